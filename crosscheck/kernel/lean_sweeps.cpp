// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/lean_sweeps.hpp"

#include <utility>

namespace dynwitness::crosscheck::kernel {
namespace {

using scene::JointPosition;

/// A 3 x 3 matrix U with which the points of a body accelerate, a + U r.
struct Spin {
  Vector3 w, wd;  ///< angular velocity and its rate
  Vector3 a;      ///< acceleration of the origin
  Matrix3 U;
};

Matrix3 accelerationMatrix(const Vector3& w, const Vector3& wd) {
  const Traced xx = w.x() * w.x(), yy = w.y() * w.y(), zz = w.z() * w.z();
  const Traced xy = w.x() * w.y(), xz = w.x() * w.z(), yz = w.y() * w.z();
  Matrix3 U;
  U << -(yy + zz), xy - wd.z(), xz + wd.y(),  //
      xy + wd.z(), -(xx + zz), yz - wd.x(),   //
      xz - wd.y(), yz + wd.x(), -(xx + yy);
  return U;
}

/// Coordinates before the joint's turn to coordinates after it: Rz(q)' v.
Vector3 turned(const JointPosition<Traced>& x, const Vector3& v) {
  return {x.c * v.x() + x.s * v.y(), x.c * v.y() - x.s * v.x(), v.z()};
}
Vector3 turnedBack(const JointPosition<Traced>& x, const Vector3& v) {
  return {x.c * v.x() - x.s * v.y(), x.s * v.x() + x.c * v.y(), v.z()};
}

/// Rz(q) S Rz(q)', with four products where ten are written:  w = s (S_xx - S_yy) + 2 c S_xy.
Symmetric3 turnedBack(const JointPosition<Traced>& x, const Symmetric3& S) {
  const Traced w = x.s * (S.xx - S.yy) + x.c * (S.xy + S.xy);
  const Traced sw = x.s * w;
  return {S.xx - sw,
          S.yy + sw,
          S.zz,
          x.c * w - S.xy,
          x.c * S.xz - x.s * S.yz,
          x.s * S.xz + x.c * S.yz};
}

/// a b' + b a'
Symmetric3 symmetricProduct(const Vector3& a, const Vector3& b) {
  const Traced xx = a.x() * b.x(), yy = a.y() * b.y(), zz = a.z() * b.z();
  return {xx + xx,
          yy + yy,
          zz + zz,
          a.x() * b.y() + a.y() * b.x(),
          a.x() * b.z() + a.z() * b.x(),
          a.y() * b.z() + a.z() * b.y()};
}

/// Mass moments about a point from which the old origin lies at p.
struct Moments {
  Traced mass;
  Vector3 h;
  Symmetric3 S;
};
Moments shiftedBack(const Vector3& p, const Moments& b) {
  return {b.mass, b.h + p * b.mass,
          b.S + symmetricProduct(b.h, p) + Symmetric3::outer(p, b.mass)};
}

Vector3 alongZ(Traced t) { return {0, 0, t}; }

/// Vectors and moments between parent and link, the joint included.
class Passage {
 public:
  Passage(const LeanLink& link, const scene::State<Traced>& state, Turning turning)
      : link_(link), by_matrix_(turning == Turning::kByMatrix && link.turns) {
    p_ = link.p;
    if (link.turns) {
      x_ = state.x[link.slot];
      if (by_matrix_) {
        R_ = link.R;
        R_.row(0) = link.R.row(0) * x_.c + link.R.row(1) * x_.s;
        R_.row(1) = link.R.row(1) * x_.c - link.R.row(0) * x_.s;
      }
    } else {
      p_ += link.R.row(2).transpose() * state.x[link.slot].q;
    }
  }
  const Vector3& p() const { return p_; }  ///< origin of the link in the parent
  Vector3 outward(const Vector3& v) const {
    if (by_matrix_) return R_ * v;
    const Vector3 at_joint = link_.R * v;
    return link_.turns ? turned(x_, at_joint) : at_joint;
  }
  Vector3 inward(const Vector3& v) const {
    if (by_matrix_) return R_.transpose() * v;
    return link_.R.transpose() * (link_.turns ? turnedBack(x_, v) : v);
  }
  Moments inward(const Moments& b) const {
    const Symmetric3 S = link_.turns ? turnedBack(x_, b.S) : b.S;
    return shiftedBack(p_, {b.mass, inward(b.h), S.turnedBack(link_.R)});
  }

