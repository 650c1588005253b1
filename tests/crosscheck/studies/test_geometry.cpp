// SPDX-License-Identifier: GPL-3.0-or-later
// The kinetic metric: its laws over the field, closed forms by other roads, and what it refuses.
#include "crosscheck/studies/geometry.hpp"

#include <ostream>
#include <string>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "recursive/build_model.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"
#include "tests/fixtures/treated_scenes.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Q;

namespace {

constexpr int kSeeds = 5;
using D = Dual<Q>;
using DD = Dual<D>;
using VectorQ = recursive::VectorX<Q>;

/// With a base, and no gravity.
scene::Scene readScene(const std::string& links) {
  return scene::readSceneToml("title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n" + links,
                              "x.toml");
}

/// Links in the x-y plane that turn about z; joint k at (offset, 0) of its parent, point masses.
scene::Mechanism planarArm(const Q& offset, const std::vector<fixtures::V3<Q>>& first,
                           const std::vector<fixtures::V3<Q>>& second, const Q& mass) {
  scene::Mechanism m;
  m.links.emplace_back();
  for (const auto* cloud : {&first, &second}) {
    scene::Link link;
    link.parent = static_cast<int>(m.links.size()) - 1;
    link.joint.kind = scene::JointKind::kRevolute;
    if (link.parent > 0) link.joint.placement.xyz[0] = fixtures::numberOf(offset);
    Q xx, yy, zz, xy;
    fixtures::V3<Q> h = fixtures::V3<Q>::Constant(Q(0));
    for (const auto& r : *cloud) {
      h += r * mass;
      xx += mass * r.y() * r.y();
      yy += mass * r.x() * r.x();
      xy -= mass * r.x() * r.y();
    }
    const Q total = mass * Q(static_cast<int>(cloud->size()));
    link.inertia.mass = fixtures::numberOf(total);
    link.inertia.com = fixtures::vectorOf(fixtures::V3<Q>(h / total));
    link.inertia.about = scene::MassProperties::About::kLinkOrigin;
    link.inertia.xx = fixtures::numberOf(xx);
    link.inertia.yy = fixtures::numberOf(yy);
    link.inertia.zz = fixtures::numberOf(xx + yy);
    link.inertia.xy = fixtures::numberOf(xy);
    m.links.push_back(link);
  }
  return m;
}

Q determinant(const Q (&m)[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/** Gauss's curvature of E du^2 + 2 F du dv + G dv^2 by Brioschi's formula, which knows no
   Christoffel symbols, where E, F, G depend on v alone: K (E G - F^2)^2 = | -E_vv/2  0  -E_v/2 | |
   0      E_v/2  0     | | F_v      E   F     | - | E_v/2  E      F     | | G_v/2    F   G     |   |
   0      F      G     |                      */
Q brioschi(const DD& E, const DD& F, const DD& G) {
  const Q e = E.value.value, f = F.value.value, g = G.value.value;
  const Q E_v = E.value.derivative, F_v = F.value.derivative, G_v = G.value.derivative,
          E_vv = E.derivative.derivative;
  const Q first[3][3] = {{-E_vv / 2, 0, -E_v / 2}, {F_v, e, f}, {G_v / 2, f, g}};
  const Q second[3][3] = {{0, E_v / 2, 0}, {E_v / 2, e, f}, {0, f, g}};
  const Q area = e * g - f * f;
  return (determinant(first) - determinant(second)) / (area * area);
}

}  // namespace

BOOST_DATA_TEST_CASE(the_laws_hold_in_every_scene_that_has_a_metric,
                     data::make(fixtures::scenesTreatedBy(Command::kGeometry)), name) {
  const scene::Scene scene = scene::findScene(name);
  const bool is_tree = scene.mechanism.closures.empty();
  const auto checks = checkGeometryExactly(scene, {});
  BOOST_TEST(checks.size() == (is_tree ? 6u : 4u));
  std::size_t decided = 0;
  for (const CheckResult& check : checks) {
    BOOST_TEST((check.verdict != Verdict::kDisagree), check.name() << ": " << check.reason);
    decided += check.verdict == Verdict::kAgree ? 1 : 0;
  }
  if (scene.mechanism.dof() > 9) return;
  const Surface surface = surfaceNear(scene, inDouble(scene, scene.start_q));
  BOOST_TEST(decided == (surface.has_dependent_rows ? 0u : checks.size()));
}

BOOST_AUTO_TEST_CASE(the_laws_hold_for_every_robot_of_a_structure) {
  ExactOptions options;
  options.parameters = Parameters::kRandom;
  for (const char* name : {"double_pendulum", "scara", "furuta_pendulum", "lead_screw", "heavy_top",
                           "satellite_arm", "loop_on_arm"})
    for (const CheckResult& check : checkGeometryExactly(scene::findScene(name), options))
      BOOST_TEST((check.verdict == Verdict::kAgree), name << " " << check.name());
}

// A planar arm's metric from its textbook closed form, its curvature by Brioschi's determinants,
// and as one fraction:  K = b cos q2 (a e - e^2 - b^2) / (det M)^2, here with b cos q2 for any
// second cloud.
BOOST_DATA_TEST_CASE(the_curvature_of_a_planar_arm_is_its_closed_form, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  const Q l = sample.positive(), mass = sample.positive();
  std::vector<fixtures::V3<Q>> clouds[2];
  for (auto& cloud : clouds)
    for (int i = 0; i < 3; ++i) cloud.push_back({sample.rational(), sample.rational(), Q(0)});
  const scene::Mechanism arm = planarArm(l, clouds[0], clouds[1], mass);
  const auto model = recursive::buildModel(arm, fixtures::RationalNumbers(arm));
  const scene::State<Q> state = fixtures::randomState(2, seed);
  KineticMetric<Q> metric(model, state.x);

  // by hand: M = (a + 2 b, e + b; e + b, e) with b(q2) = l (h_x cos q2 - h_y sin q2)
  Q a = 0, e = 0, h_x = 0, h_y = 0;
  for (const auto& r : clouds[0]) a += mass * r.dot(r);
  for (const auto& r : clouds[1]) {
    e += mass * r.dot(r);
    h_x += mass * r.x();
    h_y += mass * r.y();
  }
  a += e + Q(3) * mass * l * l;
  const auto second = moving(moving(state.x[1], Q(1)), D(Q(1)));  // q2, d/dq2, d2/dq2^2
  const DD b = (DD(D(h_x)) * second.c - DD(D(h_y)) * second.s) * DD(D(l));
  const DD E = DD(D(a)) + b + b, F = DD(D(e)) + b, G = DD(D(e));
  BOOST_TEST(metric.M()(0, 0) == E.value.value);
  BOOST_TEST(metric.M()(0, 1) == F.value.value);
  const Q K = metric.sectional(metric.unit(0), metric.unit(1));
  BOOST_TEST(K == brioschi(E, F, G));
  // b'' = -b, b^2 + b'^2 = l^2 h^2
  const Q value = b.value.value, det = E.value.value * e - F.value.value * F.value.value;
  BOOST_TEST(K == value * (a * e - e * e - l * l * (h_x * h_x + h_y * h_y)) / (det * det));
}

// Two slides move on a plane, a slide that turns in polar coordinates on one too; a body that turns
// about two crossing axes with equal moments J moves on a sphere of radius 2 sqrt(J).
BOOST_AUTO_TEST_CASE(flat_is_flat) {
  const scene::Scene polar = scene::readSceneToml(R"(
title = "x"
source = "x"
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
joint = { kind = "revolute" }
[[link]]
name = "bead"
parent = "arm"
mass = 3
joint = { kind = "prismatic", axis = [1, 0, 0] }
)",
                                                  "polar.toml");
  for (const double r : {0.5, 2.0}) {
    const MetricAt at = metricAt(polar, {0.3, r});
    BOOST_TEST(std::abs(at.M.value(0, 0) - 3 * r * r) <= at.M.bound(0, 0));
    // by hand, polar coordinates: Gamma^r_tt = -r, Gamma^t_tr = 1/r
    BOOST_TEST(std::abs(at.second[1].value(0, 0) + r) <= at.second[1].bound(0, 0));
    BOOST_TEST(std::abs(at.second[0].value(0, 1) - 1 / r) <= at.second[0].bound(0, 1));
    BOOST_TEST(std::abs(at.sectional.value(0, 1)) <= at.sectional.bound(0, 1));
  }
}
// A point at distance r = 2 m, mass 3 kg, on crossing axes: a sphere, K = 1 / (m r^2).
BOOST_AUTO_TEST_CASE(a_spherical_pendulum_moves_on_a_sphere) {
  const scene::Scene sphere = scene::readSceneToml(R"(
title = "x"
source = "x"
[[link]]
name = "base"
[[link]]
name = "bob"
parent = "base"
mass = 3
com = [2, 0, 0]
[link.joint]
kind = "universal"
xyz = [0, 0, 0]
rpy = [0, "pi/2", 0]
)",
                                                   "sphere.toml");
  for (const double q : {0.4, 1.1, -0.7}) {
    const MetricAt at = metricAt(sphere, {0.3, q});
    BOOST_TEST(std::abs(at.sectional.value(0, 1) - 1.0 / 12) <=
               at.sectional.bound(0, 1) + 0x1p-57);  // 1/12 rounded
  }
}

