// SPDX-License-Identifier: Apache-2.0
// Loop closures: residual, Jacobian and velocity products, from the sweeps' own quantities.
#pragma once

#include <vector>

#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::recursive {

using scene::VectorX;

/// One closure: frame A fixed to link a, frame B to link b (-1: the world).
template <typename T>
struct Closure {
  scene::ClosureKind kind;
  int a, b;
  Transform<T> X_A, X_B;  ///< link frame to closure frame
  int row;                ///< of its first equation
  T length;               ///< of a distance; a disc's radius [m]
};

/// The closures of a mechanism, and what constraintEquations() writes on and returns.
template <typename T>
struct Constraints {
  std::vector<Closure<T>> closures;
  VectorX<T> phi;    ///< residual, m [m, 1]; 0 of equations of rates (scene::isOfRates)
  MatrixX<T> J;      ///< of J qd = 0, m x n: dphi/dq, or what an equation of rates asks
  VectorX<T> gamma;  ///< (dJ/dt) qd, m: d^2 phi/dt^2 = J qdd + gamma

  std::vector<Transform<T>> X_W;  ///< world to link
  std::vector<int> chain;         ///< by link: 1 inboard of a, 2 of b, 3 of both

  int rows() const { return static_cast<int>(phi.size()); }
};

/// The closures of `mechanism`, for the model that buildModel() made of it with the same numbers.
template <typename Numbers, typename T = typename Numbers::Scalar>
Constraints<T> buildConstraints(const scene::Mechanism& mechanism, const Numbers& number,
                                const Model<T>& model) {
  Constraints<T> out;
  int rows = 0;
  const auto frame = [&](const scene::Attachment& at) {
    return detail::composed<T>(at.steps(), number) * model.places[at.link].X;
  };
  for (const scene::Closure& closure : mechanism.closures) {
    out.closures.push_back({closure.kind, model.places[closure.a.link].link,
                            model.places[closure.b.link].link, frame(closure.a), frame(closure.b),
                            rows, number(closure.length)});
    rows += scene::equationCount(closure.kind);
  }
  out.phi = VectorX<T>::Constant(rows, T(0));
  out.gamma = out.phi;
  out.J = MatrixX<T>::Constant(rows, model.dof(), T(0));
  out.X_W.assign(model.links.size(), Transform<T>::identity());
  out.chain.assign(model.links.size(), 0);
  return out;
}

