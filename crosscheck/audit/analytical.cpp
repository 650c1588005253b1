// SPDX-License-Identifier: GPL-3.0-or-later
// Section 14: the equations of motion in joint coordinates.
#include "crosscheck/audit/board.hpp"
#include "crosscheck/audit/costs.hpp"
#include "crosscheck/audit/lifted.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

#include <fmt/format.h>

namespace dynwitness::audit {
namespace {

template <typename T>
VectorX<T> scaled(const VectorX<T>& v, const T& s) {
  return v * s;
}

/// qd' M qd / divisor against the sum of m v^2 / 2 over the points and d qd^2 / 2 over the rotors.
void compareEnergy(Point& at, const Robot<T>& robot, int divisor) {
  const VectorX<T> qd = Robot<T>::column(robot.qd);
  at.equal("T", T(qd.dot(VectorX<T>(robot.massMatrix() * qd)) / T(divisor)),
           energiesOf(robot, robot.qd).first);
}

Trials linearTerms() {
  return Trials("linear_terms")
      .printed(both(exact([](Point& at) {
                      const auto robot = anyRobot(at, kMixed);
                      const auto& [qd, qdd, zero] = std::tuple(robot.qd, robot.qdd, robot.zeros());
                      const T s = at.number();
                      const Vector3<T> none = Vector3<T>::Zero();
                      const auto times = [&](const std::vector<T>& v) {
                        return Robot<T>::values(scaled<T>(Robot<T>::column(v), s));
                      };
                      const VectorX<T> M_qdd = robot.forces(zero, qdd, none),
                                       c = robot.forces(qd, zero, none),
                                       g = robot.forces(zero, zero, robot.gravity);
                      at.equal("sum of the three", robot.forces(qdd), VectorX<T>(M_qdd + c + g));
                      at.equal("s qdd", robot.forces(zero, times(qdd), none), scaled<T>(M_qdd, s));
                      at.equal("s qd", robot.forces(times(qd), zero, none), scaled<T>(c, T(s * s)));
                      at.equal("s g", robot.forces(zero, zero, Vector3<T>(robot.gravity * s)),
                               scaled<T>(g, s));
                    }),
                    differs([](Point& at) {
                      const auto robot = anyRobot(at, kMixed);
                      const T s = at.number();
                      at.equal(
                          "s qd",
                          robot.forces(Robot<T>::values(scaled<T>(Robot<T>::column(robot.qd), s)),
                                       robot.zeros(), Vector3<T>::Zero()),
                          scaled<T>(robot.forces(robot.qd, robot.zeros(), Vector3<T>::Zero()), s));
                    })));
}

Trials parameterLinearity() {
  return Trials("parameter_linearity")
      .printed(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn});
        const Vector3<T> s = at.vector();
        const VectorX<T> middle = robot.forces(robot.qdd);
        auto moved = [&](const Vector3<T>& by) {
          auto other = robot;
          other.body[1] = robot.body[1].seenFrom(Matrix3<T>::Identity(), by);
          return other.forces(robot.qdd);
        };
        at.equal("mean", VectorX<T>(moved(s) + moved(-s)), scaled<T>(middle, T(2)));
      }))
      .corrected(exact([](Point& at) {
        const auto first = anyRobot(at, kMixed, Rotors::kNone);
        auto second = first, together = first;
        for (int i = 0; i < first.n(); ++i) {
          for (Vector3<T>& r : second.body[i].r) r = at.vector();
          for (std::size_t k = 0; k < 3; ++k) {
            together.body[i].m.push_back(second.body[i].m[k]);
            together.body[i].r.push_back(second.body[i].r[k]);
          }
          const RigidInertia<T> sum = first.body[i].inertia() + second.body[i].inertia();
          const RigidInertia<T> whole = together.body[i].inertia();
          at.equal("first moment", sum.h, whole.h);
          at.equal("inertia", sum.I.matrix(), whole.I.matrix());
        }
        at.equal("tau", VectorX<T>(first.forces(first.qdd) + second.forces(first.qdd)),
                 together.forces(first.qdd));
      }));
}

