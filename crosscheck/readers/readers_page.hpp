// SPDX-License-Identifier: GPL-3.0-or-later
// What readers made of a file, as a page.
#pragma once

#include <string>

#include "crosscheck/readers/compare.hpp"
#include "crosscheck/system/environment.hpp"

namespace dynwitness::crosscheck {

/// @param picture  a file beside it (readersPicture); empty: there is none
std::string readersPage(const ReadersResult& result, const Environment& environment,
                        const std::string& picture = "");

/** The file's robot, as one page: each moving body's inertia, with all that is fixed to it, as
    written; and as engines have read it, where that is another.
    @throws InputError  what moves cannot be drawn */
std::string readersPicture(const std::string& text, const std::filesystem::path& file,
                           const ReadersResult& result, const std::string& version);

}  // namespace dynwitness::crosscheck
