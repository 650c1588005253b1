// SPDX-License-Identifier: Apache-2.0
// What is asked of many states, shared out to the processor's cores.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <type_traits>
#include <vector>

#include "recursive/fast/strided.hpp"

namespace dynwitness::recursive::fast {

/** ManyStates, ManyDerivatives or ManySteps, an object a thread; states in as many parts, equal up
    to a vector, whose answers do not depend on how many there are:

        AllCores<ManyStates> arms(model);
        arms.ask(&ManyStates::inverseDynamics, states, q, qd, qdd, tau);

    A call starts threads, which allocate, and waits for them; else only `Many` may allocate. */
template <typename Many>
class AllCores {
 public:
  /// @param threads  0: as many as the machine has cores
  explicit AllCores(const Model<double>& model, int threads = 0, int width = widestVectors()) {
    if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    parts_.reserve(static_cast<std::size_t>(threads));
    for (int k = 0; k < threads; ++k) parts_.emplace_back(model, width);
    running_.reserve(static_cast<std::size_t>(threads));
  }

  int threads() const { return static_cast<int>(parts_.size()); }

  /// Asks a member function, whose first argument is the number of states, with the same others;
  /// arrays (Strided) begin where a part does. A part that no thread is to be had for is done here.
  /// @throws  what the first part that failed has thrown, when all have ended
  template <typename... Parameters>
  void ask(void (Many::*question)(std::size_t, Parameters...), std::size_t states,
           const std::common_type_t<Parameters>&... arguments) {
    // whole vectors, so that only the last part has lanes to spare
    const auto width = static_cast<std::size_t>(parts_[0].width());
    const std::size_t vectors = (states + width - 1) / width, parts = parts_.size();
    const auto begin = [&](std::size_t k) { return std::min(states, vectors * k / parts * width); };
    failed_.assign(parts, nullptr);
    const auto part = [&](std::size_t k) noexcept {
      const std::size_t first = begin(k), count = begin(k + 1) - first;
      if (count == 0) return;
      try {
        (parts_[k].*question)(count, from(first, arguments)...);
      } catch (...) {
        failed_[k] = std::current_exception();
      }
    };
    for (std::size_t k = 1; k < parts; ++k) {
      if (begin(k + 1) == begin(k)) continue;
      try {
        running_.emplace_back(part, k);
      } catch (const std::exception&) {
        part(k);
      }
    }
    part(0);
    for (std::thread& thread : running_) thread.join();
    running_.clear();
    for (const std::exception_ptr& failed : failed_)
      if (failed) std::rethrow_exception(failed);
  }

 private:
  template <typename T>
  static Strided<T> from(std::size_t first, const Strided<T>& array) {
    return {array.at + static_cast<std::ptrdiff_t>(first) * array.state, array.state, array.number};
  }
  template <typename T>
  static T from(std::size_t /*first*/, const T& same_for_all) {
    return same_for_all;
  }

  std::vector<Many> parts_;
  std::vector<std::thread> running_;
  std::vector<std::exception_ptr> failed_;
};

}  // namespace dynwitness::recursive::fast
