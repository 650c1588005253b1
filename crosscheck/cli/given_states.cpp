// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/given_states.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/closed_states.hpp"
#include "scene/error.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/remarks.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

/// The scene's start, and what --q, --qd, --qdd and --tau say otherwise.
scene::State<double> givenState(const StatesAsked& asked, const scene::Scene& scene,
                                scene::State<double> start) {
  std::vector<double> q;
  for (const scene::JointPosition<double>& x : start.x) q.push_back(x.q);
  q = asked.q->values(scene, q);
  for (std::size_t k = 0; k < q.size(); ++k) start.x[k] = scene::jointPosition(q[k]);
  start.qd = asked.qd->values(scene, start.qd);
  start.qdd = asked.qdd->values(scene, start.qdd);
  start.tau = asked.tau->values(scene, start.tau);
  return start;
}

/// --convention. @return none: not given
std::optional<CoordinateConvention> askedConvention(const StatesAsked& asked) {
  if (asked.convention.empty()) return {};
  return conventionNamed(asked.convention);
}

/// Tells of angles of more than a turn in a file, once a column.
class TurnsOfFile {
 public:
  TurnsOfFile(std::string file, const scene::Mechanism& mechanism) : file_(std::move(file)) {
    const std::vector<scene::SlotKind> slots = mechanism.slots();
    const std::vector<int> given = scene::givenSlots(mechanism);
    for (std::size_t k = 0; k < given.size(); ++k)
      if (slots[static_cast<std::size_t>(given[k])] == scene::SlotKind::kAngle)
        angles_.push_back({static_cast<std::size_t>(given[k]), k + 1});
  }
  void look(const scene::State<double>& state) {
    const auto isTold = [&](const Angle& angle) {
      const std::string turns =
          scene::moreThanATurn(state.x[angle.slot].q, scene::AngleSpelling::kDecimal);
      if (turns.empty()) return false;
      tell(fmt::format("{}: q{} = {}\n", file_, angle.column, turns));
      return true;
    };
    angles_.erase(std::remove_if(angles_.begin(), angles_.end(), isTold), angles_.end());
  }

 private:
  struct Angle {
    std::size_t slot, column;  ///< q1: 1
  };
  std::string file_;
  std::vector<Angle> angles_;  ///< that were not told of
};

/// Those of a file, one after the other.
class StatesOfFile : public States {
 public:
  StatesOfFile(const StatesAsked& asked, const scene::Mechanism& mechanism)
      : reader_(asked.file, mechanism,
                {{}, true, asked.keep, "; or --keep, which keeps others in the answer"},
                askedConvention(asked)),
        turns_(asked.file == "-" ? "standard input" : asked.file, mechanism) {}
  scene::State<double>* current() override {
    if (!is_read_) {
      has_state_ = reader_.next(&state_);
      if (has_state_) turns_.look(state_);
    }
    is_read_ = true;
    return has_state_ ? &state_ : nullptr;
  }
  void next() override { is_read_ = false; }
  bool mayWait() const override { return reader_.mayWait(); }
  GivenColumns given() const override {
    return {reader_.gives("qd"), reader_.gives("qdd"), reader_.gives("tau")};
  }
  std::vector<std::string> keptNames() const override { return reader_.keptNames(); }
  std::vector<std::string> kept() const override { return reader_.kept(); }
  CoordinateConvention convention() const override { return reader_.convention(); }
  double fraction() const override { return reader_.fraction(); }

 private:
  StatesReader reader_;
  TurnsOfFile turns_;
  scene::State<double> state_;
  bool is_read_ = false, has_state_ = true;
};

/// One that the command line gives.
class GivenState : public States {
 public:
  GivenState(const StatesAsked& asked, const scene::Scene& scene, scene::State<double> start)
      : state_(givenState(asked, scene, std::move(start))),
        convention_(askedConvention(asked).value_or(CoordinateConvention::kDynwitness)) {
    const bool tau = asked.tau->isGiven(), qdd = asked.qdd->isGiven();
    given_ = {true, qdd, tau || !qdd, !(asked.q->isGiven() || asked.qd->isGiven() || qdd || tau),
              !tau};
  }
  scene::State<double>* current() override { return is_past_ ? nullptr : &state_; }
  void next() override { is_past_ = true; }
  GivenColumns given() const override { return given_; }
  CoordinateConvention convention() const override { return convention_; }
  double fraction() const override { return is_past_ ? 1 : 0; }

