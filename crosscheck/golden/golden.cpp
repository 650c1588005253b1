// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/golden/golden.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/golden/worst_state.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/witnesses/outside_judge.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Quantities = std::vector<Quantity>;
using State = scene::State<double>;

constexpr int kDigits = 50;
constexpr long kAccuracy = 176;  ///< [bits] 50 digits, and what their rounding must not see
constexpr long kLimitBits = 256;
constexpr int kMostRates = 64;  ///< M, qdd and T of more are for those who ask for them
constexpr long kBitsALink = 8;  ///< balls of a chain widen by about half of that
constexpr long kMostNumbers = 4000000;

const Quantities kAll(std::begin(kGoldenQuantities), std::end(kGoldenQuantities));

// ---- questions

/// Builds the groups one by one.
class Questions {
 public:
  Questions(const scene::Scene& scene, const GoldenOptions& options)
      : options_(options), mechanism_(scene.mechanism), name_(scene.name), n_(mechanism_.dof()) {
    out_.scene = scene;
    out_.seed = options.seed;
    wanted_ = options.quantities;
    if (wanted_.empty()) {
      wanted_ = kAll;
      if (n_ > kMostRates) {
        const auto is_dear = [](Quantity q) {
          return q == Quantity::kM || q == Quantity::kQdd || q == Quantity::kKinetic;
        };
        wanted_.erase(std::remove_if(wanted_.begin(), wanted_.end(), is_dear), wanted_.end());
        out_.left_out.push_back(
            fmt::format("M, kinetic, qdd: n^2 numbers a state and limits that cost n^2 and n^3 "
                        "operations, and n = {} rates; --quantity asks for them",
                        n_));
        wanted_.erase(std::remove(wanted_.begin(), wanted_.end(), Quantity::kReactions),
                      wanted_.end());
        out_.left_out.emplace_back(
            "reactions: 6 numbers a link, and those that are 0 take thousands of bits to say so; "
            "--quantity asks for them");
      }
    }
    base_ = drawn(0);
    for (double& rate : base_.qd)
      if (rate == 0) rate = 1;
  }

  Golden ask() {
    atRest();
    unitAccelerations();
    ratesAlone();
    generic();
    largeAngles();
    tinyRates();
    worstKnown();
    if (out_.groups.empty())
      throw scene::InputError({}, "--quantity: no group of states asks for these alone, allowed: " +
                                      std::string("also tau, which all groups ask for"));
    if (out_.numbers() > kMostNumbers)
      throw scene::InputError(
          {out_.scene.file.string()},
          fmt::format("{} numbers to certify, allowed: {}; fewer with --random and --quantity",
                      out_.numbers(), kMostNumbers));
    return std::move(out_);
  }

 private:
  State drawn(std::uint64_t index) const {
    return plainState(mechanism_, name_ + " golden", options_.seed, index);
  }
  std::vector<double> zeros() const { return std::vector<double>(base_.qd.size(), 0.0); }
  /// The base position, at rest.
  State still() const {
    State state = base_;
    state.qd = state.qdd = zeros();
    return state;
  }
  const std::string& rate(int i) const { return labels_[static_cast<std::size_t>(i)]; }

  GoldenGroup& group(const char* name, const char* sentence, long of = 0) {
    out_.groups.push_back({name, sentence, of, {}});
    return out_.groups.back();
  }
  /// Adds a state, if anything that it is good for is wanted.
  void add(GoldenGroup& group, std::string note, const State& state, const Quantities& good_for) {
    GoldenState one;
    for (const Quantity quantity : wanted_)
      if (std::count(good_for.begin(), good_for.end(), quantity) > 0) one.asked.push_back(quantity);
    if (one.asked.empty()) return;
    one.index = next_++;
    one.note = std::move(note);
    one.state = state;
    group.states.push_back(std::move(one));
  }
  /// After the last state: without any, the group goes.
  void close(const char* why_none = "nothing that it is good for was asked for") {
    if (!out_.groups.back().states.empty()) return;
    out_.left_out.push_back(out_.groups.back().name + ": " + why_none);
    out_.groups.pop_back();
  }

