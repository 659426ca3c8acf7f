// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/part_boundary.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void PartBoundary<dim>::initialize(const PartSetup<dim> &setup)
  {
    const Nodes<dim> &all_nodes = *setup.nodes;
    const unsigned int degree = all_nodes.degree();
    shapes = FaceShapes<dim>(degree, (3 * degree + 1) / 2); // exact for N t₁ × t₂

    face_nodes.clear();
    orientation.clear();
    is_shared.clear();
    std::vector<types::global_dof_index> cell_nodes;
    for (const auto &cell : all_nodes.dof_handler().active_cell_iterators())
    {
      if (!cell->is_locally_owned() ||
          (setup.part_cells != nullptr && setup.part_cells->part_of(cell) != setup.index))
        continue;
      all_nodes.cell_nodes(cell, cell_nodes);
      for (const unsigned int face : cell->face_indices())
      {
        const bool at_boundary = cell->face(face)->at_boundary();
        if (!at_boundary && (setup.part_cells == nullptr ||
                             setup.part_cells->part_beyond(cell, face) == setup.index))
          continue;
        if (at_boundary && !all_nodes.is_outer_face(cell, face))
          continue;
        for (const unsigned int place : all_nodes.face_places(face))
          face_nodes.push_back(cell_nodes[place]);
        is_shared.push_back(!at_boundary);
        // The tangents of a face are those of the cell's axes in their order; their product points
        // along the third axis, but against the second.
        orientation.push_back((face % 2 == 0 ? -1. : 1.) * (face / 2 == 1 ? -1. : 1.));
      }
    }
  }

  template <int dim>
  void PartBoundary<dim>::add_areas(const NodalVector &position, NodalVector &free,
                                    NodalVector &shared) const
  {
    const NodePartition &partition = *position.partition();
    const unsigned int nodes_per_face = shapes.n_nodes;
    std::vector<unsigned int> local(nodes_per_face);
    for (std::size_t face = 0; face < orientation.size(); ++face)
    {
      for (unsigned int k = 0; k < nodes_per_face; ++k)
        local[k] = partition.local_index(face_nodes[face * nodes_per_face + k]);
      NodalVector &areas = is_shared[face] ? shared : free;
      for (unsigned int q = 0; q < shapes.weights.size(); ++q)
      {
        const Tensor<1, dim> normal =
            shapes.weights[q] * orientation[face] *
            shapes.normal(q, [&](const unsigned int k) { return position.node(local[k]); });
        for (unsigned int k = 0; k < nodes_per_face; ++k)
          for (unsigned int c = 0; c < dim; ++c)
            areas.node(local[k])[c] += shapes.value(q, k) * normal[c];
      }
    }
  }

  template class PartBoundary<2>;
  template class PartBoundary<3>;
} // namespace tombolo
