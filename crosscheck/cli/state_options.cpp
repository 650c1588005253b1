// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/state_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/standard_files.hpp"
#include "scene/error.hpp"
#include "scene/expression.hpp"
#include "scene/mimic.hpp"
#include "scene/nearest_name.hpp"
#include "scene/numbers.hpp"
#include "scene/remarks.hpp"

namespace dynwitness::cli {
namespace {

constexpr const char* kNames[] = {"q", "qd", "qdd", "tau"};
constexpr const char* kMeanings[] = {"Positions [rad, m]", "Rates [rad/s, m/s]",
                                     "Accelerations [rad/s^2, m/s^2]", "Joint forces [N m, N]"};

std::string nameOf(StateOption::Part part) {
  return kNames[static_cast<int>(part)];
}

/// Angles of more than a turn are mostly degrees.
void remarkOnTurns(const scene::Mechanism& mechanism, const std::vector<double>& q) {
  const std::vector<scene::SlotKind> slots = mechanism.slots();
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (slots[k] != scene::SlotKind::kAngle) continue;
    const std::string turns = scene::moreThanATurn(q[k], scene::AngleSpelling::kExpression);
    if (!turns.empty()) return tell(fmt::format("--q: q{} = {}\n", k + 1, turns));
  }
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
                      "parameters and pi (degrees: 30*pi/180){}",
                      option, text, reason));
}

std::vector<NamedPlace> placesNamed(const std::string& prefix,
                                    const std::vector<std::string>& names) {
  std::vector<NamedPlace> places;
  for (std::size_t k = 0; k < names.size(); ++k) {
    places.push_back({fmt::format("{}{}", prefix, k + 1), static_cast<int>(k)});
    if (!names[k].empty()) places.push_back({names[k], static_cast<int>(k)});
  }
  return places;
}

std::vector<std::string> positionNames(const scene::Mechanism& mechanism) {
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

int placeMeant(const std::string& option, const std::string& name,
               const std::vector<NamedPlace>& places) {
  constexpr std::size_t kMost = 24;  // a joint and its place for twelve
  std::vector<std::string> known;
  int at = -1;
  for (const NamedPlace& place : places) {
    known.push_back(place.name);
    if (place.name != name || place.at == at) continue;
    if (at >= 0)
      throw scene::InputError(
          {}, fmt::format("{}: \"{}\" is a joint's name and the place of another one, allowed: the "
                          "other name of the one that is meant",
                          option, name));
    at = place.at;
  }
  if (at >= 0) return at;
  const std::string guess = scene::didYouMean(name, known);
  const bool more = known.size() > kMost;
  known.resize(std::min(known.size(), kMost));
  throw scene::InputError(
      {}, fmt::format("{}: \"{}\" is none of the scene's{}, allowed: {}{}", option, name, guess,
                      fmt::join(known, ", "), more ? ", ... (dynwitness show lists them)" : ""));
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

std::vector<double> StateOption::values(const scene::Scene& scene,
                                        const std::vector<double>& otherwise) const {
  if (words_->empty()) return otherwise;
  if (part_ != Part::kQ) return told(scene, otherwise);
  const std::vector<double> q = positions(scene, otherwise);
  remarkOnTurns(scene.mechanism, q);
  return q;
}

std::vector<double> StateOption::positions(const scene::Scene& scene,
                                           const std::vector<double>& otherwise) const {
  if (!scene.mechanism.hasMimics()) return told(scene, otherwise);
  std::vector<double> given;  // followers are where their leaders put them
  for (const int slot : scene::givenSlots(scene.mechanism))
    given.push_back(otherwise[static_cast<std::size_t>(slot)]);
  return scene::allPositions(scene.mechanism, told(scene, given));
}

std::vector<double> StateOption::told(const scene::Scene& scene,
                                      const std::vector<double>& otherwise) const {
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
  const std::vector<NamedPlace> places =
      placesNamed(short_name, part_ == Part::kQ ? positionNames(scene.mechanism)
                                                : scene.mechanism.rateLabels());
  std::vector<bool> is_given(values.size(), false);
  for (const std::string& word : *words_) {
    const std::size_t equals = word.find('=');
    const auto at = static_cast<std::size_t>(placeMeant(option, word.substr(0, equals), places));
    if (is_given[at])
      throw scene::InputError(
          {},
          fmt::format("{}: read '{}', which was given before, allowed: each once", option, word));
    is_given[at] = true;
    values[at] = numberIn(option, word.substr(equals + 1), scene);
  }
  return values;
}

}  // namespace dynwitness::cli
