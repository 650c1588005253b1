// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/case_runner.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/campaign/shard_ledger.hpp"
#include "crosscheck/campaign/smaller.hpp"
#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/exact/small_state.hpp"
#include "crosscheck/inputs/feature_pairs.hpp"
#include "crosscheck/system/children.hpp"
#include "crosscheck/system/shell.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Of = CampaignPart::Of;

constexpr int kMostTrials =
    400;                    // of smaller(): a failing mechanism costs as much as so many others
constexpr int kPool = 300;  // mechanisms from which it is seen which pairs are rare

/// Equal for disagreements that are probably one fault: what is asked, and who is asked.
std::string causeOf(const CheckResult& check) {
  return fmt::format("{} {} ({}{}{})", check.name(), check.quantity, check.left,
                     check.right.empty() ? "" : ", ", check.right);
}
bool hasCause(const std::vector<CheckResult>& checks, const std::string& cause) {
  return std::any_of(checks.begin(), checks.end(),
                     [&](const CheckResult& check) { return causeOf(check) == cause; });
}

/// A bit each, four a digit.
/// @param count  of all that there are
std::string hexOf(const std::vector<int>& set, int count) {
  std::string digits(static_cast<std::size_t>(count + 3) / 4, '0');
  std::vector<int> values(digits.size(), 0);
  for (const int bit : set) values[static_cast<std::size_t>(bit) / 4] |= 8 >> (bit % 4);
  for (std::size_t k = 0; k < digits.size(); ++k) digits[k] = "0123456789abcdef"[values[k]];
  return digits;
}

/// Which of exactCheckNames() were decided, had nothing to ask, were not answerable.
Json lawsOf(const RandomCampaign& found) {
  const std::vector<std::string>& names = exactCheckNames();
  std::vector<int> met[3];
  for (const auto& [law, counts] : found.by_law) {
    const auto it = std::find(names.begin(), names.end(), law);
    if (it == names.end())
      throw std::logic_error("case_runner: exactCheckNames() lacks \"" + law + '"');
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (counts[k] > 0) met[k].push_back(static_cast<int>(it - names.begin()));
  }
  const auto count = static_cast<int>(names.size());
  return {{"decided", hexOf(met[0], count)},
          {"idle", hexOf(met[1], count)},
          {"not_answerable", hexOf(met[2], count)}};
}

/// How many moving joints carry the farthest link, and the most that stand on one link.
std::pair<int, int> depthAndBranches(const scene::Mechanism& m) {
  std::vector<int> depth(m.links.size(), 0), on(m.links.size(), 0);
  for (std::size_t i = 1; i < m.links.size(); ++i) {
    const auto parent = static_cast<std::size_t>(m.links[i].parent);
    depth[i] = depth[parent] + (m.links[i].joint.kind == scene::JointKind::kFixed ? 0 : 1);
    ++on[parent];
  }
  return {*std::max_element(depth.begin(), depth.end()), *std::max_element(on.begin(), on.end())};
}

Json kindsOf(const scene::Mechanism& m) {
  std::map<std::string, int> kinds;
  for (std::size_t i = 1; i < m.links.size(); ++i) ++kinds[scene::name(m.links[i].joint.kind)];
  return kinds;
}

/// Of failures, which are checks that disagree or that are not answerable.
Verdict verdictOf(const std::vector<RandomCampaign::Failure>& failures) {
  Verdict out = Verdict::kAgree;
  for (const RandomCampaign::Failure& failure : failures)
    for (const CheckResult& check : failure.checks)
      if (out != Verdict::kDisagree) out = check.verdict;
  return out;
}

/// Where an exact check shows it; what only shows in double has none.
std::optional<FoundState> smallStateOf(const scene::Scene& scene, const std::string& cause,
                                       const CampaignOptions& options) {
  CampaignOptions exactly = options;
  exactly.in_double.clear();
  return smallestState(scene.mechanism, options.exact.seed, [&](const SmallState& state) {
    exactly.exact.at = [&](const FieldNumbers& number, scene::State<PrimeField>& at) {
      putInto(state, scene.mechanism, number, at);
    };
    return hasCause(disagreementsAbout(scene, exactly).checks, cause);
  });
}

/// As the scene's own start, where any position is one: not of closed loops, nor of followers.
void startAt(const SmallState& state, scene::Scene* scene) {
  if (!scene->mechanism.closures.empty() || scene->mechanism.hasMimics()) return;
  scene->start_q = positionsOf(state, scene->mechanism);
  scene->start_qd.assign(state.qd.begin(), state.qd.end());
}

