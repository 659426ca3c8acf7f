// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/interpolated_remap.h>

#include <tombolo/remesh/cloud_interpolation.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Half widths over the largest distance to a node of the same cell: that of the paper. */
    constexpr double remap_dilation = 1.1;

    /** The half widths of nodes, and their bodies. */
    template <int dim>
    class NodeSupports
    {
    public:
      /** Ghosts are current. Collective. */
      NodeSupports(const std::vector<RemapCell<dim>> &cells, const NodePartition &partition)
      {
        for (auto *const vector : vectors())
        {
          vector->reinit(partition.scalars());
          // What no cell has must not win.
          for (unsigned int i = 0; i < partition.n_owned() + partition.n_ghosts(); ++i)
            vector->local_element(i) = -1.;
        }
        for (const RemapCell<dim> &cell : cells)
          for (unsigned int k = 0; k < cell.nodes.size(); ++k)
          {
            double &of_node = body.local_element(cell.nodes[k]);
            of_node = std::max(of_node, cell.body);
            for (unsigned int d = 0; d < dim; ++d)
              for (const Point<dim> &other : cell.before)
              {
                double &width = widths[d].local_element(cell.nodes[k]);
                width = std::max(width, remap_dilation * std::abs(other[d] - cell.before[k][d]));
              }
          }
        for (auto *const vector : vectors())
        {
          vector->compress(VectorOperation::max);
          vector->update_ghost_values();
        }
      }

      /** Whether a cell has it. */
      bool is_known(const unsigned int node) const
      {
        return body.local_element(node) >= 0.;
      }

      Tensor<1, dim> of_node(const unsigned int node) const
      {
        Tensor<1, dim> result;
        for (unsigned int d = 0; d < dim; ++d)
          result[d] = widths[d].local_element(node);
        return result;
      }

      double body_of(const unsigned int node) const
      {
        return body.local_element(node);
      }

    private:
      using Vector = LinearAlgebra::distributed::Vector<double>;

      std::vector<Vector *> vectors()
      {
        std::vector<Vector *> result(1, &body);
        for (Vector &width : widths)
          result.push_back(&width);
        return result;
      }

      std::array<Vector, dim> widths;
      Vector body;
    };

    template <int dim>
    Point<dim> place_of_node(const NodalVector &position, const unsigned int node)
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position.node(node)[d];
      return result;
    }

    template <int dim>
    Point<dim> place_of_point(const std::vector<double> &shares,
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
    const NodeSupports<dim> supports(cells, partition);
    Cloud<dim> cloud, targets;
    std::vector<unsigned int> moved;
    std::vector<double> values;
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
    {
      if (!supports.is_known(i))
        continue;
      cloud.places.push_back(place_of_node<dim>(before, i));
      cloud.bodies.push_back(supports.body_of(i));
      cloud.supports.push_back(supports.of_node(i));
      for (const NodalVector *const field : fields)
        values.insert(values.end(), field->node(i), field->node(i) + node_stride);
      const Point<dim> place = place_of_node<dim>(after, i);
      if (place == cloud.places.back())
        continue;
      moved.push_back(i);
      targets.places.push_back(place);
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
    // Several points of a cell lie nearer to each other than cells.
    const double share_of_cell = corner_shares.size() == 1 ? 1. : 0.85;
    const NodeSupports<dim> supports(cells, *partition);
    Cloud<dim> cloud, targets;
    for (const RemapCell<dim> &cell : cells)
    {
      Tensor<1, dim> support;
      for (const unsigned int node : cell.nodes)
        for (unsigned int d = 0; d < dim; ++d)
          support[d] = std::max(support[d], share_of_cell * supports.of_node(node)[d]);
      for (const std::vector<double> &shares : corner_shares)
      {
        cloud.places.push_back(place_of_point<dim>(shares, cell.before));
        cloud.bodies.push_back(cell.body);
        cloud.supports.push_back(support);
        if (!cell.has_moved())
          continue;
        targets.places.push_back(place_of_point<dim>(shares, cell.after));
        targets.bodies.push_back(cell.body);
      }
    }
    const CloudInterpolation<dim> interpolation(cloud, targets, partition->communicator());
    std::vector<double> found = interpolation.interpolate(points.values, points.n_components);
    interpolation.limit(points.values, points.n_components, points.stress, found);
    const std::size_t n = corner_shares.size() * points.n_components;
    auto next = found.begin();
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (cells[c].has_moved())
      {
        std::copy_n(next, n, points.values.begin() + std::ptrdiff_t(c * n));
        next += std::ptrdiff_t(n);
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
} // namespace tombolo
