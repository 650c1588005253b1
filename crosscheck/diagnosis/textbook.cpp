// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/textbook.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

Matrix3d turnAbout(int axis, double c, double s) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  Matrix3d R = Matrix3d::Identity();
  R(j, j) = R(k, k) = c;
  R(j, k) = -s;
  R(k, j) = s;
  return R;
}

/// Rodrigues: a turn about a unit vector.
Matrix3d turnAbout(const Vector3d& z, double c, double s) {
  Matrix3d hat;
  hat << 0, -z(2), z(1), z(2), 0, -z(0), -z(1), z(0), 0;
  return c * Matrix3d::Identity() + s * hat + (1 - c) * z * z.transpose();
}

/// The turn of a quaternion (w, x, y, z) of any length.
Matrix3d turnOf(double w, const Vector3d& v) {
  Matrix3d hat;
  hat << 0, -v(2), v(1), v(2), 0, -v(0), -v(1), v(0), 0;
  return Matrix3d::Identity() + (2 / (w * w + v.squaredNorm())) * (w * hat + hat * hat);
}

Matrix3d pointMass(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

/// The first terms of a sine's or a cosine's series.
double series(double x, int terms, bool sine) {
  double term = sine ? x : 1, sum = 0;
  for (int k = 0; k < terms; ++k) {
    sum += term;
    const int n = 2 * k + (sine ? 2 : 1);
    term *= -x * x / (n * (n + 1));
  }
  return sum;
}

}  // namespace

Frame composed(const std::vector<PlacementStep>& steps) {
  Frame out;
  for (const PlacementStep& step : steps)
    if (step.axis < 0)
      out.p += out.R * step.shift;
    else
      out.R = out.R * turnAbout(step.axis, std::cos(step.angle), std::sin(step.angle));
  return out;
}

TextbookModel textbookModel(const scene::Scene& scene) {
  using Kind = scene::Step::Kind;
  const scene::Mechanism& mechanism = scene.mechanism;
  const scene::RealNumbers<double> number(mechanism);
  const auto vector = [&](const scene::Vector& v) {
    return Vector3d(number(v[0]), number(v[1]), number(v[2]));
  };
  const auto turn = [&](int axis, const scene::Number& angle) {
    const scene::CosSin<double> a = number.angle(angle);
    return turnAbout(axis, a.c, a.s);
  };
  TextbookModel out;
  if (mechanism.has_gravity) out.gravity = vector(mechanism.gravity);
  for (const scene::Link& link : mechanism.links) {
    TextbookLink one;
    const scene::Joint& joint = link.joint;
    one.name = link.name;
    one.joint = joint.name;
    one.parent = link.parent;
    const scene::MassProperties& given = link.inertia;
    one.mass = number(given.mass);
    one.com = vector(given.com);
    one.written << number(given.xx), number(given.xy), number(given.xz),  //
        number(given.xy), number(given.yy), number(given.yz),             //
        number(given.xz), number(given.yz), number(given.zz);
    one.axes = turn(2, given.rpy[2]) * turn(1, given.rpy[1]) * turn(0, given.rpy[0]);
    one.about_origin = given.about == scene::MassProperties::About::kLinkOrigin;
    one.inertia = one.axes * one.written * one.axes.transpose();
    if (one.about_origin) one.inertia -= pointMass(one.mass, one.com);
    const auto stepsOf = [&](const std::vector<scene::Step>& steps, Frame* frame) {
      std::vector<PlacementStep> all;
      for (const scene::Step& step : steps) {
        PlacementStep s;
        Frame here;
        if (step.kind == Kind::kTranslate) {
          here.p = s.shift = vector(step.translation);
        } else {
          s.axis = step.kind == Kind::kRotateX ? 0 : step.kind == Kind::kRotateY ? 1 : 2;
          s.angle = number(step.angle);
          here.R = turn(s.axis, step.angle);
        }
        *frame = *frame * here;
        all.push_back(s);
      }
      return all;
    };
    if (link.parent >= 0) {
      one.kind = joint.kind;
      one.is_dh = joint.placement.convention == scene::Placement::Convention::kDh;
      one.is_mdh = joint.placement.convention == scene::Placement::Convention::kMdh;
      one.before_steps = stepsOf(joint.placement.beforeJoint(), &one.before);
      one.after_steps = stepsOf(joint.placement.afterJoint(), &one.after);
      if (scene::hasAxis(joint.kind)) one.axis = vector(joint.axis).normalized();
      one.pitch = number(joint.pitch);
      one.rotor = number(joint.rotor_inertia);
      one.gear = number(joint.gear_ratio);
      one.added = one.gear * one.gear * one.rotor;
      if (joint.gyroscopic) one.spin = one.gear * one.rotor;
      one.viscous = number(joint.friction.viscous);
      one.coulomb[0] = number(joint.friction.positive);
      one.coulomb[1] = number(joint.friction.negative);
      one.stiffness = number(joint.stiffness);
      one.rest = number(joint.rest);
    }
    one.q = out.positions;
    one.qd = out.dof;
    if (link.parent >= 0) {
      out.positions += static_cast<int>(scene::positionSlots(joint.kind).size());
      out.dof += scene::degreesOfFreedom(joint.kind);
    }
    out.links.push_back(one);
  }
  for (const scene::Wrench& w : mechanism.wrenches)
    out.wrenches.push_back({w.link, w.axes == scene::Wrench::Axes::kWorld, vector(w.force),
                            vector(w.moment), vector(w.at)});
  return out;
}

