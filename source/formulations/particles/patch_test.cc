// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/patch_test.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
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
    for (const auto &cell : setup.cells())
    {
      all_nodes.cell_nodes(cell, cell_nodes);
      for (const unsigned int face : cell->face_indices())
      {
        const bool at_boundary = cell->face(face)->at_boundary();
        if (!at_boundary && (setup.part_cells == nullptr ||
                             setup.is_of_equals(setup.part_cells->part_beyond(cell, face))))
          continue;
        if (at_boundary && !all_nodes.is_outer_face(cell, face))
          continue;
        for (const unsigned int corner : all_nodes.face_node_indices(face))
          face_nodes.push_back(cell_nodes[corner]);
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

  namespace
  {
    /** The vectors b of owned nodes, where tractions of a constant stress act. Collective. */
    template <int dim>
    NodalVector boundary_areas(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                               const bool smooths, const NodalVector &position,
                               const Stencils &shape)
    {
      // A traction t enters the nodal forces as Φᵀ(t s), and so do the forces of elements with the
      // trace bridge; with the paper's they stay where they are. A prescribed particle, and any one
      // where nothing is smoothed, has a unit row of Φ. At lumped rows forces stay, too.
      PartBoundary<dim> boundary;
      boundary.initialize(setup);
      const auto &partition = position.partition();
      NodalVector areas, target;
      areas.reinit(partition);
      target.reinit(partition);
      if (!smooths || shape.is_lumped)
        boundary.add_areas(position, target, target);
      else
        boundary.add_areas(position, areas, setup.trace_bridge ? areas : target);
      areas.collect();
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        const double *const area = areas.node(shape.particle_node[i]);
        const auto add = [&](const unsigned int node, const double share)
        {
          for (unsigned int d = 0; d < dim; ++d)
            target.node(node)[d] += share * area[d];
        };
        if (setup.prescribed_nodes.size() > 0 &&
            setup.prescribed_nodes.is_element(particles.nodes()[i]))
          add(shape.particle_node[i], 1.);
        else if (std::any_of(area, area + dim,
                             [](const double component) { return component != 0.; }))
        {
          const Stencils::Row row = shape.row(i);
          for (unsigned int k = 0; k < row.size; ++k)
            add(row.neighbour[k], row.value[k]);
        }
      }
      target.collect();
      return target;
    }

    /** The Euclidean norm over owned nodes of all ranks. Collective. */
    double norm_of(const NodalVector &field)
    {
      NodeLanes sum = 0.;
      for (unsigned int i = 0; i < field.partition()->n_owned(); ++i)
        sum += load_node(field.node(i)) * load_node(field.node(i));
      std::array<double, node_stride> squares;
      store_node(sum, squares.data());
      double result = 0;
      for (const double square : ordered_sum(squares, field.partition()->communicator()))
        result += square;
      return std::sqrt(result);
    }
  } // namespace

  template <int dim>
  double patch_test_defect(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                           const bool smooths, const std::vector<double> &volume,
                           const NodalVector &position, const Stencils &shape,
                           const std::vector<double> &own_shares)
  {
    const NodalVector boundary = boundary_areas(setup, particles, smooths, position, shape);
    const auto own_share = [&](const unsigned int i)
    { return own_shares.empty() ? 1. : own_shares[i]; };
    NodalVector residual(boundary.partition());
    const auto add = [&](const unsigned int node, const NodeLanes &value)
    { store_node(load_node(residual.node(node)) + value, residual.node(node)); };
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
      {
        NodeLanes gradient = load_node(row.gradient + k * Stencils::n_gradient);
        gradient[3] = 0.;
        add(row.neighbour[k], gradient * (-volume[i] / own_share(i)));
      }
    }
    residual.add_to_owners();
    for (unsigned int i = 0; i < residual.partition()->n_owned(); ++i)
      add(i, load_node(boundary.node(i)));
    // Nodes of equal parts have forces from there, too.
    NodalVector tested(boundary.partition());
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      if (own_share(i) == 1.)
        store_node(load_node(residual.node(shape.particle_node[i])),
                   tested.node(shape.particle_node[i]));
    const double scale = norm_of(boundary), norm = norm_of(tested);
    return scale > 0. ? norm / scale : 0.;
  }

  template double patch_test_defect<2>(const PartSetup<2> &, const ParticleSet<2> &, bool,
                                       const std::vector<double> &, const NodalVector &,
                                       const Stencils &, const std::vector<double> &);
  template double patch_test_defect<3>(const PartSetup<3> &, const ParticleSet<3> &, bool,
                                       const std::vector<double> &, const NodalVector &,
                                       const Stencils &, const std::vector<double> &);
} // namespace tombolo
