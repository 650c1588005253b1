// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/json.hpp"

#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/report/ledger_report.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/verdicts/causes.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

void putText(Json* object, const char* key, const std::string& text) {
  if (!text.empty()) (*object)[key] = cleanText(text);
}

Json texts(const std::vector<std::string>& list) {
  Json array = Json::array();
  for (const std::string& text : list) array.push_back(cleanText(text));
  return array;
}

Json words(const std::vector<Road>& roads) {
  Json array = Json::array();
  for (const Road road : roads) array.push_back(name(road));
  return array;
}

void putVoided(Json* json, const CheckResult& check) {
  if (check.voided == 0) return;
  (*json)["voided"] = {{"states", check.voided}, {"first", check.first_voided}};
  if (check.excused > 0) (*json)["voided"]["excused"] = check.excused;
  putText(&(*json)["voided"], "reason", check.voided_reason);
}

Json toJson(const CheckResult::Off& off) {
  Json json{{"entry", cleanText(off.entry)}};
  putText(&json, "joint", off.joint);
  json["state"] = off.state;
  json["said"] = number(off.said);
  json["right"] = number(off.right);
  putText(&json, "unit", off.unit);
  return json;
}

Json toJson(const CheckResult& check) {
  Json json{{"check", cleanText(check.name())}};
  putText(&json, "statement", check.statement);
  json["quantity"] = cleanText(check.quantity);
  json["left"] = cleanText(check.left);
  putText(&json, "right", check.right);
  if (check.verdict != Verdict::kNotAnswerable) {
    json["states"] = check.states;
    putVoided(&json, check);
    json["unit"] = check.unitName();
    json["worst"] = number(check.worst);
    json["limit"] = number(check.limit);
    json["ratio"] = number(check.ratio);
    json["worst_state"] = check.worst_state;
    putText(&json, "worst_entry", check.worst_entry);
    if (const std::optional<double> room = check.limitOverSeen()) {
      json["seen"] = number(check.seen / check.ulp());
      json["loosest_limit"] = number(check.loosest / check.ulp());
      json["limit_over_seen"] = number(*room);
    }
    if (check.digits) json["digits"] = number(*check.digits);
    if (check.condition) json["condition"] = number(*check.condition);
    if (check.off) json["off"] = toJson(*check.off);
    if (!check.wrong_joints.empty()) json["wrong_joints"] = texts(check.wrong_joints);
    if (check.known_loss) json["known_loss"] = true;
    json["seed"] = check.seed;
  }
  putText(&json, "no_exact", check.no_exact);
  if (check.exact) {
    json["exact"] = {{"prime", check.exact->prime},
                     {"points", check.exact->points},
                     {"discarded", check.exact->discarded},
                     {"degree", number(check.exact->degree)},
                     {"error_probability", number(check.exact->error_probability)},
                     {"residual_zero", check.exact->residual_zero},
                     {"parameters", cleanText(check.exact->parameters)}};
  }
  json["verdict"] = name(check.verdict);
  if (check.verdict != Verdict::kAgree) putText(&json, "reason", check.reason);
  return json;
}

Json toJson(const Coverage& coverage) {
  Json json{{"quantity", cleanText(coverage.quantity)},
            {"comparisons", coverage.asked},
            {"not_answered", coverage.voided},
            {"excused", coverage.excused}};
  putText(&json, "reason", coverage.reason);
  return json;
}

Json toJson(const Control& control) {
  Json json{{"quantity", cleanText(control.quantity)}};
  if (control.size > 0) {
    json["size"] = number(control.size);
    json["found"] = words(control.found);
    json["missed"] = words(control.missed);
  }
  if (!control.blind.empty()) json["blind"] = texts(control.blind);
  putText(&json, "nothing", control.nothing);
  return json;
}

Json toJson(const DigitsResult& digits) {
  Json json{{"witness", cleanText(digits.witness)},
            {"quantity", cleanText(digits.quantity)},
            {"scalar", name(digits.scalar)},
            {"states", digits.states}};
  if (!digits.worst) return json;
  json["worst"] = number(*digits.worst);
  json["median"] = number(*digits.median);
  json["worst_single"] = number(*digits.worst_single);
  json["worst_state"] = digits.worst_state;
  json["worst_entry"] = cleanText(digits.worst_entry);
  return json;
}

Json toJson(const Finding& finding) {
  Json json{{"kind", name(finding.kind)},
            {"scene", cleanText(finding.scene)},
            {"quantity", cleanText(finding.quantity)}};
  putText(&json, "witness", finding.witness);
  if (finding.digits) json["digits"] = number(*finding.digits);
  json["text"] = cleanText(finding.text);
  return json;
}

