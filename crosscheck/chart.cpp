// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/chart.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "crosscheck/arithmetic/eigen_scalar.hpp"
#include "crosscheck/report/environment.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/truth.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr long kTruthBits = 200;
constexpr long kBallBits = 128;
constexpr int kBatches = 20;          // of states; one time is taken for each
constexpr int kRounds = 5;            // over all methods
constexpr double kEnoughSeconds = 1;  // of one method: slow ones get fewer rounds

/// A float of 50 decimal digits that Eigen can hold. (The bare number type of Boost 1.74 does not
/// compile with Eigen 3.4: it asks every matrix expression whether it is a container of bytes.)
class Digits50 {
 public:
  using Float = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                              boost::multiprecision::et_off>;
  Digits50() = default;
  Digits50(int value) : x_(value) {}     // NOLINT(google-explicit-constructor): exact
  Digits50(double value) : x_(value) {}  // NOLINT(google-explicit-constructor): exact
  explicit Digits50(const Float& x) : x_(x) {}
  const Float& value() const { return x_; }

  friend Digits50 operator+(const Digits50& a, const Digits50& b) { return Digits50(a.x_ + b.x_); }
  friend Digits50 operator-(const Digits50& a, const Digits50& b) { return Digits50(a.x_ - b.x_); }
  friend Digits50 operator*(const Digits50& a, const Digits50& b) { return Digits50(a.x_ * b.x_); }
  friend Digits50 operator/(const Digits50& a, const Digits50& b) { return Digits50(a.x_ / b.x_); }
  Digits50 operator-() const { return Digits50(-x_); }
  Digits50& operator+=(const Digits50& b) { return x_ += b.x_, *this; }
  Digits50& operator-=(const Digits50& b) { return x_ -= b.x_, *this; }
  Digits50& operator*=(const Digits50& b) { return x_ *= b.x_, *this; }
  Digits50& operator/=(const Digits50& b) { return x_ /= b.x_, *this; }
  friend bool operator==(const Digits50& a, const Digits50& b) { return a.x_ == b.x_; }
  friend Digits50 sqrt(const Digits50& a) { return Digits50(Float(sqrt(a.x_))); }
  friend Digits50 cos(const Digits50& a) { return Digits50(Float(cos(a.x_))); }
  friend Digits50 sin(const Digits50& a) { return Digits50(Float(sin(a.x_))); }

 private:
  Float x_ = 0;
};

}  // namespace
}  // namespace dynwitness::crosscheck

namespace dynwitness::scene {
template <>
inline crosscheck::Digits50 fromExact<crosscheck::Digits50>(const Exact& x) {
  return crosscheck::Digits50(fromExact<crosscheck::Digits50::Float>(x));
}
}  // namespace dynwitness::scene

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::Digits50>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::Digits50, 8, 100, 150> {};
}  // namespace Eigen

namespace dynwitness::crosscheck {
namespace {

// ------------------------------------------------------------------------------------- methods

using States = std::vector<scene::State<double>>;

/// One method in one scalar, ready to run.
class Method {
 public:
  Method(std::string name, std::string scalar) : name(std::move(name)), scalar(std::move(scalar)) {}
  virtual ~Method() = default;
  virtual void run(int state) = 0;            ///< what is timed
  virtual MatrixOf<Ball> answer() const = 0;  ///< of the last run, exactly as it is