Trials eq61() {
  return Trials("eq61")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, kMixed);
        const VectorX<T> c = robot.forces(robot.qd, robot.zeros(), Vector3<T>::Zero()),
                         g = robot.forces(robot.zeros(), robot.zeros(), robot.gravity);
        at.equal("tau", robot.forces(robot.qdd),
                 VectorX<T>(robot.massMatrix() * Robot<T>::column(robot.qdd) + c + g));
      }))
      .ours(exact([](Point& at) {
        const auto robot = anyRobot(at, kMixed);
        const recursive::Model<T> model = robot.model();
        recursive::Workspace<T> ws(model);
        std::vector<T> c = robot.zeros(), g = robot.zeros();
        recursive::inverseDynamics(model, robot.x, robot.qd, robot.zeros(), ws, c,
                                   recursive::Terms::none());
        recursive::inverseDynamics(model, robot.x, robot.zeros(), robot.zeros(), ws, g,
                                   recursive::Terms::potential());
        const MatrixX<T> M = compositeMassMatrix<T>(model, robot.x);
        at.equal("our code: tau", robot.forces(robot.qdd),
                 VectorX<T>(M * Robot<T>::column(robot.qdd) + Robot<T>::column(c) +
                            Robot<T>::column(g)));
      }));
}

Trials eq62() {
  return Trials("eq62").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, kMixed);
    const auto metric = metricOf(robot);
    VectorX<T> c(3);
    for (int i = 0; i < 3; ++i) {
      c(i) = T(0);
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) c(i) += metric.christoffel(i, j, k) * robot.qd[j] * robot.qd[k];
    }
    at.equal("c", c, robot.forces(robot.qd, robot.zeros(), Vector3<T>::Zero()));
  }));
}

Trials coriolisChoice() {
  return Trials("coriolis_choice")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        const auto metric = metricOf(robot);
        const auto& dM = metric.gradient();
        // C_ij = sum of (dM_ij/dq_k - 1/2 dM_jk/dq_i) qd_k, the terms as Lagrange gives them
        MatrixX<T> S = MatrixX<T>::Constant(2, 2, T(0));
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k)
              S(i, j) += (dM[k](i, j) - T(2) * (dM[k](i, j) - dM[i](j, k) / T(2))) * robot.qd[k];
        at.zero("S + S'", MatrixX<T>(S + S.transpose()));
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kSlide, kTurn});
        const auto metric = metricOf(robot);
        MatrixX<T> S = MatrixX<T>::Constant(3, 3, T(0));
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
              S(i, j) +=
                  (metric.gradient()[k](i, j) - T(2) * metric.christoffel(i, j, k)) * robot.qd[k];
        at.zero("S + S'", MatrixX<T>(S + S.transpose()));
      }));
}

Trials staticGravity() {
  return Trials("static_gravity").printed(exact([](Point& at) {
    auto robot = anyRobot(at, kMixed);
    robot.qd = robot.zeros();
    const recursive::Model<T> model = robot.model();
    recursive::Workspace<T> ws(model);
    std::vector<T> g = robot.zeros();
    recursive::inverseDynamics(model, robot.x, robot.qd, robot.qd, ws, g);
    robot.tau = g;
    at.zero("qdd", Robot<T>::column(robot.accelerations()));
  }));
}

Trials coasting() {
  return Trials("coasting")
      .printed(exact([](Point& at) {
        auto robot = anyRobot(at, {kTurn, kTurn});
        robot.tau = Robot<T>::values(robot.forces(robot.qd, robot.zeros(), Vector3<T>::Zero()));
        at.zero("qdd", Robot<T>::column(robot.accelerations()));
      }))
      .condition(exact([](Point& at) {
        auto robot = anyRobot(at, kMixed);
        robot.gravity = Vector3<T>::Zero();
        robot.tau = Robot<T>::values(robot.forces(robot.qd, robot.zeros(), Vector3<T>::Zero()));
        at.zero("qdd", Robot<T>::column(robot.accelerations()));
      }))
      .corrected(exact([](Point& at) {
        auto robot = anyRobot(at, kMixed);
        const recursive::Model<T> model = robot.model();
        recursive::Workspace<T> ws(model);
        recursive::inverseDynamics(model, robot.x, robot.qd, robot.zeros(), ws, robot.tau);
        at.zero("qdd", Robot<T>::column(robot.accelerations()));
      }));
}

