#pragma once

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "support/sample_maps.h"
#include "trimquad/tmesh/partition.h"

namespace trimquad {

/// Every triangle in a chart of its own, turned and shifted by any number of quanta: the same seamless map.
void shuffleSeamlessCharts(Parametrization& map, std::mt19937& random);

double areaOf(const Parametrization& map);

/// The course of a real arc: legs follow each other, lie on the iso-line and add up to the length.
void expectCourse(const Parametrization& map, const TMesh& tmesh, const TMesh::Arc& arc);

/// What a partition promises, counted anew; `verify` has held already.
void expectPartition(const Parametrization& map, const TMesh& tmesh);

TMesh soundPartition(const Parametrization& map);

std::map<int, int> typesOf(const TMesh& tmesh);

}  // namespace trimquad
