// SPDX-License-Identifier: GPL-3.0-or-later
#include "recursive/reroot.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/build_model.hpp"
#include "scene/scene.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::recursive;
using crosscheck::PrimeField;
using F = PrimeField;

namespace {

constexpr std::uint64_t kPrime = 9223372036854775783u;  // the largest below 2^63; 3 mod 4

std::string link(const std::string& name, const std::string& parent, const std::string& joint) {
  return "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent +
         "\"\nmass = 2\ncom = [0.1, -0.2, 0.3]\n"
         "inertia = { xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.01, xz "
         "= -0.02 }\n[link.joint]\nxyz = [0.4, 0.5, -0.6]\nrpy = [0.3, 0.2, -1]\n" +
         joint + "\n";
}

/// A floating body with two branches: turn, screw, slide on one, where the turn carries a ball
/// joint and that a body which floats; a turn on the other.
scene::Scene tree() {
  return scene::readSceneToml(
      "gravity = [1, 2, -9]\n[[link]]\nname = \"world\"\n" +
          link("base", "world", "kind = \"floating\"") +
          link("a", "base",
               "kind = \"revolute\"\naxis = [1, 2, 2]\nrotor_inertia = 0.1\nstiffness = 3") +
          link("b", "a", "kind = \"helical\"\npitch = 0.3") +
          link("c", "b", "kind = \"prismatic\"\naxis = [0, 1, 0]") +
          link("d", "base", "kind = \"revolute\"") + link("e", "a", "kind = \"spherical\"") +
          link("f", "e", "kind = \"floating\"") +
          "[[wrench]]\nlink = \"b\"\nforce = [1, 2, 3]\nat = [0.1, 0, 0]\naxes = \"world\"\n"
          "[[wrench]]\nlink = \"a\"\nforce = [1, 2, 3]\nmoment = [4, 5, 6]\n",
      "tree.toml");
}

}  // namespace

BOOST_AUTO_TEST_SUITE(identities)

// T, V and the momentum are those of the same motion, link by link summed in another order
BOOST_DATA_TEST_CASE(any_root_has_the_same_energy_and_momentum, data::xrange(7), root) {
  const PrimeField::Modulus modulus(kPrime);
  const scene::Mechanism m = tree().mechanism;
  const crosscheck::FieldSource source("reroot", 1, 0);
  const Model<F> model = buildModel(m, crosscheck::FieldNumbers(m, source));
  const Rerooted<F> rooted = reroot(model, root);
  scene::State<F> state = crosscheck::indeterminateState(m, source), other = state;
  Workspace<F> ws(model), ws_rooted(rooted.model);
  rerootState(model, rooted, ws, other.x, other.qd);
  BOOST_TEST((kineticEnergy(model, state.x, state.qd, ws) ==
              kineticEnergy(rooted.model, other.x, other.qd, ws_rooted)));
  BOOST_TEST(
      (potentialEnergy(model, state.x, ws) == potentialEnergy(rooted.model, other.x, ws_rooted)));
  BOOST_TEST((momentum(model, state.x, state.qd, ws).vector() ==
              momentum(rooted.model, other.x, other.qd, ws_rooted).vector()));
}

BOOST_DATA_TEST_CASE(back_to_the_first_root_is_the_same_tree, data::xrange(7), root) {
  const PrimeField::Modulus modulus(kPrime);
  const scene::Mechanism m = tree().mechanism;
  const crosscheck::FieldSource source("reroot", 1, 0);
  const Model<F> model = buildModel(m, crosscheck::FieldNumbers(m, source));
  const Rerooted<F> there = reroot(model, root), back = reroot(there.model, there.link[0]);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const int j = back.link[there.link[i]];
    // frames may lie elsewhere: seen from the old frame, inertia is what it was
    const Transform<F> X = (back.X[there.link[i]] * there.X[i]);
    const RigidInertia<F> M = X.inverse().inverseTimes(model.links[i].M);
    BOOST_TEST((M.mass == back.model.links[j].M.mass && M.h == back.model.links[j].M.h));
    BOOST_TEST((M.I.matrix() == back.model.links[j].M.I.matrix()));
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

BOOST_AUTO_TEST_CASE(roots_that_cannot_be_are_refused) {
  const scene::Mechanism m = tree().mechanism;
  const Model<double> model = buildModel(m, scene::RealNumbers<double>(m));
  BOOST_CHECK_THROW(reroot(model, 7), std::invalid_argument);
  BOOST_CHECK_THROW(reroot(model, -1), std::invalid_argument);
  const scene::Mechanism pendulum = scene::findScene("double_pendulum").mechanism;
  BOOST_CHECK_THROW(reroot(buildModel(pendulum, scene::RealNumbers<double>(pendulum)), 1),
                    std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
