// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/check_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using Judged = QuantityFound::Verdict;
constexpr std::size_t kMostTold = 6;  ///< findings on a terminal

std::string joined(const std::vector<std::string>& words, const char* between = ", ") {
  return fmt::format("{}", fmt::join(words, between));
}

std::vector<std::string> labels(const Examination& e, const std::vector<int>& rates) {
  std::vector<std::string> out;
  for (const int rate : rates)
    out.push_back("'" + e.rate_labels[static_cast<std::size_t>(rate)] + "'");
  return out;
}

std::string lineOf(const QuantityFound& q) {
  std::string out = fmt::format("  {:<10} {:<11}", q.name, name(q.verdict));
  if (q.verdict == Judged::kCannotSay) return out + q.reason + "\n";
  if (q.digits)
    out += fmt::format("{:4.1f} digits of {:<9.3g}", *q.digits, q.largest);
  else
    out += fmt::format("{:24}", "all zero");
  out += fmt::format("  error {:.3g} ulp, limit {:.3g} ulp", q.seen, q.limit);
  if (q.verdict == Judged::kWrong) out += fmt::format(" at {}, state {}", q.entry, q.state);
  return out + "\n";
}

/// What it believes the links to be: the first thing to read, since it explains what follows.
std::string modelText(const ModelExamined& model) {
  if (!model.is_told) return "";
  if (model.differences.empty())
    return fmt::format("  {:<10} {:<11}its links are the scene's\n", "model", name(Judged::kRight));
  std::string out;
  for (std::size_t k = 0; k < model.differences.size() && k < kMostTold; ++k)
    out += fmt::format("  {:<10} {:<11}{}\n", k == 0 ? "model" : "",
                       k == 0 ? name(Judged::kWrong) : "", sentenceOf(model.differences[k]));
  if (model.differences.size() > kMostTold)
    out += fmt::format("  {:<22}and {} more: --format json\n", "",
                       model.differences.size() - kMostTold);
  return out;
}

/// Whether quantities of states are wrong, and not the links or the Jacobian alone.
bool hasWrongQuantity(const Examination& e) {
  return std::any_of(e.quantities.begin(), e.quantities.end(), [](const QuantityFound& q) {
    return q.verdict == Judged::kWrong && !q.is_jacobian;
  });
}

std::string jacobianText(const Examination& e) {
  const auto found = std::find_if(e.quantities.begin(), e.quantities.end(),
                                  [](const QuantityFound& q) { return q.is_jacobian; });
  if (found == e.quantities.end() || found->verdict != Judged::kWrong) return "";
  return fmt::format("  jacobian of {}: {}\n", e.frame,
                     e.jacobian_reading.empty()
                         ? std::string("nothing on record explains it")
                         : "explained exactly by: it is that " + e.jacobian_reading);
}

