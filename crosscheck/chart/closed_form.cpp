// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "crosscheck/chart/derived_method.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

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
          case symbolic::Input::kForce:
            return s.tau[joint_];
          case symbolic::Input::kDirection:
            return scene::directionOf(s.qd[joint_]);
          case symbolic::Input::kCos:
            return std::cos(s.x[joint_].q);
          case symbolic::Input::kSin:
            return std::sin(s.x[joint_].q);
          case symbolic::Input::kPosition:
            return s.x[joint_].q;
          case symbolic::Input::
              kRotation:  // joints with quaternions have no closed form (chart.cpp)
            break;
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
      case Formula::Kind::kQuotient:
        return operands_[0](s) / operands_[1](s);
      case Formula::Kind::kCos:
        return std::cos(operands_[0](s));
      case Formula::Kind::kSin:
        return std::sin(operands_[0](s));
      case Formula::Kind::kMatrix:  // no number
        break;
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
  ClosedFormMethod(Quantity quantity, const scene::Mechanism& mechanism, const States& states)
      : DerivedMethod(MethodName::kClosedForm, quantity, mechanism.dof(), states) {
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

}  // namespace

std::unique_ptr<Method> closedFormMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                         const States& states) {
  return std::make_unique<ClosedFormMethod>(quantity, mechanism, states);
}

}  // namespace dynwitness::crosscheck
