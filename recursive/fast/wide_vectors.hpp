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
  DYNWITNESS_INLINE Vec<Pack> load() const {
    return {Pack::load(x), Pack::load(y), Pack::load(z)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE Vec<Pack> loadFrom(int first) const {
    return {Pack::loadFrom(first, x), Pack::loadFrom(first, y), Pack::loadFrom(first, z)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE void store(const Vec<Pack>& v) {
    v.x.store(x), v.y.store(y), v.z.store(z);
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
  DYNWITNESS_INLINE Symmetric3<Pack> load() const {
    return {Pack::load(xx), Pack::load(yy), Pack::load(zz),
            Pack::load(xy), Pack::load(xz), Pack::load(yz)};
  }
  template <typename Pack>
  DYNWITNESS_INLINE void store(const Symmetric3<Pack>& m) {
    m.xx.store(xx), m.yy.store(yy), m.zz.store(zz);
    m.xy.store(xy), m.xz.store(xz), m.yz.store(yz);
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
