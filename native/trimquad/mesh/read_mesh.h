#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

/// A triangle mesh as its file has it, neither checked for manifoldness nor repaired (see check_mesh.h).
struct MeshFile {
  TriangleSoup soup;
  std::string format;     ///< "obj", "off", "ply" or "stl"
  int faceCount = 0;      ///< faces of the file; more than three corners make several triangles
  std::vector<int> face;  ///< by triangle: the file's face that it comes from, counted from 0
};

/// Reads Wavefront OBJ, Geomview OFF (ascii; colours, normals and texture coordinates are skipped), PLY
/// (ascii and both binary forms) and STL (ascii and binary; bitwise equal corners become one vertex). The
/// extension, in any case, decides which. Polygons are triangulated (triangulatePolygon).
/// Vertex order is kept.
///
/// Guarantees on return: at least one triangle, every index in range, every coordinate finite. Numbers are
/// read alike in every locale. Memory stays within a small multiple of the file's size, whatever counts the
/// file announces. Throws Error(Input) with line or byte and what to do about it for everything that does not
/// follow the format.
MeshFile readMesh(const std::filesystem::path& path);

struct MeshSource;
/// The bytes of a file (mesh_formats.h). Throws Error(Input, "read") for what is no readable file, or an
/// empty one.
MeshSource loadBytes(const std::filesystem::path& path);

}  // namespace trimquad
