// SPDX-License-Identifier: Apache-2.0
// Vectors of four links or axes side by side: structures of arrays, read and written by lanes of
// packs or one lane at a time.
#pragma once

#include "recursive/fast/lanes.hpp"

namespace dynwitness::recursive::fast {

template <typename T>
DYNWITNESS_INLINE T dot(const Vec<T>& a, const Vec<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Four vectors.
template <typename T>
struct Wide3 {
  T x[kBlock], y[kBlock], z[kBlock];

  template <typename Pack>
  DYNWITNESS_INLINE Vec<Pack> load(int lane = 0) const {
    return {Pack::load(x + lane), Pack::load(y + lane), Pack::load(z + lane)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE Vec<Pack> loadFrom(int first, int lane) const {
    const int of_pack = first - lane;
    return {Pack::loadFrom(of_pack, x + lane), Pack::loadFrom(of_pack, y + lane),
            Pack::loadFrom(of_pack, z + lane)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE void store(const Vec<Pack>& v, int lane = 0) {
    v.x.store(x + lane), v.y.store(y + lane), v.z.store(z + lane);
  }
  /// One of them, whose components are the lanes of a pack.
  template <typename Pack>
  DYNWITNESS_INLINE void scatter(int lane, const Pack& v) {
    v.scatterThree(x + lane, kBlock);
  }
  DYNWITNESS_INLINE Vec<T> at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  DYNWITNESS_INLINE void set(int lane, const Vec<T>& v) {
    x[lane] = v.x, y[lane] = v.y, z[lane] = v.z;
  }
  DYNWITNESS_INLINE void add(int lane, const Vec<T>& v) { set(lane, at(lane) + v); }
};

/// Four symmetric matrices.
template <typename T>
struct Wide6 {
  T xx[kBlock], yy[kBlock], zz[kBlock], xy[kBlock], xz[kBlock], yz[kBlock];

  template <typename Pack>
  DYNWITNESS_INLINE Symmetric3<Pack> load(int lane = 0) const {
    return {Pack::load(xx + lane), Pack::load(yy + lane), Pack::load(zz + lane),
            Pack::load(xy + lane), Pack::load(xz + lane), Pack::load(yz + lane)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE void store(const Symmetric3<Pack>& m, int lane = 0) {
    m.xx.store(xx + lane), m.yy.store(yy + lane), m.zz.store(zz + lane);
    m.xy.store(xy + lane), m.xz.store(xz + lane), m.yz.store(yz + lane);
  }
  DYNWITNESS_INLINE Symmetric3<T> at(int lane) const {
    return {xx[lane], yy[lane], zz[lane], xy[lane], xz[lane], yz[lane]};
  }
  DYNWITNESS_INLINE void set(int lane, const Symmetric3<T>& m) {
    xx[lane] = m.xx, yy[lane] = m.yy, zz[lane] = m.zz;
    xy[lane] = m.xy, xz[lane] = m.xz, yz[lane] = m.yz;
  }
  DYNWITNESS_INLINE void add(int lane, const Symmetric3<T>& m) { set(lane, at(lane) + m); }
};

}  // namespace dynwitness::recursive::fast