  const std::string name, scalar;
};

template <typename T>
Ball exactly(const T& x) {
  return Ball(x);
}
Ball exactly(const Digits50& x) {
  return Ball(static_cast<scene::Rational>(x.value()));
}

template <typename T>
MatrixOf<Ball> exactlyAll(const MatrixOf<T>& m) {
  const BallPrecision precision(2 * kTruthBits);  // 50 digits are 168 bits
  return m.unaryExpr([](const T& x) { return exactly(x); });
}

template <typename T>
scene::JointPosition<T> positionAt(const T& q) {
  return scene::jointPosition(q);
}
scene::JointPosition<Ball> positionAt(const Ball& q) {
  scene::CosSin<Ball> point = cosSin(q);
  return {q, std::move(point.c), std::move(point.s)};
}

template <typename T>
std::vector<T> converted(const std::vector<double>& v) {
  return std::vector<T>(v.begin(), v.end());
}

enum class Sweep { kNewtonEuler, kCompositeBody, kCompositeBodySolved, kArticulatedBody };

const char* sweepName(Sweep sweep) {
  switch (sweep) {
    case Sweep::kNewtonEuler:
      return "Newton-Euler sweep";
    case Sweep::kCompositeBody:
      return "composite-body sweep";
    case Sweep::kCompositeBodySolved:
      return "mass matrix and L D L'";
    case Sweep::kArticulatedBody:
      return "articulated-body sweep";
  }
  return "?";
}

/// A sweep of recursive/, without any allocation.
template <typename Numbers, typename T = typename Numbers::Scalar>
class SweepMethod : public Method {
 public:
  SweepMethod(Sweep sweep, const std::string& scalar, const scene::Mechanism& mechanism,
              const States& states)
      : Method(sweepName(sweep), scalar),
        sweep_(sweep),
        setup_(recursive::buildModel(mechanism, Numbers(mechanism))),
        zeros_(setup_.zeros()),
        out_(zeros_),
        M_(zeros_.size(), zeros_.size()) {
    for (const scene::State<double>& s : states) {
      states_.push_back({{}, converted<T>(s.qd), converted<T>(s.qdd), converted<T>(s.tau)});
      for (const scene::JointPosition<double>& x : s.x)
        states_.back().x.push_back({static_cast<T>(x.q), T(0), T(0)});
    }
  }

  void run(int state) override {
    const BallPrecision precision(kBallBits);  // for the one scalar that reads it
    scene::State<T>& s = states_[state];
    for (scene::JointPosition<T>& x : s.x) x = positionAt(x.q);
    switch (sweep_) {
      case Sweep::kNewtonEuler:
        recursive::inverseDynamics(setup_.model, s.x, s.qd, s.qdd, setup_.ws, out_);
        break;
      case Sweep::kCompositeBody:
        recursive::massMatrix(setup_.model, s.x, setup_.ws, M_);
        break;
      case Sweep::kCompositeBodySolved:  // M qdd = tau - (c + g - Q)
        recursive::massMatrix(setup_.model, s.x, setup_.ws, M_);
        recursive::inverseDynamics(setup_.model, s.x, s.qd, zeros_, setup_.ws, out_);
        for (std::size_t i = 0; i < out_.size(); ++i) out_[i] = s.tau[i] - out_[i];
        recursive::factorize(M_);
        recursive::solve(M_, out_);
        break;
      case Sweep::kArticulatedBody:
        recursive::forwardDynamics(setup_.model, s.x, s.qd, s.tau, setup_.ws, out_);
        break;
    }
  }
  MatrixOf<Ball> answer() const override {
    return exactlyAll<T>(sweep_ == Sweep::kCompositeBody ? M_ : column(out_));
  }

 private:
  Sweep sweep_;
  Setup<T> setup_;
  std::vector<T> zeros_, out_;
  MatrixX<T> M_;
  std::vector<scene::State<T>> states_;
};

/// What the two derived methods share: the numbers M, c, g and Q in, the quantity out.
class DerivedMethod : public Method {
 public:
  DerivedMethod(const std::string& name, Quantity quantity, int dof, const States& states)
      : Method(name, "double"), quantity_(quantity), states_(states), M_(dof, dof), out_(dof) {}

  MatrixOf<Ball> answer() const override {
    return exactlyAll<double>(quantity_ == Quantity::kM ? M_ : MatrixOf<double>(column(out_)));
  }

