// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>
#include <tombolo/materials/strain_measure.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The material points of a part of smoothed cells, and what their stresses do through the rows
   * of SmoothedGradients, which stay those of the initial configuration: with F_q = Σ x_J ⊗ G_qJ
   * the present gradients are F_q⁻ᵀ G_qJ, and the volume of a point is det F_q V_q. The points of a
   * cell share their dilatation (MeanDilatation).
   */
  template <int dim>
  class SmoothedIntegration
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    explicit SmoothedIntegration(const Section &section);

    /** Takes material and heat of the part and makes the points; none in a scene of heat alone.
     * @p rows and @p cells must outlive this. With void cells there are points for all cells. */
    void initialize(const PartSetup<dim> &setup, const SmoothedGradients<dim> &rows,
                    const CellBatches<dim> &cells);

    /** @name As in Formulation */
    ///@{
    void add_internal_force(const MechanicalInput &input, NodalVector &force);
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const;
    /** To the corners of the cells by mass; @p of_cells becomes what each has given. */
    void add_plastic_heat(NodalVector &heat, std::vector<double> &of_cells);
    double pending_plastic_heat() const
    {
      return plastic_heating.pending(material_points);
    }
    /** See Formulation::find_volumes(). */
    void take_volumes(const NodalVector &position, const std::vector<bool> &are_new);
    EnergyAccounts energies() const;
    const std::string &failure() const
    {
      return failure_message;
    }
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take);
    std::string unfit_to_linearize() const
    {
      return bulk_viscosity.is_on() ? "artificial bulk viscosity, which resists rates" : "";
    }
    ///@}

    /** The squares of the speeds of longitudinal waves in the cells of a batch, over that of the
     * material in the initial state: the largest of their points. */
    Lanes squared_speed(unsigned int batch) const;

    const Material &material() const
    {
      return *part_material;
    }
    const MaterialPoints &points() const
    {
      return material_points;
    }
    MaterialPoints &points()
    {
      return material_points;
    }
    const PlasticHeating &heating() const
    {
      return plastic_heating;
    }

  private:
    template <unsigned int n_points>
    struct BatchMotion;

    template <unsigned int n_points>
    void add_force_of_points(const MechanicalInput &input, NodalVector &force);
    template <unsigned int n_points>
    void apply_stiffness_of_points(const NodalVector &position, const NodalVector &velocity,
                                   double time_step, NodalVector &force) const;
    template <unsigned int n_points>
    void advance_motion(unsigned int batch, const MechanicalInput &input,
                        BatchMotion<n_points> &motion);
    /** F⁻ᵀ, L and the volumes of the points of a batch, the dilatation shared. */
    template <unsigned int n_points>
    void find_motion(unsigned int batch, const NodalVector &position, const NodalVector &velocity,
                     BatchMotion<n_points> &motion) const;
    /** Subtracts the nodal forces of stresses that come multiplied by the volumes. */
    template <unsigned int n_points>
    void scatter(unsigned int batch, const Lanes (&stress)[n_points][6],
                 BatchMotion<n_points> &motion, NodalVector &force) const;
    template <unsigned int n_points>
    void note_failure(unsigned int batch, const MechanicalInput &input,
                      const BatchMotion<n_points> &motion);
    /** Calls @p use with the number of points of a cell as an integral constant. */
    template <typename Use>
    void with_points(const Use &use) const;

    BulkViscosity bulk_viscosity;
    StrainMeasure measure;
    PlasticHeating plastic_heating;
    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    const SmoothedGradients<dim> *rows = nullptr;
    const CellBatches<dim> *cells = nullptr;
    MaterialPoints material_points;
    std::vector<double *> material_variables; // first address of each component
    std::string failure_message;
  };
} // namespace tombolo
