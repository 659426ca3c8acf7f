// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/consistent_gradients.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    NodeLanes at(const NodalVector &field, const unsigned int node)
    {
      return load_node(field.node(node));
    }

    void add(NodalVector &field, const unsigned int node, const NodeLanes &value)
    {
      double *const target = field.node(node);
      store_node(load_node(target) + value, target);
    }

    /** Inverts a symmetric positive definite matrix in place; false where it is close to singular.
     */
    template <unsigned int n>
    bool invert_moments(double (&matrix)[n][n])
    {
      double inverse[n][n] = {};
      double factor[n][n] = {};
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j)
        {
          double sum = matrix[i][j];
          for (unsigned int k = 0; k < j; ++k)
            sum -= factor[i][k] * factor[j][k];
          if (i != j)
            factor[i][j] = sum / factor[j][j];
          else if (sum > 1e-10 * matrix[i][i])
            factor[i][i] = std::sqrt(sum);
          else
            return false;
        }
      for (unsigned int column = 0; column < n; ++column)
      {
        double solution[n] = {};
        for (unsigned int i = 0; i < n; ++i)
        {
          double sum = i == column ? 1. : 0.;
          for (unsigned int k = 0; k < i; ++k)
            sum -= factor[i][k] * solution[k];
          solution[i] = sum / factor[i][i];
        }
        for (unsigned int i = n; i-- > 0;)
        {
          double sum = solution[i];
          for (unsigned int k = i + 1; k < n; ++k)
            sum -= factor[k][i] * solution[k];
          solution[i] = sum / factor[i][i];
        }
        for (unsigned int i = 0; i < n; ++i)
          inverse[i][column] = solution[i];
      }
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          matrix[i][j] = 0.5 * (inverse[i][j] + inverse[j][i]);
      return true;
    }

    /** The system for μ, matrix-free. */
    template <int dim>
    class Multipliers
    {
    public:
      Multipliers(const std::vector<double> &volume, const NodalVector &position,
                  const Stencils &shape)
          : volume(volume), position(position), shape(shape)
      {
        factors.resize(shape.n_particles());
        weights.reserve(shape.value.size());
        for (const double value : shape.value)
          weights.push_back(std::sqrt(std::abs(value)));
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
          if (!shape.is_rigid(row))
            set_factors(row);
      }

      void apply(const NodalVector &multiplier, NodalVector &result) const
      {
        result.set_zero();
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          if (!factors[row].takes_part)
            continue;
          const unsigned int own = shape.particle_node[row];
          const NodeLanes centre = at(position, own);
          const NodeLanes own_value = at(multiplier, own);
          Fit fit;
          for_entries(row,
                      [&](const std::size_t entry, const unsigned int node) {
                        fit.add(weight(entry), at(multiplier, node) - own_value,
                                at(position, node) - centre);
                      });
          fit.solve(factors[row]);
          for_entries(row,
                      [&](const std::size_t entry, const unsigned int node)
                      {
                        const NodeLanes residual = at(multiplier, node) - own_value -
                                                   fit.value(at(position, node) - centre);
                        add(result, node, residual * (volume[row] * weight(entry)));
                      });
        }
        result.add_to_owners();
      }

      /** One over the diagonal (images left out); zero at nodes that have no part in the system. */
      void inverse_diagonal(NodalVector &diagonal) const
      {
        diagonal.set_zero();
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          if (!factors[row].takes_part)
            continue;
          const NodeLanes centre = at(position, shape.particle_node[row]);
          for_entries(row,
                      [&](const std::size_t entry, const unsigned int node)
                      {
                        const NodeLanes offset = at(position, node) - centre;
                        double basis[n_basis] = {1.};
                        for (unsigned int d = 0; d < dim; ++d)
                          basis[d + 1] = offset[d];
                        double share = 0;
                        for (unsigned int a = 0; a < n_basis; ++a)
                          for (unsigned int b = 0; b < n_basis; ++b)
                            share += basis[a] * factors[row].inverse[a][b] * basis[b];
                        const double w = weight(entry);
                        *diagonal.node(node) += volume[row] * w * (1. - w * share);
                      });
        }
        diagonal.add_to_owners();
        for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
          *diagonal.node(i) = *diagonal.node(i) > 0. ? 1. / *diagonal.node(i) : 0.;
      }

      /** Adds δG to the gradients of @p changed, which is the same object as was given. */
      void change_gradients(const NodalVector &multiplier, Stencils &changed) const
      {
        AlignedVector<double> change;
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          if (!factors[row].takes_part)
            continue;
          const std::size_t begin = shape.row_start[row];
          const unsigned int own = shape.particle_node[row];
          const NodeLanes centre = at(position, own);
          const NodeLanes own_value = at(multiplier, own);
          change.resize_fast((shape.row_start[row + 1] - begin) * node_stride);
          const auto changed_at = [&](const std::size_t entry)
          { return change.data() + (entry - begin) * node_stride; };
          for_entries(row, [&](const std::size_t entry, const unsigned int node)
                      { store_node(at(multiplier, node) - own_value, changed_at(entry)); });
          // The second fit takes what round-off left of the first.
          for (unsigned int repetition = 0; repetition < 2; ++repetition)
          {
            Fit fit;
            for_entries(row,
                        [&](const std::size_t entry, const unsigned int node) {
                          fit.add(weight(entry), load_node(changed_at(entry)),
                                  at(position, node) - centre);
                        });
            fit.solve(factors[row]);
            for_entries(row,
                        [&](const std::size_t entry, const unsigned int node)
                        {
                          double *const value = changed_at(entry);
                          store_node(load_node(value) - fit.value(at(position, node) - centre),
                                     value);
                        });
          }
          for_entries(row,
                      [&](const std::size_t entry, const unsigned int)
                      {
                        double *const gradient =
                            changed.gradient.data() + entry * Stencils::n_gradient;
                        for (unsigned int d = 0; d < dim; ++d)
                          gradient[d] += changed_at(entry)[d] * weight(entry);
                      });
        }
      }

    private:
      static constexpr unsigned int n_basis = dim + 1;

      struct RowFactors
      {
        bool takes_part = false;
        double inverse[n_basis][n_basis] = {}; ///< of Σ w q qᵀ, q = [1, x_J - x_I]
      };

      /** The linear least squares fit of a vector. */
      struct Fit
      {
        NodeLanes moment[n_basis] = {};

        void add(const double weight, const NodeLanes &value, const NodeLanes &offset)
        {
          const NodeLanes weighted = value * weight;
          moment[0] += weighted;
          for (unsigned int d = 0; d < dim; ++d)
            moment[d + 1] += weighted * NodeLanes(offset[d]);
        }

        void solve(const RowFactors &factors)
        {
          NodeLanes coefficient[n_basis] = {};
          for (unsigned int a = 0; a < n_basis; ++a)
            for (unsigned int b = 0; b < n_basis; ++b)
              coefficient[a] += moment[b] * factors.inverse[a][b];
          for (unsigned int a = 0; a < n_basis; ++a)
            moment[a] = coefficient[a];
        }

        NodeLanes value(const NodeLanes &offset) const
        {
          NodeLanes result = moment[0];
          for (unsigned int d = 0; d < dim; ++d)
            result += moment[d + 1] * NodeLanes(offset[d]);
          return result;
        }
      };

      double weight(const std::size_t entry) const
      {
        return weights[entry];
      }

      template <typename Use>
      void for_entries(const unsigned int row, const Use &use) const
      {
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
          use(entry, shape.neighbour[entry]);
      }

      void set_factors(const unsigned int row)
      {
        const NodeLanes centre = at(position, shape.particle_node[row]);
        double scale = 0;
        for_entries(row,
                    [&](const std::size_t entry, const unsigned int node)
                    {
                      const NodeLanes offset = at(position, node) - centre;
                      for (unsigned int d = 0; d < dim; ++d)
                        if (weight(entry) > 0.)
                          scale = std::max(scale, std::abs(static_cast<double>(offset[d])));
                    });
        if (scale == 0.)
          return;
        RowFactors &of_row = factors[row];
        for_entries(row,
                    [&](const std::size_t entry, const unsigned int node)
                    {
                      const NodeLanes offset = at(position, node) - centre;
                      double basis[n_basis] = {1.};
                      for (unsigned int d = 0; d < dim; ++d)
                        basis[d + 1] = offset[d] / scale;
                      for (unsigned int a = 0; a < n_basis; ++a)
                        for (unsigned int b = 0; b < n_basis; ++b)
                          of_row.inverse[a][b] += weight(entry) * basis[a] * basis[b];
                    });
        of_row.takes_part = invert_moments(of_row.inverse);
        for (unsigned int a = 0; a < n_basis; ++a)
          for (unsigned int b = 0; b < n_basis; ++b)
            of_row.inverse[a][b] /= (a > 0 ? scale : 1.) * (b > 0 ? scale : 1.);
      }

      const std::vector<double> &volume;
      const NodalVector &position;
      const Stencils &shape;
      std::vector<RowFactors> factors;
      std::vector<double> weights;
    };

    /** Takes from a vector what it has in common with the linear functions that are in the null
     * space: component by component those that planes of symmetry allow. Returns the square of
     * what it took. */
    template <int dim>
    double remove_linear_part(const NodalVector &position, const NodalVector &inverse_diagonal,
                              NodalVector &residual)
    {
      const NodePartition &partition = *residual.partition();
      const unsigned int n_owned = partition.n_owned();
      unsigned int n_planes[dim] = {};
      std::array<double, dim + 1> centre = {};
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*inverse_diagonal.node(i) > 0.)
        {
          centre[dim] += 1.;
          for (unsigned int d = 0; d < dim; ++d)
            centre[d] += position.node(i)[d];
        }
      centre = ordered_sum(centre, partition.communicator());
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] /= centre[dim];
      if (const Symmetry *const symmetry = partition.symmetry())
        for (const SymmetryPlane &plane : symmetry->planes)
        {
          ++n_planes[plane.axis];
          centre[plane.axis] = plane.coordinate;
        }
      const auto value = [&](const unsigned int function, const unsigned int node)
      { return function == 0 ? 1. : position.node(node)[function - 1] - centre[function - 1]; };

      std::vector<double> sums((dim + 1) * (2 * dim + 1), 0.); // products with functions, residual
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*inverse_diagonal.node(i) > 0.)
          for (unsigned int a = 0; a <= dim; ++a)
          {
            double *const of_function = sums.data() + a * (2 * dim + 1);
            for (unsigned int b = 0; b <= dim; ++b)
              of_function[b] += value(a, i) * value(b, i);
            for (unsigned int c = 0; c < dim; ++c)
              of_function[dim + 1 + c] += value(a, i) * residual.node(i)[c];
          }
      sums = ordered_sum(sums, partition.communicator());
      double removed = 0;
      for (unsigned int c = 0; c < dim; ++c)
      {
        std::vector<unsigned int> functions;
        if (n_planes[c] == 1)
          functions.push_back(c + 1);
        else if (n_planes[c] == 0)
        {
          functions.push_back(0);
          for (unsigned int d = 0; d < dim; ++d)
            if (n_planes[d] == 0)
              functions.push_back(d + 1);
        }
        const auto n = static_cast<unsigned int>(functions.size());
        if (n == 0)
          continue;
        FullMatrix<double> gram(n, n);
        for (unsigned int a = 0; a < n; ++a)
          for (unsigned int b = 0; b < n; ++b)
            gram(a, b) = sums[functions[a] * (2 * dim + 1) + functions[b]];
        gram.gauss_jordan();
        for (unsigned int a = 0; a < n; ++a)
        {
          double coefficient = 0;
          for (unsigned int b = 0; b < n; ++b)
            coefficient += gram(a, b) * sums[functions[b] * (2 * dim + 1) + dim + 1 + c];
          removed += coefficient * sums[functions[a] * (2 * dim + 1) + dim + 1 + c];
          for (unsigned int i = 0; i < n_owned; ++i)
            if (*inverse_diagonal.node(i) > 0.)
              residual.node(i)[c] -= coefficient * value(functions[a], i);
        }
      }
      return removed;
    }

    using Sums = std::array<double, node_stride>;

    /** a·b by component over owned nodes of this rank. */
    Sums products(const NodalVector &a, const NodalVector &b)
    {
      NodeLanes sum = 0.;
      for (unsigned int i = 0; i < a.partition()->n_owned(); ++i)
        sum += at(a, i) * at(b, i);
      Sums result;
      store_node(sum, result.data());
      return result;
    }

    double total(const Sums &sums)
    {
      double result = 0;
      for (const double sum : sums)
        result += sum;
      return result;
    }

    /** @p residual := b - Σ_I V_I G_I at owned nodes; returns its norm. Collective. */
    double compute_defect(const std::vector<double> &volume, const NodalVector &boundary,
                          const Stencils &shape, NodalVector &residual)
    {
      residual.set_zero();
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const Stencils::Row of_row = shape.row(row);
        for (unsigned int k = 0; k < of_row.size; ++k)
        {
          NodeLanes gradient = load_node(of_row.gradient + k * Stencils::n_gradient);
          gradient[3] = 0.;
          add(residual, of_row.neighbour[k], gradient * (-volume[row]));
        }
      }
      residual.add_to_owners();
      for (unsigned int i = 0; i < residual.partition()->n_owned(); ++i)
        add(residual, i, at(boundary, i));
      return std::sqrt(
          total(ordered_sum(products(residual, residual), residual.partition()->communicator())));
    }

    /** By component, the squares of the residual and behind them those with the preconditioner,
     * over owned nodes of all ranks. Collective. */
    std::array<double, 2 * node_stride> residual_norms(const NodalVector &residual,
                                                       const NodalVector &inverse_diagonal)
    {
      Sums sums[2] = {};
      NodeLanes plain = 0., preconditioned = 0.;
      for (unsigned int i = 0; i < residual.partition()->n_owned(); ++i)
      {
        const NodeLanes square = at(residual, i) * at(residual, i);
        plain += square;
        preconditioned += square * *inverse_diagonal.node(i);
      }
      store_node(plain, sums[0].data());
      store_node(preconditioned, sums[1].data());
      std::array<double, 2 * node_stride> both;
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        both[c] = sums[0][c];
        both[node_stride + c] = sums[1][c];
      }
      return ordered_sum(both, residual.partition()->communicator());
    }
  } // namespace

  template <int dim>
  GradientConsistency ConsistentGradients<dim>::establish(
      const std::vector<double> &volume, const NodalVector &position, const NodalVector &boundary,
      const double tolerance, const unsigned int largest_n_iterations, Stencils &shape)
  {
    const auto &partition = position.partition();
    const MPI_Comm communicator = partition->communicator();
    const unsigned int n_owned = partition->n_owned();
    NodalVector residual, direction, image, multiplier, inverse_diagonal;
    for (NodalVector *const vector : {&residual, &direction, &image, &multiplier})
      vector->reinit(partition);
    inverse_diagonal.reinit(partition, 1);

    const Multipliers<dim> matrix(volume, position, shape);
    matrix.inverse_diagonal(inverse_diagonal);
    GradientConsistency result;
    const double scale = std::sqrt(total(ordered_sum(products(boundary, boundary), communicator)));
    result.defect_before = compute_defect(volume, boundary, shape, residual);
    const double removed = remove_linear_part<dim>(position, inverse_diagonal, residual);

    // Conjugate gradients for each component on its own: planes of symmetry make three systems of
    // what is one otherwise. A component that has converged stands still.
    // Nor is it worth to go far below what cannot be reached.
    const double threshold = std::max(tolerance * scale * tolerance * scale, 0.01 * removed);
    std::array<double, 2 *node_stride> norms = residual_norms(residual, inverse_diagonal);
    NodeLanes step = 0.;
    while (true)
    {
      double norm = 0;
      bool moves[node_stride];
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        norm += norms[c];
        moves[c] = norms[c] > 0.01 * threshold;
      }
      result.converged = norm <= threshold;
      if (result.converged || result.iterations == largest_n_iterations)
        break;
      ++result.iterations;
      for (unsigned int i = 0; i < n_owned; ++i)
        store_node(at(residual, i) * *inverse_diagonal.node(i) + at(direction, i) * step,
                   direction.node(i));
      direction.update_ghosts();
      matrix.apply(direction, image);
      const Sums curvature = ordered_sum(products(direction, image), communicator);
      NodeLanes length = 0.;
      for (unsigned int c = 0; c < node_stride; ++c)
        length[c] = moves[c] && curvature[c] > 0. ? norms[node_stride + c] / curvature[c] : 0.;
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        add(multiplier, i, at(direction, i) * length);
        add(residual, i, at(image, i) * (-length));
      }
      const std::array<double, 2 *node_stride> next = residual_norms(residual, inverse_diagonal);
      for (unsigned int c = 0; c < node_stride; ++c)
        step[c] = moves[c] ? next[node_stride + c] / norms[node_stride + c] : 0.;
      norms = next;
    }
    multiplier.update_ghosts();
    matrix.change_gradients(multiplier, shape);
    result.defect = compute_defect(volume, boundary, shape, residual);
    if (scale > 0.)
    {
      result.defect_before /= scale;
      result.defect /= scale;
    }
    return result;
  }

  template <int dim>
  double ConsistentGradients<dim>::defect(const std::vector<double> &volume,
                                          const NodalVector &boundary, const Stencils &shape)
  {
    NodalVector residual;
    residual.reinit(boundary.partition());
    const double scale = std::sqrt(
        total(ordered_sum(products(boundary, boundary), boundary.partition()->communicator())));
    const double norm = compute_defect(volume, boundary, shape, residual);
    return scale > 0. ? norm / scale : 0.;
  }

  template struct ConsistentGradients<2>;
  template struct ConsistentGradients<3>;
} // namespace tombolo
