// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas as we write them in plain text, set for the page.
#pragma once

#include <string>
#include <string_view>

namespace dynwitness::crosscheck {

/** MathML of a formula in plain text.

    Read are: names with subscripts (m_i6, P_(i+1), M_A,1, r_i,i+1), time derivatives (qd, qdd, Xd,
    vd: a letter and d or dd), Jbar (a letter and a bar), second derivatives (d2L/dt2), Greek
    letters by name, one raised index (Gamma^i_jk), w for omega, T_F and T_V with their letter
    raised, ' for the transpose, powers (^-1, ^2, ^T), hat(...), fractions left as a/b, the cross
    product (an x between two operands) and its dual x*, matrices [a, b; c, d], sum, int, and
    relations. What is none of these is shown upright as it stands, so that words may stand in a
    formula. */
std::string mathMl(std::string_view formula);

/// Text in which formulas stand between backticks, escaped for HTML.
std::string textWithMath(std::string_view text);

}  // namespace dynwitness::crosscheck
