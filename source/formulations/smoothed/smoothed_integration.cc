// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_integration.h>

#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/logarithmic_points.h>
#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <type_traits>

namespace tombolo
{
  using namespace dealii;

  /** The motion of a batch of cells. */
  template <int dim>
  template <unsigned int n_points>
  struct SmoothedIntegration<dim>::BatchMotion
  {
    static constexpr unsigned int size = n_points * n_lanes;

    Matrix3<Lanes> inverse_transpose[n_points]; // F⁻ᵀ
    Matrix3<Lanes> gradient[n_points];          // L, the dilatation shared
    Lanes shared[n_points];                     // what that added to the diagonal
    Lanes volume[n_points];                     // det F V_q, of unused lanes too
    alignas(64) double columns[size][3][node_stride];
    alignas(64) double strain[6][size];
    alignas(64) double factor[size]; // of work, logarithmic measure
  };

  template <int dim>
  void SmoothedIntegration<dim>::declare_parameters(ParameterHandler &handler)
  {
    declare_strain_measure(handler, StrainMeasure::logarithmic);
    declare<BulkViscosity>(handler);
  }

  template <int dim>
  SmoothedIntegration<dim>::SmoothedIntegration(const Section &section)
      : bulk_viscosity(section), measure(read_strain_measure(section))
  {}

