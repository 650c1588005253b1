// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/integrators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/extrapolation_stepper.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/util/ublas_wrapper.hpp>
#include <boost/numeric/ublas/lu.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>

#include "crosscheck/motion/collocation.hpp"
#include "crosscheck/motion/method_named.hpp"
#include "crosscheck/motion/state_gap.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;

constexpr double kAny = std::numeric_limits<double>::infinity();

/// An explicit stepper of Boost.odeint. It is made anew where it must forget.
template <typename T, typename Stepper>
class Explicit : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit Explicit(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const auto f = [this](const State& at, State& rate, T t) { equations_.rate(at, t, &rate); };
    next_ = *y;
    stepper_->do_step(f, *y, time, next_, h);
    std::swap(*y, next_);
  }
  void forget() override { stepper_ = std::make_unique<Stepper>(); }

 private:
  MotionEquations<T>& equations_;
  std::unique_ptr<Stepper> stepper_ = std::make_unique<Stepper>();
  State next_;
};

template <typename T>
class Rosenbrock : public Steps<T> {
 public:
  using State = std::vector<T>;
  using Vector = ublas::vector<T>;
  explicit Rosenbrock(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const auto size = y->size();
    const auto f = [&](const Vector& at, Vector& rate, T t) {
      State out(size);
      equations_.rate(State(at.begin(), at.end()), t, &out);
      std::copy(out.begin(), out.end(), rate.begin());
    };
    const auto jacobian = [&](const Vector& at, ublas::matrix<T>& J, const T& t, Vector& by_time) {
      const State here(at.begin(), at.end());
      const auto columns = columnsOfJacobian(equations_, here, t);
      for (std::size_t j = 0; j < size; ++j)
        for (std::size_t i = 0; i < size; ++i) J(i, j) = columns[j][i];
      std::fill(by_time.begin(), by_time.end(), T(0));
      if (equations_.isAutonomous()) return;
      const T small = std::cbrt(std::numeric_limits<T>::epsilon()) * (1 + std::abs(t));
      State before(size), after(size);
      equations_.rate(here, t - small, &before);
      equations_.rate(here, t + small, &after);
      for (std::size_t i = 0; i < size; ++i) by_time(i) = (after[i] - before[i]) / (2 * small);
    };
    Vector x(size);
    std::copy(y->begin(), y->end(), x.begin());
    stepper_.do_step(std::make_pair(f, jacobian), x, time, h);
    std::copy(x.begin(), x.end(), y->begin());
  }

 private:
  MotionEquations<T>& equations_;
  odeint::rosenbrock4<T> stepper_;
};

template <typename T>
class SemiImplicitEuler : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit SemiImplicitEuler(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const int first = equations_.positions(), n = equations_.dof();
    State rate(y->size()), u(n);
    equations_.rate(*y, time, &rate);
    for (int i = 0; i < n; ++i) {
      (*y)[first + i] += h * rate[first + i];
      u[i] = h * (*y)[first + i];
    }
    y->back() += h * rate.back();
    equations_.move(y, u);
  }

 private:
  MotionEquations<T>& equations_;
};

