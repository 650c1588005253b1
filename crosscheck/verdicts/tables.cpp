// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/motion/pendulum_period.hpp"
#include "crosscheck/verdicts/check_reading.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"

namespace dynwitness::crosscheck {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double kUnitRoundoff = RunningError::kUnitRoundoff;

json readTable(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw scene::InputError({file.string()}, "cannot be read");
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    throw scene::InputError({file.string()}, error.what());
  }
}

/// A number of a table: JSON number, expression text, or sqrt(expression).
double number(const json& value, const fs::path& file) {
  if (value.is_number()) return value.get<double>();
  const std::string text = value.get<std::string>();
  const scene::SourceLocation where{file.string()};
  if (text.rfind("sqrt(", 0) == 0 && text.back() == ')')
    return std::sqrt(number(text.substr(5, text.size() - 6), file));
  return scene::exactValue(scene::Expression::parse(text, where), {}, where).toDouble();
}

std::vector<double> numbers(const json& value, const fs::path& file) {
  std::vector<double> out;
  for (const json& entry : value) out.push_back(number(entry, file));
  return out;
}

/// The text of printed entry (i, j): M is an array of rows, everything else an array.
std::string printedText(const json& printed, int i, int j) {
  const json& entry = printed.at(i).is_array() ? printed.at(i).at(j) : printed.at(i);
  return entry.get<std::string>();
}

/// Places after the decimal point of a printed number, counting a power of ten: "1.5e-3" has 4.
int placesOf(const std::string& text) {
  const std::size_t exponent_at = text.find_first_of("eE");
  const std::string digits = text.substr(0, exponent_at);
  const std::size_t point = digits.find('.');
  const int places = point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
  return exponent_at == std::string::npos ? places
                                          : places - std::stoi(text.substr(exponent_at + 1));
}

/// A part of a table that must be there and must not be empty.
const json& entry(const json& object, const char* key, const fs::path& file) {
  if (!object.contains(key) || object[key].empty())
    throw scene::InputError({file.string()}, fmt::format("'{}' is missing or empty", key));
  return object[key];
}

/// How far a computed value may be from a printed one, and what that limit is counted in.
struct Limit {
  double distance;
  double size;  ///< of the unit
  Unit unit;
};

class Agreement {
 public:
  Agreement(const json& table, const json& one_case, const std::string& quantity,
            const fs::path& file)
      : quantity_(quantity) {
    if (table.contains("accuracy") && table["accuracy"].contains(quantity))
      accuracy_ = number(table["accuracy"][quantity], file);
    computed_ = one_case.value("computed_digits", table.value("computed_digits", false));
    if (one_case.contains("digits") && one_case["digits"].contains(quantity))
      places_ = one_case["digits"][quantity].get<int>();
    if (one_case.contains("significant") && one_case["significant"].contains(quantity))
      significant_ = one_case["significant"][quantity].get<int>();
    units_ = one_case.value("truncated", false) ? 1.0 : 0.5;
  }

  /// @param rounding  bound of what a program in double may lose on this entry
  Limit limit(const std::string& text, double printed, double rounding) const {
    if (accuracy_ > 0) return {accuracy_, accuracy_, Unit::kStatedAccuracy};
    // all bits of a double: "4" is no number with one digit then
    if (computed_ && places_ < 0 && significant_ == 0)
      return {rounding, rounding, Unit::kSourceRounding};
    int places = placesOf(text);
    if (places_ >= 0) places = places_;
    if (significant_ > 0) {
      if (printed == 0) return {rounding, rounding, Unit::kSourceRounding};
      places = significant_ - 1 - static_cast<int>(std::floor(std::log10(std::abs(printed))));
    }
    const double place = std::pow(10.0, -places), printing = units_ * place;
    if (computed_) return {rounding + printing, rounding + printing, Unit::kSourceRounding};
    return {printing, place, Unit::kPrintedDigit};
  }

 private:
  std::string quantity_;
  double accuracy_ = 0, units_ = 0.5;
  bool computed_ = false;
  int places_ = -1, significant_ = 0;
};

/// One case of a table as a state in the scene's coordinates.
struct Case {
  scene::State<double> state;
  std::vector<double> scale;  ///< q here = scale * q there
};

