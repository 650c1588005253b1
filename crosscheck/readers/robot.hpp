// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader has made of a robot description, in one form for all readers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/** Mass, first moment and rotational inertia of a rigid body about the origin of a frame, in its
    axes. Sums are bodies that are fixed to each other. */
struct MassMoments {
  double mass = 0;                                   ///< [kg]
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   ///< m c [kg m]
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< about the origin [kg m^2]
  double reach2 = 0;  ///< sum of tr(I) + m c^2 of all that was added: what rounding is relative to

  static MassMoments of(double mass, const Eigen::Vector3d& com, const Eigen::Matrix3d& about_com);
  MassMoments& operator+=(const MassMoments& other);
  /// Seen from the frame that X leads to: x' = X x.
  MassMoments movedBy(const Eigen::Isometry3d& X) const;
  Eigen::Vector3d com() const;  ///< zero without mass
  Eigen::Matrix3d aboutCom() const;
};

/** A moving joint and the body that it carries: its link with all that is fixed to it. The body's
    frame is the joint's after the motion, so that at q = 0 both are the same. */
struct ReadBody {
  std::string link, joint;
  int parent = -1;  ///< -1: what rests in the world
  scene::JointKind kind = scene::JointKind::kRevolute;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< x_parent = placement x_joint
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();              ///< as the reader keeps it
  MassMoments moments;
  int links = 1;                       ///< how many make it
  std::optional<double> lower, upper;  ///< none: unlimited
  double damping = 0, friction = 0, armature = 0, stiffness = 0;
  double rest = 0;     ///< where its spring is at rest [rad], [m]; without a spring it says nothing
  std::string leader;  ///< the joint that this one follows; empty: none
  double multiplier = 1, offset = 0;
};

struct Robot {
  Eigen::Vector3d gravity = {0, 0, 0};  ///< [m/s^2]
  std::vector<ReadBody> bodies;         ///< parents before children
  /// How far the reader's own principal axes may be from the body's [rad]: it keeps moments and
  /// axes, and stops turning before they are found.
  double unturned = 0;

  int indexOf(const std::string& link) const;  ///< -1: none
  /// At q = 0, in the world's axes.
  std::vector<Eigen::Isometry3d> placements() const;
  std::vector<int> depths() const;  ///< how many joints there are between a body and the world
};

/// Roundings of one frame on a generous count: rpy to a quaternion (6 sines and cosines, 16
/// products and sums), made of length 1 (12), to a matrix (30), that by another (45), a vector
/// turned and added (18); twice, since two readings are compared.
inline constexpr double kRoundingsOfFrame = 256;
/// What that many frames in a row, and one number more, may be off, relative.
double roundingOf(int frames);

/// Whether a joint is revolute or prismatic.
bool hasOnePosition(const ReadBody& body);
bool allHaveOnePosition(const Robot& robot);

/// c.c 1 - c c'
Eigen::Matrix3d lever(const Eigen::Vector3d& c);

struct MassAndGravity {
  Eigen::MatrixXd M;  ///< n x n
  Eigen::VectorXd g;
  /// How far another program that computes the same in double may be.
  Eigen::MatrixXd M_bound;
  Eigen::VectorXd g_bound;
};

/** M and g of a robot whose joints have one position each, by Jacobians in the world's axes:

        M = sum over bodies of  m Jv' Jv + Jw' I Jw + armature,    g = -sum of m Jv' gravity

    A third way beside the sweeps and the derivation, of one page.
    @param q  one a body; of a joint with several degrees of freedom it is not used: that is held */
MassAndGravity massAndGravity(const Robot& robot, const std::vector<double>& q);

/// Seeded positions, one a body: angles in [-pi, pi), slides in [-1, 1) m.
std::vector<double> drawPositions(const Robot& robot, std::uint64_t seed, std::uint64_t index);

}  // namespace dynwitness::crosscheck