// The bound of the printed numbers covers the exact ones: rationals of the same doubles.
BOOST_AUTO_TEST_CASE(bounds_are_not_empty) {
  const MetricAt at = metricAt(scene::findScene("puma_560"), {0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
  BOOST_TEST(at.sectional.value.rows() == 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      BOOST_TEST(std::isfinite(at.sectional.bound(i, j)));
      BOOST_TEST(at.sectional.value(i, j) == at.sectional.value(j, i));
      for (int k = 0; k < 6; ++k)  // dM_ij/dq_k = Gamma_i,jk + Gamma_j,ik, symmetric in j and k
        BOOST_TEST(at.first[i].value(j, k) == at.first[i].value(k, j));
    }
}

// A body on a spherical joint is the rotations with a left-invariant metric. Milnor, Curvatures of
// left invariant metrics on Lie groups, Advances in Mathematics 21 (1976), section 4: with
// [e2, e3] = lambda_1 e1 and so on of an orthonormal frame and mu_i = (lambda_1 + lambda_2 +
// lambda_3) / 2 - lambda_i,  Ricci(e1) = 2 mu_2 mu_3,  K(e1, e2) = lambda_3 mu_3 - mu_1 mu_2. Here
// lambda_i = I_i / sqrt(I_1 I_2 I_3).
BOOST_AUTO_TEST_CASE(a_body_on_a_spherical_joint_has_milnors_curvature) {
  const double I[] = {1, 2, 2.5}, product = I[0] * I[1] * I[2], half = (I[0] + I[1] + I[2]) / 2;
  const double m[] = {half - I[0], half - I[1], half - I[2]};
  const MetricAt at = metricAt(readScene(R"(
[[link]]
name = "body"
parent = "base"
mass = 1
inertia = { xx = 1, yy = 2, zz = 2.5 }
joint = { kind = "spherical" }
)"),
                               {0.5, 0.25, -1, 2});
  BOOST_TEST(!at.commutes);
  double ricci[] = {0, 0, 0};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const int k = 3 - i - j;
      const double K = (I[k] * m[k] - m[i] * m[j]) / product;
      BOOST_TEST(std::abs(at.sectional.value(i, j) - K) <= at.sectional.bound(i, j) + 0x1p-52);
      ricci[i] += at.sectional.value(i, j);
      // Euler's equations: <e_i, D_j e_k> antisymmetric in j and k is half of the commutator's
      const double torsion = at.first[i].value(j, k) - at.first[i].value(k, j);
      BOOST_TEST(std::abs(torsion) == I[i]);
    }
  for (int i = 0; i < 3; ++i)
    BOOST_TEST(std::abs(ricci[i] - 2 * m[(i + 1) % 3] * m[(i + 2) % 3] / product) <= 0x1p-50);
}

// Turning does not bend the space that a body's centre of mass moves in.
BOOST_AUTO_TEST_CASE(a_free_body_moves_in_flat_space_and_on_the_rotations) {
  const MetricAt at = metricAt(readScene(R"(
[[link]]
name = "body"
parent = "base"
mass = 3
inertia = { xx = 1, yy = 2, zz = 2.5 }
joint = { kind = "floating" }
)"),
                               {1, 2, 3, 0.5, 0.25, -1, 2});
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j)
      BOOST_TEST(std::abs(at.sectional.value(i, j)) <= at.sectional.bound(i, j));
  BOOST_TEST(std::abs(at.sectional.value(3, 4)) > 0.1);  // of the rotations: (2.5 m3 - m1 m2) / 5
}