Textbook::Textbook(const Belief& belief)
    : formulas_(belief.formulas),
      passing_(belief.passing),
      gravity_(belief.model.gravity),
      dof_(belief.model.dof),
      positions_(belief.model.positions),
      wrenches_(belief.model.wrenches) {
  using scene::JointKind;
  const Formulas& f = formulas_;
  simple_ = f.products == Formulas::Products::kAll && f.factor_M == 1 && f.factor_c == 1 &&
            f.triangle == Formulas::Triangle::kBoth && f.mirrored == Formulas::Triangle::kBoth &&
            !f.qdd_ignored && !f.g_twice_in_tau && !f.c_times_qd;
  has_loads_ = !wrenches_.empty();
  for (std::size_t i = 0; i < belief.model.links.size(); ++i) {
    const TextbookLink& link = belief.model.links[i];
    int parent = -1;
    Frame before = link.before;
    if (link.parent >= 0) {
      parent = place_of_link_[static_cast<std::size_t>(link.parent)];
      before = parts_[static_cast<std::size_t>(parent)].after * link.before;
    }
    int q = link.q, qd = link.qd;
    const auto add = [&](Part::Kind kind, int slots, int rates, const Vector3d& axis) -> Part& {
      Part part;
      part.kind = kind;
      part.parent = parent;
      part.joint = static_cast<int>(i);
      part.before = before;
      part.axis = axis;
      part.q = q;
      part.qd = qd;
      part.rates = rates;
      q += slots;
      qd += rates;
      parent = static_cast<int>(parts_.size());
      before = Frame();
      parts_.push_back(part);
      return parts_.back();
    };
    switch (link.kind) {
      case JointKind::kFixed:
        add(Part::Kind::kRigid, 0, 0, link.axis);
        break;
      case JointKind::kRevolute:
        add(Part::Kind::kTurn, 1, 1, link.axis);
        break;
      case JointKind::kHelical:
        add(Part::Kind::kTurn, 1, 1, link.axis).pitch = link.pitch;
        break;
      case JointKind::kPrismatic:
        add(Part::Kind::kSlide, 1, 1, link.axis);
        break;
      case JointKind::kCylindrical:
        add(Part::Kind::kSlide, 1, 1, link.axis);
        add(Part::Kind::kTurn, 1, 1, link.axis);
        break;
      case JointKind::kUniversal:
        add(Part::Kind::kTurn, 1, 1, Vector3d::UnitX());
        add(Part::Kind::kTurn, 1, 1, Vector3d::UnitY());
        break;
      case JointKind::kPlanar: {
        // x and y of the joint frame turned by Rz(alpha) Ry(beta), which takes z to the axis
        const double rho = std::hypot(link.axis(0), link.axis(1));
        const Matrix3d R =
            turnAbout(2, rho == 0 ? 1 : link.axis(0) / rho, rho == 0 ? 0 : link.axis(1) / rho) *
            turnAbout(1, link.axis(2), rho);
        add(Part::Kind::kSlide, 1, 1, R.col(0));
        add(Part::Kind::kSlide, 1, 1, R.col(1));
        add(Part::Kind::kTurn, 1, 1, link.axis);
        break;
      }
      case JointKind::kSpherical:
        add(Part::Kind::kBall, 4, 3, link.axis);
        break;
      case JointKind::kFloating:
        add(Part::Kind::kFree, 7, 6, link.axis);
        break;
    }
    Part& last = parts_.back();
    last.link = static_cast<int>(i);
    last.after = link.after;
    last.mass = link.mass;
    last.com = link.com;
    last.inertia = link.after.R * link.inertia * link.after.R.transpose();
    if (last.rates == 1) {
      last.added = link.added;
      last.spin = link.spin;
      last.viscous = link.viscous;
      last.coulomb[0] = link.coulomb[0];
      last.coulomb[1] = link.coulomb[1];
      last.stiffness = link.stiffness;
      last.rest = link.rest;
    }
    place_of_link_.push_back(static_cast<int>(parts_.size()) - 1);
  }
}

