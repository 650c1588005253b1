// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/state_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/error.hpp"
#include "scene/expression.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::cli {
namespace {

constexpr const char* kNames[] = {"q", "qd", "qdd", "tau"};
constexpr const char* kMeanings[] = {"Positions [rad, m]", "Rates [rad/s, m/s]",
                                     "Accelerations [rad/s^2, m/s^2]", "Joint forces [N m, N]"};

std::string nameOf(StateOption::Part part) {
  return kNames[static_cast<int>(part)];
}

}  // namespace

double numberIn(const std::string& option, const std::string& text, const scene::Scene& scene) {
  std::string reason;
  try {
    const double value =
        scene::RealNumbers<double>(scene.mechanism)(scene::Expression::parse(text));
    if (std::isfinite(value)) return value;
  } catch (const scene::InputError& error) {
    reason = std::string("; ") + error.what();
  }
  throw scene::InputError(
      {}, fmt::format("{}: read '{}', allowed: a finite number, or an expression in the scene's "
                      "parameters and pi{}",
                      option, text, reason));
}

StateOption::StateOption(CLI::App* command, Part part, const std::string& otherwise)
    : part_(part), words_(std::make_shared<std::vector<std::string>>()) {
  const std::string name = nameOf(part);
  command
      ->add_option("--" + name, *words_,
                   fmt::format("{}, in the order of `show` or by joint, elbow=0.3; without: {}",
                               kMeanings[static_cast<int>(part)], otherwise))
      ->delimiter(',')
      ->type_name("FLOAT:finite ...");
}

/// Two a number where a joint has one name for it: by joint and by place ("elbow", "q3").
std::vector<std::string> StateOption::namesIn(const scene::Mechanism& mechanism) const {
  if (part_ != Part::kQ) return mechanism.rateLabels();
  std::vector<std::string> names;
  for (const scene::Link& link : mechanism.links) {
    if (link.joint.mimic) continue;
    const std::size_t slots = scene::positionSlots(link.joint.kind).size();
    const std::vector<std::string>& rates = scene::rateNames(link.joint.kind);
    for (std::size_t k = 0; k < slots; ++k)
      names.push_back(!scene::ratesArePositionDerivatives(link.joint.kind) ? ""
                      : rates[k].empty()                                   ? link.joint.name
                                         : link.joint.name + "." + rates[k]);
  }
  return names;
}

std::vector<double> StateOption::values(const scene::Scene& scene,
                                        const std::vector<double>& otherwise) const {
  if (words_->empty()) return otherwise;
  const std::string short_name = nameOf(part_), option = "--" + short_name;
  const auto isNamed = [](const std::string& word) { return word.find('=') != std::string::npos; };
  const bool all_named = std::all_of(words_->begin(), words_->end(), isNamed);
  if (!all_named && std::any_of(words_->begin(), words_->end(), isNamed))
    throw scene::InputError({}, option +
                                    ": some numbers have names and some have none, allowed: "
                                    "all, or those that are named");
  std::vector<double> values;
  if (!all_named) {
    for (const std::string& word : *words_) values.push_back(numberIn(option, word, scene));
    if (values.size() != otherwise.size())
      throw scene::InputError(
          {}, fmt::format("{}: {} values, allowed: {}", option, values.size(), otherwise.size()));
    return values;
  }
  values = otherwise;
  const std::vector<std::string> names = namesIn(scene.mechanism);
  for (const std::string& word : *words_) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    std::size_t at = 0;
    while (at < values.size() && name != fmt::format("{}{}", short_name, at + 1) &&
           (at >= names.size() || names[at].empty() || name != names[at]))
      ++at;
    if (at == values.size()) {
      std::vector<std::string> allowed;
      for (const std::string& one : names)
        if (!one.empty()) allowed.push_back(one);
      constexpr std::size_t kMost = 12;
      const bool more = allowed.size() > kMost;
      allowed.resize(std::min(allowed.size(), kMost));
      throw scene::InputError(
          {},
          fmt::format("{}: \"{}\" is none of the scene's, allowed: {}1 to {}{}{}{}{}", option, name,
                      short_name, short_name, values.size(), allowed.empty() ? "" : ", ",
                      fmt::join(allowed, ", "), more ? ", ... (dynwitness show lists them)" : ""));
    }
    values[at] = numberIn(option, word.substr(equals + 1), scene);
  }
  return values;
}

}  // namespace dynwitness::cli
