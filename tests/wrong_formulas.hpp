// SPDX-License-Identifier: GPL-3.0-or-later
// A second copy of the sweeps' formulas, in dense 6 x 6 matrices and with every link kept as it
// stands in the scene, into which one mistake can be put at a time: what the crosscheck must find.
// With Mistake::kNone it is a correct witness.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/witness.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"

namespace dynwitness::wrong {

enum class Mistake {
  kNone,
  // gravity
  kGravitySign,          // a_0 = +gravity
  kGravityNotTurned,     // every link sees world gravity as if its axes were the world's
  kGravityForgetsALink,  // the last link is weightless
  // velocity products
  kCoriolisSign,          // a = .. - v x Z qd
  kCoriolisMissing,       // a without v x Z qd
  kBiasMissing,           // f without v x* M v
  kForceCrossLosesForce,  // x* without v x f in the moment
  // inertia
  kParallelAxisSign,       // I = I_c - shift
  kCentreInParentAxes,     // the shift takes the centre of mass in the axes of the parent
  kProductsOfInertiaSign,  // -I_xy for I_xy, as for "positive" products of inertia
  kInertiaAxesIgnored,     // inertia given in turned axes is taken as given in link axes
  // transformations
  kRotationTransposed,        // R for R'
  kTranslationSign,           // + R' p x for - R' p x
  kForceMovedLikeMotion,      // f_p += X^-1 f for X' f
  kChildForceNotTransformed,  // f_p += f
  kDhTurnsBeforeItMoves,      // alpha before a in a DH row (the last two steps of a placement)
  // joints
  kRotorMissing,        // no d qdd
  kGearNotSquared,      // d = n J
  kRotorOnNextJoint,    // d_i at joint i + 1
  kSlideTakenForTurn,   // Z = (0, z) for a prismatic joint
  kSpringSign,          // tau = .. - k (q - rest)
  kWorldLoadNotTurned,  // a load in world axes is taken as given in link axes
  // composite bodies
  kCompositeOfOneChild,  // at a branch only the last child is carried along
  kCompositeNotMoved,    // I_C p += I_C
  kForceNotCarried,      // M_ij = Z_j' F with F still in the axes of link i
  // articulated bodies
  kInertiaNotProjected,     // M_a without - U U' / D
  kJointBiasMissing,        // u = tau without - Z' f_A
  kVelocityBiasNotCarried,  // f_A p without M_a c
  kForceOfJointNotCarried,  // f_A p without U u / D
};

template <typename T>
using V3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using M3 = Eigen::Matrix<T, 3, 3>;
template <typename T>
using V6 = Eigen::Matrix<T, 6, 1>;
template <typename T>
using M6 = Eigen::Matrix<T, 6, 6>;
template <typename T>
using MX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

template <typename T>
M3<T> hat(const V3<T>& r) {
  M3<T> m;
  m << T(0), -r(2), r(1), r(2), T(0), -r(0), -r(1), r(0), T(0);
  return m;
}

/// What a sweep takes into account besides M qdd and velocity products.
struct Asked {
  bool gravity, springs, loads;
};

/// RNEA, CRBA, ABA and the energies; 6-vectors are linear part first. All scene links are bodies.
template <typename Numbers>
class Formulas {
 public:
  using T = typename Numbers::Scalar;
  using Positions = std::vector<scene::JointPosition<T>>;
  using Values = std::vector<T>;

