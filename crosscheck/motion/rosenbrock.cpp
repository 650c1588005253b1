// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/util/ublas_wrapper.hpp>
#include <boost/numeric/ublas/lu.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>

#include "crosscheck/motion/step_makers.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;

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
std::unique_ptr<Steps<T>> rosenbrock(MotionEquations<T>& equations) {
  return std::make_unique<Rosenbrock<T>>(equations);
}

}  // namespace

template <typename T>
std::vector<StepMaker<T>> rosenbrockSteps() {
  return {rosenbrock<T>};
}

template std::vector<StepMaker<double>> rosenbrockSteps();
template std::vector<StepMaker<long double>> rosenbrockSteps();

}  // namespace dynwitness::crosscheck