Json toJson(const Cause& cause) {
  Json json = Json::object();
  putText(&json, "witness", cause.witness);
  json["wrong"] = texts(cause.wrong);
  json["following"] = texts(cause.following);
  json["right"] = texts(cause.right);
  json["joints"] = texts(cause.joints);
  if (cause.off != nullptr) json["off"] = toJson(*cause.off);
  json["checks"] = cause.checks.size();
  json["text"] = cleanText(cause.text);
  return json;
}

Json toJson(const Drift& drift) {
  Json json{{"method", cleanText(drift.method)},
            {"method_order", drift.method_order},
            {"duration", number(drift.duration)},
            {"scale", number(drift.scale)}};
  if (std::isfinite(drift.observed_order) && drift.observed_order > 0)
    json["observed_order"] = drift.observed_order;
  json["paths"] = Json::array();
  for (const Drift::Path& path : drift.paths)
    json["paths"].push_back({{"step", number(path.step)}, {"worst", number(path.worst)}});
  return json;
}

Json toJson(const PublishedMotion& motion) {
  Json json{{"title", cleanText(motion.title)}, {"source", cleanText(motion.source)}};
  putText(&json, "own", motion.own);
  putText(&json, "note", motion.note);
  putText(&json, "moved", motion.moved);
  json["method"] = cleanText(motion.method);
  json["step_error"] = number(motion.step_error);
  json["duration"] = number(motion.duration);
  if (!motion.failure.empty()) {
    putText(&json, "failure", motion.failure);
    return json;
  }
  json["steps"] = motion.steps;
  json["values"] = motion.values;
  json["ratio"] = number(motion.ratio);
  json["entries"] = Json::array();
  for (const PublishedMotion::Entry& entry : motion.entries)
    json["entries"].push_back({{"of", cleanText(entry.of)},
                               {"time", number(entry.time)},
                               {"published", number(entry.published)},
                               {"ours", number(entry.ours)},
                               {"difference", number(entry.difference)},
                               {"limit", number(entry.limit)},
                               {"digits", number(entry.digits)}});
  return json;
}

Json toJson(const SceneResult& scene) {
  Json json{{"name", cleanText(scene.name)}};
  putText(&json, "title", scene.title);
  putText(&json, "source", scene.source);
  putText(&json, "file", scene.file);
  json["dof"] = scene.dof;
  json["links"] = scene.links;
  if (!scene.not_modelled.empty()) json["not_modelled"] = texts(scene.not_modelled);
  if (scene.ledger) json["ledger"] = ledgerJson(*scene.ledger);
  json["checks"] = Json::array();
  for (const CheckResult& check : scene.checks) json["checks"].push_back(toJson(check));
  if (!scene.digits.empty()) {
    json["digits"] = Json::array();
    for (const DigitsResult& digits : scene.digits) json["digits"].push_back(toJson(digits));
  }
  if (!scene.findings.empty()) {
    json["findings"] = Json::array();
    for (const Finding& finding : scene.findings) json["findings"].push_back(toJson(finding));
  }
  if (const std::vector<Cause> causes = causesOf(scene); !causes.empty()) {
    json["causes"] = Json::array();
    for (const Cause& cause : causes) json["causes"].push_back(toJson(cause));
  }
  if (!scene.controls.empty()) {
    json["controls"] = Json::array();
    for (const Control& control : scene.controls) json["controls"].push_back(toJson(control));
  }
  if (scene.drift) json["drift"] = toJson(*scene.drift);
  if (!scene.motions.empty()) {
    json["motions"] = Json::array();
    for (const PublishedMotion& motion : scene.motions) json["motions"].push_back(toJson(motion));
  }
  return json;
}

Json toJson(const Environment& environment) {
  Json json = Json::object();
  putText(&json, "commit", environment.commit);
  putText(&json, "compiler", environment.compiler);
  putText(&json, "flags", environment.flags);
  putText(&json, "cpu", environment.cpu);
  putText(&json, "date", environment.date);
  json["libraries"] = Json::array();
  for (const Environment::Library& library : environment.libraries)
    json["libraries"].push_back(
        {{"name", cleanText(library.name)}, {"version", cleanText(library.version)}});
  return json;
}

}  // namespace

std::string checkJson(const CheckResult& check) {
  return toJson(check).dump();
}

std::string environmentJson(const Environment& environment) {
  return toJson(environment).dump();
}

