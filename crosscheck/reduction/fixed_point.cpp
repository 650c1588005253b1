// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/kernel/roads.hpp"
#include "crosscheck/reduction/boxes.hpp"
#include "crosscheck/reduction/envelope_sampler.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using kernel::Formula;
using scene::JointRanges;
using symbolic::Input;
using symbolic::Program;
using Code = Program::Code;

/// That the envelope is divided into, for ranges and errors.
constexpr int kMostBoxes = 20000;
constexpr int kSampled = 200;  ///< states whose derivatives choose fraction bits
constexpr int kMostBits = 63;  ///< of a product or sum, with its sign: int64_t
constexpr int kMostRounds = 40;
/// What the double nearest to a cosine or sine by the C library (1 ulp) is off.
constexpr double kLibrary = 2 * RunningError::kUnitRoundoff;

double lastPlace(int fraction) {
  return std::ldexp(1.0, -fraction);
}

/// Bits before the point of numbers of this magnitude.
int integerBits(double magnitude) {
  int bits = 0;
  if (magnitude > 0) std::frexp(magnitude, &bits);  // magnitude < 2^bits
  return magnitude > 0 ? bits : 0;
}

/// The shortest fraction that has the same digits.
int shortest(double constant, int fraction) {
  while (fraction > 0 && std::remainder(std::ldexp(constant, fraction - 1), 1) == 0) --fraction;
  return fraction;
}

class Planner {
 public:
  Planner(const scene::Scene& scene, const std::vector<JointRanges>& ranges, double error)
      : scene_(scene), ranges_(ranges) {
    requireTreated(scene, Command::kReduce);
    if (ranges.empty())
      throw scene::InputError(
          {scene.file.string()},
          "no [envelope], allowed: a scene whose file gives ranges of q, qd and "
          "qdd for every joint (data/scenes/README.md)");
    out_.error = error;
    try {
      out_.program = kernel::smallestRoad(scene.mechanism, Formula::kInverseDynamics).program;
    } catch (const kernel::NotUsed& none) {
      throw scene::InputError({scene.file.string()}, std::string("fixed point: ") + none.what());
    }
    for (const Program::Instruction& i : out_.program.body)
      if (i.code == Code::kInverse)
        throw scene::InputError({scene.file.string()},
                                "fixed point: the program divides, allowed: those that do not");
    nameSignals();
    divide();
  }

  FixedPoint run() {
    bool is_first = true;
    overBoxes([&](const auto& slot) {
      for (std::size_t s = 0; s < out_.signals.size(); ++s) {
        FixedSignal& signal = out_.signals[s];
        const RunningError& x = slot(static_cast<int>(s));
        // the sums below round, too
        const double reach = x.bound() * (1 + kLibrary) +
                             2 * RunningError::kUnitRoundoff * (std::abs(x.value()) + x.bound());
        const double low = x.value() - reach, high = x.value() + reach;
        signal.low = is_first ? low : std::min(signal.low, low);
        signal.high = is_first ? high : std::max(signal.high, high);
      }
      is_first = false;
    });
    findSensitivities();
    double share = 1;
    for (int round = 0;; ++round) {
      allocate(share * out_.error);
      const double worst = certify();
      if (worst <= out_.error) break;
      if (round == kMostRounds || !std::isfinite(worst))
        throw scene::InputError({scene_.file.string()},
                                "fixed point: no word lengths were found for this error, allowed: "
                                "a larger --error");
      share *= 0.95 * out_.error / worst;
    }
    giveIntegerBits();
    requireHeld();
    return std::move(out_);
  }

 private:
  // ---- what there is

