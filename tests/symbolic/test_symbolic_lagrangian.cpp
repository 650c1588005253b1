// SPDX-License-Identifier: GPL-3.0-or-later
// T, V and the equations that follow from them, in exact rational arithmetic: residuals are 0.
//
// Measured on one core of a 2-core machine, g++ 12 -O1: derive() takes 8 ms (PUMA 560), 15 ms
// (7-joint arms), 100 ms (31-joint humanoid).
#include <cmath>
#include <iomanip>
#include <sstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/verdicts/check_identities.hpp"
#include "scene/scene.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/exact_points.hpp"
#include "symbolic/quasi_velocities.hpp"
#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::symbolic;
namespace data = boost::unit_test::data;

namespace {

scene::Mechanism mechanism(const std::string& toml) {
  return scene::readSceneToml("title = \"t\"\nsource = \"this test\"\n" + toml, "test.toml")
      .mechanism;
}

std::vector<Rational> evaluate(const Equations& e, const scene::Mechanism& m,
                               const std::vector<Node>& nodes,
                               const scene::State<Rational>& state) {
  const Program program = compile(e.graph, nodes);
  return ProgramRun<Rational>(program, ExactNumbers(m))(state);
}
Rational evaluate(const Equations& e, const scene::Mechanism& m, Node node,
                  const scene::State<Rational>& state) {
  return evaluate(e, m, std::vector<Node>{node}, state)[0];
}

/// T, V, p, M, c, g, Q, tau of a mechanism as numbers.
struct Values {
  int n;
  Rational T, V;
  std::vector<Rational> p, c, g, Q, tau;
  std::vector<std::vector<Rational>> M;

