// SPDX-License-Identifier: GPL-3.0-or-later
// Whole steps of time: of trees by semi-implicit Euler and Runge-Kutta 4, of closed loops by
// semi-implicit Euler, beside the engines' own steps in one run. An engine is timed where its step
// is seen to be the same as ours; where it is not, it is left out with the reason.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/chart/raw_engines.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/closed_states.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "recursive/build_model.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constraints.hpp"
#include "recursive/fast/closed_dynamics.hpp"
#include "recursive/point_springs.hpp"
#include "tests/benchmarks/benchmark_parts.hpp"
#include "tests/benchmarks/fast_by_compiler.hpp"
#include "tests/fixtures/lanes/many_steps.hpp"

namespace dynwitness::benchmarks {
namespace {

using namespace crosscheck;
using recursive::Constraints;
using recursive::Model;
using recursive::fast::Integrator;
using State = scene::State<double>;
namespace fast = recursive::fast;

/// Of who makes one step after the other from one state: so short that the state stays what it is.
constexpr double kTimedStep = 1e-9;  // [s]

/// A scene, its model and its states, read once.
struct Case {
  explicit Case(const std::string& name)
      : scene(scene::findScene(name)),
        number(scene.mechanism),
        model(recursive::buildModel(scene.mechanism, number)),
        closures(recursive::buildConstraints(scene.mechanism, number, model)),
        springs(recursive::buildPointSprings(scene.mechanism, number, model)) {
    if (!isClosed()) {
      for (int k = 0; k < kStates; ++k)
        states.push_back(drawState(scene.mechanism, name, kSeed, k));
      return;
    }
    const ClosedState drawn = ClosedStates(scene).draw(kSeed, 0);
    if (!drawn.failure.empty()) throw std::runtime_error(drawn.failure);
    states.push_back(drawn.state.state);
    normalize(&states.back());
  }
  bool isClosed() const { return !closures.closures.empty(); }

  /// Engines do with quaternions what we leave.
  void normalize(State* s) const {
    for (const recursive::LinkModel<double>& link : model.links) {
      if (link.kind != recursive::JointKind::kFloating) continue;
      double square = 0;
      for (int k = 3; k < 7; ++k) square += s->x[link.slot + k].q * s->x[link.slot + k].q;
      for (int k = 3; k < 7; ++k) s->x[link.slot + k].q /= std::sqrt(square);
    }
  }

  scene::Scene scene;
  scene::RealNumbers<double> number;
  Model<double> model;
  Constraints<double> closures;
  std::vector<recursive::PointSpring<double>> springs;
  std::vector<State> states;
};

const Case& caseOf(const std::string& name) {
  static std::map<std::string, Case> all;
  return all.try_emplace(name, name).first->second;
}

// ---- our own steps, one state at a time ---------------------------------------------------------

class OwnSteps : public RawSteps {
 public:
  OwnSteps(const Model<double>& model, double h)
      : h_(h),
        plan_(model),
        x_(model.positions),
        u_(model.dof()),
        moved_(model.positions),
        rates_are_derivatives_(model.positions == model.dof()) {}
  void start(const State& s) override {
    q_.clear();
    for (const scene::JointPosition<double>& x : s.x) q_.push_back(x.q);
    qd_ = s.qd;
    tau_ = s.tau;
  }
  std::vector<double> positions() const override { return q_; }
  std::vector<double> rates() const override { return qd_; }

 protected:
  /// The end of a step of semi-implicit Euler.
  void move(const std::vector<double>& qdd) {
    fast::detail::advance(qd_, h_, qdd, qd_);
    if (rates_are_derivatives_) return fast::detail::advance(q_, h_, qd_, q_);
    for (std::size_t k = 0; k < qd_.size(); ++k) u_[k] = Lane(h_ * qd_[k]);
    for (std::size_t k = 0; k < q_.size(); ++k) x_[k].q = moved_[k] = Lane(q_[k]);
    fast::detail::movePositions<2>(plan_, x_.data(), u_.data(), moved_.data());
    for (std::size_t k = 0; k < q_.size(); ++k) q_[k] = moved_[k].v[0];
  }
  void positionRates(const std::vector<double>& q, const std::vector<double>& qd,
                     std::vector<double>* rates) {
    if (rates_are_derivatives_) {
      *rates = qd;
      return;
    }
    for (std::size_t k = 0; k < qd.size(); ++k) u_[k] = Lane(qd[k]);
    for (std::size_t k = 0; k < q.size(); ++k) x_[k].q = Lane(q[k]);
    fast::detail::positionRates(plan_, x_.data(), u_.data(), moved_.data());
    for (std::size_t k = 0; k < q.size(); ++k) (*rates)[k] = moved_[k].v[0];
  }

  double h_;
  fast::Plan<double> plan_;
  std::vector<double> q_, qd_, tau_;