Case readCase(const json& table, const json& one_case, const scene::Mechanism& mechanism,
              const fs::path& file) {
  const int n = mechanism.dof();
  if (mechanism.positions() != n)
    throw scene::InputError({file.string()},
                            "the scene has spherical or floating joints, or joints that follow "
                            "others, allowed in tables: joints "
                            "whose qd are derivatives of q");
  Case out;
  out.scale = table.contains("coordinate_scale") ? numbers(table["coordinate_scale"], file)
                                                 : std::vector<double>(n, 1.0);
  const auto read = [&](const char* key) {
    std::vector<double> v =
        one_case.contains(key) ? numbers(one_case[key], file) : std::vector<double>(n, 0.0);
    if (static_cast<int>(v.size()) != n || static_cast<int>(out.scale.size()) != n)
      throw scene::InputError({file.string()},
                              fmt::format("case '{}': {} has {} numbers, the scene has {} joints",
                                          one_case.value("name", ""), key, v.size(), n));
    return v;
  };
  const std::vector<double> q = read("q");
  out.state.qd = read("qd");
  out.state.qdd = read("qdd");
  out.state.tau = read("tau");
  for (int i = 0; i < n; ++i) {
    out.state.x.push_back(scene::jointPosition(out.scale[i] * q[i]));
    out.state.qd[i] *= out.scale[i];
    out.state.qdd[i] *= out.scale[i];
    out.state.tau[i] /= out.scale[i];
  }
  return out;
}

/// The state with what reading it may have moved: an expression, its scale and their product are
/// rounded once each.
scene::State<RunningError> asRead(const scene::State<double>& state) {
  const auto read = [](double x) { return RunningError(x, 3 * kUnitRoundoff * std::abs(x)); };
  scene::State<RunningError> out;
  for (const scene::JointPosition<double>& x : state.x) {
    const RunningError q = read(x.q);
    const scene::JointPosition<RunningError> at = runningErrorPosition(x.q);
    // |cos'| <= 1 and |sin'| <= 1
    out.x.push_back({q, RunningError(at.c.value(), at.c.bound() + q.bound()),
                     RunningError(at.s.value(), at.s.bound() + q.bound())});
  }
  for (const double x : state.qd) out.qd.push_back(read(x));
  for (const double x : state.qdd) out.qdd.push_back(read(x));
  for (const double x : state.tau) out.tau.push_back(read(x));
  return out;
}

/// The answer in the source's coordinates.
Eigen::MatrixXd inSourceCoordinates(Eigen::MatrixXd value, std::optional<Quantity> quantity,
                                    const std::vector<double>& scale) {
  if (!quantity) return value;  // a ratio has no coordinates
  for (Eigen::Index i = 0; i < value.rows(); ++i) {
    if (*quantity == Quantity::kQdd)
      value.row(i) /= scale[i];
    else
      value.row(i) *= scale[i];
    if (*quantity == Quantity::kM) value.col(i) *= scale[i];
  }
  return value;
}

/// The scene as a table speaks of it: under its gravity; some of its cases without the wrenches.
class ScenesOfTable {
 public:
  ScenesOfTable(const json& table, const PreparedScene& scene, const fs::path& file)
      : with_wrenches_(scene) {
    if (!table.contains("gravity")) return;
    scene::Scene changed = scene.scene();
    bool is_same = changed.mechanism.has_gravity;
    changed.mechanism.has_gravity = true;
    for (int k = 0; k < 3; ++k) {
      const json& g = table["gravity"][k];
      scene::Number& gravity = changed.mechanism.gravity[k];
      const scene::Number stated = scene::Expression::parse(
          g.is_string() ? g.get<std::string>() : g.dump(), {file.string()});
      is_same = is_same && gravity.text() == stated.text();
      gravity = stated;
    }
    if (!is_same) with_wrenches_ = std::move(changed);
  }

  const PreparedScene& of(const json& one_case) {
    if (one_case.value("wrenches", true)) return with_wrenches_;
    if (!without_) {
      scene::Scene changed = with_wrenches_.scene();
      changed.mechanism.wrenches.clear();
      without_.emplace(std::move(changed));
    }
    return *without_;
  }

 private:
  PreparedScene with_wrenches_;
  std::optional<PreparedScene> without_;
};

fs::path ownScene(const json& content, const fs::path& table) {
  if (!content.contains("scene_file")) return {};
  return table.parent_path() / content["scene_file"].get<std::string>();
}

/// The period ratio, and how far it may be off: halving the step leaves less than half of the
/// error, and the angle of release is known to the rounding of its reading.
Answer periodRatio(const scene::Mechanism& mechanism, double q_0) {
  constexpr int kSteps = 1000;
  const auto ratio = [&](double q, int steps) { return pendulumPeriodRatio(mechanism, q, steps); };
  const double fine = ratio(q_0, kSteps);
  const double error = std::abs(fine - ratio(q_0, kSteps / 2)) +
                       std::abs(fine - ratio(q_0 * (1 + 4 * kUnitRoundoff), kSteps)) +
                       kUnitRoundoff * fine;
  return {Eigen::MatrixXd::Constant(1, 1, fine), Eigen::MatrixXd::Constant(1, 1, error)};
}

}  // namespace

std::optional<Quantity> tabledQuantity(const std::string& name) {
  if (name == "period_ratio") return {};
  return quantityNamed(name);
}