  Values(const scene::Mechanism& m, const Options& options, const scene::State<Rational>& state) {
    Equations e = derive(m, options);
    n = e.dof();
    std::vector<Node> tau_nodes = inverseDynamics(e);
    std::vector<Node> nodes = {e.kinetic, e.potential};
    for (const auto* part : {&e.p, &e.c, &e.g, &e.Q, &tau_nodes})
      nodes.insert(nodes.end(), part->begin(), part->end());
    for (const auto& row : e.M) nodes.insert(nodes.end(), row.begin(), row.end());
    const std::vector<Rational> all = evaluate(e, m, nodes, state);
    T = all[0];
    V = all[1];
    auto at = all.begin() + 2;
    for (auto* part : {&p, &c, &g, &Q, &tau}) {
      part->assign(at, at + n);
      at += n;
    }
    for (int i = 0; i < n; ++i, at += n) M.emplace_back(at, at + n);
  }
};

/// A tree with everything in it: oblique and reversed axes, DH and modified DH rows, fixed joints,
/// sliders, products of inertia in turned axes, rotors, springs, wrenches in both kinds of axes.
scene::Mechanism randomTree(unsigned seed, int links) {
  std::mt19937 random(seed);
  const auto number = [&] {
    return std::to_string(static_cast<int>(random() % 1999) - 999) + "e-3";
  };
  const auto vector = [&] { return "[" + number() + ", " + number() + ", " + number() + "]"; };
  const std::vector<std::string> axes = {"[0, 0, 1]", "[0, -2, 0]", "[1, 0, 0]", "[0.6, 0, 0.8]",
                                         "[1, 2, 2]", "[1, -2, 3]", "[0, 0, -1]"};
  std::string toml = "gravity = " + vector() + "\n[[link]]\nname = \"base\"\n";
  for (int i = 1; i <= links; ++i) {
    const std::string parent = i == 1 ? "base" : "link" + std::to_string(1 + random() % (i - 1));
    toml += "[[link]]\nname = \"link" + std::to_string(i) + "\"\nparent = \"" + parent +
            "\"\nmass = 2.5\ncom = " + vector() + "\ninertia = { about = \"" +
            (random() % 2 ? "com" : "origin") + "\", rpy = [0.3, \"pi/2\", " + number() +
            "], xx = 24, yy = 25, zz = 26, xy = " + number() + ", xz = " + number() +
            ", yz = " + number() + " }\n[link.joint]\n";
    const unsigned kind = i == links ? 0 : random() % 5;
    toml += std::string("kind = \"") +
            (kind == 4   ? "fixed"
             : kind == 3 ? "prismatic"
                         : "revolute") +
            "\"\n";
    if (kind < 4)
      toml += "rotor_inertia = 1e-3\ngear_ratio = 50\nstiffness = 3\nrest = " + number() + "\n";
    switch (random() % 4) {
      case 0:
        toml +=
            "dh = { a = " + number() + ", alpha = \"pi/2\", d = " + number() + ", theta = 0.7 }\n";
        break;
      case 1:
        toml += "mdh = { a = " + number() + ", alpha = \"-pi/3\", d = " + number() + " }\n";
        break;
      default:
        toml += "xyz = " + vector() + "\nrpy = [" + number() + ", \"pi\", \"pi/4\"]\n";
        if (kind < 4) toml += "axis = " + axes[random() % axes.size()] + "\n";
    }
  }
  for (const std::string axis_kind : {"link", "world"})
    toml += "[[wrench]]\nlink = \"link" + std::to_string(links) + "\"\nforce = " + vector() +
            "\nmoment = " + vector() + "\nat = " + vector() + "\naxes = \"" + axis_kind + "\"\n";
  return mechanism(toml);
}

/// What mechanics demands of every mechanism.
void checkIdentities(const scene::Mechanism& m, unsigned seed) {
  const int n = m.dof();
  const auto state = exactState(n, seed, m.positions());
  const Values v(m, {}, state);
  Rational twice_T = 0;
  for (int i = 0; i < n; ++i) {
    Rational p = 0, tau = v.c[i] + v.g[i] - v.Q[i];
    for (int j = 0; j < n; ++j) {
      p += v.M[i][j] * state.qd[j];
      tau += v.M[i][j] * state.qdd[j];
    }
    twice_T += p * state.qd[i];
    BOOST_TEST(v.p[i] == p);
    BOOST_TEST(v.tau[i] == tau);
  }
  BOOST_TEST(twice_T == 2 * v.T);

  // the same functions whatever is folded or regrouped
  for (const Options options : {Options{true, true}, Options{false, false}, Options{true, false}}) {
    const Values other(m, options, state);
    BOOST_TEST(other.T == v.T);
    BOOST_TEST(other.V == v.V);
    BOOST_TEST((other.M == v.M && other.c == v.c && other.g == v.g && other.Q == v.Q));
  }

  // dT/dt + dV/dt = power of M qdd + c + g
  Equations e = derive(m);
  const Node rate =
      e.graph.directionalDerivative({e.graph.add(e.kinetic, e.potential)}, motion(e, true))[0];
  Rational power = 0;
  for (int i = 0; i < n; ++i) power += (v.tau[i] + v.Q[i]) * state.qd[i];
  BOOST_TEST(evaluate(e, m, rate, state) == power);
}

/** The Christoffel form of the Coriolis matrix [n x n], with  c = C qd  and  dM/dt - 2 C  skew,
    where all rates are derivatives of positions:
        C_ij = sum_k Gamma_ijk qd_k = (dM_ij/dt + dp_i/dq_j - dp_j/dq_i) / 2 */
std::vector<std::vector<Node>> christoffelMatrix(Equations& e) {
  const int n = e.dof();
  Graph& graph = e.graph;
  std::vector<std::vector<Node>> A;  // A[j][i] = dp_i/dq_j
  for (int j = 0; j < n; ++j) A.push_back(graph.directionalDerivative(e.p, e.directions[j]));
  std::vector<std::vector<Node>> C(n, std::vector<Node>(n));
  const Node half = graph.constant(Rational(1, 2));
  for (int i = 0; i < n; ++i) {
    const std::vector<Node> M_rate = graph.directionalDerivative(e.M[i], motion(e));
    for (int j = 0; j < n; ++j)
      C[i][j] = graph.multiply(half, graph.add(M_rate[j], graph.subtract(A[j][i], A[i][j])));
  }
  return C;
}

void checkChristoffelMatrix(const scene::Mechanism& m, unsigned seed) {
  Equations e = derive(m);
  const int n = e.dof();
  const auto state = exactState(n, seed, m.positions());
  const auto C_nodes = christoffelMatrix(e);
  std::vector<std::vector<Rational>> C, M_rate;
  for (int i = 0; i < n; ++i) {
    C.push_back(evaluate(e, m, C_nodes[i], state));
    M_rate.push_back(evaluate(e, m, e.graph.directionalDerivative(e.M[i], motion(e)), state));
  }
  for (int i = 0; i < n; ++i) {
    Rational c = 0;
    for (int j = 0; j < n; ++j) {
      c += C[i][j] * state.qd[j];
      BOOST_TEST(M_rate[i][j] - 2 * C[i][j] == -(M_rate[j][i] - 2 * C[j][i]));
    }
    BOOST_TEST(c == evaluate(e, m, e.c[i], state));
  }
}

}  // namespace

BOOST_AUTO_TEST_SUITE(known_answers)

