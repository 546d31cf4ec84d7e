#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

enum class Encoding { Ascii, Little, Big };

struct ScalarType {
  std::string_view name, sizedName;
  int size;
  bool isFloat, isSigned;
};

constexpr ScalarType kTypes[] = {
    {"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
    {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
    {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
    {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true},
};

/// What a property is for the mesh.
enum class Role { None, X, Y, Z, Corners };

struct Property {
  Role role = Role::None;
  const ScalarType* type = nullptr;
  const ScalarType* countType = nullptr;  ///< of a list; null otherwise
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;

  bool has(Role role) const {
    return std::any_of(properties.begin(), properties.end(),
                       [&](const Property& p) { return p.role == role; });
  }
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
};

const ScalarType* scalarType(std::string_view name, const LineScanner& scanner) {
  for (const ScalarType& type : kTypes)
    if (name == type.name || name == type.sizedName) return &type;
  scanner.fail(inQuotes(name) + " is no type of PLY");
}

Encoding encoding(LineScanner& scanner) {
  const std::string_view name = scanner.token();
  if (scanner.token() != "1.0") scanner.fail("only version 1.0 of PLY exists");
  if (name == "ascii") return Encoding::Ascii;
  if (name == "binary_little_endian") return Encoding::Little;
  if (name == "binary_big_endian") return Encoding::Big;
  scanner.fail(inQuotes(name) + " is no encoding of PLY");
}

Property property(LineScanner& scanner, const std::string& element) {
  Property result;
  const std::string_view type = scanner.token();
  if (type == "list") {
    result.countType = scalarType(scanner.token(), scanner);
    if (result.countType->isFloat) scanner.fail("the length of a list must be a whole number");
    result.type = scalarType(scanner.token(), scanner);
  } else {
    result.type = scalarType(type, scanner);
  }
  const std::string_view name = scanner.token();
  if (name.empty()) scanner.fail("a property has no name");
  if (element == "vertex" && !result.countType)
    result.role = name == "x" ? Role::X : name == "y" ? Role::Y : name == "z" ? Role::Z : Role::None;
  if (element == "face" && result.countType && (name == "vertex_indices" || name == "vertex_index")) {
    if (result.type->isFloat) scanner.fail("the vertex numbers of faces must be whole numbers");
    result.role = Role::Corners;
  }
  return result;
}

void checkElements(const Header& header, const LineScanner& scanner) {
  const auto named = [&](const char* name) {
    const auto it = std::find_if(header.elements.begin(), header.elements.end(),
                                 [&](const Element& e) { return e.name == name; });
    return it == header.elements.end() ? nullptr : &*it;
  };
  const Element *vertex = named("vertex"), *face = named("face");
  if (!vertex || !vertex->has(Role::X) || !vertex->has(Role::Y) || !vertex->has(Role::Z))
    scanner.fail("the header declares no vertices with x, y and z");
  if (!face || !face->has(Role::Corners))
    scanner.fail("the header declares no faces with vertex_indices; save the mesh with polygons");
}

/// Leaves the scanner on the line end_header.
Header readHeader(LineScanner& scanner) {
  if (!scanner.nextLine() || scanner.rest() != "ply") scanner.fail("a PLY file begins with the line ply");
  if (!scanner.nextLine() || scanner.token() != "format")
    scanner.fail("the second line of a PLY file is its format");
  Header header;
  header.encoding = encoding(scanner);
  while (scanner.nextLine()) {
    const std::string_view statement = scanner.token();
    if (statement == "end_header") {
      checkElements(header, scanner);
      return header;
    }
    if (statement == "element") {
      auto& element = header.elements.emplace_back();
      element.name = scanner.token();
      element.count = scanner.integer("the number of elements");
      if (element.count < 0) scanner.fail("the number of elements is negative");
    } else if (statement == "property") {
      if (header.elements.empty()) scanner.fail("a property comes before the first element");
      auto& element = header.elements.back();
      element.properties.push_back(property(scanner, element.name));
    } else if (statement != "comment" && statement != "obj_info") {
      scanner.fail(inQuotes(statement) + " is no statement of a PLY header");
    }
  }
  scanner.fail("the file is cut short: its header has no end");
}

/// Values of an ascii body, one element a line.
class TextBody {
 public:
  explicit TextBody(LineScanner& scanner) : scanner_(scanner) {}
  void begin(const Element& element, long long index) {
    if (!scanner_.nextLine())
      scanner_.fail("the file is cut short: element " + inQuotes(element.name) + " has " +
                    std::to_string(index) + " of " + std::to_string(element.count) + " lines");
  }
  void end() {
    if (scanner_.more()) scanner_.fail("the line has more values than the header declares");
  }
  double number(const ScalarType&) { return scanner_.number("a value"); }
  long long integer(const ScalarType&) { return scanner_.integer("a whole number"); }
  void checkListFits(long long, const ScalarType&) {}  // a missing value is found when it is read
  std::size_t place() const { return scanner_.line(); }
  std::string placeText() const { return scanner_.place(); }
  [[noreturn]] void fail(const std::string& message) { scanner_.fail(message); }
  bool atEnd() { return !scanner_.nextLine(); }

 private:
  LineScanner& scanner_;
};

/// Values of a binary body.
class BinaryBody {
 public:
  BinaryBody(const MeshSource& source, std::size_t begin, Encoding encoding)
      : source_(source), at_(begin), big_(encoding == Encoding::Big) {}
  void begin(const Element&, long long) { start_ = at_; }
  void end() {}
  double number(const ScalarType& type) {
    if (!type.isFloat) return double(integer(type));
    const std::uint64_t bits = take(type.size);
    return type.size == 4 ? std::bit_cast<float>(std::uint32_t(bits)) : std::bit_cast<double>(bits);
  }
  long long integer(const ScalarType& type) {
    const std::uint64_t bits = take(type.size);
    if (!type.isSigned) return (long long)(bits);
    const int unused = 64 - 8 * type.size;
    return (long long)(bits << unused) >> unused;
  }
  void checkListFits(long long length, const ScalarType& type) {
    if (length > (long long)(source_.bytes.size() - at_) / type.size) cutShort();
  }
  std::size_t place() const { return start_; }
  std::string placeText() const { return "byte " + std::to_string(start_); }
  [[noreturn]] void fail(const std::string& message) { source_.fail(message, placeText()); }
  bool atEnd() const { return source_.bytes.find_first_not_of(" \r\n", at_) == std::string::npos; }

 private:
  [[noreturn]] void cutShort() { fail("the file is cut short or its header announces too many elements"); }
  std::uint64_t take(int size) {
    if (source_.bytes.size() - at_ < std::size_t(size)) cutShort();
    std::uint64_t bits = 0;
    for (int i = 0; i < size; ++i)
      bits = bits << 8 | static_cast<unsigned char>(source_.bytes[at_ + (big_ ? i : size - 1 - i)]);
    at_ += size;
    return bits;
  }

  const MeshSource& source_;
  std::size_t at_, start_ = 0;
  bool big_;
};

template <class Body>
void readList(const Property& property, Body& body, PolygonFile& file) {
  const long long length = body.integer(*property.countType);
  if (length < 0) body.fail("a list has a negative length");
  body.checkListFits(length, *property.type);
  if (property.role == Role::Corners) {
    file.beginFace(body.place());
    for (long long k = 0; k < length; ++k) file.corners.push_back(body.integer(*property.type));
  } else {
    for (long long k = 0; k < length; ++k) body.number(*property.type);
  }
}

template <class Body>
PolygonFile readBody(const Header& header, const MeshSource& source, Body body) {
  PolygonFile file;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    const bool isVertex = element.name == "vertex";
    for (long long i = 0; i < element.count; ++i) {
      body.begin(element, i);
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (const Property& property : element.properties) {
        if (property.countType) {
          readList(property, body, file);
          continue;
        }
        const double value = body.number(*property.type);
        if (property.role != Role::None) point[int(property.role) - int(Role::X)] = value;
      }
      body.end();
      if (isVertex) file.addPoint(point, source, body.placeText());
    }
  }
  if (!body.atEnd()) source.fail("the file goes on after the elements that its header announces");
  file.binary = header.encoding != Encoding::Ascii;
  return file;
}

}  // namespace

PolygonFile readPly(const MeshSource& source) {
  LineScanner scanner(source);
  const Header header = readHeader(scanner);
  if (header.encoding == Encoding::Ascii) return readBody(header, source, TextBody(scanner));
  return readBody(header, source, BinaryBody(source, scanner.end(), header.encoding));
}

}  // namespace trimquad
