// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/tributary_areas.h>

#include <algorithm>
#include <map>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  TributaryAreas<dim>::TributaryAreas(const unsigned int n_groups, const Nodes<dim> &nodes)
      : groups(n_groups), all_nodes(nodes.owned().size()),
        shapes(nodes.degree(), nodes.degree() + 1)
  {}

  template <int dim>
  void TributaryAreas<dim>::add_face(const unsigned int group,
                                     const std::vector<types::global_dof_index> &nodes,
                                     const double orientation)
  {
    AssertIndexRange(group, groups.size());
    AssertDimension(nodes.size(), shapes.n_nodes);
    faces.push_back({group, nodes, {}, {}, orientation});
    for (const types::global_dof_index node : nodes)
      all_nodes.add_index(node);
  }

  template <int dim>
  double TributaryAreas<dim>::orientation(const std::vector<Point<dim>> &nodes,
                                          const Point<dim> &inside) const
  {
    Tensor<1, dim> normal, centre;
    for (const Point<dim> &node : nodes)
      centre += node / static_cast<double>(nodes.size());
    for (unsigned int q = 0; q < shapes.weights.size(); ++q)
      normal +=
          shapes.weights[q] * shapes.normal(q, [&](const unsigned int k) { return nodes[k]; });
    return normal * (centre - inside) > 0. ? 1. : -1.;
  }

  template <int dim>
  void TributaryAreas<dim>::remove_faces_of(
      const std::vector<std::vector<types::global_dof_index>> &nodes_of_cells)
  {
    std::multimap<types::global_dof_index, const std::vector<types::global_dof_index> *> cell_of;
    for (const auto &cell : nodes_of_cells)
      for (const types::global_dof_index node : cell)
        cell_of.emplace(node, &cell);
    const auto is_of_cell = [](const Face &face, const std::vector<types::global_dof_index> &cell)
    {
      return std::all_of(face.global_nodes.begin(), face.global_nodes.end(),
                         [&](const types::global_dof_index node)
                         { return std::find(cell.begin(), cell.end(), node) != cell.end(); });
    };
    const auto is_removed = [&](const Face &face)
    {
      const auto candidates = cell_of.equal_range(face.global_nodes.front());
      return std::any_of(candidates.first, candidates.second,
                         [&](const auto &entry) { return is_of_cell(face, *entry.second); });
    };
    faces.erase(std::remove_if(faces.begin(), faces.end(), is_removed), faces.end());
  }

  template <int dim>
  IndexSet TributaryAreas<dim>::required_nodes() const
  {
    IndexSet result = all_nodes;
    result.compress();
    return result;
  }

  template <int dim>
  void TributaryAreas<dim>::set_partition(const NodePartition &partition)
  {
    std::vector<std::map<unsigned int, unsigned int>> place_of_node(groups.size());
    for (Group &group : groups)
      group.nodes.clear();
    for (Face &face : faces)
    {
      face.nodes.clear();
      face.places.clear();
      Group &group = groups[face.group];
      for (const types::global_dof_index global_node : face.global_nodes)
      {
        const unsigned int node = partition.local_index(global_node);
        const auto [place, is_new] = place_of_node[face.group].try_emplace(
            node, static_cast<unsigned int>(group.nodes.size()));
        if (is_new)
          group.nodes.push_back(node);
        face.nodes.push_back(node);
        face.places.push_back(place->second);
      }
    }
    for (Group &group : groups)
    {
      group.areas.assign(group.nodes.size(), 0.);
      group.outward_areas.assign(group.nodes.size(), Tensor<1, dim>());
    }
  }

  template <int dim>
  void TributaryAreas<dim>::update(const NodalVector &position)
  {
    for (Group &group : groups)
    {
      std::fill(group.areas.begin(), group.areas.end(), 0.);
      std::fill(group.outward_areas.begin(), group.outward_areas.end(), Tensor<1, dim>());
    }
    for (const Face &face : faces)
    {
      std::vector<double> &areas = groups[face.group].areas;
      std::vector<Tensor<1, dim>> &outward_areas = groups[face.group].outward_areas;
      for (unsigned int q = 0; q < shapes.weights.size(); ++q)
      {
        const Tensor<1, dim> normal =
            shapes.normal(q, [&](const unsigned int k) { return position.node(face.nodes[k]); });
        const double area = shapes.weights[q] * normal.norm();
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
        {
          areas[face.places[k]] += area * shapes.value(q, k);
          if (face.orientation != 0.)
            outward_areas[face.places[k]] +=
                face.orientation * shapes.weights[q] * shapes.value(q, k) * normal;
        }
      }
    }
  }

  template <int dim>
  std::vector<unsigned int>
  TributaryAreas<dim>::owned_nodes(const std::shared_ptr<const NodePartition> &partition) const
  {
    return owned_marked_nodes(partition,
                              [&](const auto &mark)
                              {
                                for (const Group &group : groups)
                                  std::for_each(group.nodes.begin(), group.nodes.end(), mark);
                              });
  }

  template class TributaryAreas<2>;
  template class TributaryAreas<3>;
} // namespace tombolo