 protected:
  /// qdd from M_ and out_ = tau - c - g + Q.
  void solve() {
    recursive::factorize(M_);
    recursive::solve(M_, out_);
  }
  Quantity quantity_;
  States states_;
  MatrixX<double> M_;
  std::vector<double> out_;
};

/// The derived equations as a straight-line program: nothing is computed twice.
class ProgramMethod : public DerivedMethod {
 public:
  ProgramMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : DerivedMethod("straight-line program", quantity, mechanism.dof(), states),
        program_(programFor(quantity, mechanism)),
        run_(program_, scene::RealNumbers<double>(mechanism)),
        results_(program_.outputs.size()) {}

  void run(int state) override {
    scene::State<double>& s = states_[state];
    for (scene::JointPosition<double>& x : s.x) x = scene::jointPosition(x.q);
    const int n = static_cast<int>(out_.size());
    if (quantity_ == Quantity::kTau) {
      run_(s, out_.data());
      return;
    }
    run_(s, results_.data());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) M_(i, j) = results_[i * n + j];
    if (quantity_ == Quantity::kM) return;
    const double *c = &results_[n * n], *g = c + n, *Q = g + n;
    for (int i = 0; i < n; ++i) out_[i] = s.tau[i] - c[i] - g[i] + Q[i];
    solve();
  }

 private:
  static symbolic::Program programFor(Quantity quantity, const scene::Mechanism& mechanism) {
    symbolic::Options options;
    options.fold_parameters = true;
    symbolic::Equations e = symbolic::derive(mechanism, options);
    if (quantity == Quantity::kTau) return symbolic::compile(e.graph, symbolic::inverseDynamics(e));
    std::vector<symbolic::Node> nodes;
    for (const auto& row : e.M) nodes.insert(nodes.end(), row.begin(), row.end());
    if (quantity == Quantity::kQdd)
      for (const auto* part : {&e.c, &e.g, &e.Q})
        nodes.insert(nodes.end(), part->begin(), part->end());
    return symbolic::compile(e.graph, nodes);
  }

  symbolic::Program program_;
  symbolic::ProgramRun<double> run_;
  std::vector<double> results_;
};

/// A formula evaluated as it is printed: every function and every product where it stands.
class PrintedFormula {
 public:
  using Formula = symbolic::Formula;
  using Values = std::map<std::string, double>;  ///< of symbols, and of "cos(...)" of an axis

  PrintedFormula(const Formula& f, const Values& values) : kind_(f.kind), exponent_(f.exponent) {
    switch (f.kind) {
      case Formula::Kind::kNumber:
        value_ = scene::Exact{f.number, 0}.toDouble();
        return;
      case Formula::Kind::kSymbol:
        setConstant(values.at(f.symbol));
        return;
      case Formula::Kind::kInput:
        input_ = f.input;
        joint_ = f.joint;
        return;
      case Formula::Kind::kCos:
      case Formula::Kind::kSin: {
        // the angles of an oblique axis are names without a value; their functions have one
        const Formula& angle = f.operands[0];
        const auto known =
            values.find((f.kind == Formula::Kind::kCos ? "cos(" : "sin(") + angle.symbol + ")");
        if (angle.kind == Formula::Kind::kSymbol && known != values.end()) {
          setConstant(known->second);
          return;
        }
        break;
      }
      default:
        break;
    }
    for (const Formula& operand : f.operands) operands_.emplace_back(operand, values);
    // numbers of the scene are worked out beforehand
    if (std::all_of(operands_.begin(), operands_.end(),
                    [](const PrintedFormula& p) { return p.kind_ == Formula::Kind::kNumber; }))
      setConstant((*this)({}));
  }

