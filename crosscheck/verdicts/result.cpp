// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/result.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "crosscheck/verdicts/causes.hpp"

namespace dynwitness::crosscheck {

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgree:
      return "agree";
    case Verdict::kDisagree:
      return "disagree";
    case Verdict::kNotAnswerable:
      return "not answerable";
  }
  return "?";
}

const char* name(RunVerdict verdict) {
  switch (verdict) {
    case RunVerdict::kAgree:
      return "agree";
    case RunVerdict::kNotAnswerable:
      return "not answerable";
    case RunVerdict::kIncomplete:
      return "incomplete";
    case RunVerdict::kProvesNothing:
      return "proves nothing";
    case RunVerdict::kDisagree:
      return "disagree";
  }
  return "?";
}

const char* name(CheckKind kind) {
  switch (kind) {
    case CheckKind::kSame:
      return "same";
    case CheckKind::kTruth:
      return "truth";
    case CheckKind::kTable:
      return "table";
    case CheckKind::kWitness:
    case CheckKind::kRefusal:
      return "witness";
    case CheckKind::kLaw:
    case CheckKind::kLeftOut:
      break;
  }
  return "";
}

const char* measure(Unit unit) {
  switch (unit) {
    case Unit::kUlp:
      return "ulp";
    case Unit::kAbsolute:
      return "its own unit, being zero within rounding";
    case Unit::kExact:
      return "exact";
    case Unit::kBoundPerPivot:
      return "error bound / pivot";
    case Unit::kObservedOrder:
      return "observed order";
    case Unit::kPowerOfStepError:
      return "power of a step's error";
    case Unit::kRoundingOfSteps:
      return "rounding of the steps";
    case Unit::kDirections:
      return "directions";
    case Unit::kPaths:
      return "paths";
    case Unit::kPrintedDigit:
      return "units of the last printed digit";
    case Unit::kStatedAccuracy:
      return "stated accuracy of the source";
    case Unit::kSourceRounding:
      return "rounding of the source's program";
  }
  return "?";
}

bool isLimitFromBelow(Unit unit) {
  return unit == Unit::kObservedOrder || unit == Unit::kPowerOfStepError;
}

std::string name(Unit unit) {
  return std::string(measure(unit)) + (isLimitFromBelow(unit) ? " (at least)" : "");
}

const char* name(Road road) {
  switch (road) {
    case Road::kPairs:
      return "pairs";
    case Road::kTruth:
      return "truth";
    case Road::kField:
      return "field";
    case Road::kTable:
      return "table";
  }
  return "?";
}

const char* name(Finding::Kind kind) {
  switch (kind) {
    case Finding::Kind::kDisagreement:
      return "disagreement";
    case Finding::Kind::kKnownLoss:
      return "known loss";
    case Finding::Kind::kOpenStart:
      return "open start";
    case Finding::Kind::kEngine:
      return "engine";
  }
  return "?";
}

int exitStatus(RunVerdict verdict) {
  switch (verdict) {
    case RunVerdict::kAgree:
      return 0;
    case RunVerdict::kIncomplete:
    case RunVerdict::kDisagree:
      return 1;
    case RunVerdict::kNotAnswerable:
    case RunVerdict::kProvesNothing:
      break;
  }
  return 3;
}

std::string CheckResult::name() const {
  const std::string of_kind = crosscheck::name(kind);
  return of_kind.empty() ? law : of_kind;
}

std::string CheckResult::unitName() const {
  static const std::map<std::string, const char*> kUnits = {
      {"M", "kg m^2, kg m or kg"},  {"kinetic", "J"}, {"potential", "J"}, {"energy", "J"},
      {"momentum", "N s or N m s"},
  };
  static const std::vector<std::string> kForces = {"c", "g", "tau", "qdd", "reactions"};
  if (unit != Unit::kAbsolute) return crosscheck::name(unit);
  const auto found = kUnits.find(quantity);
  const bool is_force =  // qdd is judged by the forces that it leaves
      std::find(kForces.begin(), kForces.end(), quantity) != kForces.end();
  return fmt::format("{} (zero within rounding)", found != kUnits.end() ? found->second
                                                  : is_force            ? "N m or N"
                                                                        : "SI units");
}