std::vector<fs::path> bundledTables() {
  std::vector<fs::path> tables;
  std::error_code error;  // a folder that does not exist has no tables
  for (const auto& entry : fs::directory_iterator(scene::dataFolder() / "reference", error))
    if (entry.path().extension() == ".json") tables.push_back(entry.path());
  std::sort(tables.begin(), tables.end());
  return tables;
}

fs::path ownScene(const fs::path& table) {
  return ownScene(readTable(table), table);
}

bool isAbout(const fs::path& table, const scene::Scene& scene) {
  const json content = readTable(table);
  // by file and not by name: a scene of the user's own may be called like a bundled one
  fs::path about = ownScene(content, table);
  if (about.empty())
    about = scene::dataFolder() / "scenes" / (content.value("scene", "") + ".toml");
  std::error_code error;
  return fs::equivalent(about, scene.file, error);
}

namespace {

/// One quantity that a case of a table prints.
struct Printed {
  const json& one_case;
  const json& numbers;
  const Case& here;
  std::string name;
  std::optional<Quantity> quantity;  ///< as tabledQuantity() says
  Agreement agreement;

  std::string of() const { return one_case.value("name", ""); }
  Eigen::MatrixXd there(const Eigen::MatrixXd& value) const {
    return inSourceCoordinates(value, quantity, here.scale);
  }
};

class TableComparison {
 public:
  TableComparison(const fs::path& file, const PreparedScene& scene)
      : file_(file), table_(readTable(file)), scenes_(table_, scene, file) {}

  std::vector<CheckResult> with(const std::vector<WitnessKind>& kinds) {
    for (const json& one_case : entry(table_, "cases", file_)) ask(one_case, kinds);
    for (CheckResult& check : results_) {
      if (check.judged() > 0 || check.verdict != Verdict::kAgree) continue;
      check.verdict = Verdict::kNotAnswerable;
      check.reason = check.voided_reason;
    }
    return results_;
  }

 private:
  CheckResult& check(const std::string& quantity, const std::string& witness) {
    for (CheckResult& known : results_)
      if (known.quantity == quantity && known.right == witness) return known;
    CheckResult made;
    made.kind = CheckKind::kTable;
    made.statement = table_.value("title", file_.stem().string());
    made.quantity = quantity;
    made.left = "table";
    made.right = witness;
    results_.push_back(made);
    return results_.back();
  }

  void ask(const json& one_case, const std::vector<WitnessKind>& kinds) {
    const PreparedScene& asked = scenes_.of(one_case);
    std::vector<MadeWitness> witnesses;  // one a kind
    for (const WitnessKind& kind : kinds) witnesses.push_back(kind.make(asked));
    EngineBound in_double(asked);
    const Case here = readCase(table_, one_case, asked.mechanism(), file_);
    for (const auto& [name, numbers] : entry(one_case, "expect", file_).items()) {
      const Printed printed = {one_case,
                               numbers,
                               here,
                               name,
                               tabledQuantity(name),
                               Agreement(table_, one_case, name, file_)};
      if (!printed.quantity) {
        compare(printed, "articulated_body", periodRatio(asked.mechanism(), here.state.x[0].q),
                Eigen::MatrixXd::Zero(1, 1));
        continue;
      }
      const Eigen::MatrixXd rounding = in_double(*printed.quantity, asRead(here.state));
      for (std::size_t i = 0; i < kinds.size(); ++i) {
        if (witnesses[i].isRefused())
          voided(printed, kinds[i].info.name, witnesses[i].refusal(), true);
        else if (Witness& witness = **witnesses[i]; witness.answers(*printed.quantity))
          ask(witness, printed, rounding);
      }
    }
  }

  void voided(const Printed& printed, const std::string& witness, const std::string& why,
              bool refused) {
    CheckResult& out = check(printed.name, witness);
    out.addVoided(out.states++, why, refused);
  }

  void ask(Witness& witness, const Printed& printed, const Eigen::MatrixXd& rounding) {
    try {
      compare(printed, witness.name(), witness.answer(*printed.quantity, printed.here.state),
              rounding);
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::exception& error) {
      voided(printed, witness.name(), error.what(), false);
    }
  }