 private:
  const LeanLink& link_;
  bool by_matrix_;
  JointPosition<Traced> x_;
  Matrix3 R_;
  Vector3 p_;
};

}  // namespace

bool isLean(const recursive::Model<Traced>& model) {
  if (!model.world_loads.empty() || model.gyroscopic || model.friction) return false;
  for (const recursive::LinkModel<Traced>& link : model.links)
    if (link.kind != scene::JointKind::kRevolute && link.kind != scene::JointKind::kPrismatic)
      return false;
  return true;
}

LeanModel leanModel(const recursive::Model<Traced>& model) {
  LeanModel lean;
  lean.gravity = model.gravity;
  const Traced half = Traced(1) / Traced(2);
  for (const recursive::LinkModel<Traced>& link : model.links) {
    LeanLink out;
    out.parent = link.parent;
    out.dof = link.dof;
    out.slot = link.slot;
    out.turns = link.kind == scene::JointKind::kRevolute;
    out.R = link.X_tree.R;
    out.p = link.X_tree.p;
    out.mass = link.M.mass;
    out.h = link.M.h;
    const Symmetric3& I = link.M.I;
    out.S = {half * (I.yy + I.zz - I.xx), half * (I.xx + I.zz - I.yy), half * (I.xx + I.yy - I.zz),
             -I.xy, -I.xz, -I.yz};
    out.rotor = link.rotor;
    out.stiffness = link.stiffness;
    out.rest = link.rest;
    out.force = link.load.force;
    out.moment = link.load.moment;
    lean.links.push_back(out);
  }
  return lean;
}

namespace {

void add(LeanLink& link, const Moments& b) {
  link.mass += b.mass;
  link.h += b.h;
  link.S = link.S + b.S;
}

/// Moves to the parent what the joint's motion cannot tell apart.
void regroupLink(LeanModel& model, int i) {
  LeanLink& link = model.links[i];
  Moments moved{0, Vector3::Zero(), Symmetric3::zero()};
  if (link.turns) {
    moved = {link.mass, alongZ(link.h.z()), Symmetric3::zero()};
    moved.S.zz = link.S.zz;
    link.mass = link.h.z() = link.S.zz = 0;
  } else {
    moved.S = link.S;
    link.S = Symmetric3::zero();
  }
  if (link.parent < 0) return;  // what rests in the world needs no force
  add(model.links[link.parent],
      shiftedBack(link.p,
                  {moved.mass, link.R.transpose() * moved.h, moved.S.turnedBack(link.R)}));
}

}  // namespace

void regroup(LeanModel& model) {
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) regroupLink(model, i);
}

void takeMass(LeanModel& model, int i, Traced mass) {
  LeanLink& link = model.links[i];
  link.mass += mass;
  add(model.links[link.parent],
      shiftedBack(link.p, {-mass, Vector3::Zero(), Symmetric3::zero()}));
  for (int k = link.parent; k >= 0; k = model.links[k].parent) regroupLink(model, k);
}

void slide(LeanModel& model, int moved, Traced t) {
  LeanLink& link = model.links[moved];
  link.p += link.R.row(2).transpose() * t;
  const Moments about = shiftedBack(alongZ(-t), {link.mass, link.h, link.S});
  link.h = about.h;
  link.S = about.S;
  link.moment -= alongZ(t).cross(link.force);
  for (LeanLink& child : model.links)
    if (child.parent == moved) child.p.z() -= t;
}

bool scaleLengths(LeanModel& model, Traced unit) {
  for (const LeanLink& link : model.links)
    if (!link.turns) return false;
  const Traced per = Traced(1) / unit;
  for (LeanLink& link : model.links) {
    link.p *= per;
    link.h *= unit;
    link.mass = link.mass * unit * unit;
    link.force *= unit;
  }
  model.gravity *= per;
  return true;
}

std::vector<Traced> inverseDynamics(const LeanModel& model, const scene::State<Traced>& state,
                                    LeanTerms terms, Turning turning) {
  const int n = static_cast<int>(model.links.size());
  std::vector<Spin> motion(n);
  std::vector<Passage> passage;
  std::vector<Vector3> f(n), moment(n);

  // outward: how each link moves, and what it alone needs
  for (int i = 0; i < n; ++i) {
    const LeanLink& link = model.links[i];
    passage.emplace_back(link, state, turning);
    const Passage& to = passage.back();
    const Traced qd = terms.velocities ? state.qd[link.dof] : Traced(0);
    const Traced qdd = terms.accelerations ? state.qdd[link.dof] : Traced(0);
    Spin& m = motion[i];
    m.w = m.wd = m.a = Vector3::Zero();
    if (terms.gravity) m.a = -model.gravity;
    if (link.parent >= 0) {
      const Spin& parent = motion[link.parent];
      m.w = to.outward(parent.w);
      m.wd = to.outward(parent.wd);
      m.a = parent.a + parent.U * to.p();
    }
    m.a = to.outward(m.a);                                                         // (1)
    const Vector3 w_p = m.w;
    if (link.turns) {
      m.wd += Vector3(w_p.y() * qd, -(w_p.x() * qd), qdd);
      m.w.z() += qd;
    } else {
      const Traced twice = qd + qd;
      m.a += Vector3(w_p.y() * twice, -(w_p.x() * twice), qdd);
    }
    m.U = accelerationMatrix(m.w, m.wd);
    const Matrix3& U = m.U;
    const Symmetric3& S = link.S;
    f[i] = m.a * link.mass + U * link.h - link.force;                              // (2)
    const Vector3 own = {
        S.yy * U(2, 1) - S.zz * U(1, 2) + S.yz * (U(2, 2) - U(1, 1)) + S.xy * U(2, 0) - S.xz * U(1, 0),
        S.zz * U(0, 2) - S.xx * U(2, 0) + S.xz * (U(0, 0) - U(2, 2)) + S.yz * U(0, 1) - S.xy * U(2, 1),
        S.xx * U(1, 0) - S.yy * U(0, 1) + S.xy * (U(1, 1) - U(0, 0)) + S.xz * U(1, 2) - S.yz * U(0, 2)};
    moment[i] = own + link.h.cross(m.a) - link.moment;
    if (!terms.loads) {
      f[i] += link.force;
      moment[i] += link.moment;
    }
  }

  // inward: what passes through each joint
  std::vector<Traced> tau(n);
  for (int i = n - 1; i >= 0; --i) {
    const LeanLink& link = model.links[i];
    Traced& out = tau[link.dof];
    out = link.turns ? moment[i].z() : f[i].z();
    if (terms.accelerations) out += link.rotor * state.qdd[link.dof];
    if (terms.springs) out += link.stiffness * (state.x[link.slot].q - link.rest);
    if (link.parent < 0) continue;
    const Vector3 force = passage[i].inward(f[i]);                                 // (3)
    f[link.parent] += force;
    moment[link.parent] += passage[i].inward(moment[i]) + passage[i].p().cross(force);
  }
  return tau;
}

