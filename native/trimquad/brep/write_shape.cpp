#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <iomanip>
#include <sstream>

#include "trimquad/brep/assemble.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

/// What `print` prints. OpenCASCADE prints to memory: on a full disk its own streams end in a bad cast.
std::string printed(const std::function<bool(std::ostream&)>& print) {
  std::ostringstream text;
  if (!print(text)) throw stageError("write", "OpenCASCADE could not print the shape");
  return std::move(text).str();
}

/// Writes the text and makes sure that every byte has arrived.
void writeFile(const std::string& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file) file << text;
  file.close();
  if (!file)
    throw inputError("write",
                     std::string("the file cannot be written (") +
                         (errno != 0 ? std::strerror(errno) : "incomplete") +
                         "); check the folder, its permissions and the disk",
                     path);
}

/// OpenCASCADE counts products in the process, and numbers their names.
void nameProducts(const Handle(StepData_StepModel) & model) {
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    product->SetId(new TCollection_HAsciiString("TrimQuad"));
    product->SetName(new TCollection_HAsciiString("TrimQuad"));
  }
}

/// Sets one of the translator's global settings and puts the old value back.
class TranslatorSetting {
 public:
  TranslatorSetting(const char* name, const std::string& value) : name_(name) {
    const char* before = Interface_Static::CVal(name);
    before_ = before ? before : "";
    TRIMQUAD_ASSERT(Interface_Static::SetCVal(name, value.c_str()));
  }
  ~TranslatorSetting() { Interface_Static::SetCVal(name_, before_.c_str()); }
  TranslatorSetting(const TranslatorSetting&) = delete;
  TranslatorSetting& operator=(const TranslatorSetting&) = delete;

 private:
  const char* name_;
  std::string before_;
};

std::string digits(double value) {
  std::ostringstream text;
  text << std::setprecision(17) << value;
  return text.str();
}

/// The uncertainty to say in a file: readers make curves on surfaces anew that are further off than that, and
/// worse ones. As much as the shape's edges need, at most a millionth of its size.
double uncertainty(const Shape& shape) {
  constexpr double least = 1e-7, most = 1e-6, more = 1.2;
  double tolerance = 0;
  for (TopExp_Explorer edges(shape.topology(), TopAbs_EDGE); edges.More(); edges.Next())
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(edges.Current())));
  if (tolerance <= least) return least;
  return std::max(least, std::min(more * tolerance, most * shape.diagonal()));
}

}  // namespace

std::string stepText(const Shape& shape) {
  return guarded(Error::Kind::Stage, "write", "the shape cannot be translated to STEP", [&] {
    const QuietTranslators quiet;
    STEPControl_Controller::Init();
    const TranslatorSetting schema("write.step.schema", "AP242DIS"), unit("write.step.unit", "MM"),
        curves("write.surfacecurve.mode", "On"), given("write.precision.mode", "2"),
        precision("write.precision.val", digits(uncertainty(shape)));
    STEPControl_Writer writer;
    if (writer.Transfer(shape.topology(), STEPControl_AsIs) != IFSelect_RetDone)
      throw stageError("write", "OpenCASCADE could not translate the shape to STEP; try .brep instead");
    const Handle(StepData_StepModel) model = writer.Model();
    nameProducts(model);
    APIHeaderSection_MakeHeader header(model);
    header.SetName(new TCollection_HAsciiString("TrimQuad"));
    header.SetTimeStamp(new TCollection_HAsciiString("2000-01-01T00:00:00"));
    header.SetOriginatingSystem(new TCollection_HAsciiString("TrimQuad"));
    header.Apply(model);
    return printed([&](std::ostream& stream) {
      StepData_StepWriter text(model);
      text.SendModel(Handle(StepData_Protocol)::DownCast(model->Protocol()));
      return text.Print(stream);
    });
  });
}

void writeStep(const Shape& shape, const std::string& path) {
  writeFile(path, stepText(shape));
}

void writeBrep(const Shape& shape, const std::string& path) {
  const std::string text = guarded(Error::Kind::Stage, "write", "the shape cannot be written", [&] {
    return printed([&](std::ostream& stream) {
      BRepTools::Write(shape.topology(), stream);
      return stream.good();
    });
  });
  writeFile(path, text);
}

}  // namespace trimquad