// Hand derivation: a rod of length l turning about y, hanging down; q = 0 is the rest position.
BOOST_AUTO_TEST_CASE(physical_pendulum) {
  const auto m = mechanism(R"(
gravity = [0, 0, "-g"]
[parameters]
g = 9.81
m = 1.5
l = 0.8
[[link]]
name = "base"
[[link]]
name = "rod"
parent = "base"
mass = "m"
com = [0, 0, "-l/2"]
inertia = { about = "com", xx = "m*l^2/12", yy = "m*l^2/12" }
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
)");
  const auto s = exactState(1, 3);
  const Values v(m, {}, s);
  const Rational mass(3, 2), l(4, 5), g(981, 100);
  BOOST_TEST(v.M[0][0] == mass * l * l / 3);
  BOOST_TEST(v.c[0] == 0);
  BOOST_TEST(v.g[0] == mass * g * l / 2 * s.x[0].s);
  BOOST_TEST(v.V == -mass * g * l / 2 * s.x[0].c);
}

// The textbook's planar two-link arm (e.g. Siciliano et al., Robotics (2009), section 7.3.2,
// without rotors), links along x, turning about z, gravity along -y; written out by hand.
BOOST_AUTO_TEST_CASE(planar_two_link_arm) {
  const auto m = mechanism(R"(
gravity = [0, "-g", 0]
[parameters]
g = 9.81
m1 = 2
m2 = 1.25
a1 = 0.7
l1 = 0.3
l2 = 0.4
I1 = 0.05
I2 = 0.02
[[link]]
name = "base"
[[link]]
name = "upper"
parent = "base"
mass = "m1"
com = ["l1", 0, 0]
inertia = { about = "com", xx = "I1", yy = "I1", zz = "I1" }
[link.joint]
kind = "revolute"
[[link]]
name = "fore"
parent = "upper"
mass = "m2"
com = ["l2", 0, 0]
inertia = { about = "com", xx = "I2", yy = "I2", zz = "I2" }
[link.joint]
kind = "revolute"
xyz = ["a1", 0, 0]
)");
  const auto s = exactState(2, 4);
  const Rational g(981, 100), m1 = 2, m2(5, 4), a1(7, 10), l1(3, 10), l2(2, 5), I1(1, 20),
                              I2(1, 50);
  const Rational c1 = s.x[0].c, c2 = s.x[1].c, s2 = s.x[1].s;
  const Rational c12 = c1 * c2 - s.x[0].s * s2, qd1 = s.qd[0], qd2 = s.qd[1];
  const Rational h = m2 * a1 * l2 * s2;
  for (const Options options : {Options{false, true}, Options{true, false}}) {
    const Values v(m, options, s);
    BOOST_TEST(v.M[0][0] == I1 + m1 * l1 * l1 + I2 + m2 * (a1 * a1 + l2 * l2 + 2 * a1 * l2 * c2));
    BOOST_TEST(v.M[0][1] == I2 + m2 * (l2 * l2 + a1 * l2 * c2));
    BOOST_TEST(v.M[1][1] == I2 + m2 * l2 * l2);
    BOOST_TEST(v.c[0] == -h * qd2 * (2 * qd1 + qd2));
    BOOST_TEST(v.c[1] == h * qd1 * qd1);
    BOOST_TEST(v.g[0] == (m1 * l1 + m2 * a1) * g * c1 + m2 * g * l2 * c12);
    BOOST_TEST(v.g[1] == m2 * g * l2 * c12);
  }
}

// A cart on a spring along x that carries a pole turning about y; q2 = 0: the pole hangs along -z.
BOOST_AUTO_TEST_CASE(cart_pole_with_spring_and_rotor) {
  const auto m = mechanism(R"(
gravity = [0, 0, -10]
[[link]]
name = "rail"
[[link]]
name = "cart"
parent = "rail"
mass = 3
[link.joint]
kind = "prismatic"
axis = [1, 0, 0]
stiffness = 20
rest = 0.25
[[link]]
name = "pole"
parent = "cart"
mass = 2
com = [0, 0, -0.5]
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
rotor_inertia = 0.001
gear_ratio = 10
)");
  const auto s = exactState(2, 6);
  const Values v(m, {}, s);
  const Rational c = s.x[1].c, sn = s.x[1].s;  // x of the pole's mass: q1 - sin(q2)/2
  BOOST_TEST(v.M[0][0] == 5);
  BOOST_TEST(v.M[0][1] == -c);
  BOOST_TEST(v.M[1][1] == Rational(1, 2) + Rational(1, 10));
  BOOST_TEST(v.c[0] == sn * s.qd[1] * s.qd[1]);
  BOOST_TEST(v.c[1] == 0);
  BOOST_TEST(v.g[0] == 20 * (s.x[0].q - Rational(1, 4)));
  BOOST_TEST(v.g[1] == 10 * sn);
}