// A point of 3 kg that slides anywhere but at 2 m from a point: a sphere, K = 1 / (m r^2), and a
// plane where it slides on one.
BOOST_AUTO_TEST_CASE(closures_leave_a_sphere_or_a_plane) {
  const std::string slides = R"(
[[link]]
name = "x"
parent = "base"
joint = { kind = "prismatic", axis = [1, 0, 0] }
[[link]]
name = "y"
parent = "x"
joint = { kind = "prismatic", axis = [0, 1, 0] }
[[link]]
name = "z"
parent = "y"
mass = 3
joint = { kind = "prismatic", axis = [0, 0, 1] }
)";
  const scene::Scene on_sphere = readScene(
      slides +
      "[[closure]]\nkind = \"distance\"\nlength = 3\na = { link = \"z\" }\nb = { link = \"base\" }\n");
  // 3 m: 1 + 4 + 4, and 4 + 4 + 1, closed to the last bit
  for (const std::vector<double>& q : {std::vector<double>{1, 2, 2}, {2, -2, 1}}) {
    const MetricAt at = metricAt(on_sphere, q);
    BOOST_REQUIRE(at.surface.rates.size() == 2u);
    BOOST_TEST(at.surface.q == q);
    BOOST_TEST(std::abs(at.sectional.value(0, 1) - 1.0 / 27) <=
               at.sectional.bound(0, 1) + 0x1p-57);  // 1/27 rounded
    BOOST_TEST(at.sectional.bound(0, 1) < 1e-10);
  }
  const MetricAt plane = metricAt(
      readScene(slides + "[[closure]]\nkind = \"plane\"\n"
                         "a = { link = \"base\", rpy = [0.3, 0.4, 0] }\nb = { link = \"z\" }\n"),
      {0, 0, 0});
  BOOST_REQUIRE(plane.surface.rates.size() == 2u);
  BOOST_TEST(std::abs(plane.sectional.value(0, 1)) <= plane.sectional.bound(0, 1));
}

