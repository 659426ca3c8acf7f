// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_contact.h>

#include <tombolo/state/state_archive.h>

#include <array>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MortarContact<dim>::serialize_histories(StateArchive &archive)
  {
    using Values = std::vector<std::array<double, 3>>;
    const auto scalars =
        [&](const std::string &name, const auto &first, const auto &second, const auto &third)
    {
      Values values;
      for (NodeHistory &history : histories)
        values.push_back({{first(history), second(history), third(history)}});
      archive.nodal(name, slaves.owned_nodes(), values);
      for (std::size_t k = 0; k < histories.size(); ++k)
      {
        first(histories[k]) = values[k][0];
        second(histories[k]) = values[k][1];
        third(histories[k]) = values[k][2];
      }
    };
    const auto vectors = [&](const std::string &name, const auto &vector)
    {
      Values values(histories.size());
      for (std::size_t k = 0; k < histories.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          values[k][d] = vector(histories[k])[d];
      archive.nodal(name, slaves.owned_nodes(), values);
      for (std::size_t k = 0; k < histories.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          vector(histories[k])[d] = values[k][d];
    };
    using History = NodeHistory;
    scalars(
        "stiffness, depth, damping force",
        [](History &h) -> double & { return h.spring.stiffness; },
        [](History &h) -> double & { return h.spring.depth; },
        [](History &h) -> double & { return h.spring.damping_force; });
    scalars(
        "gap, area, offset", [](History &h) -> double & { return h.gap; },
        [](History &h) -> double & { return h.area; },
        [](History &h) -> double & { return h.offset; });
    vectors("elastic slip", [](History &h) -> Tensor<1, dim> & { return h.spring.elastic_slip; });
    vectors("traction", [](History &h) -> Tensor<1, dim> & { return h.traction; });
    vectors("normal", [](History &h) -> Tensor<1, dim> & { return h.normal; });
    Values bonded;
    for (const NodeHistory &history : histories)
      bonded.push_back({{history.is_bonded ? 1. : 0., 0., 0.}});
    archive.nodal("is bonded", slaves.owned_nodes(), bonded);
    for (std::size_t k = 0; k < histories.size(); ++k)
      histories[k].is_bonded = bonded[k][0] > 0.;
  }

  template <int dim>
  void MortarContact<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("body contact " + contact_name);
    archive("mass per area", mass_per_area);
    archive("stiffness", stiffness);
    std::vector<double *> shares{&friction_heat, &damping_heat, &conducted_heat};
    for (unsigned int d = 0; d < dim; ++d)
      shares.insert(shares.end(), {&impulse[d], &force_sum[d]});
    archive.sums("heat, work and impulse", shares);
    serialize_histories(archive);
    const auto areas = [&](const std::string &name, const std::vector<unsigned int> &nodes,
                           std::vector<double> &area)
    {
      std::vector<std::array<double, 3>> values(nodes.size());
      for (std::size_t k = 0; k < area.size(); ++k)
        values[k][0] = area[k];
      archive.nodal(name, nodes, values);
      area.clear();
      for (const auto &value : values)
        area.push_back(value[0]);
    };
    areas("areas of the slave", slaves.owned_nodes(), slave_areas);
    areas("areas of the master", masters.owned_nodes(), master_areas);
  }

  template void MortarContact<2>::serialize(StateArchive &);
  template void MortarContact<3>::serialize(StateArchive &);
} // namespace tombolo
