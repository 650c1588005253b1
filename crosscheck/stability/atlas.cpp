// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/stability/atlas.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/chart/methods.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/system/children.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/estimated_sweep.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostDigits = 17;   // of a double in decimals
constexpr long kDistanceBits = 256;  // an answer and a truth that both carry more than 53
constexpr int kStepOfCompiled = 4;   // of severities, for methods that compile
constexpr const char* kTold = "digits: ";

bool isOurs(const WitnessKind& kind) {
  return kind.info.version == DYNWITNESS_VERSION && !isProgram(kind);
}
/// Of the roads of a whole mechanism: an engine's is called as its witness.
bool isEngine(const std::string& road) {
  static const std::vector<WitnessKind> kinds = witnessKinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const WitnessKind& kind) {
    return kind.info.name == road && !isOurs(kind);
  });
}

/// With all equations of its closures: none of a family's follows from the others.
MechanismState closedAt(const Case& given) {
  int rows = 0;
  for (const scene::Closure& closure : given.scene.mechanism.closures)
    rows += scene::equationCount(closure.kind);
  MechanismState at;
  at.state = given.state;
  at.rows.resize(static_cast<std::size_t>(rows));
  std::iota(at.rows.begin(), at.rows.end(), 0);
  return at;
}

double wrongFrom() {
  return std::pow(10.0, -kFewestDigits);
}

/// By which road the witnesses of this name find qdd.
Road roadOf(const std::string& name) {
  static const std::map<std::string, Road> known = {{"composite_body", Road::kMassMatrix},
                                                    {"lagrange", Road::kMassMatrix},
                                                    {"recursive_lagrange", Road::kMassMatrix},
                                                    {"lagrange_multipliers", Road::kMassMatrix},
                                                    {"dense_system", Road::kMassMatrix},
                                                    {"hybrid_sweep", Road::kSweep},
                                                    {"loops_eliminated", Road::kSweep},
                                                    {"mujoco", Road::kMassMatrix},
                                                    {"mujoco_principal", Road::kMassMatrix},
                                                    {"kdl", Road::kMassMatrix},
                                                    {"articulated_body", Road::kSweep},
                                                    {"fast", Road::kSweep},
                                                    {"simbody", Road::kSweep},
                                                    {"dart", Road::kSweep}};
  const auto at = known.find(name);
  return at == known.end() ? Road::kAny : at->second;
}

std::unique_ptr<Witness> witnessOf(const WitnessKind& kind, const Case& given, Quantity quantity) {
  std::unique_ptr<Witness> witness = kind.make(PreparedScene(given.scene)).value();
  if (!witness->answers(quantity))
    throw std::runtime_error(fmt::format("does not answer {}", crosscheck::name(quantity)));
  return witness;
}

Method witnessMethod(const WitnessKind& kind) {
  Method method;
  method.name = kind.info.name;
  method.road = roadOf(method.name);
  method.is_ours = isOurs(kind);
  method.is_compiled = kind.is_compiled;
  method.is_derived = kind.is_compiled || kind.info.name == "lagrange";
  method.value = [kind](const Case& given, Quantity quantity) -> MatrixX<Ball> {
    return witnessOf(kind, given, quantity)->value(quantity, given.state).unaryExpr([](double x) {
      return Ball(x);
    });
  };
  // who has an estimate of one quantity has it of all that families ask of it
  method.is_estimated =
      method.is_ours && (method.name == "newton_euler" || method.name == "composite_body" ||
                         method.name == "articulated_body" || method.name == kFastName);
  if (method.is_ours)
    method.warns = [kind](const Case& given, Quantity quantity) {
      if (const EstimatedSweep estimated =
              estimatedSweep(kind.info.name, quantity, given.scene.mechanism, false))
        return estimated(given.state).digits <= kFewestDigits;
      const Answer answer = witnessOf(kind, given, quantity)->answer(quantity, given.state);
      return certainDigits(answer) <= kFewestDigits;
    };
  return method;
}

/// A sweep in float, as the charts have it.
Method floatMethod(const char* name, Quantity quantity, Sweep sweep) {
  Method method;
  method.name = name;
  method.numbers = &inFloat();
  method.road = roadOf(method.name);
  method.name += " float";
  method.is_ours = true;
  method.value = [quantity, sweep](const Case& given, Quantity asked) {
    if (asked != quantity)
      throw std::runtime_error(fmt::format("does not answer {}", crosscheck::name(asked)));
    const std::unique_ptr<crosscheck::Method> in_float =
        sweepInFloat(sweep, given.scene.mechanism, {given.state});
    in_float->run(0);
    return in_float->answer();
  };
  method.is_estimated = true;
  method.warns = [sweep_name = std::string(name)](const Case& given, Quantity asked) {
    return estimatedSweep(sweep_name, asked, given.scene.mechanism, true)(given.state).digits <=
           kFewestDigits;
  };
  return method;
}