std::vector<Textbook::Placed> Textbook::placed(const Vector& q) const {
  std::vector<Placed> out(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    Frame joint;
    switch (part.kind) {
      case Part::Kind::kRigid:
        break;
      case Part::Kind::kTurn: {
        const double angle = q(part.q);
        const double x = formulas_.reduced ? std::remainder(angle, 2 * M_PI) : angle;
        const double c =
            formulas_.cosine_terms > 0 ? series(x, formulas_.cosine_terms, false) : std::cos(angle);
        const double s =
            formulas_.sine_terms > 0 ? series(x, formulas_.sine_terms, true) : std::sin(angle);
        joint.R = turnAbout(part.axis, c, s);
        joint.p = part.axis * (part.pitch * angle);
        break;
      }
      case Part::Kind::kSlide:
        joint.p = part.axis * q(part.q);
        break;
      case Part::Kind::kBall:
        joint.R = turnOf(q(part.q), q.segment<3>(part.q + 1));
        break;
      case Part::Kind::kFree:
        joint.p = q.segment<3>(part.q);
        joint.R = turnOf(q(part.q + 3), q.segment<3>(part.q + 4));
        break;
    }
    const Frame here = part.before * joint;
    Placed& at = out[i];
    at.E = here.R.transpose();
    at.r = here.p;
    if (part.link >= 0 && part.link == formulas_.turned_back)  // the link's axes, not the joint's
      at.E = part.after.R * (here.R * part.after.R);
    at.com = part.after.p + part.after.R * part.com;
    if (part.link >= 0 && part.link == formulas_.com_elsewhere && part.parent >= 0) {
      const Frame& parent = parts_[static_cast<std::size_t>(part.parent)].after;
      if (formulas_.com == Formulas::Com::kParentFrame)
        at.com = at.E * (parent.p + parent.R * part.com - at.r);
      if (formulas_.com == Formulas::Com::kParentAxes)
        at.com = part.after.p + at.E * (parent.R * part.com);
    }
  }
  return out;
}

/// The same places for a sweep in world axes.
std::vector<Textbook::Placed> Textbook::inWorldAxes(std::vector<Placed> at) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const int up = parts_[i].parent;
    const Matrix3d R = up < 0 ? Matrix3d::Identity() : at[static_cast<std::size_t>(up)].Z;
    Placed& here = at[i];
    here.Z = R * here.E.transpose();
    here.E = Matrix3d::Identity();
    here.r = R * here.r;
    here.com = here.Z * here.com;
  }
  return at;
}

Textbook::JointMotion Textbook::jointMotion(const Part& part, const Matrix3d& Z, const Vector& qd,
                                            const Vector& qdd) {
  JointMotion J;
  switch (part.kind) {
    case Part::Kind::kRigid:
      break;
    case Part::Kind::kTurn:
      J.w = Z * part.axis * qd(part.qd);
      J.wd = Z * part.axis * qdd(part.qd);
      J.v = part.pitch * J.w;
      J.a = part.pitch * J.wd;
      break;
    case Part::Kind::kSlide:
      J.v = Z * part.axis * qd(part.qd);
      J.a = Z * part.axis * qdd(part.qd);
      break;
    case Part::Kind::kBall:
      J.w = Z * qd.segment<3>(part.qd);
      J.wd = Z * qdd.segment<3>(part.qd);
      break;
    case Part::Kind::kFree:
      J.v = Z * qd.segment<3>(part.qd);
      J.w = Z * qd.segment<3>(part.qd + 3);
      J.a = Z * qdd.segment<3>(part.qd);
      J.wd = Z * qdd.segment<3>(part.qd + 3);
      break;
  }
  return J;
}