  double operator()(const scene::State<double>& s) const {
    switch (kind_) {
      case Formula::Kind::kNumber:
      case Formula::Kind::kSymbol:
        return value_;
      case Formula::Kind::kInput:
        switch (input_) {
          case symbolic::Input::kVelocity:
            return s.qd[joint_];
          case symbolic::Input::kAcceleration:
            return s.qdd[joint_];
          case symbolic::Input::kCos:
            return std::cos(s.x[joint_].q);
          case symbolic::Input::kSin:
            return std::sin(s.x[joint_].q);
          case symbolic::Input::kPosition:
            return s.x[joint_].q;
        }
        break;
      case Formula::Kind::kSum: {
        double sum = operands_[0](s);
        for (std::size_t i = 1; i < operands_.size(); ++i) sum += operands_[i](s);
        return sum;
      }
      case Formula::Kind::kProduct: {
        double product = operands_[0](s);
        for (std::size_t i = 1; i < operands_.size(); ++i) product *= operands_[i](s);
        return product;
      }
      case Formula::Kind::kNegate:
        return -operands_[0](s);
      case Formula::Kind::kPower: {
        const double base = operands_[0](s);
        double power = 1;
        for (int i = 0; i < std::abs(exponent_); ++i) power *= base;
        return exponent_ < 0 ? 1 / power : power;
      }
      case Formula::Kind::kCos:
        return std::cos(operands_[0](s));
      case Formula::Kind::kSin:
        return std::sin(operands_[0](s));
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  void setConstant(double value) {
    kind_ = Formula::Kind::kNumber;
    value_ = value;
    operands_.clear();
  }

  Formula::Kind kind_;
  int exponent_ = 1;
  double value_ = 0;
  symbolic::Input input_ = symbolic::Input::kPosition;
  int joint_ = 0;
  std::vector<PrintedFormula> operands_;
};

/// The closed form, entry by entry, as `dynwitness derive` prints it.
class ClosedFormMethod : public DerivedMethod {
 public:
  static constexpr const char* kName = "closed form as printed";

  ClosedFormMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : DerivedMethod(kName, quantity, mechanism.dof(), states) {
    symbolic::Options options;
    options.fold_parameters = true;
    options.regroup_inertias = false;
    const symbolic::Equations e = symbolic::derive(mechanism, options);
    const PrintedFormula::Values values = valuesOf(e, mechanism);
    symbolic::ClosedAlgebra algebra(e);
    const auto printed = [&](symbolic::Node node) {
      return PrintedFormula(algebra.formula(algebra.expression(node)), values);
    };
    for (int i = 0; i < e.dof(); ++i)
      for (int j = 0; j <= i; ++j) triangle_.push_back(printed(e.M[i][j]));
    for (int i = 0; i < e.dof(); ++i)
      bias_.push_back({printed(e.c[i]), printed(e.g[i]), printed(e.Q[i])});
  }

  void run(int state) override {
    const scene::State<double>& s = states_[state];
    const int n = static_cast<int>(out_.size());
    for (int i = 0, k = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j, ++k) M_(i, j) = M_(j, i) = triangle_[k](s);
    if (quantity_ == Quantity::kM) return;
    for (int i = 0; i < n; ++i) {
      const double bias = bias_[i].c(s) + bias_[i].g(s) - bias_[i].Q(s);
      if (quantity_ == Quantity::kQdd) {
        out_[i] = s.tau[i] - bias;
        continue;
      }
      out_[i] = bias;
      for (int j = 0; j < n; ++j) out_[i] += M_(i, j) * s.qdd[j];
    }
    if (quantity_ == Quantity::kQdd) solve();
  }

 private:
  struct Bias {
    PrintedFormula c, g, Q;
  };

  /// The symbols that folding leaves: numbers with pi in them, and fixed angles.
  static PrintedFormula::Values valuesOf(const symbolic::Equations& e,
                                         const scene::Mechanism& mechanism) {
    const scene::RealNumbers<double> number(mechanism);
    PrintedFormula::Values values = {{"pi", scene::Exact{0, 1}.toDouble()}};
    for (const auto& [name, value] : mechanism.parameterValues()) values[name] = value.toDouble();
    std::vector<symbolic::Node> nodes = {e.kinetic, e.potential};
    nodes.insert(nodes.end(), e.Q.begin(), e.Q.end());
    for (const symbolic::Atom& atom : symbolic::compile(e.graph, nodes).atoms) {
      using Kind = symbolic::Atom::Kind;
      switch (atom.kind) {
        case Kind::kNumber:
          values[atom.name] = number(atom.number);
          break;
        case Kind::kCosAlpha:
          values[atom.name] = number.axisTurn(atom.axis).alpha.c;
          break;
        case Kind::kSinAlpha:
          values[atom.name] = number.axisTurn(atom.axis).alpha.s;
          break;
        case Kind::kCosBeta:
          values[atom.name] = number.axisTurn(atom.axis).beta.c;
          break;
        case Kind::kSinBeta:
          values[atom.name] = number.axisTurn(atom.axis).beta.s;
          break;
        case Kind::kCos:
        case Kind::kSin:
          break;  // functions of numbers that are evaluated as they stand
      }
    }
    return values;
  }

  std::vector<PrintedFormula> triangle_;
  std::vector<Bias> bias_;
};

/// An outside engine behind the interface of witnesses.
class EngineMethod : public Method {
 public:
  EngineMethod(std::unique_ptr<Witness> witness, Quantity quantity, const States& states)
      : Method(witness->name(), "double"),
        witness_(std::move(witness)),
        quantity_(quantity),
        states_(states) {}
  void run(int state) override { value_ = witness_->value(quantity_, states_[state]); }
  MatrixOf<Ball> answer() const override { return exactlyAll<double>(value_); }

 private:
  std::unique_ptr<Witness> witness_;
  Quantity quantity_;
  States states_;
  Eigen::MatrixXd value_;
};

using Methods = std::vector<std::unique_ptr<Method>>;

void addSweeps(Sweep sweep, const scene::Mechanism& mechanism, const States& states,
               Methods* methods) {
  const auto add = [&](auto numbers, const char* scalar) {
    methods->push_back(
        std::make_unique<SweepMethod<decltype(numbers)>>(sweep, scalar, mechanism, states));
  };
  const scene::Mechanism& m = mechanism;
  add(scene::RealNumbers<float>(m), "float");
  add(scene::RealNumbers<double>(m), "double");
  add(scene::RealNumbers<long double>(m), "long double");
  add(BallNumbers(m), "128-bit balls");
  add(scene::RealNumbers<Digits50>(m), "50 digits");
}

Methods methodsFor(const scene::Scene& scene, Quantity quantity,
                   const std::vector<WitnessKind>& kinds, const States& states, Chart* chart) {
  const scene::Mechanism& mechanism = scene.mechanism;
  Methods methods;
  if (mechanism.dof() <= symbolic::kClosedFormJoints)
    methods.push_back(std::make_unique<ClosedFormMethod>(quantity, mechanism, states));
  else
    chart->left_out.push_back(fmt::format("{}: more than {} joints", ClosedFormMethod::kName,
                                          symbolic::kClosedFormJoints));
  methods.push_back(std::make_unique<ProgramMethod>(quantity, mechanism, states));
  if (quantity == Quantity::kTau) addSweeps(Sweep::kNewtonEuler, mechanism, states, &methods);
  if (quantity == Quantity::kM) addSweeps(Sweep::kCompositeBody, mechanism, states, &methods);
  if (quantity == Quantity::kQdd) {
    methods.push_back(std::make_unique<SweepMethod<scene::RealNumbers<double>>>(
        Sweep::kCompositeBodySolved, "double", mechanism, states));
    addSweeps(Sweep::kArticulatedBody, mechanism, states, &methods);
  }
  for (const WitnessKind& kind : kinds) {
    if (kind.info.version == DYNWITNESS_VERSION) continue;  // ours: above, without their bounds
    if (!kind.info.present) {
      chart->left_out.push_back(kind.info.name + ": absent from this build");
      continue;
    }
    std::unique_ptr<Witness> witness = makeWitness(kind, scene);
    if (witness->answers(quantity))
      methods.push_back(std::make_unique<EngineMethod>(std::move(witness), quantity, states));
    else
      chart->left_out.push_back(
          fmt::format("{}: does not answer {}", kind.info.name, crosscheck::name(quantity)));
  }
  return methods;
}

// --------------------------------------------------------------------------------- measurement

/// Largest distance of an entry to the truth / largest entry of the truth, rounded up.
double relativeError(const MatrixOf<Ball>& answer, const MatrixOf<Ball>& truth) {
  const BallPrecision precision(kTruthBits);
  double size = 0, error = 0;
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    const Ball distance = answer.data()[k] - truth.data()[k];
    if (!distance.isFinite()) return std::numeric_limits<double>::infinity();
    size = std::max(size, truth.data()[k].atLeast());
    error = std::max(error, distance.atMost());
  }
  return error == 0 ? 0 : error / size;
}

/// CPU time of this thread [s]: other programs on the machine do not count.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The value below which this share of a sorted list lies.
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5)];
}

