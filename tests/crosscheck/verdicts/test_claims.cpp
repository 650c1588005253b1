// SPDX-License-Identifier: GPL-3.0-or-later
// What a program says besides quantities: its links against the scene's, and how a point moves,
// against the virtual work of a force there.
#include "crosscheck/verdicts/claims.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "scene/numbers.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
using Eigen::Matrix3d;
using Eigen::Vector3d;
namespace data = boost::unit_test::data;

namespace {

scene::Mechanism mechanismOf(const std::string& name) {
  return scene::findScene(name).mechanism;
}

/// The scene's own, as a program tells them that took them as they came.
std::vector<BelievedLink> asTold(const scene::Mechanism& mechanism) {
  const ToldNumbers number(mechanism);
  std::vector<BelievedLink> out;
  for (std::size_t i = 1; i < mechanism.links.size(); ++i) {
    const ToldNumbers::Inertia told = number.inertia(mechanism.links[i].inertia);
    out.push_back({static_cast<int>(i), static_cast<double>(told.mass), told.com.cast<double>(),
                   told.I.cast<double>()});
  }
  return out;
}
std::vector<ModelDifference> differences(const scene::Mechanism& mechanism,
                                         const std::vector<BelievedLink>& links,
                                         double factor = 1) {
  return compareModel(mechanism, links, factor).differences;
}

Matrix3d pointMass(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

/// The link and the child that a fixed joint holds on it, as one body: by moments about its origin.
BelievedLink merged(const scene::Mechanism& mechanism, const BelievedLink& link,
                    const BelievedLink& child) {
  const ToldNumbers number(mechanism);
  const scene::Placement& placement =
      mechanism.links[static_cast<std::size_t>(child.link)].joint.placement;
  const ToldNumbers::Frame X =
      number.frame(placement.beforeJoint()) * number.frame(placement.afterJoint());
  const Matrix3d R = X.R.cast<double>();
  const Vector3d c = X.p.cast<double>() + R * child.com;
  BelievedLink out = link;
  out.mass = link.mass + child.mass;
  out.com = (link.mass * link.com + child.mass * c) / out.mass;
  out.inertia = link.inertia + pointMass(link.mass, link.com) + R * child.inertia * R.transpose() +
                pointMass(child.mass, c) - pointMass(out.mass, out.com);
  return out;
}

/// A child on a fixed joint, and its carrier; by index in asTold().
struct Pair {
  std::size_t child, carrier;
};
Pair fixedPair(const scene::Mechanism& mechanism) {
  for (std::size_t i = 1; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    if (link.joint.kind == scene::JointKind::kFixed && link.parent > 0)
      return {i - 1, static_cast<std::size_t>(link.parent) - 1};
  }
  BOOST_FAIL("no fixed joint on a link that moves");
  return {};
}

}  // namespace

BOOST_DATA_TEST_CASE(the_links_of_the_scene_are_no_difference,
                     data::make({"puma_560", "franka_panda", "kuka_iiwa_14", "humanoid_floating",
                                 "prismatic_revolute_mix", "satellite_arm"}),
                     name) {
  const scene::Mechanism mechanism = mechanismOf(name);
  std::vector<BelievedLink> links = asTold(mechanism);
  BOOST_TEST(differences(mechanism, links).empty());
  // kept about the link's origin in single steps, and given back
  for (BelievedLink& link : links) {
    const Vector3d h = link.mass * link.com;
    const Matrix3d about_origin = link.inertia + pointMass(link.mass, link.com);
    if (link.mass != 0) link.com = h / link.mass;
    link.inertia = about_origin - pointMass(link.mass, link.com);
  }
  const std::vector<ModelDifference> found = differences(mechanism, links);
  BOOST_TEST(found.empty(), (found.empty() ? "" : sentenceOf(found.front())));
}

struct Changed {
  std::string parameter;
  std::function<void(BelievedLink&)> change;
};
std::ostream& operator<<(std::ostream& out, const Changed& changed) {
  return out << changed.parameter;
}
const std::vector<Changed> kChanged = {
    {"mass", [](BelievedLink& l) { l.mass *= 1 + 1e-12; }},
    {"com y", [](BelievedLink& l) { l.com(1) += 1e-12; }},
    {"Ixx", [](BelievedLink& l) { l.inertia(0, 0) *= 1 + 1e-11; }},
    {"Ixz", [](BelievedLink& l) { l.inertia(0, 2) = l.inertia(2, 0) = l.inertia(0, 2) + 1e-12; }},
};

BOOST_DATA_TEST_CASE(one_number_that_differs_is_named_with_both_values, data::make(kChanged),
                     changed) {
  const scene::Mechanism mechanism = mechanismOf("franka_panda");
  std::vector<BelievedLink> links = asTold(mechanism);
  changed.change(links.at(3));
  const std::vector<ModelDifference> found = differences(mechanism, links);
  BOOST_TEST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found.front().parameter == changed.parameter);
  BOOST_TEST(found.front().link == mechanism.links.at(4).name);
  BOOST_TEST(found.front().said != found.front().scene);
  const std::string sentence = sentenceOf(found.front());
  BOOST_TEST(sentence.find("link '" + mechanism.links.at(4).name + "': " + changed.parameter) == 0u,
             sentence);
  // single precision keeps no such digit
  BOOST_TEST(differences(mechanism, links, 0x1p29).empty());
}