void CheckResult::useItsOwnUnit(double largest_there) {
  const double one = std::numeric_limits<double>::epsilon() *
                     (largest_there > 0 && std::isfinite(largest_there) ? largest_there : 1.0);
  if (unit != Unit::kUlp || !(limit * one >= largest_there)) return;
  unit = Unit::kAbsolute;
  worst *= one;
  limit *= one;
}

bool CheckResult::asksTheSameAs(const CheckResult& other) const {
  return kind == other.kind && law == other.law && quantity == other.quantity &&
         left == other.left && right == other.right;
}

void CheckResult::addVoided(int state, const std::string& why, bool is_excused) {
  const bool is_first = is_excused ? voided == 0 : voided == excused;
  if (is_first) {
    first_voided = state;
    voided_reason = why;
  }
  ++voided;
  excused += is_excused ? 1 : 0;
}

std::vector<Coverage> coverageOf(const std::vector<CheckResult>& checks) {
  std::vector<Coverage> all;
  for (const CheckResult& check : checks) {
    if (check.asksNothing()) continue;
    auto at = std::find_if(all.begin(), all.end(),
                           [&](const Coverage& c) { return c.quantity == check.quantity; });
    if (at == all.end()) {
      all.emplace_back();
      at = all.end() - 1;
      at->quantity = check.quantity;
    }
    // no state is to blame: there was nothing to ask
    const bool is_idle = check.verdict == Verdict::kNotAnswerable && check.voided == 0;
    const long voided = is_idle ? 1 : check.voided, excused = is_idle ? 1 : check.excused;
    if (voided > excused ? at->missing() == 0 : voided > 0 && at->voided == 0)
      at->reason = is_idle ? check.reason : check.voided_reason;
    at->asked += is_idle ? 1 : check.states;
    at->voided += voided;
    at->excused += excused;
  }
  return all;
}

std::optional<double> CheckResult::limitOverSeen() const {
  if ((unit != Unit::kUlp && unit != Unit::kAbsolute) || verdict == Verdict::kNotAnswerable ||
      !std::isfinite(seen))
    return std::nullopt;
  // without an error and without room for one: both sides are the same numbers
  if (seen == 0 && !(loosest > std::numeric_limits<double>::min())) return std::nullopt;
  return loosest / std::max(seen, ulp());
}

double CheckResult::ulp() const {
  const double one = std::numeric_limits<double>::epsilon() * largest;
  return std::isnormal(one) ? one : std::numeric_limits<double>::epsilon();
}

int CrosscheckResult::count(Verdict verdict) const {
  int count = 0;
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks) count += check.verdict == verdict ? 1 : 0;
  return count;
}

int CrosscheckResult::checkCount() const {
  return count(Verdict::kAgree) + count(Verdict::kDisagree);
}

int CrosscheckResult::exactCount() const {
  int count = 0;
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks)
      count += check.exact && check.exact->residual_zero ? 1 : 0;
  return count;
}

RunVerdict CrosscheckResult::verdict() const {
  if (count(Verdict::kDisagree) > 0) return RunVerdict::kDisagree;
  if (controlMissed()) return RunVerdict::kProvesNothing;
  if (count(Verdict::kAgree) == 0) return RunVerdict::kNotAnswerable;
  return thinlyCovered().empty() && openAtStart().empty() ? RunVerdict::kAgree
                                                          : RunVerdict::kIncomplete;
}

std::vector<Coverage> CrosscheckResult::coverage() const {
  std::vector<CheckResult> all;
  for (const SceneResult& scene : scenes)
    all.insert(all.end(), scene.checks.begin(), scene.checks.end());
  return coverageOf(all);
}

namespace {

/// "qdd of chain", for each quantity of a scene with this property.
std::vector<std::string> quantitiesThat(bool (Coverage::*is)() const,
                                        const std::vector<SceneResult>& scenes) {
  std::vector<std::string> found;
  for (const SceneResult& scene : scenes)
    for (const Coverage& coverage : coverageOf(scene.checks))
      if ((coverage.*is)()) found.push_back(fmt::format("{} of {}", coverage.quantity, scene.name));
  return found;
}

}  // namespace

