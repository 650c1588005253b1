// SPDX-License-Identifier: GPL-3.0-or-later
// What readers make of a file, against what it says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/readers/reader.hpp"
#include "crosscheck/readers/rules.hpp"

namespace dynwitness::crosscheck {

/// What a change of one number of a robot does, at the worst of the seeded states.
struct Effect {
  double M_percent = 0;  ///< of a diagonal entry of M
  double g = 0;          ///< [N m], [N]
};
Effect effectOf(const Robot& robot, const Robot& changed, int states, std::uint64_t seed);

/// Something that a reader has otherwise.
struct Misreading {
  std::string link;
  std::string quantity;  ///< "inertia", "axis", "damping", ...
  std::string rule;      ///< the mistake that gives exactly what was read; empty: none is known
  std::string ours, theirs;
  scene::SourceLocation where;
  bool has_effect = false;
  Effect effect = {};
  std::vector<std::string> records = {};  ///< where this is on public record
  std::optional<MassMoments> read = {};   ///< what was read of a body's mass
};

struct ReaderResult {
  std::string name, version;
  bool present = true;
  std::string absence;  ///< not present: what is missing
  std::string refusal;
  std::string failure;  ///< how it crashed, hung, or talked nonsense, which is a finding, too
  std::vector<std::string> told;
  std::vector<Misreading> findings;
  std::string
      remedy;  ///< tried: with it the reader has the robot of the file; empty: none is known

  bool has_read = false;
};

struct ReadersResult {
  std::string file, format;  ///< "urdf", "mjcf"
  int links = 0, states = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> bodies;      ///< names of the moving links
  std::vector<std::string> impossible;  ///< inertias that no body has
  std::vector<std::string> remarks;     ///< what is remarkable in a URDF (scene/remarks.hpp)
  /// What is in an MJCF file and not in the comparison.
  std::vector<std::string> not_compared;
  std::vector<ReaderResult> readers;

  bool anyRead() const;
  /// Whether every reader that has read has the robot of the file.
  bool agrees() const;
  /// The moving links, and what findings name besides; empty: the whole robot.
  std::vector<std::string> rows() const;
};

/// "mujoco 2.2.2"
std::string title(const ReaderResult& reader);
/// What the table says of a link: "same", the quantities that differ, or why there is nothing.
std::string cellOf(const ReaderResult& reader, const std::string& link);
/// "M 12 % on its diagonal, g 3 N m at the worst state"; empty: there is none to say.
std::string effectText(const Misreading& finding);

/** Reads a URDF or MJCF by every reader and compares: the tree, joints (kinds, places, axes,
    limits, damping, friction, armature, springs, followers), mass, centre of mass and inertia of
    each moving body after lumping fixed joints, gravity; then each reader's own M and g with those
    of what it shows, at seeded states. Of one that shows nothing, what it has read is found from
    its M and g (answers.hpp). Each reads in a copy of this process.
    @throws InputError  our own reader refuses the file, or nothing moves in it */
ReadersResult examineReaders(const std::string& text, const std::filesystem::path& file,
                             const std::vector<Reader>& readers, int states, std::uint64_t seed,
                             const ReaderLimits& limits = {});

/// What inertia is, in one line.
std::string shown(const MassMoments& m);
std::string shown(const Eigen::Isometry3d& X);
std::string shown(const Eigen::Vector3d& v);

/// The robot as a URDF that leaves readers little to do: fixed links merged, inertias in link axes
/// about centres of mass, unit axes.
std::string plainUrdf(const scene::Urdf& urdf);

/// The table: a row a link, a column a reader, what differs alone unless `all`; then the findings.
std::string readersText(const ReadersResult& result, bool all);
/// For programs; crosscheck/readers/readers.schema.json describes it.
std::string readersJson(const ReadersResult& result, const std::string& version);

}  // namespace dynwitness::crosscheck
