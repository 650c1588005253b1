// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <utility>

#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/extrapolation_stepper.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "crosscheck/motion/step_makers.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace odeint = boost::numeric::odeint;

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

template <typename T, typename Stepper>
std::unique_ptr<Steps<T>> odeintSteps(MotionEquations<T>& equations) {
  return std::make_unique<Explicit<T, Stepper>>(equations);
}
}  // namespace

template <typename T>
std::vector<StepMaker<T>> explicitSteps() {
  using S = std::vector<T>;
  return {odeintSteps<T, odeint::euler<S, T>>,
          odeintSteps<T, odeint::modified_midpoint<S, T>>,
          odeintSteps<T, odeint::runge_kutta4<S, T>>,
          odeintSteps<T, odeint::runge_kutta_dopri5<S, T>>,
          odeintSteps<T, odeint::runge_kutta_fehlberg78<S, T>>,
          odeintSteps<T, odeint::extrapolation_stepper<8, S, T>>,
          odeintSteps<T, odeint::adams_bashforth_moulton<4, S, T>>};
}

template std::vector<StepMaker<double>> explicitSteps();
template std::vector<StepMaker<long double>> explicitSteps();

}  // namespace dynwitness::crosscheck