/// Times of one evaluation [ns], one a batch of states.
void timeOneRound(Method& method, int states, std::vector<double>* times) {
  const int batches = std::min(kBatches, states);
  for (int b = 0; b < batches; ++b) {
    const int first = states * b / batches, last = states * (b + 1) / batches;
    const double start = cpuSeconds();
    for (int k = first; k < last; ++k) method.run(k);
    times->push_back(1e9 * (cpuSeconds() - start) / (last - first));
  }
}

}  // namespace

Chart speedAccuracy(const scene::Scene& scene, Quantity quantity,
                    const std::vector<WitnessKind>& kinds, int states, std::uint64_t seed) {
  if (quantity != Quantity::kM && quantity != Quantity::kTau && quantity != Quantity::kQdd)
    throw std::invalid_argument(
        fmt::format("speedAccuracy: quantity: expected M, tau or qdd, got {}", name(quantity)));
  Chart chart{scene.name, scene.title, name(quantity), states, seed, thisEnvironment().cpu, {}, {}};
  States drawn;
  std::vector<MatrixOf<Ball>> truths;
  Truth truth(scene.mechanism, kTruthBits);
  for (int k = 0; k < states; ++k) {
    drawn.push_back(drawState(scene.mechanism, scene.name, seed, k));
    Certified certified = truth(quantity, drawn.back());
    if (!certified.exists())
      throw std::runtime_error(
          fmt::format("speedAccuracy: {}: state {}: {}", scene.name, k, certified.reason));
    truths.push_back(std::move(certified.value));
  }

  Methods methods;
  for (auto& method : methodsFor(scene, quantity, kinds, drawn, &chart)) {
    std::vector<double> errors;
    try {
      for (int k = 0; k < states; ++k) {  // this pass also warms up what the timing needs
        method->run(k);
        errors.push_back(relativeError(method->answer(), truths[k]));
      }
    } catch (const std::exception& error) {  // an engine that cannot hold the scene
      chart.left_out.push_back(fmt::format("{}: {}", method->name, error.what()));
      continue;
    }
    std::sort(errors.begin(), errors.end());
    chart.points.push_back({method->name, method->scalar, errors.back(), quantile(errors, 0.5)});
    methods.push_back(std::move(method));
  }

  std::vector<std::vector<double>> times(methods.size());
  std::vector<double> spent(methods.size(), 0.0);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (spent[i] > kEnoughSeconds) continue;
      const double start = cpuSeconds();
      timeOneRound(*methods[i], states, &times[i]);
      spent[i] += cpuSeconds() - start;
    }
  }
  for (std::size_t i = 0; i < methods.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    chart.points[i].time_min_ns = times[i].front();
    chart.points[i].time_median_ns = quantile(times[i], 0.5);
    chart.points[i].time_high_ns = quantile(times[i], 0.9);
  }
  return chart;
}