template <typename T>
class StormerVerlet : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit StormerVerlet(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    constexpr int kMostIterations = 60;
    const int first = equations_.positions(), n = equations_.dof();
    p_0_ = equations_.momentum(*y);
    start_ = end_ = *y;
    const T work = equations_.power(*y, time);
    Vector v = Eigen::Map<const Vector>(y->data() + first, n);
    Eigen::PartialPivLU<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>> lu;
    T before = std::numeric_limits<T>::infinity();
    for (int k = 0;; ++k) {
      const Vector left = residual(v, h);
      // M(q_0) stands for the derivative, which it is where M is constant and nothing damps; where
      // that does not do, it is made of differences
      if (k == kDifferences) lu.compute(derivative(v, left, h));
      Vector change;
      if (k < kDifferences) {
        const State solved = equations_.velocity(start_, State(left.data(), left.data() + n));
        change = Eigen::Map<const Vector>(solved.data(), n);
      } else {
        change = lu.solve(left);
      }
      T now = 0;
      for (int i = 0; i < n; ++i)
        keepWorse(&now, T(std::abs(h * change(i)) / (1 + std::abs(start_[i]))));
      if (!std::isfinite(now) || k == kMostIterations)
        throw std::runtime_error(
            fmt::format("the discrete Euler-Lagrange equations have no solution near by: the step "
                        "of {} s at t = {} s is too long",
                        static_cast<double>(h), static_cast<double>(time)));
      // it ends where the change is nothing that y can show, or falls no more, which is rounding
      if (now <= std::numeric_limits<T>::epsilon() / kSomeRoundings ||
          (!(now < before) && now <= sqrtOfEps<T>()))
        break;
      before = now;
      v += change;
    }
    residual(v, h);  // leaves start_, end_, half_ at v
    const State pull = equations_.pull(end_);
    State p_1(n);
    for (int i = 0; i < n; ++i) p_1[i] = half_[i] + h / 2 * pull[i];
    const State qd = equations_.velocity(end_, p_1);
    std::copy(qd.begin(), qd.end(), end_.begin() + first);
    end_.back() += h / 2 * (work + equations_.power(end_, time + h));
    *y = end_;
  }

 private:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  static constexpr int kDifferences = 12;  ///< iterations before the derivative is made

  /// p_0 + h/2 pull(q_0, v) - (M(q_0) + M(q_1)) v / 2
  Vector residual(const Vector& v, T h) {
    const int first = equations_.positions(), n = equations_.dof();
    for (int i = 0; i < n; ++i) {
      start_[first + i] = end_[first + i] = v(i);
      end_[i] = start_[i] + h * v(i);
    }
    const State p = equations_.momentum(start_), q = equations_.momentum(end_),
                pull = equations_.pull(start_);
    Vector left(n);
    half_.resize(n);
    for (int i = 0; i < n; ++i) {
      half_[i] = (p[i] + q[i]) / 2;
      left(i) = p_0_[i] + h / 2 * pull[i] - half_[i];
    }
    return left;
  }
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> derivative(const Vector& v, const Vector& left,
                                                              T h) {
    const auto n = v.size();
    Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> J(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      Vector moved = v;
      moved(j) += sqrtOfEps<T>() * (1 + std::abs(v(j)));
      J.col(j) = (left - residual(moved, h)) / (moved(j) - v(j));
    }
    return J;
  }

  MotionEquations<T>& equations_;
  State p_0_, start_, end_, half_;
};

template <typename T>
class LieRungeKutta : public Steps<T> {
 public:
  using State = std::vector<T>;
  explicit LieRungeKutta(MotionEquations<T>& equations) : equations_(equations) {}
  void step(State* y, T time, T h) override {
    const int n = equations_.dof();
    const Slope k_1 = slope(*y, State(n, T(0)), time),
                k_2 = slope(moved(*y, k_1, h / 2), scaled(k_1.u, h / 2), time + h / 2),
                k_3 = slope(moved(*y, k_2, h / 2), scaled(k_2.u, h / 2), time + h / 2),
                k_4 = slope(moved(*y, k_3, h), scaled(k_3.u, h), time + h);
    Slope all = k_1;
    const auto add = [](State* sum, const State& a, const State& b, const State& c) {
      for (std::size_t i = 0; i < sum->size(); ++i)
        (*sum)[i] = ((*sum)[i] + 2 * a[i] + 2 * b[i] + c[i]) / 6;
    };
    add(&all.u, k_2.u, k_3.u, k_4.u);
    add(&all.rest, k_2.rest, k_3.rest, k_4.rest);
    *y = moved(*y, all, h);
  }

 private:
  struct Slope {
    State u, rest;  ///< of exp's argument; of rates and work
  };
  static State scaled(State u, T h) {
    for (T& x : u) x *= h;
    return u;
  }
  State moved(State y, const Slope& slope, T h) const {
    equations_.move(&y, scaled(slope.u, h));
    for (std::size_t i = 0; i < slope.rest.size(); ++i)
      y[equations_.positions() + i] += h * slope.rest[i];
    return y;
  }
  Slope slope(const State& y, const State& u, T time) const {
    const int first = equations_.positions();
    State rate(y.size());
    equations_.rate(y, time, &rate);
    Slope out{State(y.begin() + first, y.end() - 1), State(rate.begin() + first, rate.end())};
    const State once = equations_.commutator(u, out.u), twice = equations_.commutator(u, once);
    for (std::size_t i = 0; i < out.u.size(); ++i) out.u[i] += once[i] / 2 + twice[i] / 12;
    return out;
  }

  MotionEquations<T>& equations_;
};

template <typename T>
using State = std::vector<T>;