std::vector<std::string> CrosscheckResult::thinlyCovered() const {
  return quantitiesThat(&Coverage::isThin, scenes);
}

std::vector<std::string> CrosscheckResult::comparedNowhere() const {
  return quantitiesThat(&Coverage::isNowhere, scenes);
}

std::vector<std::string> CrosscheckResult::openAtStart() const {
  std::vector<std::string> open;
  for (const SceneResult& scene : scenes)
    for (const Finding& finding : scene.findings)
      if (finding.kind == Finding::Kind::kOpenStart) open.push_back(finding.scene);
  return open;
}

bool CrosscheckResult::controlMissed() const {
  for (const SceneResult& scene : scenes)
    for (const Control& control : scene.controls)
      if (!control.missed.empty()) return true;
  return false;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

namespace {

/// "pairs, truth and field"
std::string roadsListed(const std::vector<Road>& roads) {
  std::vector<std::string> words;
  for (const Road road : roads) words.emplace_back(name(road));
  return listed(words);
}

bool isTableAlone(const std::vector<Road>& roads) {
  return roads == std::vector<Road>{Road::kTable};
}

/// At most `most` of them, and how many more there are.
std::string shortened(std::vector<std::string> words, std::size_t most) {
  if (words.size() > most) {
    const std::size_t more = words.size() - most;
    words.resize(most);
    words.push_back(fmt::format("{} more", more));
  }
  return listed(words);
}

}  // namespace

std::string CrosscheckResult::controlLine() const {
  std::vector<std::string> quantities, larger, missed, idle;
  std::vector<Road> roads;
  std::map<std::string, int> nothing;  // scenes, by quantity
  std::set<std::string> seen_in;
  double least = 0, table = 0;
  for (const SceneResult& scene : scenes)
    for (const Control& control : scene.controls)
      if (control.size > 0 && !isTableAlone(control.found))
        least = least == 0 ? control.size : std::min(least, control.size);
  for (const SceneResult& scene : scenes) {
    for (const Control& control : scene.controls) {
      const std::string where = fmt::format("{} of {}", control.quantity, scene.name);
      if (!control.missed.empty())
        missed.push_back(fmt::format("{} by {}", where, roadsListed(control.missed)));
      if (!control.nothing.empty()) ++nothing[control.quantity];
      if (control.found.empty()) continue;
      seen_in.insert(scene.name);
      if (isTableAlone(control.found)) {
        table = std::max(table, control.size);
        continue;
      }
      addOnce(quantities, control.quantity);
      for (const Road road : control.found) addOnce(roads, road);
      if (control.size > least) larger.push_back(fmt::format("{} at {:.0e}", where, control.size));
    }
  }
  if (seen_in.empty() && missed.empty()) return "control: nothing was planted";
  std::string line;
  if (!missed.empty())
    line =
        fmt::format("control: a known fault, a kilogram too heavy by {:.0e}, was not found in {}",
                    least, shortened(missed, 5));
  else
    line = fmt::format(
        "control: a kilogram too heavy by {:.0e} was found in {} of {}{} scene{}, by {}", least,
        listed(quantities), seen_in.size() == scenes.size() && scenes.size() > 1 ? "all " : "",
        seen_in.size(), seen_in.size() == 1 ? "" : "s", roadsListed(roads));
  if (table > 0) line += fmt::format("; in tables by their digits, at most {:.0e}", table);
  if (!larger.empty()) line += "; " + shortened(larger, 3);
  for (const auto& [quantity, count] : nothing)
    idle.push_back(fmt::format("{} of {} scene{}", quantity, count, count == 1 ? "" : "s"));
  if (!idle.empty()) line += "; nothing to plant in " + listed(idle);
  return line;
}

std::pair<const SceneResult*, const CheckResult*> CrosscheckResult::worst() const {
  std::pair<const SceneResult*, const CheckResult*> worst{nullptr, nullptr};
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks)
      if (check.verdict != Verdict::kNotAnswerable &&
          (check.unit == Unit::kUlp || check.unit == Unit::kAbsolute) && !check.known_loss &&
          (worst.second == nullptr || !(check.ratio <= worst.second->ratio)))
        worst = {&scene, &check};
  return worst;
}