Method roadMethod(const std::string& name, MechanismQuantity asked) {
  Method method;
  method.name = name;
  method.is_ours = !isEngine(name);
  if (method.is_ours) method.road = roadOf(name);  // on loops an engine goes a road of its own
  const auto part = [name, asked](const Case& given) {
    for (const NamedRoad& road : given.roads) {
      if (road.name != name) continue;
      if (road.road.isRefused()) throw std::runtime_error(road.road.refusal());
      MechanismAnswer::Part out = (*road.road)->answer(closedAt(given))[asked];
      if (out.value.size() == 0)
        throw std::runtime_error(fmt::format("does not answer {}", crosscheck::name(asked)));
      return out;
    }
    throw std::runtime_error("does not hold such mechanisms");
  };
  method.value = [part](const Case& given, Quantity) -> MatrixX<Ball> {
    return part(given).value.unaryExpr([](double x) { return Ball(x); });
  };
  if (method.is_ours)
    method.warns = [part](const Case& given, Quantity) {
      const MechanismAnswer::Part said = part(given);
      return certainDigits({said.value, said.bound}) <= kFewestDigits;
    };
  return method;
}

/// Those who answer for whole mechanisms; an engine among them where it is among `chosen`.
std::vector<Method> roadMethods(const Family& family, const std::vector<Method>& chosen) {
  const auto isChosen = [&chosen](const std::string& name) {
    return std::any_of(chosen.begin(), chosen.end(),
                       [&](const Method& m) { return m.name == name; });
  };
  std::vector<Method> out;
  for (const NamedRoad& road : mechanismRoads(PreparedScene(harmlessCase(family).scene)))
    if (!isEngine(road.name) || isChosen(road.name))
      out.push_back(roadMethod(road.name, *family.whole));
  return out;
}

/// Decimal digits of the answer's entry that is farthest off, as a share of the largest entry.
double digitsOf(const MatrixX<Ball>& answer, const MatrixX<Ball>& truth) {
  if (answer.rows() != truth.rows() || answer.cols() != truth.cols())
    throw std::runtime_error(fmt::format("{} x {} numbers", answer.rows(), answer.cols()));
  const BallPrecision precision(kDistanceBits);
  Ball farthest(0), largest(0);
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    if (!answer.data()[k].isFinite()) throw std::runtime_error("not a number");
    const Ball distance = abs(answer.data()[k] - truth.data()[k]);
    if ((distance - farthest).isPositive()) farthest = distance;
    if ((abs(truth.data()[k]) - largest).isPositive()) largest = abs(truth.data()[k]);
  }
  const Ball error = farthest / largest;
  const double most = error.isFinite() ? error.atMost() : std::numeric_limits<double>::infinity();
  return std::clamp(-std::log10(most), 0.0, kMostDigits);
}

/// The mechanisms of one severity, and what is right.
struct Question {
  std::vector<Case> cases;
  std::vector<MatrixX<Ball>> truths;
};

/// In a copy of this process: what engines say as they die, and what they die of, is told by us.
void hush() {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
}

/// Severities, each made and certified once for all methods.
class Dial {
 public:
  explicit Dial(const Family& family) : family_(family) {}

  const Question& at(const std::string& severity) {
    const auto [it, is_new] = questions_.try_emplace(severity);
    if (!is_new) return it->second;
    for (int variant = 0; variant < kVariants; ++variant) {
      Case given = family_.make(severity, variant);
      try {
        it->second.truths.push_back(truthOf(family_, given));
      } catch (const std::exception& none) {
        throw std::runtime_error(
            fmt::format("{} at {}: no certified truth: {}", family_.name, severity, none.what()));
      }
      if (family_.whole) given.roads = mechanismRoads(PreparedScene(given.scene));
      it->second.cases.push_back(std::move(given));
    }
    return it->second;
  }

 private:
  const Family& family_;
  std::map<std::string, Question> questions_;
};

class Turning {
 public:
  Turning(const Family& family, const Method& method, Dial& dial, const Settings& settings)
      : family_(family), method_(method), dial_(dial), settings_(settings) {}