  Formulas(const scene::Mechanism& mechanism, const Numbers& number, Mistake mistake)
      : wrong_(mistake), gravity_(V3<T>::Zero()) {
    if (mechanism.has_gravity) gravity_ = vector(mechanism.gravity, number);
    for (const scene::Link& link : mechanism.links) addBody(link, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      loads_.push_back({w.link, w.axes == scene::Wrench::Axes::kWorld, vector(w.force, number),
                        vector(w.moment, number), vector(w.at, number)});
    if (is(Mistake::kRotorOnNextJoint)) {
      T carried(0);
      for (Body& body : bodies_)
        if (body.dof >= 0) std::swap(carried, body.rotor);
    }
  }

  int dof() const { return dof_; }

  Values inverse(const Positions& x, const Values& qd, const Values& qdd, Asked asked) const {
    const std::size_t n = bodies_.size();
    const std::vector<Pose> poses = posesOf(x);
    std::vector<V6<T>> v(n, V6<T>::Zero()), a(n, V6<T>::Zero()), f(n, V6<T>::Zero());
    Values tau(static_cast<std::size_t>(dof_), T(0));
    V6<T> a_0 = V6<T>::Zero();
    if (asked.gravity)
      a_0.template head<3>() = is(Mistake::kGravitySign) ? gravity_ : V3<T>(-gravity_);
    std::vector<V6<T>> weightless(n, V6<T>::Zero());  // what a carries of gravity
    for (std::size_t i = 0; i < n; ++i) {
      const Body& b = bodies_[i];
      const V6<T> v_J = b.dof < 0 ? V6<T>(V6<T>::Zero()) : V6<T>(b.Z * at(qd, b));
      const V6<T> a_J = b.dof < 0 ? V6<T>(V6<T>::Zero()) : V6<T>(b.Z * at(qdd, b));
      if (b.parent < 0) {
        weightless[i] = a_0;  // the root rests in the world: its frame is the world's
      } else {
        const M6<T> X = motion(poses[i]);
        v[i] = X * v[p(b)] + v_J;
        a[i] = X * a[p(b)] + a_J + coriolis(v[i], v_J);
        weightless[i] = is(Mistake::kGravityNotTurned) ? a_0 : V6<T>(X * weightless[p(b)]);
      }
      const bool weighs = !(is(Mistake::kGravityForgetsALink) && i + 1 == n);
      f[i] = b.M * (weighs ? V6<T>(a[i] + weightless[i]) : a[i]) + bias(b.M, v[i]);
    }
    if (asked.loads) subtractLoads(poses, f);
    for (std::size_t i = n; i-- > 0;) {
      const Body& b = bodies_[i];
      if (b.dof >= 0) {
        T& out = tau[static_cast<std::size_t>(b.dof)];
        out = b.Z.dot(f[i]) + b.rotor * at(qdd, b);
        if (asked.springs) out += spring(b, x);
      }
      if (b.parent >= 0) f[p(b)] += inward(poses[i], f[i]);
    }
    return tau;
  }

  MX<T> massMatrix(const Positions& x) const {
    const std::size_t n = bodies_.size();
    const std::vector<Pose> poses = posesOf(x);
    std::vector<M6<T>> I_C(n);
    for (std::size_t i = 0; i < n; ++i) I_C[i] = bodies_[i].M;
    MX<T> M = MX<T>::Constant(dof_, dof_, T(0));
    std::vector<bool> has_child(n, false);
    for (std::size_t i = n; i-- > 0;) {
      const Body& b = bodies_[i];
      if (b.dof >= 0) {
        V6<T> F = I_C[i] * b.Z;
        M(b.dof, b.dof) = b.Z.dot(F) + b.rotor;
        std::size_t k = i;
        for (int j = b.parent; j >= 0; j = bodies_[static_cast<std::size_t>(j)].parent) {
          if (!is(Mistake::kForceNotCarried)) F = inward(poses[k], F);
          k = static_cast<std::size_t>(j);
          if (bodies_[k].dof >= 0)
            M(b.dof, bodies_[k].dof) = M(bodies_[k].dof, b.dof) = bodies_[k].Z.dot(F);
        }
      }
      if (b.parent < 0) continue;
      if (is(Mistake::kCompositeOfOneChild) && has_child[p(b)]) continue;
      has_child[p(b)] = true;
      const M6<T> X = motion(poses[i]);
      I_C[p(b)] += is(Mistake::kCompositeNotMoved) ? I_C[i] : M6<T>(X.transpose() * I_C[i] * X);
    }
    return M;
  }

  /// M qdd = tau - (c + g - loads) by elimination.
  Values forwardByMassMatrix(const Positions& x, const Values& qd, const Values& tau) const {
    MX<T> M = massMatrix(x);
    const Values zeros(static_cast<std::size_t>(dof_), T(0));
    const Values rest = inverse(x, qd, zeros, {true, true, true});
    Values b = tau;
    for (std::size_t i = 0; i < b.size(); ++i) b[i] -= rest[i];
    const int n = dof_;
    for (int j = 0; j < n; ++j)
      for (int i = j + 1; i < n; ++i) {
        const T factor = M(i, j) / M(j, j);
        for (int k = j; k < n; ++k) M(i, k) -= factor * M(j, k);
        b[static_cast<std::size_t>(i)] -= factor * b[static_cast<std::size_t>(j)];
      }
    for (int i = n - 1; i >= 0; --i) {
      T& out = b[static_cast<std::size_t>(i)];
      for (int k = i + 1; k < n; ++k) out -= M(i, k) * b[static_cast<std::size_t>(k)];
      out /= M(i, i);
    }
    return b;
  }

  Values forward(const Positions& x, const Values& qd, const Values& tau) const {
    const std::size_t n = bodies_.size();
    const std::vector<Pose> poses = posesOf(x);
    std::vector<V6<T>> v(n, V6<T>::Zero()), c(n, V6<T>::Zero()), f(n), U(n), a(n);
    std::vector<M6<T>> M_A(n);
    std::vector<T> D(n, T(1)), u(n, T(0));
    for (std::size_t i = 0; i < n; ++i) {
      const Body& b = bodies_[i];
      if (b.parent >= 0) {
        const V6<T> v_J = b.dof < 0 ? V6<T>(V6<T>::Zero()) : V6<T>(b.Z * at(qd, b));
        v[i] = motion(poses[i]) * v[p(b)] + v_J;
        c[i] = coriolis(v[i], v_J);
      }
      M_A[i] = b.M;
      f[i] = bias(b.M, v[i]);
    }
    subtractLoads(poses, f);
    for (std::size_t i = n; i-- > 0;) {
      const Body& b = bodies_[i];
      M6<T> M_a = M_A[i];
      V6<T> f_a = f[i];
      if (b.dof >= 0) {
        U[i] = M_A[i] * b.Z;
        D[i] = b.rotor + b.Z.dot(U[i]);
        u[i] = at(tau, b) - spring(b, x);
        if (!is(Mistake::kJointBiasMissing)) u[i] -= b.Z.dot(f[i]);
        if (!is(Mistake::kInertiaNotProjected)) M_a -= U[i] * U[i].transpose() * (T(1) / D[i]);
        if (!is(Mistake::kForceOfJointNotCarried)) f_a += U[i] * (u[i] / D[i]);
      }
      if (!is(Mistake::kVelocityBiasNotCarried)) f_a += M_a * c[i];
      if (b.parent < 0) continue;
      const M6<T> X = motion(poses[i]);
      M_A[p(b)] += X.transpose() * M_a * X;
      f[p(b)] += inward(poses[i], f_a);
    }
    Values qdd(static_cast<std::size_t>(dof_), T(0));
    for (std::size_t i = 0; i < n; ++i) {
      const Body& b = bodies_[i];
      if (b.parent < 0) {
        a[i] = V6<T>::Zero();
        a[i].template head<3>() = is(Mistake::kGravitySign) ? gravity_ : V3<T>(-gravity_);
        continue;
      }
      a[i] = motion(poses[i]) * a[p(b)] + c[i];
      if (b.dof < 0) continue;
      T& out = qdd[static_cast<std::size_t>(b.dof)];
      out = (u[i] - U[i].dot(a[i])) / D[i];
      a[i] += b.Z * out;
    }
    return qdd;
  }

  T kinetic(const Positions& x, const Values& qd) const {
    const std::vector<V6<T>> v = velocities(posesOf(x), qd);
    T twice(0);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_[i];
      twice += v[i].dot(b.M * v[i]);
      if (b.dof >= 0) twice += b.rotor * at(qd, b) * at(qd, b);
    }
    return twice / T(2);
  }

