// SPDX-License-Identifier: GPL-3.0-or-later
// A mechanism as a picture that moves: one HTML file that needs no network, and a drawing in it for
// print and for readers without scripts.
//
// It reads the scene's placements for itself and shares no formula with the sweeps: what it shows
// is held to theirs by a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/scene.hpp"
#include "scene/urdf.hpp"

namespace dynwitness::crosscheck {

/// A rigid body's mass on a link, as written or as somebody has read it.
struct ViewBody {
  int link = 0;
  std::string who;                                ///< which engine reads it so; empty: as written
  double mass = 0;                                ///< [kg]
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  ///< [m], link frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about com, link axes [kg m^2]
};

/** The ellipsoid of uniform density with a body's mass and inertia. With I_k the principal moments,

        I_k = m (a_i^2 + a_j^2) / 5,    a_k^2 = 5 (I_i + I_j - I_k) / (2 m)

    @param halves  half axes a_k [m]; what is below zero is 0
    @param axes    columns: the principal axes, right-handed
    @return whether a body with this inertia is possible, but for rounding */
bool ellipsoidOf(const ViewBody& body, Eigen::Vector3d* halves, Eigen::Matrix3d* axes);

/// A link, and the joint that carries it. The joint moves about and along z of its frame.
struct ViewLink {
  std::string name, joint;
  int parent = -1;
  scene::JointKind kind = scene::JointKind::kFixed;
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();  ///< x_parent = before x_joint
  Eigen::Isometry3d after = Eigen::Isometry3d::Identity();   ///< x_moved_joint = after x_link
  double pitch = 0;                                          ///< of a helical joint [m/rad]
  int slot = 0;       ///< its first position, followers' counted too
  std::string label;  ///< "q3", "q1..q7", "= -1 q2" of a follower
  // of a follower: q = multiplier q(leader_slot) + offset; -1: it follows nobody
  int leader_slot = -1;
  double multiplier = 1, offset = 0;
};

/// A position, and how far a slider moves it.
struct ViewSlot {
  std::string name;   ///< "q3", numbered as in a states file; empty: of a follower
  std::string label;  ///< the joint's name, and which of its positions
  scene::SlotKind kind = scene::SlotKind::kAngle;
  double start = 0, rest = 0, lower = 0, upper = 0;  ///< [rad], [m]
  bool is_limited = false;                           ///< lower and upper are the joint's limits
  int quaternion = -1;                               ///< the first slot of the one that it is in
};

/// Two frames that something holds or pulls together: a closure, or a spring.
struct ViewPair {
  std::string name, kind;
  bool is_rod = false;  ///< a distance is held
  int link_a = 0, link_b = 0;
  Eigen::Isometry3d a = Eigen::Isometry3d::Identity(), b = Eigen::Isometry3d::Identity();
  double length = 0;  ///< of a distance [m]
};

/// States along a motion.
struct ViewMotion {
  struct Energy {
    std::string name;
    std::vector<double> joules;  ///< one a time
  };
  std::vector<double> times;           ///< [s]
  std::vector<std::vector<double>> q;  ///< all positions, one row a time
  std::vector<Energy> energies;        ///< none or more curves
};

/// Beyond this many links names lie on each other, and numbers and drawing are as fine as a screen
/// shows: 7 digits, and what lies in front of what by kinds of lines.
inline constexpr std::size_t kMostLinksInFull = 60;

struct View {
  std::string name, title;
  std::vector<ViewLink> links;
  std::vector<ViewSlot> slots;
  std::vector<ViewBody> bodies;  ///< those of the scene; a reader's may be added
  std::vector<ViewPair> closures, springs;
  std::optional<ViewMotion> motion;
  bool has_gravity = false;
  // where it is seen from at first
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), ahead = Eigen::Vector3d::UnitX();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  double radius = 1, glyph = 0.1;                    ///< [m], of all; of an axis
  double azimuth = 0, elevation = 0;                 ///< [rad], from `ahead`, about `up`
};

/** The scene at its start.
    @param parts  of a URDF, one a link: its limits; or none */
View viewOf(const scene::Scene& scene, const std::vector<scene::UrdfPart>& parts = {});

/// Frames in the world, one a link: of the joint before its motion and after it, and of the link.
struct ViewPlaces {
  std::vector<Eigen::Isometry3d> before, moved, link;
};
/// @param q  one a slot; those of followers are not read
ViewPlaces placesOf(const View& view, const std::vector<double>& q);

/// What the page's script reads: no '<' in it, so that it may stand in a <script>. Links, slots
/// and bodies are tables; each frame is there once, and called by its number.
std::string viewJson(const View& view);

/// The content of the page's <svg> without scripts: the start, in a box of 640 x 480 about 0.
std::string viewSvg(const View& view);

/** The whole page.
    @param summary  HTML: a few words below the title
    @param facts    HTML: sections below the picture */
std::string viewPage(const View& view, const std::string& version, const std::string& summary,
                     const std::string& facts);

}  // namespace dynwitness::crosscheck
