// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_areas.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ContactAreas<dim>::ContactAreas(const Nodes<dim> &nodes,
                                  const std::set<types::boundary_id> &boundaries,
                                  const std::vector<unsigned int> &candidates,
                                  const std::vector<double> &volume)
      : faces(nodes, boundaries)
  {
    for (const unsigned int node : candidates)
      inner_area.push_back(std::pow(volume[node], (dim - 1.) / dim));
  }

  template class ContactAreas<2>;
  template class ContactAreas<3>;
} // namespace tombolo