  T potential(const Positions& x) const {
    T V(0);
    std::vector<Pose> world = posesOf(x);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_[i];
      if (b.parent >= 0)
        world[i] = {world[p(b)].R * world[i].R, world[p(b)].o + world[p(b)].R * world[i].o};
      V -= gravity_.dot(world[i].o * b.mass + world[i].R * b.h);
      if (b.dof >= 0) V += spring(b, x) * (x[static_cast<std::size_t>(b.dof)].q - b.rest) / T(2);
    }
    return V;
  }

  V6<T> momentum(const Positions& x, const Values& qd) const {
    const std::vector<Pose> poses = posesOf(x);
    const std::vector<V6<T>> v = velocities(poses, qd);
    std::vector<V6<T>> h(bodies_.size());
    for (std::size_t i = 0; i < h.size(); ++i) h[i] = bodies_[i].M * v[i];
    for (std::size_t i = h.size(); i-- > 0;)
      if (bodies_[i].parent >= 0) h[p(bodies_[i])] += inward(poses[i], h[i]);
    return h[0];
  }

 private:
  struct Pose {
    M3<T> R;  ///< of the link in its parent's frame
    V3<T> o;
  };
  struct Body {
    int parent = -1, dof = -1;
    bool slides = false;
    Pose before{M3<T>::Identity(), V3<T>::Zero()}, after{M3<T>::Identity(), V3<T>::Zero()};
    V3<T> axis = V3<T>::Zero();  ///< in the joint frame, of length 1
    V6<T> Z = V6<T>::Zero();     ///< in the link frame
    M6<T> M = M6<T>::Zero();     ///< about the link frame's origin
    T mass{0}, rotor{0}, stiffness{0}, rest{0};
    V3<T> h = V3<T>::Zero();
  };
  struct Load {
    int link;
    bool in_world_axes;
    V3<T> force, moment, at;
  };

