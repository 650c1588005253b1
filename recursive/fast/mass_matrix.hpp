// SPDX-License-Identifier: Apache-2.0
// The joint-space mass matrix by composite bodies over a plan.
#pragma once

#include "recursive/fast/plan.hpp"

namespace dynwitness::recursive::fast {

/// Four numbers side by side: the columns of M that are carried inward together.
template <typename T>
struct Lanes {
  static constexpr int kCount = 4;
  T v[kCount];

  T get(int i) const { return v[i]; }
  void set(int i, const T& x) { v[i] = x; }
  Lanes operator+(const Lanes& b) const {
    return {{v[0] + b.v[0], v[1] + b.v[1], v[2] + b.v[2], v[3] + b.v[3]}};
  }
  Lanes operator-(const Lanes& b) const {
    return {{v[0] - b.v[0], v[1] - b.v[1], v[2] - b.v[2], v[3] - b.v[3]}};
  }
  Lanes operator-() const { return {{-v[0], -v[1], -v[2], -v[3]}}; }
  friend Lanes operator*(const T& s, const Lanes& b) {
    return {{s * b.v[0], s * b.v[1], s * b.v[2], s * b.v[3]}};
  }
};

/// The same in vector registers, two numbers each: every machine of the x86-64 and AArch64 kind has them.
template <>
struct Lanes<double> {
  typedef double Pair __attribute__((vector_size(16)));
  static constexpr int kCount = 4;
  Pair low, high;

