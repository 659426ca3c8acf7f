// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_formulation.h>

namespace tombolo
{
  template <int dim>
  void ParticleFormulation<dim>::add_mass(NodalVector &mass) const
  {
    const Stencils &shape = stencils();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      *mass.node(shape.particle_node[i]) += shape.mass[i];
  }

  template <int dim>
  void ParticleFormulation<dim>::point_positions(const NodalVector &position,
                                                 std::vector<Point<dim>> &points) const
  {
    const Stencils &shape = stencils();
    points.resize(shape.n_particles());
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        points[i][d] = position.node(shape.particle_node[i])[d];
  }

  template class ParticleFormulation<2>;
  template class ParticleFormulation<3>;
} // namespace tombolo