Trials massColumn() {
  return Trials("mass_column").printed(exact([](Point& at) {
    auto robot = anyRobot(at, kMixed);
    robot.qd = robot.zeros();
    const MatrixX<T> M = compositeMassMatrix<T>(robot.model(), robot.x);
    for (int i = 0; i < 3; ++i)
      at.equal("tau", robot.forces(robot.unit(i)),
               VectorX<T>(M.col(i) + robot.forces(robot.qd, robot.qd, robot.gravity)));
  }));
}

Trials eq63() {
  return Trials("eq63")
      .printed(exact([](Point& at) {
        const auto robot = anyRobot(at, {kTurn, kTurn});
        compareEnergy(at, robot, 1);
      }))
      .corrected(exact([](Point& at) {
        const auto robot = anyRobot(at, kMixed);
        compareEnergy(at, robot, 2);
      }))
      .numbers([] {
        Rows rows;
        for (const char* name : {"simple_pendulum", "double_pendulum", "puma_560", "scara"}) {
          OnTheBoard arm(name, 1);
          const MatrixX<double> M = compositeMassMatrix<double>(arm.model, arm.x);
          const VectorX<double> qd = Robot<double>::column(arm.qd);
          rows.push_back({name, onBoard(qd.dot(VectorX<double>(M * qd))),
                          onBoard(recursive::kineticEnergy(arm.model, arm.x, arm.qd, arm.ws))});
        }
        return rows;
      });
}

/// The degree of a polynomial through these values: how often differences can be taken.
int degreeOf(std::vector<long> values) {
  for (int degree = 0;; ++degree) {
    bool constant = true;
    for (const long v : values) constant = constant && v == values[0];
    if (constant) return degree;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = values[i + 1] - values[i];
    values.pop_back();
  }
}

constexpr int kLongest = 24;
std::vector<Cost> costs() {
  std::vector<Cost> all;
  for (int n = 1; n <= kLongest; ++n) all.push_back(costOf(n));
  return all;
}

Trial growsWithDegree(int degree, long Cost::*what, const char* name) {
  return decided("count", [=]() -> Decision {
    std::vector<long> values;
    for (const Cost& cost : costs()) values.push_back(cost.*what);
    const int found = degreeOf(values);
    return {found == degree,
            fmt::format("{}: {} operations at n = 1, {} at n = {}; a polynomial of degree {} in n",
                        name, values.front(), values.back(), kLongest, found)};
  });
}

enum class Composite { kDearer, kCheaper };
/// How composite bodies with a factorization compare with articulated bodies for all these n.
Trial composite(Composite is, int from, int to) {
  return decided("count", [=]() -> Decision {
    const std::vector<Cost> all = costs();
    std::string found;
    for (int n = from; n <= to; ++n) {
      const Cost& cost = all[static_cast<std::size_t>(n - 1)];
      const long operations = cost.mass_matrix + cost.solve;
      found = fmt::format("n = {}: {} operations, articulated bodies {}", n, operations,
                          cost.articulated);
      if ((operations > cost.articulated) != (is == Composite::kDearer)) return {false, found};
    }
    return {true, found};
  });
}

