// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_stiffness.h>

#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <memory>

namespace tombolo
{
  template <int dim>
  void find_particle_equations(const Stencils &shape, const std::vector<double> &initial_volume,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take)
  {
    using Stiffness = RowStiffness<dim, 1>;
    const auto stiffness = std::make_unique<Stiffness>(material, input.time_increment);
    alignas(64) double temperature[n_lanes];
    typename Stiffness::Gradients gradients;
    for (unsigned int first = 0; first < shape.n_particles(); first += n_lanes)
    {
      const unsigned int n = std::min<unsigned int>(n_lanes, shape.n_particles() - first);
      Matrix3<Lanes> &deformation = gradients.deformation[0];
      RowBlock::gather_gradients<dim>(shape, first, n, input.position->data(),
                                      input.velocity->data(), deformation,
                                      gradients.displacement[0]);
      for (Lanes &entry : gradients.displacement[0].entry)
        entry *= input.time_increment;
      gradients.volume[0] = 0.;
      gradients.is_deformed = 0.;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        temperature[lane] = 0.;
        if (lane >= n)
          continue;
        gradients.volume[0][lane] = initial_volume[first + lane];
        if (material.plastic_heating->is_on())
          temperature[lane] = *input.temperature->node(shape.particle_node[first + lane]);
        if (shape.is_undeformed(first + lane))
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              deformation(i, j)[lane] = i == j ? 1. : 0.;
        else
          gradients.is_deformed[lane] = 1.;
      }
      stiffness->find(first, gradients, temperature);
      for (unsigned int lane = 0; lane < n; ++lane)
        stiffness->hand_over(lane, {{shape.row(first + lane)}}, take);
    }
  }

  template void find_particle_equations<2>(const Stencils &, const std::vector<double> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);
  template void find_particle_equations<3>(const Stencils &, const std::vector<double> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);
} // namespace tombolo
