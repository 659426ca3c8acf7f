#include <tombolo/boundary/tributary_areas.h>

#include <tombolo/boundary/place.h>

#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <map>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  TributaryAreas<dim>::TributaryAreas(const unsigned int n_groups, const Nodes<dim> &nodes)
      : groups(n_groups), all_nodes(nodes.owned().size())
  {
    prepare_quadrature(nodes.degree());
  }

  template <int dim>
  void TributaryAreas<dim>::prepare_quadrature(const unsigned int degree)
  {
    const QGaussLobatto<1> support_points(degree + 1);
    const auto polynomials =
        Polynomials::generate_complete_Lagrange_basis(support_points.get_points());
    const QGauss<dim - 1> quadrature(degree + 1);
    const unsigned int n = degree + 1;
    nodes_per_face = dim == 2 ? n : n * n;
    std::vector<double> value_and_derivative(2);
    for (unsigned int q = 0; q < quadrature.size(); ++q)
    {
      quadrature_weights.push_back(quadrature.weight(q));
      std::vector<double> values[2], derivatives[2];
      for (unsigned int d = 0; d < dim - 1; ++d)
        for (unsigned int i = 0; i < n; ++i)
        {
          polynomials[i].value(quadrature.point(q)[d], value_and_derivative);
          values[d].push_back(value_and_derivative[0]);
          derivatives[d].push_back(value_and_derivative[1]);
        }
      for (unsigned int k = 0; k < nodes_per_face; ++k)
        shape_values.push_back(dim == 2 ? values[0][k] : values[0][k % n] * values[1][k / n]);
      for (unsigned int d = 0; d < dim - 1; ++d)
        for (unsigned int k = 0; k < nodes_per_face; ++k)
          shape_derivatives.push_back(dim == 2 ? derivatives[0][k]
                                      : d == 0 ? derivatives[0][k % n] * values[1][k / n]
                                               : values[0][k % n] * derivatives[1][k / n]);
    }
  }

  template <int dim>
  void TributaryAreas<dim>::add_face(const unsigned int group,
                                     const std::vector<types::global_dof_index> &nodes)
  {
    AssertIndexRange(group, groups.size());
    AssertDimension(nodes.size(), nodes_per_face);
    faces.push_back({group, nodes, {}, {}});
    for (const types::global_dof_index node : nodes)
      all_nodes.add_index(node);
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
      group.areas.assign(group.nodes.size(), 0.);
  }

  template <int dim>
  void TributaryAreas<dim>::update(const NodalVector &position)
  {
    for (Group &group : groups)
      std::fill(group.areas.begin(), group.areas.end(), 0.);
    for (const Face &face : faces)
    {
      std::vector<double> &areas = groups[face.group].areas;
      for (unsigned int q = 0; q < quadrature_weights.size(); ++q)
      {
        Tensor<1, dim> tangents[dim - 1];
        for (unsigned int d = 0; d < dim - 1; ++d)
          for (unsigned int k = 0; k < nodes_per_face; ++k)
            tangents[d] += shape_derivatives[(q * (dim - 1) + d) * nodes_per_face + k] *
                           point_of<dim>(position.node(face.nodes[k]));
        double area = quadrature_weights[q];
        if constexpr (dim == 2)
          area *= tangents[0].norm();
        else
          area *= cross_product_3d(tangents[0], tangents[1]).norm();
        for (unsigned int k = 0; k < nodes_per_face; ++k)
          areas[face.places[k]] += area * shape_values[q * nodes_per_face + k];
      }
    }
  }

  template <int dim>
  const std::vector<unsigned int> &TributaryAreas<dim>::nodes(const unsigned int group) const
  {
    return groups[group].nodes;
  }

  template <int dim>
  const std::vector<double> &TributaryAreas<dim>::areas(const unsigned int group) const
  {
    return groups[group].areas;
  }

  template <int dim>
  std::vector<unsigned int>
  TributaryAreas<dim>::owned_nodes(const std::shared_ptr<const NodePartition> &partition) const
  {
    NodalVector mark;
    mark.reinit(partition, 1);
    for (const Group &group : groups)
      for (const unsigned int node : group.nodes)
        *mark.node(node) = 1.;
    mark.add_to_owners();
    std::vector<unsigned int> result;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*mark.node(i) > 0.)
        result.push_back(i);
    return result;
  }

  template class TributaryAreas<2>;
  template class TributaryAreas<3>;
} // namespace tombolo
