// SPDX-License-Identifier: Apache-2.0
// A model made ready once for the fast sweeps: one contiguous record a link, in the order in which
// a sweep wants them, with everything that the state cannot change already done.
//
// Three things save the most:
//  - Link frames are turned about their own joint axes, which nobody notices outside, so that the
//    fixed turn from parent to child is one about x alone, or none at all: a quarter turn costs no
//    product. Which links allow it is decided by exact zeros; the others keep a matrix.
//  - The kind of a joint and of its fixed turn pick the code once a link (Step), not once an entry.
//   - Links stand depth first, so that the one processed last is the first child of the next one
//     inward, and hands its result over in registers; only branches are written to memory.
// The same source runs on every scalar. recursive/*.hpp holds the textbook sweeps; the tests and
// the crosscheck hold these to be the same functions.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "recursive/fast/dispatch.hpp"
#include "recursive/fast/lanes.hpp"
#include "recursive/fast/vector.hpp"
#include "recursive/model.hpp"

namespace dynwitness::recursive::fast {

/// What the code of a sweep is specialised for: what the joint does, and the fixed turn before it.
enum class Step {
  kTurnStraight,
  kTurnQuarter,
  kTurnTwist,
  kTurnMatrix,
  kSlideTwist,
  kSlideMatrix,
  kOther
};

/// Everything constant about a link, in the axes of its (turned) frame.
template <typename T>
struct Link {
  Step step = Step::kOther;
  JointKind kind = JointKind::kFixed;
  int parent = 0;  ///< place of the parent's record: 0 is the world, k + 1 link k of the plan
  int dof = -1, slot = -1, axes = 0;
  int branch =
      -1;  ///< where the inertias of all children but the first are summed; -1: at most one
  int matrix = -1;         ///< place of the fixed turn, or of the joint's, among the matrices
  int end = 0;             ///< the first link after this one that is not outboard of it
  int column = 0;          ///< of the joint's first axis in the blocks of force columns
  bool is_apart = false;   ///< the joint is not at the parent's origin
  bool is_offset = false;  ///< the angle has a constant part
  bool is_loaded = false;
  bool is_special = false;  ///< friction, or a gyroscopic rotor
  bool is_sprung = false;   ///< a spring, or special
  bool is_last_child = false;
  T c = T(1), s = T(0);      ///< of the fixed turn about x
  T c_o = T(1), s_o = T(0);  ///< of the angle's constant part
  Vec<T> p, slide;           ///< joint seen from the parent, and the axis there
  T mass;
  Vec<T> h;
  Symmetric3<T> I;
  Vec<T> D;  ///< I_zz - I_yy, I_xx - I_zz, I_yy - I_xx
  T rotor, stiffness, rest, pitch;
  T viscous, positive, negative;  ///< friction
  T spin, rotor_less_spin;        ///< of a gyroscopic rotor that the parent carries
  Vec<T> force, moment;           ///< constant load about the origin
};

template <typename T>
bool isExactlyZero(const T& x) {
  if constexpr (std::is_floating_point_v<T>)
    return x == T(0);
  else
    return x.isZero();
}

template <typename T>
struct PlannedLoad {
  int link;
  Vec<T> force, moment, at;
};

struct ColumnBlock {
  int begin = 0;                        ///< column, a multiple of kBlock
  int dofs[kBlock] = {-1, -1, -1, -1};  ///< -1: the column is not in use
  int first_dof = -1;  ///< of as many consecutive ones; -1: they are not, or a column is not in use
  int first_column = 0;  ///< the first in use; all after it are
  int last_link = -1;    ///< whose joint has the last column
};

/// Built once from a model, then constant.
template <typename T>
struct Plan {
  explicit Plan(const Model<T>& model);

  std::vector<Link<T>> links;
  std::vector<Mat<T>> matrices;
  std::vector<ColumnBlock> blocks;
  std::vector<PlannedLoad<T>> world_loads;
  Vec<T> gravity;
  int dof, positions, branches = 0;
  bool is_chain = true;  ///< every joint feels every other one
  bool has_specials = false;

