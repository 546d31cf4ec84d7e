#include <algorithm>

#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

/// Geomview's header: [ST][C][N][4][n]OFF [BINARY]. The counts may follow on the same line.
void readKeyword(LineScanner& scanner) {
  if (!scanner.nextLine()) scanner.fail("the file is empty");
  std::string_view keyword = scanner.token();
  const std::string_view whole = keyword;
  for (const std::string_view prefix : {"ST", "C", "N"})
    if (keyword.starts_with(prefix)) keyword.remove_prefix(prefix.size());
  if (keyword == "4OFF" || keyword == "nOFF" || keyword == "4nOFF")
    scanner.fail("the vertices do not have three coordinates (" + std::string(whole) +
                 "); save the mesh as plain OFF");
  if (keyword != "OFF") scanner.fail("an OFF file begins with OFF, this one with " + inQuotes(whole));
}

}  // namespace

PolygonFile readOff(const MeshSource& source) {
  LineScanner scanner(source);
  readKeyword(scanner);
  if (!scanner.more() && !scanner.nextLine()) scanner.fail("the counts of vertices and faces are missing");
  const std::string_view first = scanner.token();
  if (first == "BINARY") scanner.fail("binary OFF is not supported; save the mesh as ascii OFF or as PLY");
  const long long vertexCount = scanner.toInteger(first, "the number of vertices");
  const long long faceCount = scanner.integer("the number of faces");
  if (scanner.more()) scanner.integer("the number of edges");
  if (scanner.more()) scanner.fail("the line of counts has more than three numbers");
  if (vertexCount < 0 || faceCount < 0) scanner.fail("a count is negative");

  PolygonFile file;
  const auto expectLine = [&](const char* what, long long read, long long announced) {
    if (!scanner.nextLine())
      scanner.fail("the file is cut short: it announces " + std::to_string(announced) + " " + what +
                   ", but ends after " + std::to_string(read));
  };
  for (long long i = 0; i < vertexCount; ++i) {
    expectLine("vertices", i, vertexCount);
    Eigen::Vector3d point;
    for (double& x : point) x = scanner.number("a coordinate");
    while (scanner.more()) scanner.number("a normal, colour or texture coordinate");
    file.addPoint(point, source, scanner.place());
  }
  for (long long i = 0; i < faceCount; ++i) {
    expectLine("faces", i, faceCount);
    const long long size = scanner.integer("the number of corners of a face");
    file.beginFace(scanner.line());
    for (long long k = 0; k < size; ++k) file.corners.push_back(scanner.integer("a vertex number of a face"));
    while (scanner.more()) scanner.number("a colour");
  }
  if (scanner.nextLine())
    scanner.fail("the file goes on after the " + std::to_string(faceCount) + " faces that it announces");
  return file;
}

}  // namespace trimquad
