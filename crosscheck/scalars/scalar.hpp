// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers that the same computation is run on when its digits and its time are compared.
#pragma once

namespace dynwitness::crosscheck {

enum class Scalar { kFloat, kDouble, kLongDouble, k50Digits, kBalls };

/// "float", "double", "long double", "50 digits", "128-bit balls"
inline const char* name(Scalar scalar) {
  switch (scalar) {
    case Scalar::kFloat:
      return "float";
    case Scalar::kDouble:
      return "double";
    case Scalar::kLongDouble:
      return "long double";
    case Scalar::k50Digits:
      return "50 digits";
    case Scalar::kBalls:
      return "128-bit balls";
  }
  return "?";
}

}  // namespace dynwitness::crosscheck