// A joint about an axis is a joint about z in a frame that fixed joints turn there and back again.
// Identities cannot see a reversed axis: it makes another mechanism, which obeys mechanics too.
struct AxisCase {
  double x, y, z;
};
std::ostream& operator<<(std::ostream& out, const AxisCase& a) {
  return out << a.x << ' ' << a.y << ' ' << a.z;
}
BOOST_DATA_TEST_CASE(axes_point_where_they_say,
                     data::make(std::vector<AxisCase>{{1, 0, 0},
                                                      {0, 1, 0},
                                                      {0, 0, 1},
                                                      {-3, 0, 0},
                                                      {0, -2, 0},
                                                      {0, 0, -1},
                                                      {0.6, 0, 0.8},
                                                      {3, -4, 0},
                                                      {1, 2, 2},
                                                      {1, -2, 3}}) *
                         data::make({"revolute", "prismatic"}),
                     axis, kind) {
  const auto text = [](double x) {
    std::ostringstream out;
    out << std::setprecision(17) << x;
    return out.str();
  };
  const double alpha = std::atan2(axis.y, axis.x);
  const double beta = std::atan2(std::hypot(axis.x, axis.y), axis.z);
  const std::string head = R"(
gravity = [1, 2, -9]
[[link]]
name = "base"
[[link]]
name = "a"
parent = "base"
mass = 1
com = [0.3, 0.2, 0.1]
[link.joint]
kind = "revolute"
axis = [0, 1, 0]
)";
  const std::string body =
      "mass = 2\ncom = [0.1, -0.2, 0.3]\ninertia = { xx = 0.1, yy = 0.12, zz = 0.15, xy = 0.02 }\n";
  const std::string moving =
      std::string("[link.joint]\nkind = \"") + kind + "\"\nxyz = [0.5, 0.4, 0.3]\n";
  const std::string fixed = "[link.joint]\nkind = \"fixed\"\n";
  const auto direct =
      mechanism(head + "[[link]]\nname = \"b\"\nparent = \"a\"\n" + body + moving + "axis = [" +
                text(axis.x) + ", " + text(axis.y) + ", " + text(axis.z) + "]\n");
  const auto spelled_out = mechanism(
      head + "[[link]]\nname = \"b\"\nparent = \"a\"\nmass = 1e-30\n" + moving + "rpy = [0, " +
      text(beta) + ", " + text(alpha) + "]\n[[link]]\nname = \"c\"\nparent = \"b\"\n" + fixed +
      "rpy = [0, " + text(-beta) + ", 0]\n[[link]]\nname = \"d\"\nparent = \"c\"\n" + body + fixed +
      "rpy = [0, 0, " + text(-alpha) + "]\n");
  const auto evaluateDoubles = [](const scene::Mechanism& m) {
    const Equations e = derive(m);
    std::vector<Node> nodes = massCoriolisGravity(e);
    nodes.push_back(e.kinetic);
    nodes.push_back(e.potential);
    scene::State<double> state;
    state.x = {scene::jointPosition(0.4), scene::jointPosition(-1.1)};
    state.qd = {0.7, -0.9};
    const Program program = compile(e.graph, nodes);
    return ProgramRun<double>(program, scene::RealNumbers<double>(m))(state);
  };
  const std::vector<double> a = evaluateDoubles(direct), b = evaluateDoubles(spelled_out);
  for (std::size_t i = 0; i < a.size(); ++i) BOOST_TEST(std::abs(a[i] - b[i]) < 1e-13);
}

// A force at a point of a turned link does work along the point's path.
BOOST_AUTO_TEST_CASE(wrenches_in_link_and_world_axes) {
  const std::string arm = R"(
[[link]]
name = "base"
[[link]]
name = "arm"
parent = "base"
mass = 1
com = [1, 0, 0]
[link.joint]
kind = "revolute"
[[link]]
name = "hand"
parent = "arm"
[link.joint]
kind = "fixed"
xyz = [0.5, 0, 0]
rpy = ["pi/2", 0, 0]
[[wrench]]
link = "hand"
force = [3, 4, 5]
moment = [7, 8, 9]
at = [1.5, 0, 0]
)";
  const auto s = exactState(1, 8);
  // r x f about z is 2 times the force across the arm. The hand's y is the arm's z and its z the
  // arm's -y; in world axes the force across the arm is f_y c - f_x s
  BOOST_TEST(Values(mechanism(arm + "axes = \"link\"\n"), {}, s).Q[0] == 2 * -5 + 8);
  BOOST_TEST(Values(mechanism(arm + "axes = \"world\"\n"), {}, s).Q[0] ==
             2 * (4 * s.x[0].c - 3 * s.x[0].s) + 9);
}

