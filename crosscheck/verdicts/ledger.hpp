// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene's model consists of, and what of its equations of motion is not there: plain data.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/** Sizes of a model, and the entries of M, c and g that are zero whatever the state, with reasons.
    Of scenes with closures it is about the tree that the joints make. */
struct Ledger {
  /// Entries of one quantity; those that are zero in every state.
  struct Zeros {
    /// Those with the same reason.
    struct Group {
      std::string reason;                ///< "independent branches"; kNoSimpleReason
      std::vector<std::string> entries;  ///< "M_1,2": joints by the number of their rate, from 1
    };
    std::string quantity;  ///< "M" (i <= j), "c", "c_ijk" (of qd_j qd_k, j <= k), "g"
    int entries = 0;       ///< there are
    int zero = 0;          ///< of them, 0 in every state
    std::vector<Group> groups;
    std::string not_examined;  ///< why nobody looked; empty: counted
  };
  static constexpr const char* kNoSimpleReason = "no simple reason";

  int links = 0;                       ///< that joints move
  int joints = 0;                      ///< that move
  int rates = 0;                       ///< degrees of freedom
  int parameters = 0;                  ///< ten a moving link, and one a rotor
  std::optional<int> base_parameters;  ///< combinations of them that joint forces can tell
  std::string no_base_parameters;      ///< why they were not counted
  std::vector<Zeros> zeros;
  /// Chance at most that an entry that is called zero is not.
  double error_probability = 0;
  /// Multiplications, additions and divisions of tau, friction apart: of a sweep for any mechanism
  /// (recursive/fast/), and of the scene's own program, which has nothing that is zero.
  std::optional<long> general_operations, operations;
  std::string no_operations;  ///< why one of them was not counted
  /// Rules that contradict what was computed: a fault of ours.
  std::vector<std::string> disputes;
};

}  // namespace dynwitness::crosscheck
