// SPDX-License-Identifier: GPL-3.0-or-later
// Where the states of a command come from: a file, seeds, or the command line itself.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/inputs/conventions.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::cli {

/// What the command line says about states: --states, --random with --seed, or --q, --qd, --qdd
/// and --tau.
struct StatesAsked {
  std::string file;  ///< of --states; empty: none
  int random = 0;    ///< so many seeded states; 0: none
  std::uint64_t seed = 1;
  bool keep = false;       ///< other columns of the file
  std::string convention;  ///< a name; empty: what the file says, or dynwitness
  std::optional<StateOption> q, qd, qdd, tau;
};

/// Adds these options, which exclude each other. @param about_files  what --help says of --states
void addStates(CLI::App& command, StatesAsked& asked, const std::string& about_files);

/// --convention NAME. @param of_what  what has it, behind the meaning in --help
CLI::Option* addConvention(CLI::App& command, std::string& name, const std::string& of_what);

/// Where a motion starts: --q and --qd, or a row of --states.
struct StartAsked {
  std::optional<StateOption> q, qd;
  std::string file, convention;
  int row = 1;

  bool isGiven() const { return !file.empty() || q->isGiven() || qd->isGiven(); }
};
void addStart(CLI::App& command, StartAsked& asked);
/// @param motion  another file that may have the convention; empty: none
/// @throws scene::InputError  --convention, and no file
void requireFileOfConvention(const StartAsked& asked, const std::string& motion = {});
/// The scene with this start, in doubles; as it is where none is given.
/// @throws scene::InputError  the options or the file have no such state
scene::Scene startedAt(scene::Scene scene, const StartAsked& asked);

/// Which groups of columns the states have; q is always there.
struct GivenColumns {
  bool qd = false, qdd = false, tau = false;
  /// Of a state that no file has: what stands there though nobody gave it.
  bool is_start = false, is_tau_zero = false;
};

/// States, one after the other.
class States {
 public:
  virtual ~States() = default;
  /// The state that next() goes on from; nullptr: there is none left.
  virtual scene::State<double>* current() = 0;
  virtual void next() = 0;
  virtual GivenColumns given() const = 0;
  /// Somebody who writes the states may be waiting for answers.
  virtual bool mayWait() const { return false; }
  /// Columns that the command does not know, and is to keep, and what stands in them at current().
  virtual std::vector<std::string> keptNames() const { return {}; }
  virtual std::vector<std::string> kept() const { return {}; }
  /// Whose coordinates the states had before they were read.
  virtual crosscheck::CoordinateConvention convention() const = 0;
  virtual double fraction() const = 0;  ///< of them that are past; negative: nobody knows
};

/** @param start  what is not given is what this state says
    @throws scene::InputError  a file, an option or a seed has no such states (also from next()) */
std::unique_ptr<States> statesOf(const StatesAsked& asked, const scene::Scene& scene,
                                 const std::function<scene::State<double>()>& start);

/** A kept column that the answer has, too, becomes "given.NAME": the reactions that `simulate`
    wrote beside those that are asked for.
    @param all  the first `kept` are the file's
    @throws scene::InputError  the file has a "given.NAME", too */
void setApart(const std::string& file, std::size_t kept, std::vector<std::string>* all);

}  // namespace dynwitness::cli
