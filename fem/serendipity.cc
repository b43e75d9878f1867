#include "fem/serendipity.h"

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/scalar_polynomials_base.h>
#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <array>

namespace fem
{
  using dealii::Point;
  using dealii::Tensor;

  namespace
  {
    constexpr unsigned int degree = 2;

    /** Power of each coordinate. */
    template <int dim>
    using Exponents = std::array<unsigned int, dim>;

    /** All products of powers in which at most one coordinate is squared. */
    template <int dim>
    std::vector<Exponents<dim>> list_monomials()
    {
      std::vector<Exponents<dim>> monomials;
      for (unsigned int code = 0; code < dealii::Utilities::pow(3u, dim); ++code)
        {
          Exponents<dim> exponents;
          unsigned int n_squares = 0;
          for (unsigned int d = 0, rest = code; d < dim; ++d, rest /= 3)
            {
              exponents[d] = rest % 3;
              n_squares += exponents[d] == 2;
            }
          if (n_squares <= 1)
            monomials.push_back(exponents);
        }
      return monomials;
    }

    /** Corners, then middles of edges, as deal.II numbers them in the unit cell. */
    template <int dim>
    std::vector<Point<dim>> list_nodes()
    {
      using Cell = dealii::GeometryInfo<dim>;
      std::vector<Point<dim>> nodes;
      for (unsigned int v = 0; v < Cell::vertices_per_cell; ++v)
        nodes.push_back(Cell::unit_cell_vertex(v));
      for (unsigned int line = 0; line < Cell::lines_per_cell; ++line)
        nodes.push_back(0.5 * (Cell::unit_cell_vertex(Cell::line_to_cell_vertices(line, 0)) +
                               Cell::unit_cell_vertex(Cell::line_to_cell_vertices(line, 1))));
      return nodes;
    }

    /** Derivative of a monomial, orders[d] times in coordinate d. */
    template <int dim>
    double differentiate(const Exponents<dim> &exponents, const Exponents<dim> &orders, const Point<dim> &p)
    {
      double value = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        {
          if (orders[d] > exponents[d])
            return 0.;
          for (unsigned int k = 0; k < orders[d]; ++k)
            value *= exponents[d] - k;
          for (unsigned int k = orders[d]; k < exponents[d]; ++k)
            value *= p[d];
        }
      return value;
    }

    /** The shape functions: polynomials that are one at their own node and zero at all others. */
    template <int dim>
    class SerendipityPolynomials : public dealii::ScalarPolynomialsBase<dim>
    {
    public:
      SerendipityPolynomials()
          : dealii::ScalarPolynomialsBase<dim>(degree, list_nodes<dim>().size()), monomials_(list_monomials<dim>()),
            coefficients_(monomials_.size(), monomials_.size())
      {
        const std::vector<Point<dim>> nodes = list_nodes<dim>();
        for (unsigned int n = 0; n < nodes.size(); ++n)
          for (unsigned int m = 0; m < monomials_.size(); ++m)
            coefficients_(n, m) = differentiate<dim>(monomials_[m], {}, nodes[n]);
        coefficients_.gauss_jordan();
      }

      void evaluate(const Point<dim> &p, std::vector<double> &values, std::vector<Tensor<1, dim>> &first,
                    std::vector<Tensor<2, dim>> &second, std::vector<Tensor<3, dim>> &third,
                    std::vector<Tensor<4, dim>> &fourth) const override
      {
        std::vector<Tensor<0, dim>> scalars(values.size());
        fill<0>(p, scalars);
        std::copy(scalars.begin(), scalars.end(), values.begin());
        fill<1>(p, first);
        fill<2>(p, second);
        fill<3>(p, third);
        fill<4>(p, fourth);
      }

      double compute_value(unsigned int i, const Point<dim> &p) const override { return combine(i, {}, p); }
      Tensor<1, dim> compute_1st_derivative(unsigned int i, const Point<dim> &p) const override
      {
        return derive<1>(i, p);
      }
      Tensor<2, dim> compute_2nd_derivative(unsigned int i, const Point<dim> &p) const override
      {
        return derive<2>(i, p);
      }
      Tensor<3, dim> compute_3rd_derivative(unsigned int i, const Point<dim> &p) const override
      {
        return derive<3>(i, p);
      }
      Tensor<4, dim> compute_4th_derivative(unsigned int i, const Point<dim> &p) const override
      {
        return derive<4>(i, p);
      }
      Tensor<1, dim> compute_grad(unsigned int i, const Point<dim> &p) const override { return derive<1>(i, p); }
      Tensor<2, dim> compute_grad_grad(unsigned int i, const Point<dim> &p) const override { return derive<2>(i, p); }