namespace detail {

/** Where a disc of radius r, about z at the place p seen from A, touches A's xy plane, with h = p_z
    and c = z_z:

        rho = -(n - c z) r^2 / h     from its centre
        phi = (h - (1 - c^2) r^2 / h) / 2,     phi' = by_height h' + by_lean c'
 */
template <typename T>
struct DiscContact {
  DiscContact(const T& radius, const Transform<T>& X_BA)
      : z(X_BA.R.row(2)), h(X_BA.p.z()), c(z.z()), square_over_h(radius * radius / h) {
    rho = (Vector3<T>(T(0), T(0), T(1)) - z * c) * -square_over_h;
    const T reach = (T(1) - c * c) * square_over_h;
    phi = (h - reach) / T(2);
    by_height = (T(1) + reach / h) / T(2);
    by_lean = c * square_over_h;
  }
  /// d rho / dt, where the centre moves at p_rate and the disc turns at w.
  Vector3<T> rhoRate(const Vector3<T>& p_rate, const Vector3<T>& w) const {
    const Vector3<T> z_rate = w.cross(z);
    return (z * z_rate.z() + z_rate * c) * square_over_h - rho * (p_rate.z() / h);
  }
  /// d by_height / dt h' + d by_lean / dt c'
  T phiCurvature(const T& h_rate, const T& c_rate) const {
    const T shrink = h_rate / h, reach_over_h = (T(1) - c * c) * square_over_h / h;
    const T of_height = -(c * c_rate * square_over_h / h + reach_over_h * shrink);
    const T of_lean = (c_rate - c * shrink) * square_over_h;
    return of_height * h_rate + of_lean * c_rate;
  }
  Vector3<T> z;
  T h, c, square_over_h;  ///< r^2 / h
  Vector3<T> rho;
  T phi, by_height, by_lean;
};

/** What a closure sees of a motion of B on A, given in A's axes: the rate of B's origin r at
    distance p, and of the products of axes  x_A . z_B,  y_A . z_B,  x_A . y_B,

        r' = v + w x p,     z_B' = w x z_B,   y_B' = w x y_B
        of a distance  p . r',    of a skate  y_B . r',    of a disc  v + w x (p + rho)     */
template <typename T, typename Row>
void closureRates(const Closure<T>& closure, const Motion<T>& x, const Transform<T>& X_BA,
                  Row&& row) {
  const scene::ClosureKind kind = closure.kind;
  const Vector3<T> point = x.linear + x.angular.cross(X_BA.p);
  if (kind == scene::ClosureKind::kDistance) return row(0, X_BA.p.dot(point));
  if (kind == scene::ClosureKind::kPlane) return row(0, point.z());
  if (kind == scene::ClosureKind::kSkate) return row(0, Vector3<T>(X_BA.R.row(1)).dot(point));
  if (kind == scene::ClosureKind::kRolling) {
    const DiscContact<T> disc(closure.length, X_BA);
    const Vector3<T> there = point + x.angular.cross(disc.rho);
    row(0, there.x());
    row(1, there.y());
    return row(2, disc.by_height * point.z() + disc.by_lean * x.angular.cross(disc.z).z());
  }
  row(0, point.x());
  row(1, point.y());
  if (kind == scene::ClosureKind::kPlanarPoint) return;
  row(2, point.z());
  if (kind == scene::ClosureKind::kPoint) return;
  const Vector3<T> z = x.angular.cross(Vector3<T>(X_BA.R.row(2)));  // rows of R_BA: B's axes in A
  row(3, z.x());
  row(4, z.y());
  if (kind == scene::ClosureKind::kHinge) return;
  row(5, x.angular.cross(Vector3<T>(X_BA.R.row(1))).x());
}

}  // namespace detail

/** Residual phi(q), Jacobian J(q) and velocity products gamma(q, qd) of all closures, in
    O(closures depth + links).

    One outward sweep with qdd = 0 and no gravity gives the velocity v and the acceleration a of
    every link. With everything of a closure in A's axes,
        (1)  V = v_B - v_A                        motion of B as seen from A
        (2)  V' = a_B - a_A - v_A x V             its rate of change there, at qdd = 0
        (3)  phi' = rates of V  (closureRates),   column k of J = rates of +-Z_k: + where joint k is
             inboard of B alone, - where it is inboard of A alone, nothing where of both
        (4)  gamma = rates of V'  and the centrifugal parts  w x r',  w x (w x z_B); of a distance
             p . (w x r') + r' . r';  of a skate none, y_B' . r' + y_B . (w x r') = 0;  of a disc
             w x (r' + rho')
    No differences, no division: the same source runs on any field.

    @param  x, qd   positions, one a slot, and velocity [rad/s, m/s], length n. phi = 0 is not
      needed.
    @throws std::invalid_argument  x or qd has another length */
