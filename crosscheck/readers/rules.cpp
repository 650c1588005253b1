// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/rules.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <boost/math/constants/constants.hpp>

#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
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
                                 Mistake::kNotShifted,          Mistake::kShiftInPrincipalAxes,
                                 Mistake::kMassDropped,         Mistake::kComInParent,
                                 Mistake::kParallelAxisMissing, Mistake::kParallelAxisDoubled,
                                 Mistake::kParallelAxisNegated};

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
      return "a massless link gets 1 kg and 1 kg m^2";
    case Mistake::kDefaultMassAlone:
      return "a massless link gets 1 kg";
    case Mistake::kGeometryWithoutInertial:
      return "a massless link gets that of its collision shapes, of 1000 kg/m^3";
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
    case Mistake::kShiftInPrincipalAxes:
      return "a fixed child is merged without its rotation, and its shift is turned by its principal axes";
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

FileParts readParts(const std::string& text, const std::filesystem::path& file) {
  return scene::isMjcf(text) ? FileParts(scene::readSceneMjcf(text, file).mechanism)
                             : FileParts(scene::readUrdfAsWritten(text, file));
}

FileParts::FileParts(const scene::Urdf& urdf) {
  build(urdf.scene.mechanism, &urdf.parts);
}
FileParts::FileParts(const scene::Mechanism& mechanism) {
  build(mechanism, nullptr);
}

namespace {

bool isFixed(const scene::Link& link) {
  return link.parent >= 0 && link.joint.kind == scene::JointKind::kFixed;
}

Matrix3d tensor(const scene::MassProperties& p, const Numbers& number) {
  return (Matrix3d() << number(p.xx), number(p.xy), number(p.xz), number(p.xy), number(p.yy),
          number(p.yz), number(p.xz), number(p.yz), number(p.zz))
      .finished();
}

/// The joint of a link that moves, but for its place.
ReadBody jointOf(const scene::Link& link, const scene::UrdfPart* part, const Numbers& number) {
  const scene::Joint& joint = link.joint;
  ReadBody body;
  body.link = link.name;
  body.joint = joint.name;
  body.kind = joint.kind;
  const Vector3d axis = vector(joint.axis, number);
  if (axis.isZero(0))
    throw scene::InputError(link.where, "joint \"" + joint.name +
                                            "\": axis is [0, 0, 0], allowed: any length but zero");
  body.axis = scene::positionSlots(joint.kind).size() == 1 ? Vector3d(axis.normalized())
                                                           : Vector3d(0, 0, 0);
  body.links = 0;
  body.damping = number(joint.friction.viscous);
  body.friction = number(joint.friction.positive);
  const double gear = number(joint.gear_ratio);
  body.armature = gear * gear * number(joint.rotor_inertia);
  body.stiffness = number(joint.stiffness);
  body.rest = number(joint.rest);
  if (joint.mimic) {
    body.leader = joint.mimic->joint;
    body.multiplier = number(joint.mimic->multiplier);
    body.offset = number(joint.mimic->offset);
  }
  if (part && part->limits) {
    body.lower = number(part->limits->lower);
    body.upper = number(part->limits->upper);
  }
  return body;
}

}  // namespace

/// From the body that carries a link's parent to the link's joint.
std::vector<FileParts::Origin> FileParts::originsOf(const scene::Mechanism& mechanism,
                                                    const scene::Link& link) {
  const Numbers number(mechanism);
  std::vector<Origin> out;
  for (const scene::Link* l = &link;; l = &mechanism.links[static_cast<std::size_t>(l->parent)]) {
    const scene::Placement& at = l->joint.placement;
    if (l != &link && !isFixed(*l)) break;
    out.push_back(
        {vector(at.xyz, number), vector(at.rpy, number), along(at.beforeJoint(), number)});
  }
  std::reverse(out.begin(), out.end());
  return out;
}

/// A link as it is written.
FileParts::Piece FileParts::pieceOf(const scene::Link& link, const scene::UrdfPart* part,
                                    const Isometry3d& X_before, const Numbers& number) {
  const scene::MassProperties& m = link.inertia;
  Piece piece;
  piece.link = link.name;
  piece.is_fixed = isFixed(link);
  piece.mass = number(m.mass);
  piece.has_inertial = !part || part->has_inertial;
  piece.has_mass = piece.mass != 0 && (!part || part->has_inertial);
  piece.from_parent = X_before.translation();
  piece.turn_from_parent = X_before.linear();
  piece.com = vector(m.com, number);
  piece.R = turn(m.rpy, number);
  piece.I = tensor(m, number);
  if (m.about == scene::MassProperties::About::kLinkOrigin)
    piece.I -= piece.mass * lever(piece.R.transpose() * piece.com);
  if (part)
    for (const scene::MassProperties& solid : part->solids) {
      const Matrix3d R = turn(solid.rpy, number);
      piece.solids.push_back(MassMoments::of(number(solid.mass), vector(solid.com, number),
                                             R * tensor(solid, number) * R.transpose()));
    }
  return piece;
}

