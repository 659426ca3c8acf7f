// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/elements/cell_plastic_heat.h>
#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/unusable_cell.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/logarithmic_points.h>
#include <tombolo/formulations/plastic_flow.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/formulations/point_stiffness.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The integration of stresses over the cells of one part, for one element type: the element, the
   * material and the artificial viscosity, what the stresses of CellPoints do at the nodes.
   *
   * The forces at t_n use the gradients at x_n; the strain increment comes from the velocity
   * between t_{n-1} and t_n differentiated at x_n and moved to the middle of the step by
   * motion_increment(), so that a rigid rotation makes no strain.
   */
  template <int dim, typename Element>
  class CellIntegration
  {
  public:
    using Points = CellPoints<dim, Element>;
    using NodeValues = typename Points::NodeValues;
    static constexpr unsigned int n_nodes = Points::n_nodes;
    static constexpr unsigned int n_points = Points::n_points;

    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      Element::declare_parameters(handler);
      declare_strain_measure(handler, Element::measure);
      declare<BulkViscosity>(handler);
    }

    explicit CellIntegration(const Section &section)
        : element(section), bulk_viscosity(section), measure(read_strain_measure(section))
    {}

    /** Without artificial viscosity. */
    explicit CellIntegration(const Element &element) : element(element) {}

    /** Takes material and heat of the part and makes the points, with the fields of material,
     * element, viscosity and heat; no points in a scene of heat alone. */
    void create_points(const PartSetup<dim> &setup, Points &points);

    /** Sets volumes and variables of the points as they are at the start. Only with points, and
     * before the initial positions of nodes are released. */
    void set_initial_state(Points &points);

    /** @name As in Formulation */
    ///@{
    void add_internal_force(const MechanicalInput &input, Points &points, NodalVector &force);
    void apply_elastic_stiffness(const Points &points, const NodalVector &position,
                                 const NodalVector &velocity, double time_step,
                                 NodalVector &force) const;
    /** Of stress, hourglass control and artificial viscosity. */
    EnergyAccounts energies(const Points &points) const;
    void add_plastic_heat(Points &points, NodalVector &heat) const;

    /** Of the last add_internal_force() or set_initial_state(). */
    const std::string &failure() const
    {
      return failure_message;
    }
    ///@}

    /** The power of the internal forces of t_{n-1} on @p velocity, that of a cell which has moved
     * with it to @p position. */
    double internal_power(const Points &points, unsigned int place, const NodalVector &position,
                          const NodalVector &velocity, double time_increment) const;

    /** The positions of the nodes of a batch, and the volumes of its points there. */
    void find_volumes(const Points &points, unsigned int batch, const NodalVector &position,
                      NodeValues &x, Lanes (&volume)[n_points]) const;

    /** Whether all points of the cell at a place have a positive volume at these positions. */
    bool is_volume_positive(const Points &points, unsigned int place,
                            const NodalVector &position) const;

    /** Whether points of a cell keep their parts of its volume. */
    bool shares_volume() const
    {
      return measure == StrainMeasure::logarithmic && Element::shares_volume;
    }

    const Material &material() const
    {
      return *part_material;
    }
    const PlasticHeating &heating() const
    {
      return plastic_heating;
    }

  private:
    template <int, typename>
    friend class CellStiffness;
    static constexpr unsigned int points_per_batch = Points::points_per_batch;
    // One virtual call of the material serves a block, whose data stay in the caches.
    static constexpr unsigned int batches_per_block = std::max(1u, 64u / points_per_batch);
    static constexpr unsigned int points_per_block = batches_per_block * points_per_batch;

    /** One component of each field of the element or of the material, at one place. */
    using Pointers = std::vector<double *>;

    /** Addresses of the element's own variables in a batch. */
    void find_variables(const unsigned int batch, Pointers &variables)
    {
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + Points::first_point(batch);
    }

    void advance_motion(unsigned int batch, const MechanicalInput &input, Points &points,
                        typename Element::Work &work, double (*strain)[points_per_block],
                        double *work_factor, unsigned int offset);
    /** Strains of the logarithmic measure at the points of a batch from the gradients of the step,
     * and the Kirchhoff stress in the place of Cauchy's. */
    void find_logarithmic_motions(unsigned int batch, MaterialPoints &material_points,
                                  const Matrix3<Lanes> (&gradient)[n_points],
                                  MotionIncrement<Lanes> (&motions)[n_points]) const;
    /** Element::limit() of a batch, with the plastic strain @p before the step. */
    void limit_forces(const MaterialPoints &material_points, unsigned int batch,
                      const double *before, typename Element::Work &work);
    /** Volume times stress, and what acts beside it, at the points of a batch. */
    void integrate_stress(const MaterialPoints &material_points, unsigned int batch,
                          Lanes (&stress)[n_points][6]) const;
    void scatter_force(const Points &points, unsigned int batch, const typename Element::Work &work,
                       NodalVector &force) const;
    void note_failure(const Points &points, unsigned int batch, const NodeValues &x,
                      const Lanes (&volume)[n_points]);

    Element element;
    BulkViscosity bulk_viscosity;
    StrainMeasure measure = StrainMeasure::rate;
    PlasticHeating plastic_heating;
    PlasticFlow plastic_flow;
    std::shared_ptr<const Material> part_material;
    Pointers material_variables; // first address of each component
    Pointers element_variables;  // first address of each component
    Pointers batch_variables;    // those of the batch at hand
    std::string failure_message;
  };

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::create_points(const PartSetup<dim> &setup, Points &points)
  {
    part_material = setup.material;
    if (!setup.has_mechanics)
      return;
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
    points.create_points(variables);

    MaterialPoints &material_points = points.material_points();
    plastic_heating.initialize(material_points);
    plastic_flow.set(material_points);
    material_variables.clear();
    element_variables.clear();
    for (unsigned int f = MaterialPoints::n_standard_fields; f < n_element_fields; ++f)
      for (unsigned int c = 0; c < material_points.fields()[f].n_components; ++c)
        (f < n_material_fields ? material_variables : element_variables)
            .push_back(material_points.component(f, c));
    batch_variables.resize(element_variables.size());
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::set_initial_state(Points &points)
  {
    failure_message.clear();
    MaterialPoints &material_points = points.material_points();
    NodeValues x, v;
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        v[k][d] = 0.;
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      points.gather_initial_positions(batch, x);
      typename Element::Work work;
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
      note_failure(points, batch, x, volume);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
          material_points.component(MaterialPoints::volume,
                                    0)[(batch * n_points + q) * n_lanes + lane] = volume[q][lane];
      find_variables(batch, batch_variables);
      element.initialize_variables(work, batch_variables.data());
    }
    bulk_viscosity.initialize(*part_material, dim, material_points);
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::add_internal_force(const MechanicalInput &input,
                                                         Points &points, NodalVector &force)
  {
    failure_message.clear();
    MaterialPoints &material_points = points.material_points();
    typename Element::Work work[batches_per_block];
    const bool is_logarithmic = measure == StrainMeasure::logarithmic;
    alignas(64) double strain[6][points_per_block];
    alignas(64) double factor[points_per_block];
    alignas(64) double plastic_strain[points_per_block];
    alignas(64) double nodal_temperature[points_per_block];
    alignas(64) double temperature_increment[points_per_block];
    MaterialBatch material_batch;
    material_batch.time_increment = input.time_increment;
    material_batch.measure = measure;
    material_batch.internal_variables.resize(material_variables.size());
    for (unsigned int c = 0; c < 6; ++c)
      material_batch.strain_increment[c] = strain[c];

    const unsigned int n_batches = points.cells().n_batches();
    for (unsigned int begin = 0; begin < n_batches; begin += batches_per_block)
    {
      const unsigned int end = std::min(begin + batches_per_block, n_batches);
      for (unsigned int batch = begin; batch < end; ++batch)
        advance_motion(batch, input, points, work[batch - begin], strain, factor,
                       (batch - begin) * points_per_batch);

      const std::size_t first = Points::first_point(begin);
      material_batch.n = (end - begin) * points_per_batch;
      for (unsigned int c = 0; c < 6; ++c)
        material_batch.stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      material_batch.relative_volume =
          material_points.component(MaterialPoints::volume_ratio, 0) + first;
      material_batch.volume_ratio = is_logarithmic ? factor : material_batch.relative_volume;
      for (std::size_t c = 0; c < material_variables.size(); ++c)
        material_batch.internal_variables[c] = material_variables[c] + first;
      if (plastic_heating.is_on())
      {
        for (unsigned int batch = begin; batch < end; ++batch)
          points.interpolate(batch, *input.temperature,
                             nodal_temperature + (batch - begin) * points_per_batch);
        plastic_heating.advance(material_points, first, material_batch.n, nodal_temperature,
                                input.time_increment == 0., temperature_increment);
        material_batch.temperature = plastic_heating.temperature(material_points) + first;
        material_batch.temperature_increment = temperature_increment;
      }
      const bool limits_forces = Element::limits_forces && plastic_flow.is_possible();
      if (limits_forces)
        plastic_flow.keep(material_points, first, material_batch.n, plastic_strain);
      part_material->update_stress(material_batch);
      if (is_logarithmic)
        LogarithmicPoints::complete(material_points, first, material_batch.n);
      if (bulk_viscosity.is_on())
        bulk_viscosity.advance(material_points, first, material_batch.n,
                               material_batch.strain_increment, input.time_increment);

      for (unsigned int batch = begin; batch < end; ++batch)
      {
        if (limits_forces)
          limit_forces(material_points, batch, plastic_strain + (batch - begin) * points_per_batch,
                       work[batch - begin]);
        scatter_force(points, batch, work[batch - begin], force);
      }
    }
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::advance_motion(const unsigned int batch,
                                                     const MechanicalInput &input, Points &points,
                                                     typename Element::Work &work,
                                                     double (*strain)[points_per_block],
                                                     double *const factor,
                                                     const unsigned int offset)
  {
    NodeValues x, v;
    points.gather(batch, *input.position, x);
    points.gather(batch, *input.velocity, v);
    Lanes volume[n_points];
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);
    note_failure(points, batch, x, volume);

    MaterialPoints &material_points = points.material_points();
    const std::size_t first = Points::first_point(batch);
    double *const volume_ratio = material_points.component(MaterialPoints::volume_ratio, 0) + first;
    double *const volumes = material_points.component(MaterialPoints::volume, 0) + first;
    const unsigned int n_valid = points.cells().n_valid(batch);
    const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
    const bool is_logarithmic = measure == StrainMeasure::logarithmic;
    const Lanes growth =
        shares_volume() ? LogarithmicPoints::growth_of_cell(volumes, volume) : Lanes(1.);
    Lanes spin[n_points][3];
    element.separate(work, gradient);
    MotionIncrement<Lanes> motions[n_points];
    for (unsigned int q = 0; q < n_points; ++q)
    {
      for (Lanes &entry : gradient[q].entry)
        entry *= input.time_increment;
      if (!is_logarithmic)
        motions[q] = motion_increment(gradient[q]);
    }
    if (is_logarithmic)
    {
      find_logarithmic_motions(batch, material_points, gradient, motions);
      element.share_logarithmic(work, motions);
    }
    else
      element.share(work, motions);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const MotionIncrement<Lanes> &motion = motions[q];
      const unsigned int i = q * n_lanes;
      for (unsigned int d = 0; d < 3; ++d)
        spin[q][d] = motion.spin[d];
      store_lanes(load_lanes(volume_ratio + i) * motion.volume_factor, volume_ratio + i);
      // The energy of a point is weighed by its initial volume, and so is its Kirchhoff stress: of
      // points that share the growth of the cell each keeps its part of the volume.
      store_lanes(shares_volume() ? load_lanes(volumes + i) * growth : is_cell * volume[q],
                  volumes + i);
      if (is_logarithmic)
        store_lanes(work_factor(motion), factor + offset + i);
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
  void CellIntegration<dim, Element>::find_logarithmic_motions(
      const unsigned int batch, MaterialPoints &material_points,
      const Matrix3<Lanes> (&gradient)[n_points], MotionIncrement<Lanes> (&motions)[n_points]) const
  {
    const std::size_t first = Points::first_point(batch);
    alignas(64) double bulk[points_per_batch], shear[points_per_batch];
    const double *const temperature = plastic_heating.temperature(material_points);
    part_material->elastic_moduli(
        points_per_batch, temperature == nullptr ? nullptr : temperature + first, bulk, shear);
    for (unsigned int q = 0; q < n_points; ++q)
      motions[q] =
          LogarithmicPoints::begin(material_points, first + q * n_lanes, gradient[q],
                                   load_lanes(bulk + q * n_lanes), load_lanes(shear + q * n_lanes));
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::limit_forces(const MaterialPoints &material_points,
                                                   const unsigned int batch, const double *before,
                                                   typename Element::Work &work)
  {
    Lanes flow_stress[n_points];
    for (unsigned int q = 0; q < n_points; ++q)
      flow_stress[q] = plastic_flow.stress(
          material_points, Points::first_point(batch) + q * n_lanes, before + q * n_lanes);
    find_variables(batch, batch_variables);
    element.limit(work, flow_stress, batch_variables.data());
  }

  template <int dim, typename Element>
  TOMBOLO_ALWAYS_INLINE void
  CellIntegration<dim, Element>::integrate_stress(const MaterialPoints &material_points,
                                                  const unsigned int batch,
                                                  Lanes (&stress)[n_points][6]) const
  {
    const std::size_t first = Points::first_point(batch);
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
  void CellIntegration<dim, Element>::scatter_force(const Points &points, const unsigned int batch,
                                                    const typename Element::Work &work,
                                                    NodalVector &force) const
  {
    Lanes stress[n_points][6];
    integrate_stress(points.material_points(), batch, stress);
    NodeValues internal_force;
    element.integrate(work, stress, internal_force);
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        internal_force[k][d] = -internal_force[k][d];
    points.scatter(batch, internal_force, force);
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::apply_elastic_stiffness(const Points &points,
                                                              const NodalVector &position,
                                                              const NodalVector &velocity,
                                                              const double time_step,
                                                              NodalVector &force) const
  {
    const PointStiffness stiffness(*part_material, points.material_points(), measure);
    std::vector<const double *> variables(element_variables.size());
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      NodeValues x, v;
      points.gather(batch, position, x);
      points.gather(batch, velocity, v);
      typename Element::Work work;
      Lanes volume[n_points];
      Matrix3<Lanes> gradient[n_points];
      element.evaluate(x, v, work, volume, gradient);
      Lanes stress[n_points][6];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Matrix3<Lanes> &l = gradient[q];
        if (measure == StrainMeasure::logarithmic) // of the Kirchhoff stress
          volume[q] /=
              load_lanes(points.material_points().component(MaterialPoints::volume_ratio, 0) +
                         Points::first_point(batch) + q * n_lanes);
        Lanes modulus = stiffness.lambda(Points::first_point(batch) + q * n_lanes);
        if (bulk_viscosity.is_on())
          modulus += 2. / time_step *
                     load_lanes(bulk_viscosity.tangent(points.material_points()) +
                                Points::first_point(batch) + q * n_lanes);
        stiffness.find_stress(l, volume[q], modulus, stress[q]);
      }
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + Points::first_point(batch);
      element.linearize(work, time_step, variables.data());
      NodeValues action;
      element.integrate(work, stress, action);
      points.scatter(batch, action, force);
    }
  }

  template <int dim, typename Element>
  EnergyAccounts CellIntegration<dim, Element>::energies(const Points &points) const
  {
    EnergyAccounts result;
    const MaterialPoints &material_points = points.material_points();
    Lanes elastic = 0., stored = 0., dissipated = 0.;
    std::vector<const double *> variables(element_variables.size());
    alignas(64) double density[points_per_batch];
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      const std::size_t first = Points::first_point(batch);
      const double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      const double *const temperature = plastic_heating.temperature(material_points);
      part_material->elastic_energy_density(points_per_batch, stress,
                                            temperature == nullptr ? nullptr : temperature + first,
                                            density);
      const double *const volume = material_points.component(MaterialPoints::volume, 0) + first;
      const double *const ratio =
          material_points.component(MaterialPoints::volume_ratio, 0) + first;
      const bool is_logarithmic = measure == StrainMeasure::logarithmic;
      for (unsigned int i = 0; i < points_per_batch; i += n_lanes)
        elastic += load_lanes(density + i) * load_lanes(volume + i) *
                   (is_logarithmic ? load_lanes(ratio + i) : Lanes(1.));

      Lanes batch_stored = 0., batch_dissipated = 0.;
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + first;
      element.add_energies(variables.data(), batch_stored, batch_dissipated);
      const unsigned int n_valid = points.cells().n_valid(batch);
      const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
      stored += is_cell * batch_stored;
      dissipated += is_cell * batch_dissipated;
    }
    result.add("elastic energy", EnergyKind::stored,
               reduce(elastic) + integral_over_initial_volume(material_points, "pressure work"));
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored, reduce(stored));
    result.add("viscous dissipation", EnergyKind::artificial,
               reduce(dissipated) +
                   integral_over_initial_volume(material_points, BulkViscosity::dissipation_name));
    return result;
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::add_plastic_heat(Points &points, NodalVector &heat) const
  {
    tombolo::add_plastic_heat(points, plastic_heating, heat);
  }

  template <int dim, typename Element>
  double CellIntegration<dim, Element>::internal_power(const Points &points,
                                                       const unsigned int place,
                                                       const NodalVector &position,
                                                       const NodalVector &velocity,
                                                       const double time_increment) const
  {
    const unsigned int batch = place / n_lanes, lane = place % n_lanes;
    const std::size_t first = Points::first_point(batch);
    NodeValues x, v;
    points.gather(batch, position, x);
    points.gather(batch, velocity, v);
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        x[k][d] -= time_increment * v[k][d];
    typename Element::Work work;
    Lanes volume[n_points];
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);

    // A step of no duration gives the element's own forces; it is made with a copy, since cells of
    // the same batch remain.
    dealii::AlignedVector<double> copy(element_variables.size() * points_per_batch);
    Pointers variables;
    for (std::size_t c = 0; c < element_variables.size(); ++c)
    {
      variables.push_back(copy.data() + c * points_per_batch);
      std::copy_n(element_variables[c] + first, points_per_batch, variables.back());
    }
    Lanes spin[n_points][3];
    for (auto &of_point : spin)
      for (Lanes &component : of_point)
        component = 0.;
    element.advance(work, spin, 0., variables.data());

    Lanes stress[n_points][6];
    integrate_stress(points.material_points(), batch, stress);
    NodeValues force;
    element.integrate(work, stress, force);
    double power = 0;
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        power += force[k][d][lane] * v[k][d][lane];
    return power;
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::find_volumes(const Points &points, const unsigned int batch,
                                                   const NodalVector &position, NodeValues &x,
                                                   Lanes (&volume)[n_points]) const
  {
    NodeValues v;
    points.gather(batch, position, x);
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        v[k][d] = 0.;
    typename Element::Work work;
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);
  }

  template <int dim, typename Element>
  bool CellIntegration<dim, Element>::is_volume_positive(const Points &points,
                                                         const unsigned int place,
                                                         const NodalVector &position) const
  {
    NodeValues x;
    Lanes volume[n_points];
    find_volumes(points, place / n_lanes, position, x, volume);
    return std::all_of(volume, volume + n_points,
                       [&](const Lanes &of_point) { return of_point[place % n_lanes] > 0.; });
  }

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::note_failure(const Points &points, const unsigned int batch,
                                                   const NodeValues &x,
                                                   const Lanes (&volume)[n_points])
  {
    auto is_sound = volume[0] > 0.;
    for (unsigned int q = 1; q < n_points; ++q)
      is_sound = is_sound && volume[q] > 0.;
    if (all_of(is_sound) || !failure_message.empty())
      return;
    for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
      if (!is_sound[lane] && failure_message.empty())
        failure_message = describe_unusable_cell(points, batch, lane, x, volume);
  }
} // namespace tombolo