  Point ask(double severity) {
    const std::string text = decimalOf(severity, family_.is_whole);
    const Question& question = dial_.at(text);
    Point point;
    point.severity = std::stod(text);
    const std::string said = triedInCopy(
        [&] {
          hush();
          double fewest = kMostDigits;
          for (std::size_t k = 0; k < question.cases.size(); ++k)
            fewest = std::min(fewest, digitsIn(question, k));
          return fmt::format("{}{:.6f}", kTold, fewest);
        },
        settings_.patience);
    if (said.rfind(kTold, 0) == 0) {
      point.digits = std::stod(said.substr(std::string(kTold).size()));
      if (method_.warns && (point.isBroken() || method_.is_estimated))
        point.warned = warns(question, point.isBroken());
    } else {
      point.digits = kNone;
      point.stop = said.substr(0, said.find('\n'));
    }
    return point;
  }

 private:
  double digitsIn(const Question& question, std::size_t variant) const {
    return digitsOf(method_.value(question.cases[variant], family_.quantity),
                    question.truths[variant]);
  }
  bool isTold(const Case& given) const {
    try {
      return method_.warns(given, family_.quantity);
    } catch (const std::exception&) {
      return true;  // who throws has told
    }
  }
  /// Whether each wrong answer was told to be one; of right ones whether any was.
  bool warns(const Question& question, bool is_broken) const {
    constexpr const char* kWarned = "warned";
    return triedInCopy(
               [&]() -> std::string {
                 hush();
                 for (std::size_t k = 0; k < question.cases.size(); ++k) {
                   if (!is_broken && isTold(question.cases[k])) return kWarned;
                   if (is_broken && digitsIn(question, k) < kFewestDigits &&
                       !isTold(question.cases[k]))
                     return "";
                 }
                 return is_broken ? kWarned : "";
               },
               settings_.patience) == kWarned;
  }

  const Family& family_;
  const Method& method_;
  Dial& dial_;
  const Settings& settings_;
};

/// Of equal steps of the logarithm; whole ones once each.
std::vector<double> severitiesOf(const Family& family, int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) {
    const double share = k / (count - 1.0);
    const double s = family.from * std::pow(family.to / family.from, share);
    const double rounded = std::stod(decimalOf(s, family.is_whole));
    if (out.empty() || rounded > out.back()) out.push_back(rounded);
  }
  return out;
}

}  // namespace

Case harmlessCase(const Family& family) {
  return family.make(decimalOf(family.from, family.is_whole), 0);
}

std::vector<Method> methodsOf(const std::vector<WitnessKind>& kinds) {
  std::vector<Method> out;
  for (const WitnessKind& kind : kinds)
    if (kind.info.present) out.push_back(witnessMethod(kind));
  out.push_back(floatMethod("newton_euler", Quantity::kTau, Sweep::kNewtonEuler));
  out.push_back(floatMethod("composite_body", Quantity::kQdd, Sweep::kCompositeBodySolved));
  out.push_back(floatMethod("articulated_body", Quantity::kQdd, Sweep::kArticulatedBody));
  return out;
}

const Theory* theoryFor(const Family& family, Road road, const std::string& method) {
  const Theory* of_road = nullptr;
  for (const Theory& theory : family.theories) {
    const auto& named = theory.methods;
    if (std::find(named.begin(), named.end(), method) != named.end()) return &theory;
    if (of_road == nullptr && named.empty() && (theory.road == Road::kAny || theory.road == road))
      of_road = &theory;
  }
  return of_road;
}

double firstBroken(const Family& family, const std::function<double(double)>& error) {
  const auto isBroken = [&](double s) { return error(s) > wrongFrom(); };
  if (!isBroken(family.to)) return kNone;
  if (isBroken(family.from)) return family.from;
  double low = std::log10(family.from), high = std::log10(family.to);
  constexpr int kHalvings = 60;  // more than a double can tell apart
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (low + high) / 2;
    (isBroken(std::pow(10.0, middle)) ? high : low) = middle;
  }
  return std::pow(10.0, high);
}

double predictedBreak(const Family& family, const Theory& theory, const Arithmetic& numbers) {
  return firstBroken(family, [&](double s) { return theory.error(s, numbers); });
}

bool Course::isAsPredicted() const {
  if (!has_theory || !left_out.empty()) return false;
  if (!breaks() || !isPredicted()) return breaks() == isPredicted();
  return ratio() >= 0.5 && ratio() <= 2;
}

std::string Course::verdict() const {
  if (!left_out.empty()) return "not asked";
  if (!breaks()) return isPredicted() ? "outlasts the theory" : "survives";
  if (!has_theory) return "breaks, no theory";
  if (!isPredicted()) return "breaks, not predicted";
  if (isAsPredicted()) return "as predicted";
  return ratio() < 1 ? "earlier than predicted" : "later than predicted";
}

std::string Course::end() const {
  for (const Point& point : points)
    if (point.severity == breaks_at) return point.stop;
  return "";
}