template <typename T>
void constraintEquations(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                         const std::vector<T>& qd, Workspace<T>& ws, Constraints<T>& out) {
  linkVelocities(model, x, qd, ws);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    const Motion<T> c = cross(ws.v[i], AnyJoints::motion(link, qd));
    ws.a[i] = link.parent < 0 ? c : ws.X_up[i] * ws.a[link.parent] + c;
    out.X_W[i] = link.parent < 0 ? ws.X_up[i] : ws.X_up[i] * out.X_W[link.parent];
  }

  for (std::size_t i = 0; i < static_cast<std::size_t>(out.J.size()); ++i) out.J.data()[i] = T(0);
  for (const Closure<T>& closure : out.closures) {
    const int a = closure.a, b = closure.b;
    const Transform<T> X_AW = a < 0 ? closure.X_A : closure.X_A * out.X_W[a];
    const Transform<T> X_BW = b < 0 ? closure.X_B : closure.X_B * out.X_W[b];
    const Transform<T> X_BA = X_BW * X_AW.inverse();
    const auto in_A = [&](const std::vector<Motion<T>>& of_link, int link) {
      if (link < 0) return Motion<T>::zero();
      return link == a ? closure.X_A * of_link[link]
                       : X_BA.inverseTimes(closure.X_B * of_link[link]);
    };
    const Motion<T> v_A = in_A(ws.v, a), V = in_A(ws.v, b) - v_A;            // (1)
    const Motion<T> V_rate = in_A(ws.a, b) - in_A(ws.a, a) - cross(v_A, V);  // (2)

    const Vector3<T> z_B = X_BA.R.row(2), y_B = X_BA.R.row(1);
    const Vector3<T>&p = X_BA.p, &w = V.angular;
    const Vector3<T> r_rate = V.linear + w.cross(p), r = w.cross(r_rate);
    T phi[] = {p.x(), p.y(), p.z(), z_B.x(), z_B.y(), y_B.x()};
    const Vector3<T> z = w.cross(w.cross(z_B)), y = w.cross(w.cross(y_B));
    T centrifugal[] = {r.x(), r.y(), r.z(), z.x(), z.y(), y.x()};
    if (closure.kind == scene::ClosureKind::kDistance) {
      phi[0] = (p.dot(p) - closure.length * closure.length) / T(2);
      centrifugal[0] = p.dot(r) + r_rate.dot(r_rate);
    }
    if (closure.kind == scene::ClosureKind::kPlane) {
      phi[0] = p.z();
      centrifugal[0] = r.z();
    }
    if (closure.kind == scene::ClosureKind::kSkate) phi[0] = centrifugal[0] = T(0);
    if (closure.kind == scene::ClosureKind::kRolling) {
      const detail::DiscContact<T> disc(closure.length, X_BA);
      const Vector3<T> u = w.cross(r_rate + disc.rhoRate(r_rate, w));
      phi[0] = phi[1] = T(0);
      phi[2] = disc.phi;
      centrifugal[0] = u.x();
      centrifugal[1] = u.y();
      centrifugal[2] = disc.by_height * r.z() + disc.by_lean * z.z() +
                       disc.phiCurvature(r_rate.z(), w.cross(z_B).z());
    }
    detail::closureRates(closure, V_rate, X_BA, [&](int k, const T& rate) {
      out.phi(closure.row + k) = phi[k];
      out.gamma(closure.row + k) = rate + centrifugal[k];  // (4)
    });

    for (int i = a; i >= 0; i = model.links[i].parent) out.chain[i] += 1;
    for (int i = b; i >= 0; i = model.links[i].parent) out.chain[i] += 2;
    const auto columns = [&](int from, int side) {
      for (int i = from; i >= 0; i = model.links[i].parent) {
        const LinkModel<T>& link = model.links[i];
        if (out.chain[i] != side || link.dof < 0) continue;
        for (int j = 0; j < AnyJoints::axes(link); ++j) {
          Motion<T> Z = Motion<T>::zero();
          AnyJoints::addMotion(link, j, T(1), Z);
          const Motion<T> at_A = X_AW * out.X_W[i].inverseTimes(Z);
          detail::closureRates(closure, at_A, X_BA, [&](int k, const T& rate) {
            out.J(closure.row + k, link.dof + j) += side == 2 ? rate : -rate;  // (3)
          });
        }
      }
    };
    columns(a, 1);
    columns(b, 2);
    for (int i = a; i >= 0; i = model.links[i].parent) out.chain[i] = 0;
    for (int i = b; i >= 0; i = model.links[i].parent) out.chain[i] = 0;
  }
}

}  // namespace dynwitness::recursive
