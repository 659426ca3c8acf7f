// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/surface_nodes.h>

#include <tombolo/contact/nodal_geometry.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    // Slots of what is known of the faces around a node.
    enum FaceSlot : unsigned int
    {
      n_faces,
      id,
      squared_id,
      held
    };

    // Of faces towards void cells: no boundary of a mesh has it.
    constexpr double id_of_void = -1.;
  } // namespace

  template <int dim>
  SurfaceNodes<dim>::SurfaceNodes(const Model<dim> &model,
                                  const std::vector<SmoothedCell<dim>> &lattice)
  {
    constexpr double smooth = 0.92; // half of 46 degrees between two faces
    NodalVector ids, normals;
    for (NodalVector *const vector : {&ids, &normals})
      vector->reinit(model.state.partition(), Quantity::scalars);
    examine_faces(lattice, ids, normals);
    for (NodalVector *const vector : {&ids, &normals})
      vector->add_to_owners();
    const unsigned int n_owned = model.state.partition()->n_owned();
    smooth_nodes.resize(n_owned);
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const of_node = ids.node(i);
      n_faces_of_nodes.push_back(of_node[n_faces]);
      // Steps of the lattice towards void cells are no edges of the body.
      const bool has_edge = of_node[id] != id_of_void * of_node[n_faces] &&
                            vector_of<dim>(normals.node(i)).norm() <= smooth * of_node[n_faces];
      smooth_nodes[i] = of_node[n_faces] > 0. && of_node[held] == 0. &&
                        of_node[n_faces] * of_node[squared_id] == of_node[id] * of_node[id] &&
                        !has_edge;
    }
    for (const NodePartition::Reflected &own_image : model.state.partition()->nodes_on_planes())
      smooth_nodes[own_image.source] = false;
  }

  template <int dim>
  void SurfaceNodes<dim>::examine_faces(const std::vector<SmoothedCell<dim>> &lattice,
                                        NodalVector &ids, NodalVector &normals)
  {
    const auto &all = SubCells<dim>::facets();
    for (const SmoothedCell<dim> &cell : lattice)
      for (const unsigned int face : GeometryInfo<dim>::face_indices())
      {
        if (!cell.is_on_boundary[face])
          continue;
        Tensor<1, dim> normal;
        for (const auto &facet : all)
          if (facet.to == SubCells<dim>::outside && facet.face == face)
            normal += SubCells<dim>::area(facet, cell.corners);
        normal /= normal.norm();
        for (unsigned int k = 0; k < cell.nodes.size(); ++k)
        {
          if (((k >> (face / 2)) & 1u) != face % 2)
            continue;
          const unsigned int node = ids.partition()->local_index(cell.nodes[k]);
          double *const of_node = ids.node(node);
          of_node[n_faces] += 1.;
          if (cell.boundary_ids[face] != numbers::internal_face_boundary_id ||
              cell.is_towards_void[face])
          {
            const double number = cell.is_towards_void[face] ? id_of_void : cell.boundary_ids[face];
            of_node[id] += number;
            of_node[squared_id] += number * number;
          }
          else
            of_node[held] += 1.;
          for (unsigned int d = 0; d < dim; ++d)
            normals.node(node)[d] += normal[d];
        }
      }
  }

  template class SurfaceNodes<2>;
  template class SurfaceNodes<3>;
} // namespace tombolo
