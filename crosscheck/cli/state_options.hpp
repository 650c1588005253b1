// SPDX-License-Identifier: GPL-3.0-or-later
// The state that a command is asked at: --q, --qd, --qdd, --tau, the same in every command.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "scene/scene.hpp"

namespace dynwitness::cli {

/// A number of an option: an expression in the scene's parameters and pi.
/// @throws scene::InputError  it is none, or not finite
double numberIn(const std::string& option, const std::string& text, const scene::Scene& scene);

/// What an option calls a position or a rate: by place ("q3") or by joint ("elbow", "joint.turn").
struct NamedPlace {
  std::string name;
  int at;
};
/// PREFIX1, PREFIX2, ... and these names, "" where there is none.
std::vector<NamedPlace> placesNamed(const std::string& prefix,
                                    const std::vector<std::string>& names);
/// Of positions that are given (followers have none), in their order.
std::vector<std::string> positionNames(const scene::Mechanism& mechanism);
/// The place that is meant.
/// @throws scene::InputError  nothing or more than one has that name
int placeMeant(const std::string& option, const std::string& name,
               const std::vector<NamedPlace>& places);

/** One of these options. Its numbers are expressions in the scene's parameters and pi, all of them
    in the order of `dynwitness show`, or some by name:

        --q 0.3,pi/2          --q elbow=0.3           --q q4=1,q5=0

    by that of the joint ("joint.turn" where it has several rates) or by place. Those that are not
    named are what they would be without the option. */
class StateOption {
 public:
  enum class Part { kQ, kQd, kQdd, kTau };

  /// @param otherwise  what stands there without the option, for --help
  StateOption(CLI::App* command, Part part, const std::string& otherwise);

  bool isGiven() const { return !words_->empty(); }
  /** One number a position slot (of q, those of followers from their leaders) or degree of freedom:
      what is given, and otherwise these. An angle of more than a turn is remarked on.
      @throws scene::InputError  other counts, names and numbers */
  std::vector<double> values(const scene::Scene& scene, const std::vector<double>& otherwise) const;

 private:
  /// Of q, followers where their leaders put them.
  std::vector<double> positions(const scene::Scene& scene,
                                const std::vector<double>& otherwise) const;
  /// The same of what may be given.
  std::vector<double> told(const scene::Scene& scene, const std::vector<double>& otherwise) const;

  Part part_;
  std::shared_ptr<std::vector<std::string>> words_;
};

}  // namespace dynwitness::cli
