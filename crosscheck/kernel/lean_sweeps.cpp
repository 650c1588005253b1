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

/// U of a link that turns about z, of which the column U z is known: points on the axis move with
/// the parent as well. With it U_zx = w_z w_x - w'_y = 2 w_z w_x - U_xz, and U_zz needs no sum.
/// @param rate  whether w'_x and w'_y are asked for; w'_z is known
void turnAbout(const Vector3& column, bool rate, Spin* m) {
  const Vector3& w = m->w;
  const Traced xx = w.x() * w.x(), yy = w.y() * w.y(), zz = w.z() * w.z();
  const Traced xy = w.x() * w.y(), xz = w.x() * w.z(), yz = w.y() * w.z();
  m->wd.x() = yz - column.y();
  m->wd.y() = column.x() - xz;
  const Traced twice = w.z() + w.z();
  m->U << -(yy + zz), xy - m->wd.z(), column.x(),  //
      xy + m->wd.z(), -(xx + zz), column.y(),      //
      rate ? xz - m->wd.y() : twice * w.x() - column.x(),
      rate ? yz + m->wd.x() : twice * w.y() - column.y(), column.z();
}

/// Whether a vector is one of the axes, or its opposite, whatever the state is.
bool isAxis(const Vector3& v) {
  int zeros = 0, ones = 0;
  for (int k = 0; k < 3; ++k) {
    zeros += v(k) == Traced(0);
    ones += v(k) == Traced(1) || v(k) == Traced(-1);
  }
  return zeros == 2 && ones == 1;
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
  return {
      S.xx - sw, S.yy + sw, S.zz, x.c * w - S.xy, x.c * S.xz - x.s * S.yz, x.s * S.xz + x.c * S.yz};
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
struct MassMoments {
  Traced mass;
  Vector3 h;
  Symmetric3 S;
};
MassMoments shiftedBack(const Vector3& p, const MassMoments& b) {
  return {b.mass, b.h + p * b.mass, b.S + symmetricProduct(b.h, p) + Symmetric3::outer(p, b.mass)};
}

Vector3 alongZ(Traced t) {
  return {0, 0, t};
}

bool isUnit(Traced x) {
  return x == Traced(1) || x == Traced(-1);
}

/// Whether a link's joint axis is the parent's z axis, or its opposite, whatever the numbers are.
bool isParallel(const LeanLink& link) {
  return isUnit(link.R(2, 2));
}

/** The axes of a link in a pose, its figures in those, and the way of vectors and moments to the
    parent.

    The axes of a link that turns ride with it, or stay those of the unturned joint: then its
    figures turn, and what passes through it does not. A child about a parallel axis goes on from
    there: it turns by the sum of both angles (by their difference, where the axes are opposite). */
class Passage {
 public:
  Passage(const LeanModel& model, const std::vector<Passage>& inboard, int i,
          const scene::State<Traced>& state, Turning turning)
      : R_(model.links[i].R), p_(model.links[i].p) {
    const LeanLink& link = model.links[i];
    const Passage* parent = link.parent < 0 ? nullptr : &inboard[link.parent];
    const bool parent_stays = parent != nullptr && parent->stays_;
    if (link.turns) {
      angle_ = state.x[link.slot];
      stays_ = link.stays;
      turned_ = !stays_;
      if (parent_stays && isParallel(link))
        angle_ = sum(angle_, parent->angle_, R_(2, 2));
      else
        turned_by_parent_ = parent_stays;
    } else {
      p_ += R_.row(2).transpose() * state.x[link.slot].q;
      turned_by_parent_ = parent_stays;
    }
    if (parent_stays) {
      p_ = turnedBack(parent->angle_, p_);
      parent_angle_ = parent->angle_;
    }
    by_matrix_ = turning == Turning::kByMatrix && (turned_ || turned_by_parent_);
    if (by_matrix_) R_ = matrix();
  }

  const Vector3& p() const { return p_; }  ///< origin of the link in the parent
  /// The joint's axis in the parent.
  Vector3 axis() const { return inward(Vector3(0, 0, 1)); }

  Vector3 outward(Vector3 v) const {
    if (by_matrix_) return R_ * v;
    if (turned_by_parent_) v = turned(parent_angle_, v);
    v = R_ * v;
    return turned_ ? turned(angle_, v) : v;
  }
  Vector3 inward(Vector3 v) const {
    if (by_matrix_) return R_.transpose() * v;
    if (turned_) v = turnedBack(angle_, v);
    v = R_.transpose() * v;
    return turned_by_parent_ ? turnedBack(parent_angle_, v) : v;
  }
  MassMoments inward(const MassMoments& b) const {
    Symmetric3 S = turned_ ? turnedBack(angle_, b.S) : b.S;
    S = S.turnedBack(by_matrix_ ? unturned_ : R_);
    if (turned_by_parent_) S = turnedBack(parent_angle_, S);
    return shiftedBack(p_, {b.mass, inward(b.h), S});
  }
  /// What rides with the link, in the axes that this one counts in.
  Vector3 posed(const Vector3& v) const { return stays_ ? turnedBack(angle_, v) : v; }
  Symmetric3 posed(const Symmetric3& S) const { return stays_ ? turnedBack(angle_, S) : S; }

 private:
  static JointPosition<Traced> sum(const JointPosition<Traced>& x, const JointPosition<Traced>& y,
                                   Traced sign) {
    return {0, x.c * y.c - sign * (x.s * y.s), x.s * y.c + sign * (x.c * y.s)};
  }
  Matrix3 matrix() {
    unturned_ = R_;
    Matrix3 R = R_;
    if (turned_by_parent_)
      for (int k = 0; k < 3; ++k) R.row(k) = turnedBack(parent_angle_, R_.row(k).transpose());
    if (turned_)
      for (int k = 0; k < 3; ++k) R.col(k) = turned(angle_, R.col(k));
    return R;
  }

  Matrix3 R_, unturned_;
  Vector3 p_;
  JointPosition<Traced> angle_, parent_angle_;  ///< from the unturned axes to those that ride
  bool stays_ = false, turned_ = false, turned_by_parent_ = false, by_matrix_ = false;
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
    out.S = {half * (I.yy + I.zz - I.xx),
             half * (I.xx + I.zz - I.yy),
             half * (I.xx + I.yy - I.zz),
             -I.xy,
             -I.xz,
             -I.yz};
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

void add(LeanLink& link, const MassMoments& b) {
  link.mass += b.mass;
  link.h += b.h;
  link.S = link.S + b.S;
}

/// Moves to the parent what the joint's motion cannot tell apart.
void regroupLink(LeanModel& model, int i) {
  LeanLink& link = model.links[i];
  MassMoments moved{0, Vector3::Zero(), Symmetric3::zero()};
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
      shiftedBack(link.p, {moved.mass, link.R.transpose() * moved.h, moved.S.turnedBack(link.R)}));
}

}  // namespace

