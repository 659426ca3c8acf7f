// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/penalty_contact.h>

#include <tombolo/state/state_archive.h>

#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void PenaltyContact<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("contact " + contact_name);
    std::vector<double *> shares{&friction_heat, &damping_heat, &surface_work, &translation_work};
    for (unsigned int d = 0; d < dim; ++d)
    {
      shares.push_back(&impulse[d]);
      shares.push_back(&force_sum[d]);
    }
    for (unsigned int c = 0; c < 3; ++c)
    {
      shares.push_back(&angular_impulse[c]);
      shares.push_back(&torque_sum[c]);
    }
    archive.sums("heat, work and impulse", shares);

    std::vector<std::array<double, 3>> scalars, slips, forces, positions;
    const auto components = [](const Tensor<1, dim> &vector)
    {
      std::array<double, 3> result{};
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = vector[d];
      return result;
    };
    for (const NodeHistory &history : histories)
    {
      scalars.push_back(
          {{history.spring.stiffness, history.spring.depth, history.spring.damping_force}});
      slips.push_back(components(history.spring.elastic_slip));
      forces.push_back(components(history.force));
      positions.push_back(components(history.position));
    }
    archive.nodal("stiffness, depth, damping force", candidates, scalars);
    archive.nodal("bond", candidates, slips);
    archive.nodal("force", candidates, forces);
    archive.nodal("position", candidates, positions);
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      NodeHistory &history = histories[k];
      history.spring.stiffness = scalars[k][0];
      history.spring.depth = scalars[k][1];
      history.spring.damping_force = scalars[k][2];
      for (unsigned int d = 0; d < dim; ++d)
      {
        history.spring.elastic_slip[d] = slips[k][d];
        history.force[d] = forces[k][d];
        history.position[d] = positions[k][d];
      }
    }
    surface->translation().serialize(archive);
    if (!settings.has_heat)
      return;
    if (tool_heat)
      tool_heat->serialize(archive);
    std::vector<std::array<double, 3>> heat;
    for (const double value : pending_heat)
      heat.push_back({{value, 0., 0.}});
    archive.nodal("heat to give", candidates, heat);
    for (std::size_t k = 0; k < pending_heat.size(); ++k)
      pending_heat[k] = heat[k][0];
  }

  template void PenaltyContact<2>::serialize(StateArchive &);
  template void PenaltyContact<3>::serialize(StateArchive &);
} // namespace tombolo
