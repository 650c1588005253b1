// SPDX-License-Identifier: GPL-3.0-or-later
// Independent tasks in several processes: GiNaC is not made for threads, and neither are all
// engines.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/// Processors that this process may run on.
int availableProcessors();

/** work(0), ..., work(count - 1), each in one of several copies of this process, which take the
    next index when they are done with one. What a task changes in memory is lost with its copy;
    what it returns comes back. One process: the tasks run here, in order.

    @param processes  at least 1
    @param done       called here as answers come in, in any order, with the index; may be empty
    @return           what the tasks returned, by index
    @throws scene::InputError   what a task threw
    @throws std::runtime_error  the message of anything else that a task threw, or which task a copy
                                was at when it died. The other copies are stopped then, and when
                                this process ends by a signal, KILL too. */
std::vector<std::string> inProcesses(int processes, int count,
                                     const std::function<std::string(int)>& work,
                                     const std::function<void(int)>& done = {});

/// How one of several copies ended.
struct CopyEnded {
  std::string answer;   ///< what its task returned
  std::string problem;  ///< not empty: why there is none
};

/** work(0), ..., work(count - 1), each in a copy of this process that does nothing else: what one
    of them does to its process it does to itself alone.

    @param at_a_time  copies, at least 1
    @param seconds    after which a copy is ended
    @param ended      called here as copies end, in any order */
void inOwnCopies(int at_a_time, int count, double seconds,
                 const std::function<std::string(int)>& work,
                 const std::function<void(int, const CopyEnded&)>& ended);

/// A status as of waitpid(), in words: "was ended by a signal (Killed)", "failed with status 1"
std::string howItEnded(int status);

}  // namespace dynwitness::crosscheck
