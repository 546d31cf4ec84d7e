#include <algorithm>
#include <string_view>

#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

/// Statements that carry no polygon: normals, texture, groups, materials, lines, points and free-form
/// geometry.
constexpr std::string_view kSkipped[] = {
    "vt",     "vn",     "vp",     "g",        "o",        "s",      "mg",    "l",         "p",
    "usemtl", "mtllib", "usemap", "maplib",   "bevel",    "lod",    "step",  "deg",       "bmat",
    "curv",   "surf",   "curv2",  "c_interp", "d_interp", "cstype", "parm",  "trim",      "hole",
    "scrv",   "end",    "sp",     "con",      "call",     "ctech",  "stech", "trace_obj", "shadow_obj",
    "csh",    "bsp",    "bzp",    "cdc",      "cdp",      "res"};

/// "7", "7/3", "7//5" or "7/3/5": the vertex number; the other two must be whole numbers and are dropped.
long long vertexNumber(std::string_view corner, const LineScanner& scanner) {
  const std::size_t slash = corner.find('/');
  const long long vertex = scanner.toInteger(corner.substr(0, slash), "a vertex number of a face");
  if (slash == std::string_view::npos) return vertex;
  const std::string_view others = corner.substr(slash + 1);
  const std::size_t second = others.find('/');
  const std::string_view texture = others.substr(0, second);
  if (!texture.empty()) scanner.toInteger(texture, "a texture number of a face");
  if (second != std::string_view::npos)
    scanner.toInteger(others.substr(second + 1), "a normal number of a face");
  else if (texture.empty())
    scanner.fail("a face corner ends in a slash");
  return vertex;
}

void readVertex(LineScanner& scanner, const MeshSource& source, PolygonFile& file) {
  Eigen::Vector3d point;
  for (double& x : point) x = scanner.number("a coordinate");
  int extra = 0;  // a weight, or a colour, or both
  for (; scanner.more(); ++extra) scanner.number("a weight or colour");
  if (extra > 4) scanner.fail("a vertex has more than seven numbers");
  file.addPoint(point, source, scanner.place());
}

void readFace(LineScanner& scanner, PolygonFile& file) {
  file.beginFace(scanner.line());
  while (scanner.more()) {
    const long long number = vertexNumber(scanner.token(), scanner);
    if (number == 0) scanner.fail("a face names vertex 0, but vertices count from 1");
    // A negative number counts back from the vertices read so far.
    const long long vertex = number > 0 ? number - 1 : (long long)(file.points.size()) + number;
    if (vertex < 0) scanner.fail("a face names vertex " + std::to_string(number) + ", before the first one");
    file.corners.push_back(vertex);
  }
}

/// A backslash at the end of a line joins it with the next one. Line numbers stay: the line break moves
/// behind.
MeshSource joinedLines(const MeshSource& source) {
  MeshSource joined{source.name, {}};
  joined.bytes.reserve(source.bytes.size());
  std::string owed;
  for (std::size_t i = 0; i < source.bytes.size(); ++i) {
    const char c = source.bytes[i];
    const std::size_t lineBreak = source.bytes.compare(i + 1, 2, "\r\n") == 0 ? 2 : 1;
    const char next = i + 1 < source.bytes.size() ? source.bytes[i + 1] : ' ';
    if (c == '\\' && (next == '\n' || next == '\r')) {
      joined.bytes += ' ';
      owed += '\n';
      i += lineBreak;
    } else {
      joined.bytes += c;
      if (c == '\n' || (c == '\r' && next != '\n')) joined.bytes += owed, owed.clear();
    }
  }
  return joined;
}

}  // namespace

PolygonFile readObj(const MeshSource& original) {
  const bool continued = original.bytes.find('\\') != std::string::npos;
  const MeshSource joined = continued ? joinedLines(original) : MeshSource{};
  const MeshSource& source = continued ? joined : original;
  PolygonFile file;
  LineScanner scanner(source);
  while (scanner.nextLine()) {
    const std::string_view statement = scanner.token();
    if (statement == "v") {
      readVertex(scanner, source, file);
    } else if (statement == "f" || statement == "fo") {
      readFace(scanner, file);
    } else if (std::find(std::begin(kSkipped), std::end(kSkipped), statement) == std::end(kSkipped)) {
      scanner.fail(inQuotes(statement) + " is no statement of a Wavefront OBJ file");
    }
  }
  return file;
}

}  // namespace trimquad
