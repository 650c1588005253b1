// SPDX-License-Identifier: GPL-3.0-or-later
// States from a CSV file, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/inputs/conventions.hpp"
#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// What a file may have beside states.
struct OtherColumns {
  std::vector<std::string> names;
  bool has_positions = true;  ///< false: q need not be there
  bool are_kept = false;      ///< any others may be there, and are kept as they are written
  std::string remedy = {};    ///< what else is allowed, for a message about unknown ones
};

/** Reads states of a mechanism, row by row: millions take no more memory than one. The first line
    names the columns, in any order: q1 .. q(positions) and qd1 .. qdn, then qdd1 .. qddn and/or
    tau1 .. taun, n its degrees of freedom. A group that is left out (except q) is zero. Quaternions
    need not be of length 1. Lines that start with # and empty lines are passed over, but that

        # convention: mujoco

    before the header says whose coordinates spherical and floating joints have. */
class StatesReader {
 public:
  /** Reads the header.
      @param file       a regular file, or "-": standard input, which may be a pipe
      @param mechanism  must outlive the reader
      @param others     columns that may be there as well
      @param convention whose coordinates it has; none: the file has to say so, where that matters
      @throws scene::InputError  `file:line: ...` on unknown, doubled or missing columns, on another
        convention than the file's own, or none */
  StatesReader(const std::filesystem::path& file, const scene::Mechanism& mechanism,
               const OtherColumns& others = {},
               std::optional<CoordinateConvention> convention = CoordinateConvention::kDynwitness);
  ~StatesReader();

  /** The next state into *state; false at the end.
      @throws scene::InputError  `file:line: ...` on no row at all, a row of another length, entries
        that are not finite numbers, quaternions that are zero, and lines longer than any row is */
  bool next(scene::State<double>* state);
  /// Whether the header names the columns of "q", "qd", "qdd" or "tau".
  bool gives(const std::string& group) const;
  /// Other columns that the header names, in the order in which they were allowed; and their
  /// numbers in the last row.
  const std::vector<std::string>& otherNames() const;
  std::vector<double> others() const;
  /// Columns that are kept, in the order of the file; and what stands in them in the last row.
  const std::vector<std::string>& keptNames() const;
  std::vector<std::string> kept() const;
  CoordinateConvention convention() const;
  /// Whether next() may have to wait for whoever writes the next row: into a pipe, or a terminal.
  bool mayWait() const;
  /// How much of the file is read, from 0 to 1; negative when nobody knows how long it is.
  double fraction() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
