// SPDX-License-Identifier: GPL-3.0-or-later
// Spatial algebra against the chapter's equations written out in 3-vectors, over the rationals.
#include "recursive/spatial.hpp"

#include <type_traits>
#include <utility>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "tests/fixtures/fixtures.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness::recursive;
using dynwitness::fixtures::M3;
using dynwitness::fixtures::mismatch;
using dynwitness::fixtures::Point;
using dynwitness::fixtures::Q;
using dynwitness::fixtures::Sampler;
using dynwitness::fixtures::V3;

// ------------------------------------------------------- what must compile, and what must not

namespace {

template <typename, typename A, typename B>
struct CanAdd : std::false_type {};
template <typename A, typename B>
struct CanAdd<std::void_t<decltype(std::declval<A>() + std::declval<B>())>, A, B> : std::true_type {
};
template <typename, typename A, typename B>
struct CanSubtract : std::false_type {};
template <typename A, typename B>
struct CanSubtract<std::void_t<decltype(std::declval<A>() - std::declval<B>())>, A, B>
    : std::true_type {};
template <typename, typename A, typename B>
struct CanDot : std::false_type {};
template <typename A, typename B>
struct CanDot<std::void_t<decltype(dot(std::declval<A>(), std::declval<B>()))>, A, B>
    : std::true_type {};
template <typename, typename A, typename B>
struct CanCross : std::false_type {};
template <typename A, typename B>
struct CanCross<std::void_t<decltype(cross(std::declval<A>(), std::declval<B>()))>, A, B>
    : std::true_type {};
template <typename, typename A, typename B>
struct CanMultiply : std::false_type {};
template <typename A, typename B>
struct CanMultiply<std::void_t<decltype(std::declval<A>() * std::declval<B>())>, A, B>
    : std::true_type {};

using X = Motion<double>;
using F = Force<double>;
// the same questions answered "yes" where they should be: the probes themselves work
static_assert(CanAdd<void, X, X>::value && CanAdd<void, F, F>::value);
static_assert(!CanAdd<void, X, F>::value && !CanAdd<void, F, X>::value);
static_assert(CanSubtract<void, X, X>::value && CanSubtract<void, F, F>::value);
static_assert(!CanSubtract<void, X, F>::value && !CanSubtract<void, F, X>::value);
static_assert(CanDot<void, X, F>::value);
static_assert(!CanDot<void, X, X>::value && !CanDot<void, F, F>::value &&
              !CanDot<void, F, X>::value);
static_assert(CanCross<void, X, X>::value && CanCross<void, X, F>::value);
static_assert(!CanCross<void, F, X>::value && !CanCross<void, F, F>::value);
static_assert(CanMultiply<void, RigidInertia<double>, X>::value);
static_assert(!CanMultiply<void, RigidInertia<double>, F>::value);
static_assert(CanMultiply<void, ArticulatedInertia<double>, X>::value);
static_assert(!CanMultiply<void, ArticulatedInertia<double>, F>::value);
static_assert(!std::is_convertible_v<X, F> && !std::is_convertible_v<F, X>);
static_assert(std::is_same_v<decltype(cross(X(), F())), F>);
static_assert(std::is_same_v<decltype(cross(X(), X())), X>);
static_assert(std::is_same_v<decltype(std::declval<Transform<double>>() * X()), X>);
static_assert(std::is_same_v<decltype(std::declval<Transform<double>>() * F()), F>);
static_assert(std::is_same_v<decltype(std::declval<RigidInertia<double>>() * X()), F>);

// ----------------------------------------------------------------------------- random elements

Motion<Q> randomMotion(Sampler& s) {
  return {s.vector(), s.vector()};
}
Force<Q> randomForce(Sampler& s) {
  return {s.vector(), s.vector()};
}
Transform<Q> randomTransform(Sampler& s) {
  using namespace dynwitness::fixtures::detail;
  return {rotationZ(s.circle()) * rotationY(s.circle()) * rotationX(s.circle()), s.vector()};
}
std::vector<Point> randomCloud(Sampler& s) {
  std::vector<Point> cloud(5);
  for (Point& point : cloud) point = {s.vector(), s.positive()};
  return cloud;
}

/// Inertia about the origin, by the sums over mass points that define it.
RigidInertia<Q> summed(const std::vector<Point>& cloud) {
  RigidInertia<Q> out = RigidInertia<Q>::zero();
  M3<Q> I = M3<Q>::Zero();
  for (const Point& point : cloud) {
    out.mass += point.mass;
    out.h += point.at * point.mass;
    const Q x = point.at(0), y = point.at(1), z = point.at(2);
    M3<Q> one;
    one << y * y + z * z, -x * y, -x * z, -x * y, x * x + z * z, -y * z, -x * z, -y * z,
        x * x + y * y;
    I += one * point.mass;
  }
  out.I = Symmetric3<Q>::fromUpper(I);
  return out;
}

std::string mismatch(const Motion<Q>& a, const Motion<Q>& b) {
  return mismatch(a.vector(), b.vector());
}
std::string mismatch(const Force<Q>& a, const Force<Q>& b) {
  return mismatch(a.vector(), b.vector());
}
std::string mismatch(const RigidInertia<Q>& a, const RigidInertia<Q>& b) {
  if (a.mass != b.mass) return "mass " + a.mass.str() + " and " + b.mass.str();
  const std::string h = mismatch(a.h, b.h);
  return h.empty() ? mismatch(a.I.matrix(), b.I.matrix()) : "h " + h;
}

/// M as the 6 x 6 matrix of the chapter's (18).
Matrix6<Q> matrixOf(const RigidInertia<Q>& M) {
  Matrix6<Q> m = Matrix6<Q>::Zero();
  const V3<Q>& h = M.h;
  M3<Q> h_hat;
  h_hat << 0, -h(2), h(1), h(2), 0, -h(0), -h(1), h(0), 0;
  m.topLeftCorner<3, 3>() = M3<Q>::Identity() * M.mass;
  m.topRightCorner<3, 3>() = -h_hat;
  m.bottomLeftCorner<3, 3>() = h_hat;
  m.bottomRightCorner<3, 3>() = M.I.matrix();
  return m;
}

constexpr int kSeeds = 8;

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// Chapter (1), (6): the same force about another reference point, in other axes, in 3-vectors. The
// chapter's frame 2 is our B, its frame 1 our A; r_12 = p (B's origin seen from A's).
BOOST_DATA_TEST_CASE(a_force_moves_to_another_point_by_equation_1, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X_BA = randomTransform(sample);
  const Force<Q> F_B = randomForce(sample);
  const M3<Q> R_AB = X_BA.R.transpose();
  const V3<Q> f = R_AB * F_B.force;
  const V3<Q> m = R_AB * F_B.moment + X_BA.p.cross(V3<Q>(R_AB * F_B.force));
  BOOST_TEST(mismatch(X_BA.inverseTimes(F_B), Force<Q>{f, m}) == "");
  // and back: the point moves by -p before the axes turn
  const V3<Q> m_back = X_BA.R * V3<Q>(m - X_BA.p.cross(f));
  BOOST_TEST(mismatch(X_BA * Force<Q>{f, m}, Force<Q>{X_BA.R * f, m_back}) == "");
}

// Chapter (8), (11): v_1 = v_2 + r_12 x w_2, the velocity of the body's point at the other origin.
BOOST_DATA_TEST_CASE(a_velocity_moves_to_another_point_by_equation_8, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X_BA = randomTransform(sample);
  const Motion<Q> v_B = randomMotion(sample);
  const V3<Q> w_A = X_BA.R.transpose() * v_B.angular;
  const V3<Q> v_A = V3<Q>(X_BA.R.transpose() * v_B.linear) + X_BA.p.cross(w_A);
  BOOST_TEST(mismatch(X_BA.inverseTimes(v_B), Motion<Q>{v_A, w_A}) == "");
  const V3<Q> v_B_again = X_BA.R * V3<Q>(v_A + w_A.cross(X_BA.p));
  BOOST_TEST(mismatch(X_BA * Motion<Q>{v_A, w_A}, Motion<Q>{v_B_again, v_B.angular}) == "");
}

// Section 5.3, left open there: momentum moves like force. By hand: p = sum m v, l = sum r x m v
// over mass points of a moving body, about both origins.
BOOST_DATA_TEST_CASE(momentum_of_mass_points_moves_like_a_force, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const std::vector<Point> cloud = randomCloud(sample);  // in A
  const Motion<Q> x_A = randomMotion(sample);
  const Transform<Q> X_BA = randomTransform(sample);
  Force<Q> about_A = Force<Q>::zero(), about_B = Force<Q>::zero();
  for (const Point& point : cloud) {
    const V3<Q> v = x_A.linear + x_A.angular.cross(point.at);
    about_A.force += v * point.mass;
    about_A.moment += point.at.cross(V3<Q>(v * point.mass));
    const V3<Q> r_B = X_BA.R * V3<Q>(point.at - X_BA.p), v_B = X_BA.R * v;
    about_B.force += v_B * point.mass;
    about_B.moment += r_B.cross(V3<Q>(v_B * point.mass));
  }
  BOOST_TEST(mismatch(summed(cloud) * x_A, about_A) == "");
  BOOST_TEST(mismatch(X_BA * about_A, about_B) == "");
  BOOST_TEST(mismatch(X_BA.inverseTimes(about_B), about_A) == "");
}

// Chapter (3) to (5), (10) to (12): the matrices, blocks typed from the page.
BOOST_DATA_TEST_CASE(transformation_matrices_have_the_blocks_of_the_chapter, data::xrange(kSeeds),
                     seed) {
  Sampler sample(seed);
  const Transform<Q> X_BA = randomTransform(sample);
  const M3<Q> R_AB = X_BA.R.transpose();
  const V3<Q> r = X_BA.p;  // r_12 with A = 1, B = 2
  M3<Q> r_hat;
  r_hat << 0, -r(2), r(1), r(2), 0, -r(0), -r(1), r(0), 0;  // (4)
  BOOST_TEST(mismatch(skew(r), r_hat) == "");
  Matrix6<Q> T_F_12, T_V_12, T_F_21, T_V_21;
  T_F_12 << R_AB, M3<Q>::Zero(), r_hat * R_AB, R_AB;                                       // (6)
  T_F_21 << R_AB.transpose(), M3<Q>::Zero(), -R_AB.transpose() * r_hat, R_AB.transpose();  // (7)
  T_V_12 << R_AB, r_hat * R_AB, M3<Q>::Zero(), R_AB;                                       // (11)
  T_V_21 << R_AB.transpose(), -R_AB.transpose() * r_hat, M3<Q>::Zero(), R_AB.transpose();  // (12)
  BOOST_TEST(mismatch(X_BA.forceMatrix(), T_F_21) == "");
  BOOST_TEST(mismatch(X_BA.motionMatrix(), T_V_21) == "");
  BOOST_TEST(mismatch(X_BA.inverse().forceMatrix(), T_F_12) == "");
  BOOST_TEST(mismatch(X_BA.inverse().motionMatrix(), T_V_12) == "");
  BOOST_TEST(mismatch(T_F_21, T_V_12.transpose()) == "");  // (13)
}

// Chapter (16) and (18) against sums over mass points: the sums know no parallel-axis theorem.
BOOST_DATA_TEST_CASE(the_parallel_axis_rule_gives_the_inertia_of_a_point_cloud,
                     data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  std::vector<Point> cloud = randomCloud(sample);
  const RigidInertia<Q> about_origin = summed(cloud);
  const V3<Q> r_c = about_origin.h / about_origin.mass;
  std::vector<Point> centred = cloud;
  for (Point& point : centred) point.at -= r_c;
  const RigidInertia<Q> about_com = summed(centred);
  BOOST_TEST(mismatch(about_com.h, V3<Q>::Zero()) == "");
  BOOST_TEST(mismatch(RigidInertia<Q>::aboutCenterOfMass(about_com.mass, r_c, about_com.I),
                      about_origin) == "");
  BOOST_TEST(mismatch(ArticulatedInertia<Q>::fromRigid(about_origin).matrix(),
                      matrixOf(about_origin)) == "");
}

// The same cloud seen from A and from B: points are moved one by one, then summed.
BOOST_DATA_TEST_CASE(an_inertia_moves_to_another_frame_as_its_points_do, data::xrange(kSeeds),
                     seed) {
  Sampler sample(seed);
  const std::vector<Point> in_B = randomCloud(sample);
  const Transform<Q> X_BA = randomTransform(sample);
  std::vector<Point> in_A = in_B;
  for (Point& point : in_A) point.at = X_BA.p + X_BA.R.transpose() * point.at;
  BOOST_TEST(mismatch(X_BA.inverseTimes(summed(in_B)), summed(in_A)) == "");
}

// F = M a + bias for a cloud: each point needs m times its acceleration. With spatial acceleration
// (a, alpha) and velocity (v, w) a point at r has the acceleration a + w x v + alpha x r + w x (w x
// r).
BOOST_DATA_TEST_CASE(inertial_force_is_the_sum_of_mass_times_acceleration, data::xrange(kSeeds),
                     seed) {
  Sampler sample(seed);
  const std::vector<Point> cloud = randomCloud(sample);
  const Motion<Q> v = randomMotion(sample), a = randomMotion(sample);
  Force<Q> sum = Force<Q>::zero();
  for (const Point& point : cloud) {
    const V3<Q> w_r = v.angular.cross(point.at);
    const V3<Q> acceleration =
        a.linear + v.angular.cross(v.linear) + a.angular.cross(point.at) + v.angular.cross(w_r);
    sum.force += acceleration * point.mass;
    sum.moment += point.at.cross(V3<Q>(acceleration * point.mass));
  }
  const RigidInertia<Q> M = summed(cloud);
  BOOST_TEST(mismatch(M * a + biasForce(M, v), sum) == "");
}

// Chapter (15), a body whose origin is at rest: F_b = (w x (w x m r_c), w x I w).
BOOST_DATA_TEST_CASE(bias_force_of_a_body_turning_about_its_origin_is_equation_15,
                     data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const RigidInertia<Q> M = summed(randomCloud(sample));
  const V3<Q> w = sample.vector();
  const Force<Q> F_b = {w.cross(V3<Q>(w.cross(M.h))), w.cross(V3<Q>(M.I.matrix() * w))};
  BOOST_TEST(mismatch(biasForce(M, Motion<Q>{V3<Q>::Zero(), w}), F_b) == "");
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(a_transformation_and_its_inverse_cancel, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X = randomTransform(sample);
  const Motion<Q> v = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(mismatch(X.inverse() * (X * v), v) == "");
  BOOST_TEST(mismatch(X.inverse() * (X * f), f) == "");
  BOOST_TEST(mismatch(X.inverseTimes(X * v), v) == "");
  BOOST_TEST(mismatch(X.inverseTimes(X * f), f) == "");
  BOOST_TEST(mismatch((X.inverse() * X).motionMatrix(), Matrix6<Q>::Identity()) == "");
}

BOOST_DATA_TEST_CASE(transformations_compose, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X_BA = randomTransform(sample), X_CB = randomTransform(sample);
  const Motion<Q> v = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(mismatch((X_CB * X_BA) * v, X_CB * (X_BA * v)) == "");
  BOOST_TEST(mismatch((X_CB * X_BA) * f, X_CB * (X_BA * f)) == "");
  BOOST_TEST(mismatch((X_CB * X_BA).motionMatrix(), X_CB.motionMatrix() * X_BA.motionMatrix()) ==
             "");
}

BOOST_DATA_TEST_CASE(operators_and_matrices_say_the_same, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X = randomTransform(sample);
  const Motion<Q> v = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(mismatch((X * v).vector(), X.motionMatrix() * v.vector()) == "");
  BOOST_TEST(mismatch((X * f).vector(), X.forceMatrix() * f.vector()) == "");
}

// Chapter (13): power does not depend on the frame, and T_F' T_V = 1.
BOOST_DATA_TEST_CASE(power_is_the_same_in_every_frame, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X = randomTransform(sample);
  const Motion<Q> v = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(dot(X * v, X * f) == dot(v, f));
  BOOST_TEST(mismatch(X.forceMatrix().transpose() * X.motionMatrix(), Matrix6<Q>::Identity()) ==
             "");
}

// Chapter (19), with dense 6 x 6 products instead of the shifts that the code uses.
BOOST_DATA_TEST_CASE(inertias_move_by_equation_19, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X_BA = randomTransform(sample);
  const RigidInertia<Q> M_B = summed(randomCloud(sample));
  const Matrix6<Q> T_F_AB = X_BA.inverse().forceMatrix();
  BOOST_TEST(mismatch(matrixOf(X_BA.inverseTimes(M_B)),
                      T_F_AB * matrixOf(M_B) * T_F_AB.transpose()) == "");
  // an articulated inertia is any symmetric matrix, not only a rigid body's
  Matrix6<Q> any = Matrix6<Q>::Zero();
  for (int k = 0; k < 4; ++k) {
    const Vector6<Q> column = randomForce(sample).vector();
    any += column * column.transpose();
  }
  ArticulatedInertia<Q> A_B = {Symmetric3<Q>::fromUpper(any.topLeftCorner<3, 3>()),
                               any.topRightCorner<3, 3>(),
                               Symmetric3<Q>::fromUpper(any.bottomRightCorner<3, 3>())};
  BOOST_TEST(mismatch(A_B.matrix(), any) == "");
  BOOST_TEST(mismatch(X_BA.inverseTimes(A_B).matrix(), T_F_AB * any * T_F_AB.transpose()) == "");
  const Motion<Q> v = randomMotion(sample);
  BOOST_TEST(mismatch((A_B * v).vector(), any * v.vector()) == "");
  const Force<Q> U = randomForce(sample);
  const Q inverse_D = sample.rational();
  BOOST_TEST(mismatch(A_B.minusOuter(U, inverse_D).matrix(),
                      any - U.vector() * U.vector().transpose() * inverse_D) == "");
}

// crf(x) = -crm(x)', written with dot(): power of a force on a motion that ride in the same frame.
BOOST_DATA_TEST_CASE(the_two_cross_products_are_dual, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Motion<Q> x = randomMotion(sample), y = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(dot(cross(x, y), f) == -dot(y, cross(x, f)));
}

// Jacobi: what makes the cross product the derivative of a change of frame.
BOOST_DATA_TEST_CASE(the_motion_cross_product_obeys_jacobi, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Motion<Q> x = randomMotion(sample), y = randomMotion(sample), z = randomMotion(sample);
  const Motion<Q> sum = cross(x, cross(y, z)) + cross(y, cross(z, x)) + cross(z, cross(x, y));
  BOOST_TEST(mismatch(sum, Motion<Q>::zero()) == "");
  BOOST_TEST(mismatch(cross(x, y) + cross(y, x), Motion<Q>::zero()) == "");
}

// A change of frame carries both cross products along.
BOOST_DATA_TEST_CASE(cross_products_do_not_depend_on_the_frame, data::xrange(kSeeds), seed) {
  Sampler sample(seed);
  const Transform<Q> X = randomTransform(sample);
  const Motion<Q> x = randomMotion(sample), y = randomMotion(sample);
  const Force<Q> f = randomForce(sample);
  BOOST_TEST(mismatch(X * cross(x, y), cross(X * x, X * y)) == "");
  BOOST_TEST(mismatch(X * cross(x, f), cross(X * x, X * f)) == "");
}

BOOST_AUTO_TEST_SUITE_END()
