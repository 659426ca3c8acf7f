// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/mesh/nodes.h>

#include <deal.II/fe/fe_values.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** What a cell gives to the averages around its nodes I, with the functions N_J of its nodes J
   * (see CellAverages). */
  template <int dim>
  struct CellIntegrals
  {
    using Node = dealii::types::global_dof_index;

    static constexpr double gradient_sharpness = 2.; ///< s of χ = Π_k (1 ± s ξ_k) / 2
    static constexpr double value_sharpness = 1.5;   ///< of ψ

    /** All zero. */
    CellIntegrals(const std::vector<Node> &nodes, const std::vector<dealii::Point<dim>> &points);

    /** Integrates over a cell whose corners are the nodes; @p hierarchic are their numbers in
     * @p fe_values. */
    void add(const dealii::FEValues<dim> &fe_values, const std::vector<unsigned int> &hierarchic);

    /** The same of the corners, or in the place of those that depend on others, of the others.
     * @p places are those of Nodes::points_depended_on(). */
    CellIntegrals of_nodes_that_move(const Nodes<dim> &of_mesh,
                                     const std::map<Node, dealii::Point<dim>> &places) const;

    std::vector<Node> nodes;
    std::vector<dealii::Point<dim>> points;
    std::vector<double> volume;                   ///< ∫ χ_I
    std::vector<double> weight;                   ///< ∫ ψ_I
    std::vector<dealii::Tensor<1, dim>> moment;   ///< ∫ ψ_I (x - x_I)
    std::vector<double> value;                    ///< ∫ ψ_I N_J, J fastest
    std::vector<dealii::Tensor<1, dim>> gradient; ///< ∫ χ_I ∇N_J
  };

  /**
   * φ and ∇φ of particles as averages over the cells around them, without a kernel and without a
   * direction: with the functions N of the linear cells, weights w of their Gauss points,
   *
   * @verbatim
   *   V_I ∇φ_J(x_I) = Σ_q w_q χ_I(ξ_q) ∇N_J(x_q),     V_I = Σ_q w_q χ_I(ξ_q)
   *   φ_J(x_I) = Σ_q w_q ψ_I(ξ_q) N_J(x_q) / Σ_q w_q ψ_I(ξ_q) - d_I · ∇φ_J(x_I)
   *   χ_I = Π_k (1 ± 2 ξ_k) / 2,   ψ_I = Π_k (1 ± 3/2 ξ_k) / 2
   * @endverbatim
   *
   * where d_I is the centre of ψ_I relative to x_I. As Σ_I χ_I = 1, the nodal forces of a constant
   * stress are those of its tractions at the boundary, lumped as by linear elements: the patch test
   * is passed to round-off in any mesh. The centre of χ_I of a particle at a plane surface is a
   * sixth of a cell inside, for which the second moments of a layered body are exact but for
   * (h/6)²: bending is not too stiff. Inside a lattice ∂φ is the central difference, averaged
   * across by (1, 10, 1)/12, and φ is (1, 6, 1)/8 an axis, for which affine smoothing has the phase
   * speed of linear elements with lumped mass.
   *
   * Corners of cells that depend on others are no particles: with N = Σ C N of the others, χ and ψ
   * of these have their shares C of those of such a corner, and all of the above stays.
   *
   * The functions are those of the initial configuration. doc/method.md, section 2.
   */
  template <int dim>
  class CellAverages
  {
  public:
    CellAverages() = default;
    explicit CellAverages(const Entries &e);

    /** Decides whether the particles of this part have these functions. Throws the InputError of
     * what they do not have, where they are asked for. */
    void choose(const PartSetup<dim> &setup);
    /** Why the part cannot have these functions; empty if it can. */
    std::string obstacle(const PartSetup<dim> &setup) const;
    bool is_on() const
    {
      return is_chosen;
    }
    /** What the functions are and, where they could be others, why they are not, for the audit. */
    std::string description() const;

    /** Computes the functions of @p particles, the nodes of the part of choose(), and gives these
     * the volumes V_I, and supports that reach all in whose rows they are. Collective. */
    void establish(ParticleSet<dim> &particles);

    /** Leaves in the rows of @p found those that have functions. */
    void restrict(Neighbourhoods<dim> &found, Stencils &stencils) const;

    /** Fills the rows of @p stencils; with @p share_rows, those that are the same are kept once. */
    void fill(const Neighbourhoods<dim> &found, bool share_rows, Stencils &stencils) const;

  private:
    struct Entry
    {
      ImageNode node;
      double value = 0;
      double gradient[3] = {};
    };
    /** What the cells around a particle have summed up; all but volume with images of cells. */
    struct Sums
    {
      Entry &at(const ImageNode &node);

      std::vector<Entry> entries; // by node
      double volume = 0, image_volume = 0, weight = 0;
      double moment[dim] = {};
    };
    using Node = dealii::types::global_dof_index;
    /** Stencils::accelerated_share of @p particles with lumped volumes. Collective. */
    std::vector<double> find_accelerated_shares(const ParticleSet<dim> &particles) const;
    /** Adds the integrals of a cell to the sums of its nodes, where @p sums_of has some. */
    void add_cell(const CellIntegrals<dim> &integrals,
                  const std::function<Sums *(Node)> &sums_of) const;
    /** Adds what all ranks have for particles. Collective. */
    void add_from_ranks(const std::map<Node, Sums> &of_rank,
                        const std::function<Sums *(Node)> &sums_of) const;
    /** Widens supports of @p particles where they do not reach rows that they are in. Collective.
     */
    void widen_supports(ParticleSet<dim> &particles) const;
    const Entry *find(const Neighbourhoods<dim> &found, unsigned int row, unsigned int place) const;

    Section section;
    std::string wanted, reason;
    bool is_chosen = false;
    const Nodes<dim> *nodes = nullptr;
    const PartCells<dim> *part_cells = nullptr;
    unsigned int part = 0;
    std::vector<std::vector<Entry>> rows;  // by particle, ascending by node
    std::vector<double> accelerated_share; // by particle
  };
} // namespace tombolo
