// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/grade/rubric.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/diagnosis/hypotheses.hpp"
#include "crosscheck/diagnosis/suspects.hpp"
#include "crosscheck/diagnosis/textbook.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "scene/text_file.hpp"
#include "scene/toml_file.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using scene::InputError;

std::string joined(const std::set<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The rules of all mistakes that can be named in these scenes.
std::set<std::string> rulesOf(const std::vector<RubricTask>& tasks) {
  std::set<std::string> rules = {"stale_state", "float_precision"};
  for (const RubricTask& task : tasks) {
    const TextbookModel model = textbookModel(withoutFollowers(task.scene));
    for (const Hypothesis& h : hypotheses(model)) rules.insert(h.rule);
    for (const Suspect& s : suspects(model)) rules.insert(s.rule);
  }
  return rules;
}

/// A name of a variable, as a shell has them.
bool isVariable(const std::string& name) {
  return !name.empty() && name.find_first_not_of(
                              "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuv"
                              "wxyz0123456789_") == std::string::npos;
}

class RubricReader : scene::TomlFile {
 public:
  explicit RubricReader(const fs::path& file)
      : TomlFile(file.string()), folder_(file.parent_path()) {}

  Rubric read(const toml::table& top) const {
    checkKeys(top, "rubric",
              {"command", "main", "build", "files", "environment", "hide", "scalar", "seed",
               "partial", "limits", "partial_by_rule", "task"});
    Rubric out;
    const toml::node& command = required(top, "rubric", "command", "a shell's words");
    out.command = text(command, "command");
    if (out.command.find("{file}") == std::string::npos)
      throw InputError(where(command), fmt::format("command: read '{}', allowed: a shell's words "
                                                   "with {{file}} in them, the submission",
                                                   out.command));
    out.main = optionalString(top, "main");
    out.build = optionalString(top, "build");
    for (const auto& [name, node] : strings(top, "files")) out.files.push_back(beside(name, *node));
    out.environment = {"PATH", "LANG"};
    if (top.get("environment")) {
      out.environment.clear();
      for (const auto& [name, node] : strings(top, "environment")) {
        if (!isVariable(name))
          throw InputError(where(*node), fmt::format("environment: read '{}', allowed: names of "
                                                     "variables, whose values are ours",
                                                     name));
        out.environment.push_back(name);
      }
    }
    for (const auto& [name, node] : strings(top, "hide")) {
      const fs::path path = fs::absolute(folder_ / name).lexically_normal();
      if (!fs::exists(path))
        throw InputError(where(*node), fmt::format("hide: {} does not exist, allowed: folders and "
                                                   "files, by paths from the rubric's folder",
                                                   path.string()));
      out.hide.push_back(path);
    }
    const std::string scalar = top.get("scalar") ? optionalString(top, "scalar") : "double";
    if (scalar != "double" && scalar != "float")
      throw InputError(where(*top.get("scalar")),
                       fmt::format("scalar: read '{}', allowed: double, float", scalar));
    out.single = scalar == "float";
    if (const toml::node* seed = top.get("seed")) {
      if (!seed->is_integer() || seed->as_integer()->get() < 0)
        wrongType(*seed, "seed", "a whole number, 0 or more");
      out.seed = static_cast<std::uint64_t>(seed->as_integer()->get());
    }
    if (const toml::node* partial = top.get("partial"))
      out.partial = number(*partial, "partial", 0, 1);
    readLimits(top, out);
    readTasks(top, out);
    readShares(top, out);
    return out;
  }

 private:
  /// A text that is not empty.
  std::string text(const toml::node& node, const std::string& what) const {
    std::string out = string(node, what);
    if (out.empty()) throw InputError(where(node), what + ": an empty string, allowed: a text");
    return out;
  }

  double number(const toml::node& node, const std::string& what, double low, double high) const {
    const std::string allowed = std::isfinite(high)
                                    ? fmt::format("a number from {:g} to {:g}", low, high)
                                    : fmt::format("a number, {:g} or more", low);
    if (!node.is_number()) wrongType(node, what, allowed);
    const double x = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                                       : node.as_floating_point()->get();
    if (!(x >= low && x <= high && std::isfinite(x)))
      throw InputError(where(node), fmt::format("{}: read {:g}, allowed: {}", what, x, allowed));
    return x;
  }

  std::vector<std::pair<std::string, const toml::node*>> strings(const toml::table& table,
                                                                 const std::string& key) const {
    std::vector<std::pair<std::string, const toml::node*>> out;
    const toml::node* node = table.get(key);
    if (!node) return out;
    if (!node->is_array()) wrongType(*node, key, "an array of strings");
    for (const toml::node& one : *node->as_array()) out.emplace_back(text(one, key), &one);
    return out;
  }

  /// A file that is laid beside every submission: the lecturer's, or a helper that we ship.
  std::pair<std::string, std::string> beside(const std::string& name,
                                             const toml::node& node) const {
    fs::path file = folder_ / name;
    if (!fs::exists(file) && fs::path(name).filename() == name)
      file = scene::dataFolder() / "engines" / name;
    if (!fs::is_regular_file(file))
      throw InputError(where(node), fmt::format("files: there is no file {}, allowed: paths from "
                                                "the rubric's folder, and names in {}",
                                                (folder_ / name).string(),
                                                (scene::dataFolder() / "engines").string()));
    std::ifstream stream(file, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    if (!stream)
      throw InputError(where(node), fmt::format("files: {} cannot be read", file.string()));
    return {file.filename().string(), std::move(bytes)};
  }

  void readLimits(const toml::table& top, Rubric& out) const {
    constexpr double kDay = 86400, kMost = 1e6;
    out.limits.gigabytes = 1;
    out.limits.processes = 16;
    const toml::node* node = top.get("limits");
    if (!node) return;
    const toml::table& limits = asTable(*node, "limits");
    checkKeys(limits, "limits", {"seconds", "build_seconds", "memory", "processes", "disk"});
    const auto take = [&](const char* key, double& value, double low, double high) {
      if (const toml::node* one = limits.get(key))
        value = number(*one, std::string("limits: ") + key, low, high);
    };
    take("seconds", out.limits.seconds, 0.1, kDay);
    take("build_seconds", out.build_seconds, 0.1, kDay);
    take("memory", out.limits.gigabytes, 0.01, kMost);
    take("disk", out.disk, 0.001, kMost);
    if (const toml::node* one = limits.get("processes")) {
      const std::string allowed = "a whole number from 1 to 10000";
      if (!one->is_integer()) wrongType(*one, "limits: processes", allowed);
      const std::int64_t count = one->as_integer()->get();
      if (count < 1 || count > 10000)
        throw InputError(where(*one),
                         fmt::format("limits: processes: read {}, allowed: {}", count, allowed));
      out.limits.processes = static_cast<int>(count);
    }
  }

  void readTasks(const toml::table& top, Rubric& out) const {
    for (const toml::table* table : tables(top, "task")) {
      checkKeys(*table, "task", {"scene", "marks"});
      const toml::node& name = required(*table, "task", "scene", "the name of a scene, or a file");
      RubricTask task;
      task.scene = found(text(name, "scene"), name);
      for (const RubricTask& other : out.tasks)
        if (other.scene.name == task.scene.name)
          throw InputError(where(name), fmt::format("scene: '{}' is the scene of another task, "
                                                    "allowed: each once",
                                                    task.scene.name));
      const toml::node& node = required(*table, "task", "marks", "a table, such as M = 3");
      const toml::table& marks = asTable(node, "marks");
      std::vector<std::string_view> names;
      for (const Quantity quantity : kAllQuantities) names.emplace_back(crosscheck::name(quantity));
      names.emplace_back(kJacobian);
      checkKeys(marks, "marks", names);
      for (const std::string_view what : names)
        if (const toml::node* one = marks.get(what))
          task.marks.emplace_back(what, number(*one, fmt::format("marks: {}", what), 0,
                                               std::numeric_limits<double>::infinity()));
      if (task.marks.empty())
        throw InputError(where(node), "marks: is empty, allowed: at least one of " +
                                          fmt::format("{}", fmt::join(names, ", ")));
      out.tasks.push_back(std::move(task));
    }
    if (out.tasks.empty())
      throw InputError({file_, 0}, "rubric: has no [[task]], allowed: at least one");
    if (!(out.outOf() > 0))
      throw InputError({file_, 0}, "rubric: all marks are 0, allowed: at least one that is not");
  }

  scene::Scene found(const std::string& name, const toml::node& node) const {
    try {
      const fs::path beside_it = folder_ / name;
      return scene::findScene(fs::is_regular_file(beside_it) ? beside_it.string() : name);
    } catch (const InputError& error) {
      throw InputError(where(node), std::string("scene: ") + error.what());
    }
  }

  void readShares(const toml::table& top, Rubric& out) const {
    const toml::node* node = top.get("partial_by_rule");
    if (!node) return;
    const std::set<std::string> rules = rulesOf(out.tasks);
    for (const auto& [key, value] : asTable(*node, "partial_by_rule")) {
      const std::string rule(key.str());
      if (rules.count(rule) == 0)
        throw InputError(where(key.source()),
                         fmt::format("partial_by_rule: unknown key \"{}\", allowed: mistakes that "
                                     "can be made in these scenes: {}",
                                     rule, joined(rules)));
      out.partial_by_rule[rule] = number(value, "partial_by_rule: " + rule, 0, 1);
    }
  }

  fs::path folder_;
};

}  // namespace

double Rubric::outOf() const {
  double sum = 0;
  for (const RubricTask& task : tasks)
    for (const auto& [quantity, marks] : task.marks) sum += marks;
  return sum;
}

double Rubric::share(const std::string& rule) const {
  const auto at = partial_by_rule.find(rule);
  return at == partial_by_rule.end() ? partial : at->second;
}

std::string Rubric::runKey() const {
  nlohmann::ordered_json key = {{"command", command},
                                {"main", main},
                                {"build", build},
                                {"environment", environment},
                                {"seconds", {limits.seconds, build_seconds}},
                                {"gigabytes", {limits.gigabytes, disk}},
                                {"processes", limits.processes},
                                {"single", single},
                                {"seed", seed}};
  for (const fs::path& path : hide) key["hide"].push_back(path.string());
  for (const RubricTask& task : tasks) key["scenes"].push_back(scene::writeSceneToml(task.scene));
  std::string out = key.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (const auto& [name, bytes] : files)
    out += fmt::format("\n{} {}\n", name, bytes.size()) + bytes;
  return out;
}

Rubric readRubric(const fs::path& file) {
  const std::string text = scene::readTextFile(file, "a rubric (TOML)");
  return RubricReader(file).read(scene::parsedToml(scene::withoutMark(text), file.string()));
}

const char* exampleRubric() {
  return R"toml(# A rubric of dynwitness grade. A submission is a program that speaks the protocol of
# crosscheck/witnesses/engine_protocol.md: a file, or a folder.

# How it is started: a shell's words, in a folder of its own. {file} is the submission.
command = "python3 {file}"
# Of a submission that is a folder, the file that is started; without: the only file in it.
main = "my_arm.py"
# What is done once before, for instance
# build = "c++ -std=c++17 -O2 -o my_arm {file}"    # and then  command = "./my_arm # {file}"

# Laid beside each submission: paths from this file's folder, or helpers that dynwitness brings.
files = ["dynwitness_engine.py"]
# The variables of yours that it gets; HOME and TMPDIR are its own folder.
environment = ["PATH", "LANG"]
# What it must not see beside the other submissions (where the machine can hide anything):
# hide = ["solution"]

# Whose roundings are allowed: of double, or of float.
scalar = "double"
# Of the states that are asked; another one every year, if you like.
seed = 1
# The share of its marks that a wrong quantity keeps when a single mistake, which dynwitness can
# name, explains all wrong answers of the task to the last digits,
partial = 0.5

[limits]
seconds = 10          # for an answer
build_seconds = 60
memory = 1            # GB of address space, each process
processes = 16        # at a time
disk = 0.1            # GB

# and the same for some mistakes, by the rule that  dynwitness check --format json  calls them.
[partial_by_rule]
gravity_sign = 0.8
float_precision = 0.9

# A scene and its marks, of M, c, g, tau, qdd, kinetic, potential, momentum, reactions,
# jacobian; as many as you like.
[[task]]
scene = "double_pendulum"
[task.marks]
M = 3
c = 3
g = 2
tau = 2
)toml";
}

}  // namespace dynwitness::crosscheck
