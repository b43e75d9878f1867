#include "fem/rigid_motions.h"

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace fem
{
  using dealii::Tensor;

  namespace
  {
    constexpr double negligible = 1e-10; // of the largest pivot: far above rounding, far below any real mesh

    /** Axis vectors of translations and rotations that a geometry allows. */
    struct Motions
    {
      std::vector<unsigned int> translations, rotations;
    };

    Motions get_motions(Geometry geometry)
    {
      if (geometry == Geometry::axisymmetric)
        return {{2}, {}};
      if (geometry == Geometry::plane_strain)
        return {{0, 2}, {1}};
      return {{0, 1, 2}, {0, 1, 2}};
    }

    /** Displacement that each motion gives a component. @param position  from the centre, over the body's size */
    std::vector<double> compute_displacements(const Motions &motions, const Tensor<1, 3> &position, unsigned int axis)
    {
      std::vector<double> displacements;
      for (const unsigned int translation : motions.translations)
        displacements.push_back(translation == axis ? 1. : 0.);
      for (const unsigned int rotation : motions.rotations)
        {
          Tensor<1, 3> vector;
          vector[rotation] = 1.;
          displacements.push_back(dealii::cross_product_3d(vector, position)[axis]);
        }
      return displacements;
    }

    /** Number of columns of a positive semidefinite matrix without a pivot. */
    unsigned int count_missing_pivots(std::vector<std::vector<double>> matrix)
    {
      const unsigned int n = matrix.size();
      double largest = 0.;
      for (unsigned int done = 0; done < n; ++done)
        {
          unsigned int best = done;
          for (unsigned int i = done; i < n; ++i)
            best = matrix[i][i] > matrix[best][best] ? i : best;
          std::swap(matrix[done], matrix[best]);
          for (auto &row : matrix)
            std::swap(row[done], row[best]);
          largest = std::max(largest, matrix[done][done]);
          if (matrix[done][done] <= negligible * largest)
            return n - done;
          for (unsigned int i = done + 1; i < n; ++i)
            for (unsigned int j = n; j-- > done;)
              matrix[i][j] -= matrix[i][done] / matrix[done][done] * matrix[done][j];
        }
      return 0;
    }
  } // namespace

  unsigned int count_free_rigid_motions(Geometry geometry, const std::vector<PrescribedComponent> &components,
                                        MPI_Comm communicator)
  {
    using dealii::Utilities::MPI::sum;
    Tensor<1, 3> centre;
    for (const PrescribedComponent &component : components)
      centre += component.position;
    const double n_components = sum(double(components.size()), communicator);
    centre = sum(centre, communicator) / std::max(n_components, 1.);
    double size_squared = 0.;
    for (const PrescribedComponent &component : components)
      size_squared += (component.position - centre).norm_square();
    size_squared = sum(size_squared, communicator) / std::max(n_components, 1.);
    const double size = size_squared > 0. ? std::sqrt(size_squared) : 1.;

    const Motions motions = get_motions(geometry);
    const unsigned int n = motions.translations.size() + motions.rotations.size();
    std::vector<std::vector<double>> matrix(n, std::vector<double>(n, 0.));
    for (const PrescribedComponent &component : components)
      {
        const auto given = compute_displacements(motions, (component.position - centre) / size, component.axis);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            matrix[i][j] += given[i] * given[j];
      }
    for (auto &row : matrix)
      sum(row, communicator, row);
    return count_missing_pivots(matrix);
  }
} // namespace fem
