// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_formulation.h>

#include <tombolo/approximation/row_deformation.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  std::vector<SurfaceFibre> find_surface_fibres(const PartSetup<dim> &setup)
  {
    std::vector<SurfaceFibre> fibres;
    const Nodes<dim> &nodes = *setup.nodes;
    std::vector<types::global_dof_index> own, inner;
    std::vector<Point<dim>> points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (!cell->is_locally_owned() || setup.part_cells->part_of(cell) != setup.index)
        continue;
      nodes.cell_nodes(cell, own);
      nodes.cell_points(cell, points);
      for (const unsigned int face : cell->face_indices())
      {
        const unsigned int opposite = face ^ 1u;
        if (!nodes.is_outer_face(cell, face) || cell->at_boundary(opposite) ||
            setup.part_cells->part_beyond(cell, opposite) != setup.index)
          continue;
        nodes.cell_nodes(typename Nodes<dim>::Cell(&nodes.dof_handler().get_triangulation(),
                                                   cell->neighbor(opposite)->level(),
                                                   cell->neighbor(opposite)->index(),
                                                   &nodes.dof_handler()),
                         inner);
        const unsigned int across = cell->neighbor_of_neighbor(opposite) / 2;
        for (const unsigned int place : nodes.face_places(face))
        {
          const unsigned int next = place ^ (1u << (face / 2));
          const auto in_neighbour = static_cast<unsigned int>(
              std::find(inner.begin(), inner.end(), own[next]) - inner.begin());
          fibres.push_back({{{own[place], own[next], inner[in_neighbour ^ (1u << across)]}},
                            cell->measure() / (1u << dim),
                            points[place].distance(points[next])});
        }
      }
    }
    return fibres;
  }

  template std::vector<SurfaceFibre> find_surface_fibres<2>(const PartSetup<2> &);
  template std::vector<SurfaceFibre> find_surface_fibres<3>(const PartSetup<3> &);

  template <int dim>
  const char *ParticleFormulation<dim>::phase() const
  {
    return "particle forces";
  }

  template <int dim>
  const std::vector<unsigned int> &ParticleFormulation<dim>::particle_nodes() const
  {
    return stencils().particle_node;
  }

  template <int dim>
  double ParticleFormulation<dim>::smallest_spacing() const
  {
    return particle_set().smallest_spacing();
  }

  template <int dim>
  Point<dim> ParticleFormulation<dim>::support(const unsigned int i) const
  {
    Point<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = particle_set().initial_supports()[std::size_t(i) * node_stride + d];
    return result;
  }

  template <int dim>
  Tensor<2, dim> ParticleFormulation<dim>::deformation(const unsigned int i,
                                                       const NodalVector &position) const
  {
    if (stencils().is_undeformed(i))
      return Tensor<2, dim>(unit_symmetric_tensor<dim>());
    return row_deformation<dim>(stencils(), i, position);
  }

  template <int dim>
  NeighbourCounts ParticleFormulation<dim>::neighbour_counts() const
  {
    const Stencils &shape = stencils();
    NeighbourCounts counts;
    std::size_t sum = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      const auto n =
          row.size - static_cast<unsigned int>(std::count(row.value, row.value + row.size, 0.));
      counts.minimum = i == 0 ? n : std::min(counts.minimum, n);
      counts.maximum = std::max(counts.maximum, n);
      sum += n;
    }
    if (shape.n_particles() > 0)
      counts.mean = static_cast<double>(sum) / shape.n_particles();
    return counts;
  }

  template <int dim>
  unsigned int ParticleFormulation<dim>::degree() const
  {
    return 0;
  }

  template <int dim>
  void ParticleFormulation<dim>::add_mass(NodalVector &mass) const
  {
    const Stencils &shape = stencils();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      *mass.node(shape.particle_node[i]) += shape.mass[i];
  }

  template <int dim>
  void ParticleFormulation<dim>::point_positions(const NodalVector &position,
                                                 std::vector<Point<dim>> &points) const
  {
    const Stencils &shape = stencils();
    points.resize(shape.n_particles());
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        points[i][d] = position.node(shape.particle_node[i])[d];
  }

  template <int dim>
  const std::vector<Point<dim>> &ParticleFormulation<dim>::initial_point_positions() const
  {
    return particle_set().initial_positions();
  }

  template <int dim>
  unsigned int ParticleFormulation<dim>::n_cells() const
  {
    return 0;
  }

  template <int dim>
  unsigned int ParticleFormulation<dim>::n_points_per_cell() const
  {
    return 0;
  }

  template class ParticleFormulation<2>;
  template class ParticleFormulation<3>;
} // namespace tombolo
