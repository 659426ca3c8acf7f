// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/state/field.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace tombolo
{
  /** What the stress of a point follows. */
  enum class StrainMeasure
  {
    rate,       ///< the rate of deformation, turned with the spin (eqs 5, 19)
    logarithmic ///< the elastic logarithmic strain: stress that is the derivative of an energy
  };

  /**
   * n consecutive material points, as arrays of a structure-of-arrays: stress[c][i] is component c
   * (xx, yy, zz, yz, xz, xy) of point i. n is a multiple of n_lanes; padding points have zero
   * strain increments. The arrays do not overlap. The stress is Kirchhoff's, whose work per initial
   * volume is the change of ½ τ : C⁻¹ : τ with either StrainMeasure.
   */
  struct MaterialBatch
  {
    unsigned int n;                          ///< number of points
    double time_increment;                   ///< t_n - t_{n-1} [T]
    double *stress[6];                       ///< in: rotated to t_n, out: at t_n
    const double *strain_increment[6];       ///< tensor components of Δt D, no factor 2 on shear
    const double *relative_volume = nullptr; ///< J at t_n; equations of state need it
    const double *temperature = nullptr;     ///< at t_n; null in scenes without heat
    /** Change of the temperature since the last update; null in scenes without heat. */
    const double *temperature_increment = nullptr;
    std::vector<double *> internal_variables; ///< one array per component, in declared order
  };

  /**
   * The derivative of the stress of update_stress() with respect to the strain increment of the
   * step, of the points of a batch: entry 6 i + j is the array of ∂σ_i/∂Δε_j by components xx, yy,
   * zz, yz, xz, xy, where the strain has tensor components and a shear component is that of both of
   * its entries. As the former stress and the strain increment make one trial stress, a
   * change δσ of the former acts as the strain C⁻¹ : δσ. [M/(L T^2)]
   */
  using MaterialTangent = std::array<double *, 36>;

  inline void set_elastic_tangent(const double bulk, const double shear, const unsigned int i,
                                  const MaterialTangent &tangent)
  {
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        tangent[6 * row + column][i] = (row == column ? 2. * shear : 0.) +
                                       (row < 3 && column < 3 ? bulk - 2. / 3. * shear : 0.);
  }

  /** A material: a function from strain increments to stress, in batches. It has no mesh. */
  class Material
  {
  public:
    virtual ~Material() = default;

    /** Density in the initial configuration [M/L^3]. */
    virtual double density() const = 0;

    /** Density that resists acceleration: density() times the factors of scale_inertia() [M/L^3].
     * Wave speeds and artificial viscosity follow from it; heat and body forces from density(). */
    double inertial_density() const
    {
      return inertia_over_mass * density();
    }

    /** inertial_density() over density(). */
    double relative_inertia() const
    {
      return inertia_over_mass;
    }

    /** Multiplies the inertia, as mass scaling or a faster process; before a part is made of it. */
    void scale_inertia(const double factor)
    {
      inertia_over_mass *= factor;
    }

    /**
     * What a point must store besides the stress. Names with a meaning for others:
     * - "plastic work": energy that plastic flow has dissipated per unit of initial volume
     *   [M/(L T^2)]; enters "plastic dissipation", and heats in scenes with heat;
     * - "thermal work": energy that changes of the temperature have given to the elastic energy,
     * per unit of initial volume [M/(L T^2)]; enters "thermal work";
     * - "effective plastic strain", "temperature": their largest values are in the statistics. In
     *   scenes with heat the formulation keeps the temperature, and a material must not;
     * - "damage": for criteria of failure and conversion; its largest value is in the statistics;
     * - "pressure work": energy per unit of initial volume [M/(L T^2)] that is stored beside
     *   elastic_energy_density(): by the change of volume where that is of the deviator only, or by
     *   plastic flow;
     * - "viscous work": what artificial viscosity has dissipated per unit of initial volume
     *   [M/(L T^2)]; the formulation adds to it;
     * - "bulk modulus": the present one, instead of bulk_modulus() in step estimates.
     */
    virtual std::vector<FieldDescription> internal_variables() const
    {
      return {};
    }
    /** Whether one of them has this name. */
    bool remembers(const std::string &variable) const;

    /** Whether it has stresses at all. One that has not is for scenes of heat alone. */
    virtual bool has_mechanics() const
    {
      return true;
    }

    /** The share of the plastic work that heats (Taylor-Quinney), in scenes with heat. */
    virtual double plastic_heat_fraction() const
    {
      return 0.;
    }

    /** Hypoelastic update (eq. 5): the stress comes in already rotated by the objective rate. */
    virtual void update_stress(MaterialBatch &batch) const = 0;

    /** The same, and its consistent tangent; by default by difference quotients: seven updates. */
    virtual void update_stress_and_tangent(MaterialBatch &batch,
                                           const MaterialTangent &tangent) const;

    /** The temperature from which on there is no flow stress; infinity: there is no such one. */
    virtual double melts_at() const
    {
      return std::numeric_limits<double>::infinity();
    }

    /** The flow stress of a slow test at an effective plastic strain and a temperature, without
     * damage; infinite where nothing flows [M/(L T^2)]. */
    virtual double slow_yield_stress(double /*plastic_strain*/, double /*temperature*/) const
    {
      return std::numeric_limits<double>::infinity();
    }

    bool can_yield() const
    {
      return slow_yield_stress(0., 0.) < std::numeric_limits<double>::infinity();
    }

    /** The cost of update_stress() for a point in the mean of a run, in relative cost units (a node
     * has 20, see doc/performance.md): the balance of the ranks follows it. */
    virtual double cost_per_point() const
    {
      return 5.;
    }

    /** Elastic moduli that bound the stiffness, for step estimates and hourglass control. */
    virtual double bulk_modulus() const = 0;
    virtual double shear_modulus() const = 0;

    /** The elastic moduli of @p n points at @p temperature, which is null in scenes without heat:
     * with them logarithmic strains are found from stresses. By default those above. */
    virtual void elastic_moduli(unsigned int n, const double *temperature, double *bulk,
                                double *shear) const;

    /** √((K + 4G/3)/ρ) with the inertial density, the speed of P waves [L/T]. */
    double longitudinal_wave_speed() const;
    /** √(G/ρ) with the inertial density [L/T]. */
    double shear_wave_speed() const;

    /** Elastic energy per unit of current volume, ½ σ : C⁻¹ : σ, of @p n points. @p stress as in
     * MaterialBatch; @p temperature is null in scenes without heat. */
    virtual void elastic_energy_density(unsigned int n, const double *const stress[6],
                                        const double *temperature, double *energy_density) const;

  private:
    double inertia_over_mass = 1.;
  };

  template <>
  struct PluginKind<Material>
  {
    static constexpr const char *name = "material";
  };
} // namespace tombolo
