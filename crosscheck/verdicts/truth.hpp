// SPDX-License-Identifier: GPL-3.0-or-later
// The certified truth: an enclosure of the exact answer that is as narrow as one asks.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// An enclosure of a quantity at a state, and how it was reached.
struct Certified {
  MatrixX<Ball> value;    ///< shaped like the quantity; empty when there is none
  long bits = 0;          ///< precision of the last attempt
  int sharp_entries = 0;  ///< that are known to the accuracy asked, exact zeros included
  std::string reason;     ///< why there is no enclosure, or which entry is not sharp
  /// There is no such number: M is singular, the pivot that says so being zero, or less than the
  /// smallest normal double.
  bool is_impossible = false;

  bool exists() const { return value.size() > 0; }
  /// Every entry is exact or relatively as accurate as was asked.
  bool isSharp() const { return exists() && sharp_entries == value.size(); }
};

/** Encloses quantities by running our sweeps on balls: composite bodies for M, Newton-Euler for
    c, g and tau, articulated bodies for qdd. The precision starts at 128 bits and is doubled
    until the radius of every entry is below 2^-accuracy of the entry.

    An entry whose true value is 0, without every term of it being 0, never gets there. When such an
    entry is below 2^-(2 accuracy) of the largest it is left at that, as beyond what any computation
    in double could resolve. Where all entries are of that kind there is no largest, and the
    doubling goes on to the most bits; what is then below the smallest normal double is left at
    that. `reason` names such an entry; the enclosure is certain all the same.

    What is certified is the value of that sweep's formula at exactly this state (every double of
    it is taken as the number it is). That the formula is the right one is not: for that the
    sweeps are compared with the other witnesses, and with the derived equations exactly. */
class Truth {
 public:
  static constexpr long kAccuracy = 80;  ///< [bits]
  static constexpr long kMaxBits = 4096;

  /// @param accuracy  [bits]; more than 80 to judge computations of more than 20 digits
  /// @param most_bits  where doubling ends; a chain's balls widen by up to 4 bits a link
  explicit Truth(const scene::Mechanism& mechanism, long accuracy = kAccuracy,
                 long most_bits = kMaxBits);
  ~Truth();

  /// The quantity at a state. Where there is no enclosure (singular M: some joint moves no inertia)
  /// the result does not exist(), and its reason names the joint.
  Certified operator()(Quantity quantity, const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
