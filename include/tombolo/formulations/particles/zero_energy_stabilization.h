// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <deal.II/base/aligned_vector.h>

#include <vector>

namespace tombolo
{
  class StateArchive;

  /**
   * A stiffness against what nodal gradients do not see, above all the mode that alternates from
   * node to node (doc/method.md, section 9): for particles what hourglass stiffness is for
   * elements with one point. Each pair of a row I and its neighbour J has an elongation
   *
   *   ė_IJ = W_I e_IJ + v_J - v_I - L_I (x_J - x_I),  L = G v F⁻¹,  W its spin,
   *
   * at the present positions x, which turns with the material and which no linear velocity changes.
   * It stores ½ Σ k_IJ |e_IJ|², and the nodal forces are those of the power -Σ k_IJ e_IJ · (ė_IJ -
   * W_I e_IJ): their sum and that of their moments about x are zero to round-off, rigid motions
   * feel nothing, and central differences conserve the energy to second order. With ΔX = X_J - X_I
   * and the volume V_I of the kernel's reference
   *
   *   k_IJ = κ (K + 4/3 G) V_I max(φ_J(x_I), 0) s_IJ,  s_IJ = Σ_d (ΔX_d² / µ_d) / |ΔX|²,
   *
   * where µ_d = m₂ h_d² is the second moment that the row of an interior particle has on a lattice
   * of spacing h_d = support / dilation. On a cubic lattice s = 1/µ₂. Where spacings differ, a pair
   * along an axis has the weight of this axis, and one across several a mean that the wide ones
   * dominate, so that the stiffness along each axis stays of the size of the physical one.
   *
   * Where the material flows, e shrinks as far as the row would otherwise store more than a given
   * share of the elastic energy of shear at the flow stress, σ²/(6 G) per volume; what is lost is
   * booked as dissipated. A new reference begins with e = 0, and books what was stored. Rows
   * without gradient (rigid ones) have none. Off, it holds and does nothing.
   */
  class ZeroEnergyStabilization
  {
  public:
    /** None. */
    ZeroEnergyStabilization() = default;
    /** Entries of the section of a formulation. Throws InputError for bad values. */
    ZeroEnergyStabilization(const Section &section, const Kernel &kernel, double dilation);
    static void declare_parameters(dealii::ParameterHandler &handler);

    bool is_on() const
    {
      return kappa > 0.;
    }

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const;

    /** Finds the fields in @p points. Does nothing if off. */
    void initialize(const Material &material, const MaterialPoints &points);

    /** Stiffnesses of the pairs, without elongation, for @p shape with numbers that fit @p position
     * and @p support (node_stride doubles a node); @p volume is that of each row in the reference.
     * If on. */
    void set_reference(unsigned int dim, const Stencils &shape, const std::vector<double> &volume,
                       const double *position, const double *support);

    /** Books what is stored as lost, before a new reference. If on. */
    void restart(MaterialPoints &points) const;

    /** Advances the elongations by the motion of the last step, after the stress of @p points, and
     * adds the nodal forces. Nodal arrays as in ParticleForce. If on. */
    void add_force(const Stencils &shape, const double *position, const double *velocity,
                   double time_increment, MaterialPoints &points, double *force);

    /** Adds the force that @p velocity causes per unit time, with the sign of +K. If on. */
    void apply_elastic_stiffness(const Stencils &shape, const double *position,
                                 const double *velocity, double *force) const;

    double stored_energy(const MaterialPoints &points) const; ///< of this rank's rows
    double dissipation(const MaterialPoints &points) const;   ///< likewise

    /** Writes or reads the elongations, as rows of @p archive. The neighbours of @p shape have
     * their place in @p positions, node_stride doubles each, at @p place: rows are read in any
     * order of the neighbours, who are recognized by their positions. Takes effect in
     * complete_reading(). If on. Collective. */
    void serialize(const Stencils &shape, const std::vector<double> &positions,
                   const std::vector<unsigned int> &place, StateArchive &archive);
    /** Puts what was read into the pairs of the present reference. If on. */
    void complete_reading();

    std::size_t memory_consumption() const;

  private:
    double kappa = 0;
    double limit = 0; ///< share of the elastic energy at the flow stress; 0: no limit
    double dilation = 1;
    double second_moment = 1; ///< m₂
    double modulus = 0, shear_modulus = 0;
    unsigned int energy_field = 0, dissipation_field = 0, seen_strain_field = 0;
    unsigned int plastic_strain_field = 0;
    bool is_limited = false;

    /** e_IJ and, in the pad, k_IJ; node_stride for each entry of the shape functions [L, M/T^2]. */
    dealii::AlignedVector<double> pairs;
    std::vector<double> read_elongations; ///< 3 for each entry
  };
} // namespace tombolo