  /// @param rounding  what the source's program may lose, and what reading the state does to the
  ///                  answer
  void compare(const Printed& printed, const std::string& witness, const Answer& answer,
               const Eigen::MatrixXd& rounding) {
    CheckResult& out = check(printed.name, witness);
    const Eigen::MatrixXd theirs = printed.there(answer.value),
                          own = printed.there(answer.bound + rounding),
                          source = printed.there(rounding);
    if (!own.allFinite())
      throw std::runtime_error("no error bound: a divisor is zero within rounding");
    const int index = out.states++;
    requireShape(printed, theirs);
    for (Eigen::Index i = 0; i < theirs.rows(); ++i) {
      for (Eigen::Index j = 0; j < theirs.cols(); ++j) {
        const std::string text = printedText(printed.numbers, i, j);
        const double expected = number(text, file_);
        const Limit limit = printed.agreement.limit(text, expected, source(i, j));
        const double residual = std::abs(theirs(i, j) - expected);
        // decimals are not doubles: the printed number is read, and subtracted, to rounding
        const double read = 2 * kUnitRoundoff * (std::abs(expected) + std::abs(theirs(i, j)));
        const double allowed = limit.distance + own(i, j) + read;
        const double used = residual == 0 ? 0 : residual / allowed;
        if (!out.worst_entry.empty() && used <= out.ratio) continue;
        out.ratio = std::isfinite(used) ? used : std::numeric_limits<double>::infinity();
        out.unit = limit.unit;
        const double unit = limit.size > 0 ? limit.size : allowed;
        out.worst = residual == 0 ? 0 : residual / unit;
        out.limit = allowed > 0 ? allowed / unit : 1;
        out.worst_state = index;
        out.worst_entry = entryName(printed.name, i, j, theirs);
        if (used <= 1) continue;
        out.verdict = Verdict::kDisagree;
        out.reason = fmt::format("{}, case '{}': {} prints {} for {}, computed {:.17g}",
                                 file_.filename().string(), printed.of(), table_.value("title", ""),
                                 text, out.worst_entry, theirs(i, j));
      }
    }
  }

  void requireShape(const Printed& printed, const Eigen::MatrixXd& theirs) const {
    const std::size_t rows = printed.numbers.size(),
                      columns = printed.numbers[0].is_array() ? printed.numbers[0].size() : 1;
    if (rows != static_cast<std::size_t>(theirs.rows()) ||
        columns != static_cast<std::size_t>(theirs.cols()))
      throw scene::InputError(
          {file_.string()}, fmt::format("case '{}': {} is {} x {}, expected {} x {}", printed.of(),
                                        printed.name, rows, columns, theirs.rows(), theirs.cols()));
  }

  const fs::path& file_;
  json table_;
  ScenesOfTable scenes_;
  std::vector<CheckResult> results_;
};

}  // namespace

std::vector<CheckResult> compareWithTable(const fs::path& file, const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds) {
  return TableComparison(file, scene).with(kinds);
}

namespace {

/// What the reading of the scene's file is worth, as a clause.
std::string wordsOnReading(const std::vector<CheckResult>& checks) {
  int agree = 0, others = 0;
  for (const CheckResult& check : checks) {
    if (check.law != kReading) continue;
    if (check.verdict == Verdict::kDisagree)
      return "the reading: the file, read a second time, says otherwise than the scene";
    ++(check.verdict == Verdict::kAgree ? agree : others);
  }
  return agree > 0 && others == 0
             ? "the table, or the figures in the scene's file, which were read twice and came "
               "out the same"
             : "the table, or the reading of the scene's file, which all witnesses share";
}

}  // namespace

std::vector<Finding> findTableDisputes(const std::string& scene_name,
                                       const std::vector<CheckResult>& checks) {
  struct Dispute {
    std::string title, quantity;
    int witnesses = 0, against = 0;
  };
  std::vector<Dispute> disputes;
  for (const CheckResult& check : checks) {
    if (check.kind != CheckKind::kTable || check.verdict == Verdict::kNotAnswerable) continue;
    auto at = std::find_if(disputes.begin(), disputes.end(), [&](const Dispute& known) {
      return known.title == check.statement && known.quantity == check.quantity;
    });
    if (at == disputes.end()) at = disputes.insert(at, {check.statement, check.quantity});
    ++at->witnesses;
    at->against += check.verdict == Verdict::kDisagree ? 1 : 0;
  }
  std::vector<Finding> findings;
  for (const Dispute& dispute : disputes) {
    const bool among_themselves =
        std::any_of(checks.begin(), checks.end(), [&](const CheckResult& check) {
          return check.kind == CheckKind::kSame && check.quantity == dispute.quantity &&
                 check.verdict == Verdict::kDisagree;
        });
    // of one witness nobody knows whether others would agree with it
    if (dispute.witnesses < 2 || dispute.against < dispute.witnesses || among_themselves) continue;
    Finding finding;
    finding.scene = scene_name;
    finding.quantity = dispute.quantity;
    finding.witness = "table";
    finding.text = fmt::format(
        "{}: {}: {} witnesses agree with each other and stand against the table '{}'; wrong is {}",
        scene_name, dispute.quantity, dispute.witnesses, dispute.title, wordsOnReading(checks));
    findings.push_back(finding);
  }
  return findings;
}

}  // namespace dynwitness::crosscheck