void FileParts::build(const scene::Mechanism& mechanism,
                      const std::vector<scene::UrdfPart>* parts) {
  const Numbers number(mechanism);
  if (mechanism.has_gravity) robot_.gravity = vector(mechanism.gravity, number);
  struct Carrier {
    int body = -1;
    Isometry3d X = Isometry3d::Identity();  // x_body = X x_link
  };
  std::vector<Carrier> carriers;
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    const scene::UrdfPart* const part = parts ? &(*parts)[i] : nullptr;
    const Carrier parent =
        link.parent < 0 ? Carrier() : carriers[static_cast<std::size_t>(link.parent)];
    const Isometry3d X_before = along(link.joint.placement.beforeJoint(), number),
                     X_after = along(link.joint.placement.afterJoint(), number);
    Carrier here{parent.body, parent.X * X_before * X_after};
    if (link.parent >= 0 && !isFixed(link)) {
      ReadBody body = jointOf(link, part, number);
      body.parent = parent.body;
      body.placement = parent.X * X_before;
      here = {static_cast<int>(robot_.bodies.size()), X_after};
      origins_.push_back(originsOf(mechanism, link));
      axes_.push_back(vector(link.joint.axis, number));
      where_.push_back(link.where);
      robot_.bodies.push_back(body);
      pieces_.emplace_back();
    }
    carriers.push_back(here);
    if (here.body < 0) continue;
    Piece piece = pieceOf(link, part, X_before, number);
    piece.X = here.X;
    pieces_[static_cast<std::size_t>(here.body)].push_back(std::move(piece));
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

/// A link in the making: what mistakes turn it into, before it is summed up.
struct FileParts::Draft {
  explicit Draft(const Piece& piece)
      : mass(piece.mass),
        com(piece.com),
        R(piece.R),
        I(piece.I),
        X(piece.X),
        tensor_turn(piece.X.linear()) {}

  double mass;
  Vector3d com;
  Matrix3d R, I;
  Isometry3d X;
  Matrix3d tensor_turn;  ///< of the inertia; that of X, but for mistakes
  double about_com = 0;  ///< multiples of m c^2 that are added to the inertia
  double parallel_axes = 1;
  bool from_solids = false, com_not_rotated = false, balanced = false, dropped = false,
       shift_in_axes = false;

  /// A mistake about a link's own <inertial>. @return false: it is none
  bool slipInertial(Mistake mistake, const Piece& piece);
  /// A mistake on merging it into the link that it is fixed to.
  void slipMerging(Mistake mistake, const Piece& piece);
  MassMoments summedUp(const Piece& piece);
};

bool FileParts::Draft::slipInertial(Mistake mistake, const Piece& piece) {
  switch (mistake) {
    case Mistake::kInertialTurnDropped:
      R.setIdentity();
      return true;
    case Mistake::kInertialTurnTransposed:
      R.transposeInPlace();
      return true;
    case Mistake::kInertialTurnOneSide:
    case Mistake::kInertialTurnOneSideLow:
      I = fromTriangle(R * I, mistake == Mistake::kInertialTurnOneSide);
      R.setIdentity();
      return true;
    case Mistake::kInertialTurnTwice:
      R = (R * R).eval();
      return true;
    case Mistake::kProductsDropped:
      I = Matrix3d(I.diagonal().asDiagonal());
      return true;
    case Mistake::kProductsNegated:
      I = 2 * Matrix3d(I.diagonal().asDiagonal()) - I;
      return true;
    case Mistake::kComTurned:
      com = piece.R * com;
      return true;
    case Mistake::kComTurnedBack:
      com = piece.R.transpose() * com;
      return true;
    case Mistake::kComInParent:
      com = piece.turn_from_parent.transpose() * (com - piece.from_parent);
      return true;
    case Mistake::kComDropped:
      com.setZero();
      return true;
    case Mistake::kInertiaAboutJoint:
      about_com -= 1;
      return true;
    case Mistake::kInertiaShiftedTwice:
      about_com += 1;
      return true;
    case Mistake::kInertiaDropped:
      I.setZero();
      return true;
    case Mistake::kBalanced:
      balanced = true;
      return true;
    case Mistake::kFromGeometry:
      from_solids = from_solids || piece.has_mass;
      return true;
    case Mistake::kGeometryWithoutInertial:
      from_solids = from_solids || !piece.has_mass;
      return true;
    case Mistake::kDefaultMass:
    case Mistake::kDefaultMassAlone:
      if (piece.has_mass) return true;
      mass = 1;
      if (mistake == Mistake::kDefaultMass) I.setIdentity();
      return true;
    default:
      return false;
  }
}

void FileParts::Draft::slipMerging(Mistake mistake, const Piece& piece) {
  switch (mistake) {
    case Mistake::kParallelAxisMissing:
      parallel_axes = 0;
      return;
    case Mistake::kParallelAxisDoubled:
      parallel_axes = 2;
      return;
    case Mistake::kParallelAxisNegated:
      parallel_axes = -1;
      return;
    default:
      break;
  }
  if (!piece.is_fixed) return;
  switch (mistake) {
    case Mistake::kNotRotated:
      X.linear().setIdentity();
      tensor_turn.setIdentity();
      return;
    case Mistake::kTensorNotRotated:
      tensor_turn.setIdentity();
      return;
    case Mistake::kComNotRotated:
      com_not_rotated = true;
      return;
    case Mistake::kRotatedBack:
      X.linear() = Matrix3d(X.linear().transpose());
      tensor_turn.transposeInPlace();
      return;
    case Mistake::kNotShifted:
      X.translation().setZero();
      return;
    case Mistake::kShiftInPrincipalAxes:
      shift_in_axes = true;
      return;
    case Mistake::kMassDropped:
      dropped = true;
      return;
    default:
      return;
  }
}

namespace {

/** Principal axes as columns, the largest moment first, as MuJoCo keeps them: those nearest to the
    link's own, then a quarter turn for each two that are not in that order. */
Matrix3d principalAxes(const Matrix3d& I) {
  Vector3d moments = I.diagonal();
  Matrix3d Q = Matrix3d::Identity();
  if (!I.isDiagonal(roundingOf(0))) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(I);
    int order[] = {0, 1, 2};
    double best = -1;
    do {  // as near to the link's axes as signs and orders allow
      Matrix3d V;
      for (int k = 0; k < 3; ++k)
        V.col(k) =
            solver.eigenvectors().col(order[k]) * (solver.eigenvectors()(k, order[k]) < 0 ? -1 : 1);
      if (V.determinant() < 0 || V.trace() <= best) continue;
      best = V.trace();
      Q = V;
      for (int k = 0; k < 3; ++k) moments[k] = solver.eigenvalues()[order[k]];
    } while (std::next_permutation(order, order + 3));
  }
  for (const int k : {0, 1, 0}) {
    if (moments[k] >= moments[k + 1] * (1 - roundingOf(0))) continue;
    std::swap(moments[k], moments[k + 1]);
    const Vector3d about = Vector3d::Unit((k + 2) % 3);
    Q = Q * Eigen::AngleAxisd(boost::math::constants::half_pi<double>(), about);
  }
  return Q;
}

}  // namespace

