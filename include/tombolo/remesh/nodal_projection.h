// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>

#include <array>

namespace tombolo
{
  /**
   * The conservative remap of a nodal field: the weighted least squares
   *
   * @verbatim
   *   Σ_K (∫ ρ Ψ⁺_J Ψ⁺_K + δ_JK d_J) z⁺_K = ∫ ρ Ψ⁺_J z⁻ + d_J z⁻_J
   * @endverbatim
   *
   * in the present body, with the functions of CellSimplices and the exact integrals of
   * CellOverlap. d_J is what node J has of @p mass beyond that of the integrals: the mass of other
   * parts there, and of the part itself the difference to the integrals. The masses of nodes become
   * m⁺ = ∫ ρ Ψ⁺ + d, so that Σ m z stays to round-off, and linear fields stay where d is zero or
   * nodes stay.
   *
   * @p field number @p number of the overlap, node_stride slots; @p mass: scalar, in the measure of
   * ρ, at owned nodes. @p field gets the values of after, with current ghosts. With @p mass_after
   * m⁺ is that, d is what it has beyond the integrals and never less than zero, and nodes that have
   * moved get for d what the field is in the mean around them. One shift of all nodes restores Σ m
   * z then. Nodes that have lost all cells have zero. Constant fields stay. Collective.
   */
  template <int dim>
  void project_nodal_field(const CellOverlap<dim> &overlap, unsigned int number,
                           const NodalVector &mass, NodalVector &field,
                           const NodalVector *mass_after = nullptr);

  /**
   * Keeps a field of project_nodal_field() between the values that it had @p before, with ghosts,
   * at nodes up to two cells away: a projection overshoots beside steep gradients. What this adds
   * or takes goes to where there is room for it around cells that have moved, so that Σ m z stays.
   * @p mass: m⁺, at owned nodes. Collective.
   */
  template <int dim>
  void limit_nodal_field(const CellOverlap<dim> &overlap, const NodalVector &before,
                         const NodalVector &mass, NodalVector &field);

  /** ∫ ρ Ψ⁺ less ∫ ρ Ψ⁻ of each corner of each cell: what its lumped mass gains, by cell and
   * corner [M]. */
  template <int dim>
  std::vector<double> gained_masses(const CellOverlap<dim> &overlap);

  /** ∫ ρ Ψ⁺ of each corner of a cell of after whose sub-cells have these masses [M]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_corners>
  masses_of_corners(const typename SubCells<dim>::Corners &corners, const double *of_sub_cells);
} // namespace tombolo