std::string diagnosisText(const Examination& e) {
  if (!hasWrongQuantity(e)) {
    const std::string why = jacobianText(e);
    return why.empty() ? "" : "\nwhy\n" + why;
  }
  std::string out = "\nwhere\n  " + joined(e.where.terms) + "\n";
  if (!e.where.rates.empty()) {
    std::vector<int> right;
    for (int i = 0; i < static_cast<int>(e.rate_labels.size()); ++i)
      if (std::count(e.where.rates.begin(), e.where.rates.end(), i) == 0) right.push_back(i);
    out += "  wrong at " + joined(labels(e, e.where.rates));
    out += right.empty() ? "\n" : "; right at " + joined(labels(e, right)) + "\n";
  }
  for (const std::string& sentence : e.where.growth) out += "  " + sentence + "\n";

  out += "\nwhy\n" + jacobianText(e);
  if (!e.model.differences.empty())
    out += "  its model differs from the scene (above), which may be all of it\n";
  if (e.isExplained()) {
    const CheckFinding& best = e.findings.front();
    out += fmt::format(
        "  explained exactly by: {} (residual {:.1g}: {:.2g} of what rounding may leave)\n",
        sentenceOf(best), best.residual_relative, best.residual);
    if (!best.spared.empty())
      out += "    but for " + joined(best.spared) +
             ", which it would have made wrong and which is right\n";
    if (!best.unasked.empty()) out += "    this leaves unexplained: " + joined(best.unasked) + "\n";
    for (const bool is_first : {true, false}) {
      std::vector<std::string> lines;
      for (std::size_t k = 1; k < e.findings.size(); ++k)
        if (e.findings[k].is_first == is_first)
          lines.push_back(fmt::format("    {}. {} (residual {:.1g})\n", k + 1,
                                      sentenceOf(e.findings[k]), e.findings[k].residual_relative));
      if (lines.empty()) continue;
      out += is_first ? "  no answer at any state tells it from\n"
                      : "  at the states that were asked it cannot be told from\n";
      for (std::size_t k = 0; k < lines.size() && k < kMostTold; ++k) out += lines[k];
      if (lines.size() > kMostTold)
        out += fmt::format("    and {} more: --format json\n", lines.size() - kMostTold);
    }
  } else {
    out +=
        e.tried == 0
            ? "  it is so near to its limit that no mistake is needed to explain it: no cause told"
            : fmt::format("  nothing on record explains it: {} mistakes tried", e.tried);
    if (e.pairs > 0) out += fmt::format(", and {} of {} pairs of them", e.pairs_tried, e.pairs);
    out += "\n";
    for (const CheckFinding& f : e.findings)
      out += fmt::format("    nearest: {}: {:.3g} of the misfit would be left\n", sentenceOf(f),
                         f.left);
  }
  if (e.smallest) {
    const Smallest& s = *e.smallest;
    const auto values = [](const std::vector<double>& v) {
      std::vector<std::string> words;
      for (const double x : v) words.push_back(fmt::format("{:.17g}", x));
      return "[" + joined(words) + "]";
    };
    out += fmt::format("\nthe smallest question that is answered wrongly: {} of {} link{}{}\n",
                       name(s.quantity), s.scene.mechanism.links.size() - 1,
                       s.scene.mechanism.links.size() == 2 ? "" : "s",
                       s.cut.empty() ? "" : ", cut off: " + joined(s.cut));
    out += "  q = " + values(s.q) + "\n";
    if (s.quantity != Quantity::kM && s.quantity != Quantity::kg &&
        s.quantity != Quantity::kPotential)
      out += "  qd = " + values(s.qd) + "\n";
    if (!s.qdd.empty()) out += "  qdd = " + values(s.qdd) + "\n";
    if (!s.tau.empty()) out += "  tau = " + values(s.tau) + "\n";
    if (!s.joints.empty()) out += "  all other joints than " + joined(s.joints) + " at rest\n";
  }
  return out;
}

}  // namespace

namespace {

/// Quantities that were asked and of which nothing can be said, though there is something to say.
std::vector<std::string> notAnswered(const Examination& e) {
  std::vector<std::string> out;
  for (const QuantityFound& q : e.quantities)
    if (q.verdict == Judged::kCannotSay && !q.reason.empty()) out.push_back(q.name);
  return out;
}

/// The last line: a verdict, and of what, unless of all.
std::string headlineOf(const Examination& e) {
  if (e.isWrong()) return "WRONG";
  const std::vector<std::string> left = notAnswered(e);
  if (left.empty()) return "right";
  std::vector<std::string> judged;
  if (e.model.is_told) judged.push_back("its links");
  for (const QuantityFound& q : e.quantities)
    if (q.verdict == Judged::kRight) judged.push_back(q.name);
  return fmt::format("right in {}; not answered: {}", listed(judged), joined(left));
}

Json modelJson(const ModelExamined& model) {
  Json differences = Json::array();
  for (const ModelDifference& d : model.differences) {
    Json one = {{"link", d.link}};
    if (!d.parameter.empty()) {
      one["parameter"] = d.parameter;
      one["said"] = d.said;
    }
    one["scene"] = d.scene;
    one["unit"] = d.unit;
    one["sentence"] = sentenceOf(d);
    differences.push_back(one);
  }
  return {{"verdict", name(model.differences.empty() ? Judged::kRight : Judged::kWrong)},
          {"differences", differences}};
}

}  // namespace

std::string sentenceOf(const CheckFinding& finding) {
  std::vector<std::string> parts;
  for (const Explanation& part : finding.parts) parts.push_back(part.sentence);
  return joined(parts, " AND ");
}

std::string checkText(const Examination& e) {
  std::string out = fmt::format("{} by {} {}, limits of {} precision, {} states\n", e.scene,
                                e.engine, e.version == "unknown" ? "(version not told)" : e.version,
                                e.single ? "single" : "double", e.states);
  for (const std::string& remark : e.remarks) out += "  " + remark + "\n";
  if (!e.failure.empty()) return out + "FAILED: " + e.failure + "\n";
  out +=
      "  digits: the fewest that are right, counted in the quantity's largest entry (\"of\"); ulp: a "
      "unit of its last place\n";
  out += fmt::format("  {:<10} {:<11}right digits of largest  error, and what rounding may leave\n",
                     "quantity", "verdict");
  out += modelText(e.model);
  for (const QuantityFound& q : e.quantities) out += lineOf(q);
  if (e.isWrong()) out += diagnosisText(e);
  out += "\n" + headlineOf(e) + "\n";
  return out;
}

