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
    const std::vector<MortarHistory<dim>> &histories = contact.state().histories;
    const std::vector<unsigned int> &nodes = contact.slave_faces().owned_nodes();
    NodalVector normals, kept;
    normals.reinit(partition);
    kept.reinit(partition);
    for (std::size_t k = 0; k < histories.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
      {
        normals.node(nodes[k])[d] = histories[k].normal[d];
        kept.node(nodes[k])[d] = 1.;
      }
    normals.update_ghosts();
    kept.update_ghosts(); // zero across planes of symmetry, as what segments add there
    ContactRows<dim> rows;
    contact.mortar_segments().add_weights(normals, rows);
    if (!contact.is_tied())
    {
      NodalVector pressed;
      pressed.reinit(partition);
      for (std::size_t k = 0; k < histories.size(); ++k)
        if (histories[k].spring.is_closed())
        {
          for (unsigned int d = 0; d < dim; ++d)
            pressed.node(nodes[k])[d] = histories[k].normal[d];
          pressed.node(nodes[k])[node_stride - 1] = -histories[k].gap;
        }
      pressed.update_ghosts();
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
