#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

inline constexpr double kPi = std::numbers::pi;

/// columns x rows squares, each cut in two triangles, at surface(i, j); i runs from 0 to columns, j from 0 to
/// rows.
TriangleSoup sheet(int columns, int rows, const std::function<Eigen::Vector3d(double, double)>& surface);

TriangleSoup flatSheet(int columns, int rows);

/// The surface of the unit cube, outward, every corner once.
TriangleSoup cube();

/// A band of n squares closed after `halfTwists` half twists.
TriangleSoup band(int n, int halfTwists);

/// A sphere of radius r around the origin, outward: the cube's surface, subdivided and projected.
TriangleSoup sphere(double r, int subdivisions);

/// Every triangle with three vertices of its own.
TriangleSoup exploded(const TriangleSoup& soup);

double enclosedVolume(const TriangleSoup& soup);

}  // namespace trimquad