 private:
  scene::State<double> state_;
  CoordinateConvention convention_;
  GivenColumns given_;
  bool is_past_ = false;
};

/// Seeded ones: the joints anywhere, and where there are closures, closed.
class RandomStates : public States {
 public:
  RandomStates(const StatesAsked& asked, const scene::Scene& scene)
      : scene_(scene),
        count_(asked.random),
        seed_(asked.seed),
        convention_(askedConvention(asked).value_or(CoordinateConvention::kDynwitness)) {
    if (!scene.mechanism.closures.empty()) closed_.emplace(prepared_.emplace(scene));
    draw();
  }
  scene::State<double>* current() override { return at_ < count_ ? &state_ : nullptr; }
  void next() override {
    ++at_;
    draw();
  }
  /// Closed, accelerations are no free choice: those that belong to tau are found.
  GivenColumns given() const override { return {true, !closed_, true}; }
  CoordinateConvention convention() const override { return convention_; }
  double fraction() const override { return static_cast<double>(at_) / count_; }

 private:
  void draw() {
    if (at_ >= count_) return;
    if (!closed_) {
      state_ = drawState(scene_.mechanism, scene_.name, seed_, static_cast<std::uint64_t>(at_));
      return;
    }
    const ClosedState drawn = closed_->draw(seed_, at_);
    if (!drawn.failure.empty())
      throw scene::InputError({}, fmt::format("--random: state {} of seed {}: {}; allowed: another "
                                              "--seed, or --states",
                                              at_ + 1, seed_, drawn.failure));
    state_ = drawn.state.state;
  }

  const scene::Scene& scene_;
  int count_, at_ = 0;
  std::uint64_t seed_;
  CoordinateConvention convention_;
  std::optional<PreparedScene> prepared_;
  std::optional<ClosedStates> closed_;
  scene::State<double> state_;
};

}  // namespace

void addStates(CLI::App& command, StatesAsked& asked, const std::string& about_files) {
  command.add_option("--states", asked.file, about_files);
  using Part = StateOption::Part;
  asked.q.emplace(&command, Part::kQ, "the scene's start");
  asked.qd.emplace(&command, Part::kQd, "the scene's start");
  asked.qdd.emplace(&command, Part::kQdd, "found from tau");
  asked.tau.emplace(&command, Part::kTau, "none");
  CLI::Option* random = addRandom(command, asked.random, 1000000000,
                                  "closed where there are closures; the table has them");
  random->default_str("");  // none
  addSeed(command, asked.seed, "of the states")->needs(random);
  CLI::Option* file = command.get_option("--states");
  command
      .add_flag(
          "--keep", asked.keep,
          "Columns of the file that are none of a state's (time, labels) stand in the answer as "
          "they are, before it; without, they are refused")
      ->needs(file);
  addConvention(
      command, asked.convention,
      "order of quaternion, position and velocities, and their axes, in states and in "
      "answers (dynwitness: x, y, z, quaternion w, x, y, z; velocity and angular velocity "
      "in link axes). A file whose first line is \"# convention: NAME\" needs none");
  for (const char* name : {"--q", "--qd", "--qdd", "--tau"})
    command.get_option(name)->excludes("--convention");
  for (const char* name : {"--q", "--qd", "--qdd", "--tau", "--random"})
    command.get_option(name)->excludes("--states");
  for (const char* name : {"--q", "--qd", "--qdd", "--tau"})
    command.get_option(name)->excludes(random);
}

CLI::Option* addConvention(CLI::App& command, std::string& name, const std::string& of_what) {
  return command
      .add_option("--convention", name,
                  "Whose coordinates spherical and floating joints have: " + of_what)
      ->check(oneOf(conventionNames()));
}