  template <int dim>
  void SmoothedIntegration<dim>::initialize(const PartSetup<dim> &setup,
                                            const SmoothedGradients<dim> &of_part,
                                            const CellBatches<dim> &batches)
  {
    part_material = setup.material;
    thermal_properties = setup.heat;
    rows = &of_part;
    cells = &batches;
    material_points.reinit(0, {});
    if (!setup.has_mechanics)
      return;
    plastic_heating.set(setup.heat, *part_material);
    std::vector<FieldDescription> variables = part_material->internal_variables();
    const std::size_t n_material_fields = MaterialPoints::n_standard_fields + variables.size();
    for (const std::vector<FieldDescription> &fields :
         {bulk_viscosity.variables(), plastic_heating.variables()})
      variables.insert(variables.end(), fields.begin(), fields.end());
    const std::vector<double> &volumes = rows->volumes();
    const unsigned int n_points = rows->n_points_per_cell();
    material_points.reinit(setup.void_cells != nullptr
                               ? cells->n_batches_of_places() * n_points * n_lanes
                               : static_cast<unsigned int>(volumes.size()),
                           variables);
    material_variables.clear();
    for (unsigned int f = MaterialPoints::n_standard_fields; f < n_material_fields; ++f)
      for (unsigned int c = 0; c < material_points.fields()[f].n_components; ++c)
        material_variables.push_back(material_points.component(f, c));
    for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells->n_valid(batch); ++lane)
        {
          const unsigned int point = (batch * n_points + q) * n_lanes + lane;
          material_points.component(MaterialPoints::volume, 0)[point] = volumes[point];
        }
    bulk_viscosity.initialize(*part_material, dim, material_points);
    plastic_heating.initialize(material_points);
  }

  template <int dim>
  template <typename Use>
  void SmoothedIntegration<dim>::with_points(const Use &use) const
  {
    switch (rows->n_points_per_cell())
    {
    case 1:
      use(std::integral_constant<unsigned int, 1>());
      break;
    case 4:
      use(std::integral_constant<unsigned int, 4>());
      break;
    default:
      if constexpr (dim == 3)
        use(std::integral_constant<unsigned int, 8>());
    }
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::find_motion(const unsigned int batch, const NodalVector &position,
                                             const NodalVector &velocity,
                                             BatchMotion<n_points> &motion) const
  {
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Matrix3<Lanes> deformation, gradient;
      RowBlock::gather_gradients<dim>(rows->stencils(),
                                      (std::size_t(batch) * n_points + q) * n_lanes, n_lanes,
                                      position.data(), velocity.data(), deformation, gradient);
      Lanes det;
      const Matrix3<Lanes> inverse_deformation = inverse(deformation, det);
      motion.inverse_transpose[q] = RowBlock::transposed(inverse_deformation);
      motion.gradient[q] = multiply(gradient, inverse_deformation);
      motion.volume[q] =
          det * load_lanes(rows->volumes().data() + (std::size_t(batch) * n_points + q) * n_lanes);
    }
    MeanDilatation::share_gradient<dim>(motion.volume, motion.gradient, motion.shared);
  }

  template <int dim>
  void SmoothedIntegration<dim>::take_volumes(const NodalVector &position,
                                              const std::vector<bool> &are_new)
  {
    with_points(
        [&](const auto number)
        {
          constexpr unsigned int n_points = decltype(number)::value;
          BatchMotion<n_points> motion;
          for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
          {
            find_motion(batch, position, position, motion); // of which the volumes matter
            LogarithmicPoints::take_volumes(material_points,
                                            std::size_t(batch) * n_points * n_lanes, motion.volume,
                                            measure == StrainMeasure::logarithmic, are_new);
          }
        });
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::advance_motion(const unsigned int batch,
                                                const MechanicalInput &input,
                                                BatchMotion<n_points> &motion)
  {
    find_motion(batch, *input.position, *input.velocity, motion);
    note_failure(batch, input, motion);
    const std::size_t first = std::size_t(batch) * n_points * n_lanes;
    const bool is_logarithmic = measure == StrainMeasure::logarithmic;
    double *const volumes = material_points.component(MaterialPoints::volume, 0) + first;
    double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0) + first;
    alignas(64) double bulk[n_lanes * n_points], shear[n_lanes * n_points];
    if (is_logarithmic)
    {
      const double *const temperature = plastic_heating.temperature(material_points);
      part_material->elastic_moduli(
          n_points * n_lanes, temperature == nullptr ? nullptr : temperature + first, bulk, shear);
    }
    const Lanes growth =
        is_logarithmic ? LogarithmicPoints::growth_of_cell(volumes, motion.volume) : Lanes(1.);
    MotionIncrement<Lanes> increments[n_points];
    for (unsigned int q = 0; q < n_points; ++q)
    {
      // The middle of the step is that of the motion itself, as in FullyIntegratedHexahedron.
      Matrix3<Lanes> h = motion.gradient[q];
      for (unsigned int i = 0; i < dim; ++i)
        h(i, i) -= motion.shared[q];
      for (Lanes &entry : h.entry)
        entry *= input.time_increment;
      const unsigned int i = q * n_lanes;
      increments[q] = is_logarithmic
                          ? LogarithmicPoints::begin(material_points, first + i, h,
                                                     load_lanes(bulk + i), load_lanes(shear + i))
                          : motion_increment(h);
    }
    if (is_logarithmic)
      MeanDilatation::share_logarithmic<dim>(motion.volume, increments);
    else
      MeanDilatation::share_strain<dim>(motion.volume, increments);
    const unsigned int n_valid = cells->n_valid(batch);
    const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const MotionIncrement<Lanes> &increment = increments[q];
      const unsigned int i = q * n_lanes;
      store_lanes(load_lanes(ratio + i) * increment.volume_factor, ratio + i);
      store_lanes(is_logarithmic ? load_lanes(volumes + i) * growth : is_cell * motion.volume[q],
                  volumes + i);
      store_lanes(work_factor(increment), motion.factor + i);
      Lanes stress[6];
      for (unsigned int c = 0; c < 6; ++c)
      {
        store_lanes(increment.strain[c], motion.strain[c] + i);
        stress[c] = load_lanes(material_points.component(MaterialPoints::stress, c) + first + i);
      }
      rotate(increment.spin, stress);
      for (unsigned int c = 0; c < 6; ++c)
        store_lanes(stress[c], material_points.component(MaterialPoints::stress, c) + first + i);
    }
  }

  template <int dim>
  void SmoothedIntegration<dim>::add_internal_force(const MechanicalInput &input,
                                                    NodalVector &force)
  {
    failure_message.clear();
    with_points(
        [&](const auto n_points) {
          this->template add_force_of_points<std::decay_t<decltype(n_points)>::value>(input, force);
        });
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::add_force_of_points(const MechanicalInput &input,
                                                     NodalVector &force)
  {
    constexpr unsigned int batch_size = n_points * n_lanes;
    const bool is_logarithmic = measure == StrainMeasure::logarithmic;
    BatchMotion<n_points> motion;
    alignas(64) double nodal_temperature[batch_size], temperature_increment[batch_size];
    MaterialBatch material_batch;
    material_batch.n = batch_size;
    material_batch.time_increment = input.time_increment;
    material_batch.measure = measure;
    material_batch.internal_variables.resize(material_variables.size());
    for (unsigned int c = 0; c < 6; ++c)
      material_batch.strain_increment[c] = motion.strain[c];
    for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
    {
      advance_motion(batch, input, motion);
      const std::size_t first = std::size_t(batch) * batch_size;
      for (unsigned int c = 0; c < 6; ++c)
        material_batch.stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      material_batch.relative_volume =
          material_points.component(MaterialPoints::volume_ratio, 0) + first;
      material_batch.volume_ratio = is_logarithmic ? motion.factor : material_batch.relative_volume;
      for (std::size_t c = 0; c < material_variables.size(); ++c)
        material_batch.internal_variables[c] = material_variables[c] + first;
      if (plastic_heating.is_on())
      {
        rows->interpolate(cells->nodes(batch), *input.temperature, nodal_temperature);
        plastic_heating.advance(material_points, first, batch_size, nodal_temperature,
                                input.time_increment == 0., temperature_increment);
        material_batch.temperature = plastic_heating.temperature(material_points) + first;
        material_batch.temperature_increment = temperature_increment;
      }
      part_material->update_stress(material_batch);
      if (is_logarithmic)
        LogarithmicPoints::complete(material_points, first, batch_size);
      if (bulk_viscosity.is_on())
        bulk_viscosity.advance(material_points, first, batch_size, material_batch.strain_increment,
                               input.time_increment);
      Lanes stress[n_points][6];
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
      scatter(batch, stress, motion, force);
    }
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::scatter(const unsigned int batch,
                                         const Lanes (&stress)[n_points][6],
                                         BatchMotion<n_points> &motion, NodalVector &force) const
  {
    constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    const Lanes mean = MeanDilatation::mean_pressure<dim>(motion.volume, stress);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const Lanes difference =
          motion.volume[q] * mean - (1. / dim) * MeanDilatation::trace_in_plane<dim>(stress[q]);
      Matrix3<Lanes> cauchy;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          cauchy(i, j) = stress[q][component[i][j]];
      for (unsigned int i = 0; i < dim; ++i)
        cauchy(i, i) += difference;
      RowBlock::store_columns(multiply(cauchy, motion.inverse_transpose[q]),
                              motion.columns[q * n_lanes][0]);
    }
    const Stencils &stencils = rows->stencils();
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int lane = 0; lane < cells->n_valid(batch); ++lane)
        RowBlock::subtract_row(stencils.row((batch * n_points + q) * n_lanes + lane),
                               motion.columns[q * n_lanes + lane][0], force.data());
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::note_failure(const unsigned int batch,
                                              const MechanicalInput &input,
                                              const BatchMotion<n_points> &motion)
  {
    for (unsigned int lane = 0; lane < cells->n_valid(batch); ++lane)
      for (unsigned int q = 0; q < n_points; ++q)
        if (!(motion.volume[q][lane] > 0.) && failure_message.empty())
        {
          constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
          Point<dim> centre;
          for (unsigned int k = 0; k < n_corners; ++k)
            for (unsigned int d = 0; d < dim; ++d)
              centre[d] +=
                  input.position->node(cells->nodes(batch)[k * n_lanes + lane])[d] / n_corners;
          failure_message = describe_unusable_cell<dim>(centre, centre, motion.volume[q][lane]);
        }
  }

  template <int dim>
  void SmoothedIntegration<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                         const NodalVector &velocity,
                                                         const double time_step,
                                                         NodalVector &force) const
  {
    with_points(
        [&](const auto n_points)
        {
          this->template apply_stiffness_of_points<std::decay_t<decltype(n_points)>::value>(
              position, velocity, time_step, force);
        });
  }

  template <int dim>
  template <unsigned int n_points>
  void SmoothedIntegration<dim>::apply_stiffness_of_points(const NodalVector &position,
                                                           const NodalVector &velocity,
                                                           const double time_step,
                                                           NodalVector &force) const
  {
    const PointStiffness stiffness(*part_material, material_points, measure);
    BatchMotion<n_points> motion;
    for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
    {
      find_motion(batch, position, velocity, motion);
      Lanes stress[n_points][6];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const std::size_t i = (std::size_t(batch) * n_points + q) * n_lanes;
        Lanes volume = -motion.volume[q];          // scatter() subtracts
        if (measure == StrainMeasure::logarithmic) // of the Kirchhoff stress
          volume /= load_lanes(material_points.component(MaterialPoints::volume_ratio, 0) + i);
        Lanes modulus = stiffness.lambda(i);
        if (bulk_viscosity.is_on())
          modulus += 2. / time_step * load_lanes(bulk_viscosity.tangent(material_points) + i);
        stiffness.find_stress(motion.gradient[q], volume, modulus, stress[q]);
      }
      scatter(batch, stress, motion, force);
    }
  }

  template <int dim>
  void SmoothedIntegration<dim>::find_cell_equations(
      const MechanicalInput &input, const std::function<void(const CellEquations &)> &take)
  {
    with_points(
        [&](const auto number)
        {
          constexpr unsigned int n_points = decltype(number)::value;
          using Stiffness = RowStiffness<dim, n_points>;
          constexpr unsigned int batch_size = n_points * n_lanes;
          const RowMaterial material{part_material.get(), measure,
                                     &plastic_heating,    &material_points,
                                     material_variables,  true};
          const auto stiffness = std::make_unique<Stiffness>(material, input.time_increment);
          const Stencils &stencils = rows->stencils();
          alignas(64) double temperature[batch_size];
          typename Stiffness::Gradients gradients;
          for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
          {
            const std::size_t first = std::size_t(batch) * batch_size;
            for (unsigned int q = 0; q < n_points; ++q)
            {
              RowBlock::gather_gradients<dim>(stencils, first + q * n_lanes, n_lanes,
                                              input.position->data(), input.velocity->data(),
                                              gradients.deformation[q], gradients.displacement[q]);
              for (Lanes &entry : gradients.displacement[q].entry)
                entry *= input.time_increment;
              gradients.volume[q] = load_lanes(rows->volumes().data() + first + q * n_lanes);
            }
            if (plastic_heating.is_on())
              rows->interpolate(cells->nodes(batch), *input.temperature, temperature);
            stiffness->find(first, gradients, temperature);
            for (unsigned int lane = 0; lane < cells->n_valid(batch); ++lane)
            {
              std::array<Stencils::Row, n_points> of_cell{};
              for (unsigned int q = 0; q < n_points; ++q)
                of_cell[q] = stencils.row(static_cast<unsigned int>(first) + q * n_lanes + lane);
              stiffness->hand_over(lane, of_cell, take);
            }
          }
        });
  }

  template <int dim>
  void SmoothedIntegration<dim>::add_plastic_heat(NodalVector &heat, std::vector<double> &of_cells)
  {
    of_cells.assign(cells->n_cells(), 0.);
    if (!plastic_heating.has_plastic_heat())
      return;
    const std::vector<std::vector<double>> &shares = rows->corner_shares();
    for (unsigned int batch = 0; batch < cells->n_batches(); ++batch)
      for (std::size_t q = 0; q < shares.size(); ++q)
        for (unsigned int lane = 0; lane < cells->n_valid(batch); ++lane)
        {
          const double given = plastic_heating.give(
              material_points,
              static_cast<unsigned int>((batch * shares.size() + q) * n_lanes + lane));
          of_cells[cells->cell_at(batch * n_lanes + lane)] += given;
          for (unsigned int k = 0; k < shares[q].size(); ++k)
            *heat.node(cells->nodes(batch)[k * n_lanes + lane]) += shares[q][k] * given;
        }
  }

  template <int dim>
  EnergyAccounts SmoothedIntegration<dim>::energies() const
  {
    const unsigned int n = material_points.padded_size();
    std::vector<double> density(n);
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = material_points.component(MaterialPoints::stress, c);
    part_material->elastic_energy_density(n, stress, plastic_heating.temperature(material_points),
                                          density.data());
    const double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    double elastic = 0;
    for (unsigned int i = 0; i < n; ++i)
      elastic += density[i] * volume[i] * (measure == StrainMeasure::logarithmic ? ratio[i] : 1.);
    EnergyAccounts result;
    result.add("elastic energy", EnergyKind::stored,
               elastic + integral_over_initial_volume(material_points, "pressure work"));
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored, 0.);
    result.add("viscous dissipation", EnergyKind::artificial,
               integral_over_initial_volume(material_points, BulkViscosity::dissipation_name));
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(material_points, "thermal work"));
    return result;
  }

  template <int dim>
  Lanes SmoothedIntegration<dim>::squared_speed(const unsigned int batch) const
  {
    const PointStiffness stiffness(*part_material, material_points, StrainMeasure::rate);
    const unsigned int n_points = rows->n_points_per_cell();
    Lanes largest = 0.;
    for (unsigned int q = 0; q < n_points; ++q)
      largest =
          max(largest, stiffness.squared_speed((std::size_t(batch) * n_points + q) * n_lanes));
    return largest;
  }

  template class SmoothedIntegration<2>;
  template class SmoothedIntegration<3>;
} // namespace tombolo