/// M, c and g of the bundled PUMA 560 as formulas, and what M qdd + c + g costs.
struct Explicit {
  double named = 0;    ///< repeated terms computed once
  double written = 0;  ///< every entry written out to the end
};
Explicit costOfExplicitForm() {
  const symbolic::Equations equations = symbolic::derive(scene::findScene("puma_560").mechanism);
  const symbolic::Program program =
      symbolic::compile(equations.graph, symbolic::massCoriolisGravity(equations));
  std::vector<double> written(static_cast<std::size_t>(program.slots), 0.0);
  for (const auto& i : program.body) {
    const bool two =
        i.code != symbolic::Program::Code::kNegate && i.code != symbolic::Program::Code::kInverse;
    written[i.result] =
        (i.code != symbolic::Program::Code::kNegate) + written[i.a] + (two ? written[i.b] : 0.0);
  }
  const symbolic::Program::Operations named = program.bodyOperations();
  const double n = equations.dof(), sums = 2 * n * n;  // M qdd + c + g
  Explicit out{named.multiplications + named.additions + named.divisions + sums, sums};
  for (const int slot : program.outputs) out.written += written[slot];
  return out;
}
enum class Form { kNamed, kWritten };
/// Whether the explicit form costs more (or less) than the inverse dynamics sweep of six joints.
Trial explicitAgainstSweep(Form form, Composite is) {
  return decided("count", [=]() -> Decision {
    const Explicit formulas = costOfExplicitForm();
    const double operations = form == Form::kNamed ? formulas.named : formulas.written;
    const double sweep = static_cast<double>(costOf(6).inverse);
    return {(operations > sweep) == (is == Composite::kDearer),
            fmt::format("PUMA 560: {:.0f} operations, Newton-Euler sweep of six joints {:.0f}",
                        operations, sweep)};
  });
}

Trials compositeBodies() {
  return Trials("composite_bodies").printed(exact([](Point& at) {
    const auto robot = anyRobot(at, {kTurn, kSlide, kTurn}, Rotors::kAll, {-1, 0, 0});
    const SixVectors<T> six(robot);
    std::vector<Matrix6<T>> I_C = six.M;
    for (int i = 2; i > 0; --i) I_C[robot.parent[i]] += six.X[i].transpose() * I_C[i] * six.X[i];
    const MatrixX<T> M = robot.massMatrix();
    for (int j = 0; j < 3; ++j) {
      at.equal("M_jj", M(j, j), T(six.Z[j].dot(I_C[j] * six.Z[j]) + robot.rotor[j]));
      if (j == 0) continue;
      const Vector6<T> F = six.X[j].transpose() * (I_C[j] * six.Z[j]);
      at.equal("M_0j", M(0, j), T(six.Z[0].dot(F)));
      at.equal("M_j0", M(j, 0), T(six.Z[0].dot(F)));
    }
    at.zero("different branches", M(1, 2));
  }));
}

Trials compositeOrder() {
  return Trials("composite_order")
      .printed(growsWithDegree(3, &Cost::mass_matrix, "M by composite bodies"))
      .condition(growsWithDegree(3, &Cost::solve, "bias forces, L D L' and its solution"))
      .corrected(both(growsWithDegree(2, &Cost::mass_matrix, "M by composite bodies"),
                      growsWithDegree(3, &Cost::solve, "bias forces, L D L' and its solution")));
}

Trials explicitForm() {
  return Trials("explicit_form")
      .printed(explicitAgainstSweep(Form::kNamed, Composite::kDearer))
      .condition(explicitAgainstSweep(Form::kWritten, Composite::kDearer))
      .corrected(explicitAgainstSweep(Form::kNamed, Composite::kCheaper));
}

Trials compositeEfficiency() {
  return Trials("composite_efficiency")
      .printed(composite(Composite::kDearer, 1, kLongest))
      .condition(composite(Composite::kDearer, 20, kLongest))
      .corrected(composite(Composite::kCheaper, 2, 8));
}

}  // namespace

std::vector<Trials> analytical() {
  return {linearTerms(),
          parameterLinearity(),
          eq61(),
          eq62(),
          coriolisChoice(),
          staticGravity(),
          coasting(),
          massColumn(),
          eq63(),
          compositeBodies(),
          compositeOrder(),
          explicitForm(),
          compositeEfficiency()};
}

}  // namespace dynwitness::audit