std::string checkJson(const Examination& e, const std::string& version) {
  Json quantities = Json::array(), findings = Json::array();
  for (const QuantityFound& q : e.quantities) {
    Json one = {{"quantity", q.name}, {"verdict", name(q.verdict)}};
    if (!q.reason.empty()) one["reason"] = q.reason;
    if (q.states > 0) {
      one["states"] = q.states;
      if (q.digits) one["digits"] = *q.digits;
      one["error_ulp"] = q.seen;
      one["limit_ulp"] = q.limit;
      one["largest"] = q.largest;
    }
    if (q.verdict == Judged::kWrong) {
      one["entry"] = q.entry;
      one["state"] = q.state;
      one["rates"] = Json::array();
      for (const int rate : q.rates)
        one["rates"].push_back(e.rate_labels[static_cast<std::size_t>(rate)]);
    }
    quantities.push_back(one);
  }
  const auto put = [&](Json& to, const Explanation& part) {
    to["rule"] = part.rule;
    if (part.link >= 0)
      to[part.at_joint ? "joint" : "link"] =
          (part.at_joint ? e.joint_names : e.link_names)[static_cast<std::size_t>(part.link)];
    for (const Estimate& x : part.estimates) {
      Json one = {{"name", x.name}, {"unit", x.unit}, {"value", x.value}, {"scene", x.scene}};
      if (std::isfinite(x.uncertainty)) one["uncertainty"] = x.uncertainty;
      to["estimates"].push_back(one);
    }
  };
  for (const CheckFinding& f : e.findings) {
    Json one = Json::object();
    put(one, f.parts.front());
    for (std::size_t k = 1; k < f.parts.size(); ++k) {
      Json part = Json::object();
      put(part, f.parts[k]);
      one["with"].push_back(part);
    }
    one["explains"] = f.explains;
    one["sentence"] = sentenceOf(f);
    if (f.explains) {
      one["residual_ulp"] = f.residual_ulp;
      one["residual_of_limit"] = f.residual;
      one["residual"] = f.residual_relative;
    } else {
      one["left"] = f.left;
    }
    if (f.is_first) one["same_as_first"] = true;
    if (!f.spared.empty()) one["spared"] = f.spared;
    if (!f.unasked.empty()) one["unexplained"] = f.unasked;
    findings.push_back(one);
  }
  Json out = {{"dynwitness", version},
              {"scene", e.scene},
              {"engine", e.engine},
              {"engine_version", e.version},
              {"scalar", e.single ? "float" : "double"},
              {"seed", e.seed},
              {"states", e.states},
              {"verdict", e.isWrong() ? "wrong" : "right"},
              {"not_answered", notAnswered(e)}};
  if (!e.failure.empty()) out["failure"] = e.failure;
  out["remarks"] = e.remarks;
  if (e.model.is_told) out["model"] = modelJson(e.model);
  if (!e.frame.empty()) out["frame"] = e.frame;
  if (!e.jacobian_reading.empty()) out["jacobian_reading"] = e.jacobian_reading;
  out["quantities"] = quantities;
  if (e.isWrong() && e.failure.empty()) {
    out["where"] = {{"terms", e.where.terms}, {"growth", e.where.growth}, {"rates", Json::array()}};
    for (const int rate : e.where.rates)
      out["where"]["rates"].push_back(e.rate_labels[static_cast<std::size_t>(rate)]);
  }
  out["explained"] = e.isExplained();
  out["findings"] = findings;
  out["tried"] = {{"mistakes", e.tried}, {"pairs", e.pairs_tried}, {"pairs_in_all", e.pairs}};
  if (e.smallest) {
    const Smallest& s = *e.smallest;
    out["smallest"] = {{"quantity", name(s.quantity)},
                       {"cut", s.cut},
                       {"joints", s.joints},
                       {"q", s.q},
                       {"qd", s.qd}};
    if (!s.qdd.empty()) out["smallest"]["qdd"] = s.qdd;
    if (!s.tau.empty()) out["smallest"]["tau"] = s.tau;
    out["smallest"]["scene"] = scene::writeSceneToml(s.scene);
  }
  return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynwitness::crosscheck
