// SPDX-License-Identifier: GPL-3.0-or-later
// Our sweeps as what growth() measures: in double alone, nothing kept that a call does not need.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

inline constexpr const char* kFastMethod = "fast";
inline constexpr const char* kTextbookMethod = "textbook";

/// One method made ready for one mechanism; its calls at one state are what is timed.
class GrowthMethod {
 public:
  virtual ~GrowthMethod() = default;
  virtual bool knowsInverse() const { return true; }
  virtual bool knowsForward() const { return true; }
  /// The caller's arrays: what they take is not counted as the method's.
  virtual void set(const scene::State<double>& state) = 0;
  virtual void inverseDynamics() = 0;  ///< cosines and sines of the joints included
  virtual void forwardDynamics() = 0;
  virtual const Eigen::MatrixXd& result() const = 0;  ///< of the last call: tau or qdd
};

std::unique_ptr<GrowthMethod> fastForGrowth(const scene::Mechanism& mechanism);
std::unique_ptr<GrowthMethod> textbookForGrowth(const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
