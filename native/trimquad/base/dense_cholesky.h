#pragma once

#include <vector>

namespace trimquad {

/// Eliminates the first `columns` of `rows` unknowns of a symmetric matrix, of which only the lower triangle
/// is read and written. Uses AVX2 instructions where the processor has them; the result on one processor is
/// always the same. \param panel   the first columns, rows x columns by columns: becomes the factor's \param
/// update  the remaining columns, square: becomes the Schur complement. What is above the diagonals of
///                both is undefined afterwards.
/// \param scratch kept between calls to save allocations
/// \return whether the eliminated part is positive definite
bool eliminate(double* panel, int rows, int columns, double* update, std::vector<double>& scratch);

}  // namespace trimquad
