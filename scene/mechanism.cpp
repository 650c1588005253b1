// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mechanism.hpp"

#include <stdexcept>

namespace dynwitness::scene {
namespace {

void translate(const Number& x, const Number& y, const Number& z, std::vector<Step>* steps) {
  if (x.isLiteralZero() && y.isLiteralZero() && z.isLiteralZero()) return;
  steps->push_back({Step::Kind::kTranslate, {x, y, z}, Number(0)});
}

void rotate(Step::Kind kind, const Number& angle, std::vector<Step>* steps) {
  if (angle.isLiteralZero()) return;
  steps->push_back({kind, {}, angle});
}

}  // namespace

int degreesOfFreedom(JointKind kind) {
  return kind == JointKind::kFixed ? 0 : 1;
}

const char* name(JointKind kind) {
  switch (kind) {
    case JointKind::kFixed:
      return "fixed";
    case JointKind::kRevolute:
      return "revolute";
    case JointKind::kPrismatic:
      return "prismatic";
  }
  throw std::logic_error("name: unknown joint kind");
}

const char* name(ClosureKind kind) {
  switch (kind) {
    case ClosureKind::kDistance:
      return "distance";
    case ClosureKind::kPlanarPoint:
      return "planar_point";
    case ClosureKind::kPoint:
      return "point";
    case ClosureKind::kHinge:
      return "hinge";
    case ClosureKind::kWeld:
      return "weld";
  }
  throw std::logic_error("name: unknown closure kind");
}

int equationCount(ClosureKind kind) {
  switch (kind) {
    case ClosureKind::kDistance:
      return 1;
    case ClosureKind::kPlanarPoint:
      return 2;
    case ClosureKind::kPoint:
      return 3;
    case ClosureKind::kHinge:
      return 5;
    case ClosureKind::kWeld:
      return 6;
  }
  throw std::logic_error("equationCount: unknown closure kind");
}

std::vector<Step> Attachment::steps() const {
  Placement placement;
  placement.xyz = xyz;
  placement.rpy = rpy;
  return placement.beforeJoint();
}

std::vector<Step> Placement::beforeJoint() const {
  std::vector<Step> steps;
  switch (convention) {
    case Convention::kXyzRpy:
      translate(xyz[0], xyz[1], xyz[2], &steps);
      rotate(Step::Kind::kRotateZ, rpy[2], &steps);
      rotate(Step::Kind::kRotateY, rpy[1], &steps);
      rotate(Step::Kind::kRotateX, rpy[0], &steps);
      break;
    case Convention::kDh:
      break;
    case Convention::kMdh:
      rotate(Step::Kind::kRotateX, alpha, &steps);
      translate(a, 0, 0, &steps);
      rotate(Step::Kind::kRotateZ, theta, &steps);
      translate(0, 0, d, &steps);
      break;
  }
  return steps;
}

std::vector<Step> Placement::afterJoint() const {
  std::vector<Step> steps;
  if (convention == Convention::kDh) {
    rotate(Step::Kind::kRotateZ, theta, &steps);
    translate(a, 0, d, &steps);  // Tz(d) Tx(a): no turn between them
    rotate(Step::Kind::kRotateX, alpha, &steps);
  }
  return steps;
}

int Mechanism::dof() const {
  int n = 0;
  for (const Link& link : links) n += degreesOfFreedom(link.joint.kind);
  return n;
}

std::vector<int> Mechanism::movingLinks() const {
  std::vector<int> moving;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (degreesOfFreedom(links[i].joint.kind) > 0) moving.push_back(static_cast<int>(i));
  }
  return moving;
}

ParameterValues Mechanism::parameterValues() const {
  ParameterValues values;
  for (const Parameter& p : parameters) values[p.name] = exactValue(p.value, values, p.where);
  return values;
}

}  // namespace dynwitness::scene
