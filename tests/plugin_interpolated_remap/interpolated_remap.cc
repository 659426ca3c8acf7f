// SPDX-License-Identifier: LGPL-2.1-or-later
#include "interpolated_remap.h"

#include "cloud_interpolation.h"

#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/formulations/smoothed/value_remap.h>
#include <tombolo/remesh/nodal_projection.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Half widths over the largest distance to a node of the same cell: that of the paper. */
    constexpr double remap_dilation = 1.1;

    /** J Jᵀ in the middle of a cell of before: its size and shear, whatever its own axes are. */
    template <int dim>
    Tensor<2, dim> shape_of(const RemapCell<dim> &cell)
    {
      const Tensor<2, dim> jacobian = PointOfCell<dim>(cell.before).jacobian;
      return jacobian * transpose(jacobian);
    }

    /** What makes cells of this shape turned unit cells. */
    template <int dim>
    Tensor<2, dim> inverse_root(const Tensor<2, dim> &shape)
    {
      Tensor<2, dim> result;
      for (const auto &pair :
           eigenvectors(symmetrize(shape), SymmetricTensorEigenvectorMethod::jacobi))
        result += outer_product(pair.second, pair.second) / std::sqrt(pair.first);
      return result;
    }

    /** The supports of nodes, which have the mean shape of the cells around, and their bodies. */
    template <int dim>
    class NodeSupports
    {
    public:
      /** Collective. */
      NodeSupports(const std::vector<RemapCell<dim>> &cells,
                   const std::shared_ptr<const NodePartition> &partition)
          : body(partition, nothing)
      {
        find_shapes(cells, partition);
        for (unsigned int d = 0; d < dim; ++d)
          widths.emplace_back(partition, nothing);
        for (const RemapCell<dim> &cell : cells)
          for (unsigned int k = 0; k < cell.nodes.size(); ++k)
          {
            body.raise(cell.nodes[k], cell.body);
            const Tensor<2, dim> inverse = inverse_root(shape(cell.nodes[k]));
            for (const Point<dim> &other : cell.before)
            {
              const Tensor<1, dim> distance = inverse * (other - cell.before[k]);
              for (unsigned int d = 0; d < dim; ++d)
                widths[d].raise(cell.nodes[k], remap_dilation * std::abs(distance[d]));
            }
          }
        body.share();
        for (NodeMaxima &width : widths)
          width.share();
      }

      /** Whether a cell has it. */
      bool is_known(const unsigned int node) const
      {
        return body[node] >= 0.;
      }

      /** CloudFunctions of nodes. */
      Tensor<2, dim> metric(const unsigned int node) const
      {
        Tensor<2, dim> result = inverse_root(shape(node));
        for (unsigned int d = 0; d < dim; ++d)
          result[d] /= widths[d][node];
        return result;
      }

      /** CloudFunctions of the middles of cells: as wide as those of the nodes around. */
      Tensor<2, dim> metric_of_cell(const RemapCell<dim> &cell) const
      {
        Tensor<2, dim> result = inverse_root(shape_of(cell));
        for (unsigned int d = 0; d < dim; ++d)
          result[d] /= widths[d].largest_of(cell.nodes);
        return result;
      }

      double body_of(const unsigned int node) const
      {
        return body[node];
      }

    private:
      static constexpr double nothing = -1.; // less than any body and any width

      void find_shapes(const std::vector<RemapCell<dim>> &cells,
                       const std::shared_ptr<const NodePartition> &partition)
      {
        for (NodalVector &row : shapes)
          row.reinit(partition, Quantity::scalars);
        for (const RemapCell<dim> &cell : cells)
        {
          const Tensor<2, dim> cell_shape = shape_of(cell);
          for (const unsigned int node : cell.nodes)
            for (unsigned int i = 0; i < dim; ++i)
            {
              shapes[i].node(node)[node_stride - 1] += 1.;
              for (unsigned int j = 0; j < dim; ++j)
                shapes[i].node(node)[j] += cell_shape[i][j];
            }
        }
        for (NodalVector &row : shapes)
        {
          row.sum_over_ranks();
        }
      }

      Tensor<2, dim> shape(const unsigned int node) const
      {
        Tensor<2, dim> result;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            result[i][j] = shapes[i].node(node)[j] / shapes[i].node(node)[node_stride - 1];
        return result;
      }

      std::array<NodalVector, dim> shapes; // rows of sums over cells; their number comes last
      std::vector<NodeMaxima> widths;      // along each axis
      NodeMaxima body;
    };

    template <int dim>
    Point<dim> node_position(const NodalVector &position, const unsigned int node)
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position.node(node)[d];
      return result;
    }

    template <int dim>
    Point<dim> point_position(const std::vector<double> &shares,
                              const typename SubCells<dim>::Corners &corners)
    {
      Point<dim> result;
      for (unsigned int k = 0; k < corners.size(); ++k)
        result += shares[k] * corners[k];
      return result;
    }

    /** Collective. */
    template <int dim>
    bool any_has_moved(const std::vector<RemapCell<dim>> &cells, const MPI_Comm communicator)
    {
      const bool moves = std::any_of(cells.begin(), cells.end(),
                                     [](const RemapCell<dim> &cell) { return cell.has_moved(); });
      return Utilities::MPI::max(moves ? 1 : 0, communicator) != 0;
    }
  } // namespace

  template <int dim>
  void interpolate_nodal_fields(const std::vector<RemapCell<dim>> &cells, const NodalVector &before,
                                const NodalVector &after, const std::vector<NodalVector *> &fields)
  {
    const NodePartition &partition = *before.partition();
    if (!any_has_moved(cells, partition.communicator()))
      return;
    const NodeSupports<dim> supports(cells, before.partition());
    Cloud<dim> cloud, targets;
    std::vector<unsigned int> moved;
    std::vector<double> values;
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      if (!supports.is_known(i))
        continue;
      cloud.positions.push_back(node_position<dim>(before, i));
      cloud.bodies.push_back(supports.body_of(i));
      cloud.metrics.push_back(supports.metric(i));
      for (const NodalVector *const field : fields)
        values.insert(values.end(), field->node(i), field->node(i) + node_stride);
      const Point<dim> new_position = node_position<dim>(after, i);
      if (new_position == cloud.positions.back())
        continue;
      moved.push_back(i);
      targets.positions.push_back(new_position);
      targets.bodies.push_back(cloud.bodies.back());
    }
    const CloudInterpolation<dim> interpolation(cloud, targets, partition.communicator());
    const auto n = static_cast<unsigned int>(fields.size() * node_stride);
    const std::vector<double> found = interpolation.interpolate(values, n);
    const double *next = found.data();
    for (const unsigned int i : moved)
      for (NodalVector *const field : fields)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          field->node(i)[slot] = *next++;
    for (NodalVector *const field : fields)
      field->update_ghosts();
  }

  template <int dim>
  void interpolate_points(const std::vector<RemapCell<dim>> &cells,
                          const std::shared_ptr<const NodePartition> &partition,
                          const std::vector<std::vector<double>> &corner_shares,
                          PointValues &points)
  {
    if (!any_has_moved(cells, partition->communicator()))
      return;
    const NodeSupports<dim> supports(cells, partition);
    const std::size_t n_points = corner_shares.size();
    const unsigned int n = points.n_components;
    Cloud<dim> cloud, targets;
    std::vector<double> means;
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      const RemapCell<dim> &cell = cells[c];
      cloud.positions.emplace_back();
      means.resize((c + 1) * n, 0.);
      const double *const mass = points.mass.data() + c * n_points;
      const double total = std::accumulate(mass, mass + n_points, 0.);
      for (std::size_t q = 0; q < n_points; ++q)
      {
        cloud.positions.back() +=
            mass[q] / total * point_position<dim>(corner_shares[q], cell.before);
        for (unsigned int f = 0; f < n; ++f)
          means[c * n + f] += mass[q] / total * points.values[(c * n_points + q) * n + f];
      }
      cloud.bodies.push_back(cell.body);
      cloud.metrics.push_back(supports.metric_of_cell(cell));
      for (std::size_t q = 0; q < n_points && cell.has_moved(); ++q)
      {
        targets.positions.push_back(point_position<dim>(corner_shares[q], cell.after));
        targets.bodies.push_back(cell.body);
      }
    }
    const CloudInterpolation<dim> interpolation(cloud, targets, partition->communicator());
    std::vector<double> found = interpolation.interpolate(means, n);
    interpolation.limit(means, n, points.stress, found);
    auto next = found.begin();
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (cells[c].has_moved())
      {
        std::copy_n(next, n_points * n, points.values.begin() + std::ptrdiff_t(c * n_points * n));
        next += std::ptrdiff_t(n_points * n);
      }
  }

  template void interpolate_nodal_fields(const std::vector<RemapCell<2>> &, const NodalVector &,
                                         const NodalVector &, const std::vector<NodalVector *> &);
  template void interpolate_nodal_fields(const std::vector<RemapCell<3>> &, const NodalVector &,
                                         const NodalVector &, const std::vector<NodalVector *> &);
  template void interpolate_points(const std::vector<RemapCell<2>> &,
                                   const std::shared_ptr<const NodePartition> &,
                                   const std::vector<std::vector<double>> &, PointValues &);
  template void interpolate_points(const std::vector<RemapCell<3>> &,
                                   const std::shared_ptr<const NodePartition> &,
                                   const std::vector<std::vector<double>> &, PointValues &);

  template <int dim>
  class InterpolatedRemap : public ValueRemap<dim>
  {
  public:
    static void declare_parameters(ParameterHandler &) {}

    explicit InterpolatedRemap(const Section &) {}

    void remap_nodes(const std::vector<RemapCell<dim>> &cells, const NodalVector &before,
                     const NodalVector &after,
                     const std::vector<NodalVector *> &fields) const override
    {
      interpolate_nodal_fields(cells, before, after, fields);
    }

    void remap_points(const std::vector<RemapCell<dim>> &cells,
                      const std::shared_ptr<const NodePartition> &partition,
                      const std::vector<std::vector<double>> &corner_shares,
                      PointValues &points) const override
    {
      interpolate_points(cells, partition, corner_shares, points);
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(ValueRemap, InterpolatedRemap, "interpolation",
                                  "values at new places, Wu et al. 2015, eqs (65) to (74)")
} // namespace tombolo
