// SPDX-License-Identifier: GPL-3.0-or-later
// ROS' kdl_parser as a reader of robot descriptions: KDL::Tree of the user's bytes, no option set.
// A tree knows neither limits nor friction nor who follows whom. It is a program of its own since
// its library brings ROS, Python and ICU along, which would be loaded at every start of dynwitness.
#include <map>
#include <memory>

#include <kdl/tree.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "crosscheck/readers/programs/shown.hpp"
#include "data/engines/dynwitness_engine.hpp"

namespace {

using namespace dynwitness_engine;
using dynwitness::programs::shown;
using nlohmann::json;

constexpr double kGravity = -9.81;

Eigen::Vector3d vector(const KDL::Vector& v) {
  return {v.x(), v.y(), v.z()};
}
Eigen::Isometry3d frame(const KDL::Frame& f) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) X(i, j) = f.M(i, j);
  X.translation() = vector(f.p);
  return X;
}

/// KDL refers inertia to the frame of the segment, in its axes.
json linkOf(const KDL::Segment& segment, int parent) {
  const KDL::RigidBodyInertia& I = segment.getInertia();
  const double m = I.getMass();
  const Eigen::Vector3d c = vector(I.getCOG());
  Eigen::Matrix3d about_com;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) about_com(i, j) = I.getRotationalInertia().data[3 * i + j];
  about_com -= m * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  json link = {{"name", segment.getName()},
               {"parent", parent},
               {"mass", m},
               {"com", shown(c)},
               {"inertia", shown(about_com)}};
  const KDL::Joint& joint = segment.getJoint();
  const KDL::Joint::JointType type = joint.getType();
  const bool turns = type == KDL::Joint::RotAxis || type == KDL::Joint::RotX ||
                     type == KDL::Joint::RotY || type == KDL::Joint::RotZ;
  const bool slides = type == KDL::Joint::TransAxis || type == KDL::Joint::TransX ||
                      type == KDL::Joint::TransY || type == KDL::Joint::TransZ;
  const Eigen::Isometry3d X = frame(segment.pose(0));
  json said = {{"name", joint.getName()}, {"kind", "fixed"}, {"before", shown(X)}};
  if (turns || slides) {
    said["kind"] = turns ? "revolute" : "prismatic";
    said["axis"] = shown(Eigen::Vector3d(X.linear().transpose() * vector(joint.JointAxis())));
  }
  link["joint"] = said;
  return link;
}

/// A tree, and where its joints are in what is shown.
struct Read {
  KDL::Tree tree;
  std::vector<unsigned> places;  ///< in KDL's order, one a moving joint that is shown
  json links = json::array();

  void add(const KDL::SegmentMap::const_iterator& at, int parent) {
    const KDL::TreeElement& element = at->second;
    const int here = static_cast<int>(links.size());
    if (parent < 0) {
      links.push_back({{"name", element.segment.getName()},
                       {"parent", -1},
                       {"mass", 0},
                       {"com", {0, 0, 0}},
                       {"inertia", shown(Eigen::Matrix3d(Eigen::Matrix3d::Zero()))}});
    } else {
      links.push_back(linkOf(element.segment, parent));
      if (element.segment.getJoint().getType() != KDL::Joint::None) places.push_back(element.q_nr);
    }
    for (const auto& child : element.children) add(child, here);
  }

  /// tau, in the order that is shown.
  Vector torques(const Vector& q, const Vector& qdd) {
    KDL::TreeIdSolver_RNE solver(tree, KDL::Vector(0, 0, kGravity));
    const unsigned n = tree.getNrOfJoints();
    KDL::JntArray positions(n), rates(n), accelerations(n), tau(n);
    for (std::size_t i = 0; i < places.size(); ++i) {
      positions(places[i]) = q.at(i);
      accelerations(places[i]) = qdd.empty() ? 0 : qdd.at(i);
    }
    if (solver.CartToJnt(positions, rates, accelerations, KDL::WrenchMap(), tau) < 0)
      throw std::runtime_error("TreeIdSolver_RNE refuses");
    Vector out;
    for (const unsigned place : places) out.push_back(tau(place));
    return out;
  }
};

}  // namespace

int main() {
  Engine engine("kdl_parser", KDL_PARSER_VERSION);
  auto read = std::make_shared<Read>();
  engine.scene = [&](const Json& scene) {
    if (!kdl_parser::treeFromString(dynwitness::programs::textOf(scene["file"].text()), read->tree))
      throw std::runtime_error("treeFromString says no");
    read->add(read->tree.getRootSegment(), -1);
    engine.shows =
        json({{"gravity", {0, 0, kGravity}},
              {"links", read->links},
              {"told",
               {"a KDL::Tree keeps no limits and no friction, and has no gravity of its own"}},
              {"not_kept", {"limits", "damping", "friction"}}})
            .dump();
  };
  engine.vector("g", [read](const State& s) { return read->torques(s.q, {}); });
  engine.matrix("M", [read](const State& s) {
    const std::size_t n = s.q.size();
    const Vector g = read->torques(s.q, {});
    Matrix M(n, Vector(n));
    for (std::size_t j = 0; j < n; ++j) {
      Vector qdd(n, 0.0);
      qdd[j] = 1;
      const Vector tau = read->torques(s.q, qdd);
      for (std::size_t i = 0; i < n; ++i) M[i][j] = tau[i] - g[i];
    }
    return M;
  });
  return engine.testify();
}