  void nameSignals() {
    const Program& p = out_.program;
    const symbolic::ProgramRun<RunningError> run(p, RunningErrorNumbers(scene_.mechanism));
    out_.signals.resize(static_cast<std::size_t>(p.slots));
    std::vector<bool> is_known(out_.signals.size(), true);  // before a state is
    for (const Program::Load& load : p.loads) {
      FixedSignal& signal = out_.signals[static_cast<std::size_t>(load.slot)];
      signal.kind = FixedSignal::Kind::kInput;
      signal.name = nameOf(load);
      is_known[static_cast<std::size_t>(load.slot)] = false;
      use(load.slot);
    }
    for (const Program::Instruction& i : p.body) {
      is_known[static_cast<std::size_t>(i.result)] = false;
      out_.signals[static_cast<std::size_t>(i.result)].name = fmt::format("t{}", i.result);
      for (const int s : {i.result, i.a}) use(s);
      if (i.code != Code::kNegate) use(i.b);
    }
    for (std::size_t i = 0; i < p.outputs.size(); ++i) {
      out_.signals[static_cast<std::size_t>(p.outputs[i])].name = fmt::format("tau_{}", i + 1);
      use(p.outputs[i]);
    }
    constants_.resize(out_.signals.size());
    for (std::size_t s = 0; s < out_.signals.size(); ++s) {
      if (!is_known[s]) continue;
      constants_[s] = run.slot(static_cast<int>(s));
      out_.signals[s].kind = FixedSignal::Kind::kConstant;
      out_.signals[s].value = constants_[s].value();
      if (out_.signals[s].name.empty())
        out_.signals[s].name = fmt::format("{:.6g}", constants_[s].value());
    }
  }
  void use(int slot) { out_.signals[static_cast<std::size_t>(slot)].is_used = true; }
  static std::string nameOf(const Program::Load& load) {
    switch (load.input) {
      case Input::kCos:
        return fmt::format("cos q{}", load.joint + 1);
      case Input::kSin:
        return fmt::format("sin q{}", load.joint + 1);
      case Input::kPosition:
        return fmt::format("q{}", load.joint + 1);
      case Input::kVelocity:
        return fmt::format("qd{}", load.joint + 1);
      default:
        return fmt::format("qdd{}", load.joint + 1);
    }
  }

  // ---- boxes

  /// As many pieces of each joint's q that the program reads.
  void divide() {
    std::set<int> read;
    for (const Program::Load& load : out_.program.loads)
      if (load.input == Input::kCos || load.input == Input::kSin || load.input == Input::kPosition)
        if (ranges_[static_cast<std::size_t>(load.joint)].q.low <
            ranges_[static_cast<std::size_t>(load.joint)].q.high)
          read.insert(load.joint);
    pieces_.assign(ranges_.size(), 1);
    const int each = read.empty()
                         ? 1
                         : std::max(1, static_cast<int>(std::pow(
                                           kMostBoxes, 1.0 / static_cast<double>(read.size()))));
    out_.boxes = 1;
    for (const int joint : read) {
      pieces_[static_cast<std::size_t>(joint)] = each;
      out_.boxes *= each;
    }
  }

  static RunningError ballOf(const scene::Range& r) {
    const double middle = 0.5 * (r.low + r.high);
    const double reach = std::max(r.high - middle, middle - r.low);
    return {middle, reach * (1 + 4 * RunningError::kUnitRoundoff) +
                        2 * RunningError::kUnitRoundoff * std::abs(middle)};
  }

  /// q with its cosine and sine, all of which are in the balls. An angle that is turned by pi/2 has
  /// lost u (|q| + pi/2) and what M_PI_2 lacks, a cosine 1 ulp.
  static scene::JointPosition<RunningError> positionOf(const scene::Range& q) {
    const double lost = 2 * RunningError::kUnitRoundoff * (2 + q.most());
    const auto cosine = [lost](double low, double high) {
      constexpr double kTurn = 2 * M_PI;
      const double a = std::cos(low), b = std::cos(high);
      const bool has_one = std::floor((high + lost) / kTurn) > std::floor((low - lost) / kTurn);
      const bool has_minus_one =
          std::floor((high + lost) / kTurn + 0.5) > std::floor((low - lost) / kTurn + 0.5);
      const scene::Range range{has_minus_one ? -1 : std::min(a, b), has_one ? 1 : std::max(a, b)};
      const RunningError ball = ballOf(range);
      return RunningError(ball.value(), ball.bound() + lost);
    };
    return {ballOf(q), cosine(q.low, q.high), cosine(q.low - M_PI_2, q.high - M_PI_2)};
  }

  /// @param visit  visit(slot), slot(s) the ball of a slot over one box
  template <typename Visit>
  void overBoxes(const Visit& visit) const {
    symbolic::ProgramRun<RunningError> run(out_.program, RunningErrorNumbers(scene_.mechanism));
    std::vector<RunningError> tau(out_.program.outputs.size());
    scene::State<RunningError> state;
    for (const JointRanges& r : ranges_) {
      state.qd.push_back(ballOf(r.qd));
      state.qdd.push_back(ballOf(r.qdd));
    }
    for (int box = 0; box < out_.boxes; ++box) {
      state.x.clear();
      int at = box;
      for (std::size_t k = 0; k < ranges_.size(); ++k) {
        const scene::Range& q = ranges_[k].q;
        const int piece = at % pieces_[k];
        at /= pieces_[k];
        const double width = (q.high - q.low) / pieces_[k];
        // neighbours share an end: it is the same double of both
        const double low = piece == 0 ? q.low : q.low + piece * width,
                     high = piece + 1 == pieces_[k] ? q.high : q.low + (piece + 1) * width;
        state.x.push_back(positionOf({low, high}));
      }
      run(state, tau.data());
      visit([&](int s) -> const RunningError& { return run.slot(s); });
    }
  }

