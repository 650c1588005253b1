// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/uncertain_answers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/witnesses/certain_digits.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

double certain(const EvaluatedColumn& column, Answer answer) {
  if (!column.rows.empty()) {
    answer.value = answer.value(column.rows, Eigen::all).eval();
    answer.bound = answer.bound(column.rows, Eigen::all).eval();
  }
  return certainDigits(answer);
}

}  // namespace

UncertainAnswers::UncertainAnswers(const scene::Scene& scene,
                                   const std::vector<EvaluatedColumn>& columns)
    : scene_(scene.name), of_(columns.size()) {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const EvaluatedColumn& column = columns[k];
    if (!column.witness || column.is_engines) continue;
    const std::string& name = column.witness->name();
    of_[k].estimated = estimatedSweep(name, column.quantity, scene.mechanism, false);
    if (!of_[k].estimated)
      of_[k].estimated = estimatedKernel(*column.witness, column.quantity, scene.mechanism);
    if (of_[k].estimated)
      of_[k].estimated_single = estimatedSweep(name, column.quantity, scene.mechanism, true);
    else
      of_[k].bounded_single = sweepInSinglePrecision(name, scene.mechanism);
  }
}

void UncertainAnswers::see(std::size_t at, const EvaluatedColumn& column,
                           const scene::State<double>& state, long row) {
  Asked& asked = of_[at];
  if (asked.estimated) {
    asked.seen.count(asked.estimated(state).digits, row);
    if (asked.estimated_single) asked.single.count(asked.estimated_single(state).digits, row);
    return;
  }
  asked.seen.count(certain(column, column.witness->answer(column.quantity, state)), row);
  if (asked.bounded_single)
    asked.single.count(certain(column, asked.bounded_single(column.quantity, state)), row);
}

void UncertainAnswers::tell(const std::vector<EvaluatedColumn>& columns, long rows) const {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (!columns[k].witness || columns[k].is_engines) continue;
    const std::string who =
        fmt::format("{}: {} by {}", scene_, columns[k].name, columns[k].witness->name());
    const Asked& asked = of_[k];
    const char* how = asked.estimated ? "left by estimate" : "certain";
    tellOf(who, how, asked.seen, rows);
    if (asked.estimated_single || asked.bounded_single)
      tellOf(who + " in single precision", how, asked.single, rows);
  }
}

void UncertainAnswers::Seen::count(double left, long at) {
  if (left > kFewestDigits) return;
  ++states;
  if (!(left >= digits)) digits = left, row = at;
}

void UncertainAnswers::tellOf(const std::string& who, const char* how, const Seen& seen,
                              long rows) {
  if (seen.states == 0)
    cli::tell(
        fmt::format("{}: more than {} digits of the largest entry are {} at each of {} states\n",
                    who, kFewestDigits, how, rows));
  else
    cli::tell(fmt::format(
        "{}: at {} of {} states no more than {} digits of the largest entry are "
        "{}, the fewest {:.1f} (state {}): rounding may have made the "
        "others\n",
        who, seen.states, rows, kFewestDigits, how, std::max(0.0, seen.digits), seen.row));
}

void requireBound(const EvaluatedColumn& column) {
  if (column.witness && !column.is_engines && column.along == Along::kNothing) return;
  throw scene::InputError(
      {}, fmt::format(
              "--warn with {}{}, which comes without estimate or bound, allowed: what our sweeps "
              "answer of the tree (M, c, g, tau, qdd, kinetic, potential, momentum, reactions)",
              column.name, column.is_engines ? " of a program" : ""));
}

}  // namespace dynwitness::cli
