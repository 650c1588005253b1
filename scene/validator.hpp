// SPDX-License-Identifier: GPL-3.0-or-later
// Decides whether a scene is possible. For scene/validation*.cpp alone, which hold its members:
// validation.cpp what is asked first and last, the others bodies, joints, which joints move
// inertia, and the rational frames in which all of it is decided.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/function_values.hpp"
#include "scene/inertia_need.hpp"
#include "scene/rational_geometry.hpp"
#include "scene/scene.hpp"

namespace dynwitness::scene::validation {

using scene::operator*;  // which Frame's own would hide

/// A frame seen from another one: x = R x' + p.
struct Frame {
  RationalMatrix R = identity();
  RationalVector p{0, 0, 0};
};

Frame operator*(const Frame& a, const Frame& b);

/// Inertia of one link about its centre of mass, and what it was computed from.
struct Body {
  Rational mass;
  RationalVector com;
  RationalMatrix inertia;
  bool is_exact;       ///< no rounding in it
  const Vector* turn;  ///< from the axes that it is given in to the link's; null: these
};

/// A motion of a joint's link: velocity of the joint frame's origin, and angular velocity.
struct Twist {
  RationalVector v, w;
};

class Validator {
 public:
  explicit Validator(const Scene& scene)
      : scene_(scene), mechanism_(scene.mechanism), file_{scene.file.string(), 0} {}

  void run(InertiaNeed need);
  std::vector<std::string> impossibleInertias();

  void requireInertiaFor(const std::string& asked);

 private:
  [[noreturn]] static void failLink(const Link& link, const std::string& what) {
    throw InputError(link.where, "link \"" + link.name + "\": " + what);
  }
  [[noreturn]] static void failJoint(const Link& link, const std::string& what) {
    throw InputError(link.where,
                     "joint \"" + link.joint.name + "\" of link \"" + link.name + "\": " + what);
  }

  Rational value(const Number& n);
  RationalVector vector(const Vector& v) { return {value(v[0]), value(v[1]), value(v[2])}; }

  void findParameters();
  void requireTree();
  void requireValues() const;
  void requireBodies();
  void requireJoint(const Link& link);
  void requireRotors(const Link& link);
  void requireCarriers();
  void requireStart() const;
  void requireInertiaOutboard(const std::string& asked);
  void requireEnds(const std::string& what, int a, int b, const SourceLocation& where) const;
  void requireSpring(const Spring& spring) const;

  Rational shortened(const Rational& x);
  Frame shortened(Frame f);
  Frame frame(const std::vector<Step>& steps);
  RationalMatrix turn(const Step& step);
  RationalVector turned(const std::vector<Step>& steps, RationalVector v);  ///< frame(steps).R v
  RationalMatrix turnOf(const Vector& rpy);
  Body body(const Link& link);
  const Body& inLinkAxes(std::size_t i);
  std::string impossible(const Link& link, const RationalMatrix& given, const RationalMatrix& R,
                         const Rational& allowance);
  double sizeOfRobot();
  Rational slack(const Rational& scale) const;
  std::vector<Twist> motionsOf(const Joint& joint);
  bool surelyMovesInertia(std::size_t leaf);
  bool movesInertia(std::size_t leaf);

  const Scene& scene_;
  const Mechanism& mechanism_;
  SourceLocation file_;
  ParameterValues values_;
  ParameterErrors parameter_errors_;  ///< of those that have rounded functions in them
  std::vector<Body> bodies_;
  std::vector<int> first_child_, next_child_;  ///< of each link; -1: none
  std::vector<int> carriers_;  ///< of each link the link that moves it; 0, the root: none does
  std::vector<std::pair<const Link*, std::string>> complaints_;  ///< about inertias
  std::optional<double> size_;
  bool is_exact_ = true;  ///< no rounding in the decision that is being made
};

}  // namespace dynwitness::scene::validation