  /// So many of 0 .. count - 1, in order: all, or drawn.
  std::vector<int> some(int count, const char* of_what) const {
    std::set<int> chosen;
    RandomStream random(name_ + " golden " + of_what, options_.seed, 0);
    const int wanted = std::min(count, options_.states);
    if (wanted == count)
      for (int i = 0; i < count; ++i) chosen.insert(i);
    while (static_cast<int>(chosen.size()) < wanted)
      chosen.insert(std::min(count - 1, static_cast<int>(random.uniform(0, count))));
    return {chosen.begin(), chosen.end()};
  }

  void atRest() {
    GoldenGroup& g = group(
        "at_rest",
        "nothing moves: tau is what gravity, springs and loads ask for. What fails here is wrong "
        "in one of these, in a mass, a centre of mass or a placement");
    const Quantities good_for = {Quantity::kg, Quantity::kPotential, Quantity::kTau,
                                 Quantity::kReactions};
    add(g, "the base position", still(), good_for);
    for (int k = 1; k < options_.states; ++k) {
      State state = drawn(static_cast<std::uint64_t>(k));
      state.qd = state.qdd = zeros();
      add(g, "", state, good_for);
    }
    close();
  }

  void unitAccelerations() {
    GoldenGroup& g = group(
        "unit_accelerations",
        "one acceleration is 1 at the base position, and nothing moves: tau less tau of the base "
        "position at rest is a column of M. What fails here, and not at rest, is wrong in M: an "
        "inertia, the point or the axes that it belongs to, a rotor, or how accelerations are "
        "passed on",
        n_);
    bool is_first = true;
    for (const int i : some(n_, "accelerations")) {
      State state = still();
      state.qdd[static_cast<std::size_t>(i)] = 1;
      // M is the same in all of these
      add(g, fmt::format("'{}' accelerates", rate(i)), state,
          is_first ? Quantities{Quantity::kM, Quantity::kTau} : Quantities{Quantity::kTau});
      is_first = false;
    }
    close();
  }

  void ratesAlone() {
    const std::vector<int> chosen = some(n_, "rates");
    GoldenGroup& alone = group(
        "one_joint_moving",
        "one rate is not zero at the base position, and nothing accelerates: c has that rate's own "
        "centrifugal terms, in qd_i^2, and tau its friction besides. What fails here first is "
        "wrong in one of these",
        n_);
    const auto with = [&](const std::vector<int>& rates) {
      State state = still();
      for (const int i : rates)
        state.qd[static_cast<std::size_t>(i)] = base_.qd[static_cast<std::size_t>(i)];
      return state;
    };
    for (const int i : chosen)
      add(alone, fmt::format("'{}' moves", rate(i)), with({i}),
          {Quantity::kc, Quantity::kKinetic, Quantity::kMomentum, Quantity::kTau});
    close();

    GoldenGroup& pairs = group(
        "two_joints_moving",
        "two rates are not zero at the base position, each as large as alone: c less c of each "
        "alone is their Coriolis term, in qd_i qd_j. What fails here first is wrong in one of "
        "these",
        static_cast<long>(n_) * (n_ - 1) / 2);
    std::vector<std::pair<int, int>> all;  // of the rates that were seen alone
    for (std::size_t a = 0; a < chosen.size(); ++a)
      for (std::size_t b = a + 1; b < chosen.size(); ++b) all.emplace_back(chosen[a], chosen[b]);
    for (const int k : some(static_cast<int>(all.size()), "pairs")) {
      const auto [i, j] = all[static_cast<std::size_t>(k)];
      add(pairs, fmt::format("'{}' and '{}' move", rate(i), rate(j)), with({i, j}),
          {Quantity::kc, Quantity::kTau});
    }
    close(n_ < 2 ? "one rate alone" : "nothing that it is good for was asked for");
  }

  void generic() {
    GoldenGroup& g = group(
        "generic",
        "everything at once, at other positions. What fails here first lies in how terms are put "
        "together, in three rates or more, in what a program keeps from call to call, or at "
        "positions like these");
    for (int k = 0; k < options_.states; ++k)
      add(g, "", drawn(static_cast<std::uint64_t>(options_.states + k)), kAll);
    close();
  }

