// SPDX-License-Identifier: Apache-2.0
// The joint-space mass matrix by composite bodies over a plan.
#pragma once

#include <vector>

#include "recursive/fast/lanes.hpp"
#include "recursive/fast/plan.hpp"

namespace dynwitness::recursive::fast {

/// Of each rate those inboard that it feels, from the world on: all other entries of its row of the
/// lower half of M are zero by nature.
template <typename P>
std::vector<std::vector<int>> ratesInboard(const Plan<P>& plan) {
  std::vector<std::vector<int>> inboard(plan.dof);
  for (const Link<P>& link : plan.links) {
    int p = link.parent;
    while (p > 0 && plan.links[p - 1].axes == 0) p = plan.links[p - 1].parent;
    const int last = p == 0 ? -1 : plan.links[p - 1].dof + plan.links[p - 1].axes - 1;
    for (int k = 0, d = link.dof; k < link.axes; ++k, ++d) {
      const int next = k == 0 ? last : d - 1;
      if (next < 0) continue;
      inboard[d] = inboard[next];
      inboard[d].push_back(next);
    }
  }
  return inboard;
}

/// What the sweep writes on, sized once for a plan.
template <typename T>
struct MassMatrixWorkspace {
  template <typename P>
  explicit MassMatrixWorkspace(const Plan<P>& plan)
      : frames(plan.links.size() + 1),
        branches(plan.branches),
        columns(plan.blocks.size()),
        others(plan) {
    for (const Link<P>& link : plan.links)
      passages.push_back({link.parent, link.dof, link.column, link.axes, link.step, link.is_apart});
    for (Frame& frame : frames) frame = {};
    for (Columns& block : columns) block = {};
    frames[0].x[0] = frames[0].y[1] = frames[0].z[2] = T(1);
  }
  /// What columns need on their way inward comes first: a line of the cache for a double.
  struct alignas(64) Frame {
    T z[kBlock], p[kBlock];  ///< axis, and the way from the parent, in the world's axes
    T x[kBlock], y[kBlock];  ///< the other axes
    T c, s;                  ///< of the joint's angle
  };
  /// What else they need of a link: links are too large to be read again for each block.
  struct Passage {
    int parent, dof, column, axes;
    Step step;
    bool is_apart;
  };
  struct Composite {
    T mass;
    Vec<T> h;
    Symmetric3<T> I;
  };
  /// In world axes: forces of the accelerations of joints, and moments about each joint's own
  /// origin.
  struct Columns {
    T f_x[kBlock], f_y[kBlock], f_z[kBlock], n_x[kBlock], n_y[kBlock], n_z[kBlock];
  };
  std::vector<Frame> frames;      ///< the first is the world
  std::vector<Passage> passages;  ///< of the links
  std::vector<Composite> branches;
  std::vector<Columns> columns;
  OtherJoints<T> others;
};

namespace detail {

/// The axes of a frame, each a vector of lanes, from the parent's through a joint.
template <Step kStep, typename T, typename P, typename Pack>
DYNWITNESS_INLINE void axesThrough(const Way<kStep, T, P>& way, Pack& x, Pack& y, Pack& z) {
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
  if constexpr (Way<kStep, T, P>::kHasMatrix) {
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

/// Mass, h and I about the joint, to about the parent's origin, from which the joint is at p.
template <typename T>
DYNWITNESS_INLINE void shiftBack(const Vec<T>& p, const T& mass, Vec<T>& h, Symmetric3<T>& I) {
  const Vec<T> h_A = h + p * mass;
  const Vec<T> k = h + h_A;
  const T a = p.x * k.x, b = p.y * k.y, c = p.z * k.z;
  I = I + Symmetric3<T>{b + c,
                        a + c,
                        a + b,
                        -(p.y * h.x + h_A.y * p.x),
                        -(p.z * h.x + h_A.z * p.x),
                        -(p.z * h.y + h_A.z * p.y)};
  h = h_A;
}

/// @tparam kWhole  false: the upper half and the diagonal only, of rates that feel each other
template <typename Pack, bool kWhole = true, typename T, typename P>
DYNWITNESS_INLINE void massMatrixBody(const Plan<P>& plan, const JointPosition<T>* x,
                                      MassMatrixWorkspace<T>& ws, T* M) {
  using Frame = typename MassMatrixWorkspace<T>::Frame;
  using Composite = typename MassMatrixWorkspace<T>::Composite;
  using Columns = typename MassMatrixWorkspace<T>::Columns;
  const int n = static_cast<int>(plan.links.size());
  const std::size_t dof = plan.dof;
  // pointers of our own: a compiler must think that what is stored might be those of the vectors
  const Link<P>* const links = plan.links.data();
  Frame* const frames = ws.frames.data();
  Columns* const columns = ws.columns.data();
  using Passage = typename MassMatrixWorkspace<T>::Passage;
  const Passage* const passages = ws.passages.data();
  // outward: the links' axes
  for (int i = 0; i < n; ++i) {
    const Link<P>& link = links[i];
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

  // inward: what is outboard of each joint as one body, and the column that moves this joint alone
  Composite I_C;  // of the link at hand; between two, what the link before hands inward
  if (kWhole && !plan.is_chain)
    std::fill(M, M + dof * dof, T(0));  // branches do not feel each other
  for (int i = n - 1; i >= 0; --i) {
    const Link<P>& link = links[i];
    const Frame& frame = frames[i + 1];
    if (link.end == i + 1) {
      I_C = {in<T>(link.mass), in<T>(link.h), in<T>(link.I)};
    } else {
      I_C.mass = I_C.mass + link.mass;
      I_C.h = I_C.h + in<T>(link.h);
      I_C.I = I_C.I + in<T>(link.I);
    }
    if (link.branch >= 0) {
      const Composite& sum = ws.branches[link.branch];
      I_C = {I_C.mass + sum.mass, I_C.h + sum.h, I_C.I + sum.I};
    }
    withStep(link.step, [&](auto step) DYNWITNESS_INLINE_LAMBDA {
      constexpr Step kStep = decltype(step)::value;
      Vec<T> h = I_C.h;
      Symmetric3<T> I = I_C.I;
      const Pack e_x = Pack::load(frame.x), e_y = Pack::load(frame.y), e_z = Pack::load(frame.z);
      const auto setColumn = [&](unsigned column, const Pack& f, const Pack& m)
                                 DYNWITNESS_INLINE_LAMBDA {
                                   Columns& block = columns[column / kBlock];
                                   f.scatterThree(block.f_x + column % kBlock, kBlock);
                                   m.scatterThree(block.n_x + column % kBlock, kBlock);
                                 };
      if constexpr (isTurn(kStep)) {  // (2)
        setColumn(link.column, h.x * e_y - h.y * e_x,
                  I.xz * e_x + I.yz * e_y + (I.zz + link.spin) * e_z);
        M[link.dof * dof + link.dof] = I.zz + link.rotor;
      } else if constexpr (isSlide(kStep)) {
        setColumn(link.column, I_C.mass * e_z, h.y * e_x - h.x * e_y + link.spin * e_z);
        M[link.dof * dof + link.dof] = I_C.mass + link.rotor;
      } else {
        for (int k = 0; k < link.axes; ++k) {
          Vec<T> v = Vec<T>::zero(), w = Vec<T>::zero();
          addAlongAxis(link, k, T(1), v, w);
          const Vec<T> f = v * I_C.mass + cross(w, h), m = cross(h, v) + times(I, w);
          setColumn(link.column + k, f.x * e_x + f.y * e_y + f.z * e_z,
                    m.x * e_x + m.y * e_y + (m.z + link.spin) * e_z);
          for (int l = 0; l <= k; ++l) {
            const T value = alongAxis(link, l, f, m);
            const std::size_t d = link.dof + k, e = link.dof + l;
            M[d * dof + e] = M[e * dof + d] = l == k ? T(value + link.rotor) : value;
          }
        }
      }
      if (link.parent == 0) return;
      const auto way = wayBack<kStep>(link, frame.c, frame.s, ws.others);
      way.inward(h);  // (1)
      way.inward(I);
      if (link.is_apart) shiftBack(jointPlace<kStep>(link, x, ws.others), I_C.mass, h, I);
      I_C.h = h;
      I_C.I = I;
    });
    if (link.parent == i || link.parent == 0) continue;  // the parent is next, or the world
    Composite& sum = ws.branches[links[link.parent - 1].branch];
    if (link.is_last_child)
      sum = I_C;
    else
      sum = {sum.mass + I_C.mass, sum.h + I_C.h, sum.I + I_C.I};
  }

  // block by block, inward: what the joints on the way to the world feel of the block's columns
  for (const ColumnBlock& block : plan.blocks) {
    const auto write = [&](int d, int first_column, const Pack& row) DYNWITNESS_INLINE_LAMBDA {
      T *const across = M + d * dof, *const down = M + d;
      if (block.first_dof >= 0 && first_column <= block.begin) {
        row.store(across + block.first_dof);
        if constexpr (kWhole) row.scatter(down + block.first_dof * dof, dof);
        return;
      }
      T values[kBlock];
      row.store(values);
      for (int k = std::max(block.first_column, first_column) - block.begin; k < kBlock; ++k) {
        const std::size_t to = block.dofs[k];
        across[to] = values[k];
        if constexpr (kWhole) down[to * dof] = values[k];
      }
    };
    const auto along = [](const T* e, const Pack& x, const Pack& y, const Pack& z)
                           DYNWITNESS_INLINE_LAMBDA { return e[0] * x + e[1] * y + e[2] * z; };
    const Columns& F = columns[block.begin / kBlock];
    Pack f_x, f_y, f_z, n_x = Pack::load(F.n_x), n_y = Pack::load(F.n_y), n_z = Pack::load(F.n_z);
    const Passage* link = passages + block.last_link;
    const Frame* frame = frames + block.last_link + 1;
    while (link->parent > 0) {
      const Passage* const next = passages + (link->parent - 1);
      const Frame* const inboard = frames + link->parent;
      if (link->column + link->axes > block.begin) {
        // its columns join; the force of those inboard is left out, and their moment stays what it
        // was
        const int lane = link->column - block.begin;
        f_x = Pack::loadFrom(lane, F.f_x);
        f_y = Pack::loadFrom(lane, F.f_y);
        f_z = Pack::loadFrom(lane, F.f_z);
      }
      if (link->is_apart) {  // (3)
        const T* const p = frame->p;
        n_x = n_x + (p[1] * f_z - p[2] * f_y);
        n_y = n_y + (p[2] * f_x - p[0] * f_z);
        n_z = n_z + (p[0] * f_y - p[1] * f_x);
      }
      if (isTurn(next->step)) {
        write(next->dof, link->column, along(inboard->z, n_x, n_y, n_z));
      } else if (isSlide(next->step)) {
        write(next->dof, link->column, along(inboard->z, f_x, f_y, f_z));
      } else {
        const Link<P>& other = links[link->parent - 1];
        for (int l = 0; l < next->axes; ++l) {
          const bool slides = other.kind == JointKind::kFloating && l < 3;
          const int axis = next->axes == 1 ? 2 : l % 3;
          const T* const e = axis == 0 ? inboard->x : axis == 1 ? inboard->y : inboard->z;
          Pack row = slides ? along(e, f_x, f_y, f_z) : along(e, n_x, n_y, n_z);
          if (other.kind == JointKind::kHelical) row = row + other.pitch * along(e, f_x, f_y, f_z);
          write(next->dof + l, link->column, row);
        }
      }
      link = next;
      frame = inboard;
    }
  }
}

DYNWITNESS_FOR_AVX2 inline void massMatrixForAvx2(const Plan<double>& plan,
                                                  const JointPosition<double>* x,
                                                  MassMatrixWorkspace<double>& ws, double* M) {
  massMatrixBody<Quad>(plan, x, ws, M);
}

}  // namespace detail

/** M(q), n x n, both halves, a symmetric matrix row by row or column by column; as
    recursive::massMatrix.
        (1)  I_C of p  +=  R' I_C R shifted by p          everything outboard of a joint as one body
        (2)  F = I_C Z,  M_ii = Z' F + d                    the column that moves joint i alone
        (3)  columns are carried inward together, four a block;  M_ij = Z_j' F
    A gyroscopic rotor of the joint, spun up, needs the moment h z of the parent: F has it from
    there on. Columns keep to the world's axes, so that a joint turns none of them: n += p x f is
    all.
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
