// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/json.hpp"
#include "crosscheck/report/text.hpp"
#include "scene/error.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kAtLeast = "at least", *kAtMost = "at most";

/// Four digits: ratios of times have no more.
double rounded(double x) {
  return std::strtod(fmt::format("{:.4g}", x).c_str(), nullptr);
}

/// A place in the file, as "/measured/3/value", and what is wrong there.
struct Misfit : std::runtime_error {
  Misfit(const std::string& place, const std::string& what)
      : std::runtime_error((place.empty() ? "" : place + ": ") + what) {}
};

/// Fields of an object, each of the type that is asked for.
class Fields {
 public:
  Fields(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
    if (!json.is_object()) throw Misfit(place_, "expected an object, got " + shown(json));
  }

  const Json& field(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) throw Misfit(place_, fmt::format("there is no field '{}'", key));
    return *found;
  }
  bool has(const char* key) const { return json_.contains(key); }
  std::string text(const char* key) const {
    const Json& value = field(key);
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
      throw Misfit(at(key), "expected a text, got " + shown(value));
    return value;
  }
  std::string textOrNone(const char* key) const { return has(key) ? text(key) : std::string(); }
  double number(const char* key) const {
    const Json& value = field(key);
    if (!value.is_number() || !(value.get<double>() >= 0))
      throw Misfit(at(key), "expected a number that is not negative, got " + shown(value));
    return value;
  }
  std::uint64_t count(const char* key) const {
    const Json& value = field(key);
    if (!value.is_number_unsigned()) throw Misfit(at(key), "expected a count, got " + shown(value));
    return value;
  }
  bool truth(const char* key) const {
    const Json& value = field(key);
    if (!value.is_boolean()) throw Misfit(at(key), "expected true or false, got " + shown(value));
    return value;
  }
  template <typename Use>
  void forEach(const char* key, const Use& use) const {
    const Json& list = field(key);
    if (!list.is_array()) throw Misfit(at(key), "expected a list, got " + shown(list));
    for (std::size_t i = 0; i < list.size(); ++i) use(list[i], fmt::format("{}/{}", at(key), i));
  }
  std::string at(const char* key) const { return place_ + "/" + key; }

  static std::string shown(const Json& value) {
    std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    return text;
  }

 private:
  const Json& json_;
  std::string place_;
};

Environment readEnvironment(const Fields& file) {
  const Fields fields(file.field("environment"), "/environment");
  Environment e;
  e.version = file.text("dynwitness");
  e.commit = fields.textOrNone("commit");
  e.compiler = fields.textOrNone("compiler");
  e.flags = fields.textOrNone("flags");
  e.cpu = fields.textOrNone("cpu");
  e.date = fields.textOrNone("date");
  fields.forEach("libraries", [&](const Json& json, const std::string& place) {
    const Fields library(json, place);
    e.libraries.push_back({library.text("name"), library.text("version")});
  });
  return e;
}

BenchResult resultOf(const Json& json) {
  const Fields file(json, "");
  BenchResult result;
  file.field("measured");  // the first word that no other file of ours has
  result.environment = readEnvironment(file);
  result.processors = static_cast<int>(file.count("processors"));
  result.load = file.number("load");
  result.states = static_cast<int>(file.count("states"));
  result.seed = file.count("seed");
  result.repetitions = static_cast<int>(file.count("repetitions"));
  file.forEach("contenders", [&](const Json& entry, const std::string& place) {
    const Fields fields(entry, place);
    result.contenders.push_back({fields.text("name"), fields.text("label"), fields.truth("ours")});
  });
  file.forEach("measured", [&](const Json& entry, const std::string& place) {
    const Fields fields(entry, place);
    result.measured.push_back({fields.text("what"), fields.text("subject"), fields.text("by"),
                               fields.text("unit"), fields.number("value")});
    if (result.measured.back().unit == "ns" && !(result.measured.back().value > 0))
      throw Misfit(fields.at("value"), "expected a time above 0 ns");
  });
  file.forEach("goals", [&](const Json& entry, const std::string& place) {
    const Fields fields(entry, place);
    const std::string sense = fields.text("sense");
    if (sense != kAtLeast && sense != kAtMost)
      throw Misfit(fields.at("sense"),
                   fmt::format("read '{}', allowed are '{}' and '{}'", sense, kAtLeast, kAtMost));
    Goal goal{static_cast<int>(fields.count("goal")),
              fields.text("what"),
              fields.text("subject"),
              fields.text("by"),
              fields.text("unit"),
              fields.number("wanted"),
              sense == kAtLeast};
    if (!(goal.wanted > 0)) throw Misfit(fields.at("wanted"), "expected a number above 0");
    result.goals.push_back(goal);
  });
  if (file.has("left_out"))
    file.forEach("left_out", [&](const Json& entry, const std::string& place) {
      if (!entry.is_string()) throw Misfit(place, "expected a text, got " + Fields::shown(entry));
      result.left_out.push_back(entry);
    });
  return result;
}