BOOST_AUTO_TEST_CASE(what_a_scene_does_not_mention_costs_nothing) {
  const auto m = mechanism(R"(
[[link]]
name = "base"
[[link]]
name = "a"
parent = "base"
mass = 2
com = [0.5, 0, 0]
[link.joint]
kind = "revolute"
[[link]]
name = "bracket"
parent = "a"
mass = 1
com = [0.25, 0, 0]
[link.joint]
kind = "fixed"
xyz = [0.5, 0, 0]
)");
  const Equations e = derive(m);
  BOOST_TEST((e.g[0] == Node{}));
  BOOST_TEST((e.c[0] == Node{}));
  BOOST_TEST(e.graph.isConstant(e.M[0][0]));
  BOOST_TEST(e.graph.value(e.M[0][0]) == 2 * Rational(1, 4) + Rational(9, 16));
}

// Limits: as counted when written; to be lowered when the count falls, and a rise is to be
// explained.
BOOST_AUTO_TEST_CASE(operation_counts) {
  struct Expected {
    const char* scene;
    int multiplications, additions;
  };
  for (const Expected& x : {Expected{"puma_560", 300, 221}, Expected{"kuka_iiwa_14", 444, 327},
                            Expected{"franka_panda", 639, 502}}) {
    const scene::Scene scene = scene::findScene(x.scene);
    Options options;
    options.fold_parameters = true;
    const Equations e = derive(scene.mechanism, options);
    const auto count = compile(e.graph, massCoriolisGravity(e)).bodyOperations();
    BOOST_TEST(count.multiplications <= x.multiplications);
    BOOST_TEST(count.additions <= x.additions);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(identities)

BOOST_DATA_TEST_CASE(every_bundled_scene_obeys_mechanics, data::make(sceneFiles()), file) {
  checkIdentities(scene::readScene(file).mechanism, 11);
}

BOOST_DATA_TEST_CASE(random_trees_obey_mechanics, data::xrange(8), seed) {
  checkIdentities(randomTree(seed, 5), 20 + seed);
}

BOOST_DATA_TEST_CASE(c_is_C_qd_and_the_rate_of_M_minus_2C_is_skew, data::xrange(5), seed) {
  checkChristoffelMatrix(randomTree(40 + seed, 4), seed);
}

BOOST_AUTO_TEST_CASE(the_mass_matrix_is_symmetric_in_structure) {
  const Equations e = derive(randomTree(3, 7));
  for (int i = 0; i < e.dof(); ++i)
    for (int j = 0; j < e.dof(); ++j) BOOST_TEST((e.M[i][j] == e.M[j][i]));
}

BOOST_AUTO_TEST_CASE(joints_on_different_branches_share_no_inertia) {
  const scene::Mechanism m = randomTree(17, 9);
  const std::vector<int> moving = m.movingLinks();
  const Equations e = derive(m);
  const auto isInboard = [&](int a, int b) {  // is link a on the way from b to the root?
    for (; b >= 0; b = m.links[b].parent)
      if (a == b) return true;
    return false;
  };
  for (int i = 0; i < e.dof(); ++i)
    for (int j = 0; j < e.dof(); ++j)
      if (!isInboard(moving[i], moving[j]) && !isInboard(moving[j], moving[i]))
        BOOST_TEST((e.M[i][j] == Node{}));
}

// a tree of forty links is derived, compiled and run; the residual of p = M qd is 0
BOOST_AUTO_TEST_CASE(large_trees) {
  const scene::Mechanism m = randomTree(99, 40);
  BOOST_TEST(m.dof() > 25);
  Equations e = derive(m, {true, true});
  std::vector<Node> residuals;
  for (int i = 0; i < e.dof(); ++i) {
    Node p;
    for (int j = 0; j < e.dof(); ++j)
      p = e.graph.add(p, e.graph.multiply(e.M[i][j], e.graph.input(Input::kVelocity, j)));
    residuals.push_back(e.graph.subtract(p, e.p[i]));
  }
  for (const Rational& r : evaluate(e, m, residuals, exactState(e.dof(), 1))) BOOST_TEST(r == 0);
}

BOOST_AUTO_TEST_SUITE_END()
