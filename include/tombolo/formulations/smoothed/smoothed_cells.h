// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/smoothed/refilled_cells.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_integration.h>
#include <tombolo/formulations/smoothed/smoothed_point_state.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/state/records.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tombolo
{
  /**
   * An element-free Galerkin part: cells whose functions are those of a convex approximation, with
   * smoothed gradients (SmoothedGradients). Its nodes are nodes of elements for other parts:
   * masses are lumped as those of linear elements, velocities are not smoothed, loads and contact
   * act at the nodes, and elements beside it share nodes without a bridge. A plane of symmetry is a
   * boundary: the functions do not include the image of the part. Cells may lie beside cells of
   * half their size (FaceNodes).
   */
  template <int dim>
  class SmoothedCells : public SmoothedIntegration<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      declare<SmoothedGradients<dim>>(handler);
      declare<PartPoints>(handler, StrainMeasure::logarithmic);
      declare<RefillSettings<dim>>(handler);
      declare<ConversionCriterion>(handler);
    }

    explicit SmoothedCells(const Section &section) : Base(section), refill_settings(section) {}

    unsigned int degree() const override
    {
      return 1;
    }
    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::free;
    }
    StepCost step_cost(const Material &material, const double /*box_ratio*/) const override
    {
      constexpr double cost_per_point = 60.; // of an element's, by the time of a step
      return StepCosts::element_cost(dim, 1, rows.n_points_per_cell(), cost_per_point, material);
    }
    void initialize(const PartSetup<dim> &part_setup) override
    {
      setup = with_void_cells(part_setup, refill_settings, criterion, voids);
      part_points.initialize(setup.material, setup.heat, setup.has_mechanics);
      cell_points.set_cells(setup, 1, MassLumping::row_sum, refill().is_on() || criterion.is_on());
      further_masses.initialize(setup);
      if (refill().is_on())
        rows.prepare_positions();
      rows.initialize(setup);
      CellBatches<dim> &cells = cell_points.cells();
      if (setup.has_mechanics)
        cell_points.create_points(rows.corner_shares(), void_cells().is_on()
                                                            ? cells.n_batches_of_slots()
                                                            : cells.n_batches());
      if (void_cells().is_on())
      {
        cell_points.remove(void_cells().is_void_by_cell(), this->points());
        remove_masses_of_void_cells();
      }
      this->create_points();
      criterion.initialize(this->points(), setup.has_mechanics);
      cell_points.cells().release_initial_positions();
    }
    dealii::IndexSet required_nodes() const override
    {
      dealii::IndexSet nodes = rows.required_nodes();
      nodes.add_indices(Base::required_nodes());
      nodes.add_indices(further_masses.required_nodes());
      return nodes;
    }
    void set_partition(const NodePartition &partition) override
    {
      Base::set_partition(partition);
      further_masses.set_partition(partition);
      rows.set_partition(partition);
    }
    void add_mass(NodalVector &mass) const override
    {
      Base::add_mass(mass);
      further_masses.add_mass(mass);
    }
    void courant_limits(const NodalVector &position, std::vector<double> &time_steps) const override
    {
      const double *const volumes = this->points().component(MaterialPoints::volume, 0);
      const unsigned int n_points = this->n_points_per_cell();
      const auto length_of = [&](const unsigned int batch)
      {
        Lanes x[n_corners][dim], total = 0.;
        for (unsigned int k = 0; k < n_corners; ++k)
          gather_nodes<dim>(position.data(), cell_points.cells().nodes(batch) + k * n_lanes, x[k]);
        for (unsigned int q = 0; q < n_points; ++q)
          total += load_lanes(volumes + (std::size_t(batch) * n_points + q) * n_lanes);
        return characteristic_length<dim, 1>(x, total);
      };
      this->find_courant_limits(length_of, time_steps);
    }
    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override
    {
      Base::add_extra_mass(inertia, mass);
      further_masses.add_extra_mass(inertia, mass);
    }
    void add_conduction(const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      rows.add_conduction(cell_points.cells(), part_points.heat()->conductivity(), position,
                          conductivity_temperature, temperature, heat_rate);
    }
    void add_plastic_heat(NodalVector &to_nodes) override
    {
      std::vector<double> cell_heat;
      cell_points.add_plastic_heat(part_points, to_nodes, &cell_heat);
      further_masses.add_shares(cell_heat, to_nodes);
    }
    bool is_removed(const unsigned int cell) const override
    {
      return void_cells().is_on() && void_cells().is_void_by_cell()[cell];
    }
    bool can_lose_cells() const override
    {
      return void_cells().is_on();
    }
    void list(Records &records) override
    {
      records.archived(
          [this](StateArchive &archive)
          {
            if (criterion.is_on())
              lost_cells.serialize(this->n_cells(), part_points.heat() != nullptr, archive);
            if (!refill().is_on())
              return;
            std::vector<double> masses = masses_of_cells();
            archive.rows("mass of corners", n_corners, masses);
            if (archive.is_reading())
              cell_points.cells().set_masses(masses);
          });
    }

    void find_couplings(const NodeGroupAction &use) const override
    {
      rows.find_couplings(this->n_cells(), use);
    }
    void deactivate_cells(const std::vector<unsigned int> &converted) override
    {
      set_converted_cells(converted);
    }
    void set_converted_cells(const std::vector<unsigned int> &converted) override
    {
      lost_cells.convert(converted, this->n_cells());
      set_void_cells(lost_cells.flags());
      remove_masses_of_void_cells();
      // Functions of the cells that are left end where those are that have become particles.
      rows.initialize(setup, reference.partition() != nullptr ? &reference : nullptr);
    }
    bool masses_move() const override
    {
      return refill().is_on();
    }

    /** @name Refills
     * The reference configuration of the functions becomes a later one, with nodes at other
     * positions. The caller sets points and masses. */
    ///@{
    const RefillSettings<dim> &refill() const
    {
      return refill_settings;
    }

    /** The cells of this rank that have reached a limit of refill(). */
    std::vector<unsigned int> distorted_cells(const NodalVector &position) const
    {
      constexpr double smallest_ratio = 0.2; // of the volume to that at the last refill
      const double limit = refill().stretch * refill().stretch;
      const auto is_distorted = [&](const unsigned int point)
      {
        const dealii::Tensor<2, dim> f = row_deformation<dim>(rows.stencils(), point, position);
        if (determinant(f) <= smallest_ratio)
          return true;
        const dealii::SymmetricTensor<2, dim> squared = symmetrize(transpose(f) * f);
        // Gershgorin's bounds of the eigenvalues mostly suffice.
        double lower = std::numeric_limits<double>::max(), upper = 0;
        for (unsigned int a = 0; a < dim; ++a)
        {
          double radius = 0;
          for (unsigned int b = 0; b < dim; ++b)
            radius += b == a ? 0. : std::abs(squared[a][b]);
          lower = std::min(lower, squared[a][a] - radius);
          upper = std::max(upper, squared[a][a] + radius);
        }
        if (upper <= limit * lower)
          return false;
        const auto squares = eigenvalues(squared); // falling
        return squares[0] > limit * squares[dim - 1];
      };
      std::vector<unsigned int> result;
      for (unsigned int cell = 0; cell < this->n_cells(); ++cell)
      {
        bool is_found = false;
        for (unsigned int q = 0; q < this->n_points_per_cell() && !is_removed(cell); ++q)
          is_found = is_found || is_distorted(this->point_of_cell(cell, q));
        if (is_found)
          result.push_back(cell);
      }
      return result;
    }

    const VoidCells<dim> &void_cells() const
    {
      return voids;
    }

    /** Fills and empties cells (void_cells() are on); renew_reference() must follow. Collective. */
    void set_void_cells(const std::vector<bool> &is_void)
    {
      voids.set(is_void);
      cell_points.remove(is_void, this->points());
    }

    /** The lumped masses of the nodes, by cell and corner; only with refills [M]. */
    const std::vector<double> &masses_of_cells() const
    {
      return cell_points.cells().masses();
    }
    /** Adds masses of further nodes, less at the corners of cells (see FurtherMasses). */
    void add_further_masses(NodalVector &mass) const
    {
      further_masses.add_mass(mass);
    }
    void set_masses(const std::vector<double> &cell_masses)
    {
      cell_points.cells().set_masses(cell_masses);
    }

    /** Uses these positions as the reference configuration; required_nodes() stay. Rows must not be
     * used before set_partition(). Throws the InputError of SmoothedGradients::initialize(), and
     * stays as it is. Collective. */
    void renew_reference(const NodalVector &position)
    {
      rows.initialize(setup, &position);
      if (criterion.is_on())
        reference = position.copy();
    }

    SmoothedPointState<dim> point_state()
    {
      return {part_points, rows, cell_points};
    }
    ///@}

  private:
    void remove_masses_of_void_cells()
    {
      std::vector<double> masses = masses_of_cells();
      for (unsigned int cell = 0; cell < this->n_cells(); ++cell)
        if (is_removed(cell))
          std::fill_n(masses.begin() + std::ptrdiff_t(cell) * n_corners, n_corners, 0.);
      set_masses(masses);
    }

    static constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
    using Base = SmoothedIntegration<dim>;
    using Base::cell_points, Base::criterion, Base::lost_cells, Base::part_points, Base::rows;

    FurtherMasses<dim> further_masses;
    const RefillSettings<dim> refill_settings;
    PartSetup<dim> setup; // with void cells
    VoidCells<dim> voids;
    NodalVector reference; // of the rows; empty: the initial positions, or nothing needs it
  };
} // namespace tombolo
