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

}  // namespace dynwitness::crosscheck
