#include "trimquad/mesh/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include "trimquad/base/error.h"
#include "trimquad/mesh/mesh_formats.h"
#include "trimquad/mesh/polygon.h"

namespace trimquad {
namespace {

/// Products of four coordinates stay finite.
constexpr double kLargestCoordinate = 1e60;
constexpr std::size_t kLargestPolygon = 10000;
constexpr std::size_t kLargestCount = std::numeric_limits<int>::max() / 8;

std::string lowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return extension.empty() ? extension : extension.substr(1);
}

/// Turns the faces of a file into triangles, after checking them.
class FaceTriangulation {
 public:
  FaceTriangulation(const PolygonFile& file, const MeshSource& source, MeshFile& mesh)
      : file_(file), source_(source), mesh_(mesh) {}

  void add(int face) {
    const std::size_t begin = file_.faceStart[face];
    const std::size_t end =
        std::size_t(face) + 1 < file_.faceStart.size() ? file_.faceStart[face + 1] : file_.corners.size();
    const std::span<const long long> corners(file_.corners.data() + begin, end - begin);
    check(face, corners);
    polygon_.clear();
    for (const long long v : corners) polygon_.push_back(file_.points[v]);
    const auto triangles = triangulatePolygon(polygon_);
    if (!triangles) fail(face, "a face crosses itself; triangulate the mesh before");
    for (const auto& t : *triangles) {
      mesh_.soup.triangles.push_back({int(corners[t[0]]), int(corners[t[1]]), int(corners[t[2]])});
      mesh_.face.push_back(face);
    }
  }

 private:
  [[noreturn]] void fail(int face, const std::string& message) const {
    source_.fail(message, (file_.binary ? "byte " : "line ") + std::to_string(file_.facePlace[face]));
  }

  void check(int face, std::span<const long long> corners) {
    if (corners.size() < 3) fail(face, "a face has fewer than three corners");
    if (corners.size() > kLargestPolygon)
      fail(face, "a face has more than " + std::to_string(kLargestPolygon) +
                     " corners; triangulate the mesh before");
    for (const long long v : corners)
      if (v < 0 || v >= (long long)(file_.points.size()))
        fail(face, "a face names vertex " + std::to_string(v) + " (counted from 0), but the file has " +
                       std::to_string(file_.points.size()) + " vertices");
    sorted_.assign(corners.begin(), corners.end());
    std::sort(sorted_.begin(), sorted_.end());
    // In STL the vertices come from welding, and a facet without area is left to the repair.
    if (mesh_.format != "stl" && std::adjacent_find(sorted_.begin(), sorted_.end()) != sorted_.end())
      fail(face, "a face names one vertex twice; clean the mesh before");
  }

  const PolygonFile& file_;
  const MeshSource& source_;
  MeshFile& mesh_;
  std::vector<Eigen::Vector3d> polygon_;
  std::vector<long long> sorted_;
};

PolygonFile readFormat(const MeshSource& source, const std::string& format) {
  if (format == "obj") return readObj(source);
  if (format == "off") return readOff(source);
  if (format == "ply") return readPly(source);
  if (format == "stl") return readStl(source);
  throw inputError("read", "a mesh file is one of .obj, .off, .ply and .stl", source.name);
}

}  // namespace

MeshSource loadBytes(const std::filesystem::path& path) {
  MeshSource source{path.filename().string(), {}};
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) source.fail("there is no file " + path.string());
  if (std::filesystem::is_directory(status)) source.fail("the input is a folder, not a file");
  std::ifstream stream(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, error);
  if (!stream || error) source.fail("the file cannot be opened; check its permissions");
  if (size == 0) source.fail("the file is empty");
  source.bytes.resize(size);
  if (!stream.read(source.bytes.data(), std::streamsize(size)))
    source.fail("the file cannot be read to its end");
  return source;
}

void MeshSource::fail(const std::string& message, const std::string& place) const {
  throw inputError("read", message, place.empty() ? name : name + ", " + place);
}

void PolygonFile::addPoint(const Eigen::Vector3d& point, const MeshSource& source, const std::string& place) {
  if (!point.allFinite()) source.fail("a coordinate is not a finite number", place);
  if (point.cwiseAbs().maxCoeff() > kLargestCoordinate) source.fail("a coordinate is absurdly large", place);
  points.push_back(point + Eigen::Vector3d::Zero());  // -0 becomes 0, so that equal means bitwise equal
}

MeshFile readMesh(const std::filesystem::path& path) {
  const std::string format = lowerExtension(path);
  const MeshSource source = loadBytes(path);
  PolygonFile file = readFormat(source, format);
  if (file.faceStart.empty()) source.fail("the file holds no faces");
  if (file.points.size() > kLargestCount || file.corners.size() > kLargestCount)
    source.fail("the mesh is too large; simplify it");
  MeshFile mesh;
  mesh.format = format;
  mesh.faceCount = int(file.faceStart.size());
  mesh.soup.triangles.reserve(file.corners.size());
  FaceTriangulation triangulation(file, source, mesh);
  for (int f = 0; f < mesh.faceCount; ++f) triangulation.add(f);
  mesh.soup.points = std::move(file.points);
  return mesh;
}

}  // namespace trimquad