  // ---- fraction bits

  /// The largest |d tau_i / d signal| at sampled states, by signal.
  void findSensitivities() {
    const Program& p = out_.program;
    sensitivity_.assign(out_.signals.size(), 0);
    symbolic::ProgramRun<double> run(p, scene::RealNumbers<double>(scene_.mechanism));
    EnvelopeSampler sampler(ranges_, 36);
    std::vector<double> tau(p.outputs.size()), adjoint;
    for (int sample = 0; sample < kSampled; ++sample) {
      const EnvelopeState drawn = sampler.next();
      scene::State<double> state{{}, drawn.qd, drawn.qdd, {}};
      for (const double q : drawn.q) state.x.push_back(scene::jointPosition(q));
      run(state, tau.data());
      for (const int output : p.outputs) {
        adjoint.assign(out_.signals.size(), 0);
        adjoint[static_cast<std::size_t>(output)] = 1;
        for (auto i = p.body.rbegin(); i != p.body.rend(); ++i) goBack(run, *i, &adjoint);
        for (std::size_t s = 0; s < adjoint.size(); ++s)
          sensitivity_[s] = std::max(sensitivity_[s], std::abs(adjoint[s]));
      }
    }
  }

  static void goBack(const symbolic::ProgramRun<double>& run, const Program::Instruction& i,
                     std::vector<double>* adjoint) {
    const double by = (*adjoint)[static_cast<std::size_t>(i.result)];
    double& a = (*adjoint)[static_cast<std::size_t>(i.a)];
    switch (i.code) {
      case Code::kNegate:
        a -= by;
        return;
      case Code::kMultiply: {
        const double at_a = run.slot(i.a), at_b = run.slot(i.b);
        a += by * at_b;
        (*adjoint)[static_cast<std::size_t>(i.b)] += by * at_a;
        return;
      }
      default:
        a += by;
        (*adjoint)[static_cast<std::size_t>(i.b)] += i.code == Code::kAdd ? by : -by;
    }
  }

  /// Each rounding of all makes the same share of the error; no bits that a result has not.
  void allocate(double error) {
    const Program& p = out_.program;
    const auto roundings = static_cast<double>(std::count_if(
        out_.signals.begin(), out_.signals.end(), [](const FixedSignal& s) { return s.is_used; }));
    for (std::size_t s = 0; s < out_.signals.size(); ++s) {
      FixedSignal& signal = out_.signals[s];
      const double bits =
          sensitivity_[s] > 0 ? std::log2(sensitivity_[s] * roundings / (2 * error)) : 0;
      signal.fraction =
          static_cast<int>(std::clamp(std::ceil(bits), -kMostBits + 1.0, kMostBits - 1.0));
      if (signal.kind == FixedSignal::Kind::kConstant)
        signal.fraction = shortest(constants_[s].value(), signal.fraction);
    }
    for (const Program::Instruction& i : p.body) {
      int& fraction = at(i.result).fraction;
      const int a = at(i.a).fraction, b = at(i.b).fraction;
      fraction = i.code == Code::kNegate     ? a
                 : i.code == Code::kMultiply ? std::min(fraction, a + b)
                                             : std::min(fraction, std::max(a, b));
    }
  }
  FixedSignal& at(int slot) { return out_.signals[static_cast<std::size_t>(slot)]; }

