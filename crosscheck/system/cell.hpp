// SPDX-License-Identifier: GPL-3.0-or-later
// A cell: what somebody else's programs may see of this machine, as far as that can be had without
// privileges.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

struct Cell {
  std::vector<std::filesystem::path> hidden;  ///< seen empty: folders, and files
  std::vector<std::string> environment;       ///< variables that stay, beside HOME and TMPDIR
  double gigabytes = 0.1;                     ///< of files that may be written
  int processes = 256;                        ///< and threads, at a time
};

/** Why this machine cannot hide anything; empty: it can. Then work in a cell (namespaces(7) of
    users, mounts, processes, networks and messages)

        sees the folders that are hidden, /tmp, /var/tmp, /dev/shm and /run as empty,
        cannot write but in its own folder, /tmp, /var/tmp and /dev/shm, which go with it,
        sees no process but its own, of which there are no more than so many (root: than 300 or
        so, by Linux 6.14; no limit before), and none of them stays behind,
        has no network. */
std::string whyNothingIsHidden();

/** Runs work in a copy of this process, in a cell with a folder of its own, which is its HOME,
    TMPDIR and working directory.

    What is started in it has the environment that the cell names, and no powers that a program can
    be given by its file.

    @param hides  hide what is to be hidden; otherwise folder and environment are all that is
                  different
    @param work   is given the folder; what it returns comes back
    @throws std::runtime_error  what it threw, how the copy ended, or why there is no cell */
std::string inCell(const Cell& cell, bool hides,
                   const std::function<std::string(const std::filesystem::path& folder)>& work);

/// Ends all that was started in a cell that hides: for the work in it, which is the first process
/// there. Elsewhere nothing.
void endAllInCell();

}  // namespace dynwitness::crosscheck
