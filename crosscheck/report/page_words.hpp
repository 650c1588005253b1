// SPDX-License-Identifier: GPL-3.0-or-later
// How the page says things: quantities, witnesses, verdicts, and what is worst.
#pragma once

#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Appends to the page.
template <typename... Args>
void put(std::string* page, const char* format, const Args&... args) {
  fmt::format_to(std::back_inserter(*page), fmt::runtime(format), args...);
}

/// escapeMarkup, which is on every other line of a page.
inline std::string esc(std::string_view text) {
  return escapeMarkup(text);
}

/// "1 link", "2 links"
std::string plural(long n, const char* word);

/// Of the style sheet: "agree", "disagree" or "none".
const char* cssClass(Verdict verdict);
const char* cssClass(RunVerdict verdict);
std::string badge(Verdict verdict, const std::string& word);

/// A quantity in words, as the headings of the check tables say it; names we do not know stay.
std::string quantityWords(const std::string& quantity);
/// "lagrange and simbody"
std::string witnessesOf(const CheckResult& check);
/// "M[1,2], state 3 of 100"; a dash for checks that no random state belongs to.
std::string worstAt(const CheckResult& check);
/// A bar and "42 %".
std::string share(const CheckResult& check);
std::string sceneTitle(const SceneResult& scene);

bool answered(const CheckResult& check);
/// False for checks that no random state belongs to, such as the energy drift.
bool drawn(const CheckResult& check);
/// For sorting: disagreements first, then what is nearest to its limit. NaN is worse than any
/// number; a limit that contains a known loss says nothing about rounding, and comes last.
double severity(const CheckResult& check);

struct SceneCounts {
  int agree = 0, disagree = 0, not_answerable = 0;
  const CheckResult* worst = nullptr;

  int answered() const { return agree + disagree; }
  Verdict verdict() const {
    if (disagree > 0) return Verdict::kDisagree;
    return agree > 0 ? Verdict::kAgree : Verdict::kNotAnswerable;
  }
};
SceneCounts count(const SceneResult& scene);

/// A box that scrolls sideways where the screen is narrower than its content; the keyboard reaches
/// it. Its end is "</div>".
void openScroll(std::string* page, const std::string& label);

}  // namespace dynwitness::crosscheck
