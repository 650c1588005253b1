// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/rules.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "scene/mimic.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Numbers = scene::RealNumbers<double>;

constexpr Mistake kMistakes[] = {Mistake::kInertialTurnDropped, Mistake::kInertialTurnTransposed,
                                 Mistake::kInertialTurnOneSide, Mistake::kInertialTurnOneSideLow,
                                 Mistake::kInertialTurnTwice,   Mistake::kProductsDropped,
                                 Mistake::kProductsNegated,     Mistake::kComTurned,
                                 Mistake::kComTurnedBack,       Mistake::kComDropped,
                                 Mistake::kInertiaAboutJoint,   Mistake::kInertiaShiftedTwice,
                                 Mistake::kInertiaDropped,      Mistake::kBalanced,
                                 Mistake::kFromGeometry,        Mistake::kDefaultMass,
                                 Mistake::kDefaultMassAlone,    Mistake::kGeometryWithoutInertial,
                                 Mistake::kNotRotated,          Mistake::kTensorNotRotated,
                                 Mistake::kComNotRotated,       Mistake::kRotatedBack,
                                 Mistake::kNotShifted,          Mistake::kMassDropped,
                                 Mistake::kComInParent,         Mistake::kParallelAxisMissing,
                                 Mistake::kParallelAxisDoubled, Mistake::kParallelAxisNegated};

Vector3d vector(const scene::Vector& v, const Numbers& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

Matrix3d about(int axis, const scene::CosSin<double>& a) {
  const int y = (axis + 1) % 3, z = (axis + 2) % 3;
  Matrix3d R = Matrix3d::Identity();
  R(y, y) = R(z, z) = a.c;
  R(z, y) = a.s;
  R(y, z) = -a.s;
  return R;
}

/// Rz Ry Rx
Matrix3d turn(const scene::Vector& rpy, const Numbers& number) {
  return about(2, number.angle(rpy[2])) * about(1, number.angle(rpy[1])) *
         about(0, number.angle(rpy[0]));
}

Isometry3d along(const std::vector<scene::Step>& steps, const Numbers& number) {
  using Kind = scene::Step::Kind;
  Isometry3d X = Isometry3d::Identity();
  for (const scene::Step& step : steps) {
    if (step.kind == Kind::kTranslate)
      X.translate(vector(step.translation, number));
    else
      X.rotate(about(step.kind == Kind::kRotateX   ? 0
                     : step.kind == Kind::kRotateY ? 1
                                                   : 2,
                     number.angle(step.angle)));
  }
  return X;
}

Matrix3d fromTriangle(const Matrix3d& m, bool upper) {
  Matrix3d out = m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      if (upper)
        out(i, j) = out(j, i);
      else
        out(j, i) = out(i, j);
  return out;
}

}  // namespace

const char* words(Mistake mistake) {
  switch (mistake) {
    case Mistake::kInertialTurnDropped:
      return "the rpy of <inertial> is dropped";
    case Mistake::kInertialTurnTransposed:
      return "the rpy of <inertial> is transposed";
    case Mistake::kInertialTurnOneSide:
    case Mistake::kInertialTurnOneSideLow:
      return "the rpy of <inertial> turns the inertia on one side only";
    case Mistake::kInertialTurnTwice:
      return "the rpy of <inertial> is applied twice";
    case Mistake::kProductsDropped:
      return "products of inertia are dropped";
    case Mistake::kProductsNegated:
      return "products of inertia have the other sign";
    case Mistake::kComTurned:
      return "the centre of mass is turned by the rpy of <inertial>";
    case Mistake::kComTurnedBack:
      return "the centre of mass is turned back by the rpy of <inertial>";
    case Mistake::kComInParent:
      return "the centre of mass is taken in the parent link's frame";
    case Mistake::kComDropped:
      return "the centre of mass is taken at the link's origin";
    case Mistake::kInertiaAboutJoint:
      return "the inertia, about the centre of mass, is taken as about the joint";
    case Mistake::kInertiaShiftedTwice:
      return "the inertia is kept about the joint and used as about the centre of mass";
    case Mistake::kInertiaDropped:
      return "the inertia is dropped, the mass kept";
    case Mistake::kBalanced:
      return "the moments of inertia are balanced: all are their mean";
    case Mistake::kFromGeometry:
      return "the inertia is that of the collision shapes, of 1000 kg/m^3";
    case Mistake::kDefaultMass:
      return "a link without <inertial> gets 1 kg and 1 kg m^2";
    case Mistake::kDefaultMassAlone:
      return "a link without <inertial> gets 1 kg";
    case Mistake::kGeometryWithoutInertial:
      return "a link without <inertial> gets that of its collision shapes, of 1000 kg/m^3";
    case Mistake::kNotRotated:
      return "a fixed child is merged without its rotation";
    case Mistake::kTensorNotRotated:
      return "a fixed child's inertia is merged without its rotation";
    case Mistake::kComNotRotated:
      return "a fixed child's centre of mass is merged without its rotation";
    case Mistake::kRotatedBack:
      return "a fixed child is merged with its rotation transposed";
    case Mistake::kNotShifted:
      return "a fixed child is merged without its shift";
    case Mistake::kMassDropped:
      return "a fixed child is dropped";
    case Mistake::kParallelAxisMissing:
      return "the parallel axis theorem is forgotten on merging";
    case Mistake::kParallelAxisDoubled:
      return "the parallel axis theorem is applied twice on merging";
    case Mistake::kParallelAxisNegated:
      return "the parallel axis theorem has the wrong sign on merging";
  }
  return "";
}

