// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/near_motion_in.hpp"

namespace dynwitness::crosscheck::hamilton {

template class Near<RunningError>;

}  // namespace dynwitness::crosscheck::hamilton
