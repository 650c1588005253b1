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
  double unit;
  const char* unit_name;
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
    if (accuracy_ > 0) return {accuracy_, accuracy_, "stated accuracy of the source"};
    // all bits of a double: "4" is no number with one digit then
    if (computed_ && places_ < 0 && significant_ == 0)
      return {rounding, rounding, "rounding of the source's program"};
    int places = placesOf(text);
    if (places_ >= 0) places = places_;
    if (significant_ > 0) {
      if (printed == 0) return {rounding, rounding, "rounding of the source's program"};
      places = significant_ - 1 - static_cast<int>(std::floor(std::log10(std::abs(printed))));
    }
    const double place = std::pow(10.0, -places), printing = units_ * place;
    if (computed_)
      return {rounding + printing, rounding + printing, "rounding of the source's program"};
    return {printing, place, "units of the last printed digit"};
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
                            "the scene has spherical or floating joints, allowed in tables: joints "
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
Eigen::MatrixXd inSourceCoordinates(Eigen::MatrixXd value, const std::string& quantity,
                                    const std::vector<double>& scale) {
  for (Eigen::Index i = 0; i < value.rows(); ++i) {
    if (quantity == "qdd")
      value.row(i) /= scale[i];
    else if (quantity != "period_ratio")
      value.row(i) *= scale[i];
    if (quantity == "M") value.col(i) *= scale[i];
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

std::vector<CheckResult> compareWithTable(const fs::path& file, const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds) {
  const json table = readTable(file);
  ScenesOfTable scenes(table, scene, file);
  std::vector<CheckResult> results;
  const auto check = [&](const std::string& quantity, const std::string& witness) -> CheckResult& {
    for (CheckResult& known : results)
      if (known.quantity == quantity && known.right == witness) return known;
    CheckResult made;
    made.check = "table";
    made.statement = table.value("title", file.stem().string());
    made.quantity = quantity;
    made.left = "table";
    made.right = witness;
    results.push_back(made);
    return results.back();
  };

  for (const json& one_case : entry(table, "cases", file)) {
    const PreparedScene& asked = scenes.of(one_case);
    std::vector<MadeWitness> witnesses;  // one a kind
    for (const WitnessKind& kind : kinds) witnesses.push_back(kind.make(asked));
    EngineBound in_double(asked);
    const Case here = readCase(table, one_case, asked.mechanism(), file);
    for (const auto& [quantity, printed] : entry(one_case, "expect", file).items()) {
      const Agreement agreement(table, one_case, quantity, file);
      // rounding: what the source's program may lose, and what reading the state does to the answer
      const auto compare = [&](const std::string& witness, const Answer& answer,
                               const Eigen::MatrixXd& rounding) {
        CheckResult& out = check(quantity, witness);
        const auto there = [&](const Eigen::MatrixXd& value) {
          return inSourceCoordinates(value, quantity, here.scale);
        };
        const Eigen::MatrixXd theirs = there(answer.value), own = there(answer.bound + rounding),
                              source = there(rounding);
        if (!own.allFinite())
          throw std::runtime_error("no error bound: a divisor is zero within rounding");
        const int index = out.states++;
        const std::size_t columns = printed[0].is_array() ? printed[0].size() : 1;
        if (printed.size() != static_cast<std::size_t>(theirs.rows()) ||
            columns != static_cast<std::size_t>(theirs.cols()))
          throw scene::InputError(
              {file.string()},
              fmt::format("case '{}': {} is {} x {}, expected {} x {}", one_case.value("name", ""),
                          quantity, printed.size(), columns, theirs.rows(), theirs.cols()));
        for (Eigen::Index i = 0; i < theirs.rows(); ++i) {
          for (Eigen::Index j = 0; j < theirs.cols(); ++j) {
            const std::string text = printedText(printed, i, j);
            const double expected = number(text, file);
            const Limit limit = agreement.limit(text, expected, source(i, j));
            const double residual = std::abs(theirs(i, j) - expected);
            // decimals are not doubles: the printed number is read, and subtracted, to rounding
            const double read = 2 * kUnitRoundoff * (std::abs(expected) + std::abs(theirs(i, j)));
            const double allowed = limit.distance + own(i, j) + read;
            const double used = residual == 0 ? 0 : residual / allowed;
            if (!out.worst_entry.empty() && used <= out.ratio) continue;
            out.ratio = std::isfinite(used) ? used : std::numeric_limits<double>::infinity();
            out.unit = limit.unit_name;
            const double unit = limit.unit > 0 ? limit.unit : allowed;
            out.worst = residual == 0 ? 0 : residual / unit;
            out.limit = allowed > 0 ? allowed / unit : 1;
            out.worst_state = index;
            out.worst_entry = entryName(quantity, i, j, theirs);
            if (!(used <= 1)) {
              out.verdict = Verdict::kDisagree;
              out.reason =
                  fmt::format("{}, case '{}': {} prints {} for {}, computed {:.17g}",
                              file.filename().string(), one_case.value("name", ""),
                              table.value("title", ""), text, out.worst_entry, theirs(i, j));
            }
          }
        }
      };

      if (quantity == "period_ratio") {
        compare("articulated_body", periodRatio(asked.mechanism(), here.state.x[0].q),
                Eigen::MatrixXd::Zero(1, 1));
        continue;
      }
      const Eigen::MatrixXd rounding = in_double(quantityNamed(quantity), asRead(here.state));
      const auto voided = [&](const std::string& witness, const std::string& why, bool refused) {
        CheckResult& out = check(quantity, witness);
        out.addVoided(out.states++, why, refused);
      };
      for (std::size_t i = 0; i < kinds.size(); ++i) {
        if (witnesses[i].isRefused()) {
          voided(kinds[i].info.name, witnesses[i].refusal(), true);
          continue;
        }
        Witness& witness = **witnesses[i];
        if (!witness.answers(quantityNamed(quantity))) continue;
        try {
          compare(witness.name(), witness.answer(quantityNamed(quantity), here.state), rounding);
        } catch (const scene::InputError&) {
          throw;
        } catch (const std::exception& error) {
          voided(witness.name(), error.what(), false);
        }
      }
    }
  }
  for (CheckResult& check : results) {
    if (check.judged() > 0 || check.verdict != Verdict::kAgree) continue;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = check.voided_reason;
  }
  return results;
}

}  // namespace dynwitness::crosscheck
