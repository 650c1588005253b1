// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/build_model.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "recursive/newton_euler.hpp"
#include "tests/fixtures/compiled_sweeps.hpp"
#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using fixtures::M3;
using fixtures::mismatch;
using fixtures::Q;
using fixtures::RationalNumbers;
using fixtures::V3;

namespace {

constexpr int kSeeds = 10, kMoving = 5;

/// A base and one link on a revolute joint.
scene::Mechanism oneLink() {
  scene::Mechanism m;
  m.links.resize(2);
  m.links[1].parent = 0;
  m.links[1].joint.kind = JointKind::kRevolute;
  m.links[1].inertia.mass = scene::Number(1);
  return m;
}

/// World axes to link axes, and the link's origin in the world, as the model places its link i.
Transform<Q> worldToLink(const Model<Q>& model, const std::vector<JointPosition<Q>>& x, int i) {
  Transform<Q> X = Transform<Q>::identity();
  for (; i >= 0; i = model.links[static_cast<std::size_t>(i)].parent)
    X = X * AnyJoints::transform(model.links[static_cast<std::size_t>(i)], x);
  return X;
}

std::vector<Q> tauOf(const Model<Q>& model, const scene::State<Q>& state) {
  Workspace<Q> ws(model);
  std::vector<Q> tau(static_cast<std::size_t>(model.dof()));
  inverseDynamics(model, state.x, state.qd, state.qdd, ws, tau);
  return tau;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// The textbook matrix of a standard DH row (any robotics book):
//   A = Rz(theta + q) Tz(d) Tx(a) Rx(alpha)
// The model's frame is the joint frame, so the centre of mass, given in the link frame behind the
// row, must appear at Rz(theta) Tz(d) Tx(a) Rx(alpha) com; and the next joint is placed behind it.
BOOST_DATA_TEST_CASE(a_dh_row_places_the_link_behind_the_joint, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  scene::Mechanism m = oneLink();
  scene::Placement& place = m.links[1].joint.placement;
  place.convention = scene::Placement::Convention::kDh;
  const Q a = sample.rational(), d = sample.rational(), alpha = sample.rational(),
          theta = sample.rational();
  place.a = fixtures::numberOf(a);
  place.d = fixtures::numberOf(d);
  place.alpha = fixtures::numberOf(alpha);
  place.theta = fixtures::numberOf(theta);
  const V3<Q> com = sample.vector();
  m.links[1].inertia.com = fixtures::vectorOf(com);
  const Model<Q> model = buildModel(m, RationalNumbers(m));
  const auto t = fixtures::circlePoint(theta), l = fixtures::circlePoint(alpha);
  Eigen::Matrix<Q, 4, 4> A;
  A << t.c, -t.s * l.c, t.s * l.s, a * t.c, t.s, t.c * l.c, -t.c * l.s, a * t.s, 0, l.s, l.c, d, 0,
      0, 0, 1;
  const Eigen::Matrix<Q, 4, 1> r = A * Eigen::Matrix<Q, 4, 1>(com(0), com(1), com(2), Q(1));
  BOOST_TEST(mismatch(model.links[0].M.h, V3<Q>(r.head<3>())) == "");
  BOOST_TEST(mismatch(model.links[0].X_tree.motionMatrix(), Matrix6<Q>::Identity()) == "");
}

// The textbook matrix of a modified DH row (Craig):  Rx(alpha) Tx(a) Rz(theta) Tz(d).
BOOST_DATA_TEST_CASE(a_modified_dh_row_places_the_joint, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  scene::Mechanism m = oneLink();
  scene::Placement& place = m.links[1].joint.placement;
  place.convention = scene::Placement::Convention::kMdh;
  const Q a = sample.rational(), d = sample.rational(), alpha = sample.rational(),
          theta = sample.rational();
  place.a = fixtures::numberOf(a);
  place.d = fixtures::numberOf(d);
  place.alpha = fixtures::numberOf(alpha);
  place.theta = fixtures::numberOf(theta);
  const Model<Q> model = buildModel(m, RationalNumbers(m));
  const auto t = fixtures::circlePoint(theta), l = fixtures::circlePoint(alpha);
  M3<Q> R;
  R << t.c, -t.s, 0, t.s * l.c, t.c * l.c, -l.s, t.s * l.s, t.c * l.s, l.c;
  BOOST_TEST(mismatch(model.links[0].X_tree.R, M3<Q>(R.transpose())) == "");
  BOOST_TEST(mismatch(model.links[0].X_tree.p, V3<Q>(a, -d * l.s, d * l.c)) == "");
}

// The model's z axis is the scene's axis, whatever its length: z of the link, seen from the base.
BOOST_DATA_TEST_CASE(the_axis_of_a_joint_becomes_z, data::xrange(kSeeds), seed) {
  fixtures::Sampler sample(seed);
  scene::Mechanism m = oneLink();
  const V3<Q> axis = sample.axis();
  m.links[1].joint.axis = fixtures::vectorOf(axis * sample.positive());
  const Model<Q> model = buildModel(m, RationalNumbers(m));
  const V3<Q> z = model.links[0].X_tree.R.row(2).transpose();
  BOOST_TEST(mismatch(V3<Q>(z * fixtures::exactRoot(axis.dot(axis))), axis) == "");
  BOOST_TEST(mismatch(M3<Q>(model.links[0].X_tree.R * model.links[0].X_tree.R.transpose()),
                      M3<Q>::Identity()) == "");
  BOOST_TEST(model.links[0].X_tree.R.determinant() == 1);
}

// By hand: gear ratio n turns the rotor n times faster, so it weighs n^2 J; 5^2 * 3/100.
BOOST_AUTO_TEST_CASE(a_rotor_counts_with_the_square_of_its_gear_ratio) {
  scene::Mechanism m = oneLink();
  m.links[1].joint.rotor_inertia = scene::Number::parse("0.03");
  m.links[1].joint.gear_ratio = scene::Number(-5);
  const Model<Q> model = buildModel(m, RationalNumbers(m));
  BOOST_TEST(model.links[0].rotor == Q(3) / 4);
}

// By hand: what is fixed to the world moves nothing and enters no link, only the potential energy.
BOOST_AUTO_TEST_CASE(links_fixed_to_the_world_belong_to_the_base) {
  scene::Mechanism m = oneLink();
  m.links[0].inertia.mass = scene::Number(2);
  m.links[0].inertia.com = {scene::Number(1), scene::Number(0), scene::Number(0)};
  scene::Link post;
  post.parent = 0;
  post.joint.placement.xyz = {scene::Number(0), scene::Number(3), scene::Number(0)};
  post.inertia.mass = scene::Number(4);
  m.links.push_back(post);
  const Model<Q> model = buildModel(m, RationalNumbers(m));
  BOOST_TEST(model.links.size() == 1u);
  BOOST_TEST(model.base.mass == 6);
  BOOST_TEST(mismatch(model.base.h, V3<Q>(2, 12, 0)) == "");
  BOOST_TEST(model.links[0].M.mass == 1);
  // unless its joint is kept, to ask what it carries
  const Model<Q> kept = buildModel(m, RationalNumbers(m), FixedJoints::kKept);
  BOOST_TEST(kept.links.size() == 2u);
  BOOST_TEST(kept.base.mass == 2);
  BOOST_TEST(kept.links[1].M.mass == 4);
  BOOST_TEST(kept.links[1].dof == -1);
}

// A load on the base is carried by the world.
BOOST_AUTO_TEST_CASE(loads_on_the_world_move_nothing) {
  scene::Mechanism m = oneLink();
  scene::Wrench wrench;
  wrench.force = wrench.moment = {scene::Number(1), scene::Number(2), scene::Number(3)};
  for (const auto axes : {scene::Wrench::Axes::kLink, scene::Wrench::Axes::kWorld}) {
    wrench.axes = axes;
    m.wrenches = {wrench};
    const Model<Q> model = buildModel(m, RationalNumbers(m));
    BOOST_TEST(model.world_loads.empty());
    BOOST_TEST(mismatch(model.links[0].load.vector(), Vector6<Q>::Zero()) == "");
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

// By another road: the poses of plain 3-D geometry (fixtures::linkPoses). The total mass of the
// moving links has its first moment where the scene's points are.
BOOST_DATA_TEST_CASE(links_stand_where_plain_geometry_puts_them, data::xrange(kSeeds), seed) {
  const fixtures::Tree tree = fixtures::randomTree(kMoving, seed);
  const scene::Mechanism& m = tree.mechanism;
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const auto poses = fixtures::linkPoses(m, state.x);
  const Model<Q> model = buildModel(m, RationalNumbers(m), FixedJoints::kKept);
  // kept: all scene links but the root are the model's links, in order
  std::size_t k = 0;
  for (std::size_t i = 1; i < m.links.size(); ++i) {
    const Transform<Q> X = worldToLink(model, state.x, static_cast<int>(k));
    V3<Q> first_moment(0, 0, 0);
    Q mass = 0;
    for (const fixtures::Point& point : tree.clouds[i]) {
      mass += point.mass;
      first_moment += fixtures::placeOf(poses[i], point.at) * point.mass;
    }
    const RigidInertia<Q> in_scene = X.inverseTimes(model.links[k].M);
    BOOST_TEST(in_scene.mass == mass);
    BOOST_TEST(mismatch(in_scene.h, first_moment) == "");
    ++k;
  }
  BOOST_TEST(k == model.links.size());
}

BOOST_DATA_TEST_CASE(lumping_fixed_joints_changes_no_force, data::xrange(kSeeds), seed) {
  const scene::Mechanism m = fixtures::randomTree(kMoving, seed).mechanism;
  const scene::State<Q> state = fixtures::randomState(kMoving, seed);
  const Model<Q> lumped = buildModel(m, RationalNumbers(m));
  const Model<Q> kept = buildModel(m, RationalNumbers(m), FixedJoints::kKept);
  BOOST_TEST(lumped.links.size() == static_cast<std::size_t>(kMoving));
  BOOST_TEST(kept.links.size() > lumped.links.size());
  BOOST_TEST(mismatch(tauOf(lumped, state), tauOf(kept, state)) == "");
}

BOOST_AUTO_TEST_SUITE_END()
