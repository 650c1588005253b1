// SPDX-License-Identifier: GPL-3.0-or-later
// What every page of ours has: its head, and the three signs of a verdict.
#pragma once

#include <string>

namespace dynwitness::crosscheck {

/** From the doctype to the open body, style sheet and signs inside.
    @param title    plain text
    @param version  of dynwitness
    @param style    more style rules
    @param skip     anchor that the keyboard's first link leads to, and that link's words */
std::string pageHead(const std::string& title, const std::string& version, const std::string& style,
                     const std::string& skip, const std::string& skip_words);

/// One of the signs "agree", "disagree" and "none", in the colour of its surroundings.
std::string icon(const char* css_class);

/// Sign and word: never a colour alone.
std::string badge(const char* css_class, const std::string& word);

}  // namespace dynwitness::crosscheck