std::string reportJson(const CrosscheckResult& result, const Environment& environment,
                       const std::string& speed, const std::string& pairs) {
  Json json{{"dynwitness", cleanText(environment.version)},
            {"headline", cleanText(result.headline())}};
  json["witnesses"] = Json::array();
  for (const WitnessInfo& witness : result.witnesses) {
    Json entry{{"name", cleanText(witness.name)}};
    putText(&entry, "version", witness.version);
    putText(&entry, "method", witness.method);
    putText(&entry, "conventions", witness.conventions);
    entry["present"] = witness.present;
    putText(&entry, "absent", witness.absent);
    json["witnesses"].push_back(entry);
  }
  json["seed"] = result.seed;
  json["states"] = result.states;
  json["command"] = cleanText(result.command);
  json["environment"] = toJson(environment);
  json["scenes"] = Json::array();
  for (const SceneResult& scene : result.scenes) json["scenes"].push_back(toJson(scene));
  if (!speed.empty()) json["speed"] = Json::parse(speed);
  if (!pairs.empty()) json["pairs"] = Json::parse(pairs);
  json["coverage"] = Json::array();
  for (const Coverage& coverage : result.coverage()) json["coverage"].push_back(toJson(coverage));
  json["control"] = cleanText(result.controlLine());
  json["verdict"] = name(result.verdict());
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

/// The run's own control and its coverage as test cases: what makes the verdict no agreement is a
/// failure.
std::string ownSuite(const CrosscheckResult& result) {
  const std::vector<std::string> thin = result.thinlyCovered();
  std::string list;
  for (const std::string& one : thin) list += (list.empty() ? "" : ", ") + one;
  const auto testCase = [](const char* what, bool failed, const std::string& text) {
    return fmt::format(
        "    <testcase classname=\"dynwitness.run\" name=\"{}\">{}</testcase>\n", what,
        failed ? fmt::format("<failure type=\"{0}\" message=\"{1}\"/>", what, escapeMarkup(text))
               : fmt::format("<system-out>{}</system-out>", escapeMarkup(text)));
  };
  return fmt::format(
      "  <testsuite name=\"the run itself\" tests=\"2\" failures=\"{}\" errors=\"0\" "
      "skipped=\"0\">\n{}{}  </testsuite>\n",
      (result.controlMissed() ? 1 : 0) + (thin.empty() ? 0 : 1),
      testCase("control", result.controlMissed(), result.controlLine()),
      testCase("coverage", !thin.empty(),
               thin.empty() ? "no quantity lacks more than a tenth of its comparisons"
                            : "more than a tenth is missing: " + list));
}

}  // namespace

std::string reportJUnit(const CrosscheckResult& result, const Environment& environment) {
  int tests = 2;
  for (const SceneResult& scene : result.scenes) tests += static_cast<int>(scene.checks.size());
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuites name=\"dynwitness crosscheck\" tests=\"{}\" failures=\"{}\" errors=\"0\" "
      "skipped=\"{}\">\n",
      tests,
      result.count(Verdict::kDisagree) + (result.controlMissed() ? 1 : 0) +
          (result.thinlyCovered().empty() ? 0 : 1),
      result.count(Verdict::kNotAnswerable));
  xml += ownSuite(result);
  const auto out = std::back_inserter(xml);
  for (const SceneResult& scene : result.scenes) {
    int failures = 0, skipped = 0;
    for (const CheckResult& check : scene.checks) {
      failures += check.verdict == Verdict::kDisagree ? 1 : 0;
      skipped += check.verdict == Verdict::kNotAnswerable ? 1 : 0;
    }
    // JUnit's timestamps carry no zone letter
    std::string date = environment.date;
    if (!date.empty() && date.back() == 'Z') date.pop_back();
    fmt::format_to(out,
                   "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" "
                   "skipped=\"{}\" timestamp=\"{}\">\n",
                   escapeMarkup(scene.name), scene.checks.size(), failures, skipped,
                   escapeMarkup(date));
    std::map<std::string, int> seen;  // CI systems join test cases of one name
    for (const CheckResult& check : scene.checks) {
      std::string title = describe(check);
      if (const int k = ++seen[title]; k > 1) title += fmt::format(" #{}", k);
      fmt::format_to(out, "    <testcase classname=\"dynwitness.{}\" name=\"{}\"",
                     escapeMarkup(scene.name), escapeMarkup(title));
      switch (check.verdict) {
        case Verdict::kAgree:
          if (check.voided > 0)
            fmt::format_to(out, "><system-out>{}</system-out></testcase>\n",
                           escapeMarkup(voidedText(check)));
          else
            fmt::format_to(out, "/>\n");
          break;
        case Verdict::kDisagree:
          fmt::format_to(
              out,
              "><failure type=\"disagree\" message=\"{}\">{}\nworst {}, limit {} [{}] "
              "(ratio {}) at {}, state {} of seed {}</failure></testcase>\n",
              escapeMarkup(check.reason.empty() ? "the witnesses disagree" : check.reason),
              escapeMarkup(check.statement), readable(check.worst), readable(check.limit),
              escapeMarkup(check.unitName()), readable(check.ratio),
              escapeMarkup(check.worst_entry), check.worst_state, check.seed);
          break;
        case Verdict::kNotAnswerable:
          fmt::format_to(out, "><skipped message=\"{}\"/></testcase>\n",
                         escapeMarkup(check.reason));
          break;
      }
    }
    fmt::format_to(out, "  </testsuite>\n");
  }
  return xml + "</testsuites>\n";
}

}  // namespace dynwitness::crosscheck