void regroup(LeanModel& model) {
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) regroupLink(model, i);
}

void takeRod(LeanModel& model, int i, const Rod& rod) {
  LeanLink& link = model.links[i];
  link.mass += rod.mass;
  link.h.z() += rod.h;
  link.S.zz += rod.S;
  const Vector3 z = link.R.row(2).transpose();
  add(model.links[link.parent],
      shiftedBack(link.p, {-rod.mass, z * -rod.h, Symmetric3::outer(z, -rod.S)}));
  for (int k = link.parent; k >= 0; k = model.links[k].parent) regroupLink(model, k);
}

void slide(LeanModel& model, int moved, Traced t) {
  LeanLink& link = model.links[moved];
  link.p += link.R.row(2).transpose() * t;
  const MassMoments about = shiftedBack(alongZ(-t), {link.mass, link.h, link.S});
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

namespace {

/// What of a link's motion is asked for, beside what every link needs.
struct Asked {
  bool rate = false;              ///< w'_x or w'_y: a child turns about another axis
  bool U_x = false, U_y = false;  ///< the first and the second column of U
};

Asked askedOf(const LeanModel& model, int i, const std::vector<int>& children, const Passage& to) {
  Asked asked;
  const auto times = [&asked](const Vector3& v) {
    asked.U_x = asked.U_x || v.x() != Traced(0);
    asked.U_y = asked.U_y || v.y() != Traced(0);
  };
  const LeanLink& link = model.links[i];
  const Symmetric3 S = to.posed(link.S);
  times(to.posed(link.h));
  times({S.xz, S.yz, 0});
  for (const int c : children) {
    const LeanLink& child = model.links[c];
    times(to.posed(child.p));
    times(to.posed(Vector3(child.R.row(2).transpose())));  // its axis
    asked.rate = asked.rate || (child.turns && !isParallel(child));
  }
  return asked;
}

}  // namespace

std::vector<Traced> inverseDynamics(const LeanModel& model, const scene::State<Traced>& state,
                                    LeanTerms terms, Turning turning) {
  const int n = static_cast<int>(model.links.size());
  std::vector<Spin> motion(n);
  std::vector<Passage> passage;
  passage.reserve(n);
  std::vector<Vector3> f(n), moment(n);

  std::vector<std::vector<int>> children(n);
  for (int i = 0; i < n; ++i)
    if (model.links[i].parent >= 0) children[model.links[i].parent].push_back(i);

  // outward: how each link moves, and what it alone needs
  for (int i = 0; i < n; ++i) {
    const LeanLink& link = model.links[i];
    passage.emplace_back(model, passage, i, state, turning);
    const Passage& to = passage.back();
    const Traced qd = terms.velocities ? state.qd[link.dof] : Traced(0);
    const Traced qdd = terms.accelerations ? state.qdd[link.dof] : Traced(0);
    Spin at_rest;
    at_rest.w = at_rest.wd = at_rest.a = Vector3::Zero();
    at_rest.U = Matrix3::Zero();
    const Spin& parent = link.parent < 0 ? at_rest : motion[link.parent];
    Spin& m = motion[i];
    m.w = to.outward(parent.w);
    m.a = parent.a + parent.U * to.p();
    if (link.parent < 0 && terms.gravity) m.a = -model.gravity;
    m.a = to.outward(m.a);  // (1)
    const Asked asked = askedOf(model, i, children[i], to);
    const Vector3 axis = to.axis();
    if (link.turns) {
      m.w.z() += qd;
      if (isAxis(axis)) {
        m.wd = Vector3(0, 0, axis.dot(parent.wd) + qdd);
        turnAbout(to.outward(parent.U * axis), asked.rate, &m);  // (4)
      } else {
        m.wd = to.outward(parent.wd) + Vector3(m.w.y() * qd, -(m.w.x() * qd), qdd);
        m.U = accelerationMatrix(m.w, m.wd);
      }
    } else {
      const Traced twice = qd + qd;
      m.wd = to.outward(parent.wd);
      m.a += Vector3(m.w.y() * twice, -(m.w.x() * twice), qdd);
      m.U = accelerationMatrix(m.w, m.wd);
    }
    const Matrix3& U = m.U;
    const Symmetric3 S = to.posed(link.S);
    const Vector3 h = to.posed(link.h);
    const Vector3 ww = m.w.cwiseProduct(m.w);
    const Traced about_z = asked.U_x && asked.U_y ? S.xx * U(1, 0) - S.yy * U(0, 1)
                                                  : (S.xx - S.yy) * (m.w.x() * m.w.y()) +
                                                        (S.xx + S.yy) * m.wd.z();  // (5)
    f[i] = m.a * link.mass + U * h;                                                // (2)
    const Vector3 own = {S.yy * U(2, 1) - S.zz * U(1, 2) + S.yz * (ww.z() - ww.y()) +
                             S.xy * U(2, 0) - S.xz * U(1, 0),
                         S.zz * U(0, 2) - S.xx * U(2, 0) + S.xz * (ww.x() - ww.z()) +
                             S.yz * U(0, 1) - S.xy * U(2, 1),
                         about_z + S.xy * (ww.y() - ww.x()) + S.xz * U(1, 2) - S.yz * U(0, 2)};
    moment[i] = own + h.cross(m.a);
    if (terms.loads) {
      f[i] -= to.posed(link.force);
      moment[i] -= to.posed(link.moment);
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
    const Vector3 force = passage[i].inward(f[i]);  // (3)
    f[link.parent] += force;
    moment[link.parent] += passage[i].inward(moment[i]) + passage[i].p().cross(force);
  }
  return tau;
}

namespace {

/// Everything outboard of each joint as one body, and the ways between them.
std::pair<std::vector<Passage>, std::vector<MassMoments>> compositeBodies(
    const LeanModel& model, const scene::State<Traced>& state, Turning turning) {
  std::vector<Passage> passage;
  passage.reserve(model.links.size());
  std::vector<MassMoments> composite;
  for (const LeanLink& link : model.links) {
    const int i = static_cast<int>(passage.size());
    passage.emplace_back(model, passage, i, state, turning);
    composite.push_back({link.mass, passage[i].posed(link.h), passage[i].posed(link.S)});
  }
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    if (model.links[i].parent < 0) continue;
    const MassMoments carried = passage[i].inward(composite[i]);
    MassMoments& parent = composite[model.links[i].parent];
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
    const MassMoments& b = composite[i];
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
    const MassMoments& b = composite[i];
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
