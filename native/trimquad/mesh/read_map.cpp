#include "trimquad/mesh/read_map.h"

#include <algorithm>

#include "trimquad/base/error.h"
#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

struct MapFile {
  TriangleSoup soup;
  std::vector<Eigen::Vector2d> images;
  std::vector<std::array<int, 3>> imageNumbers;
  std::vector<std::array<int, 2>> lines;
  std::vector<int> points;
};

int numberUpTo(std::size_t count, std::string_view word, const LineScanner& scanner, const char* what) {
  const long long number = scanner.toInteger(word, what);
  if (number < 1 || number > (long long)(count))
    scanner.fail(std::string(what) + " is " + std::to_string(number) + ", but there are " +
                 std::to_string(count));
  return int(number) - 1;
}

void readTriangle(LineScanner& scanner, MapFile& file) {
  std::array<int, 3> corners, images;
  for (int k = 0; k < 3; ++k) {
    const std::string_view word = scanner.token();
    const std::size_t slash = word.find('/');
    if (slash == std::string_view::npos) scanner.fail("a corner of a map's triangle must be vertex/texture");
    corners[k] = numberUpTo(file.soup.points.size(), word.substr(0, slash), scanner, "a vertex number");
    images[k] = numberUpTo(file.images.size(), word.substr(slash + 1), scanner, "a texture number");
  }
  if (scanner.more()) scanner.fail("a map has triangles only");
  file.soup.triangles.push_back(corners);
  file.imageNumbers.push_back(images);
}

MapFile readStatements(const MeshSource& source) {
  MapFile file;
  LineScanner scanner(source);
  while (scanner.nextLine()) {
    const std::string_view statement = scanner.token();
    if (statement == "v") {
      Eigen::Vector3d x;
      for (double& c : x) c = scanner.number("a coordinate");
      file.soup.points.push_back(x);
    } else if (statement == "vt") {
      const double u = scanner.number("u"), v = scanner.number("v");
      file.images.emplace_back(u, v);
    } else if (statement == "f") {
      readTriangle(scanner, file);
    } else if (statement == "l") {
      const int from = numberUpTo(file.soup.points.size(), scanner.token(), scanner, "a vertex number");
      file.lines.push_back(
          {from, numberUpTo(file.soup.points.size(), scanner.token(), scanner, "a vertex number")});
    } else if (statement == "p") {
      file.points.push_back(numberUpTo(file.soup.points.size(), scanner.token(), scanner, "a vertex number"));
    } else if (statement != "g") {
      scanner.fail(inQuotes(statement) + " is no statement of a map");
    }
  }
  return file;
}

}  // namespace

Parametrization readMapObj(const std::string& name, const std::string& text) {
  const MapFile file = readStatements({name, text});
  Parametrization map;
  map.mesh = buildSurfaceMesh(file.soup);
  double largest = 0;
  for (const auto& x : file.images) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  map.scale = FixedScale::fitting(largest);
  std::vector<FixedVector> images;
  for (const auto& x : file.images) {
    images.push_back(map.scale.round(x));
    if (map.scale.toQuads(images.back()) != x)
      throw inputError("read",
                       "a coordinate of the map is no multiple of its scale, so its seams cannot be exact",
                       name + ", vt " + std::to_string(images.size()));
  }
  map.corner.resize(map.mesh.n_halfedges());
  for (const auto f : map.mesh.faces())
    for (const auto h : map.mesh.fh_range(f))
      for (int k = 0; k < 3; ++k)
        if (file.soup.triangles[f.idx()][k] == map.mesh.from_vertex_handle(h).idx())
          map.corner[h.idx()] = images[file.imageNumbers[f.idx()][k]];
  for (const auto& [a, b] : file.lines) {
    const auto h = map.mesh.find_halfedge(VertexHandle(a), VertexHandle(b));
    if (!h.is_valid())
      throw inputError("read", "a line of the map is no edge of it",
                       name + ", vertices " + std::to_string(a + 1) + " and " + std::to_string(b + 1));
    map.aligned.push_back(map.mesh.edge_handle(h));
  }
  for (const int p : file.points) map.featurePoints.emplace_back(p);
  return map;
}

}  // namespace trimquad
