// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a mechanism more than its tree, in MuJoCo's words: equality constraints and tendons.
// For those that are built with MuJoCo.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "crosscheck/witnesses/mjcf.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {

/** Closures, followers and springs between points of a scene as elements of its MJCF, and their
    equations at a state.

        plane, planar_point, point, skate, rolling    connect
        hinge, weld                                   weld
        distance                                      tendon, its length held
        followers                                     joint, a polynomial of the leader's q
        springs between points                        tendon with stiffness and damping

    MuJoCo's: the rows of the constraint Jacobian (efc_J), positions, velocities, and accelerations
    at given qacc (mj_rnePostConstraint). Ours: what its constraints, which are soft, do without.

      - A connect holds two points together, three rows in world axes; a weld has three more, half
        the rates of turning in axes of the second link. They are turned into the scene's rows, a
        plane's, a hinge's among them. Both points of a connect are put where b's origin is (a
        rolling disc: where it touches), on either link, a weld is told how the links stand.
      - d/dt of the rows times qd, of which MuJoCo's reference accelerations know nothing. With
        u = v_b - v_a of two points that meet at P, and n a direction seen on link a,

            row        n . u
            its rate   n . (a_b - a_a - 2 w_a x u) + n' . u         n', P' as seen on a
                     + n . (w_ba x (P' - v_b seen on a))             where P moves on b

        Turns alike, by angular velocities. */