// The same double pendulum as a tree and with its elbow closed: Gauss's curvature knows no
// coordinates. At q1 = 0 the elbow is at 0.5 m, a double.
BOOST_DATA_TEST_CASE(a_closed_elbow_bends_as_one_of_a_tree, data::make({0.3, 1.2, -2.0}), q_2) {
  const std::string upper = R"(
[[link]]
name = "upper"
parent = "base"
mass = 1
com = [0.25, 0.1, 0]
inertia = { xx = 0.01, yy = 0.01, zz = 0.02 }
joint = { kind = "revolute" }
[[link]]
name = "lower"
mass = 2
com = [0.3, -0.05, 0]
inertia = { xx = 0.01, yy = 0.02, zz = 0.03 }
)";
  const MetricAt tree = metricAt(
      readScene(upper + "parent = \"upper\"\njoint = { kind = \"revolute\", xyz = [0.5, 0, 0] }\n"),
      {0, q_2});
  const MetricAt closed = metricAt(
      readScene(upper + "parent = \"base\"\njoint = { kind = \"planar\" }\n"
                        "[[closure]]\nkind = \"planar_point\"\n"
                        "a = { link = \"upper\", xyz = [0.5, 0, 0] }\nb = { link = \"lower\" }\n"),
      {0, 0.5, 0, q_2});
  BOOST_REQUIRE(closed.surface.rates.size() == 2u);
  const double K = tree.sectional.value(0, 1);
  BOOST_TEST(std::abs(K) > 0.01);
  BOOST_TEST(std::abs(closed.sectional.value(0, 1) - K) <=
             closed.sectional.bound(0, 1) + tree.sectional.bound(0, 1));
  BOOST_TEST(closed.sectional.bound(0, 1) < 1e-9 * std::abs(K));
}

// One freedom is a curve; of what nothing moves there is no metric.
BOOST_AUTO_TEST_CASE(a_mechanism_of_one_freedom_is_flat) {
  for (const char* name : {"andrews_squeezer", "bricard"}) {
    const scene::Scene scene = scene::findScene(name);
    const MetricAt at = metricAt(scene, inDouble(scene, scene.start_q));
    BOOST_TEST(at.surface.rates.size() == 1u, name);
    BOOST_TEST(at.M.value(0, 0) > 0);
    BOOST_TEST(at.sectional.value(0, 0) == 0);
  }
}

BOOST_AUTO_TEST_CASE(what_has_no_metric_is_refused) {
  for (const char* name : {"rolling_coin", "chaplygin_sleigh", "flyball_governor", "two_handed"})
    BOOST_CHECK_THROW(metricAt(scene::findScene(name), {}), scene::InputError);
  BOOST_CHECK_THROW(metricAt(scene::findScene("heavy_top"), {1, 0, 0}), scene::InputError);
}