std::vector<CrosscheckResult::KnownLoss> CrosscheckResult::knownLosses() const {
  std::vector<KnownLoss> losses;
  for (const WitnessInfo& witness : witnesses) {
    KnownLoss loss{&witness, nullptr, 0};
    for (const SceneResult& scene : scenes) {
      for (const Finding& finding : scene.findings) {
        if (finding.kind != Finding::Kind::kKnownLoss || finding.witness != witness.name) continue;
        ++loss.scenes;
        if (loss.worst == nullptr || finding.digits < loss.worst->digits) loss.worst = &finding;
      }
    }
    if (loss.worst != nullptr) losses.push_back(loss);
  }
  return losses;
}

std::string CrosscheckResult::causesLine() const {
  std::vector<Cause> causes;
  for (const SceneResult& scene : scenes)
    for (Cause& cause : causesOf(scene)) causes.push_back(std::move(cause));
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) {
    return a.checks.size() > b.checks.size();
  });
  if (causes.empty()) return "";
  const std::string first = causes.front().scene + ": " + causes.front().text;
  return causes.size() == 1 ? "one cause, in " + first
                            : fmt::format("{} causes, the first in {}", causes.size(), first);
}

std::string CrosscheckResult::headline() const {
  const int disagreeing = count(Verdict::kDisagree);
  std::string line = fmt::format("{} scene{}, {} checks, ", scenes.size(),
                                 scenes.size() == 1 ? "" : "s", checkCount());
  switch (verdict()) {
    case RunVerdict::kAgree:
      line += comparedNowhere().empty()
                  ? "all agree"
                  : "all agree; not compared at all: " + shortened(comparedNowhere(), 4);
      break;
    case RunVerdict::kNotAnswerable:
      line += "nothing could be answered";
      break;
    case RunVerdict::kIncomplete:
      line += "incomplete: what was answered agrees, but ";
      if (!thinlyCovered().empty())
        line += "too little was of " + shortened(thinlyCovered(), 3) +
                (openAtStart().empty() ? "" : ", and ");
      if (!openAtStart().empty())
        line += "closures are open at the start of " + shortened(openAtStart(), 3);
      break;
    case RunVerdict::kProvesNothing:
      line += "this run proves nothing: its own control, a known fault, was not found";
      break;
    case RunVerdict::kDisagree:
      line += fmt::format("{} disagree{}", disagreeing,
                          controlMissed() ? ", and the control, a known fault, was not found" : "");
      line += ": " + causesLine();
      return line;
  }
  if (exactCount() > 0) line += fmt::format(", {} exactly", exactCount());
  std::vector<Coverage> gaps;
  for (const Coverage& coverage : coverage())
    if (coverage.voided > 0) gaps.push_back(coverage);
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Coverage& a, const Coverage& b) { return a.missing() > b.missing(); });
  std::vector<std::string> unanswered;
  for (const Coverage& gap : gaps)
    unanswered.push_back(fmt::format("{} {} of {} comparisons{}", gap.quantity, gap.voided,
                                     gap.asked,
                                     gap.missing() > 0 ? fmt::format(" ({})", gap.reason) : ""));
  if (!unanswered.empty()) line += "; not answered: " + shortened(unanswered, 4);
  const auto [scene, check] = worst();
  if (check != nullptr) {
    // the two sides of a law are numbers of its own: the 20th of them is no qdd[20]
    const std::size_t index = check->worst_entry.find('[');
    const std::string entry =
        check->kind != CheckKind::kLaw ? check->worst_entry
        : index == std::string::npos
            ? check->name()
            : fmt::format("{}, entry {}", check->name(), check->worst_entry.substr(index));
    line += fmt::format(
        "; of what rounding alone may leave the largest difference is {}: {} of {} at state {} ({}{}{})",
        check->ratio <= 1 ? fmt::format("{:.0f}%", 100 * check->ratio)
                          : fmt::format("{:.2g} times it", check->ratio),
        entry, scene->name, check->worst_state, check->left, check->right.empty() ? "" : " and ",
        check->right);
  }
  return line;
}

}  // namespace dynwitness::crosscheck
