// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook's derivatives with each rounding weighed by what it does.
#include "crosscheck/witnesses/textbook_derivatives.hpp"

namespace dynwitness::crosscheck {

template class TextbookDerivatives<AdjointError>;

}  // namespace dynwitness::crosscheck