/// From the motion of the parent to that of the part.
Textbook::Motion Textbook::moved(const Part& part, const Placed& at, const Motion& up,
                                 const JointMotion& J) const {
  const Formulas& on = formulas_;
  const Matrix3d& E = at.E;
  const Vector3d& r = at.r;
  Motion here;
  const Vector3d Ew = E * up.w;
  here.w = Ew + J.w;
  Vector3d wd_moved = Ew.cross(J.w), a_moved = 2 * Ew.cross(J.v) + J.w.cross(J.v);
  if (!on.slide_coriolis && part.kind != Part::Kind::kFree) a_moved.setZero();
  if (on.joint_bias != Formulas::Bias::kKept) {
    const Vector3d Ev = E * (up.v + up.w.cross(r));
    here.v = Ev + J.v;
    if (on.biased_joint < 0 || on.biased_joint == part.joint) {
      wd_moved.setZero();
      a_moved.setZero();  // of a spatial acceleration, w x v remains
      if (on.joint_bias == Formulas::Bias::kSpatial) a_moved = here.w.cross(J.v) - Ev.cross(J.w);
    }
  }
  here.wd = E * up.wd + J.wd + wd_moved;
  const Vector3d inward = on.centripetal ? Vector3d(up.w.cross(up.w.cross(r))) : Vector3d::Zero();
  here.a = E * (up.a + up.wd.cross(r) + inward) + J.a + a_moved;
  here.wd_J = E * up.wd_J + J.wd;
  here.a_J = E * (up.a_J + up.wd_J.cross(r)) + J.a;
  here.R = up.R * E.transpose();
  return here;
}

/// What a part needs for its motion.
Textbook::Wrench Textbook::needed(const Part& part, const Placed& at, const Motion& here,
                                  bool raw_gravity) const {
  const Formulas& on = formulas_;
  const Vector3d& rc = at.com;
  const Matrix3d I = on.in_world ? Matrix3d(at.Z * part.inertia * at.Z.transpose()) : part.inertia;
  const Vector3d w_I_w = here.w.cross(I * here.w);
  const Vector3d inward =
      on.centripetal ? Vector3d(here.w.cross(here.w.cross(rc))) : Vector3d::Zero();
  Vector3d ac = on.point_bias ? Vector3d(here.a + here.wd.cross(rc) + inward)
                              : Vector3d(here.a_J + here.wd_J.cross(rc));
  if (raw_gravity) ac -= at.Z * gravity_;
  Wrench out;
  out.f = part.mass * ac;
  out.n = I * (on.turn_bias ? here.wd : here.wd_J) + rc.cross(out.f);
  if (on.gyroscopic && (on.not_gyroscopic < 0 || on.not_gyroscopic != part.link)) out.n += w_I_w;
  return out;
}

void Textbook::addLoads(const std::vector<Placed>& at, const std::vector<Motion>& m,
                        std::vector<Wrench>& through) const {
  for (const TextbookWrench& wrench : wrenches_) {
    const auto i = static_cast<std::size_t>(place_of_link_[static_cast<std::size_t>(wrench.link)]);
    const Frame& after = parts_[i].after;
    const Matrix3d R = wrench.in_world ? Matrix3d(m[i].R.transpose()) : Matrix3d(at[i].Z * after.R);
    const Vector3d force = R * wrench.force;
    through[i].f -= force;
    through[i].n -= R * wrench.moment + (at[i].Z * (after.p + after.R * wrench.at)).cross(force);
  }
}