Json stateJson(const FoundState& found, const scene::Mechanism& mechanism) {
  Json positions = Json::array();
  for (const scene::Number& q : positionsOf(found.state, mechanism)) positions.push_back(q.text());
  return {{"q", positions},
          {"qd", found.state.qd},
          {"qdd", found.state.qdd},
          {"tau", found.state.tau},
          {"trials", found.trials}};
}

void addFailure(const RandomCampaign::Failure& failure, const CampaignOptions& options,
                Json* record) {
  const std::string cause = causeOf(failure.checks.front());
  (*record)["cause"] = cause;
  (*record)["failure"] = describeFailure(failure);
  SmallerScene small = smaller(
      failure.scene,
      [&](const scene::Scene& one) {
        return hasCause(disagreementsAbout(one, options).checks, cause);
      },
      kMostTrials);
  const std::optional<FoundState> found = smallStateOf(small.scene, cause, options);
  if (found) startAt(found->state, &small.scene);
  (*record)["small"] = {{"scene", scene::writeSceneToml(small.scene)},
                        {"trials", small.trials},
                        {"is_smallest", small.is_smallest}};
  if (found) (*record)["small"]["state"] = stateJson(*found, small.scene.mechanism);
}

Json mechanismRecord(const CampaignPart& part, int index, const CampaignOptions& options) {
  const scene::Scene scene =
      randomWholeScene(options.exact.seed, static_cast<std::uint64_t>(index), part.most_joints);
  const RandomCampaign found = crosscheckDrawn(scene, index, part.most_joints, options);
  const auto [depth, branches] = depthAndBranches(scene.mechanism);
  Json record{{"name", scene.name},
              {"verdict", name(verdictOf(found.failures))},
              {"rates", scene.mechanism.dof()},
              {"depth", depth},
              {"branches", branches},
              {"kinds", kindsOf(scene.mechanism)},
              {"exact", found.checks},
              {"not_answerable", found.not_answerable},
              {"chance", found.error_probability},
              {"comparisons", found.comparisons},
              {"laws", lawsOf(found)},
              {"pairs", hexOf(pairsOf(scene.mechanism), pairCount())}};
  for (const RandomCampaign::Failure& failure : found.failures) {
    // the mechanism of plain joints that is asked about besides is another one
    if (failure.scene.name != scene.name && found.failures.size() > 1) continue;
    if (failure.checks.front().verdict == Verdict::kDisagree)
      addFailure(failure, options, &record);
    else
      record["failure"] = describeFailure(failure);
  }
  return record;
}

Json sceneRecord(const CampaignPart& part, long index, const CampaignPlan& plan) {
  const auto scenes = static_cast<long>(part.scenes.size());
  const scene::Scene& scene = part.scenes[static_cast<std::size_t>(index % scenes)];
  Options options;
  options.seed = plan.seed + static_cast<std::uint64_t>(index / scenes);
  options.states = part.states;
  options.drift = false;
  options.error_probability = plan.error_probability;
  const std::vector<WitnessKind> kinds = witnessKinds();
  CrosscheckResult run;
  run.seed = options.seed;
  run.states = options.states;
  run.scenes.push_back(crosscheckScene(PreparedScene(scene), kinds, options));
  Json record{{"name", scene.name},
              {"verdict", name(run.verdict())},
              {"seed", options.seed},
              {"checks", run.checkCount()},
              {"exact", run.exactCount()}};
  std::string text;
  for (const CheckResult& check : run.scenes.front().checks) {
    if (check.verdict != Verdict::kDisagree) continue;
    if (!record.contains("cause")) record["cause"] = causeOf(check);
    text += fmt::format("{}: {}\n", causeOf(check), check.reason);
  }
  if (!text.empty())
    record["failure"] = text + fmt::format(
                                   "to see it again: dynwitness crosscheck {} --seed {} "
                                   "--random {}",
                                   scene.file.string(), options.seed, options.states);
  return record;
}

/// By what commands.hpp says of exit statuses.
const char* verdictOf(int status) {
  return status == 0   ? "agree"
         : status == 1 ? "disagree"
         : status == 3 ? "not answerable"
                       : "failed";
}