 private:
  using Lane = fast::States<2>;  // both lanes hold the state
  std::vector<scene::JointPosition<Lane>> x_;
  std::vector<Lane> u_, moved_;
  bool rates_are_derivatives_;  ///< no joint has a quaternion
};

/// By the general sweep for speed.
class FastSteps : public OwnSteps {
 public:
  FastSteps(const Model<double>& model, const RawStep& step)
      : OwnSteps(model, step.h),
        is_runge_kutta_(step.is_runge_kutta),
        sweeps_(kFastByOwn.make(&model), kFastByOwn.release),
        qdd_(model.dof()),
        q_rate_(model.positions) {}
  void step() override {
    if (is_runge_kutta_) return rungeKutta();
    kFastByOwn.forwardDynamics(sweeps_.get(), q_.data(), qd_.data(), tau_.data(), qdd_.data());
    move(qdd_);
  }

 private:
  void rungeKutta() {
    q_at_ = q_;
    qd_at_ = qd_;
    for (int stage = 0;; ++stage) {
      kFastByOwn.forwardDynamics(sweeps_.get(), q_at_.data(), qd_at_.data(), tau_.data(),
                                 qdd_.data());
      positionRates(q_at_, qd_at_, &q_rate_);
      if (stage == 0) {
        q_sum_ = q_rate_;
        qd_sum_ = qdd_;
      } else {
        const double weight = stage == 3 ? 1 : 2;
        fast::detail::advance(q_sum_, weight, q_rate_, q_sum_);
        fast::detail::advance(qd_sum_, weight, qdd_, qd_sum_);
      }
      if (stage == 3) break;
      const double way = stage == 2 ? h_ : h_ / 2;
      fast::detail::advance(q_, way, q_rate_, q_at_);
      fast::detail::advance(qd_, way, qdd_, qd_at_);
    }
    fast::detail::advance(q_, h_ / 6, q_sum_, q_);
    fast::detail::advance(qd_, h_ / 6, qd_sum_, qd_);
  }

  bool is_runge_kutta_;
  std::unique_ptr<void, void (*)(void*)> sweeps_;
  std::vector<double> qdd_, q_rate_, q_at_, qd_at_, q_sum_, qd_sum_;
};

/// Of closed loops, by M as the fast sweeps have it.
class FastClosedSteps : public OwnSteps {
 public:
  FastClosedSteps(const Model<double>& model, const Constraints<double>& closures,
                  const std::vector<recursive::PointSpring<double>>& springs, double h)
      : OwnSteps(model, h), dynamics_(model, closures, springs), qdd_(model.dof()) {}
  void step() override {
    dynamics_.forwardDynamics(q_.data(), qd_.data(), tau_.data(), qdd_.data());
    move(qdd_);
  }

 private:
  fast::ClosedDynamics dynamics_;
  std::vector<double> qdd_;
};

/// The same by the articulated-body sweeps that eliminate loops.
class ClosedSteps : public OwnSteps {
 public:
  ClosedSteps(const Model<double>& model, const Constraints<double>& closures,
              const std::vector<recursive::PointSpring<double>>& springs, double h)
      : OwnSteps(model, h),
        model_(model),
        closures_(closures),
        springs_(springs),
        ws_(model_),
        x_(model.positions) {}
  void step() override {
    for (std::size_t k = 0; k < q_.size(); ++k) x_[k] = scene::jointPosition(q_[k]);
    recursive::constraintEquations(model_, x_, qd_, ws_, closures_);
    pulled_ = tau_;
    recursive::addSpringForces(model_, springs_, closures_.X_W, ws_, pulled_);
    move(recursive::closedForwardDynamics(model_, x_, qd_, pulled_, closures_, ws_).qdd);
  }

 private:
  Model<double> model_;
  Constraints<double> closures_;
  std::vector<recursive::PointSpring<double>> springs_;
  recursive::Workspace<double> ws_;
  std::vector<scene::JointPosition<double>> x_;
  std::vector<double> pulled_;
};

// ---- whether a step is the same as ours ---------------------------------------------------------

/// What a step changes, by its length.
struct Change {
  std::vector<double> q, qd;