// -------------------------------------------------------------------------------------- output

std::string chartCsv(const Chart& chart) {
  std::string csv = fmt::format(
      "# scene: {}\n# quantity: {}\n# states: {}, seed {}\n"
      "# error: largest |entry - truth| / largest |truth| of a state; the truth is certified by "
      "ball "
      "arithmetic to 2^-{}\n"
      "# time: CPU time of one evaluation, cosines and sines included; fastest, median and 90 % of "
      "{} batches, up to {} times\n# machine: {}\n",
      oneLine(chart.scene), chart.quantity, chart.states, chart.seed, kTruthBits, kBatches, kRounds,
      oneLine(chart.machine));
  for (const std::string& method : chart.left_out) csv += "# left out: " + oneLine(method) + "\n";
  csv += "method,scalar,error_worst,error_median,time_min_ns,time_median_ns,time_high_ns\n";
  for (const ChartPoint& p : chart.points)
    csv +=
        fmt::format("{},{},{:.3e},{:.3e},{:.1f},{:.1f},{:.1f}\n", p.method, p.scalar, p.error_worst,
                    p.error_median, p.time_min_ns, p.time_median_ns, p.time_high_ns);
  return csv;
}

namespace {

/// Colour and marker of a method, the same in every chart.
std::string looks(const std::string& method) {
  static const std::map<std::string, std::string> known = {
      {sweepName(Sweep::kNewtonEuler), "linetype 1"},
      {ClosedFormMethod::kName, "linetype 2"},
      {"straight-line program", "linetype 3"},
      {sweepName(Sweep::kCompositeBody), "linetype 4"},
      {sweepName(Sweep::kCompositeBodySolved), "linetype 4"},
      {sweepName(Sweep::kArticulatedBody), "linetype 5"},
      {"simbody", "linetype 6"},
      {"mujoco", "linecolor rgb orange pointtype 4"},
      {"mujoco_principal", "linecolor rgb amber pointtype 10"},
      {"dart", "linecolor rgb green pointtype 8"},
      {"kdl", "linecolor rgb purple pointtype 12"}};
  const auto found = known.find(method);
  return found != known.end() ? found->second : "linecolor rgb ink pointtype 3";
}

/// A gnuplot string: single quotes take everything literally but a single quote.
std::string gnuplotText(const std::string& text) {
  std::string q = "'";
  for (const char c : oneLine(text)) q += c == '\'' ? std::string("''") : std::string(1, c);
  return q + "'";
}

/// What is seen of the points: decades of error and of time [s]; an exact answer, which has no
/// place on a log axis, is drawn at the left border.
struct Range {
  double left = 0, right = -400, bottom = 400, top = -400;

