// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that read robot descriptions, each with its own defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/readers/robot.hpp"
#include "crosscheck/system/children.hpp"

namespace dynwitness::crosscheck {

/// What a reader made of a file.
struct Reading {
  std::string refusal;  ///< in its own words; empty: it has read
  Robot robot;
  std::vector<std::string> told;  ///< conventions and circumstances, which are no finding
  /// M and g by the engine itself, q one a body of `robot`; empty: it does not say.
  std::function<MassAndGravity(const std::vector<double>& q)> answer;

  /// False: `robot` is the file's, and what it has read is in its answers alone.
  bool shows = true;
  /// Quantities that its model has no place for ("limits", "damping"): these are not compared.
  std::vector<std::string> not_kept;
  std::string name, version;  ///< as a program calls itself; empty: it does not
};

/** A reader: a name, and what it makes of bytes. */
struct Reader {
  std::string name, version;
  bool present = true;
  /// @param file  where the text came from: meshes are looked for beside it
  std::function<Reading(const std::string& text, const std::filesystem::path& file)> read;
  std::string absence = {};  ///< where it is not present: what is missing
  bool is_program = false;   ///< started as a program, with limits of its own
  bool reads_mjcf = false;   ///< and not URDF alone
};

/// What a reader may use for a file, its answers included.
struct ReaderLimits {
  double seconds = 60;
  double gigabytes = 4;  ///< of address space, beside what this program has
};

/// What became of a reading in a copy of this process.
struct ReadApart {
  Reading reading;  ///< without `answer`
  /// M and g at the positions that were drawn for its robot (drawPositions), one a state; none of a
  /// robot with joints of several degrees of freedom, or one that is too large.
  std::vector<MassAndGravity> answers;
  std::string failure;  ///< how it crashed, hung or talked nonsense, with its last words
};

/** Lets readers read, each in a copy of this process, some at a time: what crashes or hangs takes
    nothing with it.
    @return  one a reader, in their order */
std::vector<ReadApart> readApart(const std::vector<const Reader*>& readers, const std::string& text,
                                 const std::filesystem::path& file, int states, std::uint64_t seed,
                                 const ReaderLimits& limits);

/// Whether a robot has so many joints that engines, some of which take the cube of them, are not
/// asked for M and g beside what they show.
bool isTooLargeToAsk(const Robot& robot);

/// One source each (NAME_reader.cpp); without its engine the source is a stub.
Reader mujocoReader();
Reader dartReader();

/** A program that speaks the protocol of engines (crosscheck/witnesses/engine_protocol.md), told
    the file and nothing of what is in it but the names of its joints.
    @param name     until it says its own
    @param command  words for a shell */
Reader programReader(const std::string& name, const std::string& command, const Limits& limits);

/// All but ours: those that are linked, programs that were built or installed beside this one, then
/// the user's.
std::vector<Reader> engineReaders(const std::vector<std::string>& commands = {},
                                  const Limits& limits = {});

}  // namespace dynwitness::crosscheck
