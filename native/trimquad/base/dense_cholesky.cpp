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

/// Four numbers anywhere in memory.
using Vector = double __attribute__((vector_size(32), aligned(8), may_alias));

TRIMQUAD_INLINE Vector& four(double* p) {
  return *reinterpret_cast<Vector*>(p);
}
TRIMQUAD_INLINE const Vector& four(const double* p) {
  return *reinterpret_cast<const Vector*>(p);
}

/// Columns in tiles of rows, so that the product reads them one after another; the last tile is filled up
/// with zeros.
TRIMQUAD_INLINE void pack(const double* a, std::int64_t stride, int rows, int depth, double* packed) {
  for (int first = 0; first < rows; first += kTileRows) {
    const int count = std::min(kTileRows, rows - first);
    for (int p = 0; p < depth; ++p, packed += kTileRows) {
      const double* column = a + p * stride + first;
      if (count == kTileRows) {
        four(packed) = four(column);
        four(packed + 4) = four(column + 4);
      } else {
        for (int i = 0; i < kTileRows; ++i) packed[i] = i < count ? column[i] : 0.0;
      }
    }
  }
}

/// c -= a b^T for one tile, of which rows x columns are stored.
TRIMQUAD_INLINE void subtractTile(const double* a, const double* b, int depth, double* c, std::int64_t stride,
                                  int rows, int columns) {
  Vector low[kTileColumns] = {}, high[kTileColumns] = {};
  for (int p = 0; p < depth; ++p, a += kTileRows, b += kTileRows) {
    const Vector a0 = four(a), a1 = four(a + 4);
    for (int j = 0; j < kTileColumns; ++j) {
      const Vector factor = {b[j], b[j], b[j], b[j]};
      low[j] += a0 * factor;
      high[j] += a1 * factor;
    }
  }
  if (rows == kTileRows && columns == kTileColumns) {
    for (int j = 0; j < kTileColumns; ++j, c += stride) {
      four(c) -= low[j];
      four(c + 4) -= high[j];
    }
    return;
  }
  double part[kTileRows];
  for (int j = 0; j < columns; ++j, c += stride) {
    four(part) = low[j];
    four(part + 4) = high[j];
    for (int i = 0; i < rows; ++i) c[i] -= part[i];
  }
}

/// c -= a a^T for the first `columns` columns of the lower triangle, a packed. Tiles that meet the diagonal
/// are written as a whole.
TRIMQUAD_INLINE void subtractProduct(const double* packed, int rows, int columns, int depth, double* c,
                                     std::int64_t stride) {
  for (int group = 0; group < rows; group += kRowGroup) {
    const int groupEnd = std::min(rows, group + kRowGroup);
    for (int j = 0; j < std::min(columns, groupEnd); j += kTileColumns) {
      const double* b = packed + std::int64_t(j / kTileRows) * kTileRows * depth + j % kTileRows;
      const int first = std::max(group, j / kTileRows * kTileRows);
      for (int i = first; i < groupEnd; i += kTileRows)
        subtractTile(packed + std::int64_t(i) * depth, b, depth, c + j * stride + i, stride,
                     std::min(kTileRows, rows - i), std::min(kTileColumns, columns - j));
    }
  }
}

/// Cholesky factor of a small block in place, column by column, and the rows below it divided by its
/// transpose.
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
  for (; first + 16 <= rows; first += 16)
    for (int j = 0; j < columns; ++j) {
      double* const column = a + j * stride + first;
      Vector x0 = four(column), x1 = four(column + 4), x2 = four(column + 8), x3 = four(column + 12);
      for (int p = 0; p < j; ++p) {
        const double* other = a + p * stride;
        const double f = other[j];
        const Vector factor = {f, f, f, f};
        x0 -= factor * four(other + first);
        x1 -= factor * four(other + first + 4);
        x2 -= factor * four(other + first + 8);
        x3 -= factor * four(other + first + 12);
      }
      four(column) = x0 * inverse[j];
      four(column + 4) = x1 * inverse[j];
      four(column + 8) = x2 * inverse[j];
      four(column + 12) = x3 * inverse[j];
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

TRIMQUAD_INLINE bool eliminateWith(double* panel, int rows, int columns, double* update, double* packed) {
  const std::int64_t stride = rows;
  for (int j = 0; j < columns; j += kBlock) {
    const int width = std::min(kBlock, columns - j), end = j + width;
    if (!factorizeBlock(panel + j * (stride + 1), stride, rows - j, width)) return false;
    if (end == columns) break;
    pack(panel + j * stride + end, stride, rows - end, width, packed);
    subtractProduct(packed, rows - end, columns - end, width, panel + end * (stride + 1), stride);
  }
  const int below = rows - columns;
  for (int j = 0; j < columns && below > 0; j += kDepth) {
    const int depth = std::min(kDepth, columns - j);
    pack(panel + j * stride + columns, stride, below, depth, packed);
    subtractProduct(packed, below, below, depth, update, below);
  }
  return true;
}

bool eliminateAnywhere(double* panel, int rows, int columns, double* update, double* packed) {
  return eliminateWith(panel, rows, columns, update, packed);
}

#ifdef TRIMQUAD_HAS_AVX2_KERNELS
__attribute__((target("avx2,fma"))) bool eliminateWithAvx2(double* panel, int rows, int columns,
                                                           double* update, double* packed) {
  return eliminateWith(panel, rows, columns, update, packed);
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