  /// Errors of all signals, and of forces. @return the largest of forces
  double certify() {
    const Program& p = out_.program;
    for (FixedSignal& signal : out_.signals) signal.error = 0;
    out_.forces.assign(p.outputs.size(), {});
    std::vector<double> e(out_.signals.size(), 0);
    for (std::size_t s = 0; s < e.size(); ++s)
      if (out_.signals[s].kind == FixedSignal::Kind::kConstant) e[s] = errorOfConstant(s);
    for (const Program::Load& load : p.loads)
      e[static_cast<std::size_t>(load.slot)] = lastPlace(at(load.slot).fraction) / 2 + kLibrary;
    overBoxes([&](const auto& slot) {
      for (const Program::Instruction& i : p.body) {
        const double a = e[static_cast<std::size_t>(i.a)];
        double& off = e[static_cast<std::size_t>(i.result)];
        if (i.code == Code::kNegate) {
          off = a;
          continue;
        }
        const double b = e[static_cast<std::size_t>(i.b)];
        off = i.code == Code::kMultiply ? most(slot(i.a)) * b + most(slot(i.b)) * a + a * b : a + b;
        if (dropped(i) > 0) off += lastPlace(at(i.result).fraction) / 2;
        off *= 1 + 8 * RunningError::kUnitRoundoff;
      }
      for (std::size_t s = 0; s < e.size(); ++s)
        out_.signals[s].error = std::max(out_.signals[s].error, e[s]);
    });
    double worst = 0;
    for (std::size_t i = 0; i < p.outputs.size(); ++i) {
      out_.forces[i].certified = at(p.outputs[i]).error;
      worst = std::max(worst, out_.forces[i].certified);
    }
    return worst;
  }

  double errorOfConstant(std::size_t s) const {
    const double c = constants_[s].value();
    const double scaled = std::ldexp(c, out_.signals[s].fraction);
    return std::ldexp(std::abs(std::nearbyint(scaled) - scaled), -out_.signals[s].fraction) +
           constants_[s].bound();
  }

  /// Bits that an instruction's result loses.
  int dropped(const Program::Instruction& i) const {
    const auto fraction = [&](int slot) {
      return out_.signals[static_cast<std::size_t>(slot)].fraction;
    };
    const int there = i.code == Code::kMultiply ? fraction(i.a) + fraction(i.b)
                                                : std::max(fraction(i.a), fraction(i.b));
    return there - fraction(i.result);
  }

  // ---- integer bits

  void giveIntegerBits() {
    for (FixedSignal& signal : out_.signals)
      signal.integer =
          integerBits(std::max(std::abs(signal.low), std::abs(signal.high)) + signal.error);
    for (const Program::Instruction& i : out_.program.body)
      out_.shifts += i.code != Code::kNegate && dropped(i) > 0 ? 1 : 0;
  }

  void requireHeld() const {
    if (const int bits = out_.widestProduct(); bits > kMostBits)
      throw scene::InputError(
          {scene_.file.string()},
          fmt::format(
              "fixed point: an error of {:.3g} [N m, N] takes products of {} bits, allowed: "
              "up to {} (int64_t), with a larger --error",
              out_.error, bits, kMostBits));
  }

  const scene::Scene& scene_;
  const std::vector<JointRanges>& ranges_;
  FixedPoint out_;
  std::vector<RunningError> constants_;
  std::vector<int> pieces_;
  std::vector<double> sensitivity_;
};

}  // namespace

int FixedSignal::word() const {
  return std::max(1, 1 + integer + fraction);
}

int FixedPoint::widestWord() const {
  int widest = 1;
  for (const FixedSignal& signal : signals) widest = std::max(widest, signal.word());
  return widest;
}

int FixedPoint::widestProduct() const {
  const auto at = [&](int slot) -> const FixedSignal& {
    return signals[static_cast<std::size_t>(slot)];
  };
  int widest = widestWord();
  for (const Program::Instruction& i : program.body) {
    if (i.code == Code::kNegate) continue;
    const FixedSignal &a = at(i.a), &b = at(i.b);
    // two integer parts, and one bit for the half that is added before a shift
    const int bits = i.code == Code::kMultiply
                         ? a.word() + b.word()
                         : 3 + std::max(a.integer, b.integer) + std::max(a.fraction, b.fraction);
    widest = std::max(widest, bits);
  }
  return widest;
}

bool FixedPoint::isKept() const {
  return std::all_of(forces.begin(), forces.end(),
                     [](const FixedForce& f) { return f.measured <= f.certified; });
}

FixedPoint fixedPoint(const scene::Scene& scene, const std::vector<JointRanges>& ranges,
                      double error, const std::function<void(const std::string&)>& stage) {
  stage("word lengths");
  FixedPoint out = Planner(scene, ranges, error).run();
  out.code = fixedPointC(scene, out);
  stage("the code beside double");
  runFixedPoint(scene, ranges, &out);
  return out;
}

}  // namespace dynwitness::crosscheck