const char* words(FrameMistake mistake) {
  switch (mistake) {
    case FrameMistake::kTurnDropped:
      return "the rpy of the joint's origin is dropped";
    case FrameMistake::kTurnTransposed:
      return "the rpy of the joint's origin is transposed";
    case FrameMistake::kTurnReversed:
      return "the rpy of the joint's origin is applied in the reverse order";
    case FrameMistake::kShiftDropped:
      return "the xyz of the joint's origin is dropped";
    case FrameMistake::kShiftTurned:
      return "the xyz of the joint's origin is turned by its rpy";
  }
  return "";
}

FileParts::FileParts(const scene::Urdf& urdf) {
  build(urdf.scene.mechanism, &urdf.parts);
}
FileParts::FileParts(const scene::Mechanism& mechanism) {
  build(mechanism, nullptr);
}

void FileParts::build(const scene::Mechanism& mechanism,
                      const std::vector<scene::UrdfPart>* parts) {
  const Numbers number(mechanism);
  if (mechanism.has_gravity) robot_.gravity = vector(mechanism.gravity, number);
  struct Carrier {
    int body = -1;
    Isometry3d X = Isometry3d::Identity();  // x_body = X x_link
  };
  const auto isFixed = [&](const scene::Link& link) {
    return link.parent >= 0 && link.joint.kind == scene::JointKind::kFixed;
  };
  const auto originOf = [&](const scene::Joint& joint) {
    return Origin{vector(joint.placement.xyz, number), vector(joint.placement.rpy, number),
                  along(joint.placement.beforeJoint(), number)};
  };
  std::vector<Carrier> carriers;
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    const scene::Joint& joint = link.joint;
    Carrier here;
    const Carrier parent =
        link.parent < 0 ? Carrier() : carriers[static_cast<std::size_t>(link.parent)];
    const Isometry3d X_before = along(joint.placement.beforeJoint(), number),
                     X_after = along(joint.placement.afterJoint(), number);
    const bool moves = link.parent >= 0 && !isFixed(link);
    if (moves) {
      ReadBody body;
      body.link = link.name;
      body.joint = joint.name;
      body.parent = parent.body;
      body.kind = joint.kind;
      body.placement = parent.X * X_before;
      const Vector3d axis = vector(joint.axis, number);
      if (axis.isZero(0))
        throw scene::InputError(link.where, "joint \"" + joint.name +
                                                "\": axis is [0, 0, 0], allowed: any length but "
                                                "zero");
      body.axis = scene::positionSlots(joint.kind).size() == 1 ? Vector3d(axis.normalized())
                                                               : Vector3d(0, 0, 0);
      body.links = 0;
      body.damping = number(joint.friction.viscous);
      body.friction = number(joint.friction.positive);
      const double gear = number(joint.gear_ratio);
      body.armature = gear * gear * number(joint.rotor_inertia);
      body.stiffness = number(joint.stiffness);
      if (joint.mimic) {
        body.leader = joint.mimic->joint;
        body.multiplier = number(joint.mimic->multiplier);
        body.offset = number(joint.mimic->offset);
      }
      if (parts && (*parts)[i].limits) {
        body.lower = number((*parts)[i].limits->lower);
        body.upper = number((*parts)[i].limits->upper);
      }
      here.body = static_cast<int>(robot_.bodies.size());
      here.X = X_after;
      std::vector<Origin> origins = {originOf(joint)};
      for (const scene::Link* l = &mechanism.links[static_cast<std::size_t>(link.parent)];
           isFixed(*l); l = &mechanism.links[static_cast<std::size_t>(l->parent)])
        origins.push_back(originOf(l->joint));
      std::reverse(origins.begin(), origins.end());
      origins_.push_back(std::move(origins));
      axes_.push_back(axis);
      where_.push_back(link.where);
      robot_.bodies.push_back(body);
      pieces_.emplace_back();
    } else {
      here.body = parent.body;
      here.X = parent.X * X_before * X_after;
    }
    carriers.push_back(here);
    if (here.body < 0) continue;
    const scene::MassProperties& m = link.inertia;
    Piece piece;
    piece.link = link.name;
    piece.is_fixed = !moves;
    piece.has_inertial = parts ? (*parts)[i].has_inertial : true;
    piece.X = here.X;
    piece.from_parent = X_before.translation();
    piece.turn_from_parent = X_before.linear();
    const auto given = [&](const scene::MassProperties& p) {
      return (Matrix3d() << number(p.xx), number(p.xy), number(p.xz), number(p.xy), number(p.yy),
              number(p.yz), number(p.xz), number(p.yz), number(p.zz))
          .finished();
    };
    piece.mass = number(m.mass);
    piece.com = vector(m.com, number);
    piece.R = turn(m.rpy, number);
    piece.I = given(m);
    if (m.about == scene::MassProperties::About::kLinkOrigin)
      piece.I -= piece.mass * lever(piece.R.transpose() * piece.com);
    if (parts)
      for (const scene::MassProperties& solid : (*parts)[i].solids) {
        const Matrix3d R = turn(solid.rpy, number);
        piece.solids.push_back(MassMoments::of(number(solid.mass), vector(solid.com, number),
                                               R * given(solid) * R.transpose()));
      }
    pieces_[static_cast<std::size_t>(here.body)].push_back(piece);
    ++robot_.bodies[static_cast<std::size_t>(here.body)].links;
  }
  for (std::size_t b = 0; b < pieces_.size(); ++b) {
    for (Piece& piece : pieces_[b]) {
      double ignored = 1;
      piece.moments = readPiece(piece, {}, &ignored);
    }
    robot_.bodies[b].moments = read(b, {});
  }
}