MassMoments FileParts::Draft::summedUp(const Piece& piece) {
  if (dropped) return {};
  if (from_solids) {
    MassMoments solids;
    for (const MassMoments& solid : piece.solids) solids += solid;
    mass = solids.mass;
    com = solids.com();
    I = solids.aboutCom();
    R.setIdentity();
  }
  I = (R * I * R.transpose() + about_com * mass * lever(com)).eval();
  if (balanced) {
    const Vector3d moments = I.selfadjointView<Eigen::Lower>().eigenvalues();
    if (moments[0] + moments[1] < moments[2]) I = moments.mean() * Matrix3d::Identity();
  }
  if (shift_in_axes) {
    MassMoments out = MassMoments::of(mass, com + principalAxes(I) * X.translation(), I);
    out.reach2 += mass * (X.translation().squaredNorm() + com.squaredNorm());
    return out;
  }
  const Vector3d moved = com_not_rotated ? Vector3d(X.translation() + com) : Vector3d(X * com);
  MassMoments out = MassMoments::of(mass, moved, tensor_turn * I * tensor_turn.transpose());
  out.reach2 += mass * (X.translation().squaredNorm() + com.squaredNorm());
  return out;
}

MassMoments FileParts::readPiece(const Piece& piece, const std::vector<Slip>& slips,
                                 double* parallel_axes) {
  Draft draft(piece);
  for (const Slip& slip : slips)
    if (slip.link.empty() || slip.link == piece.link)
      if (!draft.slipInertial(slip.mistake, piece)) draft.slipMerging(slip.mistake, piece);
  *parallel_axes = draft.parallel_axes;
  return draft.summedUp(piece);
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

bool FileParts::hasInertial(std::size_t body) const {
  return std::any_of(pieces_[body].begin(), pieces_[body].end(),
                     [](const Piece& piece) { return piece.has_inertial; });
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

bool isSame(const MassMoments& a, const MassMoments& b, int links, double unturned, double slip) {
  const double unit = roundingOf(links);
  const double mass = std::max(std::abs(a.mass), std::abs(b.mass));
  const double reach2 = std::max(a.reach2, b.reach2);
  return std::abs(a.mass - b.mass) <= unit * mass &&
         (a.first - b.first).norm() <= unit * std::sqrt(mass * reach2) + mass * slip &&
         (a.second - b.second).norm() <=
             unit * reach2 + unturned * (links + 1.0) * a.aboutCom().cwiseAbs().trace() +
                 2 * a.first.norm() * slip + mass * slip * slip;
}

std::string digitsLost(double share) {
  constexpr double kFewest = 4;  // chosen: half of float's digits
  if (!(share > 0) || !std::isfinite(share)) return "";
  const double digits = -std::log10(share);
  return digits >= kFewest ? fmt::format("digits are lost: {:.1f} are left", digits) : "";
}

NamedMistakes explanation(const FileParts& file, std::size_t body, const MassMoments& seen,
                          double unturned) {
  const std::vector<std::string> links = file.links(body);
  const int count = static_cast<int>(links.size());
  const MassMoments as_it_is = file.read(body, {});
  // a centre of mass that was turned by principal axes has what these lose
  const auto fits = [&](const MassMoments& read, Mistake mistake) {
    MassMoments there = seen;
    if (mistake == Mistake::kShiftInPrincipalAxes &&
        (read.first - seen.first).norm() <=
            unturned * (count + 1.0) * std::sqrt(std::abs(read.mass) * read.reach2)) {
      there.first = read.first;
      there.second = read.second + seen.aboutCom() - read.aboutCom();
    }
    return isSame(read, there, count, unturned);
  };
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
    if (fits(file.read(body, {{mistake, ""}}), mistake)) return {everywhere(mistake), {mistake}};
  for (const Mistake mistake : kMistakes)
    for (std::size_t place = 0; place < links.size(); ++place)
      if (fits(file.readAt(body, place, {mistake}), mistake))
        return {at(mistake, place), {mistake}};
  // two, in the order in which they are listed; those of the parallel axis are the last
  for (const Mistake first : kMistakes)
    for (const Mistake second : kMistakes) {
      if (first >= second) continue;
      const Mistake loosest = first == Mistake::kShiftInPrincipalAxes ? first : second;
      if (fits(file.read(body, {{first, ""}, {second, ""}}), loosest))
        return {everywhere(first) + ", and " + everywhere(second), {first, second}};
      for (std::size_t place = 0; place < links.size() && second < Mistake::kParallelAxisMissing;
           ++place)
        if (fits(file.readAt(body, place, {first, second}), loosest))
          return {at(first, place) + ", and " + at(second, place), {first, second}};
    }
  return {};
}

std::vector<MassReading> misreadings(const FileParts& file, std::size_t body) {
  const std::vector<std::string> links = file.links(body);
  const int count = static_cast<int>(links.size());
  const MassMoments as_it_is = file.read(body, {});
  std::vector<MassReading> out;
  const auto add = [&](Mistake mistake, const std::string& places, const MassMoments& moments) {
    if (!isSame(moments, as_it_is, count, 0))
      out.push_back({std::string(words(mistake)) + " (" + places + ")", mistake, moments});
  };
  std::vector<Mistake> at_several;
  for (const Mistake mistake : kMistakes) {
    std::string places;
    std::size_t changed = 0;
    for (std::size_t place = 0; place < links.size(); ++place) {
      if (isSame(file.readAt(body, place, {mistake}), as_it_is, count, 0)) continue;
      places += (places.empty() ? "" : ", ") + links[place];
      ++changed;
    }
    add(mistake, places, file.read(body, {{mistake, ""}}));
    if (changed > 1) at_several.push_back(mistake);
  }
  for (const Mistake mistake : at_several)
    for (std::size_t place = 0; place < links.size(); ++place)
      add(mistake, links[place], file.readAt(body, place, {mistake}));
  return out;
}

std::vector<MassReading> pairsOfMisreadings(const FileParts& file, std::size_t body) {
  const std::vector<std::string> links = file.links(body);
  std::vector<MassReading> out;
  for (const Mistake first : kMistakes)
    for (const Mistake second : kMistakes) {
      if (first >= second) continue;
      const std::string both = std::string(words(first)) + ", and " + words(second);
      out.push_back({both, first, file.read(body, {{first, ""}, {second, ""}})});
      for (std::size_t place = 0; place < links.size() && links.size() > 1; ++place)
        out.push_back(
            {both + " (" + links[place] + ")", first, file.readAt(body, place, {first, second})});
    }
  return out;
}

std::vector<JointReading> jointMisreadings(const FileParts& file, std::size_t body) {
  const ReadBody& ours = file.robot().bodies[body];
  std::vector<JointReading> out;
  for (const FrameMistake mistake :
       {FrameMistake::kTurnDropped, FrameMistake::kTurnTransposed, FrameMistake::kTurnReversed,
        FrameMistake::kShiftDropped, FrameMistake::kShiftTurned}) {
    JointReading one{"origin", words(mistake), ours};
    one.body.placement = file.readOrigin(body, mistake);
    if (!one.body.placement.isApprox(ours.placement, roundingOf(ours.links))) out.push_back(one);
  }
  if (!hasOnePosition(ours)) return out;
  const auto axis = [&](const std::string& rule, const Vector3d& a) {
    if ((a - ours.axis).norm() <= roundingOf(0)) return;
    out.push_back({"axis", rule, ours});
    out.back().body.axis = a;
  };
  axis("the axis is not normalised", file.writtenAxis(body));
  const Matrix3d R = file.turnOfOrigin(body);
  axis("the axis is taken in the parent link's frame", R.transpose() * ours.axis);
  axis("the axis is taken in the parent link's frame", R * ours.axis);
  axis("the axis has the other sign", -ours.axis);
  for (int k = 0; k < 3; ++k)
    axis(std::string("the axis is ") + "xyz"[k] + ", whatever the file says", Vector3d::Unit(k));
  using Kind = scene::JointKind;
  const Kind other = ours.kind == Kind::kRevolute ? Kind::kPrismatic : Kind::kRevolute;
  out.push_back({"joint kind",
                 std::string(scene::name(ours.kind)) + " is read as " + scene::name(other), ours});
  out.back().body.kind = other;
  return out;
}

std::string gravityMistake(const Vector3d& file, const Vector3d& seen) {
  const double size = file.norm();
  if (seen.isZero(0)) return "there is none";
  if ((file + seen).norm() <= roundingOf(0) * size) return "it has the other sign";
  if (file.cross(seen).norm() <= roundingOf(0) * size * seen.norm() && file.dot(seen) > 0)
    return "it has another size";
  if (std::abs(seen.norm() - size) <= roundingOf(0) * size) return "it points elsewhere";
  return "";
}

std::string publicRecord(const std::string& reader, Mistake mistake) {
  struct Record {
    const char* reader;  // how its name begins
    Mistake mistake;
    const char* link;
  };
  constexpr const char* kFused = "https://github.com/google-deepmind/mujoco/issues/2982";
  static constexpr Record kRecords[] = {
      {"mujoco", Mistake::kInertialTurnDropped,
       "https://github.com/google-deepmind/mujoco/issues/3559"},
      {"mujoco", Mistake::kTensorNotRotated, kFused},
      {"mujoco", Mistake::kNotRotated, kFused},
      {"mujoco", Mistake::kShiftInPrincipalAxes, kFused},
      {"mujoco", Mistake::kNotShifted, kFused},
      {"mujoco", Mistake::kComNotRotated, kFused},
      {"mujoco", Mistake::kParallelAxisMissing, kFused},
      {"dart", Mistake::kInertialTurnDropped, "https://github.com/dartsim/dart/issues/47"},
      {"dart", Mistake::kDefaultMass, "https://github.com/dartsim/dart/issues/1604"},
      {"kdl", Mistake::kComTurned, "https://github.com/ros/robot_model/pull/66"},
  };
  for (const Record& record : kRecords)
    if (record.mistake == mistake && reader.rfind(record.reader, 0) == 0) return record.link;
  return "";
}

}  // namespace dynwitness::crosscheck