template <template <typename> class Made>
struct Ours {
  template <typename T>
  static std::unique_ptr<Steps<T>> make(MotionEquations<T>& equations) {
    return std::make_unique<Made<T>>(equations);
  }
};
template <typename T, typename Stepper>
std::unique_ptr<Steps<T>> odeintSteps(MotionEquations<T>& equations) {
  return std::make_unique<Explicit<T, Stepper>>(equations);
}
template <typename T, int Stages, Nodes Kind>
std::unique_ptr<Steps<T>> collocated(MotionEquations<T>& equations) {
  return std::make_unique<Collocation<T>>(equations, Stages, Kind);
}

/// In the order of integrators().
template <typename T>
using Make = std::unique_ptr<Steps<T>> (*)(MotionEquations<T>&);
template <typename T>
std::vector<Make<T>> makers() {
  using S = State<T>;
  return {odeintSteps<T, odeint::euler<S, T>>,
          odeintSteps<T, odeint::modified_midpoint<S, T>>,
          odeintSteps<T, odeint::runge_kutta4<S, T>>,
          odeintSteps<T, odeint::runge_kutta_dopri5<S, T>>,
          odeintSteps<T, odeint::runge_kutta_fehlberg78<S, T>>,
          odeintSteps<T, odeint::extrapolation_stepper<8, S, T>>,
          odeintSteps<T, odeint::adams_bashforth_moulton<4, S, T>>,
          Ours<Rosenbrock>::make<T>,
          Ours<SemiImplicitEuler>::make<T>,
          Ours<StormerVerlet>::make<T>,
          collocated<T, 1, Nodes::kGauss>,
          collocated<T, 2, Nodes::kGauss>,
          collocated<T, 3, Nodes::kGauss>,
          collocated<T, 1, Nodes::kRadau>,
          collocated<T, 2, Nodes::kRadau>,
          collocated<T, 3, Nodes::kRadau>,
          Ours<LieRungeKutta>::make<T>};
}

/// y'' = -w^2 y - c y'
class Oscillator : public MotionEquations<double> {
 public:
  Oscillator(double w, double c) : w_(w), c_(c) {}
  int positions() const override { return 1; }
  int dof() const override { return 1; }
  void rate(const State& y, double, State* rate) override {
    *rate = {y[1], -w_ * w_ * y[0] - c_ * y[1], 0};
  }
  void move(State* y, const State& u) const override { (*y)[0] += u[0]; }
  State commutator(const State&, const State&) const override { return {0}; }
  bool hasMomenta() const override { return true; }
  State momentum(const State& y) override { return {y[1]}; }
  State velocity(const State&, const State& p) override { return p; }
  State pull(const State& y) override { return {-w_ * w_ * y[0] - c_ * y[1]}; }

 private:
  double w_, c_;
};

std::string limitText(double limit) {
  return std::isinf(limit) ? "any" : limit == 0 ? "none" : fmt::format("{:.4g}", limit);
}

}  // namespace

const char* name(Symplectic symplectic) {
  switch (symplectic) {
    case Symplectic::kNo:
      return "no";
    case Symplectic::kWhereMIsConstant:
      return "where M is constant";
    case Symplectic::kYes:
      return "yes";
  }
  return "";
}

const std::vector<Integrator>& integrators() {
  // limits: where |R(z)| leaves 1, R from the methods' coefficients; test_integrators holds them to
  // the steps
  const Symplectic no = Symplectic::kNo;
  static const std::vector<Integrator> all = {
      {"euler", 1, no, 0, 2, false, false},
      {"modified_midpoint", 2, no, 0, 3.08738, false, false},
      {"runge_kutta4", 4, no, 2.82843, 2.78529, false, false},
      {"runge_kutta_dopri5", 5, no, 0.997189, 3.30657, false, false},
      {"runge_kutta_fehlberg78", 8, no, 2.36516, 5.00759, false, false},
      {"bulirsch_stoer8", 8, no, 3.85287, 5.54957, false, false},
      {"adams_bashforth_moulton4", 4, no, 0, 1.2848, false, true},
      {"rosenbrock4", 4, no, kAny, kAny, false, false},
      {"semi_implicit_euler", 1, Symplectic::kWhereMIsConstant, 2, 0.828427, false, false},
      {"stormer_verlet", 2, Symplectic::kYes, 2, 2, true, false},
      {"implicit_midpoint", 2, Symplectic::kYes, kAny, kAny, false, false},
      {"gauss_4", 4, Symplectic::kYes, kAny, kAny, false, false},
      {"gauss_6", 6, Symplectic::kYes, kAny, kAny, false, false},
      {"implicit_euler", 1, no, kAny, kAny, false, false},
      {"radau_iia_3", 3, no, kAny, kAny, false, false},
      {"radau_iia_5", 5, no, kAny, kAny, false, false},
      {"lie_runge_kutta4", 4, no, 2.82843, 2.78529, false, false},
  };
  return all;
}

