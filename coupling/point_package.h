#pragma once

#include "fem/constitutive_model.h"

#include <span>
#include <vector>

namespace coupling
{
  /** Nine numbers, row by row. */
  void append(const dealii::Tensor<2, 3> &tensor, std::vector<double> &row);
  dealii::Tensor<2, 3> take_tensor(std::span<const double> row);

  /** Numbers that an answer takes on its way between ranks. */
  std::size_t get_response_length(bool with_tangent);

  /** An answer as plain numbers and back, the same bits. @pre row.size() == get_response_length(with_tangent) */
  void pack(const fem::PointResponse &response, bool with_tangent, std::span<double> row);
  fem::PointResponse unpack(std::span<const double> row, bool with_tangent);
} // namespace coupling
