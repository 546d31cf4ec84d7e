#include "trimquad/brep/checker.h"

#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <chrono>
#include <cmath>
#include <thread>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

const Progress progress;

/// Two wavy sheets of n x n facets that cross along a great many curves.
Shape wavySheets(int n) {
  TopoDS_Compound both;
  BRep_Builder builder;
  builder.MakeCompound(both);
  TColStd_Array1OfReal knots(1, n);
  TColStd_Array1OfInteger multiplicities(1, n);
  for (int i = 1; i <= n; ++i) {
    knots(i) = i;
    multiplicities(i) = i == 1 || i == n ? 2 : 1;
  }
  for (const double phase : {0.0, 1.5}) {
    TColgp_Array2OfPnt poles(1, n, 1, n);
    for (int i = 1; i <= n; ++i)
      for (int j = 1; j <= n; ++j) poles(i, j) = gp_Pnt(i, j, std::sin(i + phase) * std::sin(j - phase));
    builder.Add(both,
                BRepBuilderAPI_MakeFace(
                    new Geom_BSplineSurface(poles, knots, knots, multiplicities, multiplicities, 1, 1), 1e-6)
                    .Shape());
  }
  return Shape(both);
}

TEST(Checker, findsWhatTheCheckFinds) {
  const Checker checker(TRIMQUAD_CHECKER);
  const Shape crossing = wavySheets(5);
  const auto none = std::vector<std::string>{};
  ASSERT_NE(faults(crossing, {false, true}), none);
  EXPECT_EQ(checker.faults(crossing, {false, true}, 100, progress), faults(crossing, {false, true}));
  EXPECT_EQ(checker.faults(crossing, {true, false}, 100, progress), faults(crossing, {true, false}));
}

TEST(Checker, endsChecksThatTakeTooLongAndGoesOn) {
  const Checker checker(TRIMQUAD_CHECKER);
  EXPECT_EQ(checker.faults(wavySheets(150), {false, true}, 1, progress), std::nullopt);
  EXPECT_NE(checker.faults(wavySheets(5), {false, true}, 100, progress), std::nullopt);
}

TEST(Checker, aProgramThatEndsBeforeItsAnswerIsACheckThatDoesNotEnd) {
  EXPECT_EQ(Checker("/bin/false").faults(wavySheets(5), {}, 100, progress), std::nullopt);
}

TEST(Checker, aProgramThatCannotBeRunIsRefusedByName) {
  try {
    Checker("/nowhere/checker").faults(wavySheets(5), {}, 100, progress);
    FAIL() << "no program, no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Input);
    EXPECT_EQ(error.where(), "/nowhere/checker");
  }
}

TEST(Checker, stopsWhenTheUserAsks) {
  const Checker checker(TRIMQUAD_CHECKER);
  Progress stopped;
  std::thread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    stopped.cancel();
  });
  EXPECT_THROW(checker.faults(wavySheets(150), {}, 100, stopped), Error);
  user.join();
}

}  // namespace
}  // namespace trimquad
