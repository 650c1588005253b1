// SPDX-License-Identifier: Apache-2.0
// The double pendulum of data/scenes/double_pendulum.toml in C++, by hand: two uniform rods, q2
// relative.
#include <cmath>

#include "dynwitness_engine.hpp"

using namespace dynwitness_engine;

namespace {

constexpr double g0 = 9.81, m1 = 1, m2 = 0.8, l1 = 0.5, l2 = 0.4;
constexpr double r1 = l1 / 2, r2 = l2 / 2;                        // to the centres of mass
constexpr double I1 = m1 * l1 * l1 / 12, I2 = m2 * l2 * l2 / 12;  // about them

Matrix M(const State& s) {
  const double m12 = I2 + m2 * (r2 * r2 + l1 * r2 * std::cos(s.q[1])), m22 = I2 + m2 * r2 * r2;
  const double m11 = I1 + m1 * r1 * r1 + m2 * l1 * l1 + m22 + 2 * m2 * l1 * r2 * std::cos(s.q[1]);
  return {{m11, m12}, {m12, m22}};
}

Vector c(const State& s) {
  const double h = m2 * l1 * r2 * std::sin(s.q[1]);
  return {-h * (2 * s.qd[0] + s.qd[1]) * s.qd[1], h * s.qd[0] * s.qd[0]};
}

Vector g(const State& s) {
  const double g2 = m2 * r2 * g0 * std::sin(s.q[0] + s.q[1]);
  return {(m1 * r1 + m2 * l1) * g0 * std::sin(s.q[0]) + g2, g2};
}

Vector tau(const State& s) {
  const Matrix m = M(s);
  const Vector cs = c(s), gs = g(s);
  return {m[0][0] * s.qdd[0] + m[0][1] * s.qdd[1] + cs[0] + gs[0],
          m[1][0] * s.qdd[0] + m[1][1] * s.qdd[1] + cs[1] + gs[1]};
}

/// z x r and z about y, from the shoulder; from the elbow for what lies beyond it.
Matrix jacobian(const State& s) {
  const bool is_lower = s.frame.link == 2;
  const double a = s.q[0], b = is_lower ? a + s.q[1] : a, x = s.frame.at[0], z = s.frame.at[2];
  const double dx = x * std::cos(b) + z * std::sin(b), dz = z * std::cos(b) - x * std::sin(b);
  const double rx = is_lower ? dx - l1 * std::sin(a) : dx,
               rz = is_lower ? dz - l1 * std::cos(a) : dz;
  const double on = is_lower ? 1 : 0;
  return {{rz, on * dz}, {0, 0}, {-rx, -on * dx}, {0, 0}, {1, on}, {0, 0}};
}

Body rod(const std::string& name, double m, double r, double I) {
  return {name, m, {0, 0, -r}, {{I, 0, 0}, {0, I, 0}, {0, 0, 0}}};
}

}  // namespace

int main() {
  Engine engine("double_pendulum_in_cpp", "1");
  engine.matrix("M", M);
  engine.vector("c", c);
  engine.vector("g", g);
  engine.vector("tau", tau);
  engine.matrix("jacobian", jacobian);
  engine.model = [] {
    return std::vector<Body>{rod("upper", m1, r1, I1), rod("lower", m2, r2, I2)};
  };
  return engine.testify();
}
