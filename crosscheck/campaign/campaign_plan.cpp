// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/campaign_plan.hpp"

#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/system/hash.hpp"
#include "scene/text_file.hpp"
#include "scene/toml_file.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using scene::InputError;
using Of = CampaignPart::Of;

constexpr long kMostCases = 1000000000000;  // a case's number is exact in JSON's doubles

class PlanReader : scene::TomlFile {
 public:
  explicit PlanReader(const fs::path& file)
      : TomlFile(file.string()), folder_(file.parent_path()) {}

  CampaignPlan read(const toml::table& top) const {
    checkKeys(top, "plan", {"title", "seed", "error_probability", "seconds", "cases"});
    CampaignPlan plan;
    plan.title = string(required(top, "plan", "title", "a text"), "title");
    plan.seed = static_cast<std::uint64_t>(whole(top, "seed", 1, 0, INT64_MAX));
    plan.error_probability = number(top, "error_probability", 1e-30, 1e-300, 0.5);
    plan.seconds = number(top, "seconds", 600, 0.1, 1e6);
    for (const toml::table* table : tables(top, "cases")) plan.parts.push_back(part(*table));
    if (plan.parts.empty())
      throw InputError({file_, 0},
                       "no [[cases]], allowed: one or more, of = \"mechanisms\", "
                       "\"scenes\" or \"commands\"");
    if (plan.cases() > kMostCases)
      throw InputError({file_, 0},
                       fmt::format("{} cases, allowed: up to {}", plan.cases(), kMostCases));
    return plan;
  }

 private:
  long whole(const toml::table& table, const std::string& key, long otherwise, long low,
             long high) const {
    const toml::node* node = table.get(key);
    if (!node) return otherwise;
    const std::string allowed = high == INT64_MAX
                                    ? fmt::format("a whole number, {} or more", low)
                                    : fmt::format("a whole number from {} to {}", low, high);
    if (!node->is_integer()) wrongType(*node, key, allowed);
    const long x = node->as_integer()->get();
    if (x < low || x > high)
      throw InputError(where(*node), fmt::format("{}: read {}, allowed: {}", key, x, allowed));
    return x;
  }

  double number(const toml::table& table, const std::string& key, double otherwise, double low,
                double high) const {
    const toml::node* node = table.get(key);
    if (!node) return otherwise;
    const std::string allowed = fmt::format("a number from {:g} to {:g}", low, high);
    if (!node->is_number()) wrongType(*node, key, allowed);
    const double x = *node->value<double>();
    if (!(x >= low && x <= high))
      throw InputError(where(*node), fmt::format("{}: read {:g}, allowed: {}", key, x, allowed));
    return x;
  }

  std::vector<std::string> texts(const toml::table& table, const std::string& key) const {
    const toml::node& node = required(table, "cases", key, "an array of strings");
    if (!node.is_array() || node.as_array()->empty()) wrongType(node, key, "an array of strings");
    std::vector<std::string> out;
    for (const toml::node& one : *node.as_array()) out.push_back(string(one, key));
    return out;
  }

  scene::Scene sceneOf(const std::string& name) const {
    const fs::path beside = folder_ / name;
    return scene::findScene(fs::is_regular_file(beside) ? beside.string() : name);
  }

  CampaignPart part(const toml::table& table) const {
    const toml::node& node =
        required(table, "cases", "of", "\"mechanisms\", \"scenes\" or \"commands\"");
    const std::string word = string(node, "of");
    CampaignPart out;
    if (word == name(Of::kMechanisms)) {
      checkKeys(table, "cases of mechanisms",
                {"of", "count", "first", "most_joints", "draws", "states"});
      out.first = whole(table, "first", 0, 0, kMostCases);
      out.most_joints = static_cast<int>(whole(table, "most_joints", 12, 1, 1000));
      out.draws = static_cast<int>(whole(table, "draws", 1, 1, 1000));
      out.states = static_cast<int>(whole(table, "states", 0, 0, 1000000));
    } else if (word == name(Of::kScenes)) {
      out.of = Of::kScenes;
      checkKeys(table, "cases of scenes", {"of", "count", "scenes", "states"});
      for (const std::string& scene : texts(table, "scenes")) out.scenes.push_back(sceneOf(scene));
      out.states = static_cast<int>(whole(table, "states", 100, 1, 1000000));
    } else if (word == name(Of::kCommands)) {
      out.of = Of::kCommands;
      checkKeys(table, "cases of commands", {"of", "commands"});
      out.commands = texts(table, "commands");
      out.count = static_cast<long>(out.commands.size());
      return out;
    } else {
      throw InputError(where(node), fmt::format("of: read '{}', allowed: mechanisms, scenes, "
                                                "commands",
                                                word));
    }
    required(table, "cases", "count", "a whole number, 1 or more");
    out.count = whole(table, "count", 0, 1, kMostCases);
    constexpr long kMostIndex = INT32_MAX;
    if (out.of == Of::kMechanisms && (out.first + out.count) > kMostIndex / out.draws)
      throw InputError(where(table), fmt::format("(first + count) draws = ({} + {}) {}, allowed: "
                                                 "up to {}",
                                                 out.first, out.count, out.draws, kMostIndex));
    return out;
  }

  fs::path folder_;
};

std::string textOf(const CampaignPlan& plan) {
  std::string text = fmt::format("seed {}, error probability {:g}, {:g} s a case", plan.seed,
                                 plan.error_probability, plan.seconds);
  for (const CampaignPart& part : plan.parts) {
    text += fmt::format("; {} {}", part.count, name(part.of));
    if (part.of == Of::kMechanisms)
      text += fmt::format(" from {}, most joints {}, draws {}", part.first, part.most_joints,
                          part.draws);
    if (part.of != Of::kCommands) text += fmt::format(", states {}", part.states);
    for (const scene::Scene& scene : part.scenes)
      text += fmt::format(", {} {}", scene.name, hashOf(scene::writeSceneToml(scene)));
    for (const std::string& command : part.commands) text += ", " + command;
  }
  return text;
}

}  // namespace

long CampaignPlan::cases() const {
  long all = 0;
  for (const CampaignPart& part : parts) all += part.count;
  return all;
}

CampaignCase caseOf(const CampaignPlan& plan, long number) {
  long index = number;
  for (const CampaignPart& part : plan.parts) {
    if (index >= 0 && index < part.count) return {&part, index};
    index -= part.count;
  }
  throw std::out_of_range(fmt::format("case {} of {}", number, plan.cases()));
}

const char* name(Of of) {
  switch (of) {
    case Of::kMechanisms:
      return "mechanisms";
    case Of::kScenes:
      return "scenes";
    case Of::kCommands:
      return "commands";
  }
  return "?";
}

CampaignPlan readCampaignPlan(const fs::path& file) {
  const std::string text = scene::withoutMark(scene::readTextFile(file, "a plan in TOML"));
  CampaignPlan plan = PlanReader(file).read(scene::parsedToml(text, file.string()));
  plan.text = textOf(plan);
  return plan;
}

}  // namespace dynwitness::crosscheck