      std::unique_ptr<dealii::ScalarPolynomialsBase<dim>> clone() const override
      {
        return std::make_unique<SerendipityPolynomials>(*this);
      }
      std::string name() const override { return "SerendipityPolynomials"; }

    private:
      double combine(unsigned int i, const Exponents<dim> &orders, const Point<dim> &p) const
      {
        double sum = 0.;
        for (unsigned int m = 0; m < monomials_.size(); ++m)
          sum += coefficients_(m, i) * differentiate<dim>(monomials_[m], orders, p);
        return sum;
      }

      template <int order>
      static Exponents<dim> count_orders(unsigned int entry)
      {
        Exponents<dim> orders = {};
        for (unsigned int k = 0; k < order; ++k, entry /= dim)
          ++orders[entry % dim];
        return orders;
      }

      template <int order>
      Tensor<order, dim> derive(unsigned int i, const Point<dim> &p) const
      {
        Tensor<order, dim> derivative;
        for (unsigned int entry = 0; entry < Tensor<order, dim>::n_independent_components; ++entry)
          *(derivative.begin_raw() + entry) = combine(i, count_orders<order>(entry), p);
        return derivative;
      }

      // Each monomial once for all functions: faces ask for hundreds of places at a time.
      template <int order>
      void fill(const Point<dim> &p, std::vector<Tensor<order, dim>> &derivatives) const
      {
        if (derivatives.empty())
          return;
        for (unsigned int entry = 0; entry < Tensor<order, dim>::n_independent_components; ++entry)
          {
            const Exponents<dim> orders = count_orders<order>(entry);
            for (auto &derivative : derivatives)
              *(derivative.begin_raw() + entry) = 0.;
            for (unsigned int m = 0; m < monomials_.size(); ++m)
              if (const double slope = differentiate<dim>(monomials_[m], orders, p); slope != 0.)
                for (unsigned int i = 0; i < derivatives.size(); ++i)
                  *(derivatives[i].begin_raw() + entry) += coefficients_(m, i) * slope;
          }
      }

      std::vector<Exponents<dim>> monomials_;
      dealii::FullMatrix<double> coefficients_; ///< of monomial m in the function of node i
    };

    /** One unknown a corner and edge, none inside of faces and cells. */
    template <int dim>
    dealii::FiniteElementData<dim> describe()
    {
      std::vector<unsigned int> n_dofs(dim + 1, 0);
      n_dofs[0] = n_dofs[1] = 1;
      return {n_dofs, 1, degree, dealii::FiniteElementData<dim>::H1};
    }
  } // namespace

  template <int dim>
  SerendipityElement<dim>::SerendipityElement()
      : dealii::FE_Poly<dim>(
            SerendipityPolynomials<dim>(), describe<dim>(), std::vector<bool>(describe<dim>().n_dofs_per_cell(), false),
            std::vector<dealii::ComponentMask>(describe<dim>().n_dofs_per_cell(), dealii::ComponentMask(1, true)))
  {
    this->unit_support_points = list_nodes<dim>();
    this->unit_face_support_points[0] = list_nodes<dim - 1>();
  }

  template <int dim>
  std::string SerendipityElement<dim>::get_name() const
  {
    return "SerendipityElement<" + std::to_string(dim) + ">";
  }

  template <int dim>
  std::unique_ptr<dealii::FiniteElement<dim>> SerendipityElement<dim>::clone() const
  {
    return std::make_unique<SerendipityElement>();
  }

  // A function is zero on a face unless its own node lies there: on each edge it is a parabola through three nodes.
  template <int dim>
  bool SerendipityElement<dim>::has_support_on_face(unsigned int shape_index, unsigned int face_index) const
  {
    const unsigned int axis = face_index / 2;
    return this->unit_support_points[shape_index][axis] == static_cast<double>(face_index % 2);
  }

  template class SerendipityElement<2>;
  template class SerendipityElement<3>;
} // namespace fem