  Change(RawSteps& by, const State& from, double h) {
    by.start(from);
    by.step();
    q = by.positions();
    qd = by.rates();
    for (std::size_t k = 0; k < q.size(); ++k) q[k] = (q[k] - from.x[k].q) / h;
    for (std::size_t k = 0; k < qd.size(); ++k) qd[k] = (qd[k] - from.qd[k]) / h;
  }
};

/// Of the largest entry of ours.
double apart(const std::vector<double>& ours, const std::vector<double>& its) {
  double difference = 0, largest = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const double d = std::abs(ours[k] - its.at(k));
    if (!(d <= difference)) difference = std::isnan(difference) ? difference : d;
    largest = std::max(largest, std::abs(ours[k]));
  }
  return difference / largest;
}

/** What engines read loses digits (MuJoCo's inertias), what they do with quaternions differs by
    O(h^2): their steps are the same as ours where the first digits are. Seen: up to 2e-5 of qd and
    2e-4 of q, 2e-4 of loops that hold softly; Euler's method misses Runge and Kutta's q by 1e-2. */
constexpr double kFirstDigits = 1e-3;

void requireSameChange(const Change& ours, const Change& its) {
  const double q = apart(ours.q, its.q), qd = apart(ours.qd, its.qd);
  if (!(q <= kFirstDigits && qd <= kFirstDigits))
    throw std::runtime_error(fmt::format(
        "its step is another one: after it q differs by {:.2g} and qd by {:.2g} of what "
        "they change",
        q, qd));
}

/** Semi-implicit Euler moves joints of one axis by  q + h qd,  qd being that at the end, to the
    rounding of the product and of the sum, once in ours and once in its step.
    @param its  after a step from `from` */
void requireSemiImplicit(const Model<double>& model, const State& from, const RawSteps& its,
                         double h) {
  const std::vector<double> q = its.positions(), qd = its.rates();
  for (const recursive::LinkModel<double>& link : model.links) {
    if (link.dof < 0 || recursive::axisCount(link.kind) != 1) continue;
    const double moved = h * qd[link.dof], end = from.x[link.slot].q + moved;
    const double bound = std::numeric_limits<double>::epsilon() * (std::abs(end) + std::abs(moved));
    if (!(std::abs(q[link.slot] - end) <= bound))
      throw std::runtime_error(fmt::format("it is not semi-implicit: q[{}] is {:.2g} off q + h qd",
                                           link.slot, std::abs(q[link.slot] - end)));
  }
}

// ---- who takes part -----------------------------------------------------------------------------

constexpr struct {
  const char* name;
  bool is_runge_kutta;
} kMethods[] = {{kStep, false}, {kRungeKuttaStep, true}};

using MakeSteps = std::function<std::unique_ptr<RawSteps>(const Case&, const RawStep&)>;

struct Engine {
  Contender contender;
  MakeSteps make;
  bool has_rotors = false, holds_softly = false;
};

std::unique_ptr<RawSteps> ourSteps(const Case& of, const Model<double>& model, const RawStep& step,
                                   bool with_springs) {
  if (!of.isClosed()) return std::make_unique<FastSteps>(model, step);
  return std::make_unique<FastClosedSteps>(
      model, of.closures, with_springs ? of.springs : decltype(of.springs)(), step.h);
}

/// @throws std::exception  why the engine's step is not the same as ours
void requireSameStep(const Case& of, const Engine& engine, bool is_runge_kutta) {
  const Model<double> bare = bareModel(of.model, engine.has_rotors);
  // the engine shall not correct a loop that the step opens, which is by h^2
  const double h = of.isClosed() ? 0x1p-20 : 0x1p-10;  // [s]
  State from = of.states[0];
  if (!of.isClosed()) from = stateForCheck(bare, from);
  // what holds softly knows nothing of the velocity products of closures
  if (engine.holds_softly) std::fill(from.qd.begin(), from.qd.end(), 0.0);
  const std::unique_ptr<RawSteps> its = engine.make(of, {is_runge_kutta, h});
  const Change change(*its, from, h);
  // what closes loops moves q by a rounding besides
  if (!is_runge_kutta && !of.isClosed()) requireSemiImplicit(bare, from, *its, h);
  const Change ours(*ourSteps(of, bare, {is_runge_kutta, h}, false), from, h);
  requireSameChange(ours, change);
  if (!is_runge_kutta) return;
  const Change euler(*ourSteps(of, bare, {false, h}, false), from, h);
  if (apart(ours.q, euler.q) <= kFirstDigits)
    throw std::logic_error("the step is too short to tell methods apart");
}

/// Goes on from one state.
void goOn(benchmark::State& run, const std::string& scene, bool is_runge_kutta,
          const MakeSteps& make) {
  const Case& of = caseOf(scene);
  const std::unique_ptr<RawSteps> steps = make(of, {is_runge_kutta, kTimedStep});
  steps->start(of.states[0]);
  for (auto _ : run) {
    steps->step();
    benchmark::ClobberMemory();
  }
}

/// Steps from all states: of no length, so that they stay what they are.
void stepMany(benchmark::State& run, const std::string& scene, bool is_runge_kutta) {
  const Case& of = caseOf(scene);
  Rows rows(of.model, of.states, true);
  fast::ManySteps many(of.model);
  for (auto _ : run) {
    many.step(kStates, is_runge_kutta ? Integrator::kRungeKutta4 : Integrator::kSemiImplicitEuler,
              0, 1, {rows.q.data(), rows.nq}, {rows.qd.data(), rows.n}, rows.given());
    benchmark::DoNotOptimize(rows.q.data());
    benchmark::ClobberMemory();
  }
  run.counters[kStatesCounter] = kStates;
}

template <typename Function>
void add(BenchResult* result, const Contender& contender, const std::string& scene,
         const char* method, const Function& function) {
  addContender(result, contender);
  benchmark::RegisterBenchmark(fmt::format("{}/{}/{}", scene, method, contender.name).c_str(),
                               [=](benchmark::State& run) {
                                 try {
                                   function(run);
                                 } catch (const std::exception& error) {
                                   run.SkipWithError(error.what());
                                 }
                               });
}

void leaveOut(BenchResult* result, const std::string& what) {
  if (std::find(result->left_out.begin(), result->left_out.end(), what) == result->left_out.end())
    result->left_out.push_back(what);
}

void addEngine(BenchResult* result, const std::string& scene, const Engine& engine, int method) {
  const auto& [name, is_runge_kutta] = kMethods[method];
  try {
    requireSameStep(caseOf(scene), engine, is_runge_kutta);
    add(result, engine.contender, scene, name,
        [=, make = engine.make, is_runge_kutta = is_runge_kutta](benchmark::State& run) {
          goOn(run, scene, is_runge_kutta, make);
        });
  } catch (const std::invalid_argument& error) {  // of any scene
    leaveOut(result, fmt::format("{}, {}: {}", engine.contender.label, name, error.what()));
  } catch (const std::exception& error) {
    leaveOut(result,
             fmt::format("{}, {} of {}: {}", engine.contender.label, name, scene, error.what()));
  }
}

}  // namespace

