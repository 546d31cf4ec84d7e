#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "trimquad/mesh/equal_points.h"
#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

constexpr std::size_t kHeaderSize = 84, kFacetSize = 50;

std::uint32_t littleEndian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

PolygonFile readBinary(const MeshSource& source) {
  PolygonFile file;
  file.binary = true;
  const std::size_t facets = (source.bytes.size() - kHeaderSize) / kFacetSize;
  file.points.reserve(3 * facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const std::size_t place = kHeaderSize + f * kFacetSize;
    file.beginFace(place);
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d point;
      for (int axis = 0; axis < 3; ++axis)
        point[axis] =
            std::bit_cast<float>(littleEndian(source.bytes.data() + place + 12 * (k + 1) + 4 * axis));
      file.corners.push_back((long long)(file.points.size()));
      file.addPoint(point, source, "facet " + std::to_string(f + 1) + ", byte " + std::to_string(place));
    }
  }
  return file;
}

bool sameWord(std::string_view token, std::string_view word) {
  return std::equal(token.begin(), token.end(), word.begin(), word.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

/// The words of an ascii STL file, which may be broken into lines anywhere but in a solid's name.
class StlWords {
 public:
  explicit StlWords(const MeshSource& source) : scanner(source) {}

  std::string_view next() {
    if (!scanner.more() && !scanner.nextLine())
      scanner.fail("the file is cut short: it ends before endsolid");
    return scanner.token();
  }
  void expect(std::string_view word) {
    const std::string_view found = next();
    if (!sameWord(found, word)) scanner.fail("expected " + inQuotes(word) + ", found " + inQuotes(found));
  }
  double number(const char* what) { return scanner.toNumber(next(), what); }

  LineScanner scanner;
};

PolygonFile readAscii(const MeshSource& source) {
  PolygonFile file;
  StlWords words(source);
  while (words.scanner.nextLine()) {
    words.expect("solid");
    words.scanner.rest();
    while (true) {
      const std::string_view word = words.next();
      if (sameWord(word, "endsolid")) {
        words.scanner.rest();
        break;
      }
      if (!sameWord(word, "facet"))
        words.scanner.fail("expected \"facet\" or \"endsolid\", found " + inQuotes(word));
      words.expect("normal");
      for (int k = 0; k < 3; ++k) words.number("a normal");
      words.expect("outer");
      words.expect("loop");
      file.beginFace(words.scanner.line());
      for (int k = 0; k < 3; ++k) {
        words.expect("vertex");
        Eigen::Vector3d point;
        for (double& x : point) x = words.number("a coordinate");
        file.corners.push_back((long long)(file.points.size()));
        file.addPoint(point, source, words.scanner.place());
      }
      words.expect("endloop");
      words.expect("endfacet");
    }
  }
  return file;
}

/// STL has no vertices of its own: corners with bitwise the same coordinates are one, numbered as first met.
void weldEqualCorners(PolygonFile& file) {
  const std::vector<int> first = firstEqualPoint(file.points);
  std::vector<Eigen::Vector3d> points;
  std::vector<int> vertex(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == int(i)) {
      vertex[i] = int(points.size());
      points.push_back(file.points[i]);
    } else {
      vertex[i] = vertex[first[i]];
    }
  }
  file.points = std::move(points);
  for (long long& corner : file.corners) corner = vertex[corner];
}

}  // namespace

PolygonFile readStl(const MeshSource& source) {
  const std::string& bytes = source.bytes;
  const bool longEnough = bytes.size() >= kHeaderSize;
  const std::size_t announced = longEnough ? littleEndian(bytes.data() + 80) : 0;
  // The word "solid" also begins many binary files, so the size decides.
  const bool binary = longEnough && bytes.size() == kHeaderSize + kFacetSize * announced;
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool text =
      sameWord(std::string_view(bytes).substr(begin, 5), "solid") && bytes.find('\0') == std::string::npos;
  if (!binary && !text) {
    if (!longEnough) source.fail("the file is too short for an STL file");
    source.fail("the file is cut short or damaged: it announces " + std::to_string(announced) +
                " facets, but has room for " + std::to_string((bytes.size() - kHeaderSize) / kFacetSize));
  }
  PolygonFile file = binary ? readBinary(source) : readAscii(source);
  weldEqualCorners(file);
  return file;
}

}  // namespace trimquad
