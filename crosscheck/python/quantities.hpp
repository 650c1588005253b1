// SPDX-License-Identifier: GPL-3.0-or-later
// The quantities of a scene on plain arrays of doubles, state by state: what the Python module
// binds.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::python {

/** A scene, made ready once. It does not change and may be used from several threads at once, each
    with a Room of its own.

    Arrays of q have positions() numbers, those of qd, qdd and tau dof(); matrices are written row
    by row; SI units, and rates of spherical and floating joints as everywhere in dynwitness. */
class Quantities {
 public:
  explicit Quantities(scene::Scene scene);
  ~Quantities();
  Quantities(const Quantities&) = delete;
  Quantities& operator=(const Quantities&) = delete;

  const scene::Scene& scene() const { return scene_; }
  int dof() const;
  int positions() const;
  int parameters() const;  ///< columns of the regressor
  /// "upper.Ixx [kg m^2]": of each column of the regressor
  std::vector<std::string> parameterNames() const;
  /// The scene's link of this name. @throws std::invalid_argument  there is none: who there is
  std::size_t link(const std::string& name) const;
  /// Why tau and qdd of the tree alone are not the mechanism's; empty: they are.
  std::string notOfTheTree() const;

  /// What one thread writes on.
  class Room;

  void massMatrix(const double* q, double* M, Room& room) const;
  void coriolis(const double* q, const double* qd, double* c, Room& room) const;
  void gravity(const double* q, double* g, Room& room) const;
  void inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau,
                       Room& room) const;
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd,
                       Room& room) const;
  double kinetic(const double* q, const double* qd, Room& room) const;
  double potential(const double* q, Room& room) const;
  /// Force first: linear momentum, then angular about the world's origin.
  void momentum(const double* q, const double* qd, double* p, Room& room) const;
  /// 6 numbers a link but the first.
  void reactions(const double* q, const double* qd, const double* qdd, double* wrenches,
                 Room& room) const;
  void regressor(const double* q, const double* qd, const double* qdd, double* Y, Room& room) const;
  /// n x n each
  void inverseDerivatives(const double* q, const double* qd, const double* qdd, double* by_q,
                          double* by_qd, Room& room) const;
  void forwardDerivatives(const double* q, const double* qd, const double* tau, double* by_q,
                          double* by_qd, double* by_tau, Room& room) const;
  /// Of a point at `at` in the link's axes: place (3), turn (3 x 3), J (6 x n), dJ/dt (6 x n).
  struct OfPoint {
    double *position, *rotation, *jacobian, *jacobian_rate;
  };
  void point(std::size_t link, const std::array<double, 3>& at, const double* q, const double* qd,
             const OfPoint& out, Room& room) const;

  /// Rows of many states: state k's starts at from[k * apart]; apart 0: the same for all.
  struct Rows {
    const double* from;
    std::ptrdiff_t apart;
  };
  /// Many states by the sweeps, in the processor's lanes; answers stand one after the other. Each
  /// has the bits of one asked alone.
  void massMatrices(Rows q, double* M, long count) const;
  void inverseDynamicsOfMany(Rows q, Rows qd, Rows qdd, double* tau, long count) const;
  void forwardDynamicsOfMany(Rows q, Rows qd, Rows tau, double* qdd, long count) const;

  /** The scene's kernel, compiled when it is first asked for and kept on disk.
      @return  whether there is one: a C compiler, and a straight line worth having. All threads
               must ask before one computes (Python's lock sees to it). */
  bool hasKernel(bool forward) const;
  /// Many states, each array row by row (count x n), in the lanes of the kernel.
  void inverseDynamicsInLanes(const double* q, const double* qd, const double* qdd, double* tau,
                              long count) const;
  void forwardDynamicsInLanes(const double* q, const double* qd, const double* tau, double* qdd,
                              long count) const;

 private:
  struct Parts;
  scene::Scene scene_;
  std::unique_ptr<Parts> parts_;
};

class Quantities::Room {
 public:
  explicit Room(const Quantities& quantities);
  ~Room();
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

 private:
  friend class Quantities;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::python
