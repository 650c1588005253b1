// SPDX-License-Identifier: Apache-2.0
// The joint-space mass matrix by composite bodies over a plan.
#pragma once

#include "recursive/fast/plan.hpp"

namespace dynwitness::recursive::fast {

/// As many numbers as a block has columns, side by side, on any scalar.
template <typename T>
struct Lanes {
  T v[kBlock];

  static Lanes load(const T* from) { return {{from[0], from[1], from[2], from[3]}}; }
  void store(T* to) const {
    for (int i = 0; i < kBlock; ++i) to[i] = v[i];
  }
  /// One by one, this many numbers apart.
  void scatter(T* to, std::size_t apart) const {
    for (int i = 0; i < kBlock; ++i) to[i * apart] = v[i];
  }
  void scatterThree(T* to, std::size_t apart) const {
    for (int i = 0; i < 3; ++i) to[i * apart] = v[i];
  }
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

/// The same for double in vector registers of two, which every x86-64 and AArch64 processor has ...
struct TwoPairs {
  typedef double Pair __attribute__((vector_size(16)));
  typedef double Memory __attribute__((vector_size(16), aligned(8), may_alias));
  Pair low, high;

  static DYNWITNESS_INLINE TwoPairs load(const double* from) {
    return {*reinterpret_cast<const Memory*>(from), *reinterpret_cast<const Memory*>(from + 2)};
  }
  DYNWITNESS_INLINE void store(double* to) const {
    *reinterpret_cast<Memory*>(to) = low;
    *reinterpret_cast<Memory*>(to + 2) = high;
  }
  DYNWITNESS_INLINE void scatter(double* to, std::size_t apart) const {
    scatterThree(to, apart);
    to[3 * apart] = high[1];
  }
  DYNWITNESS_INLINE void scatterThree(double* to, std::size_t apart) const {
    to[0] = low[0], to[apart] = low[1], to[2 * apart] = high[0];
  }
  DYNWITNESS_INLINE TwoPairs operator+(const TwoPairs& b) const { return {low + b.low, high + b.high}; }
  DYNWITNESS_INLINE TwoPairs operator-(const TwoPairs& b) const { return {low - b.low, high - b.high}; }
  DYNWITNESS_INLINE TwoPairs operator-() const { return {-low, -high}; }
  friend DYNWITNESS_INLINE TwoPairs operator*(double s, const TwoPairs& b) { return {s * b.low, s * b.high}; }
};

/// ... and of four.
struct Quad {
  typedef double Four __attribute__((vector_size(32)));
  typedef double Memory __attribute__((vector_size(32), aligned(8), may_alias));
  Four v;