 private:
  void order(const Model<T>& model);
  void fill(const Model<T>& model);
  void layColumns();
  std::vector<int> link_of_;  ///< of the model, in the plan's order
};

/// Depth first, by a stack of our own: a chain of a million links must not end the program's.
template <typename T>
void Plan<T>::order(const Model<T>& model) {
  const int n = static_cast<int>(model.links.size());
  std::vector<int> first(n + 1, -1), next(n, -1);
  for (int i = n - 1; i >= 0; --i) {  // last to first: the lists come out in the model's order
    const int p = model.links[i].parent + 1;
    next[i] = first[p];
    first[p] = i;
  }
  std::vector<int> place(n, -1), stack;
  const auto push = [&](int record) {
    std::vector<int>::size_type at = stack.size();
    for (int i = first[record]; i >= 0; i = next[i]) stack.push_back(i);
    for (std::size_t b = stack.size(); at + 1 < b; ++at) std::swap(stack[at], stack[--b]);
  };
  push(0);
  while (!stack.empty()) {
    const int i = stack.back();
    stack.pop_back();
    place[i] = static_cast<int>(link_of_.size());
    link_of_.push_back(i);
    push(i + 1);
  }
  links.resize(n);
  for (int k = 0; k < n; ++k) {
    const int p = model.links[link_of_[k]].parent;
    links[k].parent = p < 0 ? 0 : place[p] + 1;
    if (links[k].parent != k) {
      is_chain = false;
      if (links[k].parent > 0 && links[links[k].parent - 1].branch < 0)
        links[links[k].parent - 1].branch = branches++;
    }
  }
  std::vector<char> seen(n + 1, 0);
  for (int k = n - 1; k >= 0; --k) {
    links[k].end = std::max(links[k].end, k + 1);
    if (links[k].parent > 0) {
      Link<T>& parent = links[links[k].parent - 1];
      parent.end = std::max(parent.end, links[k].end);
    }
    links[k].is_last_child = !seen[links[k].parent];
    seen[links[k].parent] = 1;
  }
  for (const WorldLoad<T>& load : model.world_loads)
    world_loads.push_back({place[load.link], Vec<T>::from(load.force), Vec<T>::from(load.moment),
                           Vec<T>::from(load.at)});
}

namespace detail {

/// Coordinates in a frame turned about z by a quarter, k times.
template <typename T>
Vec<T> inQuarters(int k, Vec<T> v) {
  for (; k > 0; --k) v = {v.y, -v.x, v.z};
  return v;
}
template <typename T>
Symmetric3<T> inQuarters(int k, Symmetric3<T> m) {
  for (; k > 0; --k) m = {m.yy, m.xx, m.zz, -m.xy, m.yz, -m.xz};
  return m;
}

}  // namespace detail

template <typename T>
void Plan<T>::fill(const Model<T>& model) {
  const int n = static_cast<int>(links.size());
  // a link's frame is turned by a quarter if its first child can then be reached by a turn about x:
  // if x is across the child's axis, which is the last row of the fixed turn
  std::vector<char> quarters(n + 1, 0), decided(n + 1, 0);
  for (int k = 0; k < n; ++k) {
    const Link<T>& link = links[k];
    const auto& axis = model.links[link_of_[k]].X_tree.R;
    const bool turns = axisCount(model.links[link_of_[k]].kind) == 1;
    if (decided[link.parent] || !turns || link.parent == 0) continue;
    const JointKind of_parent = model.links[link_of_[link.parent - 1]].kind;
    if (of_parent != JointKind::kRevolute && of_parent != JointKind::kPrismatic) continue;
    if (isExactlyZero(axis(2, 0)) || isExactlyZero(axis(2, 1))) {
      quarters[link.parent] = isExactlyZero(axis(2, 0)) ? 0 : 1;
      decided[link.parent] = 1;
    }
  }
  for (int k = 0; k < n; ++k) {
    const LinkModel<T>& from = model.links[link_of_[k]];
    Link<T>& to = links[k];
    // NOLINTNEXTLINE(bugprone-signed-char-misuse): small numbers, no letters
    const int here = quarters[k + 1], there = quarters[to.parent];
    to.kind = from.kind;
    to.dof = from.dof;
    to.slot = from.slot;
    to.axes = axisCount(from.kind);
    to.p = detail::inQuarters(there, Vec<T>::from(from.X_tree.p));
    to.is_apart = from.kind == JointKind::kPrismatic || from.kind == JointKind::kFloating ||
                  from.kind == JointKind::kHelical || !isExactlyZero(to.p.x) ||
                  !isExactlyZero(to.p.y) || !isExactlyZero(to.p.z);
    to.mass = from.M.mass;
    to.h = detail::inQuarters(here, Vec<T>::from(from.M.h));
    to.I = detail::inQuarters(here, from.M.I);
    to.D = {to.I.zz - to.I.yy, to.I.xx - to.I.zz, to.I.yy - to.I.xx};
    to.rotor = from.rotor;
    to.stiffness = from.stiffness;
    to.rest = from.rest;
    to.pitch = from.pitch;
    to.force = detail::inQuarters(here, Vec<T>::from(from.load.force));
    to.moment = detail::inQuarters(here, Vec<T>::from(from.load.moment));
    to.viscous = from.viscous;
    to.positive = from.positive;
    to.negative = from.negative;
    to.spin = to.parent > 0 ? from.spin : T(0);  // the world does not turn, and feels nothing
    to.rotor_less_spin = to.rotor - to.spin;
    for (const T* x : {&to.viscous, &to.positive, &to.negative, &to.spin})
      to.is_special = to.is_special || !isExactlyZero(*x);
    has_specials = has_specials || to.is_special;
    to.is_sprung = to.is_special || !isExactlyZero(to.stiffness);
    for (const T* x :
         {&to.force.x, &to.force.y, &to.force.z, &to.moment.x, &to.moment.y, &to.moment.z})
      to.is_loaded = to.is_loaded || !isExactlyZero(*x);

    // R = turn after x, from the parent's turned axes: its rows
    Mat<T> R = Mat<T>::from(from.X_tree.R);
    const auto row = [&](T& x, T& y, T& z) {
      const Vec<T> v = detail::inQuarters(there, Vec<T>{x, y, z});
      x = v.x, y = v.y, z = v.z;
    };
    row(R.xx, R.xy, R.xz);
    row(R.yx, R.yy, R.yz);
    row(R.zx, R.zy, R.zz);
    to.slide = {R.zx, R.zy, R.zz};
    const bool turns = from.kind == JointKind::kRevolute,
               slides = from.kind == JointKind::kPrismatic;
    Vec<T> offset = {T(1), T(0), T(0)};  // cos and sin of the angle's constant part, about z
    if ((turns || slides) && isExactlyZero(R.zx)) {
      // R = Rz(o)' Rx(a)':  first column (cos o, -sin o, 0), last row (0, -sin a, cos a)
      offset = {R.xx, -R.yx, T(0)};
      to.c = R.zz;
      to.s = -R.zy;
      to.step = slides                                              ? Step::kSlideTwist
                : isExactlyZero(to.s) && isExactlyZero(to.c - T(1)) ? Step::kTurnStraight
                : isExactlyZero(to.c)                               ? Step::kTurnQuarter
                                                                    : Step::kTurnTwist;
    } else {
      to.step = turns ? Step::kTurnMatrix : slides ? Step::kSlideMatrix : Step::kOther;
      to.matrix = static_cast<int>(matrices.size());
      matrices.push_back(R);
    }
    for (int quarter = here; quarter > 0; --quarter) offset = {-offset.y, offset.x, T(0)};
    to.c_o = offset.x;
    to.s_o = offset.y;
    to.is_offset = !isExactlyZero(to.s_o) || !isExactlyZero(to.c_o - T(1));
  }
  for (PlannedLoad<T>& load : world_loads)
    load.at = detail::inQuarters(quarters[load.link + 1], load.at);
}

template <typename T>
Plan<T>::Plan(const Model<T>& model)
    : gravity(Vec<T>::from(model.gravity)), dof(model.dof()), positions(model.positions) {
  requireOwnRates(model, "Plan");
  order(model);
  fill(model);
  link_of_.clear();
  link_of_.shrink_to_fit();
  layColumns();
}

/// Columns, four a block. What a branch leaves of its blocks is left at its inboard end: no block
/// holds columns of two branches, and its outermost four columns, which are carried farthest, fill
/// one.
template <typename T>
void Plan<T>::layColumns() {
  const int n = static_cast<int>(links.size());
  const auto roundedUp = [](int count) { return (count + kBlock - 1) / kBlock * kBlock; };
  int column = 0;
  for (int first = 0, end; first < n; first = end) {
    int axes = links[first].axes;
    for (end = first + 1; end < n && links[end].parent == end; ++end) axes += links[end].axes;
    column += roundedUp(axes) - axes;
    for (int k = first; k < end; ++k) {
      links[k].column = column;
      column += links[k].axes;
    }
  }
  blocks.resize(column / kBlock);
  for (int k = 0; k < n; ++k)
    for (int a = 0; a < links[k].axes; ++a) {
      ColumnBlock& block = blocks[(links[k].column + a) / kBlock];
      block.dofs[(links[k].column + a) % kBlock] = links[k].dof + a;
      block.last_link = k;
    }
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    ColumnBlock& block = blocks[b];
    block.begin = block.first_column = static_cast<int>(b) * kBlock;
    block.first_dof = block.dofs[0];
    for (int k = 1; k < kBlock; ++k) {
      if (block.dofs[k - 1] < 0) block.first_column = block.begin + k;
      if (block.dofs[k] != block.first_dof + k) block.first_dof = -1;
    }
  }
}

