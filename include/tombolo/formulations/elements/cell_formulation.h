// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/conduction_element.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/formulations/elements/erosion_criterion.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/plastic_heating.h>

#include <algorithm>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A part of finite elements: everything a Formulation does, for one element type (see
   * ElementDefaults for what an element is), in batches of n_lanes cells.
   *
   * Material points are kept batch by batch, within a batch point by point, within a point cell by
   * cell: point q of the cell at place c is number (c / n_lanes · n_points + q) · n_lanes + c %
   * n_lanes. Where the last batch is not full, its unused lanes repeat the last cell of the part
   * with volume zero, so that sums weighted by volume and extremes need not know of them. The place
   * of a cell is its number, until cells are removed: those that are left close up, and the others
   * keep points of volume zero behind them.
   *
   * The forces at t_n use the gradients at x_n; the strain increment comes from the velocity
   * between t_{n-1} and t_n differentiated at x_n and moved to the middle of the step by
   * motion_increment(), so that a rigid rotation makes no strain.
   */
  template <int dim, typename Element>
  class CellFormulation : public Formulation<dim>,
                          public ErodingCells<dim>,
                          public ConvertingCells<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      Element::declare_parameters(handler);
      BulkViscosity::declare_parameters(handler);
      ErosionCriterion::declare_parameters(handler);
      ConversionCriterion::declare_parameters(handler);
    }

    explicit CellFormulation(const Section &section)
        : element(section), bulk_viscosity(section), erosion(section), criterion(section)
    {}

    explicit CellFormulation(const Element &element) : element(element) {}

    unsigned int degree() const override
    {
      return Element::degree;
    }

    double cost_per_cell(const Material &material, const double /*box_ratio*/) const override
    {
      return StepCost::of_element(dim, Element::degree, n_points, Element::cost_per_point,
                                  material);
    }

    void initialize(const PartSetup<dim> &setup) override;

    dealii::IndexSet required_nodes() const override
    {
      return cells.required_nodes();
    }

    void set_partition(const NodePartition &partition) override
    {
      cells.set_partition(partition);
    }

    void add_mass(NodalVector &mass) const override
    {
      cells.add_mass(mass);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override;

    std::string failure() const override
    {
      return failure_message;
    }

    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const override;

    StepLimit courant_limit(const NodalVector &position) const override;
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void scale_inertia(const std::vector<double> &factors) override;
    void add_extra_mass(NodalVector &mass) const override;

    EnergyAccounts energies() const override;

    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override;
    StepLimit diffusion_limit(const NodalVector &position) const override;
    void add_plastic_heat(NodalVector &heat) override;
    double pending_plastic_heat() const override
    {
      return plastic_heating.pending(material_points);
    }

    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &positions) const override;

    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return initial_points;
    }

    const MaterialPoints &points() const override
    {
      return material_points;
    }
    MaterialPoints &points() override
    {
      return material_points;
    }
    const Material &material() const override
    {
      return *part_material;
    }

    unsigned int n_cells() const override
    {
      return cells.n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return has_points ? n_points : 0;
    }
    unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const override
    {
      return point_at(cells.place(cell), q);
    }

    void serialize(StateArchive &archive) override;

    bool erodes() const override
    {
      return erosion.is_on();
    }
    unsigned int find_failed_cells(const NodalVector &position) override;
    RemovedCells remove_failed_cells(const NodalVector &position, const NodalVector &velocity,
                                     double time_increment) override;
    bool is_removed(const unsigned int cell) const override
    {
      return !removed.empty() && removed[cell];
    }
    bool can_lose_cells() const override
    {
      return erosion.is_on() || criterion.is_on();
    }
    unsigned int n_removed_cells() const override
    {
      return cells.n_cells() - cells.n_present_cells() - n_converted_cells();
    }
    void add_nodes_of_removed_cells(
        std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const override;

    const ConversionCriterion &conversion() const override
    {
      return criterion;
    }
    std::vector<unsigned int> find_converting_cells(const NodalVector &position) const override;
    void add_state(const std::vector<unsigned int> &converted, StateTransfer &state) const override;
    void deactivate_cells(const std::vector<unsigned int> &given) override;
    void keep_dissipated(const EnergyAccounts &lost) override;
    std::vector<dealii::types::global_dof_index>
    nodes_of_cell(const unsigned int cell) const override
    {
      return cells.nodes_of_cell(cell);
    }
    unsigned int n_converted_cells() const override;

    std::size_t memory_consumption() const override
    {
      return material_points.memory_consumption() + cells.memory_consumption() +
             initial_points.capacity() * sizeof(dealii::Point<dim>);
    }

  private:
    static constexpr unsigned int n_nodes = Element::n_nodes;
    static constexpr unsigned int n_points = Element::n_points;
    static constexpr unsigned int points_per_batch = n_points * n_lanes;
    // One virtual call of the material serves a block, whose data stay in the caches meanwhile.
    static constexpr unsigned int batches_per_block = std::max(1u, 64u / points_per_batch);
    static constexpr unsigned int points_per_block = batches_per_block * points_per_batch;

    using NodeValues = Lanes[n_nodes][dim];

    static unsigned int point_at(const unsigned int place, const unsigned int q)
    {
      return (place / n_lanes * n_points + q) * n_lanes + place % n_lanes;
    }

    /** One component of each field of the element or of the material, at one place. */
    using Pointers = std::vector<double *>;

    void gather(const unsigned int batch, const NodalVector &vector, NodeValues &values) const
    {
      const unsigned int *const nodes = cells.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        gather_nodes<dim>(vector.data(), nodes + k * n_lanes, values[k]);
    }

    /** Addresses of the element's own variables in a batch. */
    void find_variables(const unsigned int batch, Pointers &variables)
    {
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + std::size_t(batch) * points_per_batch;
    }

    using ScalarValues = Lanes[n_nodes];

    /** The mean of the nodes of a cell. */
    static dealii::Point<3> centre(const NodeValues &x, const unsigned int lane)
    {
      dealii::Point<3> result;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 0; k < n_nodes; ++k)
          result[d] += x[k][d][lane] / n_nodes;
      return result;
    }

    /** Slot 0 of a vector. */
    void gather(const unsigned int batch, const NodalVector &vector, ScalarValues &values) const
    {
      const unsigned int *const nodes = cells.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        values[k] = Lanes([&](const auto lane) { return *vector.node(nodes[k * n_lanes + lane]); });
    }

    void advance_motion(unsigned int batch, const MechanicalInput &input,
                        typename Element::Work &work, double (*strain)[points_per_block],
                        unsigned int offset);
    /** The positions of the nodes of a batch, and the volumes of its points there. */
    void find_volumes(unsigned int batch, const NodalVector &position, NodeValues &x,
                      Lanes (&volume)[n_points]) const;
    /** Calls @p use with the batch, its positions and its lengths over wave speeds. */
    template <typename Use>
    void for_crossing_times(const NodalVector &position, const Use &use) const;
    void interpolate_temperature(unsigned int batch, const NodalVector &temperature,
                                 double *at_points) const;
    /** Volume times stress, and what acts beside it, at the points of a batch. */
    void integrate_stress(unsigned int batch, Lanes (&stress)[n_points][6]) const;
    void scatter_force(unsigned int batch, const typename Element::Work &work,
                       NodalVector &force) const;
    void note_failure(unsigned int batch, const NodeValues &x, const Lanes (&volume)[n_points]);
    bool is_volume_positive(unsigned int place, const NodalVector &position) const;
    double internal_power(unsigned int place, const NodalVector &position,
                          const NodalVector &velocity, double time_increment) const;
    void close_up();

    Element element;
    BulkViscosity bulk_viscosity;
    ErosionCriterion erosion;
    ConversionCriterion criterion; // of conversion
    PlasticHeating plastic_heating;
    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    bool has_points = true;
    CellBatches<dim> cells;
    std::vector<double> inertia_factors; // of cells; empty: one
    MaterialPoints material_points;
    std::vector<dealii::Point<dim>> initial_points;
    std::vector<std::vector<double>> shape_values; // of node k at reference point q
    Pointers material_variables;                   // first address of each component
    Pointers element_variables;                    // first address of each component
    Pointers batch_variables;                      // those of the batch at hand
    std::string failure_message;
    std::vector<unsigned int> failed_places; // of find_failed_cells(), ascending
    std::vector<bool> removed;               // by cell; empty before the first
    std::vector<bool> converted;             // those of them that became particles; likewise
    EnergyAccounts dissipated_in_removed;    // by cells that are none of the part any more
  };

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::initialize(const PartSetup<dim> &setup)
  {
    part_material = setup.material;
    thermal_properties = setup.heat;
    has_points = setup.has_mechanics;
    cells.reinit(setup, Element::degree, Element::lumping, erosion.is_on() || criterion.is_on());
    if (!has_points)
    {
      material_points.reinit(0, {});
      erosion.initialize(material_points, has_points);
      criterion.initialize(material_points, has_points);
      cells.release_initial_positions();
      return;
    }
    element.set_material(*part_material);
    plastic_heating.set(setup.heat, *part_material);

    std::vector<FieldDescription> variables = part_material->internal_variables();
    const std::size_t n_material_fields = MaterialPoints::n_standard_fields + variables.size();
    for (const FieldDescription &field : element.variables())
      variables.push_back(field);
    const std::size_t n_element_fields = MaterialPoints::n_standard_fields + variables.size();
    for (const FieldDescription &field : bulk_viscosity.variables())
      variables.push_back(field);
    for (const FieldDescription &field : plastic_heating.variables())
      variables.push_back(field);
    material_points.reinit(cells.n_batches_of_places() * points_per_batch, variables);
    erosion.initialize(material_points, has_points);
    criterion.initialize(material_points, has_points);
    plastic_heating.initialize(material_points);
    material_variables.clear();
    element_variables.clear();
    for (unsigned int f = MaterialPoints::n_standard_fields; f < n_element_fields; ++f)
      for (unsigned int c = 0; c < material_points.fields()[f].n_components; ++c)
        (f < n_material_fields ? material_variables : element_variables)
            .push_back(material_points.component(f, c));
    batch_variables.resize(element_variables.size());

    shape_values.clear();
    for (const dealii::Point<dim> &point : Element::reference_points())
      shape_values.push_back(lagrange_values<dim>(Element::degree, point));
    AssertDimension(shape_values.size(), n_points);

    initial_points.assign(material_points.size(), dealii::Point<dim>());
    failure_message.clear();
    NodeValues x, v;
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        v[k][d] = 0.;
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      const double *const positions = cells.initial_positions(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double *const values = positions + (k * dim + d) * n_lanes;
          x[k][d] = load_lanes(values);
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              initial_points[(batch * n_points + q) * n_lanes + lane][d] +=
                  shape_values[q][k] * values[lane];
        }
      typename Element::Work work;
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
      note_failure(batch, x, volume);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
          material_points.component(MaterialPoints::volume,
                                    0)[(batch * n_points + q) * n_lanes + lane] = volume[q][lane];
      find_variables(batch, batch_variables);
      element.initialize_variables(work, batch_variables.data());
    }
    for (std::size_t i = std::size_t(cells.n_batches()) * points_per_batch;
         i < initial_points.size() && cells.n_batches() > 0; ++i)
      initial_points[i] = initial_points[i - points_per_batch]; // as unused lanes
    cells.release_initial_positions();
    bulk_viscosity.initialize(*part_material, dim, material_points);

    const std::vector<std::string> failures =
        dealii::Utilities::MPI::all_gather(setup.communicator, failure_message);
    for (const std::string &failure : failures)
      if (!failure.empty())
        throw InputError("The part \"" + setup.name + "\" cannot be made of this mesh: " + failure);
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_internal_force(const MechanicalInput &input,
                                                         NodalVector &force)
  {
    failure_message.clear();
    typename Element::Work work[batches_per_block];
    alignas(64) double strain[6][points_per_block];
    alignas(64) double nodal_temperature[points_per_block];
    alignas(64) double temperature_increment[points_per_block];
    MaterialBatch material_batch;
    material_batch.time_increment = input.time_increment;
    material_batch.internal_variables.resize(material_variables.size());
    for (unsigned int c = 0; c < 6; ++c)
      material_batch.strain_increment[c] = strain[c];

    for (unsigned int begin = 0; begin < cells.n_batches(); begin += batches_per_block)
    {
      const unsigned int end = std::min(begin + batches_per_block, cells.n_batches());
      for (unsigned int batch = begin; batch < end; ++batch)
        advance_motion(batch, input, work[batch - begin], strain,
                       (batch - begin) * points_per_batch);

      const std::size_t first = std::size_t(begin) * points_per_batch;
      material_batch.n = (end - begin) * points_per_batch;
      for (unsigned int c = 0; c < 6; ++c)
        material_batch.stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      material_batch.volume_ratio =
          material_points.component(MaterialPoints::volume_ratio, 0) + first;
      for (std::size_t c = 0; c < material_variables.size(); ++c)
        material_batch.internal_variables[c] = material_variables[c] + first;
      if (plastic_heating.is_on())
      {
        for (unsigned int batch = begin; batch < end; ++batch)
          interpolate_temperature(batch, *input.temperature,
                                  nodal_temperature + (batch - begin) * points_per_batch);
        plastic_heating.advance(material_points, first, material_batch.n, nodal_temperature,
                                input.time_increment == 0., temperature_increment);
        material_batch.temperature = plastic_heating.temperature(material_points) + first;
        material_batch.temperature_increment = temperature_increment;
      }
      part_material->update_stress(material_batch);
      if (bulk_viscosity.is_on())
        bulk_viscosity.advance(material_points, first, material_batch.n,
                               material_batch.strain_increment, input.time_increment);

      for (unsigned int batch = begin; batch < end; ++batch)
        scatter_force(batch, work[batch - begin], force);
    }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::advance_motion(const unsigned int batch,
                                                     const MechanicalInput &input,
                                                     typename Element::Work &work,
                                                     double (*strain)[points_per_block],
                                                     const unsigned int offset)
  {
    NodeValues x, v;
    gather(batch, *input.position, x);
    gather(batch, *input.velocity, v);
    Lanes volume[n_points];
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);
    note_failure(batch, x, volume);

    const std::size_t first = std::size_t(batch) * points_per_batch;
    double *const volume_ratio = material_points.component(MaterialPoints::volume_ratio, 0) + first;
    double *const volumes = material_points.component(MaterialPoints::volume, 0) + first;
    const unsigned int n_valid = cells.n_valid(batch);
    const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
    Lanes spin[n_points][3];
    element.separate(work, gradient);
    MotionIncrement<Lanes> motions[n_points];
    for (unsigned int q = 0; q < n_points; ++q)
    {
      for (Lanes &entry : gradient[q].entry)
        entry *= input.time_increment;
      motions[q] = motion_increment(gradient[q]);
    }
    element.share(work, motions);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const MotionIncrement<Lanes> &motion = motions[q];
      const unsigned int i = q * n_lanes;
      for (unsigned int d = 0; d < 3; ++d)
        spin[q][d] = motion.spin[d];
      store_lanes(load_lanes(volume_ratio + i) * motion.volume_factor, volume_ratio + i);
      store_lanes(is_cell * volume[q], volumes + i);
      Lanes stress[6];
      for (unsigned int c = 0; c < 6; ++c)
      {
        store_lanes(motion.strain[c], strain[c] + offset + i);
        stress[c] = load_lanes(material_points.component(MaterialPoints::stress, c) + first + i);
      }
      rotate(motion.spin, stress);
      for (unsigned int c = 0; c < 6; ++c)
        store_lanes(stress[c], material_points.component(MaterialPoints::stress, c) + first + i);
    }
    find_variables(batch, batch_variables);
    element.advance(work, spin, input.time_increment, batch_variables.data());
  }

  template <int dim, typename Element>
  TOMBOLO_ALWAYS_INLINE void
  CellFormulation<dim, Element>::integrate_stress(const unsigned int batch,
                                                  Lanes (&stress)[n_points][6]) const
  {
    const std::size_t first = std::size_t(batch) * points_per_batch;
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const std::size_t i = first + q * n_lanes;
      const Lanes volume = load_lanes(material_points.component(MaterialPoints::volume, 0) + i);
      for (unsigned int c = 0; c < 6; ++c)
        stress[q][c] =
            volume * load_lanes(material_points.component(MaterialPoints::stress, c) + i);
      if (bulk_viscosity.is_on())
        for (unsigned int c = 0; c < 3; ++c)
          stress[q][c] -= volume * load_lanes(bulk_viscosity.pressure(material_points) + i);
    }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::scatter_force(const unsigned int batch,
                                                    const typename Element::Work &work,
                                                    NodalVector &force) const
  {
    Lanes stress[n_points][6];
    integrate_stress(batch, stress);
    NodeValues internal_force;
    element.integrate(work, stress, internal_force);
    const unsigned int *const nodes = cells.nodes(batch);
    for (unsigned int k = 0; k < n_nodes; ++k)
    {
      for (unsigned int d = 0; d < dim; ++d)
        internal_force[k][d] = -internal_force[k][d];
      add_to_nodes<dim>(internal_force[k], nodes + k * n_lanes, cells.n_valid(batch), force.data());
    }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::apply_elastic_stiffness(const NodalVector &position,
                                                              const NodalVector &velocity,
                                                              const double time_step,
                                                              NodalVector &force) const
  {
    const double bulk = part_material->bulk_modulus();
    const double shear = part_material->shear_modulus();
    const double lambda = bulk - 2. / 3. * shear;
    std::vector<const double *> variables(element_variables.size());
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      NodeValues x, v;
      gather(batch, position, x);
      gather(batch, velocity, v);
      typename Element::Work work;
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
      Lanes stress[n_points][6];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Matrix3<Lanes> &l = gradient[q];
        Lanes modulus = lambda;
        if (bulk_viscosity.is_on())
          modulus += 2. / time_step *
                     load_lanes(bulk_viscosity.tangent(material_points) +
                                std::size_t(batch) * points_per_batch + q * n_lanes);
        const Lanes pressure = modulus * volume[q] * (l(0, 0) + l(1, 1) + l(2, 2));
        const Lanes twice = 2. * shear * volume[q];
        const Lanes once = shear * volume[q];
        stress[q][0] = pressure + twice * l(0, 0);
        stress[q][1] = pressure + twice * l(1, 1);
        stress[q][2] = pressure + twice * l(2, 2);
        stress[q][3] = once * (l(1, 2) + l(2, 1));
        stress[q][4] = once * (l(0, 2) + l(2, 0));
        stress[q][5] = once * (l(0, 1) + l(1, 0));
      }
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + std::size_t(batch) * points_per_batch;
      element.linearize(work, time_step, variables.data());
      NodeValues action;
      element.integrate(work, stress, action);
      const unsigned int *const nodes = cells.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        add_to_nodes<dim>(action[k], nodes + k * n_lanes, cells.n_valid(batch), force.data());
    }
  }

  template <int dim, typename Element>
  void
  CellFormulation<dim, Element>::point_positions(const NodalVector &position,
                                                 std::vector<dealii::Point<dim>> &positions) const
  {
    positions.assign(material_points.size(), dealii::Point<dim>());
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const double *const node = position.node(cells.nodes(batch)[k * n_lanes + lane]);
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int d = 0; d < dim; ++d)
              positions[(batch * n_points + q) * n_lanes + lane][d] += shape_values[q][k] * node[d];
        }
  }
} // namespace tombolo

#include <tombolo/formulations/elements/cell_conversion.h>
#include <tombolo/formulations/elements/cell_heat.h>
#include <tombolo/formulations/elements/cell_inertia.h>
#include <tombolo/formulations/elements/cell_removal.h>