int Course::silent() const {
  if (is_step) return 0;
  return static_cast<int>(std::count_if(points.begin(), points.end(),
                                        [](const Point& point) { return point.isSilent(); }));
}

int Course::falseAlarms() const {
  return static_cast<int>(std::count_if(points.begin(), points.end(),
                                        [](const Point& point) { return point.isFalseAlarm(); }));
}

namespace {

/// Asks along the dial, and between what held and what did not.
template <typename Ask>
void followDial(const Family& family, const std::vector<double>& severities, int every,
                const Ask& ask, Course& course) {
  double held = kNone;
  for (std::size_t k = 0; k < severities.size(); ++k) {
    const bool is_end = k + 1 == severities.size();
    if (k % static_cast<std::size_t>(every) != 0 && !is_end) continue;
    const Point point = ask(severities[k]);
    if (course.points.empty() && !point.stop.empty()) {
      course.left_out = point.stop;
      return;
    }
    course.points.push_back(point);
    if (course.breaks()) continue;
    (point.isBroken() ? course.breaks_at : held) = point.severity;
  }
  while (
      course.breaks() && held == held &&
      (family.is_whole ? course.breaks_at - held > 1 : course.breaks_at / held > family.narrow)) {
    const Point point = ask(std::sqrt(held) * std::sqrt(course.breaks_at));
    if (point.severity <= held || point.severity >= course.breaks_at) break;
    (point.isBroken() ? course.breaks_at : held) = point.severity;
    course.points.push_back(point);
  }
  std::sort(course.points.begin(), course.points.end(),
            [](const Point& a, const Point& b) { return a.severity < b.severity; });
}

Course courseOf(const std::string& method, const Arithmetic& numbers, bool is_ours) {
  Course course;
  course.method = method;
  course.numbers = numbers.name;
  course.is_ours = is_ours;
  course.breaks_at = course.predicted = kNone;
  return course;
}

/// Measured here: our own code neither crashes nor hangs.
Course courseOf(const Family& family, const Measure& method,
                const std::vector<double>& severities) {
  Course course = courseOf(method.name, *method.numbers, true);
  course.has_theory = course.is_step = true;
  course.predicted = firstBroken(family, method.theory);
  const auto ask = [&](double severity) {
    Point point;
    point.severity = severity;
    double error = kNone;
    try {
      error = method.measured(severity);
    } catch (const std::exception& what) {
      point.stop = what.what();
    }
    point.digits = std::isfinite(error) ? std::clamp(-std::log10(error), 0.0, kMostDigits) : kNone;
    if (!std::isfinite(error) && point.stop.empty()) point.stop = "not a number";
    return point;
  };
  followDial(family, severities, 1, ask, course);
  return course;
}

}  // namespace

MatrixX<Ball> truthOf(const Family& family, const Case& given) {
  if (family.whole) {
    const MechanismAnswer answer =
        certifiedMechanism(PreparedScene(given.scene))->answer(closedAt(given));
    return answer[*family.whole].value.unaryExpr([](double x) { return Ball(x); });
  }
  Certified truth = Truth(given.scene.mechanism)(family.quantity, given.state);
  if (!truth.exists()) throw std::runtime_error(truth.reason);
  return std::move(truth.value);
}

Turned turn(const Family& family, const std::vector<Method>& chosen, const Settings& settings) {
  Turned out{family.name, {}};
  const std::vector<double> severities = severitiesOf(family, settings.severities);
  if (!family.measures.empty()) {
    scene::Work work("methods", static_cast<double>(family.measures.size()), 1);
    for (const Measure& method : family.measures) {
      out.courses.push_back(courseOf(family, method, severities));
      work.done();
    }
    return out;
  }
  const std::vector<Method> methods = family.whole ? roadMethods(family, chosen) : chosen;
  Dial dial(family);
  scene::Work work("methods", static_cast<double>(methods.size()), 1);
  for (const Method& method : methods) {
    Course course = courseOf(method.name, *method.numbers, method.is_ours);
    const Theory* const theory = theoryFor(
        family, family.whole || family.quantity == Quantity::kQdd ? method.road : Road::kAny,
        method.name);
    course.has_theory = theory != nullptr && theory->isClaimed();
    if (course.has_theory) course.predicted = predictedBreak(family, *theory, *method.numbers);
    if (family.is_large && method.is_derived) {
      course.left_out = "derives or compiles equations, which grow with the mechanism";
    } else {
      Turning turning(family, method, dial, settings);
      followDial(
          family, severities, method.is_compiled ? kStepOfCompiled : 1,
          [&](double severity) { return turning.ask(severity); }, course);
    }
    out.courses.push_back(std::move(course));
    work.done();
  }
  return out;
}

}  // namespace dynwitness::crosscheck::stability