class MujocoClosures {
 public:
  explicit MujocoClosures(const scene::Mechanism& mechanism)
      : closures_(mechanism.closures), followers_(scene::followers(mechanism)) {
    const ToldNumbers number(mechanism);
    sites_.resize(mechanism.links.size());
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      const scene::Closure& closure = closures_[i];
      ends_.push_back({end(closure.a, number), end(closure.b, number)});
      lengths_.push_back(static_cast<double>(number(closure.length)));
      const std::string name = closureName(i), a = mjcfLink(closure.a.link),
                        b = mjcfLink(closure.b.link);
      switch (closure.kind) {
        case scene::ClosureKind::kDistance:
          tendons_ += tendon(name, closure.a.link, ends_[i].a.at, closure.b.link, ends_[i].b.at);
          equalities_ += fmt::format("<tendon name=\"{0}\" tendon1=\"{0}\"/>", name);
          break;
        case scene::ClosureKind::kHinge:
        case scene::ClosureKind::kWeld:
          equalities_ += fmt::format("<weld name=\"{}\" body1=\"{}\" body2=\"{}\"/>", name, a, b);
          break;
        case scene::ClosureKind::kPlane:
        case scene::ClosureKind::kPlanarPoint:
        case scene::ClosureKind::kPoint:
        case scene::ClosureKind::kSkate:
        case scene::ClosureKind::kRolling:
          equalities_ += fmt::format(
              "<connect name=\"{}\" body1=\"{}\" body2=\"{}\" anchor=\"0 0 0\"/>", name, a, b);
          break;
      }
    }
    for (const scene::Follower& f : followers_)
      equalities_ +=
          fmt::format("<joint name=\"{}\" joint1=\"{}\" joint2=\"{}\" polycoef=\"{} 0 0 0\"/>",
                      followerName(f.link), mjcfJoint(f.link), mjcfJoint(f.leader),
                      mjcfNumbers({static_cast<double>(number(f.offset)),
                                   static_cast<double>(number(scene::Number(f.multiplier)))}));
    for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
      const scene::Spring& spring = mechanism.springs[i];
      tendons_ += tendon(springName(i), spring.a.link, vector(number.vector(spring.a.xyz)),
                         spring.b.link, vector(number.vector(spring.b.xyz)));
      springs_.push_back({static_cast<double>(number(spring.stiffness)),
                          static_cast<double>(number(spring.rest)),
                          static_cast<double>(number(spring.damping))});
    }
  }

  /// What stands in the body of a link.
  const std::string& sites(std::size_t link) const { return sites_[link]; }
  /// What stands beside the bodies.
  std::string elements() const {
    return fmt::format("<tendon>{}</tendon>\n<equality>{}</equality>\n", tendons_, equalities_);
  }
  /// How many rows MuJoCo may make of them.
  int mostRows() const { return static_cast<int>(6 * closures_.size() + followers_.size()) + 1; }

  /// After the file was read: finds the elements, and gives springs their numbers.
  /// @param links  MuJoCo's body, one a scene link
  void find(mjModel* model, const std::vector<int>& links) {
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      ends_[i].a.body = links[static_cast<std::size_t>(closures_[i].a.link)];
      ends_[i].b.body = links[static_cast<std::size_t>(closures_[i].b.link)];
      ids_.push_back(mj_name2id(model, mjOBJ_EQUALITY, closureName(i).c_str()));
      tendon_ids_.push_back(mj_name2id(model, mjOBJ_TENDON, closureName(i).c_str()));
    }
    for (const scene::Follower& f : followers_)
      follower_ids_.push_back(mj_name2id(model, mjOBJ_EQUALITY, followerName(f.link).c_str()));
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      const int id = mj_name2id(model, mjOBJ_TENDON, springName(i).c_str());
      model->tendon_stiffness[id] = springs_[i].stiffness;
      model->tendon_lengthspring[id] = springs_[i].rest;
      model->tendon_damping[id] = springs_[i].damping;
    }
  }

  /// Puts the anchors where points are to meet; the positions of links are up to date.
  void place(mjModel* model, const mjData* data) const {
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      mjtNum* at = model->eq_data + mjNEQDATA * ids_[i];
      if (closures_[i].kind == scene::ClosureKind::kDistance) continue;
      const bool is_weld = model->eq_type[ids_[i]] == mjEQ_WELD;
      const Vector3 P = meetingPoint(i, data);
      const int a = ends_[i].a.body, b = ends_[i].b.body;
      Eigen::Map<Vector3>(at + (is_weld ? 3 : 0)) = inLink(data, a, P);
      Eigen::Map<Vector3>(at + (is_weld ? 0 : 3)) = inLink(data, b, P);
      if (!is_weld) continue;
      mjtNum back[4];
      mju_negQuat(back, data->xquat + 4 * a);
      mju_mulQuat(at + 6, back, data->xquat + 4 * b);
      at[10] = 1;  // of turning against shifting
    }
  }

  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Equations {
    Rows J;                 ///< rows of the scene's closures, m x nv of MuJoCo
    Eigen::VectorXd gamma;  ///< J' qd, and what accelerations have at the qacc that was set
    Rows J_followers;       ///< one a follower: qd - multiplier qd of the leader
  };
  /// After mj_fwdPosition, mj_fwdVelocity and mj_rnePostConstraint without gravity.
  Equations equations(const mjModel* model, const mjData* data) const {
    Equations out;
    int m = 0;
    for (const scene::Closure& closure : closures_) m += scene::equationCount(closure.kind);
    out.J = Rows::Zero(m, model->nv);
    out.gamma = Eigen::VectorXd::Zero(m);
    int row = 0;
    for (std::size_t i = 0; i < closures_.size(); ++i) {
      const int count = scene::equationCount(closures_[i].kind);
      addClosure(i, model, data, row, out);
      row += count;
    }
    out.J_followers = Rows::Zero(static_cast<Eigen::Index>(followers_.size()), model->nv);
    for (std::size_t i = 0; i < followers_.size(); ++i)
      out.J_followers.row(static_cast<Eigen::Index>(i)) = rowsOf(follower_ids_[i], 1, model, data);
    return out;
  }

  /// A body of MuJoCo as it moves, in world axes.
  struct Moving {
    Moving(const mjModel* model, const mjData* data, int body)
        : p(data->xpos + 3 * body), R(Eigen::Map<const RowMajor3>(data->xmat + 9 * body)) {
      mjtNum six[6];  // angular part first
      mj_objectVelocity(model, data, mjOBJ_XBODY, body, six, 0);
      w = Eigen::Map<const Eigen::Vector3d>(six);
      v = Eigen::Map<const Eigen::Vector3d>(six + 3);
      mj_objectAcceleration(model, data, mjOBJ_XBODY, body, six, 0);
      w_rate = Eigen::Map<const Eigen::Vector3d>(six);
      a = Eigen::Map<const Eigen::Vector3d>(six + 3);
    }
    Eigen::Vector3d velocity(const Eigen::Vector3d& at) const { return v + w.cross(at - p); }
    Eigen::Vector3d acceleration(const Eigen::Vector3d& at) const {
      return a + w_rate.cross(at - p) + w.cross(w.cross(at - p));
    }
    Eigen::Vector3d p;
    Eigen::Matrix3d R;
    Eigen::Vector3d v, w, a, w_rate;

   private:
    using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  };

 private:
  using Vector3 = Eigen::Vector3d;
  using Matrix3 = Eigen::Matrix3d;

  struct End {
    Vector3 at;  ///< in link axes
    Matrix3 R;   ///< the closure's axes, to link axes
    int body = -1;
  };
  struct Ends {
    End a, b;
  };
  struct PointSpring {
    double stiffness, rest, damping;
  };

  static std::string closureName(std::size_t i) { return fmt::format("closure {}", i); }
  static std::string followerName(int link) { return fmt::format("follower {}", link); }
  static std::string springName(std::size_t i) { return fmt::format("spring {}", i); }
  static Vector3 vector(const ToldNumbers::Vector3& v) { return v.cast<double>(); }

  static End end(const scene::Attachment& attachment, const ToldNumbers& number) {
    const ToldNumbers::Frame X = number.frame(attachment.steps());
    return {vector(X.p), X.R.cast<double>()};
  }

  std::string tendon(const std::string& name, int a, const Vector3& at_a, int b,
                     const Vector3& at_b) {
    const auto site = [&](int link, const char* which, const Vector3& at) {
      sites_[static_cast<std::size_t>(link)] += fmt::format(
          "<site name=\"{} {}\" pos=\"{}\"/>", name, which, mjcfNumbers({at[0], at[1], at[2]}));
    };
    site(a, "a", at_a);
    site(b, "b", at_b);
    return fmt::format(
        "<spatial name=\"{0}\"><site site=\"{0} a\"/><site site=\"{0} b\"/></spatial>", name);
  }

  static Vector3 inWorld(const mjData* data, int body, const Vector3& at) {
    mjtNum out[3];
    mju_rotVecMat(out, at.data(), data->xmat + 9 * body);
    return Eigen::Map<const Vector3>(data->xpos + 3 * body) + Eigen::Map<const Vector3>(out);
  }
  static Vector3 inLink(const mjData* data, int body, const Vector3& P) {
    const Vector3 r = P - Eigen::Map<const Vector3>(data->xpos + 3 * body);
    Vector3 out;
    mju_rotVecMatT(out.data(), r.data(), data->xmat + 9 * body);
    return out;
  }
  static Matrix3 axes(const mjData* data, const End& end) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data->xmat +
                                                                          9 * end.body) *
           end.R;
  }

  /// A rolling disc: from its centre to where it touches, and how that moves on link a.
  struct Touching {
    /// @param n  the plane's normal;  z  the disc's axis, turning by w on a;  h  its height
    Touching(const Vector3& n, const Vector3& z, const Vector3& z_rate, double h, double h_rate,
             double radius)
        : rho(-(n - n.dot(z) * z) * (radius * radius / h)),
          rho_rate((n.dot(z_rate) * z + n.dot(z) * z_rate) * (radius * radius / h) -
                   rho * (h_rate / h)) {}
    Vector3 rho, rho_rate;
  };

  Vector3 meetingPoint(std::size_t i, const mjData* data) const {
    const End &a = ends_[i].a, &b = ends_[i].b;
    const Vector3 at_b = inWorld(data, b.body, b.at);
    if (closures_[i].kind != scene::ClosureKind::kRolling) return at_b;
    const Vector3 n = axes(data, a).col(2), z = axes(data, b).col(2);
    const double h = n.dot(at_b - inWorld(data, a.body, a.at));
    return at_b + Touching(n, z, Vector3::Zero(), h, 0, lengths_[i]).rho;
  }

  /// What MuJoCo made of one of its constraints; zero where no joint moves it.
  static Rows rowsOf(int id, int count, const mjModel* model, const mjData* data) {
    Rows out = Rows::Zero(count, model->nv);
    for (int i = 0, k = 0; i < data->ne && k < count; ++i)
      if (data->efc_type[i] == mjCNSTR_EQUALITY && data->efc_id[i] == id)
        out.row(k++) = Eigen::Map<const Eigen::RowVectorXd>(
            data->efc_J + static_cast<std::ptrdiff_t>(i) * model->nv, model->nv);
    return out;
  }

  void addClosure(std::size_t i, const mjModel* model, const mjData* data, int row,
                  Equations& out) const {
    using Kind = scene::ClosureKind;
    const Kind kind = closures_[i].kind;
    const End &end_a = ends_[i].a, &end_b = ends_[i].b;
    const Moving a(model, data, end_a.body), b(model, data, end_b.body);
    const Vector3 at_a = inWorld(data, end_a.body, end_a.at),
                  at_b = inWorld(data, end_b.body, end_b.at);
    if (kind == Kind::kDistance) {  // (d . d - length^2) / 2, a tendon's length is |d|
      const Vector3 u = b.velocity(at_b) - a.velocity(at_a);
      out.J.row(row) = data->ten_length[tendon_ids_[i]] * rowsOf(ids_[i], 1, model, data).row(0);
      out.gamma(row) =
          (at_b - at_a).dot(b.acceleration(at_b) - a.acceleration(at_a)) + u.squaredNorm();
      return;
    }
    const bool is_weld = kind == Kind::kHinge || kind == Kind::kWeld;
    const Rows told = rowsOf(ids_[i], is_weld ? 6 : 3, model, data);
    const Matrix3 R_a = axes(data, end_a), R_b = axes(data, end_b);
    const Vector3 w = b.w - a.w;
    Vector3 P = at_b, moved = Vector3::Zero();  // by which P leaves the point of b
    if (kind == Kind::kRolling) {
      const Vector3 n = R_a.col(2), z = R_b.col(2);
      const Touching touch(n, z, w.cross(z), n.dot(at_b - at_a),
                           n.dot(b.velocity(at_b) - a.velocity(at_b)), lengths_[i]);
      P += touch.rho;
      moved = touch.rho_rate - w.cross(touch.rho);
    }
    const Vector3 u = b.velocity(P) - a.velocity(P),
                  u_rate =
                      b.acceleration(P) - a.acceleration(P) - 2 * a.w.cross(u) + w.cross(moved);
    const auto add = [&](const Vector3& n, const Vector3& n_rate) {
      out.J.row(row) = -n.transpose() * told.topRows(3);  // MuJoCo's: of a less b
      out.gamma(row++) = n.dot(u_rate) + n_rate.dot(u);
    };
    const Vector3 fixed = Vector3::Zero();
    if (kind == Kind::kSkate) return add(R_b.col(1), w.cross(R_b.col(1)));
    if (kind != Kind::kPlane)
      for (const int k : {0, 1}) add(R_a.col(k), fixed);
    if (kind != Kind::kPlanarPoint) add(R_a.col(2), fixed);
    if (!is_weld) return;
    // rate of x_a . z_b:  w_ba . (z_b x x_a);  MuJoCo's rows are R_b' (w_a - w_b) / 2 of the links
    const Rows turning = -2 * b.R * told.bottomRows(3);
    const Vector3 turn_rate = b.w_rate - a.w_rate - a.w.cross(w);
    const auto addTurn = [&](const Vector3& of_b, const Vector3& of_a) {
      const Vector3 n = of_b.cross(of_a);
      out.J.row(row) = n.transpose() * turning;
      out.gamma(row++) = n.dot(turn_rate) + w.cross(of_b).cross(of_a).dot(w);
    };
    addTurn(R_b.col(2), R_a.col(0));
    addTurn(R_b.col(2), R_a.col(1));
    if (kind == Kind::kWeld) addTurn(R_b.col(1), R_a.col(0));
  }

  std::vector<scene::Closure> closures_;
  std::vector<scene::Follower> followers_;
  std::vector<Ends> ends_;       ///< one a closure
  std::vector<double> lengths_;  ///< the same
  std::vector<PointSpring> springs_;
  std::vector<std::string> sites_;  ///< one a link
  std::string tendons_, equalities_;
  std::vector<int> ids_, tendon_ids_, follower_ids_;
};

}  // namespace dynwitness::crosscheck