// ---- between a link and its parent --------------------------------------------------------------

/** How vectors and matrices pass the joint: outward from the parent's axes to the link's, inward
    back. The step is a constant, so that each passage is straight code. */
template <Step kStep, typename T, typename P = T>
struct Way {
  const Link<P>& link;
  T c, s;           ///< of the joint's angle
  const Mat<T>* R;  ///< for steps by matrix; of kOther the whole turn, joint included

  DYNWITNESS_INLINE Vec<T> outward(Vec<T> v) const {
    if constexpr (kStep == Step::kTurnQuarter) quarterAboutX(P(-link.s), v);
    if constexpr (kStep == Step::kTurnTwist || kStep == Step::kSlideTwist)
      turnAboutX(link.c, P(-link.s), v);
    if constexpr (kHasMatrix) v = times(*R, v);
    if constexpr (kStep != Step::kOther) turnAboutZ(c, T(-s), v);
    return v;
  }
  /// Vec, Symmetric3 or Mat
  template <typename X>
  DYNWITNESS_INLINE void inward(X& x) const {
    if constexpr (kStep != Step::kOther) turnAboutZ(c, s, x);
    if constexpr (kStep == Step::kTurnQuarter) quarterAboutX(link.s, x);
    if constexpr (kStep == Step::kTurnTwist || kStep == Step::kSlideTwist)
      turnAboutX(link.c, link.s, x);
    if constexpr (kHasMatrix) {
      if constexpr (std::is_same_v<X, Vec<T>>)
        x = transposedTimes(*R, x);
      else
        turnBack(*R, x);
    }
  }

