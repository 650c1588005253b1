// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded states of a whole mechanism: closures closed, drives where their motions are.
#pragma once

#include <memory>
#include <string>

#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/// A state, or why there is none.
struct ClosedState {
  MechanismState state;
  std::string failure;  ///< empty: there is one
};

/** States that are a pure function of (scene, seed, index).

    Without closures they are those of drawState(), driven joints at whatever position, rate and
    acceleration was drawn. With closures the scene's start is moved by a seeded amount, drives go
    to a seeded time, and ClosedMotion::project() closes what is open; where it does not arrive, the
    amount is halved. Newton's method then goes on in long double until q and qd are the doubles
    nearest to numbers that close the mechanism. */
class ClosedStates {
 public:
  explicit ClosedStates(const PreparedScene& scene);
  ~ClosedStates();

  ClosedState draw(std::uint64_t seed, int index);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
