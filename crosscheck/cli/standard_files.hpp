// SPDX-License-Identifier: GPL-3.0-or-later
// Standard input, output and error, which may be closed, full, or gone in the middle.
#pragma once

#include <string_view>

namespace dynwitness::cli {

/// Takes the numbers 0, 1 and 2 where they are free, so that no file that is opened gets them and
/// is written to by mistake. To read from or write to such a one still fails.
void occupyStandardFiles();

/// Writes a remark to standard error, unless --quiet was asked for. What cannot be written there is
/// lost, which the status tells in the end (requireOutputWritten): no reason to give up the work.
void tell(std::string_view text) noexcept;
/// The same of a failure, which is told in any case.
void tellFailure(std::string_view text) noexcept;

/// @throws std::runtime_error  standard output or error could not be written: what was printed or
///                             told has not arrived. Standard error that was closed from the start
///                             is nobody's wish to hear.
void requireOutputWritten();

}  // namespace dynwitness::cli
