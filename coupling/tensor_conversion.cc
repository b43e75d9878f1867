#include "coupling/tensor_conversion.h"

namespace coupling
{
  namespace
  {
    /** Turns the first index and moves it to the end: four times this turns all of them and restores their order. */
    dealii::Tensor<4, 3> turn_first_index(const dealii::Tensor<4, 3> &tensor, const dem::Matrix &rotation)
    {
      dealii::Tensor<4, 3> turned;
      for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 3; ++a)
          for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
              for (int l = 0; l < 3; ++l)
                turned[j][k][l][i] += rotation(i, a) * tensor[a][j][k][l];
      return turned;
    }
  } // namespace

  dem::Matrix to_matrix(const dealii::Tensor<2, 3> &tensor)
  {
    dem::Matrix matrix;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        matrix(i, j) = tensor[i][j];
    return matrix;
  }

  dealii::Tensor<2, 3> to_tensor(const dem::Matrix &matrix)
  {
    dealii::Tensor<2, 3> tensor;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        tensor[i][j] = matrix(i, j);
    return tensor;
  }

  dealii::SymmetricTensor<2, 3> to_symmetric_tensor(const dem::Matrix &matrix)
  {
    dealii::SymmetricTensor<2, 3> tensor;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        tensor[i][j] = 0.5 * (matrix(i, j) + matrix(j, i));
    return tensor;
  }

  dem::Matrix to_matrix(const dealii::SymmetricTensor<2, 3> &tensor)
  {
    return to_matrix(dealii::Tensor<2, 3>(tensor));
  }

  dealii::SymmetricTensor<4, 3> to_tensor(const dem::Tangent &tangent)
  {
    dealii::SymmetricTensor<4, 3> tensor;
    for (int m = 0; m < 6; ++m)
      for (int n = 0; n < 6; ++n)
        tensor[dem::tangent_index[m][0]][dem::tangent_index[m][1]][dem::tangent_index[n][0]][dem::tangent_index[n][1]] =
            tangent(m, n);
    return tensor;
  }

  dealii::SymmetricTensor<4, 3> rotate(const dealii::SymmetricTensor<4, 3> &tangent, const dem::Matrix &rotation)
  {
    if (rotation == dem::Matrix::Identity())
      return tangent;
    dealii::Tensor<4, 3> turned(tangent);
    for (int index = 0; index < 4; ++index)
      turned = turn_first_index(turned, rotation);
    dealii::SymmetricTensor<4, 3> result;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
          for (int l = k; l < 3; ++l)
            result[i][j][k][l] = turned[i][j][k][l];
    return result;
  }
} // namespace coupling
