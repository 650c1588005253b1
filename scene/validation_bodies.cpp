// SPDX-License-Identifier: GPL-3.0-or-later
// Whether bodies have an inertia that some body has, with the rotors that they carry.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scene/impossible_inertia.hpp"
#include "scene/validator.hpp"

namespace dynwitness::scene::validation {

/// The longest lever: from a link to a joint on it or to its centre of mass [m].
double Validator::sizeOfRobot() {
  if (size_) return *size_;
  size_ = 0;
  const auto number = [this](const Number& n) { return exactValue(n, values_, file_).toDouble(); };
  for (const Link& link : mechanism_.links) {
    const Placement& p = link.joint.placement;
    for (const Vector& v : {link.inertia.com, p.xyz, {p.a, p.d, Number(0)}})
      size_ = std::max(*size_, std::hypot(number(v[0]), number(v[1]), number(v[2])));
  }
  return *size_;
}

/// What is wrong with an inertia, by how much, and what it may have been meant as; empty: nothing.
std::string Validator::impossible(const Link& link, const RationalMatrix& given,
                                  const RationalMatrix& R, const Rational& allowance) {
  WrittenInertia written{link.inertia, given, {}, value(link.inertia.mass), allowance};
  const RationalVector c = transpose(R) * vector(link.inertia.com);
  const Rational c2 = dot(c, c);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      written.shift[i][j] = written.mass * ((i == j ? c2 : Rational(0)) - c[i] * c[j]);
  const std::string what = impossibility(written);
  if (what.empty()) return "";
  const std::string reason = likelyReason(written, sizeOfRobot());
  return what + (reason.empty() ? "" : "; likely: " + reason);
}

std::vector<std::string> Validator::impossibleInertias() {
  findParameters();
  for (const Link& link : mechanism_.links) bodies_.push_back(body(link));
  std::vector<std::string> out;
  for (const auto& [link, what] : complaints_)
    out.push_back(fmt::format("{}: link \"{}\": {}", link->where.text(), link->name, what));
  return out;
}

/// All links at once: a file with one impossible inertia tends to have many.
void Validator::requireBodies() {
  for (const Link& link : mechanism_.links) bodies_.push_back(body(link));
  if (complaints_.empty()) return;
  std::string all;
  for (const auto& [link, what] : complaints_)
    all += (all.empty() ? "" : "\n" + link->where.text() + ": ") + "link \"" + link->name +
           "\": " + what;
  if (complaints_.size() > 1)
    all += fmt::format("\n{}: {} of {} links have an inertia that no body has", file_.text(),
                       complaints_.size(), mechanism_.links.size());
  throw InputError(complaints_.front().first->where, all);
}

Body Validator::body(const Link& link) {
  const MassProperties& given = link.inertia;
  is_exact_ = true;
  Body b{value(given.mass), vector(given.com), {}, true, nullptr};
  const Rational xx = value(given.xx), yy = value(given.yy), zz = value(given.zz);
  const Rational xy = value(given.xy), xz = value(given.xz), yz = value(given.yz);
  const auto complain = [&](const std::string& what) {
    if (!what.empty()) complaints_.emplace_back(&link, what);
  };
  if (b.mass < 0)
    complain(fmt::format("mass is {} kg, allowed: zero or more",
                         exactValue(given.mass, values_).toDouble()));
  const bool has_inertia = xx != 0 || yy != 0 || zz != 0 || xy != 0 || xz != 0 || yz != 0;
  if (b.mass == 0 && has_inertia)
    complain(
        "has inertia but no mass, allowed: a mass with it, or the rotor_inertia of a "
        "joint");

  b.inertia = {{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  if (b.mass < 0 || (b.mass == 0 && has_inertia) ||
      (!has_inertia && given.about == MassProperties::About::kCenterOfMass)) {
    b.is_exact = is_exact_;
    return b;
  }
  const bool about_origin = given.about == MassProperties::About::kLinkOrigin;
  const RationalMatrix as_written = b.inertia;
  Rational size = abs(xx) + abs(yy) + abs(zz);
  if (about_origin) {  // I_com = I_o - m (c.c 1 - c c')
    const RationalMatrix R = turnOf(given.rpy);
    b.inertia = R * b.inertia * transpose(R);
    const Rational c2 = dot(b.com, b.com);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        b.inertia[i][j] -= b.mass * ((i == j ? c2 : Rational(0)) - b.com[i] * b.com[j]);
    size += b.mass * c2;
  } else {
    b.turn = &given.rpy;
  }
  b.is_exact = is_exact_;
  const Rational allowance = slack(size);
  bool ignored = false;
  if (!isRealizable(b.inertia, allowance, &ignored))
    complain(impossible(link, as_written, turnOf(given.rpy), allowance));
  return b;
}

/// Turned when somebody asks: whether a body has it, its axes do not say, and turning rationals of
/// 256 bits takes most of the reading of a file.
const Body& Validator::inLinkAxes(std::size_t i) {
  Body& b = bodies_[i];
  if (!b.turn) return b;
  const bool was_exact = is_exact_;
  is_exact_ = b.is_exact;
  const RationalMatrix R = turnOf(*b.turn);
  b.inertia = R * b.inertia * transpose(R);
  b.is_exact = is_exact_;
  b.turn = nullptr;
  is_exact_ = was_exact;
  return b;
}

/** A link that moves contains the gyroscopic rotors of the joints on it: what is left of its
    inertia without them is that of a body. A rotor of inertia J about z is at least a disc, J/2 (1
    + z z'). */
void Validator::requireCarriers() {
  std::vector<bool> rests = {true};
  for (std::size_t i = 1; i < mechanism_.links.size(); ++i) {
    const Link& link = mechanism_.links[i];
    rests.push_back(rests[link.parent] && link.joint.kind == JointKind::kFixed);
  }
  struct Spinning {
    const Link* driven;
    const Vector* axis;
    const Number* inertia;
  };
  std::map<int, std::vector<Spinning>> carriers;
  for (std::size_t i = 1; i < mechanism_.links.size(); ++i) {
    const Link& link = mechanism_.links[i];
    if (rests[link.parent]) continue;
    if (link.joint.gyroscopic)
      carriers[link.parent].push_back({&link, &link.joint.axis, &link.joint.rotor_inertia});
    for (const Rotor& rotor : link.joint.rotors)
      if (rotor.axis) carriers[link.parent].push_back({&link, &*rotor.axis, &rotor.inertia});
  }
  for (const auto& [i, rotors] : carriers) {
    const RationalMatrix& whole = inLinkAxes(static_cast<std::size_t>(i)).inertia;
    Rational size = whole[0][0] + whole[1][1] + whole[2][2];
    is_exact_ = bodies_[i].is_exact;
    // what is left beside the rotors, times `common`: whole numbers need no lowest terms
    Integer common = 1;
    IntegerMatrix left = inWholeNumbers(whole, &common);
    std::string joints;
    for (const Spinning& rotor : rotors) {
      const Joint& joint = rotor.driven->joint;
      joints += (joints.empty() ? "" : ", ") + ('"' + joint.name + '"');
      const RationalVector z = turned(joint.placement.beforeJoint(), vector(*rotor.axis));
      const Rational half = value(*rotor.inertia) / 2;
      size += half;
      // half (1 + z z' / z'z), whatever the length of z
      Integer of_z = 1;
      for (const Rational& x : z) of_z = commonDenominator(of_z, x);
      const Integer n[] = {scaledBy(of_z, z[0]), scaledBy(of_z, z[1]), scaledBy(of_z, z[2])};
      const Integer square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2],
                    factor = bottom(half) * square, share = common * top(half);
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k)
          left[j][k] = left[j][k] * factor - share * (n[j] * n[k] + (j == k ? square : Integer(0)));
      common *= factor;
    }
    bool is_positive = false;
    const Rational allowance = slack(size);
    for (auto& row : left)
      for (Integer& element : row) element *= bottom(allowance);
    if (isRealizable(left, Integer(top(allowance) * common), &is_positive)) continue;
    failLink(
        mechanism_.links[i],
        "carries the gyroscopic rotor of joint " + joints +
            ", and without it, a disc of that rotor_inertia at the least, its inertia about the "
            "centre of mass is no body's, allowed: an inertia that contains the rotor as it "
            "stands");
  }
}

}  // namespace dynwitness::scene::validation