  double get(int i) const { return i < 2 ? low[i] : high[i - 2]; }
  void set(int i, double x) { reinterpret_cast<double*>(this)[i] = x; }
  Lanes operator+(const Lanes& b) const { return {low + b.low, high + b.high}; }
  Lanes operator-(const Lanes& b) const { return {low - b.low, high - b.high}; }
  Lanes operator-() const { return {-low, -high}; }
  friend Lanes operator*(double s, const Lanes& b) { return {s * b.low, s * b.high}; }
};

template <typename T>
struct MassMatrixWorkspace {
  explicit MassMatrixWorkspace(const Plan<T>& plan)
      : turns(plan.links.size()),
        branches(plan.branches),
        columns(plan.dof_of_column.size() / Lanes<T>::kCount),
        others(plan) {}
  struct Composite {
    T mass;
    Vec<T> h;
    Symmetric3<T> I;
  };
  /// Force and moment that hold up accelerations of joints outboard, about the origin of the link at hand.
  struct Columns {
    Lanes<T> f_x, f_y, f_z, n_x, n_y, n_z;
  };
  std::vector<CosSin<T>> turns;
  std::vector<Composite> branches;
  std::vector<Columns> columns;
  OtherJoints<T> others;
};

namespace detail {

// a vector of lanes passes a joint as a vector of numbers does
template <typename T>
DYNWITNESS_INLINE void turnLanes(const T& c, const T& s, Lanes<T>& a, Lanes<T>& b) {
  const Lanes<T> new_a = c * a - s * b;
  b = s * a + c * b;
  a = new_a;
}
template <Step kStep, typename T>
DYNWITNESS_INLINE void inwardLanes(const Way<kStep, T>& way, Lanes<T>& x, Lanes<T>& y, Lanes<T>& z) {
  if constexpr (kStep != Step::kOther) turnLanes(way.c, way.s, x, y);
  if constexpr (kStep == Step::kTurnQuarter) {
    const Lanes<T> new_y = -(way.link.s * z);
    z = way.link.s * y;
    y = new_y;
  }
  if constexpr (kStep == Step::kTurnTwist || kStep == Step::kSlideTwist)
    turnLanes(way.link.c, way.link.s, y, z);
  if constexpr (Way<kStep, T>::kHasMatrix) {
    const Mat<T>& R = *way.R;
    const Lanes<T> new_x = R.xx * x + R.yx * y + R.zx * z, new_y = R.xy * x + R.yy * y + R.zy * z;
    z = R.xz * x + R.yz * y + R.zz * z;
    x = new_x;
    y = new_y;
  }
}

/// Composite body of mass m about the joint, to about the parent's origin, from which the joint is at p.
template <typename Composite, typename T>
DYNWITNESS_INLINE void shiftBack(const Vec<T>& p, const T& mass, Composite& x) {
  const Vec<T> h = x.h, h_A = h + p * mass;
  const Vec<T> k = h + h_A;
  const T a = p.x * k.x, b = p.y * k.y, c = p.z * k.z;
  x.I = x.I + Symmetric3<T>{b + c, a + c, a + b, -(p.y * h.x + h_A.y * p.x), -(p.z * h.x + h_A.z * p.x),
                            -(p.z * h.y + h_A.z * p.y)};
  x.h = h_A;
}

}  // namespace detail

/** M(q), n x n, both halves, a symmetric matrix row by row or column by column; as recursive::massMatrix.
        (1)  I_C of p  +=  R' I_C R shifted by p            everything outboard of a joint as one body
        (2)  F = I_C Z,  M_ii = Z' F + d                    the column that moves joint i alone
        (3)  all columns outboard of a joint are carried through it together, four a block; M_ij = Z_j' F
    @param M  n n numbers, written whole */
template <typename T>
void massMatrix(const Plan<T>& plan, const JointPosition<T>* x, MassMatrixWorkspace<T>& ws, T* M) {
  using Composite = typename MassMatrixWorkspace<T>::Composite;
  using Columns = typename MassMatrixWorkspace<T>::Columns;
  constexpr int kCount = Lanes<T>::kCount;
  const int n = static_cast<int>(plan.links.size()), dof = plan.dof;
  if (!plan.is_chain) std::fill(M, M + static_cast<std::size_t>(dof) * dof, T(0));
  const auto write = [&](int d, int from, int begin, int end, const Lanes<T>& row) DYNWITNESS_INLINE_LAMBDA {
    const int first = std::max(begin, from), last = std::min(end, from + kCount);
    for (int k = first; k < last; ++k) {
      const int e = plan.dof_of_column[k];
      if (e < 0) continue;  // between two branches
      const T value = row.get(k - from);
      M[static_cast<std::size_t>(d) * dof + e] = value;
      M[static_cast<std::size_t>(e) * dof + d] = value;
    }
  };

  Composite I_C;  // of the link at hand; between two, what the link before hands inward
  for (int i = n - 1; i >= 0; --i) {
    const Link<T>& link = plan.links[i];
    if (link.end == i + 1) {
      I_C = {link.mass, link.h, link.I};
    } else {
      I_C.mass = I_C.mass + link.mass;
      I_C.h = I_C.h + link.h;
      I_C.I = I_C.I + link.I;
    }
    if (link.branch >= 0) {
      const Composite& sum = ws.branches[link.branch];
      I_C = {I_C.mass + sum.mass, I_C.h + sum.h, I_C.I + sum.I};
    }
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, ws.others);
      const auto setColumn = [&](int column, const Vec<T>& f, const Vec<T>& m) DYNWITNESS_INLINE_LAMBDA {
        Columns& block = ws.columns[column / kCount];
        const int lane = column % kCount;
        block.f_x.set(lane, f.x), block.f_y.set(lane, f.y), block.f_z.set(lane, f.z);
        block.n_x.set(lane, m.x), block.n_y.set(lane, m.y), block.n_z.set(lane, m.z);
      };
      const Vec<T>& h = I_C.h;
      const Symmetric3<T>& I = I_C.I;
      if constexpr (isTurn(kStep)) {
        setColumn(link.column, {-h.y, h.x, T(0)}, {I.xz, I.yz, I.zz});                 // (2)
        M[static_cast<std::size_t>(link.dof) * dof + link.dof] = I.zz + link.rotor;
      } else if constexpr (isSlide(kStep)) {
        setColumn(link.column, {T(0), T(0), I_C.mass}, {h.y, -h.x, T(0)});
        M[static_cast<std::size_t>(link.dof) * dof + link.dof] = I_C.mass + link.rotor;
      } else {
        for (int k = 0; k < link.axes; ++k) {
          Vec<T> v = Vec<T>::zero(), w = Vec<T>::zero();
          const T one[6] = {T(k == 0), T(k == 1), T(k == 2), T(k == 3), T(k == 4), T(k == 5)};
          Link<T> unit = link;
          unit.dof = 0;
          otherMotion(unit, one, v, w);
          const Vec<T> f = v * I_C.mass + cross(w, h), m = cross(h, v) + times(I, w);
          setColumn(link.column + k, f, m);
          for (int l = 0; l <= k; ++l) {
            const T value = alongAxis(link, l, f, m);
            const std::size_t d = link.dof + k, e = link.dof + l;
            M[d * dof + e] = M[e * dof + d] = l == k ? T(value + link.rotor) : value;
          }
        }
      }
      if (link.parent == 0) return;
      const Vec<T> p = jointPlace<kStep>(link, x, ws.others);
      const Link<T>& parent = plan.links[link.parent - 1];
      for (int b = link.column / kCount; b * kCount < link.end_column; ++b) {           // (3)
        Columns& F = ws.columns[b];
        detail::inwardLanes(way, F.f_x, F.f_y, F.f_z);
        detail::inwardLanes(way, F.n_x, F.n_y, F.n_z);
        if (link.is_apart) {
          F.n_x = F.n_x + (p.y * F.f_z - p.z * F.f_y);
          F.n_y = F.n_y + (p.z * F.f_x - p.x * F.f_z);
          F.n_z = F.n_z + (p.x * F.f_y - p.y * F.f_x);
        }
        const int from = b * kCount;
        if (isTurn(parent.step)) {
          write(parent.dof, from, link.column, link.end_column, F.n_z);
        } else if (isSlide(parent.step)) {
          write(parent.dof, from, link.column, link.end_column, F.f_z);
        } else {
          const Lanes<T> entries[6] = {F.f_x, F.f_y, F.f_z, F.n_x, F.n_y, F.n_z};
          for (int l = 0; l < parent.axes; ++l) {
            Lanes<T> row = F.n_z;
            if (parent.kind == JointKind::kHelical) row = row + parent.pitch * F.f_z;
            else row = entries[parent.axes == 6 ? l : l + 3];
            write(parent.dof + l, from, link.column, link.end_column, row);
          }
        }
      }
      way.inward(I_C.h);                                                              // (1)
      way.inward(I_C.I);
      if (link.is_apart) detail::shiftBack(p, I_C.mass, I_C);
    });
    if (link.parent == i || link.parent == 0) continue;
    Composite& sum = ws.branches[plan.links[link.parent - 1].branch];
    if (link.is_last_child) sum = I_C;
    else sum = {sum.mass + I_C.mass, sum.h + I_C.h, sum.I + I_C.I};
  }
}

}  // namespace dynwitness::recursive::fast