Json commandRecord(const std::string& command, const std::filesystem::path& program, double seconds,
                   std::string* said) {
  // a shell takes the words apart, as it does in a script; the status comes first, since of long
  // output only the begin is kept
  const std::string words = fmt::format("out=$({} {} 2>&1); echo \"$?\"; printf %s \"$out\"",
                                        shellWord(program.string()), command);
  ChildOptions options;
  options.seconds = seconds;
  Child child({"/bin/sh", "-c", words}, options);
  const Ending ending = child.wait();
  const std::size_t end = ending.output.find('\n');
  if (!ending.problem.empty() || end == std::string::npos) {
    *said = ending.output;
    return {{"name", command},
            {"verdict", "failed"},
            {"cause", fmt::format("dynwitness {}", command)},
            {"failure", ending.problem.empty() ? "it has not said how it ended" : ending.problem}};
  }
  const int status = std::stoi(ending.output);
  Json record{{"name", command}, {"verdict", verdictOf(status)}, {"status", status}};
  if (status == 0) return record;
  *said = ending.output.substr(end + 1);
  record["cause"] = fmt::format("status {} of {}", status, command);
  record["failure"] = fmt::format("to see it again: dynwitness {}", command);
  return record;
}

}  // namespace

CaseRunner::CaseRunner(CampaignPlan plan, std::filesystem::path program,
                       std::vector<WitnessKind> kinds)
    : plan_(std::move(plan)), program_(std::move(program)), kinds_(std::move(kinds)) {
  const auto drawn = std::find_if(plan_.parts.begin(), plan_.parts.end(),
                                  [](const CampaignPart& part) { return part.draws > 1; });
  if (drawn == plan_.parts.end()) return;
  std::vector<int> counts(static_cast<std::size_t>(pairCount()), 0);
  for (int k = 0; k < kPool; ++k)
    for (const int pair :
         pairsOf(randomWholeScene(plan_.seed, static_cast<std::uint64_t>(k), drawn->most_joints)
                     .mechanism))
      ++counts[static_cast<std::size_t>(pair)];
  for (const int count : counts) rarity_.push_back(1.0 / (1 + count));
}

CampaignOptions CaseRunner::optionsOf(const CampaignPart& part) const {
  CampaignOptions options;
  options.exact.seed = plan_.seed;
  options.exact.error_probability = plan_.error_probability;
  options.exact.witnesses = kinds_;
  options.states = part.states;
  if (part.states == 0) return options;
  for (const WitnessKind& kind : kinds_.empty() ? witnessKinds() : kinds_)
    if (kind.info.present && !kind.is_compiled) options.in_double.push_back(kind);
  return options;
}

int CaseRunner::indexOf(const CampaignPart& part, long index) const {
  const long first = (part.first + index) * part.draws;
  long best = first;
  double most = -1;
  for (long k = first; k < first + part.draws && part.draws > 1; ++k) {
    double rare = 0;
    for (const int pair :
         pairsOf(randomWholeScene(plan_.seed, static_cast<std::uint64_t>(k), part.most_joints)
                     .mechanism))
      rare = std::max(rare, rarity_[static_cast<std::size_t>(pair)]);
    if (rare > most) most = rare, best = k;
  }
  return static_cast<int>(best);
}

std::string CaseRunner::line(long number) const {
  const auto begin = std::chrono::steady_clock::now();
  const CampaignCase one = caseOf(plan_, number);
  std::string said;
  Json record{{"case", number}, {"of", name(one.part->of)}};
  try {
    if (one.part->of == Of::kMechanisms)
      record.update(
          mechanismRecord(*one.part, indexOf(*one.part, one.index), optionsOf(*one.part)));
    else if (one.part->of == Of::kScenes)
      record.update(sceneRecord(*one.part, one.index, plan_));
    else
      record.update(commandRecord(one.part->commands[static_cast<std::size_t>(one.index)], program_,
                                  plan_.seconds, &said));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    record.update({{"verdict", "failed"}, {"cause", problem.what()}, {"failure", problem.what()}});
  }
  Json besides{
      {"seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()}};
  if (!said.empty()) besides["said"] = said;
  return sealedLine(record.dump(-1, ' ', false, Json::error_handler_t::replace),
                    besides.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string CaseRunner::lineOfFailed(long number, const std::string& problem,
                                     double seconds) const {
  const Json record{{"case", number},
                    {"of", name(caseOf(plan_, number).part->of)},
                    {"verdict", "failed"},
                    {"cause", problem},
                    {"failure", fmt::format("case {}: {}", number, problem)}};
  return sealedLine(record.dump(), Json{{"seconds", seconds}}.dump());
}

}  // namespace dynwitness::crosscheck