MassMoments FileParts::readPiece(const Piece& piece, const std::vector<Slip>& slips,
                                 double* parallel_axes) const {
  double mass = piece.mass;
  Vector3d c = piece.com;
  Matrix3d R = piece.R, I = piece.I, tensor_turn = piece.X.linear();
  Isometry3d X = piece.X;
  double about_com = 0;  // multiples of m c^2 added to the inertia
  MassMoments solids;
  for (const MassMoments& solid : piece.solids) solids += solid;
  bool from_solids = false, com_not_rotated = false, balanced = false;
  for (const Slip& slip : slips) {
    if (!slip.link.empty() && slip.link != piece.link) continue;
    switch (slip.mistake) {
      case Mistake::kInertialTurnDropped:
        R.setIdentity();
        break;
      case Mistake::kInertialTurnTransposed:
        R.transposeInPlace();
        break;
      case Mistake::kInertialTurnOneSide:
      case Mistake::kInertialTurnOneSideLow:
        I = fromTriangle(R * I, slip.mistake == Mistake::kInertialTurnOneSide);
        R.setIdentity();
        break;
      case Mistake::kInertialTurnTwice:
        R = (R * R).eval();
        break;
      case Mistake::kProductsDropped:
        I = Matrix3d(I.diagonal().asDiagonal());
        break;
      case Mistake::kProductsNegated:
        I = 2 * Matrix3d(I.diagonal().asDiagonal()) - I;
        break;
      case Mistake::kComTurned:
        c = piece.R * c;
        break;
      case Mistake::kComTurnedBack:
        c = piece.R.transpose() * c;
        break;
      case Mistake::kComInParent:
        c = piece.turn_from_parent.transpose() * (c - piece.from_parent);
        break;
      case Mistake::kComDropped:
        c.setZero();
        break;
      case Mistake::kInertiaAboutJoint:
        about_com -= 1;
        break;
      case Mistake::kInertiaShiftedTwice:
        about_com += 1;
        break;
      case Mistake::kInertiaDropped:
        I.setZero();
        break;
      case Mistake::kBalanced:
        balanced = true;
        break;
      case Mistake::kFromGeometry:
        from_solids = from_solids || piece.has_inertial;
        break;
      case Mistake::kGeometryWithoutInertial:
        from_solids = from_solids || !piece.has_inertial;
        break;
      case Mistake::kDefaultMass:
      case Mistake::kDefaultMassAlone:
        if (piece.has_inertial) break;
        mass = 1;
        if (slip.mistake == Mistake::kDefaultMass) I.setIdentity();
        break;
      case Mistake::kNotRotated:
        if (piece.is_fixed) X.linear().setIdentity(), tensor_turn.setIdentity();
        break;
      case Mistake::kTensorNotRotated:
        if (piece.is_fixed) tensor_turn.setIdentity();
        break;
      case Mistake::kComNotRotated:
        com_not_rotated = com_not_rotated || piece.is_fixed;
        break;
      case Mistake::kRotatedBack:
        if (piece.is_fixed) {
          X.linear() = Matrix3d(X.linear().transpose());
          tensor_turn.transposeInPlace();
        }
        break;
      case Mistake::kNotShifted:
        if (piece.is_fixed) X.translation().setZero();
        break;
      case Mistake::kMassDropped:
        if (piece.is_fixed) return {};
        break;
      case Mistake::kParallelAxisMissing:
        *parallel_axes = 0;
        break;
      case Mistake::kParallelAxisDoubled:
        *parallel_axes = 2;
        break;
      case Mistake::kParallelAxisNegated:
        *parallel_axes = -1;
        break;
    }
  }
  if (from_solids) {
    mass = solids.mass;
    c = solids.com();
    I = solids.aboutCom();
    R.setIdentity();
  }
  I = (R * I * R.transpose() + about_com * mass * lever(c)).eval();
  if (balanced) {
    const Vector3d moments = I.selfadjointView<Eigen::Lower>().eigenvalues();
    if (moments[0] + moments[1] < moments[2]) I = moments.mean() * Matrix3d::Identity();
  }
  const Vector3d com = com_not_rotated ? Vector3d(X.translation() + c) : Vector3d(X * c);
  MassMoments out = MassMoments::of(mass, com, tensor_turn * I * tensor_turn.transpose());
  out.reach2 += mass * (X.translation().squaredNorm() + c.squaredNorm());
  return out;
}