/// From what each part needs to what passes through its joint, and the joint forces.
Textbook::Vector Textbook::passedInward(const std::vector<Placed>& at, const std::vector<Motion>& m,
                                        const Vector& qd, const Vector& qdd,
                                        std::vector<Wrench>& through) const {
  Vector tau = Vector::Zero(dof_);
  for (std::size_t i = parts_.size(); i-- > 0;) {
    const Part& part = parts_[i];
    const Matrix3d &E = at[i].E, &Z = at[i].Z;
    const Vector3d &f = through[i].f, &n = through[i].n;
    const Vector3d axis = Z * part.axis;
    Vector3d own = n;
    switch (part.kind) {
      case Part::Kind::kRigid:
        break;
      case Part::Kind::kTurn:
        tau(part.qd) = axis.dot(n + part.pitch * f) + part.added * qdd(part.qd);
        break;
      case Part::Kind::kSlide:
        tau(part.qd) = axis.dot(f) + part.added * qdd(part.qd);
        break;
      case Part::Kind::kBall:
        tau.segment<3>(part.qd) = Z.transpose() * n;
        break;
      case Part::Kind::kFree:
        tau.segment<3>(part.qd) = Z.transpose() * f;
        tau.segment<3>(part.qd + 3) = Z.transpose() * n;
        break;
    }
    if (part.parent < 0) continue;
    const auto p = static_cast<std::size_t>(part.parent);
    if (part.spin != 0) {  // a rotor on the parent, which turns about the joint's axis
      const Vector3d Ew = E * m[p].w, Ewd = E * m[p].wd;
      own += part.spin * (axis * qdd(part.qd) + Ew.cross(axis) * qd(part.qd));
      tau(part.qd) += part.spin * axis.dot(Ewd);
    }
    const Vector3d force = E.transpose() * f;
    through[p].f += force;
    through[p].n += E.transpose() * own + at[i].r.cross(force);
  }
  return tau;
}

Textbook::Vector Textbook::sweep(const std::vector<Placed>& given, const Vector& qd,
                                 const Vector& qdd, bool gravity, bool loads,
                                 Eigen::MatrixXd* reactions) const {
  std::vector<Placed> turned;
  if (formulas_.in_world) turned = inWorldAxes(given);
  const std::vector<Placed>& at = formulas_.in_world ? turned : given;
  const bool raw_gravity = gravity && formulas_.gravity_not_turned;
  Motion world;
  if (gravity && !raw_gravity) world.a = world.a_J = -this->gravity(given);
  std::vector<Motion> m(parts_.size());
  std::vector<Wrench> through(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const Motion& up = part.parent < 0 ? world : m[static_cast<std::size_t>(part.parent)];
    m[i] = moved(part, at[i], up, jointMotion(part, at[i].Z, qd, qdd));
    through[i] = needed(part, at[i], m[i], raw_gravity);
  }
  if (loads) addLoads(at, m, through);
  Vector tau = passedInward(at, m, qd, qdd, through);
  if (reactions != nullptr) *reactions = answeredReactions(at, m, through);
  return tau;
}

/// Link by link but for the root: force and moment about the moved joint frame's origin, in its
/// axes.
Eigen::MatrixXd Textbook::answeredReactions(const std::vector<Placed>& at,
                                            const std::vector<Motion>& m,
                                            const std::vector<Wrench>& through) const {
  const Formulas& on = formulas_;
  Vector out(6 * static_cast<Eigen::Index>(place_of_link_.size() - 1));
  for (std::size_t link = 1; link < place_of_link_.size(); ++link) {
    const auto i = static_cast<std::size_t>(place_of_link_[link]);
    const Frame& after = parts_[i].after;
    const Matrix3d& Z = at[i].Z;
    Vector3d f = Z.transpose() * through[i].f, n = Z.transpose() * through[i].n;
    if (on.reaction_about == Formulas::About::kLink) n -= after.p.cross(f);
    if (on.reaction_about == Formulas::About::kCom) n -= (Z.transpose() * at[i].com).cross(f);
    Matrix3d R = Matrix3d::Identity();
    if (on.reaction_axes == Formulas::Axes::kLink) R = after.R.transpose();
    if (on.reaction_axes == Formulas::Axes::kWorld) R = on.in_world ? Z : m[i].R;
    if (on.reaction_on_parent) R = -R;
    const auto row = 6 * static_cast<Eigen::Index>(link - 1);
    out.segment<3>(row + (on.moment_first ? 3 : 0)) = R * f;
    out.segment<3>(row + (on.moment_first ? 0 : 3)) = R * n;
  }
  return out;
}