  static constexpr bool kHasMatrix =
      kStep == Step::kTurnMatrix || kStep == Step::kSlideMatrix || kStep == Step::kOther;
};

constexpr bool isTurn(Step step) {
  return step == Step::kTurnStraight || step == Step::kTurnQuarter || step == Step::kTurnTwist ||
         step == Step::kTurnMatrix;
}
constexpr bool isSlide(Step step) {
  return step == Step::kSlideTwist || step == Step::kSlideMatrix;
}

/// Calls f with the step as a constant.
template <typename F>
DYNWITNESS_INLINE void withStep(Step step, const F& f) {
  switch (step) {
    case Step::kTurnStraight:
      return f(std::integral_constant<Step, Step::kTurnStraight>());
    case Step::kTurnQuarter:
      return f(std::integral_constant<Step, Step::kTurnQuarter>());
    case Step::kTurnTwist:
      return f(std::integral_constant<Step, Step::kTurnTwist>());
    case Step::kTurnMatrix:
      return f(std::integral_constant<Step, Step::kTurnMatrix>());
    case Step::kSlideTwist:
      return f(std::integral_constant<Step, Step::kSlideTwist>());
    case Step::kSlideMatrix:
      return f(std::integral_constant<Step, Step::kSlideMatrix>());
    case Step::kOther:
      return f(std::integral_constant<Step, Step::kOther>());
  }
}

