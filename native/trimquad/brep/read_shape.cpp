#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "trimquad/brep/occt_guard.h"
#include "trimquad/brep/shape.h"

namespace trimquad {
namespace {

std::string wholeFile(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) throw inputError("read", "the file does not exist", path);
  if (!std::filesystem::is_regular_file(path, status)) throw inputError("read", "this is not a file", path);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (!(content << file.rdbuf())) {
    if (std::filesystem::file_size(path, status) == 0) throw inputError("read", "the file is empty", path);
    throw inputError("read", "the file cannot be read; check its permissions", path);
  }
  return content.str();
}

Error malformed(const std::string& format, const std::string& path) {
  return inputError("read", "the file is malformed or cut off; export it again as " + format, path);
}

/// OpenCASCADE's parsers accept a file that stops in the middle; the closing words of the format tell.
void demandEnding(const std::string& content, const std::string& ending, const std::string& format,
                  const std::string& path) {
  if (content.find(ending) == std::string::npos) throw malformed(format, path);
}

TopoDS_Shape readStep(const std::string& content, const std::string& path) {
  if (content.substr(0, 4096).find("ISO-10303-21") == std::string::npos)
    throw inputError("read", "this is not a STEP file", path);
  demandEnding(content, "ENDSEC", "STEP", path);
  demandEnding(content, "END-ISO-10303-21", "STEP", path);
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  std::istringstream stream(content);
  if (reader.ReadStream(std::filesystem::path(path).filename().c_str(), stream) != IFSelect_RetDone)
    throw malformed("STEP", path);
  reader.TransferRoots();
  return reader.OneShape();
}

TopoDS_Shape readIges(const std::string& content, const std::string& path) {
  // The last line of an IGES file is the terminate section: a T in column 73.
  bool terminated = false;
  std::istringstream lines(content);
  for (std::string line; std::getline(lines, line);)
    if (line.size() >= 73 && line[72] == 'T') terminated = true;
  if (!terminated) throw malformed("IGES", path);
  IGESControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw malformed("IGES", path);
  reader.TransferRoots();
  return reader.OneShape();
}

/// Whether the table of shapes, which closes the file, is whole: as many entries as announced, each ending
/// with an asterisk, then the root's number and location. OpenCASCADE reads on for ever where it is cut off.
bool holdsAllShapes(const std::string& content) {
  const std::string title = "\nTShapes ";
  std::istringstream table(content.substr(content.find(title) + title.size()));
  long announced = 0, found = 0;
  if (!(table >> announced) || announced <= 0) return false;
  std::string word;
  while (found < announced && table >> word) found += word == "*";
  std::string root, location;
  return found == announced && table >> root >> location;
}

TopoDS_Shape readBRep(const std::string& content, const std::string& path) {
  // OpenCASCADE prints to the standard output when it meets anything else, so look first.
  const auto head = content.substr(0, 4096);
  if (head.find("CASCADE Topology V") == std::string::npos || head.find("Locations") == std::string::npos)
    throw inputError("read", "this is not a BREP file", path);
  for (const char* section : {"\nLocations ", "\nCurve2ds ", "\nCurves ", "\nPolygon3D ", "\nSurfaces ",
                              "\nTriangulations ", "\nTShapes "})
    demandEnding(content, section, "BREP", path);
  if (!holdsAllShapes(content)) throw malformed("BREP", path);
  TopoDS_Shape shape;
  BRep_Builder builder;
  std::istringstream stream(content);
  BRepTools::Read(shape, stream, builder);
  if (shape.IsNull()) throw malformed("BREP", path);
  return shape;
}

/// What `read` gives, as a shape with faces.
template <class Read>
Shape faces(const std::string& path, Read&& read) {
  const TopoDS_Shape shape = guarded(Error::Kind::Input, "read", "the file cannot be read: " + path, [&] {
    QuietTranslators quiet;
    return read();
  });
  if (shape.IsNull()) throw inputError("read", "the file holds no shape that can be read", path);
  try {
    return Shape(shape);
  } catch (const Error& error) {
    throw inputError("read", error.message(), path);
  }
}

}  // namespace

Shape shapeFromStep(const std::string& text, const std::string& name) {
  return faces(name, [&] { return readStep(text, name); });
}

Shape readShape(const std::string& path) {
  const std::string content = wholeFile(path);
  if (content.empty()) throw inputError("read", "the file is empty", path);
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return faces(path, [&] {
    if (extension == ".step" || extension == ".stp") return readStep(content, path);
    if (extension == ".iges" || extension == ".igs") return readIges(content, path);
    if (extension == ".brep" || extension == ".brp") return readBRep(content, path);
    throw inputError("read", "unknown file type; use STEP, IGES or BREP", path);
  });
}

}  // namespace trimquad