Textbook::Input Textbook::received(const scene::State<double>& state) const {
  const Passing& by = passing_;
  Input in{Vector::Zero(positions_), Vector::Zero(dof_), Vector::Zero(dof_)};
  for (int i = 0; i < positions_; ++i) {
    const auto from = static_cast<std::size_t>(
        by.position_order.empty() ? i : by.position_order[static_cast<std::size_t>(i)]);
    in.q(i) = state.x[from].q;
    if (!by.position_sign.empty()) in.q(i) *= by.position_sign[static_cast<std::size_t>(i)];
  }
  for (const Part& part : parts_) {
    if (part.kind == Part::Kind::kTurn && by.angle_unit != 1) in.q(part.q) *= by.angle_unit;
    if (by.xyzw && (part.kind == Part::Kind::kBall || part.kind == Part::Kind::kFree)) {
      const int at = part.q + (part.kind == Part::Kind::kFree ? 3 : 0);
      const Eigen::Vector4d given = in.q.segment<4>(at);
      in.q(at) = given(3);
      in.q.segment<3>(at + 1) = given.head<3>();
    }
  }
  for (int i = 0; i < dof_; ++i) {
    const auto from =
        static_cast<std::size_t>(by.order.empty() ? i : by.order[static_cast<std::size_t>(i)]);
    const double sign = by.sign.empty() ? 1 : by.sign[static_cast<std::size_t>(i)];
    if (!state.qd.empty()) in.qd(i) = sign * state.qd[from];
    if (!state.qdd.empty()) in.qdd(i) = sign * state.qdd[from];
  }
  if (by.world_turns || by.world_slides)
    for (const Part& part : parts_) {
      if (part.kind != Part::Kind::kBall && part.kind != Part::Kind::kFree) continue;
      const bool is_free = part.kind == Part::Kind::kFree;
      const int q = part.q + (is_free ? 3 : 0), turn = part.qd + (is_free ? 3 : 0);
      const Matrix3d back = turnOf(in.q(q), in.q.segment<3>(q + 1)).transpose();
      if (by.world_turns) {
        in.qd.segment<3>(turn) = (back * in.qd.segment<3>(turn)).eval();
        in.qdd.segment<3>(turn) = (back * in.qdd.segment<3>(turn)).eval();
      }
      if (!is_free || !by.world_slides) continue;
      const Vector3d w = in.qd.segment<3>(turn);
      in.qd.segment<3>(part.qd) = (back * in.qd.segment<3>(part.qd)).eval();
      const Vector3d v = in.qd.segment<3>(part.qd);
      in.qdd.segment<3>(part.qd) = (back * in.qdd.segment<3>(part.qd)).eval() - w.cross(v);
    }
  return in;
}

/// Forces as they are passed on.
Eigen::MatrixXd Textbook::answeredForces(const Vector& given, const Vector& q) const {
  const Passing& by = passing_;
  Vector tau = given;
  if ((by.world_turns || by.world_slides) && by.world_forces)
    for (const Part& part : parts_) {
      if (part.kind != Part::Kind::kBall && part.kind != Part::Kind::kFree) continue;
      const bool is_free = part.kind == Part::Kind::kFree;
      const int at = part.q + (is_free ? 3 : 0), turn = part.qd + (is_free ? 3 : 0);
      const Matrix3d R = turnOf(q(at), q.segment<3>(at + 1));
      if (by.world_turns) tau.segment<3>(turn) = (R * tau.segment<3>(turn)).eval();
      if (is_free && by.world_slides)
        tau.segment<3>(part.qd) = (R * tau.segment<3>(part.qd)).eval();
    }
  if (by.order.empty() && by.sign.empty()) return tau;
  Vector out = tau;
  for (int i = 0; i < dof_; ++i) {
    const int to = by.order.empty() ? i : by.order[static_cast<std::size_t>(i)];
    out(to) = tau(i) * (by.sign.empty() ? 1 : by.sign[static_cast<std::size_t>(i)]);
  }
  return out;
}

Textbook::Vector Textbook::springs(const Vector& q) const {
  Vector out = Vector::Zero(dof_);
  for (const Part& part : parts_)
    if (part.stiffness != 0) out(part.qd) = part.stiffness * (q(part.q) - part.rest);
  return out;
}

