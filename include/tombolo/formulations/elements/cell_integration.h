// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** Which points flow plastically in a step: those whose "effective plastic strain" grows. */
  class PlasticFlow
  {
  public:
    void set(const MaterialPoints &points)
    {
      field = points.find_field("effective plastic strain");
      can_flow = field < points.fields().size();
    }

    bool is_possible() const
    {
      return can_flow;
    }

    /** Keeps the strain of @p n points from @p first on, before the stress is advanced. */
    void keep(const MaterialPoints &points, const std::size_t first, const unsigned int n,
              double *before) const
    {
      std::copy_n(points.component(field, 0) + first, n, before);
    }

    /** The von Mises stress of n_lanes points from @p i on, zero where they do not flow. */
    Lanes stress(const MaterialPoints &points, const std::size_t i, const double *before) const
    {
      Lanes s[6];
      for (unsigned int c = 0; c < 6; ++c)
        s[c] = load_lanes(points.component(MaterialPoints::stress, c) + i);
      const Lanes mean = (s[0] + s[1] + s[2]) * (1. / 3.);
      Lanes squared = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        squared += 1.5 * (s[c] - mean) * (s[c] - mean) + 3. * s[3 + c] * s[3 + c];
      Lanes result = square_root(squared);
      where(!(load_lanes(points.component(field, 0) + i) > load_lanes(before)), result) = 0.;
      return result;
    }

  private:
    unsigned int field = 0;
    bool can_flow = false;
  };

  /**
   * A part of cells of one element type, with the integration of stresses: the nodal forces of the
   * stresses of PartPoints.
   *
   * The forces at t_n use the gradients at x_n; the strain increment comes from the velocity
   * between t_{n-1} and t_n differentiated at x_n and moved to the middle of the step by
   * motion_increment(), so that a rigid rotation makes no strain.
   */
  template <int dim, typename Element>
  class CellIntegration : public LosingCells<dim, CellPoints<dim, Element>>
  {
  public:
    using Points = CellPoints<dim, Element>;
    using NodeValues = typename Points::NodeValues;
    using Group = typename CellBatches<dim>::Group;
    static constexpr unsigned int n_nodes = Points::n_nodes;
    static constexpr unsigned int n_points = Points::n_points;

    explicit CellIntegration(const Section &section) : Base(section), element(section)
    {
      part_points = PartPoints(section);
    }

    /** Makes the points of the cells, with the variables of the element. */
    void create_points()
    {
      if (!part_points.has_mechanics())
        return;
      element.set_material(part_points.material());
      part_points.create(cell_points.n_points_of_slots(), element.variables());
      plastic_flow.set(part_points.points());
    }

    /** Sets volumes and variables at the start, before initial positions are released. */
    void set_initial_state()
    {
      failure_message.clear();
      double *const volumes = part_points.points().component(MaterialPoints::volume, 0);
      NodeValues x, v;
      for (auto &node_values : v)
        std::fill_n(node_values, dim, Lanes(0.));
      for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
      {
        cell_points.gather_initial_positions(batch, x);
        typename Element::Work work;
        Lanes volume[n_points];
        Matrix3<Lanes> gradient[n_points];
        element.evaluate(x, v, work, volume, gradient);
        note_failure(batch, x, volume);
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int lane = 0; lane < cell_points.cells().n_valid(batch); ++lane)
            volumes[(batch * n_points + q) * n_lanes + lane] = volume[q][lane];
        element.initialize_variables(work,
                                     variables_at(Points::first_point(batch), batch_variables));
      }
      part_points.begin_with_volumes(dim);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override
    {
      add_internal_force(input, all_batches(), force);
    }

    /** The same of the cells of a group. */
    void add_internal_force(const MechanicalInput &input, const Group &group, NodalVector &force)
    {
      failure_message.clear();
      typename Element::Work work[batches_per_block];
      Sweep sweep(part_points, input.time_increment);
      alignas(64) double plastic_strain[points_per_block];
      const bool limits = Element::limits_forces && plastic_flow.is_possible();
      for (unsigned int begin = group.first_batch; begin < group.end_batch;
           begin += batches_per_block)
      {
        const unsigned int end = std::min(begin + batches_per_block, group.end_batch);
        const unsigned int n = (end - begin) * points_per_batch;
        sweep.begin(Points::first_point(begin), n);
        for (unsigned int batch = begin; batch < end; ++batch)
          advance_motion(batch, input, work[batch - begin], sweep,
                         (batch - begin) * points_per_batch);
        if (limits)
          plastic_flow.keep(part_points.points(), Points::first_point(begin), n, plastic_strain);
        sweep.update_stress();
        sweep.update_viscosity();
        for (unsigned int batch = begin; batch < end; ++batch)
        {
          if (limits)
            limit_forces(batch, plastic_strain + (batch - begin) * points_per_batch,
                         work[batch - begin]);
          scatter_force(batch, work[batch - begin], force);
        }
      }
    }

    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force) const override
    {
      apply_elastic_stiffness(position, velocity, time_step, all_batches(), 1., force);
    }

    /** The same of the cells of a group, times @p factor. */
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, const Group &group, const double factor,
                                 NodalVector &force) const
    {
      const PointStiffness stiffness(part_points, time_step);
      std::vector<double *> addresses;
      for (unsigned int batch = group.first_batch; batch < group.end_batch; ++batch)
      {
        const std::size_t first = Points::first_point(batch);
        NodeValues x, v;
        cell_points.gather(batch, position, x);
        cell_points.gather(batch, velocity, v);
        typename Element::Work work;
        Lanes volume[n_points];
        Matrix3<Lanes> gradient[n_points];
        element.evaluate(x, v, work, volume, gradient);
        Lanes stress[n_points][6];
        for (unsigned int q = 0; q < n_points; ++q)
          stiffness.find_stress(first + q * n_lanes, gradient[q], volume[q], stress[q]);
        element.linearize(work, time_step, variables_at(first, addresses));
        NodeValues action;
        element.integrate(work, stress, action);
        for (auto &node_values : action)
          for (Lanes &component : node_values)
            component *= factor;
        cell_points.scatter(batch, action, force);
      }
    }

    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override;

    /** With those of hourglass control. */
    EnergyAccounts energies() const override
    {
      EnergyAccounts result = Base::energies();
      Lanes stored = 0., dissipated = 0.;
      std::vector<double *> addresses;
      for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
      {
        Lanes batch_stored = 0., batch_dissipated = 0.;
        element.add_energies(variables_at(Points::first_point(batch), addresses), batch_stored,
                             batch_dissipated);
        const unsigned int n_valid = cell_points.cells().n_valid(batch);
        const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
        stored += is_cell * batch_stored;
        dissipated += is_cell * batch_dissipated;
      }
      result.add("hourglass energy", EnergyKind::stored, reduce(stored));
      result.add("viscous dissipation", EnergyKind::artificial, reduce(dissipated));
      return result;
    }

    std::optional<std::string> unfit_to_linearize() const override
    {
      const std::string reason = part_points.unfit_to_linearize();
      return reason.empty() && element.is_viscous() ? "forces that resist rates" : reason;
    }

    /** The power of the forces of t_{n-1} on @p velocity, by which a cell came to @p position. */
    double internal_power(const unsigned int slot, const NodalVector &position,
                          const NodalVector &velocity, const double time_increment) const
    {
      const unsigned int batch = slot / n_lanes, lane = slot % n_lanes;
      NodeValues x, v;
      cell_points.gather(batch, position, x);
      cell_points.gather(batch, velocity, v);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          x[k][d] -= time_increment * v[k][d];
      typename Element::Work work;
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);

      // A step of no duration gives the element's own forces; it is made with a copy, since cells
      // of the same batch remain.
      dealii::AlignedVector<double> copy;
      const std::vector<double *> addresses = copy_variables(Points::first_point(batch), copy);
      Lanes spin[n_points][3];
      for (auto &point_spin : spin)
        std::fill_n(point_spin, 3, Lanes(0.));
      element.advance(work, spin, 0., addresses.data());

      Lanes stress[n_points][6];
      integrate_stress(batch, stress);
      NodeValues force;
      element.integrate(work, stress, force);
      double power = 0;
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          power += force[k][d][lane] * v[k][d][lane];
      return power;
    }

    void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) override
    {
      NodeValues x;
      Lanes volume[n_points];
      for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
      {
        find_volumes(batch, position, x, volume);
        MeanDilatation::set_volumes(part_points.points(), Points::first_point(batch), volume,
                                    shares_volume(), are_new);
      }
    }

    /** The positions of the nodes of a batch, and the volumes of its points there. */
    void find_volumes(const unsigned int batch, const NodalVector &position, NodeValues &x,
                      Lanes (&volume)[n_points]) const
    {
      NodeValues v;
      cell_points.gather(batch, position, x);
      for (auto &node_values : v)
        std::fill_n(node_values, dim, Lanes(0.));
      typename Element::Work work;
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
    }

    /** Whether all points of the cell at a slot have a positive volume at these positions. */
    bool is_volume_positive(const unsigned int slot, const NodalVector &position) const
    {
      NodeValues x;
      Lanes volume[n_points];
      find_volumes(slot / n_lanes, position, x, volume);
      return std::all_of(volume, volume + n_points,
                         [&](const Lanes &point_volume)
                         { return point_volume[slot % n_lanes] > 0.; });
    }

  protected:
    using Base = LosingCells<dim, Points>;
    using Base::cell_points, Base::failure_message, Base::part_points;

  private:
    template <int, typename>
    friend class CellStiffness;
    static constexpr unsigned int points_per_batch = Points::points_per_batch;
    static constexpr unsigned int batches_per_block = std::max(1u, 64u / points_per_batch);
    static constexpr unsigned int points_per_block = batches_per_block * points_per_batch;
    using Sweep = PointSweep<points_per_block>;

    Group all_batches() const
    {
      return {1, 0, cell_points.cells().n_batches()};
    }

    /** Addresses of the components of the element's own variables. */
    const std::vector<double *> &variables() const
    {
      return part_points.formulation_variables();
    }
    /** The same at the points from @p first on, in @p addresses. */
    double *const *variables_at(const std::size_t first, std::vector<double *> &addresses) const
    {
      addresses = variables();
      for (double *&variable : addresses)
        variable += first;
      return addresses.data();
    }
    /** Addresses of copies for the points of a batch, in @p memory. */
    std::vector<double *> copy_variables(const std::size_t first,
                                         dealii::AlignedVector<double> &memory) const
    {
      memory.resize(variables().size() * points_per_batch);
      std::vector<double *> result;
      for (const double *const variable : variables())
      {
        result.push_back(memory.data() + result.size() * points_per_batch);
        std::copy_n(variable + first, points_per_batch, result.back());
      }
      return result;
    }
    /** Whether points of a cell keep their parts of its volume. */
    bool shares_volume() const
    {
      return part_points.is_logarithmic() && Element::shares_volume;
    }
    void share(const typename Element::Work &work,
               MotionIncrement<Lanes> (&motions)[n_points]) const
    {
      element.share(work, part_points.is_logarithmic(), motions);
    }

    void advance_motion(const unsigned int batch, const MechanicalInput &input,
                        typename Element::Work &work, Sweep &sweep, const unsigned int offset)
    {
      NodeValues x, v;
      cell_points.gather(batch, *input.position, x);
      cell_points.gather(batch, *input.velocity, v);
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
      note_failure(batch, x, volume);
      element.separate(work, gradient);
      MotionIncrement<Lanes> motions[n_points];
      sweep.move_cells(
          offset, cell_points.cells().n_valid(batch), gradient, volume, shares_volume(), motions,
          [&](MotionIncrement<Lanes>(&point_motions)[n_points]) { share(work, point_motions); });
      if (part_points.heating().is_on())
        cell_points.interpolate(batch, *input.temperature, sweep.nodal_temperature + offset);
      Lanes spin[n_points][3];
      for (unsigned int q = 0; q < n_points; ++q)
        std::copy_n(motions[q].spin, 3, spin[q]);
      element.advance(work, spin, input.time_increment,
                      variables_at(Points::first_point(batch), batch_variables));
    }

    /** Element::limit() of a batch, with the plastic strain @p before the step. */
    void limit_forces(const unsigned int batch, const double *before, typename Element::Work &work)
    {
      const std::size_t first = Points::first_point(batch);
      Lanes flow_stress[n_points];
      for (unsigned int q = 0; q < n_points; ++q)
        flow_stress[q] =
            plastic_flow.stress(part_points.points(), first + q * n_lanes, before + q * n_lanes);
      element.limit(work, flow_stress, variables_at(first, batch_variables));
    }

    /** Volume times stress, with the artificial pressure, at the points of a batch. */
    void integrate_stress(const unsigned int batch, Lanes (&stress)[n_points][6]) const
    {
      for (unsigned int q = 0; q < n_points; ++q)
        part_points.integrate_stress(Points::first_point(batch) + q * n_lanes, stress[q]);
    }

    void scatter_force(const unsigned int batch, const typename Element::Work &work,
                       NodalVector &force) const
    {
      Lanes stress[n_points][6];
      integrate_stress(batch, stress);
      NodeValues internal_force;
      element.integrate(work, stress, internal_force);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          internal_force[k][d] = -internal_force[k][d];
      cell_points.scatter(batch, internal_force, force);
    }

    void note_failure(const unsigned int batch, const NodeValues &x,
                      const Lanes (&volume)[n_points])
    {
      auto is_sound = volume[0] > 0.;
      for (unsigned int q = 1; q < n_points; ++q)
        is_sound = is_sound && volume[q] > 0.;
      if (all_of(is_sound) || !failure_message.empty())
        return;
      for (unsigned int lane = 0; lane < cell_points.cells().n_valid(batch); ++lane)
        if (!is_sound[lane] && failure_message.empty())
        {
          dealii::Point<dim> centre, initial;
          for (const auto &node_values : x)
            for (unsigned int d = 0; d < dim; ++d)
              centre[d] += node_values[d][lane] / n_nodes;
          double smallest = volume[0][lane];
          for (unsigned int q = 0; q < n_points; ++q)
          {
            initial +=
                cell_points.initial_positions()[Points::point_at(batch * n_lanes + lane, q)] /
                double(n_points);
            if (!(volume[q][lane] >= smallest))
              smallest = volume[q][lane];
          }
          failure_message = describe_unusable_cell(centre, initial, smallest);
        }
    }

    Element element;
    PlasticFlow plastic_flow;
    std::vector<double *> batch_variables; // those of the batch at hand
  };
} // namespace tombolo
