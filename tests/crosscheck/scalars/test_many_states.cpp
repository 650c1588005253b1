// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps at many states are the fast sweeps, and so are their derivatives: the same bits
// as one state at a time, whatever the width of the vectors, the layout of the arrays and the
// number of states. That those are right is held by tests of the witness `fast` and
// test_fast_derivatives.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <boost/test/unit_test.hpp>

#include "crosscheck/scalars/many_states.hpp"
#include "recursive/build_model.hpp"
#include "recursive/fast/derivatives.hpp"
#include "recursive/fast/dynamics.hpp"
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/lanes/many_derivatives.hpp"
#include "tests/fixtures/lanes/widths.hpp"
#include "tests/fixtures/scene_files.hpp"

using namespace dynwitness;
using namespace dynwitness::recursive;
using fast::ManyDerivatives;
using fast::ManyStates;
using fast::Strided;

namespace {

Model<double> modelOf(const std::string& file) {
  const scene::Scene scene = scene::readScene(file);
  return buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
}
Model<double> bundled(const std::string& name) {
  return modelOf(std::string(DYNWITNESS_DATA_DIR) + "/scenes/" + name + ".toml");
}

/// Derivatives by q, by qd and by qdd or tau.
using Three = std::array<std::vector<double>, 3>;

/// States of one mechanism, one after the other, and what Dynamics and Derivatives say of each.
struct Asked {
  Asked(const Model<double>& model, int states)
      : n(model.dof()), nq(model.positions), count(states) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> number(-3, 3);
    for (auto* all : {&q, &qd, &given}) {
      all->resize(static_cast<std::size_t>(count * (all == &q ? nq : n)));
      for (double& x : *all) x = number(random);
    }
  }
  void answer(const Model<double>& model) {
    fast::Dynamics one(model);
    tau.resize(static_cast<std::size_t>(count * n));
    qdd = tau;
    M.resize(static_cast<std::size_t>(count * n * n));
    for (int s = 0; s < count; ++s) {
      one.inverseDynamics(&q[s * nq], &qd[s * n], &given[s * n], &tau[s * n]);
      one.forwardDynamics(&q[s * nq], &qd[s * n], &given[s * n], &qdd[s * n]);
      one.massMatrix(&q[s * nq], &M[s * n * n]);
    }
    fast::Derivatives derivatives(model);
    of_tau.fill(M);
    of_qdd.fill(M);
    for (int s = 0; s < count; ++s) {
      const auto at = [&](std::vector<double>& all) { return &all[s * n * n]; };
      derivatives.inverseDynamics(&q[s * nq], &qd[s * n], &given[s * n], at(of_tau[0]),
                                  at(of_tau[1]), at(of_tau[2]));
      derivatives.forwardDynamics(&q[s * nq], &qd[s * n], &given[s * n], at(of_qdd[0]),
                                  at(of_qdd[1]), at(of_qdd[2]));
    }
  }
  int n, nq, count;
  std::vector<double> q, qd, given, tau, qdd, M;
  Three of_tau, of_qdd;
};

/// Bytes of an array of `count` states of `width` numbers, laid out by columns: all states' first
/// number, then all states' second, with a gap after each.
struct ByColumns {
  ByColumns(const std::vector<double>& rows, int count, int width)
      : apart(count + 3), numbers(static_cast<std::size_t>(width) * apart, -17.0) {
    for (int s = 0; s < count; ++s)
      for (int k = 0; k < width; ++k)
        numbers[static_cast<std::size_t>(k * apart + s)] =
            rows[static_cast<std::size_t>(s * width + k)];
  }
  Strided<const double> read() const { return {numbers.data(), 1, apart}; }
  Strided<double> write() { return {numbers.data(), 1, apart}; }
  int apart;
  std::vector<double> numbers;
};

/// What is no number has no bits of its own: processors choose among its signs.
bool sameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::memcmp(&x, &y, sizeof x) == 0 || (std::isnan(x) && std::isnan(y));
  });
}

void requireSameBits(ManyStates& many, const Asked& asked) {
  const int n = asked.n, nq = asked.nq, nn = n * n;
  const auto states = static_cast<std::size_t>(asked.count);
  // first, while no M of these states is there
  const std::vector<fast::MassMatrixEntry> entries = many.packedEntries();
  const auto size = static_cast<int>(entries.size());
  std::vector<double> packed(states * entries.size(), 1);
  many.packedMassMatrix(states, {asked.q.data(), nq}, {packed.data(), size});
  std::vector<double> tau(asked.tau.size(), 1), qdd(tau), M(asked.M.size(), 1);
  many.inverseDynamics(states, {asked.q.data(), nq}, {asked.qd.data(), n}, {asked.given.data(), n},
                       {tau.data(), n});
  many.forwardDynamics(states, {asked.q.data(), nq}, {asked.qd.data(), n}, {asked.given.data(), n},
                       {qdd.data(), n});
  many.massMatrix(states, {asked.q.data(), nq}, {M.data(), nn});
  BOOST_TEST(sameBits(tau, asked.tau));
  BOOST_TEST(sameBits(qdd, asked.qdd));
  BOOST_TEST(sameBits(M, asked.M));

  std::vector<double> expected;
  for (std::size_t s = 0; s < states; ++s)
    for (const fast::MassMatrixEntry& e : entries)
      expected.push_back(asked.M[s * static_cast<std::size_t>(nn) +
                                 static_cast<std::size_t>(e.row * n + e.column)]);
  BOOST_TEST(sameBits(packed, expected));
  // the others are zero
  std::vector<double> rest = asked.M;
  for (std::size_t s = 0; s < states; ++s)
    for (const fast::MassMatrixEntry& e : entries)
      for (const int place : {e.row * n + e.column, e.column * n + e.row})
        rest[s * static_cast<std::size_t>(nn) + static_cast<std::size_t>(place)] = 0;
  BOOST_TEST(std::all_of(rest.begin(), rest.end(), [](double x) { return x == 0; }));
}

