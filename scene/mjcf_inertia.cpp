// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_inertia.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Core>

#include "scene/mjcf_numbers.hpp"
#include "scene/mjcf_orientations.hpp"
#include "scene/mjcf_shapes.hpp"
#include "scene/rational_geometry.hpp"

namespace dynwitness::scene::mjcf {
namespace {

MassProperties readInertial(const Element& element, const Compiler& compiler) {
  requireKnown(element, {"pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "mass",
                         "diaginertia", "fullinertia"});
  const Said said(element, kNone);
  MassProperties m;
  for (const char* key : {"pos", "mass"})
    if (!said.has(key)) said.fail(fmt::format("has no {}", key));
  m.mass = said.number("mass");
  m.com = said.vector("pos");
  const Turn turned = turnSaid(said, compiler);
  m.rpy = turned.rpy;
  if (said.has("diaginertia")) {
    const Vector d = said.vector("diaginertia");
    m.xx = d[0];
    m.yy = d[1];
    m.zz = d[2];
  }
  if (!said.has("fullinertia")) return m;
  if (said.has("diaginertia"))
    said.fail("fullinertia", "and diaginertia are both given, allowed: one of them");
  if (!turned.isNone())
    said.fail("fullinertia",
              "with an orientation: versions of MuJoCo differ, which drop it or refuse it, "
              "allowed: without, or diaginertia");
  const std::vector<Number> f = said.numbers("fullinertia", 6, 6);
  m.xx = f[0];
  m.yy = f[1];
  m.zz = f[2];
  m.xy = f[3];
  m.xz = f[4];
  m.yz = f[5];
  return m;
}

std::optional<MassProperties> inertiaOfGeoms(const Node& node, const Compiler& compiler,
                                             const Defaults& defaults, const Class& of_body,
                                             bool rests, bool* is_known) {
  std::vector<Solid> solids;
  for (const Node& child : node.children) {
    if (child.element.kind() != "geom") continue;
    const Said without_class(child.element, kNone);
    const Said said(child.element, defaults.classOf(without_class, "class", of_body).geom);
    const Real group = std::floor(valueOf(said.number("group", 0)));
    if (group < compiler.least_group || group > compiler.most_group) continue;
    if (std::optional<Solid> solid = solidOf(said, compiler, rests, is_known))
      solids.push_back(*solid);
  }
  if (solids.empty()) return {};
  MassProperties m;
  if (solids.size() == 1) {
    const Solid& s = solids[0];
    m.mass = s.mass;
    m.com = s.com;
    m.rpy = s.turn.rpy;
    m.xx = s.moments[0];
    m.yy = s.moments[1];
    m.zz = s.moments[2];
    return m;
  }
  const SourceLocation where = node.element.where();
  Real mass = 0, size = 0;
  Vector3 first = Vector3::Zero();
  for (const Solid& s : solids) {
    mass += valueOf(s.mass);
    first += valueOf(s.mass) * valueOf(s.com);
    size = std::max(size, valueOf(s.com).norm());
  }
  const Vector3 com = first / mass;
  Matrix3 I = Matrix3::Zero();
  for (const Solid& s : solids) {
    const Vector3 c = valueOf(s.com) - com;
    I += s.turn.R * valueOf(s.moments).asDiagonal() * s.turn.R.transpose() +
         valueOf(s.mass) * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
  }
  m.mass = printed(mass, 0, where);
  m.com = printed(com, size, where);
  const Real trace = I.trace();
  m.xx = printed(I(0, 0), 0, where);
  m.yy = printed(I(1, 1), 0, where);
  m.zz = printed(I(2, 2), 0, where);
  m.xy = printed(I(0, 1), trace, where);
  m.xz = printed(I(0, 2), trace, where);
  m.yz = printed(I(1, 2), trace, where);
  return m;
}

/// boundmass, boundinertia and balanceinertia: least mass and moments, then three equal moments
/// where the triangle inequality is broken.
void bound(MassProperties* m, const Compiler& compiler, const SourceLocation& where) {
  const auto less = [](const Number& a, const Number& b) {
    return exactValue(a, {}).approximation() < exactValue(b, {}).approximation();
  };
  if (less(m->mass, compiler.least_mass)) m->mass = compiler.least_mass;
  const bool is_diagonal = isZero(m->xy) && isZero(m->xz) && isZero(m->yz);
  const auto value = [](const Number& n) { return exactValue(n, {}).approximation(); };
  const auto matrix = [&] {
    return RationalMatrix{{{value(m->xx), value(m->xy), value(m->xz)},
                           {value(m->xy), value(m->yy), value(m->yz)},
                           {value(m->xz), value(m->yz), value(m->zz)}}};
  };
  if (!isZero(compiler.least_inertia)) {
    RationalMatrix above = matrix();
    for (std::size_t k = 0; k < 3; ++k) above[k][k] -= value(compiler.least_inertia);
    if (is_diagonal) {
      for (Number* n : {&m->xx, &m->yy, &m->zz})
        if (less(*n, compiler.least_inertia)) *n = compiler.least_inertia;
    } else if (!isPositiveSemidefinite(above)) {
      throw InputError(where,
                       "<body>: boundinertia changes an inertia with products, which is not in the "
                       "subset that is read, allowed: diaginertia");
    }
  }
  bool is_positive = true;
  if (!compiler.balance || isRealizable(matrix(), 0, &is_positive) || !is_positive) return;
  const Number mean =
      Number(Rational((value(m->xx) + value(m->yy) + value(m->zz)) / 3));  // in any axes: the trace
  m->xx = m->yy = m->zz = mean;
  m->xy = m->xz = m->yz = Number(0);
}

}  // namespace

MassProperties readInertia(const Node& node, const Compiler& compiler, const Defaults& defaults,
                           const Class& of_body, bool rests, bool* is_known) {
  std::optional<Element> inertial;
  for (const Node& child : node.children) {
    if (child.element.kind() != "inertial") continue;
    if (inertial) child.element.fail("a second one, allowed: one in <body>");
    inertial = child.element;
  }
  MassProperties m;
  if (inertial) m = readInertial(*inertial, compiler);
  if (compiler.from_geoms == "true" || (compiler.from_geoms == "auto" && !inertial))
    if (const auto of_geoms = inertiaOfGeoms(node, compiler, defaults, of_body, rests, is_known))
      m = *of_geoms;
  bound(&m, compiler, node.element.where());
  return m;
}

void setTotalMass(const Compiler& compiler, std::vector<NamedLink>* links) {
  if (!(valueOf(compiler.total_mass) > 0)) return;
  Real total = 0;
  for (const NamedLink& named : *links) total += valueOf(named.link.inertia.mass);
  if (!(total > 0))
    throw InputError(compiler.total_mass_where,
                     "<compiler>: settotalmass, and there is no mass, allowed: bodies with mass");
  const Number factor = printed(valueOf(compiler.total_mass) / total, 0, compiler.total_mass_where);
  const Rational by = exactValue(factor, {}).rational;
  for (NamedLink& named : *links) {
    MassProperties& m = named.link.inertia;
    for (Number* n : {&m.mass, &m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz})
      if (!isZero(*n)) *n = Number(Rational(by * exactValue(*n, {}).rational));
  }
}

}  // namespace dynwitness::scene::mjcf
