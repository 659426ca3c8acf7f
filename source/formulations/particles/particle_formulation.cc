// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_formulation.h>

namespace tombolo
{
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

  template class ParticleFormulation<2>;
  template class ParticleFormulation<3>;
} // namespace tombolo