void requireSameBits(ManyDerivatives& many, const Asked& asked) {
  const int n = asked.n, nq = asked.nq, nn = n * n;
  const auto states = static_cast<std::size_t>(asked.count);
  Three of_tau, of_qdd;
  for (Three* three : {&of_tau, &of_qdd})
    for (std::vector<double>& matrices : *three) matrices.assign(asked.M.size(), 1);
  const Strided<const double> q{asked.q.data(), nq}, qd{asked.qd.data(), n},
      given{asked.given.data(), n};
  many.inverseDynamics(states, q, qd, given, {of_tau[0].data(), nn}, {of_tau[1].data(), nn},
                       {of_tau[2].data(), nn});
  many.forwardDynamics(states, q, qd, given, {of_qdd[0].data(), nn}, {of_qdd[1].data(), nn},
                       {of_qdd[2].data(), nn});
  for (int k = 0; k < 3; ++k) {
    BOOST_TEST_CONTEXT("derivative " << k) {
      BOOST_TEST(sameBits(of_tau[k], asked.of_tau[k]));
      BOOST_TEST(sameBits(of_qdd[k], asked.of_qdd[k]));
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_scene_gets_the_bits_of_one_state_at_a_time) {
  int asked = 0;
  for (const std::string& file : sceneFiles()) {
    const scene::Scene scene = scene::readScene(file);
    if (scene.mechanism.hasCoupledRates()) continue;  // a plan is refused
    BOOST_TEST_CONTEXT(file) {
      const auto model = buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism));
      Asked all(model, 19);
      all.answer(model);
      for (const int width : widths()) {
        BOOST_TEST_CONTEXT("width " << width) {
          ManyStates many(model, width);
          requireSameBits(many, all);
          ManyDerivatives derivatives(model, width);
          requireSameBits(derivatives, all);
        }
      }
      ++asked;
    }
  }
  BOOST_TEST(asked > 40);
}

BOOST_AUTO_TEST_CASE(any_number_of_states_and_any_layout_are_answered_and_nothing_else_is_written) {
  const auto model = bundled("satellite_arm");
  for (const int width : widths()) {
    ManyStates many(model, width);
    ManyDerivatives derivatives(model, width);
    for (const int count : {0, 1, 2, 3, 7, 8, 9, 16, 21}) {
      BOOST_TEST_CONTEXT("width " << width << ", states " << count) {
        Asked all(model, count);
        all.answer(model);
        requireSameBits(many, all);
        requireSameBits(derivatives, all);

        const ByColumns q(all.q, count, all.nq), qd(all.qd, count, all.n),
            given(all.given, count, all.n);
        ByColumns out(std::vector<double>(all.tau.size(), 5.0), count, all.n);
        const ByColumns expected(all.qdd, count, all.n);
        many.forwardDynamics(static_cast<std::size_t>(count), q.read(), qd.read(), given.read(),
                             out.write());
        BOOST_TEST(sameBits(out.numbers, expected.numbers));

        const int nn = all.n * all.n;
        ByColumns three[] = {{all.M, count, nn}, {all.M, count, nn}, {all.M, count, nn}};
        derivatives.forwardDynamics(static_cast<std::size_t>(count), q.read(), qd.read(),
                                    given.read(), three[0].write(), three[1].write(),
                                    three[2].write());
        for (int k = 0; k < 3; ++k)
          BOOST_TEST(sameBits(three[k].numbers, ByColumns(all.of_qdd[k], count, nn).numbers));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(states_do_not_hear_of_each_other) {
  // an angle that the library reduces, one that is no number, signed zeros, a rate at rest of a
  // joint with friction, a quaternion whose square underflows: each beside ordinary states
  for (const char* name : {"satellite_arm", "puma_560_friction"}) {
    const auto model = bundled(name);
    Asked all(model, 24);
    const int last = all.nq - 1;
    all.q[static_cast<std::size_t>(3 * all.nq + last)] = 1e5;
    all.q[static_cast<std::size_t>(9 * all.nq + last)] = std::numeric_limits<double>::quiet_NaN();
    all.q[static_cast<std::size_t>(10 * all.nq + last)] = -0.0;
    all.qd[static_cast<std::size_t>(11 * all.n + all.n - 1)] = -0.0;
    all.qd[static_cast<std::size_t>(12 * all.n)] = 0;
    for (int k = 0; k < all.nq; ++k) all.q[static_cast<std::size_t>(17 * all.nq + k)] *= 1e-170;
    all.answer(model);
    for (const int width : widths()) {
      BOOST_TEST_CONTEXT(name << ", width " << width) {
        ManyStates many(model, width);
        requireSameBits(many, all);
        ManyDerivatives derivatives(model, width);
        requireSameBits(derivatives, all);
      }
    }
    BOOST_TEST(std::isnan(all.qdd[static_cast<std::size_t>(9 * all.n)]));
    BOOST_TEST(!std::isnan(all.qdd[static_cast<std::size_t>(8 * all.n)]));
  }
}

BOOST_AUTO_TEST_CASE(a_width_that_the_processor_lacks_is_refused) {
  const auto model = bundled("double_pendulum");
  for (const int width : {-1, 0, 1, 3, 16})
    BOOST_CHECK_EXCEPTION(ManyStates(model, width), std::invalid_argument, [&](const auto& e) {
      return files::contains(e.what(), "width " + std::to_string(width) + " was asked");
    });
  BOOST_TEST(ManyStates(model).width() == fast::widestVectors());
}
