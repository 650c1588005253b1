// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/impossible_inertia.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

namespace dynwitness::scene {
namespace {

RationalMatrix sum(const RationalMatrix& a, const RationalMatrix& b, int sign = 1) {
  RationalMatrix out = a;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out[i][j] += sign * b[i][j];
  return out;
}

Eigen::Matrix3d rounded(const RationalMatrix& m) {
  Eigen::Matrix3d out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out(static_cast<int>(i), static_cast<int>(j)) = Exact{m[i][j], 0}.toDouble();
  return out;
}

/// (xx, yy, zz, xy, xz, yz)
std::array<double, 6> six(const Eigen::Matrix3d& I) {
  return {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
}

/// What half a unit of the last printed digit is; nothing for what is no plain decimal. A whole
/// number was not cut off: 0. A bare 0 has no digits: -1.
std::optional<double> halfUnit(const Number& n) {
  const Number& plain = n.kind() == Number::Kind::kNegate ? n.left() : n;
  if (plain.kind() != Number::Kind::kNumber) return {};
  const std::string text = plain.text();
  const std::size_t e = text.find_first_of("eE"), point = text.find('.');
  if (text.find('/') != std::string::npos) return {};
  if (point == std::string::npos && e == std::string::npos) return plain.isLiteralZero() ? -1 : 0;
  const std::size_t end = std::min(e, text.size());
  int exponent = 0;
  try {
    if (e != std::string::npos) exponent = std::stoi(text.substr(e + 1));
  } catch (const std::exception&) {
    return {};
  }
  if (point != std::string::npos) exponent -= static_cast<int>(end - point) - 1;
  return std::pow(10.0, exponent) / 2;
}

/// Whether an inertia that a body has is printed as these digits.
bool digitsAreCutOff(const WrittenInertia& inertia) {
  if (inertia.aboutOrigin()) return false;
  const MassProperties& w = inertia.written;
  std::array<double, 6> half;
  double finest = HUGE_VAL;
  std::size_t k = 0;
  for (const Number* n : {&w.xx, &w.yy, &w.zz, &w.xy, &w.xz, &w.yz}) {
    const std::optional<double> unit = halfUnit(*n);
    if (!unit) return false;
    half[k++] = *unit;
    if (*unit > 0) finest = std::min(finest, *unit);
  }
  if (finest == HUGE_VAL) return false;
  const std::array<double, 6> given = six(rounded(inertia.given)), near = nearestPossible(given);
  for (k = 0; k < 6; ++k)
    if (std::abs(given[k] - near[k]) > (half[k] < 0 ? finest : half[k])) return false;
  return true;
}

/// The six numbers as they follow each other in a URDF file, by row and column.
constexpr std::array<std::array<std::size_t, 2>, 6> kInFile = {
    {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
/// Moments first.
constexpr std::array<std::array<std::size_t, 2>, 6> kMomentsFirst = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

template <typename Places>
RationalMatrix reordered(const RationalMatrix& given, const Places& from, const Places& to) {
  RationalMatrix out;
  for (std::size_t k = 0; k < 6; ++k)
    out[to[k][0]][to[k][1]] = out[to[k][1]][to[k][0]] = given[from[k][0]][from[k][1]];
  return out;
}

struct Unit {
  const char* name;
  double factor;
};
constexpr Unit kUnits[] = {{"kg m^2", 1}, {"kg cm^2", 1e-4}, {"kg mm^2", 1e-6}, {"g mm^2", 1e-9}};

/// The unit in which the body's radius of gyration is nearest to the robot's size, where it is
/// larger than the robot as written.
std::string unitByItsSize(const WrittenInertia& inertia, double size) {
  const double mass = Exact{inertia.mass, 0}.toDouble();
  const double trace = rounded(inertia.given).trace();
  if (!(size > 0) || !(mass > 0) || !(trace > 0)) return "";
  const double radius = std::sqrt(trace / 2 / mass);
  if (!(radius > size)) return "";
  const Unit* best = std::begin(kUnits);
  const auto distance = [&](const Unit& unit) {
    return std::abs(std::log(radius * std::sqrt(unit.factor) / size));
  };
  for (const Unit& unit : kUnits)
    if (distance(unit) < distance(*best)) best = &unit;
  if (best->factor == 1) return "";
  return fmt::format(
      "in {}: the radius of gyration is {:.3g} m as written, {:.3g} m then, and the longest lever "
      "of the robot {:.3g} m",
      best->name, radius, radius * std::sqrt(best->factor), size);
}

}  // namespace

RationalMatrix WrittenInertia::aboutCenterOfMass(const RationalMatrix& numbers) const {
  return aboutOrigin() ? sum(numbers, shift, -1) : numbers;
}

std::string impossibility(const WrittenInertia& inertia) {
  bool is_positive = false;
  const RationalMatrix I = inertia.aboutCenterOfMass(inertia.given);
  if (isRealizable(I, inertia.allowance, &is_positive)) return "";
  const Eigen::Vector3d moments = rounded(I).selfadjointView<Eigen::Lower>().eigenvalues();
  const double excess = is_positive ? moments[2] - moments[1] - moments[0] : -moments[0];
  const double largest = moments.cwiseAbs().maxCoeff();
  return fmt::format(
      "principal moments of inertia about the centre of mass are {:.6g}, {:.6g}, {:.6g} kg m^2, "
      "{}: by {}",
      moments[0], moments[1], moments[2],
      is_positive ? "which breaks the triangle inequality, allowed: none greater than the sum of "
                    "the other two"
                  : "which is not positive semidefinite, allowed: zero or more",
      excess > 0
          ? fmt::format("{:.3g} kg m^2 ({:.2g} % of the largest)", excess, 100 * excess / largest)
          : "less than doubles show");
}

std::string likelyReason(const WrittenInertia& inertia, double size) {
  const auto isPossible = [&](const RationalMatrix& numbers) {
    bool ignored = false;
    return isRealizable(inertia.aboutCenterOfMass(numbers), inertia.allowance, &ignored);
  };
  const RationalMatrix& I = inertia.given;
  const auto scaled = [&](const Rational& moments, const Rational& products) {
    RationalMatrix out = I;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) out[i][j] *= i == j ? moments : products;
    return out;
  };
  std::vector<std::string> reasons;
  const auto add = [&](const std::string& reason) {
    if (!reason.empty()) reasons.push_back(reason);
  };
  const bool has_products = I[0][1] != 0 || I[0][2] != 0 || I[1][2] != 0;
  if (has_products && I[0][0] == I[0][1] && I[0][0] == I[0][2] && I[0][0] == I[1][1] &&
      I[0][0] == I[1][2] && I[0][0] == I[2][2])
    add("six times the same number stands for an inertia that nobody knew");
  if (digitsAreCutOff(inertia)) add("digits cut off: a possible one is printed the same");
  if (has_products && isPossible(scaled(1, -1))) add("products of inertia of the other sign");
  const RationalMatrix sum_of_both = sum(I, inertia.shift);
  if (inertia.aboutOrigin() && isPossible(sum_of_both))
    add("given about the centre of mass, and not about the link's origin");
  else if (!inertia.aboutOrigin() && sum_of_both != I && isPossible(sum_of_both))
    add("the parallel axis theorem was applied to an inertia about the centre of mass already: "
        "m c^2 was taken off once too often");
  if (has_products && reasons.empty()) {
    if (isPossible(reordered(I, kInFile, kMomentsFirst)))
      add("the six numbers are ixx, iyy, izz, ixy, ixz, iyz in the order of the attributes");
    else if (isPossible(reordered(I, kMomentsFirst, kInFile)))
      add("the six numbers are ixx, ixy, ixz, iyy, iyz, izz in the order ixx, iyy, izz, ...");
  }
  for (const Unit& unit : kUnits) {
    if (!has_products || !reasons.empty() || unit.factor == 1) continue;
    const Rational factor(1, static_cast<int>(std::lround(1 / unit.factor)));
    if (isPossible(scaled(1, factor)))
      add(std::string("products of inertia in ") + unit.name + " beside moments in kg m^2");
  }
  for (int places = 1; places <= 3 && reasons.empty(); ++places) {
    const Rational factor = boost::multiprecision::pow(Integer(10), static_cast<unsigned>(places));
    for (std::size_t i = 0; i < 3 && reasons.empty(); ++i)
      for (const bool larger : {true, false}) {
        RationalMatrix moved = I;
        moved[i][i] *= larger ? factor : Rational(1 / factor);
        if (!reasons.empty() || !isPossible(moved)) continue;
        add(fmt::format("the decimal point of {}: {:.6g} would be possible",
                        i == 0   ? "xx"
                        : i == 1 ? "yy"
                                 : "zz",
                        Exact{moved[i][i], 0}.toDouble()));
      }
  }
  add(unitByItsSize(inertia, size));
  return fmt::format("{}", fmt::join(reasons, "; or "));
}

std::array<double, 6> nearestPossible(const std::array<double, 6>& I) {
  Eigen::Matrix3d given;
  given << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(given.trace() / 2 * one - given);
  const Eigen::Vector3d kept = solver.eigenvalues().cwiseMax(0.0);
  const Eigen::Matrix3d S =
      solver.eigenvectors() * kept.asDiagonal() * solver.eigenvectors().transpose();
  return six(S.trace() * one - S);
}

}  // namespace dynwitness::scene
