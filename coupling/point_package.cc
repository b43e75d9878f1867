#include "coupling/point_package.h"

namespace coupling
{
  namespace
  {
    constexpr unsigned int n_stresses = dealii::SymmetricTensor<2, 3>::n_independent_components;
    constexpr unsigned int n_tangents = dealii::SymmetricTensor<4, 3>::n_independent_components;

    /** Shows every number of an answer to `move`, in the order of the row: packing and unpacking cannot differ. */
    template <typename Response, typename Move>
    void visit(Response &response, const bool with_tangent, const Move &move)
    {
      move(response.unbalanced_ratio);
      move(response.cost_s);
      for (unsigned int m = 0; m < n_stresses; ++m)
        move(response.stress.access_raw_entry(m));
      if (with_tangent)
        for (unsigned int m = 0; m < n_tangents; ++m)
          move(response.tangent.access_raw_entry(m));
    }
  } // namespace

  void append(const dealii::Tensor<2, 3> &tensor, std::vector<double> &row)
  {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        row.push_back(tensor[i][j]);
  }

  dealii::Tensor<2, 3> take_tensor(std::span<const double> row)
  {
    dealii::Tensor<2, 3> tensor;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        tensor[i][j] = row[3 * i + j];
    return tensor;
  }

  std::size_t get_response_length(const bool with_tangent)
  {
    return 3 + n_stresses + (with_tangent ? n_tangents : 0);
  }

  void pack(const fem::PointResponse &response, const bool with_tangent, std::span<double> row)
  {
    row[0] = static_cast<double>(response.status);
    std::size_t at = 1;
    visit(response, with_tangent, [&](const double value) { row[at++] = value; });
  }

  fem::PointResponse unpack(std::span<const double> row, const bool with_tangent)
  {
    fem::PointResponse response;
    response.status = static_cast<fem::Status>(static_cast<int>(row[0]));
    std::size_t at = 1;
    visit(response, with_tangent, [&](double &value) { value = row[at++]; });
    return response;
  }
} // namespace coupling