  bool is(Mistake mistake) const { return wrong_ == mistake; }
  static std::size_t p(const Body& b) { return static_cast<std::size_t>(b.parent); }
  static const T& at(const Values& v, const Body& b) { return v[static_cast<std::size_t>(b.dof)]; }
  static V3<T> vector(const scene::Vector& v, const Numbers& number) {
    return {number(v[0]), number(v[1]), number(v[2])};
  }
  static M3<T> rotation(int axis, const scene::CosSin<T>& a) {
    V3<T> e = V3<T>::Zero();
    e(axis) = T(1);
    return M3<T>(M3<T>::Identity() + hat(e) * a.s + hat(e) * hat(e) * (T(1) - a.c));
  }

  Pose composed(std::vector<scene::Step> steps, const Numbers& number) const {
    if (is(Mistake::kDhTurnsBeforeItMoves) && steps.size() >= 2)
      std::swap(steps.back(), steps[steps.size() - 2]);
    Pose pose{M3<T>::Identity(), V3<T>::Zero()};
    for (const scene::Step& step : steps) {
      if (step.kind == scene::Step::Kind::kTranslate)
        pose.o = pose.o + pose.R * vector(step.translation, number);
      else
        pose.R = (pose.R * rotation(static_cast<int>(step.kind) -
                                        static_cast<int>(scene::Step::Kind::kRotateX),
                                    number.angle(step.angle)))
                     .eval();
    }
    return pose;
  }

  void addBody(const scene::Link& link, const Numbers& number) {
    Body b;
    b.parent = link.parent;
    b.before = composed(link.joint.placement.beforeJoint(), number);
    b.after = composed(link.joint.placement.afterJoint(), number);
    if (link.parent >= 0 && link.joint.kind != scene::JointKind::kFixed) {
      b.dof = dof_++;
      b.slides = link.joint.kind == scene::JointKind::kPrismatic;
      const scene::AxisTurn<T> turn = number.axisTurn(link.joint.axis);
      b.axis = {turn.beta.s * turn.alpha.c, turn.beta.s * turn.alpha.s, turn.beta.c};
      if (b.slides && !is(Mistake::kSlideTakenForTurn))
        b.Z.template head<3>() = b.axis;
      else
        b.Z.template tail<3>() = b.axis;
      b.Z = (motion(b.after) * b.Z).eval();
      const T gear = number(link.joint.gear_ratio), J = number(link.joint.rotor_inertia);
      if (!is(Mistake::kRotorMissing))
        b.rotor = is(Mistake::kGearNotSquared) ? gear * J : gear * gear * J;
      b.stiffness = number(link.joint.stiffness);
      b.rest = number(link.joint.rest);
    }
    const scene::MassProperties& m = link.inertia;
    b.mass = number(m.mass);
    V3<T> r = vector(m.com, number);
    if (is(Mistake::kCentreInParentAxes)) r = (b.before.R * r).eval();
    b.h = r * b.mass;
    const T sign(is(Mistake::kProductsOfInertiaSign) ? -1 : 1);
    M3<T> I;
    I << number(m.xx), sign * number(m.xy), sign * number(m.xz), sign * number(m.xy), number(m.yy),
        sign * number(m.yz), sign * number(m.xz), sign * number(m.yz), number(m.zz);
    if (!is(Mistake::kInertiaAxesIgnored)) {
      const M3<T> R = rotation(2, number.angle(m.rpy[2])) * rotation(1, number.angle(m.rpy[1])) *
                      rotation(0, number.angle(m.rpy[0]));
      I = (R * I * R.transpose()).eval();
    }
    if (m.about == scene::MassProperties::About::kCenterOfMass) {
      const M3<T> shift = hat(r) * hat(b.h);
      I = is(Mistake::kParallelAxisSign) ? M3<T>(I + shift) : M3<T>(I - shift);
    }
    b.M << M3<T>(M3<T>::Identity() * b.mass), M3<T>(-hat(b.h)), hat(b.h), I;
    bodies_.push_back(b);
  }