namespace {

/// Everything outboard of each joint as one body, and the ways between them.
std::pair<std::vector<Passage>, std::vector<Moments>> compositeBodies(
    const LeanModel& model, const scene::State<Traced>& state, Turning turning) {
  std::vector<Passage> passage;
  std::vector<Moments> composite;
  for (const LeanLink& link : model.links) {
    passage.emplace_back(link, state, turning);
    composite.push_back({link.mass, link.h, link.S});
  }
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    if (model.links[i].parent < 0) continue;
    const Moments carried = passage[i].inward(composite[i]);
    Moments& parent = composite[model.links[i].parent];
    parent = {parent.mass + carried.mass, parent.h + carried.h, parent.S + carried.S};
  }
  return {std::move(passage), std::move(composite)};
}

}  // namespace

std::vector<Traced> massMatrix(const LeanModel& model, const scene::State<Traced>& state,
                               Turning turning) {
  const int n = static_cast<int>(model.links.size());
  const auto [passage, composite] = compositeBodies(model, state, turning);
  std::vector<Traced> M(static_cast<std::size_t>(n) * n);
  for (int i = n - 1; i >= 0; --i) {
    const LeanLink& link = model.links[i];
    const Moments& b = composite[i];
    // force and moment that a unit acceleration of joint i alone needs
    Vector3 f = {-b.h.y(), b.h.x(), 0}, m = {-b.S.xz, -b.S.yz, b.S.xx + b.S.yy};
    if (!link.turns) {
      f = {0, 0, b.mass};
      m = {b.h.y(), -b.h.x(), 0};
    }
    M[link.dof * n + link.dof] = (link.turns ? m.z() : f.z()) + link.rotor;
    for (int k = i; model.links[k].parent >= 0;) {
      f = passage[k].inward(f);
      m = passage[k].inward(m) + passage[k].p().cross(f);
      k = model.links[k].parent;
      const LeanLink& at = model.links[k];
      M[link.dof * n + at.dof] = M[at.dof * n + link.dof] = at.turns ? m.z() : f.z();
    }
  }
  return M;
}

std::vector<Traced> gravity(const LeanModel& model, const scene::State<Traced>& state,
                            Turning turning) {
  const int n = static_cast<int>(model.links.size());
  const auto [passage, composite] = compositeBodies(model, state, turning);
  std::vector<Vector3> a(n);
  std::vector<Traced> g(n);
  for (int i = 0; i < n; ++i) {
    const LeanLink& link = model.links[i];
    a[i] = passage[i].outward(link.parent < 0 ? Vector3(-model.gravity) : a[link.parent]);
    const Moments& b = composite[i];
    g[link.dof] = link.turns ? b.h.x() * a[i].y() - b.h.y() * a[i].x() : b.mass * a[i].z();
    g[link.dof] += link.stiffness * (state.x[link.slot].q - link.rest);
  }
  return g;
}

std::vector<Traced> solve(std::vector<Traced> M, std::vector<Traced> b,
                          const std::vector<int>& parent_dof) {
  const int n = static_cast<int>(b.size());
  const auto at = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
  std::vector<Traced> inverse_D(n);
  for (int k = n - 1; k >= 0; --k) {
    inverse_D[k] = Traced(1) / M[at(k, k)];
    for (int i = parent_dof[k]; i >= 0; i = parent_dof[i]) {
      const Traced l = M[at(k, i)] * inverse_D[k];
      for (int j = i; j >= 0; j = parent_dof[j]) M[at(i, j)] -= l * M[at(k, j)];
      b[i] -= l * b[k];
      M[at(k, i)] = l;
    }
  }
  for (int k = 0; k < n; ++k) {
    b[k] *= inverse_D[k];
    for (int i = parent_dof[k]; i >= 0; i = parent_dof[i]) b[k] -= M[at(k, i)] * b[i];
  }
  return b;
}

}  // namespace dynwitness::crosscheck::kernel