  void largeAngles() {
    constexpr int kBits = 4;
    constexpr double kReach = 65536;  // [rad], 20 bits with the grid: exact in single precision
    GoldenGroup& g = group(
        "large_angles",
        "angles of many turns, up to 65536 rad (but for screws), and nothing else that is unusual. "
        "What fails here first are sines and cosines of large angles");
    const std::vector<std::size_t> angles = freeAngles();
    for (int k = 0; !angles.empty() && k < options_.states; ++k) {
      State state = drawn(static_cast<std::uint64_t>(2 * options_.states + k));
      RandomStream random(name_ + " golden turns", options_.seed, static_cast<std::uint64_t>(k));
      for (const std::size_t i : angles)
        state.x[i] = scene::jointPosition(onGrid(random.uniform(-kReach, kReach), kBits));
      add(g, "", state, kAll);
    }
    close(angles.empty() ? "no joint turns and stays where it is"
                         : "nothing that it is good for was asked for");
  }

  /// Slots of angles that move no link away: a screw's does.
  std::vector<std::size_t> freeAngles() const {
    std::vector<std::size_t> out;
    std::size_t slot = 0;
    for (const int i : mechanism_.movingLinks()) {
      const scene::JointKind kind = mechanism_.links[static_cast<std::size_t>(i)].joint.kind;
      for (const scene::SlotKind is : scene::positionSlots(kind)) {
        if (is == scene::SlotKind::kAngle && kind != scene::JointKind::kHelical)
          out.push_back(slot);
        ++slot;
      }
    }
    return out;
  }

  void tinyRates() {
    constexpr int kBits = 20;
    constexpr int kMost = 9;
    GoldenGroup& g = group(
        "tiny_rates",
        "rates of 1 to 9 times 2^-20 at the base position, and nothing accelerates. What fails "
        "here first finds c as a difference of larger numbers (tau with and without rates), or "
        "takes small rates for 0");
    for (int k = 0; k < options_.states; ++k) {
      State state = still();
      RandomStream random(name_ + " golden tiny", options_.seed, static_cast<std::uint64_t>(k));
      for (double& x : state.qd) {
        const double size = 1 + std::floor(random.uniform(0, kMost));
        x = std::ldexp(random.uniform(0, 1) < 0.5 ? -size : size, -kBits);
      }
      add(g, "", state, {Quantity::kc, Quantity::kKinetic, Quantity::kMomentum, Quantity::kTau});
    }
    close();
  }

  void worstKnown() {
    GoldenGroup& g = group(
        "worst_known",
        "the states at which rounding may take the most of a quantity, as far as a short search "
        "found them; it proves nothing about others. What fails here alone loses more digits than "
        "an algorithm of the usual kinds needs to lose");
    const PreparedScene prepared(out_.scene);
    for (const Quantity quantity : {Quantity::kg, Quantity::kc, Quantity::kTau, Quantity::kQdd}) {
      if (std::count(wanted_.begin(), wanted_.end(), quantity) == 0) continue;
      if (quantity == Quantity::kQdd && n_ > kMostRates) {
        out_.left_out.push_back("worst_known of qdd: the search costs n^3 operations");
        continue;
      }
      const WorstState worst = worstState(prepared, quantity, options_.seed);
      if (worst.loss == 0) {
        out_.left_out.push_back(
            fmt::format("worst_known of {}: it is 0, or has no limit, wherever the search looked",
                        crosscheck::name(quantity)));
        continue;
      }
      const auto digits = [](double loss) {
        return loss > 0 ? fmt::format("{:.1f}", std::max(0.0, -std::log10(loss)))
                        : std::string("all");
      };
      add(g,
          fmt::format("the worst for {} of {} states: rounding may leave {} digits of its largest "
                      "entry, where it leaves {} at half of the states",
                      crosscheck::name(quantity), worst.looked_at, digits(worst.loss),
                      digits(worst.usual)),
          worst.state, {Quantity::kM, Quantity::kc, Quantity::kg, Quantity::kTau, Quantity::kQdd});
    }
    close();
  }

  const GoldenOptions& options_;
  const scene::Mechanism& mechanism_;
  std::string name_;
  int n_;
  std::vector<std::string> labels_ = mechanism_.rateLabels();
  Quantities wanted_;
  State base_;
  Golden out_;
  int next_ = 0;
};

// ---- answers

