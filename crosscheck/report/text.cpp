// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Length of the well-formed UTF-8 sequence at the front of `text`, 0 when there is none.
std::size_t sequenceLength(std::string_view text, std::uint32_t* code_point) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) {
    *code_point = first;
    return 1;
  }
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  std::uint32_t value = first & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    value = (value << 6) | (byte(i) & 0x3Fu);
  }
  // overlong forms, surrogates, beyond Unicode
  if ((length == 3 && value < 0x800) || (length == 4 && (value < 0x10000 || value > 0x10FFFF)) ||
      (value >= 0xD800 && value <= 0xDFFF))
    return 0;
  *code_point = value;
  return length;
}

bool allowedInXml(std::uint32_t c) {
  if (c < 0x20) return c == '\t' || c == '\n' || c == '\r';
  return c != 0x7F && c != 0xFFFE && c != 0xFFFF;
}

}  // namespace

std::string cleanText(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    std::uint32_t code_point = 0;
    const std::size_t length = sequenceLength(text, &code_point);
    if (length > 0 && allowedInXml(code_point))
      clean += text.substr(0, length);
    else
      clean += kReplacement;
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return clean;
}

std::string escapeMarkup(std::string_view text) {
  std::string escaped;
  for (const char c : cleanText(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string oneLine(std::string_view text) {
  std::string line = cleanText(text);
  for (char& c : line)
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  return line;
}

std::string gnuplotString(std::string_view text) {
  std::string q = "'";
  for (const char c : oneLine(text)) {
    q += c;
    if (c == '\'') q += c;
  }
  return q + "'";
}

std::string readable(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "infinite" : "-infinite";
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 0.00995 || size >= 999.5) return fmt::format("{:.1e}", value);
  if (size < 0.0995) return fmt::format("{:.3f}", value);
  if (size < 0.995) return fmt::format("{:.2f}", value);
  if (size < 9.95) return fmt::format("{:.1f}", value);
  return fmt::format("{:.0f}", value);
}

std::string limitText(const CheckResult& check) {
  return (isLimitFromBelow(check.unit) ? "≥ " : "") + readable(check.limit);
}

std::string worstOfLimit(const CheckResult& check) {
  if (isLimitFromBelow(check.unit))
    return fmt::format("{} {}, at least {}", measure(check.unit), readable(check.worst),
                       readable(check.limit));
  return fmt::format("{} of {} {}", readable(check.worst), readable(check.limit), check.unitName());
}

std::string shareOfLimit(double ratio) {
  if (std::isnan(ratio)) return "not a number";
  if (ratio > 1) {
    // just beyond the limit must not read as "1.0 x limit"
    if (ratio < 1.0005) return "just over the limit";
    return (ratio < 1.05 ? fmt::format("{:.4g}", ratio) : readable(ratio)) + " × limit";
  }
  const double percent = 100 * ratio;
  if (percent == 0) return "0 %";
  if (percent < 0.1) return "<0.1 %";
  return fmt::format(percent < 9.95 ? "{:.1f} %" : "{:.0f} %", percent);
}

std::string ofLimit(double ratio, const std::string& what) {
  constexpr double kFactor = 10;  // beyond 1000 %, percent say nothing
  if (!std::isfinite(ratio)) return "not within " + what;
  return ratio <= kFactor ? fmt::format("{:.0f}% of {}", 100 * ratio, what)
                          : fmt::format("{:.2g} times {}", ratio, what);
}

int codePoints(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::string safeName(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool keep = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '_' || c == '-';
    name += keep ? c : '_';
  }
  // '-' in front would read as an option of a command, 100 is well below every file system's limit
  if (name.empty() || name.front() == '-') name = "scene" + name;
  name.resize(std::min<std::size_t>(name.size(), 100));
  return name;
}

std::vector<std::string> safeNames(const std::vector<SceneResult>& scenes) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const SceneResult& scene : scenes) {
    const std::string name = safeName(scene.name);
    std::string unique = name;
    for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}", name, k);
    names.push_back(unique);
  }
  return names;
}

std::string voidedText(const CheckResult& check) {
  if (check.voided == 0) return {};
  return fmt::format("{} of {} states not judged, the first {}: {}", check.voided, check.states,
                     check.first_voided, check.voided_reason);
}

std::string describe(const CheckResult& check) {
  std::string text = check.name();
  if (!check.quantity.empty()) text += " " + check.quantity;
  if (!check.left.empty()) text += ": " + check.left;
  if (!check.right.empty()) text += " and " + check.right;
  return text;
}

}  // namespace dynwitness::crosscheck
