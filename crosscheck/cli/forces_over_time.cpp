// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/forces_over_time.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "scene/motion.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

ForcesOverTime forcesOfTime(const std::vector<std::string>& words, const scene::Scene& scene) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const std::vector<std::string> names = mechanism.rateLabels();
  const std::vector<NamedPlace> places = placesNamed("tau", names);
  const std::vector<const scene::Expression*> motions = mechanism.motions();
  const bool all_named = std::all_of(words.begin(), words.end(), [](const std::string& word) {
    return word.find('=') != std::string::npos;
  });
  std::vector<std::pair<std::size_t, scene::Expression>> parts;
  const auto number = std::make_shared<scene::RealNumbers<double>>(mechanism);
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    std::size_t at = k;
    if (all_named) {
      at = static_cast<std::size_t>(placeMeant("--tau", words[k].substr(0, equals), places));
      for (const auto& part : parts)
        if (part.first == at)
          throw scene::InputError(
              {}, fmt::format("--tau: read '{}', which was given before, allowed: each once",
                              words[k]));
    }
    const std::string text = all_named ? words[k].substr(equals + 1) : words[k];
    std::string reason;
    try {
      const scene::Expression function = scene::Expression::parseOfTime(text);
      if (!std::isfinite(scene::motionAt(function, *number, 0.0).value))
        reason = "; it is not finite at t = 0";
      else
        parts.emplace_back(at, function);
    } catch (const scene::InputError& error) {
      reason = std::string("; ") + error.what();
    }
    if (!reason.empty())
      throw scene::InputError({}, fmt::format("--tau: read '{}', allowed: a function of t, in the "
                                              "scene's parameters and pi{}",
                                              text, reason));
    if (at < motions.size() && motions[at] != nullptr)
      throw scene::InputError(
          {}, fmt::format("--tau: '{}' is driven, and its force is what the drive takes, allowed: "
                          "joints that are free",
                          names[at]));
  }
  if (!all_named && words.size() != names.size())
    throw scene::InputError(
        {}, fmt::format("--tau: {} functions, allowed: {}, or by joint, {}=2*sin(3*t)",
                        words.size(), names.size(), names.front()));
  return [parts, number](double time, std::vector<double>* tau) {
    for (const auto& [at, function] : parts)
      (*tau)[at] += scene::motionAt(function, *number, time).value;
  };
}

ForcesOverTime forcesOfFile(const std::string& file, const scene::Scene& scene, double duration) {
  StatesReader reader(file, scene.mechanism, {{"t", "time_s"}, false, true});
  const std::vector<std::string>& others = reader.otherNames();
  if (others.size() != 1 || !reader.gives("tau"))
    throw scene::InputError({file, 1},
                            "columns t (or time_s) and tau1.. are needed, one of the two "
                            "times and all of tau");
  auto rows = std::make_shared<std::vector<std::pair<double, std::vector<double>>>>();
  scene::State<double> state;
  while (reader.next(&state)) {
    const double time = reader.others().front();
    if (!rows->empty() && !(time > rows->back().first))
      throw scene::InputError(
          {file, 0}, fmt::format("row {}: t = {} s does not come after {} s, allowed: times "
                                 "that rise",
                                 rows->size() + 1, time, rows->back().first));
    rows->emplace_back(time, state.tau);
  }
  if (rows->empty() || rows->front().first > 0 || rows->back().first < duration)
    throw scene::InputError(
        {file, 0}, fmt::format("its times do not span 0 to {} s, allowed: a file that does, or a "
                               "shorter --duration",
                               duration));
  return [rows](double time, std::vector<double>* tau) {
    auto next = std::upper_bound(
        rows->begin(), rows->end(), time,
        [](double t, const std::pair<double, std::vector<double>>& row) { return t < row.first; });
    if (next == rows->begin()) ++next;
    if (next == rows->end()) --next;
    const auto& before = *(next == rows->begin() ? next : next - 1);
    const double share =
        next->first > before.first
            ? std::clamp((time - before.first) / (next->first - before.first), 0.0, 1.0)
            : 0;
    for (std::size_t k = 0; k < tau->size(); ++k)
      (*tau)[k] += before.second[k] + share * (next->second[k] - before.second[k]);
  };
}

}  // namespace dynwitness::cli