/// What a file says must be what its measurements say: rewritten it is the same file.
void requireConsistent(const Json& read, const BenchResult& result) {
  const auto said = nlohmann::json::parse(read.dump());
  const auto follows = nlohmann::json::parse(benchJson(result));
  const auto difference = nlohmann::json::diff(said, follows);
  if (difference.empty()) return;
  const auto& first = difference.front();
  const std::string place = first.at("path"), operation = first.at("op");
  if (operation == "remove") throw Misfit(place, "no such field is expected");
  const std::string expected = Fields::shown(Json::parse(first.at("value").dump()));
  if (operation == "add")
    throw Misfit(place, "is not there; by the measurements it is " + expected);
  throw Misfit(
      place,
      fmt::format("read {}, by the measurements it is {}",
                  Fields::shown(Json::parse(said.at(nlohmann::json::json_pointer(place)).dump())),
                  expected));
}

}  // namespace

bool Measurement::isTime() const {
  return unit == "ns" && std::find(std::begin(kTimed), std::end(kTimed), what) != std::end(kTimed);
}
bool Measurement::isStep() const {
  return unit == "ns" && std::find(std::begin(kSteps), std::end(kSteps), what) != std::end(kSteps);
}

std::optional<double> BenchResult::value(const std::string& what, const std::string& subject,
                                         const std::string& by, const std::string& unit) const {
  for (const Measurement& m : measured)
    if (m.what == what && m.subject == subject && m.by == by && m.unit == unit) return m.value;
  return std::nullopt;
}

std::optional<double> BenchResult::timesFaster(const std::string& engine, const std::string& what,
                                               const std::string& subject,
                                               const std::string& by) const {
  const auto its = value(what, subject, engine, "ns"), ours = value(what, subject, by, "ns");
  if (!its || !ours) return std::nullopt;
  return *its / *ours;
}

std::optional<double> BenchResult::timesFasterThanEngines(const std::string& what,
                                                          const std::string& subject,
                                                          const std::string& by) const {
  std::optional<double> least;
  for (const Contender& c : contenders) {
    if (c.is_ours) continue;
    const auto times = timesFaster(c.name, what, subject, by);
    if (times && !(least && *least <= *times)) least = times;
  }
  return least;
}

std::string BenchResult::label(const std::string& contender) const {
  for (const Contender& c : contenders)
    if (c.name == contender) return c.label;
  return contender;
}

const char* GoalVerdict::word() const {
  return !measured ? "not measured" : is_reached ? "reached" : "missed";
}