  Range(const std::vector<ChartPoint>& points, bool only_double) {
    for (const ChartPoint& p : points) {
      if (only_double && p.scalar != "double") continue;
      for (const double error : {p.error_worst, p.error_median}) {
        if (!(error > 0) || !std::isfinite(error)) continue;
        left = std::min(left, std::floor(std::log10(error)));
        right = std::max(right, std::ceil(std::log10(error)));
      }
      bottom = std::min(bottom, std::log10(1e-9 * p.time_min_ns));
      top = std::max(top, std::log10(1e-9 * p.time_high_ns));
    }
    if (right < left) left = -17, right = -15;  // all exact
    left -= only_double ? 1 : 3;
    right += only_double ? 0 : 2;
    bottom -= 0.3;
    top += 0.3;
  }
};

std::string panel(const Chart& chart, const std::string& csv, bool only_double) {
  const Range range(chart.points, only_double);
  std::vector<std::string> methods;
  for (const ChartPoint& p : chart.points)
    if ((!only_double || p.scalar == "double") &&
        std::find(methods.begin(), methods.end(), p.method) == methods.end())
      methods.push_back(p.method);
  const double decades = range.right - range.left;
  std::string text = fmt::format(
      "set xrange [1e{0:.0f}:1e{1:.0f}]\nset xtics 1e{0:.0f},1e{2:.0f}\n"
      "set yrange [{3:.3g}:{4:.3g}]\nborder = 1e{0:.0f}\nplot ",
      range.left, range.right, std::max(1.0, std::ceil(decades / 6)), std::pow(10, range.bottom),
      std::pow(10, range.top));
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const std::string chosen = fmt::format("strcol(1) eq {}{}", gnuplotText(methods[i]),
                                           only_double ? " && strcol(2) eq 'double'" : "");
    const auto settings =
        std::count_if(chart.points.begin(), chart.points.end(),
                      [&](const ChartPoint& p) { return p.method == methods[i]; });
    text += i == 0 ? "" : ", \\\n     ";
    if (!only_double && settings > 1)
      text += fmt::format(
          "'{0}' using ({1} ? seen($3) : NaN):(1e-9 * $6) with lines {2} dashtype 1 linewidth 1 "
          "notitle, \\\n"
          "     '{0}' using ({1} ? seen($3) : NaN):(1e-9 * $6):2 with labels left offset 0.7,0.6 "
          "font ',11' textcolor rgb soft notitle, \\\n     ",
          csv, chosen, looks(methods[i]));
    text += fmt::format(
        "'{}' using ({} ? seen($3) : NaN):(1e-9 * $6):(seen($4)):(seen($3)):(1e-9 * $5):(1e-9 * "
        "$7) "
        "with xyerrorbars {} dashtype 1 linewidth 1.5 {}",
        csv, chosen, looks(methods[i]),
        only_double ? "title " + gnuplotText(methods[i]) : std::string("notitle"));
  }
  return text + "\n";
}

}  // namespace

