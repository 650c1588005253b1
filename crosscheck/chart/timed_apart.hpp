// SPDX-License-Identifier: GPL-3.0-or-later
// Methods whose time is not that of one call of run().
#pragma once

#include <optional>

#include "crosscheck/chart/methods.hpp"
#include "crosscheck/chart/raw_engines.hpp"

namespace dynwitness::crosscheck {

/// Timed over several states at once, or by other calls than those that give the answer.
class TimedApart : public Method {
 public:
  using Method::Method;
  /// What is timed in place of run(): states first to last - 1.
  virtual void runAll(int first, int last) = 0;
};

inline constexpr const char* kFastMethod = "fast sweeps";
inline constexpr const char* kLanesMethod = "the kernel in lanes";
/// Behind the name of an engine whose conversions and copies are in its time.
inline constexpr const char* kByItsWitness = " (by its witness)";

/// The sweeps that are made for speed (recursive/fast/).
std::unique_ptr<Method> fastMethod(Quantity quantity, const scene::Mechanism& mechanism,
                                   const States& states);

/// The scene's own code for all states of a batch in one call.
/// @param kernel  of kernelMethod(), whose code it shares
std::unique_ptr<Method> lanesMethod(const Method& kernel, const States& states, int batches);

/// Of so many batches of states, the first state of the b-th; of b = batches, how many states there
/// are.
inline int firstOfBatch(int states, int batches, int b) {
  return static_cast<int>(static_cast<long>(states) * b / batches);
}

/// An outside engine: answers behind the interface of witnesses, timed by its own calls.
std::unique_ptr<Method> rawEngineMethod(std::unique_ptr<Witness> witness, Quantity quantity,
                                        const States& states, RawCalls raw);

}  // namespace dynwitness::crosscheck
