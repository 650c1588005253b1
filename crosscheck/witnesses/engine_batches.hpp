// SPDX-License-Identifier: GPL-3.0-or-later
// Batches of states as an engine is asked about them, and its answers. They are written and read as
// they are, since a tree of JSON takes longer than most engines. For the protocol of engines
// (engine_*.cpp) alone.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/engine_introduction.hpp"
#include "crosscheck/witnesses/frame_jacobian.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck::engine {

using State = scene::State<double>;

struct Batch {
  const State* first;
  std::size_t count;
  const State* begin() const { return first; }
  const State* end() const { return first + count; }
};

/// How something stands in an answer, and where its entries go.
struct Form {
  enum class Written { kNumber, kList, kRows };
  std::string name;
  Eigen::Index rows = 1, columns = 1;
  Written written = Written::kNumber;
  const std::vector<int>*rows_at = nullptr, *columns_at = nullptr;  ///< none: as they stand
  bool is_row_by_row = false;  ///< a column of ours, the rows one after the other

  bool hasRows() const { return written == Written::kRows; }
  static Eigen::Index placed(const std::vector<int>* at, Eigen::Index i) {
    return at == nullptr ? i : static_cast<Eigen::Index>((*at)[static_cast<std::size_t>(i)]);
  }
  double& entry(Eigen::MatrixXd& value, Eigen::Index i, Eigen::Index j) const {
    return value(placed(rows_at, i), placed(columns_at, j));
  }
  Eigen::MatrixXd ours(Eigen::MatrixXd value) const {
    if (!is_row_by_row) return value;
    return value.reshaped<Eigen::RowMajor>();
  }
};

/// What an engine says, in our order; or why there is no value.
struct Said {
  Eigen::MatrixXd value;
  std::string reason;
};

/// The line that asks it.
/// @param frame  of which the Jacobian is asked; null: of none
std::string question(long batch, const Batch& states, const std::vector<Form>& forms,
                     const Order& order, const FramePoint* frame);

/// The answer to a batch, complete and of the right shapes.
/// @return  all forms of the first state, then of the second, ...
/// @throws std::runtime_error  what was expected, and what came
std::vector<Said> answersIn(const std::string& line, long batch, std::size_t states,
                            const std::vector<Form>& forms);

}  // namespace dynwitness::crosscheck::engine
