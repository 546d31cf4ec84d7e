#include "trimquad/field/field_file.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "trimquad/base/error.h"
#include "trimquad/mesh/aabb_tree.h"
#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// Least length of a projected direction, relative to the direction, that still says where it points.
constexpr double kTangent = 1e-6;

Vector3d vectorOf(LineScanner& scanner) {
  Vector3d v;
  for (double& x : v) x = scanner.number("a coordinate of a direction");
  if (!v.allFinite()) scanner.fail("a coordinate of a direction is not a finite number");
  return v;
}

void requireSymmetry(LineScanner& scanner, long long symmetry) {
  if (symmetry != 1 && symmetry != 2 && symmetry != 4)
    scanner.fail("a field of " + std::to_string(symmetry) +
                 " directions is no cross field; give one of 1, 2 or 4 directions per face");
}

void requireAll(LineScanner& scanner, long long read, long long announced) {
  if (read != announced)
    scanner.fail("the file announces " + std::to_string(announced) + " directions, but has " +
                 std::to_string(read));
}

FieldFile readRawField(const MeshSource& source) {
  LineScanner scanner(source);
  if (!scanner.nextLine()) scanner.fail("the file is empty");
  const long long symmetry = scanner.integer("the number of directions per face");
  const long long count = scanner.integer("the number of faces");
  requireSymmetry(scanner, symmetry);
  FieldFile field{source.name, int(symmetry), {}, {}, {}};
  while (scanner.nextLine()) {
    for (int k = 0; k < symmetry; ++k) field.direction.push_back(vectorOf(scanner));
    if (scanner.more()) scanner.fail("the line has more than " + std::to_string(symmetry) + " directions");
    field.weight.push_back(1);
  }
  requireAll(scanner, field.count(), count);
  return field;
}

FieldFile readRosy(const MeshSource& source) {
  LineScanner scanner(source);
  if (!scanner.nextLine()) scanner.fail("the file is empty");
  const long long count = scanner.integer("the number of faces");
  if (!scanner.nextLine()) scanner.fail("the number of directions per face is missing");
  requireSymmetry(scanner, scanner.integer("the number of directions per face"));
  // One direction stands for all of an element.
  FieldFile field{source.name, 1, {}, {}, {}};
  while (scanner.nextLine()) {
    field.direction.push_back(vectorOf(scanner));
    if (scanner.more()) scanner.fail("the line has more than one direction");
    field.weight.push_back(1);
  }
  requireAll(scanner, field.count(), count);
  return field;
}

FieldFile readDirections(const MeshSource& source) {
  LineScanner scanner(source);
  FieldFile field{source.name, 1, {}, {}, {}};
  std::size_t columns = 0;
  while (scanner.nextLine()) {
    std::vector<double> numbers;
    while (scanner.more()) numbers.push_back(scanner.number("a coordinate"));
    for (const double x : numbers)
      if (!std::isfinite(x)) scanner.fail("a coordinate is not a finite number");
    if (numbers.size() < 3 || numbers.size() == 5 || numbers.size() > 7)
      scanner.fail("a line is dx dy dz [weight] or x y z dx dy dz [weight], but this one has " +
                   std::to_string(numbers.size()) + " numbers");
    const bool placed = numbers.size() >= 6;
    if (columns == 0) columns = numbers.size();
    if (placed != (columns >= 6))
      scanner.fail("some lines have a point before the direction and others have not");
    const auto at = [&](std::size_t i) { return Vector3d(numbers[i], numbers[i + 1], numbers[i + 2]); };
    if (placed) field.point.push_back(at(0));
    field.direction.push_back(at(placed ? 3 : 0));
    const bool weighted = numbers.size() == 4 || numbers.size() == 7;
    field.weight.push_back(weighted ? numbers.back() : 1);
    if (!(field.weight.back() >= 0 && field.weight.back() <= 1)) scanner.fail("a weight is between 0 and 1");
  }
  if (field.count() == 0) scanner.fail("the file has no directions");
  return field;
}