  std::vector<Pose> posesOf(const Positions& x) const {
    std::vector<Pose> poses;
    for (const Body& b : bodies_) {
      Pose pose = b.before;
      if (b.dof >= 0 && b.slides) {
        pose.o = pose.o + pose.R * b.axis * x[static_cast<std::size_t>(b.dof)].q;
      } else if (b.dof >= 0) {
        const T &c = x[static_cast<std::size_t>(b.dof)].c,
                &s = x[static_cast<std::size_t>(b.dof)].s;
        const M3<T> u = hat(b.axis);
        pose.R = (pose.R * (M3<T>::Identity() + u * s + u * u * (T(1) - c))).eval();
      }
      poses.push_back({pose.R * b.after.R, pose.o + pose.R * b.after.o});
    }
    return poses;
  }

  /// Parent's coordinates of a motion to the link's.
  M6<T> motion(const Pose& pose) const {
    const M3<T> R = is(Mistake::kRotationTransposed) ? pose.R : M3<T>(pose.R.transpose());
    const T sign(is(Mistake::kTranslationSign) ? 1 : -1);
    M6<T> X;
    X << R, M3<T>(R * hat(pose.o) * sign), M3<T>::Zero(), R;
    return X;
  }
  /// The link's coordinates of a force to the parent's.
  V6<T> inward(const Pose& pose, const V6<T>& f) const {
    if (is(Mistake::kChildForceNotTransformed)) return f;
    if (is(Mistake::kForceMovedLikeMotion)) {
      V6<T> out;
      out << pose.R * (f.template head<3>()) + hat(pose.o) * (pose.R * f.template tail<3>()),
          pose.R * f.template tail<3>();
      return out;
    }
    return motion(pose).transpose() * f;
  }

  V6<T> coriolis(const V6<T>& v, const V6<T>& v_J) const {
    if (is(Mistake::kCoriolisMissing)) return V6<T>::Zero();
    const M3<T> w = hat(V3<T>(v.template tail<3>())), l = hat(V3<T>(v.template head<3>()));
    V6<T> out;
    out << w * v_J.template head<3>() + l * v_J.template tail<3>(), w * v_J.template tail<3>();
    return is(Mistake::kCoriolisSign) ? V6<T>(-out) : out;
  }
  V6<T> bias(const M6<T>& M, const V6<T>& v) const {
    if (is(Mistake::kBiasMissing)) return V6<T>::Zero();
    const V6<T> h = M * v;
    const M3<T> w = hat(V3<T>(v.template tail<3>())), l = hat(V3<T>(v.template head<3>()));
    V6<T> out;
    out << w * h.template head<3>(), w * h.template tail<3>();
    if (!is(Mistake::kForceCrossLosesForce)) out.template tail<3>() += l * h.template head<3>();
    return out;
  }
  T spring(const Body& b, const Positions& x) const {
    const T force = b.stiffness * (x[static_cast<std::size_t>(b.dof)].q - b.rest);
    return is(Mistake::kSpringSign) ? T(-force) : force;
  }
  std::vector<V6<T>> velocities(const std::vector<Pose>& poses, const Values& qd) const {
    std::vector<V6<T>> v(bodies_.size(), V6<T>::Zero());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& b = bodies_[i];
      if (b.parent >= 0) v[i] = motion(poses[i]) * v[p(b)];
      if (b.dof >= 0) v[i] += b.Z * at(qd, b);
    }
    return v;
  }
  void subtractLoads(const std::vector<Pose>& poses, std::vector<V6<T>>& f) const {
    for (const Load& load : loads_) {
      M3<T> R_W = M3<T>::Identity();  // world axes to link axes
      for (int i = load.link; i >= 0; i = bodies_[static_cast<std::size_t>(i)].parent)
        R_W = (R_W * poses[static_cast<std::size_t>(i)].R.transpose()).eval();
      const bool turn = load.in_world_axes && !is(Mistake::kWorldLoadNotTurned);
      const V3<T> force = turn ? V3<T>(R_W * load.force) : load.force;
      const V3<T> moment = turn ? V3<T>(R_W * load.moment) : load.moment;
      V6<T> wrench;
      wrench << force, moment + hat(load.at) * force;
      f[static_cast<std::size_t>(load.link)] -= wrench;
    }
  }

  Mistake wrong_;
  V3<T> gravity_;
  std::vector<Body> bodies_;
  std::vector<Load> loads_;
  int dof_ = 0;
};