BOOST_AUTO_TEST_CASE(a_link_that_is_not_told_is_missing) {
  const scene::Mechanism mechanism = mechanismOf("franka_panda");
  std::vector<BelievedLink> links = asTold(mechanism);
  links.erase(links.begin() + 2);
  const std::vector<ModelDifference> found = differences(mechanism, links);
  BOOST_TEST_REQUIRE(found.size() == 1u);
  BOOST_TEST(found.front().link == mechanism.links.at(3).name);
  BOOST_TEST(sentenceOf(found.front()).find("is missing in its model") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(links_on_fixed_joints_may_be_one_body_in_any_way) {
  const scene::Mechanism mechanism = mechanismOf("prismatic_revolute_mix");
  const std::vector<BelievedLink> links = asTold(mechanism);
  const auto [child, carrier] = fixedPair(mechanism);
  std::vector<BelievedLink> whole = links;
  whole[carrier] = merged(mechanism, links[carrier], links[child]);

  std::vector<BelievedLink> left_out = whole;
  left_out.erase(left_out.begin() + static_cast<std::ptrdiff_t>(child));
  const ModelFound found = compareModel(mechanism, left_out, 1);
  BOOST_TEST(found.differences.empty(),
             (found.differences.empty() ? "" : sentenceOf(found.differences.front())));
  BOOST_TEST(found.merged.size() == 1u);

  whole[child].mass = 0;  // still told, and weightless
  whole[child].inertia.setZero();
  BOOST_TEST(differences(mechanism, whole).empty());

  // but the child has to be somewhere
  std::vector<BelievedLink> lost = links;
  lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(child));
  BOOST_TEST(!differences(mechanism, lost).empty());
  left_out[carrier < child ? carrier : carrier - 1].mass *= 1 + 1e-12;
  BOOST_TEST(differences(mechanism, left_out).size() == 1u);
}

// J' (F, N) is the joint forces that hold a wrench at that point: tau = -J' (F, N) at rest, without
// weights and springs, which the sweep of forces says
BOOST_DATA_TEST_CASE(the_jacobian_is_the_virtual_work_of_a_wrench,
                     data::make({"simple_pendulum", "puma_560", "kuka_iiwa_14", "stanford_arm",
                                 "humanoid_floating", "satellite_arm", "lead_screw",
                                 "prismatic_revolute_mix"}),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const FramePoint point = farthestPoint(scene.mechanism);
  FrameJacobian jacobian(scene);
  for (int index = 0; index < 3; ++index) {
    scene::State<double> state =
        drawState(scene.mechanism, scene.name, 7, static_cast<std::uint64_t>(index));
    const BoundedJacobian J = jacobian(point, state);
    for (auto* part : {&state.qd, &state.qdd}) part->assign(part->size(), 0.0);
    for (int k = 0; k < 6; ++k) {
      scene::Mechanism loaded = scene.mechanism;
      loaded.has_gravity = false;
      loaded.wrenches.clear();
      for (scene::Link& link : loaded.links) link.joint.stiffness = scene::Number(0);
      scene::Wrench wrench;
      wrench.link = point.link;
      wrench.axes = scene::Wrench::Axes::kWorld;
      for (int i = 0; i < 3; ++i)
        wrench.at[static_cast<std::size_t>(i)] = scene::Number::parse(std::to_string(point.at(i)));
      (k < 3 ? wrench.force : wrench.moment)[static_cast<std::size_t>(k % 3)] = scene::Number(1);
      loaded.wrenches.push_back(wrench);
      Setup<double> setup(loaded, scene::RealNumbers<double>(loaded));
      EngineBound bound(loaded);
      const Eigen::MatrixXd tau = NewtonEuler::answer(setup, Quantity::kTau, state);
      const Eigen::MatrixXd off = (J.value.row(k).transpose() + tau).cwiseAbs();
      const Eigen::MatrixXd limit = J.bound.row(k).transpose() + bound(Quantity::kTau, state);
      BOOST_TEST((off.array() <= limit.array()).all(), name << " row " << k);
    }
    // a limit that what is seen is far below would be none
    constexpr double kEps = 0x1p-52, kWide = 1e4;
    BOOST_TEST((J.bound + J.engine).maxCoeff() <= kWide * kEps * J.value.cwiseAbs().maxCoeff());
  }
}

BOOST_AUTO_TEST_CASE(other_readings_of_a_jacobian_are_others) {
  const scene::Scene scene = scene::findScene("puma_560");
  FrameJacobian jacobian(scene);
  const FramePoint point = farthestPoint(scene.mechanism);
  const scene::State<double> state = drawState(scene.mechanism, scene.name, 7, 0);
  const BoundedJacobian J = jacobian(point, state);
  const std::vector<JacobianReading> readings = otherReadings(J);
  BOOST_TEST(readings.size() == 23u);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    BOOST_TEST((readings[i].value - J.value).cwiseAbs().maxCoeff() > 1e-3, readings[i].words);
    for (std::size_t k = 0; k < i; ++k)
      BOOST_TEST((readings[i].value - readings[k].value).cwiseAbs().maxCoeff() > 1e-3,
                 readings[i].words << " and " << readings[k].words);
  }
  // of the link's origin: asked about it
  const BoundedJacobian origin = jacobian({point.link, Vector3d::Zero()}, state);
  const auto named = [&](const std::string& words) {
    for (const JacobianReading& reading : readings)
      if (reading.words == words) return reading.value;
    return Eigen::MatrixXd(Eigen::MatrixXd::Zero(6, 6));
  };
  BOOST_TEST(
      (named("of the link's origin in place of the point") - origin.value).cwiseAbs().maxCoeff() <=
      1e-14);
}
