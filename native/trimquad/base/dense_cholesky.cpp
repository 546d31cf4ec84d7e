#include "trimquad/base/dense_cholesky.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

// The kernels below are compiled once for every processor and once for those with AVX2, from one source.
#if defined(__x86_64__) && defined(__GNUC__)
#define TRIMQUAD_HAS_AVX2_KERNELS 1
#endif
#define TRIMQUAD_INLINE inline __attribute__((always_inline))

namespace trimquad {
namespace {

constexpr int kTileRows = 8, kTileColumns = 4;
constexpr int kBlock = 32;   // columns that are factorised together
constexpr int kDepth = 256;  // columns whose products are subtracted together: a tile row fits the L1 cache
constexpr int kRowGroup = 128;  // rows whose packed columns fit the L2 cache

/// Registers of two or four numbers, which may be anywhere in memory.
struct Two {
  using Vector = double __attribute__((vector_size(16), aligned(8), may_alias));
  static constexpr int kLanes = 2;
  static TRIMQUAD_INLINE Vector& at(double* p) { return *reinterpret_cast<Vector*>(p); }
  static TRIMQUAD_INLINE const Vector& at(const double* p) { return *reinterpret_cast<const Vector*>(p); }
};
struct Four {
  using Vector = double __attribute__((vector_size(32), aligned(8), may_alias));
  static constexpr int kLanes = 4;
  static TRIMQUAD_INLINE Vector& at(double* p) { return *reinterpret_cast<Vector*>(p); }
  static TRIMQUAD_INLINE const Vector& at(const double* p) { return *reinterpret_cast<const Vector*>(p); }
};

/// Columns in tiles of rows, so that the product reads them one after another; the last tile is filled up
/// with zeros.
TRIMQUAD_INLINE void pack(const double* a, std::int64_t stride, int rows, int depth, double* packed) {
  for (int first = 0; first < rows; first += kTileRows) {
    const int count = std::min(kTileRows, rows - first);
    for (int p = 0; p < depth; ++p, packed += kTileRows) {
      const double* column = a + p * stride + first;
      if (count == kTileRows)
        for (int i = 0; i < kTileRows; ++i) packed[i] = column[i];
      else
        for (int i = 0; i < kTileRows; ++i) packed[i] = i < count ? column[i] : 0.0;
    }
  }
}

/// c -= a b^T for one tile, of which rows x columns are stored. As many rows at once as two registers hold.
template <typename Lanes>
TRIMQUAD_INLINE void subtractTile(const double* a, const double* b, int depth, double* c, std::int64_t stride,
                                  int rows, int columns) {
  constexpr int kLanes = Lanes::kLanes, kRows = 2 * kLanes;
  for (int top = 0; top < rows; top += kRows) {
    typename Lanes::Vector low[kTileColumns] = {}, high[kTileColumns] = {};
    const double *left = a + top, *right = b;
    for (int p = 0; p < depth; ++p, left += kTileRows, right += kTileRows) {
      const typename Lanes::Vector a0 = Lanes::at(left), a1 = Lanes::at(left + kLanes);
      for (int j = 0; j < kTileColumns; ++j) {
        low[j] += a0 * right[j];
        high[j] += a1 * right[j];
      }
    }
    double* target = c + top;
    if (rows - top >= kRows && columns == kTileColumns) {
      for (int j = 0; j < kTileColumns; ++j, target += stride) {
        Lanes::at(target) -= low[j];
        Lanes::at(target + kLanes) -= high[j];
      }
      continue;
    }
    double part[kRows];
    for (int j = 0; j < columns; ++j, target += stride) {
      Lanes::at(part) = low[j];
      Lanes::at(part + kLanes) = high[j];
      for (int i = 0; i < std::min(kRows, rows - top); ++i) target[i] -= part[i];
    }
  }
}

/// c -= a a^T for the first `columns` columns of the lower triangle, a packed. Tiles that meet the diagonal
/// are written as a whole.
template <typename Lanes>
TRIMQUAD_INLINE void subtractProduct(const double* packed, int rows, int columns, int depth, double* c,
                                     std::int64_t stride) {
  for (int group = 0; group < rows; group += kRowGroup) {
    const int groupEnd = std::min(rows, group + kRowGroup);
    for (int j = 0; j < std::min(columns, groupEnd); j += kTileColumns) {
      const double* b = packed + std::int64_t(j / kTileRows) * kTileRows * depth + j % kTileRows;
      const int first = std::max(group, j / kTileRows * kTileRows);
      for (int i = first; i < groupEnd; i += kTileRows)
        subtractTile<Lanes>(packed + std::int64_t(i) * depth, b, depth, c + j * stride + i, stride,
                            std::min(kTileRows, rows - i), std::min(kTileColumns, columns - j));
    }
  }
}

/// Cholesky factor of a small block in place, column by column, and the rows below it divided by its
/// transpose.
template <typename Lanes>
TRIMQUAD_INLINE bool factorizeBlock(double* a, std::int64_t stride, int rows, int columns) {
  double inverse[kBlock];
  for (int j = 0; j < columns; ++j) {
    double* column = a + j * stride;
    for (int p = 0; p < j; ++p) {
      const double* other = a + p * stride;
      const double factor = other[j];
      for (int i = j; i < columns; ++i) column[i] -= factor * other[i];
    }
    if (!(column[j] > 0) || !(column[j] < HUGE_VAL)) return false;
    column[j] = std::sqrt(column[j]);
    inverse[j] = 1 / column[j];
    for (int i = j + 1; i < columns; ++i) column[i] *= inverse[j];
  }
  int first = columns;
  constexpr int kLanes = Lanes::kLanes;
  for (; first + 4 * kLanes <= rows; first += 4 * kLanes)
    for (int j = 0; j < columns; ++j) {
      double* const column = a + j * stride + first;
      typename Lanes::Vector x[4];
      for (int i = 0; i < 4; ++i) x[i] = Lanes::at(column + i * kLanes);
      for (int p = 0; p < j; ++p) {
        const double* other = a + p * stride;
        const double factor = other[j];
        for (int i = 0; i < 4; ++i) x[i] -= Lanes::at(other + first + i * kLanes) * factor;
      }
      for (int i = 0; i < 4; ++i) Lanes::at(column + i * kLanes) = x[i] * inverse[j];
    }
  for (int j = 0; j < columns && first < rows; ++j) {
    double* const column = a + j * stride;
    for (int p = 0; p < j; ++p) {
      const double* other = a + p * stride;
      const double factor = other[j];
      for (int i = first; i < rows; ++i) column[i] -= factor * other[i];
    }
    for (int i = first; i < rows; ++i) column[i] *= inverse[j];
  }
  return true;
}

template <typename Lanes>
TRIMQUAD_INLINE bool eliminateWith(double* panel, int rows, int columns, double* update, double* packed) {
  const std::int64_t stride = rows;
  for (int j = 0; j < columns; j += kBlock) {
    const int width = std::min(kBlock, columns - j), end = j + width;
    if (!factorizeBlock<Lanes>(panel + j * (stride + 1), stride, rows - j, width)) return false;
    if (end == columns) break;
    pack(panel + j * stride + end, stride, rows - end, width, packed);
    subtractProduct<Lanes>(packed, rows - end, columns - end, width, panel + end * (stride + 1), stride);
  }
  const int below = rows - columns;
  for (int j = 0; j < columns && below > 0; j += kDepth) {
    const int depth = std::min(kDepth, columns - j);
    pack(panel + j * stride + columns, stride, below, depth, packed);
    subtractProduct<Lanes>(packed, below, below, depth, update, below);
  }
  return true;
}

bool eliminateAnywhere(double* panel, int rows, int columns, double* update, double* packed) {
  return eliminateWith<Two>(panel, rows, columns, update, packed);
}

#ifdef TRIMQUAD_HAS_AVX2_KERNELS
__attribute__((target("avx2,fma"))) bool eliminateWithAvx2(double* panel, int rows, int columns,
                                                           double* update, double* packed) {
  return eliminateWith<Four>(panel, rows, columns, update, packed);
}
#endif

}  // namespace

bool eliminate(double* panel, int rows, int columns, double* update, std::vector<double>& scratch) {
  const size_t needed = size_t(rows + kTileRows) * size_t(std::min(columns, kDepth));
  if (scratch.size() < needed) scratch.resize(needed);
#ifdef TRIMQUAD_HAS_AVX2_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return eliminateWithAvx2(panel, rows, columns, update, scratch.data());
#endif
  return eliminateAnywhere(panel, rows, columns, update, scratch.data());
}

}  // namespace trimquad
