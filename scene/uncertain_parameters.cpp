// SPDX-License-Identifier: GPL-3.0-or-later
// Reads [envelope.parameters] (data/scenes/README.md).
#include "scene/uncertain_parameters.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "scene/text_file.hpp"
#include "scene/toml_file.hpp"

namespace dynwitness::scene {
namespace {

class UncertainReader : TomlFile {
 public:
  UncertainReader(const Scene& scene, const std::string& file)
      : TomlFile(file), scene_(scene), values_(scene.mechanism.parameterValues()) {}

  std::vector<UncertainParameter> read(const toml::node& node) const {
    const toml::table& table = asTable(node, "envelope.parameters");
    Keys names;
    for (const Parameter& parameter : scene_.mechanism.parameters)
      names.emplace_back(parameter.name);
    checkKeys(table, "envelope.parameters", names);
    std::vector<UncertainParameter> all;
    for (const Parameter& parameter : scene_.mechanism.parameters)
      if (const toml::node* given = table.get(parameter.name))
        all.push_back(of(parameter.name, *given));
    return all;
  }

 private:
  UncertainParameter of(const std::string& name, const toml::node& node) const {
    const std::string what = "envelope.parameters: " + name;
    const Exact& exact = values_.at(name);
    if (!exact.isRational())
      throw InputError(where(node), what + " is a multiple of pi, allowed: a rational parameter");
    const Rational value = exact.rational;
    if (const toml::table* table = node.as_table()) {
      checkKeys(*table, what, {"relative"});
      const toml::node& given = required(*table, what, "relative", "a share from 0 to 1");
      const Rational share = number(given, what + ": relative");
      if (share < 0 || share > 1)
        throw InputError(where(given), what + ": relative is " + Expression(share).text() +
                                           ", allowed: a share from 0 to 1");
      const Rational off = share * (value < 0 ? Rational(-value) : value);
      return {name, value - off, value + off};
    }
    const toml::array* pair = node.as_array();
    if (!pair || pair->size() != 2)
      wrongType(node, what, "{ relative = share } or [lowest, highest]");
    UncertainParameter out{name, number((*pair)[0], what), number((*pair)[1], what)};
    if (out.low > value || value > out.high)
      throw InputError(where(node), what + ": its value " + Expression(value).text() +
                                        " is not in [" + Expression(out.low).text() + ", " +
                                        Expression(out.high).text() +
                                        "], allowed: lowest <= value <= highest");
    return out;
  }

  /// A number as its decimals are written.
  Rational number(const toml::node& node, const std::string& what) const {
    std::string text;
    if (const auto* words = node.as_string())
      text = words->get();
    else if (const auto whole = node.value_exact<int64_t>())
      text = std::to_string(*whole);
    else if (const auto given = node.value_exact<double>())
      text = fmt::format("{}", *given);  // shortest: as it was written
    else
      wrongType(node, what, "a number or a string with an expression");
    try {
      const Exact value = exactValue(Expression::parse(text), values_);
      if (value.isRational()) return value.rational;
    } catch (const InputError& error) {
      throw InputError(where(node), what + ": " + error.what());
    }
    throw InputError(where(node), what + ": '" + text + "', allowed: without pi");
  }

  const Scene& scene_;
  ParameterValues values_;
};

/// The table; nullptr: there is none, or it is the ranges of a joint of that name.
const toml::node* tableIn(const toml::table& top, const Scene& scene) {
  const toml::table* envelope = top["envelope"].as_table();
  const std::vector<std::string> labels = scene.mechanism.rateLabels();
  if (envelope == nullptr || std::find(labels.begin(), labels.end(), "parameters") != labels.end())
    return nullptr;
  return envelope->get("parameters");
}

}  // namespace

std::vector<UncertainParameter> uncertainParametersOf(const std::string& text, const Scene& scene) {
  const std::string file = scene.file.string();
  const toml::table top = parsedToml(withoutMark(text), file);
  const toml::node* table = tableIn(top, scene);
  if (table == nullptr) return {};
  return UncertainReader(scene, file).read(*table);
}

std::vector<UncertainParameter> readUncertainParameters(const std::filesystem::path& file,
                                                        const Scene& scene) {
  if (!isTomlFile(file)) return {};
  Scene of_file = scene;
  of_file.file = file;
  return uncertainParametersOf(readTextFile(file, "a TOML scene"), of_file);
}

bool hasUncertainParameters(const std::filesystem::path& file, const Scene& scene) {
  if (!isTomlFile(file)) return false;
  const toml::table top =
      parsedToml(withoutMark(readTextFile(file, "a TOML scene")), file.string());
  return tableIn(top, scene) != nullptr;
}

std::string writeUncertainParameters(const std::vector<UncertainParameter>& parameters) {
  if (parameters.empty()) return "";
  std::string text = "\n[envelope.parameters]\n";
  for (const UncertainParameter& p : parameters)
    text += p.name + " = [\"" + Expression(p.low).text() + "\", \"" + Expression(p.high).text() +
            "\"]\n";
  return text;
}

}  // namespace dynwitness::scene