/** A witness that sits on the chair of one of ours (newton_euler, composite_body,
   articulated_body), answers the same quantities by the formulas above and gives their running
   error bounds: it is sure of its numbers, right or wrong. */
class FormulaWitness : public crosscheck::Witness {
 public:
  using Quantity = crosscheck::Quantity;
  using T = crosscheck::RunningError;

  FormulaWitness(std::string chair, const scene::Scene& scene, Mistake mistake)
      : name_(std::move(chair)),
        formulas_(scene.mechanism, crosscheck::RunningErrorNumbers(scene.mechanism), mistake) {}

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    if (name_ == "newton_euler")
      return quantity != Quantity::kQdd && quantity != Quantity::kReactions;
    return quantity == Quantity::kQdd || (name_ == "composite_body" && quantity == Quantity::kM);
  }
  crosscheck::Answer answer(Quantity quantity, const scene::State<double>& state) override {
    const MX<T> bounded = computed(quantity, crosscheck::runningErrorState(state));
    return {bounded.unaryExpr([](const T& x) { return x.value(); }),
            bounded.unaryExpr([](const T& x) { return x.bound(); })};
  }

 private:
  MX<T> computed(Quantity quantity, const scene::State<T>& state) const {
    const std::vector<T> zeros(state.qd.size(), T(0));
    const auto inverse = [&](const std::vector<T>& qd, const std::vector<T>& qdd, Asked asked) {
      return crosscheck::column(formulas_.inverse(state.x, qd, qdd, asked));
    };
    switch (quantity) {
      case Quantity::kM: {
        if (name_ == "composite_body") return formulas_.massMatrix(state.x);
        MX<T> M(formulas_.dof(), formulas_.dof());
        for (int j = 0; j < formulas_.dof(); ++j) {
          std::vector<T> unit = zeros;
          unit[static_cast<std::size_t>(j)] = 1;
          M.col(j) = inverse(zeros, unit, {false, false, false});
        }
        return M;
      }
      case Quantity::kc:
        return inverse(state.qd, zeros, {false, false, false});
      case Quantity::kg:
        return inverse(zeros, zeros, {true, true, false});
      case Quantity::kTau:
        return inverse(state.qd, state.qdd, {true, true, true});
      case Quantity::kQdd:
        return crosscheck::column(name_ == "composite_body"
                                      ? formulas_.forwardByMassMatrix(state.x, state.qd, state.tau)
                                      : formulas_.forward(state.x, state.qd, state.tau));
      case Quantity::kKinetic:
        return crosscheck::scalar(formulas_.kinetic(state.x, state.qd));
      case Quantity::kPotential:
        return crosscheck::scalar(formulas_.potential(state.x));
      case Quantity::kMomentum:
        return formulas_.momentum(state.x, state.qd);
      case Quantity::kReactions:
        break;
    }
    return {};
  }

  std::string name_;
  Formulas<crosscheck::RunningErrorNumbers> formulas_;
};

}  // namespace dynwitness::wrong