MassMoments FileParts::read(std::size_t body, const std::vector<Slip>& slips) const {
  std::vector<MassMoments> parts;
  std::vector<double> parallel_axes;
  MassMoments sum;
  bool as_it_is = true;
  for (const Piece& piece : pieces_[body]) {
    double times = 1;
    parts.push_back(readPiece(piece, slips, &times));
    parallel_axes.push_back(times);
    as_it_is = as_it_is && times == 1;
    sum += parts.back();
  }
  if (as_it_is) return sum;
  const Vector3d C = sum.com();
  Matrix3d I = Matrix3d::Zero();
  for (std::size_t k = 0; k < parts.size(); ++k)
    I += parts[k].aboutCom() + parallel_axes[k] * parts[k].mass * lever(parts[k].com() - C);
  MassMoments out = MassMoments::of(sum.mass, C, I);
  out.reach2 = sum.reach2;
  return out;
}

MassMoments FileParts::readAt(std::size_t body, std::size_t place,
                              const std::vector<Mistake>& mistakes) const {
  const Piece& piece = pieces_[body][place];
  std::vector<Slip> slips;
  for (const Mistake mistake : mistakes) slips.push_back({mistake, piece.link});
  double parallel_axes = 1;
  const MassMoments changed = readPiece(piece, slips, &parallel_axes);
  if (parallel_axes != 1) return read(body, slips);
  MassMoments out = robot_.bodies[body].moments;
  out.mass += changed.mass - piece.moments.mass;
  out.first += changed.first - piece.moments.first;
  out.second += changed.second - piece.moments.second;
  out.reach2 += changed.reach2;
  return out;
}

