// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook's derivatives in double and on running error bounds.
#include "crosscheck/witnesses/textbook_derivatives.hpp"

namespace dynwitness::crosscheck {

template class TextbookDerivatives<double>;
template class TextbookDerivatives<RunningError>;

}  // namespace dynwitness::crosscheck
