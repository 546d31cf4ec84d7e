#pragma once

#include <Eigen/Core>
#include <cmath>
#include <compare>
#include <cstdint>

namespace trimquad {

/// A map coordinate as a whole number of quanta. Absolute values stay under 2^44, so that sums, quarter-turn
/// rotations and translations are exact, products of differences fit __int128, and the double is exact too.
using Quanta = std::int64_t;
__extension__ using WideQuanta = __int128;

inline constexpr int kCoordinateBits = 44;

/// A point or a difference in a chart of the map.
struct FixedVector {
  Quanta u = 0, v = 0;

  friend bool operator==(const FixedVector&, const FixedVector&) = default;
  friend auto operator<=>(const FixedVector&, const FixedVector&) = default;
  friend FixedVector operator+(FixedVector a, FixedVector b) { return {a.u + b.u, a.v + b.v}; }
  friend FixedVector operator-(FixedVector a, FixedVector b) { return {a.u - b.u, a.v - b.v}; }
  FixedVector operator-() const { return {-u, -v}; }
  Quanta operator[](int axis) const { return axis == 0 ? u : v; }
};

/// `a` turned counter-clockwise by `quarters` times 90 degrees.
inline FixedVector rotated(FixedVector a, int quarters) {
  switch (quarters & 3) {
    case 1:
      return {-a.v, a.u};
    case 2:
      return {-a.u, -a.v};
    case 3:
      return {a.v, -a.u};
    default:
      return a;
  }
}

/// One quad edge is 2^bits quanta. Chosen per region so that every coordinate stays under 2^44.
struct FixedScale {
  int bits = 32;

  Quanta one() const { return Quanta(1) << bits; }
  double toQuads(Quanta x) const { return std::ldexp(double(x), -bits); }
  Eigen::Vector2d toQuads(FixedVector a) const { return {toQuads(a.u), toQuads(a.v)}; }
  Quanta round(double quads) const { return std::llround(std::ldexp(quads, bits)); }
  FixedVector round(const Eigen::Vector2d& a) const { return {round(a.x()), round(a.y())}; }
  bool isInteger(Quanta x) const { return (x & (one() - 1)) == 0; }
  bool isInteger(FixedVector a) const { return isInteger(a.u) && isInteger(a.v); }

  /// The finest scale at which coordinates up to `largest` quads (in absolute value) fit.
  static FixedScale fitting(double largest);
};

inline WideQuanta cross(FixedVector a, FixedVector b) {
  return WideQuanta(a.u) * b.v - WideQuanta(a.v) * b.u;
}
inline WideQuanta dot(FixedVector a, FixedVector b) {
  return WideQuanta(a.u) * b.u + WideQuanta(a.v) * b.v;
}
inline int sign(WideQuanta x) {
  return (x > 0) - (x < 0);
}

/// +1 if a, b, c turn left (counter-clockwise), -1 if right, 0 if they lie on one line. Exact.
inline int orientation(FixedVector a, FixedVector b, FixedVector c) {
  return sign(cross(b - a, c - a));
}

/// A seam's chart change: x -> rotation(x) + translation. Exact.
struct Transition {
  int rotation = 0;  ///< quarter turns, 0..3
  FixedVector translation;

  friend bool operator==(const Transition&, const Transition&) = default;
  FixedVector operator()(FixedVector x) const { return rotated(x, rotation) + translation; }
  bool isIdentity() const { return rotation == 0 && translation == FixedVector{}; }
  Transition inverse() const { return {(4 - rotation) & 3, -rotated(translation, 4 - rotation)}; }
  /// First `inner`, then this.
  Transition after(const Transition& inner) const {
    return {(rotation + inner.rotation) & 3, rotated(inner.translation, rotation) + translation};
  }
};

/// Order along the edge a -> b of its crossings with the axis-parallel lines x[axis1] = c1 and x[axis2] = c2
/// (both must cross it properly, or touch an end): negative if the first crossing comes first. Exact.
int compareCrossings(FixedVector a, FixedVector b, int axis1, Quanta c1, int axis2, Quanta c2);

/// Whether direction `d` points into the sector swept counter-clockwise from `from` to `to`, strictly. A
/// sector with from and to in the same direction is the full turn. Exact.
bool strictlyInsideSector(FixedVector from, FixedVector to, FixedVector d);

}  // namespace trimquad
