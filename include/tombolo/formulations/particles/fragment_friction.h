// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/fragment_touch.h>
#include <tombolo/materials/temperature_table.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /**
   * Friction and conduction between the fragments of one part, beside the normal forces of
   * SelfContact.
   *
   * Along the surface two particles hang on a spring of half the stiffness k of that along the
   * normal. Its elongation s follows the motion of the two materials at the point of contact,
   *
   *   Δ = Δu_J + W_J r_J - Δu_I - W_I r_I,  without its normal component,
   *
   * with the displacements Δu of the step, the offsets r of the point of contact from the centres,
   * and the skew part W of Σ_K Δu_K ⊗ g_K by the present gradients g. Particles without a linear
   * basis (debris) are points without spin, W = 0. s turns with both materials and keeps its
   * length, and slips at |½ k s| = μ f_n. The forces act at the point of contact: their moments
   * about the centres are carried by the neighbours K as ½ (f ⊗ r - r ⊗ f) g_K, the adjoint of W.
   * So friction sees no rotation of a body, linear momentum is kept to round-off, and angular
   * momentum as well where neither end is debris. To debris it gives the moment r × f that would
   * spin it, and that is lost.
   *
   * μ is that at the temperature of the hotter of the two. Half of the heat of friction is each
   * end's: they are of one material. Conduction exchanges
   *
   *   q = e (1 - exp(-x))/x (T_J - T_I),  e = h A Δt,  x = Σ_I e/C_I + Σ_J e/C_J,
   *
   * with sums over all contacts of each end, and A = V^((dim-1)/dim) of the smaller one: the exact
   * exchange of one pair, and never past the temperatures of all that touch, whatever h. What one
   * end gets the other loses, to round-off.
   */
  template <int dim>
  class FragmentFriction
  {
  public:
    /** Null where fragments neither rub nor conduct. Throws InputError. */
    static std::unique_ptr<FragmentFriction> create(const Entries &e);

    /** Throws the InputError of @p section of what has no meaning without heat. */
    static void refuse_without_heat(const Section &section);

    /** The pairs from now on, of the particle own_ids[i] in row i, of which @p of_rows says how
     * much of it in the whole body there is; local nodes are those of @p partition. What is known
     * of pairs that were there before is kept. Collective. */
    void set_pairs(const std::shared_ptr<const NodePartition> &partition, const Stencils &shape,
                   const std::vector<std::uint64_t> &own_ids, const std::vector<double> &of_rows,
                   const FragmentPairs &pairs);

    /** Begins a step. @p former_position has the components of the positions of this rank's
     * particles at its begin; @p position, with ghosts, those at its end. Rows with @p touches are
     * in contact. Collective. */
    void begin_step(const NodalVector &position,
                    const std::array<const double *, dim> &former_position,
                    const std::vector<bool> &touches, const Stencils &shape,
                    const FragmentHeat &heat);

    /** The force of friction on this end in the whole body. Adds its half of the heat. */
    dealii::Tensor<1, dim> rub(const FragmentTouch<dim> &touch, double time_step,
                               const FragmentHeat &heat);

    /** Ends the step: adds the moments of the forces to @p loads, at ghosts as well, and conducts.
     * Collective. */
    void end_step(const Stencils &shape, const FragmentHeat &heat, NodalVector &loads);

    /** In the springs, of this rank [M L^2/T^2]. */
    double stored() const
    {
      return stored_energy;
    }
    /** Heat of friction since the start, of this rank. */
    double dissipated() const
    {
      return friction_heat;
    }

    /** Writes to a checkpoint or reads it: rows of the particles @p own_ids. Collective. */
    void serialize(StateArchive &archive, const std::vector<std::uint64_t> &own_ids);

  private:
    FragmentFriction(TemperatureTable friction, TemperatureTable conductance)
        : friction(std::move(friction)), conductance(std::move(conductance))
    {}

    /** The spring of a pair that is in contact. */
    struct Spring
    {
      double stiffness = 0; ///< zero: open [M/T^2]
      dealii::Tensor<1, dim> slip;
    };
    struct KnownSpring
    {
      std::uint64_t own, partner; ///< persistent identifiers
      unsigned int mirrors;       ///< of the partner
      Spring spring;
    };
    struct Exchange
    {
      unsigned int own, other; ///< local nodes
      double exposure;         ///< e = h A Δt [M L^2/(T^2 K)]
    };

    /** Moves the springs that are closed to the known ones, which are sorted. */
    void remember_springs();
    /** Ends a contact of a row: what the spring stores becomes heat. Half of it is this end's. */
    void release(const unsigned int row, Spring &spring)
    {
      const double taken = shares[row] * 0.25 * spring.stiffness * spring.slip.norm_square();
      friction_heat += taken;
      released_heat[row] += taken;
      spring = {};
    }
    /** Images have the axial vectors of their nodes: gives them those of images. */
    void reflect_spins(const NodePartition &partition);
    void spread_couples(const Stencils &shape, NodalVector &loads);
    void conduct(const FragmentHeat &heat);

    TemperatureTable friction, conductance;
    std::vector<std::uint64_t> ids; ///< of the rows
    std::vector<double> shares;     ///< of the rows, of their particle in the whole body
    std::vector<std::size_t> row_of_pairs;
    std::vector<std::uint64_t> partner_ids;
    std::vector<unsigned int> partner_mirrors;
    std::vector<Spring> springs;    ///< of each pair
    std::vector<bool> is_touching;  ///< pairs, in this step
    std::vector<KnownSpring> known; ///< that no pair has taken yet
    // Of the step, by row: inverse of the deformation since the kernel's reference, zero where
    // there is none; sum of f ⊗ r - r ⊗ f; heat of contacts that ended.
    std::vector<dealii::Tensor<2, dim>> inverse_deformation, couple;
    std::vector<double> released_heat;
    NodalVector displacement; ///< Δu of the step
    NodalVector ends;         ///< axial vector of W, temperature
    NodalVector exposures;    ///< Σ e/C
    std::vector<Exchange> exchanges;
    double stored_energy = 0, friction_heat = 0;
  };
} // namespace tombolo
