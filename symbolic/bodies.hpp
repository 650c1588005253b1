// SPDX-License-Identifier: GPL-3.0-or-later
// A mechanism as a tree of bodies: what energies are formed of.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "scene/mimic.hpp"
#include "symbolic/frames.hpp"
#include "symbolic/joints.hpp"
#include "symbolic/mass_moments.hpp"
#include "symbolic/numbers.hpp"
#include "symbolic/options.hpp"

namespace dynwitness::symbolic {

/** A body is a link that moves on its parent, with all that is fixed to it. Its frame is the joint
    frame after the joint's motion, turned (by a constant) so that the joint's axis is a coordinate
    axis: everything constant lies between one joint's motion and the next. */
struct Body {
  std::string name;
  int parent;         ///< body, -1: the world
  FrameSteps before;  ///< parent body's frame to this body's frame at q = 0
  Joint joint;
  MassMoments moments;
};

/// A rotor geared to all rates of a joint (scene::Rotor), by psi' = sum of ratio_k qd_k.
struct GearedRotor {
  int body;  ///< the joint's last, in whose share of T it is
  int rate;  ///< the joint's first
  std::vector<Value> ratio;
  Value inertia;
  int carrier;   ///< body that feels its spin; -1: nobody
  Vector3 axis;  ///< of length 1, in the carrier's axes
};

/// Where the frame of a scene's link stands.
struct LinkFrame {
  int body;           ///< -1: the world
  FrameSteps offset;  ///< body's frame to the link's
};

/// The bodies of a mechanism, parents before their children, with nodes of one graph for all
/// numbers.
class BodyTree {
 public:
  BodyTree(const scene::Mechanism& mechanism, const Options& options, Graph* graph);

  const scene::Mechanism& mechanism() const { return mechanism_; }
  Graph* graph() const { return graph_; }
  NodeNumbers& number() { return number_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<GearedRotor>& rotors() const { return rotors_; }
  int size() const { return static_cast<int>(bodies_.size()); }
  int slots() const { return slots_; }
  const LinkFrame& frame(int link) const { return frames_[link]; }
  const MassMoments& world() const { return world_; }  ///< what is fixed to the world
  const Vector3& gravity() const { return gravity_; }

 private:
  void addBodies(const scene::Link& link, LinkFrame* frame);
  void addRotors(const scene::Joint& joint, const LinkFrame& frame);
  MassMoments& momentsOf(int body) { return body < 0 ? world_ : bodies_[body].moments; }
  void regroup();

  const scene::Mechanism& mechanism_;
  Graph* graph_;
  NodeNumbers number_;
  std::vector<Body> bodies_;
  std::vector<GearedRotor> rotors_;
  std::vector<scene::Follower> followers_;
  std::size_t next_follower_ = 0;
  int rates_ = 0, slots_ = 0;  ///< of the bodies so far
  std::vector<LinkFrame> frames_;
  MassMoments world_;
  Vector3 gravity_;
};

/// psi' of a rotor.
Value rotorRate(Graph* graph, const GearedRotor& rotor);

/// X_i of each rate. A leader's rate moves its followers too.
std::vector<Direction> directions(const BodyTree& tree);

/// The next revolute joint inboard, if it turns about the same direction as this one; else -1.
int parallelInboard(const BodyTree& tree, int body);

}  // namespace dynwitness::symbolic