Textbook::Vector Textbook::friction(const Vector& qd) const {
  Vector out = Vector::Zero(dof_);
  for (const Part& part : parts_) {
    if (part.rates != 1) continue;
    const double rate = qd(part.qd);
    out(part.qd) = part.viscous * rate + (rate > 0   ? part.coulomb[0]
                                          : rate < 0 ? -part.coulomb[1]
                                                     : 0);
  }
  return out;
}

/// In world axes.
Vector3d Textbook::gravity(const std::vector<Placed>& at) const {
  Vector3d out = gravity_;
  if (formulas_.gravity_turns_with < 0) return out;
  const auto link = static_cast<std::size_t>(formulas_.gravity_turns_with);
  for (int i = place_of_link_[link]; i >= 0; i = parts_[static_cast<std::size_t>(i)].parent)
    out = at[static_cast<std::size_t>(i)].E.transpose() * out;
  return out;
}

double Textbook::potential(const std::vector<Placed>& at, const Vector& q) const {
  double V = 0;
  const Vector3d weight = gravity(at);
  std::vector<Frame> world(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const Frame own{at[i].E.transpose(), at[i].r};
    world[i] = part.parent < 0 ? own : world[static_cast<std::size_t>(part.parent)] * own;
    V -= part.mass * weight.dot(world[i].p + world[i].R * at[i].com);
    if (part.stiffness != 0) V += part.stiffness * std::pow(q(part.q) - part.rest, 2) / 2;
  }
  return V;
}

/// Of all moving links, in world axes about the world's origin, linear part first.
Textbook::Vector Textbook::momentum(const std::vector<Placed>& at, const Vector& qd) const {
  struct Moving {
    Vector3d o, w, v;
    bool moves;
  };
  const std::vector<Placed> here = inWorldAxes(at);
  std::vector<Moving> m;
  Vector3d P = Vector3d::Zero(), L = P;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const Moving rest{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), false};
    const Moving up = part.parent < 0 ? rest : m[static_cast<std::size_t>(part.parent)];
    const Matrix3d& R = here[i].Z;
    Vector3d slide = Vector3d::Zero(), turn = slide;
    switch (part.kind) {
      case Part::Kind::kRigid:
        break;
      case Part::Kind::kTurn:
        turn = R * part.axis * qd(part.qd);
        slide = part.pitch * turn;
        break;
      case Part::Kind::kSlide:
        slide = R * part.axis * qd(part.qd);
        break;
      case Part::Kind::kBall:
        turn = R * qd.segment<3>(part.qd);
        break;
      case Part::Kind::kFree:
        slide = R * qd.segment<3>(part.qd);
        turn = R * qd.segment<3>(part.qd + 3);
        break;
    }
    m.push_back({up.o + here[i].r, up.w + turn, up.v + up.w.cross(here[i].r) + slide,
                 up.moves || part.rates > 0});
    const Moving& own = m.back();
    const Vector3d p = part.mass * (own.v + own.w.cross(here[i].com));
    P += p;
    L += R * part.inertia * R.transpose() * own.w + (own.o + here[i].com).cross(p);
    if (part.spin != 0 && up.moves) L += part.spin * (R * part.axis * qd(part.qd));
  }
  Vector out(6);
  out << P, L;
  return out;
}