std::vector<std::string> FileParts::links(std::size_t body) const {
  std::vector<std::string> out;
  for (const Piece& piece : pieces_[body]) out.push_back(piece.link);
  return out;
}

Isometry3d FileParts::readOrigin(std::size_t body, FrameMistake mistake) const {
  // from the parent body's frame to its link's: nothing in URDF
  Isometry3d X = Isometry3d::Identity();
  for (const Origin& origin : origins_[body]) {
    Isometry3d step = origin.X;
    const Matrix3d R = step.linear();
    switch (mistake) {
      case FrameMistake::kTurnDropped:
        step.linear().setIdentity();
        break;
      case FrameMistake::kTurnTransposed:
        step.linear() = R.transpose();
        break;
      case FrameMistake::kTurnReversed:
        step.linear() = (Eigen::AngleAxisd(origin.rpy[0], Vector3d::UnitX()) *
                         Eigen::AngleAxisd(origin.rpy[1], Vector3d::UnitY()) *
                         Eigen::AngleAxisd(origin.rpy[2], Vector3d::UnitZ()))
                            .toRotationMatrix();
        break;
      case FrameMistake::kShiftDropped:
        step.translation().setZero();
        break;
      case FrameMistake::kShiftTurned:
        step.translation() = R * origin.xyz;
        break;
    }
    X = X * step;
  }
  return X;
}

Matrix3d FileParts::turnOfOrigin(std::size_t body) const {
  return origins_[body].back().X.linear();
}

double FileParts::reach(std::size_t body) const {
  double sum = 0;
  for (const Origin& origin : origins_[body]) sum += origin.xyz.norm();
  return sum;
}

bool isSame(const MassMoments& a, const MassMoments& b, int links, double unturned) {
  const double unit = roundingOf(links);
  const double mass = std::max(std::abs(a.mass), std::abs(b.mass));
  const double reach2 = std::max(a.reach2, b.reach2);
  return std::abs(a.mass - b.mass) <= unit * mass &&
         (a.first - b.first).norm() <= unit * std::sqrt(mass * reach2) &&
         (a.second - b.second).norm() <=
             unit * reach2 + unturned * (links + 1.0) * a.aboutCom().cwiseAbs().trace();
}

std::string explanation(const FileParts& file, std::size_t body, const MassMoments& seen,
                        double unturned) {
  const std::vector<std::string> links = file.links(body);
  const int count = static_cast<int>(links.size());
  const MassMoments as_it_is = file.read(body, {});
  const auto fits = [&](const MassMoments& read) { return isSame(read, seen, count, unturned); };
  // of a mistake at all links, those at which it changes something
  const auto everywhere = [&](Mistake mistake) {
    std::string places;
    for (std::size_t place = 0; place < links.size(); ++place)
      if (!isSame(file.readAt(body, place, {mistake}), as_it_is, count, unturned))
        places += (places.empty() ? "" : ", ") + links[place];
    return std::string(words(mistake)) + (places.empty() ? "" : " (" + places + ")");
  };
  const auto at = [&](Mistake mistake, std::size_t place) {
    return std::string(words(mistake)) + " (" + links[place] + ")";
  };
  for (const Mistake mistake : kMistakes)
    if (fits(file.read(body, {{mistake, ""}}))) return everywhere(mistake);
  for (const Mistake mistake : kMistakes)
    for (std::size_t place = 0; place < links.size(); ++place)
      if (fits(file.readAt(body, place, {mistake}))) return at(mistake, place);
  // two, in the order in which they are listed; those of the parallel axis are the last
  for (const Mistake first : kMistakes)
    for (const Mistake second : kMistakes) {
      if (first >= second) continue;
      if (fits(file.read(body, {{first, ""}, {second, ""}})))
        return everywhere(first) + ", and " + everywhere(second);
      for (std::size_t place = 0; place < links.size() && second < Mistake::kParallelAxisMissing;
           ++place)
        if (fits(file.readAt(body, place, {first, second})))
          return at(first, place) + ", and " + at(second, place);
    }
  return "";
}

}  // namespace dynwitness::crosscheck
