// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/row_stiffness.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace tombolo
{
  /**
   * A part of smoothed cells, with the nodal forces of its stresses by the rows of
   * SmoothedGradients, which stay those of the initial configuration: with F_q = Σ x_J ⊗ G_qJ the
   * present gradients are F_q⁻ᵀ G_qJ, and the volume of a point is det F_q V_q. The points of a
   * cell share their dilatation (MeanDilatation).
   */
  template <int dim>
  class SmoothedIntegration : public LosingCells<dim, PointsInCells<dim>>
  {
  public:
    explicit SmoothedIntegration(const Section &section) : Base(section), rows(section)
    {
      part_points = PartPoints(section);
    }

    /** Makes the points with the volumes of the rows; with void cells for all cells. */
    void create_points()
    {
      if (!part_points.has_mechanics())
        return;
      part_points.create(cell_points.n_points_of_slots());
      const CellBatches<dim> &cells = cell_points.cells();
      for (unsigned int slot = 0; slot < cells.n_present_cells(); ++slot)
        for (unsigned int q = 0; q < cell_points.n_points_per_cell(); ++q)
        {
          const unsigned int point = cell_points.point_of_slot(slot, q);
          part_points.points().component(MaterialPoints::volume, 0)[point] = rows.volumes()[point];
        }
      part_points.begin_with_volumes(dim);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override
    {
      failure_message.clear();
      with_points(
          [&](const auto number)
          {
            constexpr unsigned int n_points = decltype(number)::value;
            constexpr unsigned int batch_size = n_points * n_lanes;
            BatchMotion<n_points> motion;
            PointSweep<batch_size> sweep(part_points, input.time_increment);
            MotionIncrement<Lanes> increments[n_points];
            for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
            {
              const std::size_t first = std::size_t(batch) * batch_size;
              find_motion(batch, *input.position, *input.velocity, motion);
              note_failure(batch, input, motion);
              sweep.begin(first, batch_size);
              // The middle of the step is that of the motion itself, as in
              // FullyIntegratedHexahedron.
              for (unsigned int q = 0; q < n_points; ++q)
                for (unsigned int i = 0; i < dim; ++i)
                  motion.gradient[q](i, i) -= motion.shared[q];
              sweep.move_cells(0, cell_points.cells().n_valid(batch), motion.gradient,
                               motion.volume, part_points.is_logarithmic(), increments,
                               [&](MotionIncrement<Lanes>(&point_motions)[n_points]) {
                                 MeanDilatation::share<dim>(part_points.is_logarithmic(),
                                                            motion.volume, point_motions);
                               });
              if (part_points.heating().is_on())
                cell_points.interpolate(batch, *input.temperature, sweep.nodal_temperature);
              sweep.update_stress();
              sweep.update_viscosity();
              Lanes stress[n_points][6];
              for (unsigned int q = 0; q < n_points; ++q)
                part_points.integrate_stress(first + q * n_lanes, stress[q]);
              scatter(batch, stress, motion, force);
            }
          });
    }
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force) const override
    {
      with_points(
          [&](const auto number)
          {
            constexpr unsigned int n_points = decltype(number)::value;
            const PointStiffness stiffness(part_points, time_step);
            BatchMotion<n_points> motion;
            for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
            {
              find_motion(batch, position, velocity, motion);
              Lanes stress[n_points][6];
              for (unsigned int q = 0; q < n_points; ++q) // scatter() subtracts
                stiffness.find_stress((std::size_t(batch) * n_points + q) * n_lanes,
                                      motion.gradient[q], -motion.volume[q], stress[q]);
              scatter(batch, stress, motion, force);
            }
          });
    }
    void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) override
    {
      with_points(
          [&](const auto number)
          {
            constexpr unsigned int n_points = decltype(number)::value;
            BatchMotion<n_points> motion;
            for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
            {
              find_motion(batch, position, position, motion); // of which the volumes matter
              MeanDilatation::set_volumes(part_points.points(),
                                          std::size_t(batch) * n_points * n_lanes, motion.volume,
                                          part_points.is_logarithmic(), are_new);
            }
          });
    }
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override
    {
      with_points(
          [&](const auto number)
          {
            constexpr unsigned int n_points = decltype(number)::value;
            using Stiffness = RowStiffness<dim, n_points>;
            constexpr unsigned int batch_size = n_points * n_lanes;
            const auto stiffness =
                std::make_unique<Stiffness>(part_points, true, input.time_increment);
            const Stencils &stencils = rows.stencils();
            alignas(64) double temperature[batch_size];
            typename Stiffness::Gradients gradients;
            for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
            {
              const std::size_t first = std::size_t(batch) * batch_size;
              for (unsigned int q = 0; q < n_points; ++q)
              {
                RowBlock::gather_gradients<dim>(
                    stencils, first + q * n_lanes, n_lanes, input.position->data(),
                    input.velocity->data(), gradients.deformation[q], gradients.displacement[q]);
                for (Lanes &entry : gradients.displacement[q].entry)
                  entry *= input.time_increment;
                gradients.volume[q] = load_lanes(rows.volumes().data() + first + q * n_lanes);
              }
              if (part_points.heating().is_on())
                cell_points.interpolate(batch, *input.temperature, temperature);
              stiffness->find(first, gradients, temperature);
              for (unsigned int lane = 0; lane < cell_points.cells().n_valid(batch); ++lane)
              {
                std::array<Stencils::Row, n_points> cell_rows{};
                for (unsigned int q = 0; q < n_points; ++q)
                  cell_rows[q] =
                      stencils.row(static_cast<unsigned int>(first) + q * n_lanes + lane);
                stiffness->hand_over(lane, cell_rows, take);
              }
            }
          });
    }
    std::optional<std::string> unfit_to_linearize() const override
    {
      return part_points.unfit_to_linearize();
    }

  protected:
    using Base = LosingCells<dim, PointsInCells<dim>>;
    using Base::cell_points, Base::failure_message, Base::part_points;

    SmoothedGradients<dim> rows;

  private:
    template <unsigned int n_points>
    struct BatchMotion
    {
      Matrix3<Lanes> inverse_transpose[n_points]; // F⁻ᵀ
      Matrix3<Lanes> gradient[n_points];          // L, the dilatation shared
      Lanes shared[n_points];                     // what that added to the diagonal
      Lanes volume[n_points];                     // det F V_q, of unused lanes too
      alignas(64) double columns[n_points * n_lanes][3][node_stride];
    };

    /** F⁻ᵀ, L and the volumes of the points of a batch, the dilatation shared. */
    template <unsigned int n_points>
    void find_motion(const unsigned int batch, const NodalVector &position,
                     const NodalVector &velocity, BatchMotion<n_points> &motion) const
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Matrix3<Lanes> deformation, gradient;
        RowBlock::gather_gradients<dim>(rows.stencils(),
                                        (std::size_t(batch) * n_points + q) * n_lanes, n_lanes,
                                        position.data(), velocity.data(), deformation, gradient);
        Lanes det;
        const Matrix3<Lanes> inverse_deformation = inverse(deformation, det);
        motion.inverse_transpose[q] = RowBlock::transposed(inverse_deformation);
        motion.gradient[q] = multiply(gradient, inverse_deformation);
        motion.volume[q] =
            det * load_lanes(rows.volumes().data() + (std::size_t(batch) * n_points + q) * n_lanes);
      }
      MeanDilatation::share_gradient<dim>(motion.volume, motion.gradient, motion.shared);
    }
    /** Subtracts the nodal forces of stresses that come multiplied by the volumes. */
    template <unsigned int n_points>
    void scatter(const unsigned int batch, const Lanes (&stress)[n_points][6],
                 BatchMotion<n_points> &motion, NodalVector &force) const
    {
      const Lanes mean = MeanDilatation::mean_pressure<dim>(motion.volume, stress);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Lanes difference =
            motion.volume[q] * mean - (1. / dim) * MeanDilatation::trace_in_plane<dim>(stress[q]);
        Matrix3<Lanes> cauchy = symmetric_matrix(stress[q]);
        for (unsigned int i = 0; i < dim; ++i)
          cauchy(i, i) += difference;
        RowBlock::store_columns(multiply(cauchy, motion.inverse_transpose[q]),
                                motion.columns[q * n_lanes][0]);
      }
      const Stencils &stencils = rows.stencils();
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cell_points.cells().n_valid(batch); ++lane)
          RowBlock::subtract_row(stencils.row((batch * n_points + q) * n_lanes + lane),
                                 motion.columns[q * n_lanes + lane][0], force.data());
    }
    template <unsigned int n_points>
    void note_failure(const unsigned int batch, const MechanicalInput &input,
                      const BatchMotion<n_points> &motion)
    {
      for (unsigned int lane = 0; lane < cell_points.cells().n_valid(batch); ++lane)
        for (unsigned int q = 0; q < n_points; ++q)
          if (!(motion.volume[q][lane] > 0.) && failure_message.empty())
          {
            constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
            dealii::Point<dim> centre;
            for (unsigned int k = 0; k < n_corners; ++k)
              for (unsigned int d = 0; d < dim; ++d)
                centre[d] +=
                    input.position->node(cell_points.cells().nodes(batch)[k * n_lanes + lane])[d] /
                    n_corners;
            failure_message = describe_unusable_cell<dim>(centre, centre, motion.volume[q][lane]);
          }
    }
    /** Calls @p use with the number of points of a cell as an integral constant. */
    template <typename Use>
    void with_points(const Use &use) const
    {
      if (rows.n_points_per_cell() == 1)
        use(std::integral_constant<unsigned int, 1>());
      else
        use(std::integral_constant<unsigned int, SubCells<dim>::n_sub_cells>());
    }
  };
} // namespace tombolo