Eigen::MatrixXd Textbook::operator()(Quantity quantity, const scene::State<double>& asked,
                                     bool solved_for_qdd) const {
  const Formulas& on = formulas_;
  scene::State<double> state = asked;
  const auto n = static_cast<std::size_t>(dof_);
  const std::vector<double> zeros(n, 0.0);
  if (state.qd.empty()) state.qd = zeros;
  if (state.qdd.empty()) state.qdd = zeros;
  const Input in = received(state);
  const std::vector<Placed> at = placed(in.q);
  const Vector none = Vector::Zero(dof_);

  // in the coordinates of who asks
  const auto forces = [&](const std::vector<double>& qd, const std::vector<double>& qdd) {
    scene::State<double> here = state;
    here.qd = qd;
    here.qdd = qdd;
    const Input moved = received(here);
    return Vector(answeredForces(sweep(at, moved.qd, moved.qdd, false, false), in.q));
  };
  const auto mass = [&] {
    Eigen::MatrixXd M(dof_, dof_);
    for (std::size_t j = 0; j < n; ++j) {
      std::vector<double> unit = zeros;
      unit[j] = 1;
      M.col(static_cast<Eigen::Index>(j)) = forces(zeros, unit);
    }
    return M;
  };
  const auto kept = [&](Eigen::MatrixXd M) -> Eigen::MatrixXd {
    if (on.triangle == Formulas::Triangle::kLower) return M.triangularView<Eigen::Lower>();
    if (on.triangle == Formulas::Triangle::kUpper) return M.triangularView<Eigen::Upper>();
    if (on.mirrored == Formulas::Triangle::kLower) return M.selfadjointView<Eigen::Lower>();
    if (on.mirrored == Formulas::Triangle::kUpper) return M.selfadjointView<Eigen::Upper>();
    return M;
  };
  const auto sums = [&]() -> Vector {
    const bool all = on.products == Formulas::Products::kAll;
    Vector c = none;
    if (on.products != Formulas::Products::kSquares) c = forces(state.qd, zeros);
    if (all) return c;
    Vector squares = none;
    for (std::size_t j = 0; j < n; ++j) {
      std::vector<double> one = zeros;
      one[j] = state.qd[j];
      squares += forces(one, zeros);
    }
    return on.products == Formulas::Products::kSquares ? squares : Vector(c - squares);
  };
  const auto products = [&]() -> Vector {
    if (!on.c_times_qd) return sums();
    return sums().cwiseProduct(Eigen::Map<const Vector>(state.qd.data(), dof_));
  };
  const auto weight = [&] {
    return Vector(answeredForces(sweep(at, none, none, true, false) + springs(in.q), in.q));
  };

  switch (quantity) {
    case Quantity::kM:
      return on.factor_M * kept(mass());
    case Quantity::kc: {
      const Vector c = on.factor_c * products();
      return on.gravity_in_c ? Vector(c + weight()) : c;
    }
    case Quantity::kg:
      return weight();
    case Quantity::kTau: {
      if (simple_)
        return answeredForces(
            sweep(at, in.qd, in.qdd, true, true) + springs(in.q) + friction(in.qd), in.q);
      Vector tau =
          answeredForces(sweep(at, none, none, true, true) + springs(in.q) + friction(in.qd), in.q);
      if (on.g_twice_in_tau) tau += weight();
      tau += on.factor_in_tau ? Vector(on.factor_c * products()) : sums();
      if (!on.qdd_ignored || solved_for_qdd) {
        const Vector qdd = Eigen::Map<const Vector>(state.qdd.data(), dof_);
        const bool by_mass = on.triangle_in_tau || on.mirrored != Formulas::Triangle::kBoth;
        const Vector inertial = by_mass ? Vector(kept(mass()) * qdd) : forces(zeros, state.qdd);
        tau += (on.factor_in_tau ? on.factor_M : 1) * inertial;
      }
      return tau;
    }
    case Quantity::kKinetic: {
      const Vector qd = Eigen::Map<const Vector>(state.qd.data(), dof_);
      return Eigen::MatrixXd::Constant(
          1, 1,
          on.factor_kinetic * on.factor_M *
              qd.dot((on.mirrored == Formulas::Triangle::kBoth ? kept(mass()) : mass()) * qd) / 2);
    }
    case Quantity::kPotential:
      return Eigen::MatrixXd::Constant(1, 1, potential(at, in.q));
    case Quantity::kMomentum:
      return momentum(at, in.qd);
    case Quantity::kReactions: {
      Eigen::MatrixXd reactions;
      sweep(at, in.qd, in.qdd, true, true, &reactions);
      return reactions;
    }
    default:
      return {};
  }
}

Eigen::VectorXd Textbook::inertial(const scene::State<double>& state) const {
  const Vector qdd = Eigen::Map<const Vector>(state.qdd.data(), dof_);
  if (formulas_.triangle != Formulas::Triangle::kBoth ||
      formulas_.mirrored != Formulas::Triangle::kBoth)
    return (*this)(Quantity::kM, state) * qdd;
  scene::State<double> still = state;
  still.qd.assign(state.qd.size(), 0.0);
  const Input in = received(still);
  return formulas_.factor_M *
         answeredForces(sweep(placed(in.q), in.qd, in.qdd, false, false), in.q).col(0);
}

}  // namespace dynwitness::crosscheck