void addStart(CLI::App& command, StartAsked& asked) {
  using Part = StateOption::Part;
  asked.q.emplace(&command, Part::kQ, "the scene's start");
  asked.qd.emplace(&command, Part::kQd, "the scene's start");
  CLI::Option* file = command.add_option(
      "--states", asked.file,
      "States, a CSV file: or - for standard input; the motion starts at a row of it, of which q and "
      "qd (without: at rest) count, and other columns do not");
  command.add_option("--row", asked.row, "Which row of --states, from 1")
      ->capture_default_str()
      ->check(whole(1, std::numeric_limits<int>::max()))
      ->needs(file);
  addConvention(command, asked.convention, "in that file (`evaluate --help`)");
  for (const char* name : {"--q", "--qd"}) command.get_option(name)->excludes(file);
}

void requireFileOfConvention(const StartAsked& asked, const std::string& motion) {
  if (!asked.convention.empty() && asked.file.empty() && motion.empty())
    throw scene::InputError({}, "--convention without a file that has it, allowed: with --states");
}

scene::Scene startedAt(scene::Scene scene, const StartAsked& asked) {
  if (!asked.isGiven()) return scene;
  scene::State<double> start;
  if (asked.file.empty()) {
    const scene::RealNumbers<double> number(scene.mechanism);
    const auto values = [&](const std::vector<scene::Number>& of) {
      std::vector<double> out;
      for (const scene::Number& one : of) out.push_back(number(one));
      return out;
    };
    for (const double q : asked.q->values(scene, values(scene.start_q)))
      start.x.push_back(scene::jointPosition(q));
    scene::followLeaders(scene.mechanism, &start.x);
    start.qd = asked.qd->values(scene, values(scene.start_qd));
  } else {
    std::optional<CoordinateConvention> convention;
    if (!asked.convention.empty()) convention = conventionNamed(asked.convention);
    StatesReader reader(asked.file, scene.mechanism, {{}, true, true}, convention);
    for (int row = 1; row <= asked.row; ++row)
      if (!reader.next(&start))
        throw scene::InputError({asked.file, 0}, fmt::format("--row {}: the file has {} rows, "
                                                             "allowed: one of them",
                                                             asked.row, row - 1));
    TurnsOfFile(asked.file, scene.mechanism).look(start);
    if (!reader.gives("qd") && !start.qd.empty())
      tell(fmt::format("{}: no column says qd: the motion starts at rest\n", asked.file));
    std::vector<std::string> unread;
    for (const std::string& name : reader.keptNames())
      if (name != "t" && name != "time_s") unread.push_back(name);
    if (!unread.empty())
      tell(fmt::format("{}: no part of a state, and not read: {}\n", asked.file,
                       fmt::join(unread, ", ")));
  }
  const auto decimal = [](double x) {
    return scene::Number::parse(fmt::format("{}", x == 0 ? 0.0 : x));
  };
  scene.start_q.clear();
  scene.start_qd.clear();
  for (const scene::JointPosition<double>& x : start.x) scene.start_q.push_back(decimal(x.q));
  for (const double qd : start.qd) scene.start_qd.push_back(decimal(qd));
  scene::validate(scene);
  return scene;
}

std::unique_ptr<States> statesOf(const StatesAsked& asked, const scene::Scene& scene,
                                 const std::function<scene::State<double>()>& start) {
  if (!asked.file.empty()) return std::make_unique<StatesOfFile>(asked, scene.mechanism);
  if (asked.random > 0) return std::make_unique<RandomStates>(asked, scene);
  return std::make_unique<GivenState>(asked, scene, start());
}

void setApart(const std::string& file, std::size_t kept, std::vector<std::string>* all) {
  const auto end = all->begin() + static_cast<std::ptrdiff_t>(kept);
  const std::set<std::string> own(all->begin(), end), answers(end, all->end());
  std::vector<std::string> both;
  for (auto name = all->begin(); name != end; ++name) {
    if (answers.count(*name) == 0) continue;
    both.push_back(*name);
    *name = "given." + *name;
    if (own.count(*name) + answers.count(*name) > 0)
      throw scene::InputError({file, 0},
                              fmt::format("--keep: columns '{}' and '{}', and the answer has {}, "
                                          "too, allowed: another name for one in the file",
                                          both.back(), *name, both.back()));
  }
  if (!both.empty())
    tell(fmt::format("{}: kept as given.NAME, since the answer has them, too: {}\n", file,
                     fmt::join(both, ", ")));
}

}  // namespace dynwitness::cli