/// "[mid +/- radius]", "[+/- radius]" or an exact "mid", as Arb writes them.
struct Written {
  std::string digits = "0";
  double radius = 0;
};
Written written(const Ball& x) {
  const std::string text = x.text(kDigits);
  if (text.empty() || text.front() != '[') return {text, 0};
  const std::size_t sign = text.find("+/- ");
  if (sign == std::string::npos) throw std::logic_error("written: no radius in " + text);
  Written out;
  if (sign > 1) out.digits = text.substr(1, sign - 2);
  // a radius below the smallest normal double is not told from that
  out.radius =
      std::max(std::strtod(text.c_str() + sign + 4, nullptr), std::numeric_limits<double>::min());
  return out;
}

/// At three digits, not below x.
double roundedUp(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  const auto atThree = [](double y) {
    return std::strtod(fmt::format("{:.2e}", y).c_str(), nullptr);
  };
  constexpr double kHalfAUnit = 1.005;
  const double near = atThree(x);
  return near >= x ? near : atThree(x * kHalfAUnit);
}

/// What is asked of one scene.
class Answers {
 public:
  explicit Answers(const scene::Scene& scene)
      : prepared_(scene),
        truth_(scene.mechanism, kAccuracy,
               std::max(Truth::kMaxBits,
                        kBitsALink * static_cast<long>(scene.mechanism.links.size()))),
        bound_(prepared_) {}

  GoldenAnswer operator()(Quantity quantity, const State& state) {
    GoldenAnswer out;
    out.quantity = quantity;
    const Certified truth = truth_(quantity, state);
    if (!truth.exists()) {
      out.none = truth.reason;
      return out;
    }
    const BallPrecision precision(kLimitBits);
    Eigen::MatrixXd bound = bound_(quantity, state);
    MatrixX<Ball> exact = truth.value;
    if (quantity == Quantity::kReactions) {  // a row a joint
      exact = truth.value.reshaped<Eigen::RowMajor>(truth.value.size() / 6, 6).eval();
      bound = bound.reshaped<Eigen::RowMajor>(bound.size() / 6, 6).eval();
    }
    out.value = exact.unaryExpr([](const Ball& x) { return x.containsZero() ? 0.0 : x.mid(); });
    out.radius = out.limit = Eigen::MatrixXd::Zero(out.value.rows(), out.value.cols());
    for (Eigen::Index k = 0; k < out.value.size(); ++k) {
      const Ball& x = exact.data()[k];
      const Written text = written(x);
      out.digits.push_back(text.digits);
      out.radius.data()[k] = text.radius;
      // the answer is held against the double beside the truth: that much more, and a rounding of
      // the difference, which the third digit leaves room for
      const Ball allowed = Ball(bound.data()[k]) + abs(Ball(out.value.data()[k]) - x);
      out.limit.data()[k] =
          std::isfinite(bound.data()[k]) ? roundedUp(allowed.atMost()) : bound.data()[k];
    }
    return out;
  }

 private:
  PreparedScene prepared_;
  Truth truth_;
  OutsideBound bound_;
};

}  // namespace

long Golden::states() const {
  long count = 0;
  for (const GoldenGroup& group : groups) count += static_cast<long>(group.states.size());
  return count;
}

long Golden::numbers() const {
  const long n = scene.mechanism.dof();
  long count = 0;
  for (const GoldenGroup& group : groups)
    for (const GoldenState& state : group.states)
      for (const Quantity quantity : state.asked) switch (quantity) {
          case Quantity::kM:
            count += n * n;
            break;
          case Quantity::kKinetic:
          case Quantity::kPotential:
            ++count;
            break;
          case Quantity::kMomentum:
            count += 6;
            break;
          case Quantity::kReactions:
            count += 6 * (static_cast<long>(scene.mechanism.links.size()) - 1);
            break;
          default:
            count += n;
        }
  return count;
}

Golden goldenQuestions(const scene::Scene& scene, const GoldenOptions& options) {
  return Questions(scene, options).ask();
}

void answer(Golden& golden) {
  scene::Work work("answers", static_cast<double>(golden.states()));
  Answers answers(golden.scene);
  for (GoldenGroup& group : golden.groups)
    for (GoldenState& state : group.states) {
      for (const Quantity quantity : state.asked)
        state.answers.push_back(answers(quantity, state.state));
      work.done();
    }
}

}  // namespace dynwitness::crosscheck
