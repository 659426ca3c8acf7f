#pragma once

#include <tombolo/base/parameters.h>
#include <tombolo/materials/material.h>
#include <tombolo/particles/kernel.h>
#include <tombolo/particles/shape_functions.h>
#include <tombolo/state/material_points.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/aligned_vector.h>

#include <memory>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /**
   * A stiffness against what nodal gradients do not see, above all the mode that alternates from
   * node to node (section 3 of the method page). With the displacement u of nodes since the
   * kernel's reference, the integral of the velocities that stresses come from, it stores
   *
   *   E = ½ Σ_I g_I Σ_J k_IJ |r_IJ|²,  r_IJ = u_J - u_I - (G u)_I ΔX,  ΔX = X_J - X_I,
   *   k_IJ = κ (K + 4/3 G) V_I max(φ_J(x_I), 0) s_IJ,  s_IJ = Σ_d (ΔX_d² / µ_d) / |ΔX|²,
   *
   * with the reference volume V_I and the second moment µ_d = m₂ h_d² that the row of an interior
   * particle has on a lattice of spacing h_d = support / dilation. On a cubic lattice s = 1/µ₂.
   * Where spacings differ, a pair along an axis has the weight of this axis and one across several
   * a mean weight that is never above that of the wide ones by more than their number, so that the
   * stiffness of each axis stays of the size of the physical one. E does not change under affine
   * motions and rigid rotations of u; the force is -∂E/∂u, so that its sum is zero, that of its
   * moments about X + u too, and central differences conserve the energy. Rows without gradient
   * (rigid ones) have none.
   *
   * Where the material flows, g_I ≤ 1 falls as far as the row would otherwise store more than a
   * given share of the elastic energy of shear at the flow stress, σ²/(6 G) per volume; what is
   * lost is booked as dissipated. A new reference begins with u = 0 and g = 1, and books what was
   * stored. Off, it holds and does nothing.
   */
  class PairResidual
  {
  public:
    /** None. */
    PairResidual() = default;
    /** Entries of the section of a formulation. Throws InputError for bad values. */
    PairResidual(const Section &section, const Kernel &kernel, double dilation);
    static void declare_parameters(dealii::ParameterHandler &handler);

    bool is_on() const
    {
      return kappa > 0.;
    }

    /** What points must hold; none if off. */
    std::vector<FieldDescription> variables() const;

    /** Finds the fields in @p points. Does nothing if off. */
    void initialize(const Material &material, const MaterialPoints &points);

    /** Weights of the pairs, for @p shape with numbers that fit @p position and @p support
     * (n_slots doubles a node); @p volume is that of each row in the reference. If on. */
    void set_reference(unsigned int dim, const ShapeFunctions &shape,
                       const std::vector<double> &volume, const double *position,
                       const double *support);

    /** Forgets the displacement, for a new reference. If on. */
    void restart(MaterialPoints &points);

    /** Takes the ghosts of @p partition. Collective. If on. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Advances the displacement and adds the force, after the stress of @p points. If on. */
    void add_force(const ShapeFunctions &shape, const NodalVector &velocity, double time_increment,
                   MaterialPoints &points, NodalVector &force);

    /** Adds the force that @p velocity causes per unit time, with the sign of +K. If on. */
    void add_stiffness_action(const ShapeFunctions &shape, const MaterialPoints &points,
                              const NodalVector &velocity, NodalVector &force) const;

    double stored_energy(const MaterialPoints &points) const; ///< of this rank's rows
    double dissipation(const MaterialPoints &points) const;   ///< likewise

    /** The displacement of the particles of @p shape, to or from a checkpoint. If on. */
    void serialize(const ShapeFunctions &shape, StateArchive &archive);
    /** Puts what was read where it belongs. Collective. If on. */
    void complete_reading(const ShapeFunctions &shape);

    std::size_t memory_consumption() const;

  private:
    double kappa = 0;
    double limit = 0; ///< share of the elastic energy at the flow stress; 0: no limit
    double dilation = 1;
    double second_moment = 1; ///< m₂ of a lattice row of spacing one
    double modulus = 0, shear_modulus = 0;
    unsigned int energy_field = 0, dissipation_field = 0, loss_field = 0, seen_strain_field = 0;
    unsigned int plastic_strain_field = 0;
    bool is_limited = false;

    /** ΔX and, in the pad, k_IJ; n_slots doubles for each entry of the shape functions. */
    dealii::AlignedVector<double> pairs;
    mutable dealii::AlignedVector<double> pair_forces; ///< of one row
    NodalVector displacement;                          ///< u [L]
    std::vector<double> read_displacement;
  };
} // namespace tombolo