std::string chartScript(const Chart& chart, const std::string& name, const std::string& style) {
  const std::string title = chart.title.empty() ? chart.scene : chart.title;
  const std::string csv = name + ".csv";
  const std::string task = chart.quantity == crosscheck::name(Quantity::kM) ? "mass matrix"
                           : chart.quantity == crosscheck::name(Quantity::kTau)
                               ? "inverse dynamics"
                               : "forward dynamics";
  std::string text = fmt::format(
      "# Speed against accuracy of {0} of {1}. Draw again with:  gnuplot {2}.gp\n"
      "do for [dark = 0:1] {{\n"
      "load '{3}'\n"
      "set terminal svg size 1000,480 noenhanced\n"
      "set output dark ? '{2}_dark.svg' : '{2}.svg'\n"
      "set multiplot\n"
      "set label 1 {4} at screen 0.5, screen 0.96 center textcolor rgb ink font ',15'\n"
      "set label 2 {5} at screen 0.5, screen 0.025 center textcolor rgb soft font ',11'\n"
      "set tmargin at screen 0.86\nset bmargin at screen 0.28\n"
      "set logscale xy\nset format x '1e%T'\nset format y '%.0s %cs'\nset micro\nunset mxtics\n"
      "seen(error) = error > border ? error : border\n"
      "set bars 0.6\n"
      "set xlabel 'worst relative error  [1]'\n",
      chart.quantity, oneLine(chart.scene), name, style,
      gnuplotText(fmt::format("{}, {}: lower left is better", title, task)),
      gnuplotText(
          fmt::format("worst of {} states against the certified truth, bars to the median (exact: "
                      "left border); median time, bars from the fastest to 90 %; {}",
                      chart.states, chart.machine)));
  text +=
      "set lmargin at screen 0.085\nset rmargin at screen 0.5\n"
      "set title 'The sweep in five arithmetics' textcolor rgb soft\n"
      "set ylabel 'time of one evaluation'\nunset key\n" +
      panel(chart, csv, false);
  text +=
      "unset label\nunset ylabel\n"
      "set lmargin at screen 0.575\nset rmargin at screen 0.98\n"
      "set title 'In double' textcolor rgb soft\n"
      "set key at screen 0.5, screen 0.1 center center vertical Left reverse maxrows 2\n" +
      panel(chart, csv, true);
  return text + "unset multiplot\nunset output\nreset\n}\n";
}

}  // namespace dynwitness::crosscheck
