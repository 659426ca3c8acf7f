// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace tombolo
{
  /**
   * What the stresses of a part of smoothed cells do through the rows of SmoothedGradients, which
   * stay those of the initial configuration: with F_q = Σ x_J ⊗ G_qJ the present gradients are
   * F_q⁻ᵀ G_qJ, and the volume of a point is det F_q V_q. The points of a cell share their
   * dilatation (MeanDilatation).
   */
  template <int dim>
  class SmoothedIntegration
  {
  public:
    /** The arguments must outlive this object. */
    SmoothedIntegration(const Section &section, PartPoints &part, const PointsInCells<dim> &points)
        : rows(section), part(part), points(points)
    {}

    SmoothedGradients<dim> rows;

    /** Makes the points of @p part with the volumes of the rows. With void cells there are points
     * for all cells. */
    void create_points();

    /** @name As in Formulation */
    ///@{
    void add_internal_force(const MechanicalInput &input, NodalVector &force);
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const;
    /** See Formulation::find_volumes(). */
    void take_volumes(const NodalVector &position, const std::vector<bool> &are_new);
    const std::string &failure() const
    {
      return failure_message;
    }
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take);
    std::string unfit_to_linearize() const
    {
      return part.unfit_to_linearize();
    }
    ///@}

  private:
    template <unsigned int n_points>
    struct BatchMotion;

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
    void with_points(const Use &use) const
    {
      if (rows.n_points_per_cell() == 1)
        use(std::integral_constant<unsigned int, 1>());
      else
        use(std::integral_constant<unsigned int, SubCells<dim>::n_sub_cells>());
    }

    PartPoints &part;
    const PointsInCells<dim> &points;
    std::string failure_message;
  };
} // namespace tombolo
