// SPDX-License-Identifier: GPL-3.0-or-later
// Reads [envelope] (data/scenes/README.md).
#include "scene/envelope.hpp"

#include <cmath>

#include "scene/text_file.hpp"
#include "scene/toml_file.hpp"
#include "scene/uncertain_parameters.hpp"

namespace dynwitness::scene {
namespace {

class EnvelopeReader : TomlFile {
 public:
  EnvelopeReader(const Scene& scene, const std::string& file)
      : TomlFile(file), scene_(scene), values_(scene.mechanism.parameterValues()) {}

  std::vector<JointRanges> read(const toml::node& node) const {
    const toml::table& table = asTable(node, "envelope");
    const std::vector<std::string> labels = scene_.mechanism.rateLabels();
    Keys names;
    for (const std::string& label : labels) names.emplace_back(label);
    names.emplace_back("parameters");  // uncertain_parameters.cpp
    checkKeys(table, "envelope", names);
    std::vector<JointRanges> all;
    for (const std::string& label : labels) {
      const std::string what = "envelope: joint '" + label + "'";
      const toml::node& ranges =
          required(table, "envelope", label, "{ q = [..], qd = [..], qdd = [..] } of every joint");
      const toml::table& of_joint = asTable(ranges, what);
      checkKeys(of_joint, what, {"q", "qd", "qdd", "tau"});
      all.push_back(
          {range(of_joint, what, "q"), range(of_joint, what, "qd"), range(of_joint, what, "qdd")});
      if (of_joint.contains("tau")) all.back().tau = range(of_joint, what, "tau");
    }
    return all;
  }

 private:
  Range range(const toml::table& table, const std::string& what, const std::string& key) const {
    const toml::node& node =
        required(table, what, key, "[lowest, highest]: it is unbounded without");
    const toml::array* pair = node.as_array();
    if (!pair || pair->size() != 2) wrongType(node, what + ": " + key, "[lowest, highest]");
    const Range range{number((*pair)[0], what + ": " + key), number((*pair)[1], what + ": " + key)};
    if (range.low > range.high)
      throw InputError(where(node), what + ": " + key + " is empty: lowest " +
                                        std::to_string(range.low) + " is above highest " +
                                        std::to_string(range.high) +
                                        ", allowed: lowest <= highest");
    return range;
  }

  double number(const toml::node& node, const std::string& what) const {
    double value = 0;
    if (const auto* text = node.as_string()) {
      try {
        value = exactValue(Expression::parse(text->get()), values_).toDouble();
      } catch (const InputError& error) {
        throw InputError(where(node), what + ": " + error.what());
      }
    } else if (const auto given = node.value<double>()) {
      value = *given;
    } else {
      wrongType(node, what, "a number or a string with an expression");
    }
    if (!std::isfinite(value))
      throw InputError(where(node), what + ": not finite, allowed: a finite number");
    return value;
  }

  const Scene& scene_;
  ParameterValues values_;
};

}  // namespace

std::vector<JointRanges> envelopeOf(const std::string& text, const Scene& scene) {
  const std::string file = scene.file.string();
  const toml::table top = parsedToml(withoutMark(text), file);
  const toml::node* node = top.get("envelope");
  if (!node) return {};
  return EnvelopeReader(scene, file).read(*node);
}

std::vector<JointRanges> readEnvelope(const Scene& scene) {
  if (!isTomlFile(scene.file)) return {};
  return envelopeOf(readTextFile(scene.file, "a TOML scene"), scene);
}

bool hasEnvelope(const Scene& scene) {
  if (!isTomlFile(scene.file)) return false;
  const std::string text = readTextFile(scene.file, "a TOML scene");
  return parsedToml(withoutMark(text), scene.file.string()).contains("envelope");
}

}  // namespace dynwitness::scene
