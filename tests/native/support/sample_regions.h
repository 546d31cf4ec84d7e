#pragma once

#include <functional>

#include "trimquad/mesh/region.h"

namespace trimquad::sample {

/// A region of bare triangles: surface, curves and corners are left out.
Region region(const TriangleSoup& soup);

TriangleSoup withoutUnusedPoints(const TriangleSoup& all);

using Shape = std::function<Eigen::Vector3d(double, double)>;
using Inside = std::function<bool(double, double)>;

/// columns x rows cells over [0, 1]^2, two triangles each; cells whose centre is not inside are left out.
TriangleSoup sheet(int columns, int rows, const Shape& shape, const Inside& inside = {});

/// A tube: `around` x `along` cells, closed in the first parameter; shape(0, t) == shape(1, t).
TriangleSoup tube(int around, int along, const Shape& shape, const Inside& inside = {});

Eigen::Vector3d flat(double s, double t);
Eigen::Vector3d wavy(double s, double t);
Eigen::Vector3d cylinder(double s, double t);
/// A tube bent by a quarter turn.
Eigen::Vector3d elbow(double s, double t);
/// A dome that reaches `angle` (radians) down from its top, over the square parameter domain.
Shape dome(double angle);

/// A closed surface of genus 1: around x around.
TriangleSoup torus(int columns, int rows, double radius = 3);

/// The surface of the union of unit boxes at whole-number places, each side of a box n x n cells of two
/// triangles. Boxes must not touch along an edge or in a corner only.
TriangleSoup boxes(const std::vector<std::array<int, 3>>& places, int n);

/// A cube of n x n cells a side, blown up to the unit sphere.
TriangleSoup sphere(int n);

}  // namespace trimquad::sample
