// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/page_parts.hpp"

#include <fmt/format.h>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {

std::string pageHead(const std::string& title, const std::string& version, const std::string& style,
                     const std::string& skip, const std::string& skip_words) {
  const std::string head = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta name=\"generator\" content=\"dynwitness {}\">\n"
      "<title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{}{}</style>\n</head>\n"
      "<body>\n<a class=\"skip\" href=\"#{}\">{}</a>\n",
      escapeMarkup(version), escapeMarkup(title), kStyleCss, style, skip, escapeMarkup(skip_words));
  // the three signs, drawn once
  return head +
         "<svg class=\"symbols\" aria-hidden=\"true\" focusable=\"false\">"
         "<symbol id=\"icon-agree\" viewBox=\"0 0 24 24\"><circle cx=\"12\" cy=\"12\" r=\"12\" "
         "fill=\"currentColor\"/><path d=\"M6.5 12.5l3.6 3.6 7.4-8\" fill=\"none\" "
         "stroke=\"var(--card)\" stroke-width=\"2.6\" stroke-linecap=\"round\" "
         "stroke-linejoin=\"round\"/></symbol>"
         "<symbol id=\"icon-disagree\" viewBox=\"0 0 24 24\"><path d=\"M7.5 1h9L23 7.5v9L16.500 "
         "23h-9L1 16.500v-9z\" fill=\"currentColor\"/><path d=\"M8 8l8 8m0-8l-8 8\" fill=\"none\" "
         "stroke=\"var(--card)\" stroke-width=\"2.6\" stroke-linecap=\"round\"/></symbol>"
         "<symbol id=\"icon-none\" viewBox=\"0 0 24 24\"><circle cx=\"12\" cy=\"12\" r=\"10.800\" "
         "fill=\"none\" stroke=\"currentColor\" stroke-width=\"2.2\"/><path d=\"M7.500 12h9\" "
         "stroke=\"currentColor\" stroke-width=\"2.4\" stroke-linecap=\"round\"/></symbol></svg>\n";
}

std::string icon(const char* css_class) {
  return fmt::format(R"(<svg class="icon" aria-hidden="true"><use href="#icon-{}"/></svg>)",
                     css_class);
}

std::string badge(const char* css_class, const std::string& word) {
  return fmt::format(R"(<span class="badge {0}">{1}{2}</span>)", css_class, icon(css_class),
                     escapeMarkup(word));
}

}  // namespace dynwitness::crosscheck
