// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps under constraints against one dense system in all unknowns, made from Lagrange's equations, over a
// prime field: hybrid dynamics, closed loops eliminated where they close, soft and redundant constraints,
// tasks, and Gauss' principle.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE closed_dynamics
#include "recursive/closed_dynamics.hpp"

#include <random>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/arithmetic/prime_field.hpp"
#include "crosscheck/random_mechanism.hpp"
#include "fixtures.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/hybrid_dynamics.hpp"
#include "recursive/operational_space.hpp"
