// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frozen_body.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    struct PatchErrors
    {
      double force = 0;  ///< largest at an inner node, over stress times area
      double stress = 0; ///< largest deviation of a stress, over the stress
    };

    /** One step of a uniform velocity gradient in a body between 0 and n along each axis, all parts
     * together. */
    template <int dim>
    PatchErrors patch_errors(const std::string &text, const std::vector<unsigned int> &n)
    {
      FrozenBody<dim> body(text);
      Model<dim> &model = *body.model;
      const double gradient[3][3] = {{2., 0.3, -0.2}, {0.5, -0.8, 0.4}, {-0.1, 0.6, 1.}};
      constexpr double time_increment = 1e-9;
      NodalVector velocity(model.state.partition()), force(model.state.partition());
      const unsigned int n_owned = model.state.partition()->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            velocity.node(i)[a] += gradient[a][b] * model.state.position.node(i)[b];
      velocity.update_ghosts();
      PatchErrors errors;
      double trace = 0;
      for (unsigned int d = 0; d < dim; ++d)
        trace += gradient[d][d];
      for (Part<dim> &part : model.parts)
      {
        part.formulation->add_internal_force({&model.state.position, &velocity, time_increment},
                                             force);
        const Material &material = part.formulation->material();
        const double shear = material.shear_modulus();
        const double lambda = material.bulk_modulus() - 2. / 3. * shear;
        const double scale = time_increment * material.bulk_modulus();
        const MaterialPoints &points = part.formulation->points();
        for (unsigned int i = 0; i < points.size(); ++i)
          if (points.component(MaterialPoints::volume, 0)[i] > 0.)
            for (unsigned int d = 0; d < dim; ++d)
              errors.stress = std::max(
                  errors.stress,
                  std::abs(points.component(MaterialPoints::stress, d)[i] -
                           time_increment * (lambda * trace + 2. * shear * gradient[d][d])) /
                      scale);
      }
      force.add_to_owners();
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        bool is_inside = true;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double x = model.state.position.node(i)[d];
          is_inside = is_inside && x > 1e-6 && x < n[d] - 1e-6;
        }
        for (unsigned int d = 0; d < dim && is_inside; ++d)
          errors.force = std::max(errors.force, std::abs(force.node(i)[d]) / time_increment);
      }
      errors.force = dealii::Utilities::MPI::max(errors.force, MPI_COMM_WORLD);
      errors.stress = dealii::Utilities::MPI::max(errors.stress, MPI_COMM_WORLD);
      return errors;
    }
  } // namespace testing
} // namespace tombolo