/// Cosine and sine of the joint's angle, the constant part included.
template <Step kStep, typename T, typename P>
DYNWITNESS_INLINE void jointAngle(const Link<P>& link, const JointPosition<T>* x, T& c, T& s) {
  if constexpr (isTurn(kStep)) {
    c = x[link.slot].c;
    s = x[link.slot].s;
    if (link.is_offset) turn(link.c_o, link.s_o, c, s);
  } else {
    c = link.c_o;
    s = link.s_o;
  }
}

/// The whole turn, and the place, of a joint that is neither turning nor sliding about one axis.
template <typename T, typename P>
void otherJoint(const Link<P>& link, const Mat<P>& constant, const JointPosition<T>* x, Mat<T>& R,
                Vec<T>& p) {
  const Mat<T>& fixed = in<T>(constant);
  R = fixed;
  p = in<T>(link.p);
  if (link.kind == JointKind::kHelical) {
    p = p + in<T>(link.slide) * (link.pitch * x[link.slot].q);
    const T c = x[link.slot].c, s = x[link.slot].s;
    R = {c * fixed.xx + s * fixed.yx,
         c * fixed.xy + s * fixed.yy,
         c * fixed.xz + s * fixed.yz,
         c * fixed.yx - s * fixed.xx,
         c * fixed.yy - s * fixed.xy,
         c * fixed.yz - s * fixed.xz,
         fixed.zx,
         fixed.zy,
         fixed.zz};
  } else if (link.axes >= 3) {
    int slot = link.slot;
    if (link.kind == JointKind::kFloating) {
      p = p + transposedTimes(fixed, Vec<T>{x[slot].q, x[slot + 1].q, x[slot + 2].q});
      slot += 3;
    }
    const auto joint = rotation(&x[slot]);  // its transpose turns into the link's axes
    const auto row = [&](int k) {
      return transposedTimes(fixed, Vec<T>{joint(0, k), joint(1, k), joint(2, k)});
    };
    const Vec<T> r0 = row(0), r1 = row(1), r2 = row(2);
    R = {r0.x, r0.y, r0.z, r1.x, r1.y, r1.z, r2.x, r2.y, r2.z};
  }
}

/// The motion through a joint of several axes, at these rates, in link axes.
template <typename T, typename P>
void otherMotion(const Link<P>& link, const T* rates, Vec<T>& linear, Vec<T>& angular) {
  linear = angular = Vec<T>::zero();
  const T* rate = link.dof < 0 ? nullptr : rates + link.dof;
  switch (link.kind) {
    case JointKind::kHelical:
      linear.z = link.pitch * rate[0];
      angular.z = rate[0];
      break;
    case JointKind::kFloating:
      linear = {rate[0], rate[1], rate[2]};
      rate += 3;
      [[fallthrough]];
    case JointKind::kSpherical:
      angular = {rate[0], rate[1], rate[2]};
      break;
    default:
      break;
  }
}

/// What friction takes of a joint's force at this rate; as recursive::frictionForce.
template <typename T, typename P>
T frictionForce(const Link<P>& link, const T& rate) {
  const int direction = scene::directionOf(rate);
  T force = link.viscous * rate;
  if (direction > 0) force = force + link.positive;
  if (direction < 0) force = force - link.negative;
  return force;
}
/// The same with what the joint's spring takes.
template <typename T, typename P>
DYNWITNESS_INLINE T passiveForce(const Link<P>& link, const JointPosition<T>* x, const T& rate) {
  const T force = link.stiffness * (x[link.slot].q - link.rest);
  return link.is_special ? T(force + frictionForce(link, rate)) : force;
}