void registerSteps(BenchResult* result) {
  const MakeSteps mujoco = [](const Case& of, const RawStep& step) {
    return rawSteps(kMujoco.name, of.scene, of.model, of.closures, step);
  };
  const MakeSteps simbody = [](const Case& of, const RawStep& step) {
    return rawSteps(kSimbody.name, of.scene, bareModel(of.model, false), of.closures, step);
  };
  const MakeSteps dart = [](const Case& of, const RawStep& step) {
    if (of.isClosed())
      throw std::invalid_argument(
          "its closures ask velocities of the solver of its contacts, no accelerations");
    return rawSteps(kDart.name, of.scene, bareModel(of.model, false), of.closures, step);
  };
  std::vector<Engine> of_trees, of_loops;
  const Contender of_simbody{kRawSimbody, "Simbody " + versionOf("simbody")};
  if (const std::string version = versionOf("mujoco"); !version.empty()) {
    of_trees.push_back({{kRawMujoco, "MuJoCo " + version}, mujoco, true});
    of_loops.push_back(
        {{"mujoco_soft", "MuJoCo " + version + ", closures hold softly"}, mujoco, true, true});
  }
  of_trees.push_back({of_simbody, simbody});
  of_loops.push_back({of_simbody, simbody});
  if (const std::string version = versionOf("dart"); !version.empty()) {
    const Engine engine{{"dart_raw", "DART " + version}, dart};
    of_trees.push_back(engine);
    of_loops.push_back(engine);
  }
  const std::string own = kFastByOwn.compiler();
  const Contender one{"fast", "fast sweeps, " + own, true},
      lanes{"fast_lanes", fastLanesLabel(), true},
      textbook{"recursive", "textbook sweeps, " + own, true};
  for (const char* scene : kScenes)
    for (const int method : {0, 1}) {
      const auto& [name, is_runge_kutta] = kMethods[method];
      for (const Engine& engine : of_trees) addEngine(result, scene, engine, method);
      add(result, one, scene, name, [=, is_runge_kutta = is_runge_kutta](benchmark::State& run) {
        goOn(run, scene, is_runge_kutta, [](const Case& of, const RawStep& step) {
          return ourSteps(of, of.model, step, true);
        });
      });
      add(result, lanes, scene, name, [=, is_runge_kutta = is_runge_kutta](benchmark::State& run) {
        stepMany(run, scene, is_runge_kutta);
      });
    }
  for (const char* scene : kClosedScenes) {
    for (const Engine& engine : of_loops) addEngine(result, scene, engine, 0);
    add(result, textbook, scene, kStep, [=](benchmark::State& run) {
      goOn(run, scene, false, [](const Case& of, const RawStep& step) {
        return std::make_unique<ClosedSteps>(of.model, of.closures, of.springs, step.h);
      });
    });
    add(result, one, scene, kStep, [=](benchmark::State& run) {
      goOn(run, scene, false,
           [](const Case& of, const RawStep& step) { return ourSteps(of, of.model, step, true); });
    });
  }
}

}  // namespace dynwitness::benchmarks
