// SPDX-License-Identifier: Apache-2.0
// A scene as engines that are built joint by joint like it: moving bodies alone, each in the frame
// of its moved joint, links that are fixed folded into them as pieces; and the joint forces that
// such engines leave to their user. Needs Eigen.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "dynwitness_engine.hpp"

namespace dynwitness_engine {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

struct Frame {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
  Frame operator*(const Frame& inner) const { return {R * inner.R, p + R * inner.p}; }
};

inline Vector3 vector3(const Json& from) {
  return {from[0].number(), from[1].number(), from[2].number()};
}
inline Matrix3 matrix3(const Json& from) {
  Matrix3 out;
  for (int i = 0; i < 3; ++i) out.row(i) = vector3(from[static_cast<std::size_t>(i)]);
  return out;
}
inline Frame frame(const Json& from) {
  return {matrix3(from["R"]), vector3(from["p"])};
}

/// Masses that move together: com and inertia (about com) in the axes of the moved joint.
struct Piece {
  double mass;
  Vector3 com;
  Matrix3 inertia;
};

/// revolute, prismatic, helical, spherical or floating; cylindrical, universal and planar joints
/// are chains of the first two, with bodies of no mass between.
struct MovingBody {
  std::string name, kind;
  int parent = -1;  ///< among the moving bodies; -1: the world
  Frame placement;  ///< of the joint in the parent's frame
  Vector3 axis = Vector3::UnitZ();
  double pitch = 0;                                        ///< [m/rad]
  int q = 0, qd = 0, positions = 1, rates = 1;             ///< where in the scene's order
  double rotor = 0, viscous = 0, stiffness = 0, rest = 0;  ///< rotor: gear_ratio^2 inertia
  double coulomb[2] = {0, 0};
  std::vector<Piece> pieces;
};

struct MovingBodies {
  std::vector<MovingBody> bodies;
  std::vector<Piece> resting;  ///< in the world
  Vector3 gravity;
  int positions, dof;

  /// @throws std::runtime_error  what cannot be said in this way
  explicit MovingBodies(const Json& scene)
      : gravity(vector3(scene["gravity"])),
        positions(static_cast<int>(scene["positions"].number())),
        dof(static_cast<int>(scene["dof"].number())) {
    if (scene["wrenches"].size() > 0) throw std::runtime_error("constant wrenches");
    struct Place {
      int body;
      Frame link;  // in that body's frame
    };
    std::vector<Place> places;
    for (std::size_t i = 0; i < scene["links"].size(); ++i) {
      const Json& link = scene["links"][i];
      const auto parent = static_cast<std::ptrdiff_t>(link["parent"].number());
      Place here = parent < 0 ? Place{-1, {}} : places[static_cast<std::size_t>(parent)];
      if (parent >= 0) {
        const Json& joint = link["joint"];
        here.link = here.link * frame(joint["before"]);
        if (joint["rates"].number() > 0) {
          here.body = added(joint, here.body, here.link);
          here.link = Frame();
        }
        here.link = here.link * frame(joint["after"]);
      }
      places.push_back(here);
      const Frame& X = here.link;
      const Piece piece{link["mass"].number(), X.p + X.R * vector3(link["com"]),
                        X.R * matrix3(link["inertia"]) * X.R.transpose()};
      if (piece.mass == 0 && piece.inertia.isZero(0)) continue;
      (here.body < 0 ? resting : bodies[static_cast<std::size_t>(here.body)].pieces)
          .push_back(piece);
    }
  }

  /// Of masses that rest: V is counted from the world's origin.
  double restingPotential() const {
    double V = 0;
    for (const Piece& piece : resting) V -= piece.mass * gravity.dot(piece.com);
    return V;
  }
  bool hasRotors() const {
    for (const MovingBody& body : bodies)
      if (body.rotor != 0) return true;
    return false;
  }

  // ---- forces that engines leave to their user; x: q, v: qd
  double springEnergy(const Vector& x) const {
    double V = 0;
    for (const MovingBody& b : bodies) V += b.stiffness * square(x[at(b.q)] - b.rest) / 2;
    return V;
  }
  template <typename Force>
  void addSprings(const Vector& x, Force* g) const {
    for (const MovingBody& b : bodies)
      if (b.stiffness != 0) (*g)[b.qd] += b.stiffness * (x[at(b.q)] - b.rest);
  }
  template <typename Force>
  void addFriction(const Vector& v, Force* tau) const {
    for (const MovingBody& b : bodies)
      if (b.rates == 1)
        (*tau)[b.qd] += b.viscous * v[at(b.qd)] + (v[at(b.qd)] > 0   ? b.coulomb[0]
                                                   : v[at(b.qd)] < 0 ? -b.coulomb[1]
                                                                     : 0);
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static double square(double x) { return x * x; }

  /// The bodies of one joint. @return  the outermost
  int added(const Json& joint, int parent, const Frame& placement) {
    MovingBody body;
    body.name = joint["name"].text();
    body.kind = joint["kind"].text();
    body.parent = parent;
    body.placement = placement;
    if (joint.has("axis")) body.axis = vector3(joint["axis"]);
    if (joint.has("pitch")) body.pitch = joint["pitch"].number();
    body.q = static_cast<int>(joint["q"].number());
    body.qd = static_cast<int>(joint["qd"].number());
    const double ratio = joint["gear_ratio"].number();
    body.rotor = ratio * ratio * joint["rotor_inertia"].number();
    if (joint["gyroscopic"].number() != 0)
      throw std::runtime_error("joint '" + body.name + "': gyroscopic rotors");
    body.viscous = joint["viscous"].number();
    for (std::size_t k : {0, 1}) body.coulomb[k] = joint["coulomb"][k].number();
    body.stiffness = joint["stiffness"].number();
    body.rest = joint["rest"].number();
    body.positions = static_cast<int>(joint["positions"].number());
    body.rates = static_cast<int>(joint["rates"].number());

    using Chain = std::vector<std::pair<const char*, Vector3>>;
    Chain chain;
    if (body.kind == "cylindrical") chain = {{"prismatic", body.axis}, {"revolute", body.axis}};
    if (body.kind == "universal")
      chain = {{"revolute", Vector3::UnitX()}, {"revolute", Vector3::UnitY()}};
    if (body.kind == "planar") {
      if (body.axis != Vector3::UnitZ())
        throw std::runtime_error("joint '" + body.name + "': planar about another axis than z");
      chain = {{"prismatic", Vector3::UnitX()},
               {"prismatic", Vector3::UnitY()},
               {"revolute", Vector3::UnitZ()}};
    }
    if (chain.empty()) {
      bodies.push_back(body);
      return static_cast<int>(bodies.size()) - 1;
    }
    const std::string name = body.name;
    body.positions = body.rates = 1;
    for (const auto& [kind, axis] : chain) {
      body.kind = kind;
      body.axis = axis;
      body.name = name + "." + std::to_string(bodies.size());
      bodies.push_back(body);
      body.parent = static_cast<int>(bodies.size()) - 1;
      body.placement = Frame();
      ++body.q;
      ++body.qd;
    }
    return body.parent;
  }
};

}  // namespace dynwitness_engine
