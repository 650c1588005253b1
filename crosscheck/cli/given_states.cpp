// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/given_states.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/closed_states.hpp"
#include "scene/error.hpp"

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

/// Those of a file, one after the other.
class StatesOfFile : public States {
 public:
  StatesOfFile(const std::string& file, const scene::Mechanism& mechanism)
      : reader_(file, mechanism) {}
  scene::State<double>* current() override {
    if (!is_read_) has_state_ = reader_.next(&state_);
    is_read_ = true;
    return has_state_ ? &state_ : nullptr;
  }
  void next() override { is_read_ = false; }
  bool mayWait() const override { return reader_.mayWait(); }
  GivenColumns given() const override {
    return {reader_.gives("qd"), reader_.gives("qdd"), reader_.gives("tau")};
  }
  double fraction() const override { return reader_.fraction(); }

 private:
  StatesReader reader_;
  scene::State<double> state_;
  bool is_read_ = false, has_state_ = true;
};

/// One that the command line gives.
class GivenState : public States {
 public:
  GivenState(const StatesAsked& asked, const scene::Scene& scene, scene::State<double> start)
      : state_(givenState(asked, scene, std::move(start))) {
    const bool tau = asked.tau->isGiven(), qdd = asked.qdd->isGiven();
    given_ = {true, qdd, tau || !qdd, !(asked.q->isGiven() || asked.qd->isGiven() || qdd || tau),
              !tau};
  }
  scene::State<double>* current() override { return is_past_ ? nullptr : &state_; }
  void next() override { is_past_ = true; }
  GivenColumns given() const override { return given_; }
  double fraction() const override { return is_past_ ? 1 : 0; }

 private:
  scene::State<double> state_;
  GivenColumns given_;
  bool is_past_ = false;
};

/// Seeded ones: the joints anywhere, and where there are closures, closed.
class RandomStates : public States {
 public:
  RandomStates(const StatesAsked& asked, const scene::Scene& scene)
      : scene_(scene), count_(asked.random), seed_(asked.seed) {
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
  for (const char* name : {"--q", "--qd", "--qdd", "--tau", "--random"})
    command.get_option(name)->excludes("--states");
  for (const char* name : {"--q", "--qd", "--qdd", "--tau"})
    command.get_option(name)->excludes(random);
}

std::unique_ptr<States> statesOf(const StatesAsked& asked, const scene::Scene& scene,
                                 const std::function<scene::State<double>()>& start) {
  if (!asked.file.empty()) return std::make_unique<StatesOfFile>(asked.file, scene.mechanism);
  if (asked.random > 0) return std::make_unique<RandomStates>(asked, scene);
  return std::make_unique<GivenState>(asked, scene, start());
}

}  // namespace dynwitness::cli