  static DYNWITNESS_INLINE Quad load(const double* from) {
    return {*reinterpret_cast<const Memory*>(from)};
  }
  DYNWITNESS_INLINE void store(double* to) const { *reinterpret_cast<Memory*>(to) = v; }
  DYNWITNESS_INLINE void scatter(double* to, std::size_t apart) const {
    scatterThree(to, apart);
    to[3 * apart] = v[3];
  }
  DYNWITNESS_INLINE void scatterThree(double* to, std::size_t apart) const {
    to[0] = v[0], to[apart] = v[1], to[2 * apart] = v[2];
  }
  DYNWITNESS_INLINE Quad operator+(const Quad& b) const { return {v + b.v}; }
  DYNWITNESS_INLINE Quad operator-(const Quad& b) const { return {v - b.v}; }
  DYNWITNESS_INLINE Quad operator-() const { return {-v}; }
  friend DYNWITNESS_INLINE Quad operator*(double s, const Quad& b) { return {s * b.v}; }
};

/// What the sweep writes on, sized once for a plan.
template <typename T>
struct MassMatrixWorkspace {
  explicit MassMatrixWorkspace(const Plan<T>& plan)
      : frames(plan.links.size() + 1),
        branches(plan.branches),
        columns(plan.dof_of_column.size() / kBlock),
        others(plan) {
    for (Frame& frame : frames) frame = {};
    for (Columns& block : columns) block = {};
    frames[0].x[0] = frames[0].y[1] = frames[0].z[2] = T(1);
  }
  struct Frame {
    T c, s;                                        ///< of the joint's angle
    T x[kBlock], y[kBlock], z[kBlock], p[kBlock];  ///< axes, and the way from the parent, in the world's
  };
  struct Composite {
    T mass;
    Vec<T> h;
    Symmetric3<T> I;
  };
  /// In world axes: forces of accelerations of joints outboard, and moments about the link at hand.
  struct Columns {
    T f_x[kBlock], f_y[kBlock], f_z[kBlock], n_x[kBlock], n_y[kBlock], n_z[kBlock];
  };
  std::vector<Frame> frames;  ///< the first is the world
  std::vector<Composite> branches;
  std::vector<Columns> columns;
  OtherJoints<T> others;
};

namespace detail {

/// The axes of a frame, each a vector of lanes, from the parent's through a joint.
template <Step kStep, typename T, typename Pack>
DYNWITNESS_INLINE void axesThrough(const Way<kStep, T>& way, Pack& x, Pack& y, Pack& z) {
  if constexpr (kStep == Step::kTurnQuarter) {
    const Pack new_y = way.link.s * z;
    z = -(way.link.s * y);
    y = new_y;
  }
  if constexpr (kStep == Step::kTurnTwist || kStep == Step::kSlideTwist) {
    const Pack new_y = way.link.c * y + way.link.s * z;
    z = way.link.c * z - way.link.s * y;
    y = new_y;
  }
  if constexpr (Way<kStep, T>::kHasMatrix) {
    const Mat<T>& R = *way.R;
    const Pack new_x = R.xx * x + R.xy * y + R.xz * z, new_y = R.yx * x + R.yy * y + R.yz * z;
    z = R.zx * x + R.zy * y + R.zz * z;
    x = new_x;
    y = new_y;
  }
  if constexpr (kStep != Step::kOther) {
    const Pack new_x = way.c * x + way.s * y;
    y = way.c * y - way.s * x;
    x = new_x;
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

namespace detail {

template <typename Pack, typename T>
DYNWITNESS_INLINE void massMatrixBody(const Plan<T>& plan, const JointPosition<T>* x,
                                      MassMatrixWorkspace<T>& ws, T* M) {
  using Frame = typename MassMatrixWorkspace<T>::Frame;
  using Composite = typename MassMatrixWorkspace<T>::Composite;
  using Columns = typename MassMatrixWorkspace<T>::Columns;
  const int n = static_cast<int>(plan.links.size());
  const std::size_t dof = plan.dof;
  // by pointers: what is stored through them could otherwise be the vectors' own, and be read anew each time
  const Link<T>* const links = plan.links.data();
  const ColumnBlock* const blocks = plan.blocks.data();
  Frame* const frames = ws.frames.data();
  Columns* const columns = ws.columns.data();
  const auto along = [](const T* e, const T* x, const T* y, const T* z) DYNWITNESS_INLINE_LAMBDA {
    return e[0] * Pack::load(x) + e[1] * Pack::load(y) + e[2] * Pack::load(z);
  };

  // outward: the links' axes
  for (int i = 0; i < n; ++i) {
    const Link<T>& link = links[i];
    const Frame& parent = frames[link.parent];
    Frame& frame = frames[i + 1];
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayThrough<kStep>(plan, link, x, ws.others);
      frame.c = way.c;
      frame.s = way.s;
      Pack e_x = Pack::load(parent.x), e_y = Pack::load(parent.y), e_z = Pack::load(parent.z);
      if (link.is_apart) {
        const Vec<T> p = jointPlace<kStep>(link, x, ws.others);
        (p.x * e_x + p.y * e_y + p.z * e_z).store(frame.p);
      }
      axesThrough(way, e_x, e_y, e_z);
      e_x.store(frame.x);
      e_y.store(frame.y);
      e_z.store(frame.z);
    });
  }

  if (!plan.is_chain) std::fill(M, M + dof * dof, T(0));  // branches do not feel each other
  // one row for the columns of a block; in a full one, columns before the joint's own are written again
  // when their turn comes
  const auto write = [&](int d, int b, int first_column, const Pack& row) DYNWITNESS_INLINE_LAMBDA {
    const int first_dof = blocks[b].first_dof;
    if (first_dof >= 0) {
      row.store(M + d * dof + first_dof);
      row.scatter(M + first_dof * dof + d, dof);
      return;
    }
    T values[kBlock];
    row.store(values);
    for (int k = std::max(blocks[b].first_column, first_column); k < (b + 1) * kBlock; ++k) {
      const std::size_t to = plan.dof_of_column[k];
      M[d * dof + to] = M[to * dof + d] = values[k - b * kBlock];
    }
  };
  // the same for a joint of several axes, or a screw
  const auto writeOther = [&](const Link<T>& at, const Frame& frame, int b, int first_column) {
    const Columns& F = columns[b];
    for (int l = 0; l < at.axes; ++l) {
      const bool slides = at.kind == JointKind::kFloating && l < 3;
      const int axis = at.axes == 1 ? 2 : l % 3;
      const T* const e = axis == 0 ? frame.x : axis == 1 ? frame.y : frame.z;
      Pack row = slides ? along(e, F.f_x, F.f_y, F.f_z) : along(e, F.n_x, F.n_y, F.n_z);
      if (at.kind == JointKind::kHelical) row = row + at.pitch * along(e, F.f_x, F.f_y, F.f_z);
      write(at.dof + l, b, first_column, row);
    }
  };

  Composite I_C;  // of the link at hand; between two, what the link before hands inward
  for (int i = n - 1; i >= 0; --i) {
    const Link<T>& link = links[i];
    const Frame& frame = frames[i + 1];
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
    {
      const Vec<T>& h = I_C.h;
      const Symmetric3<T>& I = I_C.I;
      const Pack e_x = Pack::load(frame.x), e_y = Pack::load(frame.y), e_z = Pack::load(frame.z);
      const auto setColumn = [&](unsigned column, const Pack& f, const Pack& m) DYNWITNESS_INLINE_LAMBDA {
        Columns& block = columns[column / kBlock];
        f.scatterThree(block.f_x + column % kBlock, kBlock);
        m.scatterThree(block.n_x + column % kBlock, kBlock);
      };
      if (isTurn(link.step)) {                                                         // (2)
        setColumn(link.column, h.x * e_y - h.y * e_x, I.xz * e_x + I.yz * e_y + I.zz * e_z);
        M[link.dof * dof + link.dof] = I.zz + link.rotor;
      } else if (isSlide(link.step)) {
        setColumn(link.column, I_C.mass * e_z, h.y * e_x - h.x * e_y);
        M[link.dof * dof + link.dof] = I_C.mass + link.rotor;
      } else {
        for (int k = 0; k < link.axes; ++k) {
          Vec<T> v = Vec<T>::zero(), w = Vec<T>::zero();
          addAlongAxis(link, k, T(1), v, w);
          const Vec<T> f = v * I_C.mass + cross(w, h), m = cross(h, v) + times(I, w);
          setColumn(link.column + k, f.x * e_x + f.y * e_y + f.z * e_z, m.x * e_x + m.y * e_y + m.z * e_z);
          for (int l = 0; l <= k; ++l) {
            const T value = alongAxis(link, l, f, m);
            const std::size_t d = link.dof + k, e = link.dof + l;
            M[d * dof + e] = M[e * dof + d] = l == k ? T(value + link.rotor) : value;
          }
        }
      }
    }
    if (link.parent == 0) continue;
    const Link<T>& parent = links[link.parent - 1];
    const Frame& inboard = frames[link.parent];
    const T p_x = frame.p[0], p_y = frame.p[1], p_z = frame.p[2];
    const T z_x = inboard.z[0], z_y = inboard.z[1], z_z = inboard.z[2];
    for (int b = link.first_block; b < link.end_block; ++b) {                           // (3)
      Columns& F = columns[b];
      Pack n_x = Pack::load(F.n_x), n_y = Pack::load(F.n_y), n_z = Pack::load(F.n_z);
      if (link.is_apart) {
        const Pack f_x = Pack::load(F.f_x), f_y = Pack::load(F.f_y), f_z = Pack::load(F.f_z);
        n_x = n_x + (p_y * f_z - p_z * f_y);
        n_y = n_y + (p_z * f_x - p_x * f_z);
        n_z = n_z + (p_x * f_y - p_y * f_x);
        n_x.store(F.n_x), n_y.store(F.n_y), n_z.store(F.n_z);
      }
      if (isTurn(parent.step)) {
        write(parent.dof, b, link.column, z_x * n_x + z_y * n_y + z_z * n_z);
      } else if (isSlide(parent.step)) {
        write(parent.dof, b, link.column, along(inboard.z, F.f_x, F.f_y, F.f_z));
      } else {
        writeOther(parent, inboard, b, link.column);
      }
    }
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      const auto way = wayBack<kStep>(plan, link, frame.c, frame.s, ws.others);
      way.inward(I_C.h);                                                              // (1)
      way.inward(I_C.I);
      if (link.is_apart) shiftBack(jointPlace<kStep>(link, x, ws.others), I_C.mass, I_C);
    });
    if (link.parent == i) continue;
    Composite& sum = ws.branches[parent.branch];
    if (link.is_last_child) sum = I_C;
    else sum = {sum.mass + I_C.mass, sum.h + I_C.h, sum.I + I_C.I};
  }
}

DYNWITNESS_FOR_AVX2 inline void massMatrixForAvx2(const Plan<double>& plan, const JointPosition<double>* x,
                                                  MassMatrixWorkspace<double>& ws, double* M) {
  massMatrixBody<Quad>(plan, x, ws, M);
}

}  // namespace detail

/** M(q), n x n, both halves, a symmetric matrix row by row or column by column; as recursive::massMatrix.
        (1)  I_C of p  +=  R' I_C R shifted by p            everything outboard of a joint as one body
        (2)  F = I_C Z,  M_ii = Z' F + d                    the column that moves joint i alone
        (3)  all columns outboard of a joint are carried inward together, four a block; M_ij = Z_j' F
    Columns keep to the world's axes, so that a joint turns none of them: n += p x f is all.
    @param M  n n numbers, written whole */
template <typename T>
void massMatrix(const Plan<T>& plan, const JointPosition<T>* x, MassMatrixWorkspace<T>& ws, T* M) {
  if constexpr (std::is_same_v<T, double>) {
    if (kHasAvx2) return detail::massMatrixForAvx2(plan, x, ws, M);
    detail::massMatrixBody<TwoPairs>(plan, x, ws, M);
  } else {
    detail::massMatrixBody<Lanes<T>>(plan, x, ws, M);
  }
}

}  // namespace dynwitness::recursive::fast
