// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/nodal_projection.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/remesh/cell_matrices.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void project_nodal_field(const CellOverlap<dim> &overlap, const unsigned int number,
                           const NodalVector &mass, NodalVector &field)
  {
    if (!overlap.has_motion)
      return;
    constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
    const auto &partition = field.partition();
    const unsigned int n_owned = partition->n_owned();
    CellMatrices<dim> matrices(partition);
    NodalVector right_side, after, before;
    right_side.reinit(partition, node_stride, field.under_reflection());
    after.reinit(partition, 1);
    before.reinit(partition, 1);
    for (std::size_t c = 0; c < overlap.cells.size(); ++c)
    {
      const auto &integrals = overlap.integrals[c];
      const auto &nodes = overlap.cells[c].nodes;
      matrices.add_cell(nodes, integrals.matrix);
      for (unsigned int k = 0; k < n_corners; ++k)
      {
        *after.node(nodes[k]) += integrals.mass[k];
        *before.node(nodes[k]) += overlap.covered_mass[c][k];
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          right_side.node(nodes[k])[slot] +=
              integrals.values[(std::size_t(number) * n_corners + k) * node_stride + slot];
      }
    }
    for (NodalVector *const vector : {&right_side, &after, &before})
      vector->add_to_owners();
    NodalVector weight; // m⁺; zero at nodes of other parts
    weight.reinit(partition, 1);
    std::vector<double> sums(2 * node_stride + 1, 0.);
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      if (!(*after.node(i) > 0.))
        continue;
      const double rest = *mass.node(i) - *before.node(i);
      *matrices.diagonal.node(i) = rest;
      *weight.node(i) = *after.node(i) + rest;
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        right_side.node(i)[slot] += rest * field.node(i)[slot];
    }
    constexpr double tolerance = 1e-15;
    matrices.solve(right_side, weight, tolerance, field);
    // What the iterations left of the sums.
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      sums[2 * node_stride] += *weight.node(i);
      for (unsigned int slot = 0; slot < node_stride; ++slot)
      {
        sums[slot] += *weight.node(i) > 0. ? right_side.node(i)[slot] : 0.;
        sums[node_stride + slot] += *weight.node(i) * field.node(i)[slot];
      }
    }
    sums = ordered_sum(sums, overlap.communicator);
    for (unsigned int i = 0; i < n_owned; ++i)
      if (*weight.node(i) > 0.)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          field.node(i)[slot] += (sums[slot] - sums[node_stride + slot]) / sums[2 * node_stride];
    field.update_ghosts();
  }

  template <int dim>
  std::vector<double> gained_masses(const CellOverlap<dim> &overlap)
  {
    std::vector<double> result;
    for (std::size_t c = 0; c < overlap.cells.size(); ++c)
      for (unsigned int k = 0; k < CellOverlap<dim>::n_corners; ++k)
        result.push_back(overlap.integrals[c].mass[k] - overlap.covered_mass[c][k]);
    return result;
  }

  template void project_nodal_field(const CellOverlap<2> &, unsigned int, const NodalVector &,
                                    NodalVector &);
  template void project_nodal_field(const CellOverlap<3> &, unsigned int, const NodalVector &,
                                    NodalVector &);
  template std::vector<double> gained_masses(const CellOverlap<2> &);
  template std::vector<double> gained_masses(const CellOverlap<3> &);
} // namespace tombolo
