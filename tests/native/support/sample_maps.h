#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "trimquad/gridmap/grid_map.h"

namespace trimquad::samples {

/// Triangles with one chart position per corner, in quads.
struct MappedSoup {
  TriangleSoup soup;
  std::vector<std::array<Eigen::Vector2d, 3>> corners;

  void add(std::array<int, 3> triangle, std::array<Eigen::Vector2d, 3> corner) {
    soup.triangles.push_back(triangle);
    corners.push_back(corner);
  }
};

GridMap gridMapOf(const MappedSoup& mapped, int bits = 24);

/// A flat map: the chart is the plane of the points themselves.
GridMap planarMap(const TriangleSoup& soup, int bits = 24);

/// columns x rows cells of two triangles each, without those that `leaveOut(i, j)`; positions by `place(i,
/// j)`.
TriangleSoup sheet(
    int columns, int rows, const std::function<Eigen::Vector2d(int, int)>& place,
    const std::function<bool(int, int)>& leaveOut = [](int, int) { return false; });

/// `quarters` squares of side `width` quads around a grid point, each n x n cells in a chart of its own.
/// `inner` cells next to the point are left out of every square.
MappedSoup cone(int quarters, int n, double width, int inner = 0, Eigen::Vector2d apex = {0, 0});

/// A tube or torus: columns x rows cells of size `du` x `dv` quads, closed in u and perhaps in v. The map is
/// moved by `offset`.
MappedSoup wrapped(int columns, int rows, double du, double dv, bool torus, Eigen::Vector2d offset = {0, 0});

/// A rectangle left out of a sheet, in cells, around which the chart is shifted by a grid vector.
struct ShiftedHole {
  int column, row, columns, rows;
  std::array<int, 2> shift;

  Eigen::Vector2d center() const { return {column + columns / 2., row + rows / 2.}; }
};

/// n x n cells of side `step` quads with holes, turned and moved in the chart. Without a value where the
/// shifts fold a triangle over.
std::optional<GridMap> shiftedPlate(int n, const std::vector<ShiftedHole>& holes, double step,
                                    Eigen::Vector2d offset, double turn = 0);

/// The same map with every triangle in a chart of its own, turned and shifted by grid automorphisms.
void shuffleCharts(GridMap& map, std::mt19937& random);

}  // namespace trimquad::samples