GoalVerdict judge(const BenchResult& result, const Goal& goal) {
  GoalVerdict verdict;
  if (goal.unit == kTimesMujoco) {
    verdict.measured = result.timesFaster(kRawMujoco, goal.what, goal.subject, goal.by);
    verdict.times_simbody = result.timesFaster(kRawSimbody, goal.what, goal.subject, goal.by);
  } else if (goal.unit == kTimesBest) {
    verdict.measured = result.timesFasterThanEngines(goal.what, goal.subject, goal.by);
    verdict.times_simbody = result.timesFaster(kRawSimbody, goal.what, goal.subject, goal.by);
  } else {
    verdict.measured = result.value(goal.what, goal.subject, goal.by, goal.unit);
  }
  if (!verdict.measured) return verdict;
  verdict.limit = limitOf(result, goal.what, goal.subject, goal.by);
  // how much it costs, in units of what the goal grants
  const double cost =
      goal.at_least ? goal.wanted / *verdict.measured : *verdict.measured / goal.wanted;
  verdict.is_reached = cost <= 1;
  if (!verdict.is_reached) verdict.missed_by = 100 * (cost - 1);
  return verdict;
}

std::string benchJson(const BenchResult& result) {
  Json json{{"dynwitness", cleanText(result.environment.version)}};
  json["environment"] = Json::parse(environmentJson(result.environment));
  json["processors"] = result.processors;
  json["load"] = result.load;
  json["states"] = result.states;
  json["seed"] = result.seed;
  json["repetitions"] = result.repetitions;
  json["contenders"] = Json::array();
  for (const Contender& c : result.contenders)
    json["contenders"].push_back(
        {{"name", cleanText(c.name)}, {"label", cleanText(c.label)}, {"ours", c.is_ours}});
  json["measured"] = Json::array();
  for (const Measurement& m : result.measured) {
    Json entry{{"what", cleanText(m.what)},
               {"subject", cleanText(m.subject)},
               {"by", cleanText(m.by)},
               {"unit", cleanText(m.unit)},
               {"value", m.value}};
    if (m.unit == "ns") {
      if (const auto times = result.timesFaster(kRawMujoco, m.what, m.subject, m.by))
        entry["times_mujoco"] = rounded(*times);
      if (const auto times = result.timesFaster(kRawSimbody, m.what, m.subject, m.by))
        entry["times_simbody"] = rounded(*times);
    }
    json["measured"].push_back(entry);
  }
  json["goals"] = Json::array();
  for (const Goal& goal : result.goals) {
    const GoalVerdict verdict = judge(result, goal);
    Json entry{{"goal", goal.number},
               {"what", cleanText(goal.what)},
               {"subject", cleanText(goal.subject)},
               {"by", cleanText(goal.by)},
               {"sense", goal.at_least ? kAtLeast : kAtMost},
               {"wanted", goal.wanted},
               {"unit", cleanText(goal.unit)}};
    if (verdict.measured) entry["measured"] = rounded(*verdict.measured);
    if (verdict.times_simbody) entry["times_simbody"] = rounded(*verdict.times_simbody);
    if (verdict.limit) {
      entry["limit_ns"] = rounded(verdict.limit->ns);
      entry["limit_of"] = verdict.limit->of;
      entry["times_limit"] = rounded(verdict.limit->times);
    }
    entry["verdict"] = verdict.word();
    if (verdict.measured && !verdict.is_reached)
      entry["missed_by_percent"] = rounded(verdict.missed_by);
    json["goals"].push_back(entry);
  }
  if (!result.left_out.empty()) {
    json["left_out"] = Json::array();
    for (const std::string& text : result.left_out) json["left_out"].push_back(cleanText(text));
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

BenchResult readBench(const std::filesystem::path& file) {
  const std::string text = scene::readTextFile(file, "a file that `dynwitness bench` wrote");
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + std::min(error.byte, text.size());
    throw scene::InputError(
        {file.string(), 1 + static_cast<int>(std::count(text.begin(), end, '\n'))},
        "is not JSON; expected a file that `dynwitness bench` wrote");
  }
  try {
    const BenchResult result = resultOf(json);
    requireConsistent(json, result);
    return result;
  } catch (const Misfit& misfit) {
    throw scene::InputError(
        {file.string()},
        fmt::format("{}; expected a file that `dynwitness bench` wrote", misfit.what()));
  }
}

}  // namespace dynwitness::crosscheck
