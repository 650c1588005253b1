// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/integrators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "crosscheck/motion/method_named.hpp"
#include "crosscheck/motion/step_makers.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

/// In the order of integrators().
template <typename T>
std::vector<StepMaker<T>> makers() {
  std::vector<StepMaker<T>> all;
  for (const auto& some : {explicitSteps<T>(), rosenbrockSteps<T>(), ownSteps<T>()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
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
  std::string table = fmt::format("  {:<25} {:>5}  {:<20} {:>9} {:>9}\n", "method", "order",
                                  "symplectic", "h|i w| <=", "h|-a| <=");
  for (const Integrator& m : integrators())
    table += fmt::format("  {:<25} {:>5}  {:<20} {:>9} {:>9}\n", m.name, m.order,
                         name(m.symplectic), limitText(m.imaginary_limit), limitText(m.real_limit));
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