/// Adds the fourth power of a direction in the plane of x and y; nothing where it stands upright.
void addCross(std::complex<double>& sum, const Vector3d& direction, const Vector3d& x, const Vector3d& y,
              double weight) {
  const std::complex<double> z(direction.dot(x), direction.dot(y));
  const double size = std::abs(z);
  if (size > kTangent * direction.norm() && size > 0) sum += weight * std::pow(z / size, 4);
}

}  // namespace

FieldFile readField(const std::filesystem::path& path) {
  const MeshSource source = loadBytes(path);
  if (path.extension() == ".rawfield") return readRawField(source);
  if (path.extension() == ".rosy") return readRosy(source);
  return readDirections(source);
}

FieldGuidance triangleDirections(const FieldFile& field, const MeshFile& mesh) {
  const int triangles = int(mesh.soup.triangles.size()), vertices = int(mesh.soup.points.size());
  const bool byFace = field.count() == mesh.faceCount, byVertex = field.count() == vertices;
  if (!byFace && !byVertex)
    throw inputError("options",
                     "the field has " + std::to_string(field.count()) + " elements, but the mesh has " +
                         std::to_string(mesh.faceCount) + " faces and " + std::to_string(vertices) +
                         " vertices; give one direction for each of these or of those",
                     field.name);
  FieldGuidance result;
  for (int t = 0; t < triangles; ++t) {
    const auto& corner = mesh.soup.triangles[t];
    const auto at = [&](int k) -> const Vector3d& { return mesh.soup.points[corner[k]]; };
    const Vector3d side = at(1) - at(0), normal = side.cross(at(2) - at(0));
    result.direction.push_back(Vector3d::Zero());
    result.weight.push_back(0);
    if (!(normal.norm() > 0)) continue;
    const Vector3d x = side.normalized(), y = normal.normalized().cross(x);
    std::complex<double> sum = 0;
    double weight = 0;
    const auto add = [&](int element) {
      for (int k = 0; k < field.symmetry; ++k)
        addCross(sum, field.direction[element * field.symmetry + k], x, y, field.weight[element]);
      weight += field.weight[element];
    };
    if (byFace)
      add(mesh.face[t]);
    else
      for (const int v : corner) add(v);
    if (!(std::abs(sum) > kTangent)) continue;
    const double angle = std::arg(sum) / 4;
    result.direction.back() = std::cos(angle) * x + std::sin(angle) * y;
    // Directions that contradict each other count for less.
    result.weight.back() = std::min(1.0, std::abs(sum) / (field.symmetry * (byFace ? 1 : 3)));
  }
  return result;
}

FieldGuidance guidanceOf(const Region& region, const FieldGuidance& byInputTriangle) {
  TRIMQUAD_ASSERT(region.inputTriangle.size() == region.mesh.n_faces());
  FieldGuidance result;
  for (const int t : region.inputTriangle) {
    result.direction.push_back(byInputTriangle.direction[t]);
    result.weight.push_back(byInputTriangle.weight[t]);
  }
  return result;
}

FieldGuidance guidanceOf(const Region& region, const FieldFile& field) {
  TRIMQUAD_ASSERT(field.point.size() == field.weight.size());
  std::vector<std::array<int, 3>> places;
  for (int i = 0; i < field.count(); ++i) places.push_back({i, i, i});
  const TriangleTree tree(field.point, places);
  FieldGuidance result;
  for (const auto f : region.mesh.faces()) {
    const int element = tree.closest(region.mesh.calc_face_centroid(f)).triangle;
    const Vector3d normal = region.mesh.calc_face_normal(f), &direction = field.direction[element];
    const Vector3d tangent = direction - normal.dot(direction) * normal;
    const bool known = tangent.norm() > kTangent * direction.norm();
    result.direction.push_back(known ? Vector3d(tangent.normalized()) : Vector3d::Zero());
    result.weight.push_back(known ? field.weight[element] : 0);
  }
  return result;
}

}  // namespace trimquad