const Integrator& integratorNamed(const std::string& name) {
  return methodNamed(integrators(), name);
}

std::string integratorNames() {
  std::string names;
  for (const Integrator& method : integrators())
    names += fmt::format("{}{} (order {})", names.empty() ? "" : ", ", method.name, method.order);
  return names;
}

std::string integratorTable() {
  std::string table = fmt::format("{:<25} {:>5}  {:<20} {:>9} {:>9}\n", "method", "order",
                                  "symplectic", "h|i w| <=", "h|-a| <=");
  for (const Integrator& m : integrators())
    table += fmt::format("{:<25} {:>5}  {:<20} {:>9} {:>9}\n", m.name, m.order, name(m.symplectic),
                         limitText(m.imaginary_limit), limitText(m.real_limit));
  return table;
}

template <typename T>
std::unique_ptr<Steps<T>> stepsOf(const std::string& name, MotionEquations<T>& equations) {
  const Integrator& method = integratorNamed(name);
  if (method.needs_momenta && !equations.hasMomenta())
    throw scene::InputError(
        {}, fmt::format("method '{}', allowed: any other; it knows trees whose joints' rates are "
                        "derivatives of their positions (not spherical, not floating, no "
                        "followers, loops or drives)",
                        name));
  return makers<T>()[static_cast<std::size_t>(&method - integrators().data())](equations);
}

template <typename T>
std::vector<std::vector<T>> columnsOfJacobian(MotionEquations<T>& equations,
                                              const std::vector<T>& y, T time) {
  const T small = std::cbrt(std::numeric_limits<T>::epsilon());
  std::vector<std::vector<T>> columns(y.size(), std::vector<T>(y.size(), T(0)));
  std::vector<T> before(y.size()), after(y.size());
  for (std::size_t j = 0; j + 1 < y.size(); ++j) {
    std::vector<T> low = y, high = y;
    low[j] -= small * (1 + std::abs(y[j]));
    high[j] += small * (1 + std::abs(y[j]));
    equations.rate(low, time, &before);
    equations.rate(high, time, &after);
    for (std::size_t i = 0; i < y.size(); ++i)
      columns[j][i] = (after[i] - before[i]) / (high[j] - low[j]);
  }
  return columns;
}

double amplification(const std::string& integrator, double re, double im) {
  if (!(re <= 0))
    throw std::invalid_argument(fmt::format("amplification: re: expected at most 0, got {}", re));
  Oscillator oscillator(std::hypot(re, im), -2 * re);
  const auto advanced = [&](std::vector<double> y, int steps) {
    const auto stepper = stepsOf<double>(integrator, oscillator);
    for (int k = 0; k < steps; ++k) stepper->step(&y, k, 1);
    return y;
  };
  const bool remembers = integratorNamed(integrator).remembers;
  // of the map of many steps the root: a remembering one's first steps are of another kind
  const int first = remembers ? 30 : 0, steps = remembers ? 100 : 1;
  Eigen::Matrix2d before, after;
  for (int column = 0; column < 2; ++column) {
    std::vector<double> start = {column == 0 ? 1.0 : 0.0, column == 0 ? 0.0 : std::hypot(re, im),
                                 0};
    const auto at_first = advanced(start, first), at_end = advanced(start, first + steps);
    for (int row = 0; row < 2; ++row) {  // rates over w: then an oscillation is a turn
      before(row, column) = at_first[row] / (row == 0 ? 1 : std::hypot(re, im));
      after(row, column) = at_end[row] / (row == 0 ? 1 : std::hypot(re, im));
    }
  }
  if (!before.allFinite() || !after.allFinite()) return kAny;
  if (!remembers) return (after * before.inverse()).eigenvalues().cwiseAbs().maxCoeff();
  return std::pow(after.norm() / before.norm(), 1.0 / steps);
}

template std::unique_ptr<Steps<double>> stepsOf(const std::string&, MotionEquations<double>&);
template std::unique_ptr<Steps<long double>> stepsOf(const std::string&,
                                                     MotionEquations<long double>&);
template std::vector<std::vector<double>> columnsOfJacobian(MotionEquations<double>&,
                                                            const std::vector<double>&, double);
template std::vector<std::vector<long double>> columnsOfJacobian(MotionEquations<long double>&,
                                                                 const std::vector<long double>&,
                                                                 long double);

}  // namespace dynwitness::crosscheck
