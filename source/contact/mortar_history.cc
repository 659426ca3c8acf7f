// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_history.h>

#include <tombolo/state/state_archive.h>

#include <array>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MortarHistory<dim>::serialize(StateArchive &archive, const std::vector<unsigned int> &nodes,
                                     std::vector<MortarHistory> &histories)
  {
    using Values = std::vector<std::array<double, 3>>;
    const auto scalars =
        [&](const std::string &name, const auto &first, const auto &second, const auto &third)
    {
      Values values;
      for (MortarHistory &history : histories)
        values.push_back({{first(history), second(history), third(history)}});
      archive.nodal(name, nodes, values);
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
      archive.nodal(name, nodes, values);
      for (std::size_t k = 0; k < histories.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          vector(histories[k])[d] = values[k][d];
    };
    using History = MortarHistory;
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
    for (const MortarHistory &history : histories)
      bonded.push_back({{history.is_bonded ? 1. : 0., 0., 0.}});
    archive.nodal("is bonded", nodes, bonded);
    for (std::size_t k = 0; k < histories.size(); ++k)
      histories[k].is_bonded = bonded[k][0] > 0.;
  }

  template struct MortarHistory<2>;
  template struct MortarHistory<3>;
} // namespace tombolo