/// Z_k' F for the axes of any joint.
template <typename T, typename P>
T alongAxis(const Link<P>& link, int k, const Vec<T>& f, const Vec<T>& n) {
  const auto entry = [](const Vec<T>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
  switch (link.kind) {
    case JointKind::kPrismatic:
      return f.z;
    case JointKind::kHelical:
      return n.z + link.pitch * f.z;
    case JointKind::kSpherical:
      return entry(n, k);
    case JointKind::kFloating:
      return k < 3 ? entry(f, k) : entry(n, k - 3);
    default:
      return n.z;
  }
}

/// (a, wd) += Z_k rate
template <typename T, typename P>
void addAlongAxis(const Link<P>& link, int k, const T& rate, Vec<T>& a, Vec<T>& wd) {
  const auto add = [&](Vec<T>& v, int i) { (i == 0 ? v.x : i == 1 ? v.y : v.z) += rate; };
  switch (link.kind) {
    case JointKind::kHelical:
      a.z = a.z + link.pitch * rate;
      wd.z = wd.z + rate;
      break;
    case JointKind::kFloating:
      k < 3 ? add(a, k) : add(wd, k - 3);
      break;
    default:
      add(wd, k);
  }
}

/// The matrices of a plan, which depend on the state where joints are kOther, and their places.
template <typename T>
struct OtherJoints {
  template <typename P>
  explicit OtherJoints(const Plan<P>& plan) : p(plan.matrices.size()) {
    for (const Mat<P>& matrix : plan.matrices) R.push_back(in<T>(matrix));
  }
  std::vector<Mat<T>> R;  ///< parent axes to link axes, a joint that is kOther included
  std::vector<Vec<T>> p;  ///< joint seen from the parent
};

/// The way through a joint at these positions, for the first time in this state.
template <Step kStep, typename T, typename P>
DYNWITNESS_INLINE Way<kStep, T, P> wayThrough(const Plan<P>& plan, const Link<P>& link,
                                              const JointPosition<T>* x, OtherJoints<T>& others) {
  Way<kStep, T, P> way{link, T(1), T(0), nullptr};
  jointAngle<kStep>(link, x, way.c, way.s);
  if constexpr (kStep == Step::kOther)
    otherJoint(link, plan.matrices[link.matrix], x, others.R[link.matrix], others.p[link.matrix]);
  if constexpr (Way<kStep, T, P>::kHasMatrix) way.R = &others.R[link.matrix];
  return way;
}
/// The same again, its angle remembered.
template <Step kStep, typename T, typename P>
DYNWITNESS_INLINE Way<kStep, T, P> wayBack(const Link<P>& link, const T& c, const T& s,
                                           const OtherJoints<T>& others) {
  const Mat<T>* R = nullptr;
  if constexpr (Way<kStep, T, P>::kHasMatrix) R = &others.R[link.matrix];
  return {link, c, s, R};
}

/// Where the joint is, seen from the parent [m].
template <Step kStep, typename T, typename P>
DYNWITNESS_INLINE Vec<T> jointPlace(const Link<P>& link, const JointPosition<T>* x,
                                    const OtherJoints<T>& others) {
  if constexpr (isSlide(kStep)) return in<T>(link.p) + in<T>(link.slide) * x[link.slot].q;
  if constexpr (kStep == Step::kOther) return others.p[link.matrix];
  return in<T>(link.p);
}

/// Calls f(link, place of its record, step) for the links with friction or a gyroscopic rotor;
/// plans without any pay nothing.
template <typename T, typename F>
void forEachSpecial(const Plan<T>& plan, const F& f) {
  if (!plan.has_specials) return;
  for (int i = 0; i < static_cast<int>(plan.links.size()); ++i) {
    const Link<T>& link = plan.links[i];
    if (link.is_special)
      withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA { f(link, i + 1, step); });
  }
}

/// Onto each parent's moment what the gyroscopic rotors of its children's joints ask of it:
///     h (z qdd + w_p x z qd),
/// qdd left out where there is none. The motions hold w of the link itself, which differs along z
/// only.
template <typename T, typename P, typename Motion, typename Record>
void addRotors(const Plan<P>& plan, const T* qd, const T* qdd, const OtherJoints<T>& others,
               const std::vector<Motion>& motions, std::vector<Record>& records) {
  forEachSpecial(plan, [&](const Link<P>& link, int record, auto step) DYNWITNESS_INLINE_LAMBDA {
    const Record& r = records[record];
    const Vec<T>& w = motions[record].w;
    Vec<T> rotor = Vec<T>{w.y, -w.x, T(0)} * (link.spin * qd[link.dof]);
    if (qdd) rotor.z = link.spin * qdd[link.dof];
    wayBack<decltype(step)::value>(link, r.c, r.s, others).inward(rotor);
    records[link.parent].n = records[link.parent].n + rotor;
  });
}

}  // namespace dynwitness::recursive::fast
