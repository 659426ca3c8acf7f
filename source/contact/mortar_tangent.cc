// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_tangent.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void add_mortar_stiffness(const MortarContact<dim> &contact, const NodalVector &position,
                            std::vector<ContactStiffness<dim>> &result)
  {
    const std::shared_ptr<const NodePartition> &partition = position.partition();
    const std::vector<MortarHistory<dim>> &histories = contact.node_histories();
    const std::vector<unsigned int> &nodes = contact.slave_faces().owned_nodes();
    const NodalVector normals =
        nodal_field(partition, Quantity::vector, nodes,
                    [&](const std::size_t k, double *const value)
                    { std::copy_n(histories[k].normal.begin_raw(), dim, value); });
    // Zero across planes of symmetry, as what segments add there.
    const NodalVector kept =
        nodal_field(partition, Quantity::vector, nodes,
                    [](const std::size_t, double *const value) { std::fill_n(value, dim, 1.); });
    ContactRows<dim> rows;
    contact.mortar_segments().add_weights(normals, rows);
    if (!contact.is_tied())
    {
      const NodalVector pressed =
          nodal_field(partition, Quantity::vector, nodes,
                      [&](const std::size_t k, double *const value)
                      {
                        if (!histories[k].spring.is_closed())
                          return;
                        std::copy_n(histories[k].normal.begin_raw(), dim, value);
                        value[node_stride - 1] = -histories[k].gap;
                      });
      contact.mortar_segments().add_changes_of_weights(position, pressed, rows);
    }
    rows.collect(*partition);
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      const MortarHistory<dim> &history = histories[k];
      if (!(history.spring.is_closed() && history.area > 0.))
        continue;
      ContactStiffness<dim> stiffness;
      stiffness.node = nodes[k];
      stiffness.entries = rows.row(partition->global_index(stiffness.node));
      stiffness.direction = history.normal;
      stiffness.is_tied = contact.is_tied() || history.is_bonded;
      if (stiffness.is_tied)
      {
        stiffness.normal = history.spring.stiffness / history.area;
        for (unsigned int d = 0; d < dim; ++d)
          stiffness.along[d][d] = stiffness.normal;
        stiffness.along -= stiffness.normal * outer_product(history.normal, history.normal);
      }
      else
        add_spring(history.spring, 1. / history.area, stiffness);
      stiffness.keep(kept.node(stiffness.node));
      result.push_back(std::move(stiffness));
    }
  }

  template void add_mortar_stiffness(const MortarContact<2> &, const NodalVector &,
                                     std::vector<ContactStiffness<2>> &);
  template void add_mortar_stiffness(const MortarContact<3> &, const NodalVector &,
                                     std::vector<ContactStiffness<3>> &);
} // namespace tombolo
