// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_node.h>

#include <tombolo/state/state_archive.h>

#include <array>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void serialize_mortar_nodes(const std::vector<unsigned int> &owned_nodes,
                              std::vector<MortarNode<dim>> &kept, StateArchive &archive)
  {
    using Values = std::vector<std::array<double, 3>>;
    const auto scalars =
        [&](const std::string &name, const auto &first, const auto &second, const auto &third)
    {
      Values values;
      for (MortarNode<dim> &history : kept)
        values.push_back({{first(history), second(history), third(history)}});
      archive.nodal(name, owned_nodes, values);
      for (std::size_t k = 0; k < kept.size(); ++k)
      {
        first(kept[k]) = values[k][0];
        second(kept[k]) = values[k][1];
        third(kept[k]) = values[k][2];
      }
    };
    const auto vectors = [&](const std::string &name, const auto &vector)
    {
      Values values(kept.size());
      for (std::size_t k = 0; k < kept.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          values[k][d] = vector(kept[k])[d];
      archive.nodal(name, owned_nodes, values);
      for (std::size_t k = 0; k < kept.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          vector(kept[k])[d] = values[k][d];
    };
    using History = MortarNode<dim>;
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
    for (const MortarNode<dim> &history : kept)
      bonded.push_back({{history.is_bonded ? 1. : 0., 0., 0.}});
    archive.nodal("is bonded", owned_nodes, bonded);
    for (std::size_t k = 0; k < kept.size(); ++k)
      kept[k].is_bonded = bonded[k][0] > 0.;
  }

  void serialize_areas(const std::string &name, const std::vector<unsigned int> &owned_nodes,
                       std::vector<double> &areas, StateArchive &archive)
  {
    std::vector<std::array<double, 3>> values(owned_nodes.size());
    for (std::size_t k = 0; k < areas.size(); ++k)
      values[k][0] = areas[k];
    archive.nodal(name, owned_nodes, values);
    areas.clear();
    for (const auto &value : values)
      areas.push_back(value[0]);
  }

  template void serialize_mortar_nodes(const std::vector<unsigned int> &,
                                       std::vector<MortarNode<2>> &, StateArchive &);
  template void serialize_mortar_nodes(const std::vector<unsigned int> &,
                                       std::vector<MortarNode<3>> &, StateArchive &);
} // namespace tombolo
