// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_handler.h>

#include <tombolo/mesh/images.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/part_cells.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The one index space of the scene: nodes are the support points of a scalar FE_Q(degree) on
   * Gauss-Lobatto points; FE node, particle and shared node are labels on it. Ownership is that of
   * degrees of freedom and stays for the whole run.
   */
  template <int dim>
  class Nodes
  {
  public:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;

    Nodes(const Mesh<dim> &mesh, unsigned int degree);

    unsigned int degree() const
    {
      return finite_element->degree;
    }

    const dealii::DoFHandler<dim> &dof_handler() const
    {
      return handler;
    }

    MPI_Comm communicator() const
    {
      return communicator_of(handler);
    }

    const dealii::IndexSet &owned() const
    {
      return owned_nodes;
    }

    /** Owned nodes and all nodes of owned cells. */
    const dealii::IndexSet &relevant() const
    {
      return relevant_nodes;
    }

    /** Global node numbers of a cell, lexicographic (x fastest) over its (degree+1)^dim points. */
    void cell_nodes(const Cell &cell, std::vector<dealii::types::global_dof_index> &nodes) const;

    /** Initial positions of a cell's nodes, in the order of cell_nodes. */
    void cell_points(const Cell &cell, std::vector<dealii::Point<dim>> &points) const;

    /** Which of a cell's nodes lie on its face @p face: ascending indices in cell_nodes. */
    const std::vector<unsigned int> &face_node_indices(const unsigned int face) const
    {
      return indices_by_face[face];
    }

    /** Calls @p visit(node) for the nodes of the faces at the boundary that @p selects(cell, face),
     * of owned and ghost cells: global numbers, some repeatedly. */
    template <typename Selects, typename Visit>
    void for_each_boundary_node(const Selects &selects, const Visit &visit) const
    {
      std::vector<dealii::types::global_dof_index> numbers;
      for (const auto &cell : handler.active_cell_iterators())
        if (!cell->is_artificial() && cell->at_boundary())
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f) && selects(cell, f))
            {
              cell_nodes(cell, numbers);
              for (const unsigned int k : indices_by_face[f])
                visit(numbers[k]);
            }
    }

    /** Calls @p visit(cell, face, nodes, points) for the faces of owned cells that
     * @p selects(cell, face), with the nodes of the face and their initial positions. */
    template <typename Selects, typename Visit>
    void for_each_face(const Selects &selects, const Visit &visit) const
    {
      std::vector<dealii::types::global_dof_index> numbers, face_numbers;
      std::vector<dealii::Point<dim>> points, face_points;
      for (const auto &cell : handler.active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int f : cell->face_indices())
          {
            if (!selects(cell, f))
              continue;
            cell_nodes(cell, numbers);
            cell_points(cell, points);
            face_numbers.clear();
            face_points.clear();
            for (const unsigned int k : indices_by_face[f])
            {
              face_numbers.push_back(numbers[k]);
              face_points.push_back(points[k]);
            }
            visit(cell, f, face_numbers, face_points);
          }
    }

    /** Images of the mesh, which continue the body. */
    void set_images(std::shared_ptr<const Images> images)
    {
      images_of_body = std::move(images);
    }

    const std::shared_ptr<const Images> &images() const
    {
      return images_of_body;
    }

    /** Those nodes of the relevant cells of this rank which depend on others: at least those of
     * cells around owned nodes, ascending. Collective. */
    void set_dependent_nodes(std::vector<DependentNode> rows);

    const std::vector<DependentNode> &dependent_nodes() const
    {
      return dependent;
    }

    bool has_dependent_nodes() const ///< on any rank
    {
      return are_any_dependent;
    }
    /** The row of a node; null where it does not depend on others, or is not relevant here. */
    const DependentNode *dependent_node(dealii::types::global_dof_index node) const;
    /** Initial positions of nodes that others depend on, where this rank has cells around them. */
    std::map<dealii::types::global_dof_index, dealii::Point<dim>> points_depended_on() const;

    /** Whether the body ends at a face of a cell: at the boundary of the mesh, unless it is its own
     * image. What acts on the surface of a body acts on these faces. */
    bool is_outer_face(const Cell &cell, unsigned int face) const;

    /** What an outer face is in messages. */
    std::string outer_face_text() const;

    /** A number of each owned node (in the order of owned()) that depends neither on the number of
     * ranks nor on the partition: the smallest (coarse cell, index within it) of the cells
     * around it, packed. Used by output, checkpoint, probes and messages. */
    const std::vector<std::uint64_t> &persistent_ids() const
    {
      return ids;
    }

  private:
    std::unique_ptr<const dealii::FiniteElement<dim>> finite_element;
    dealii::DoFHandler<dim> handler;
    dealii::IndexSet owned_nodes;
    dealii::IndexSet relevant_nodes;
    std::vector<unsigned int> lexicographic_to_hierarchic;
    std::vector<std::vector<unsigned int>> indices_by_face;
    std::vector<std::uint64_t> ids;
    std::shared_ptr<const Images> images_of_body = Images::none();
    std::vector<DependentNode> dependent;
    bool are_any_dependent = false;
  };

  /** Sets the flags of ghost cells, by active cell index, to those of their owners. Collective. */
  template <int dim>
  void update_ghost_flags(const Nodes<dim> &nodes, std::vector<bool> &flags);

  /** The largest diameter of a cell [L]. Collective. */
  template <int dim>
  double largest_cell_diameter(const Nodes<dim> &nodes);

  /** The cells of a part that this rank owns, in the order of active cells of the triangulation:
   * that of Formulation::n_cells(). */
  template <int dim>
  std::vector<typename Nodes<dim>::Cell>
  cells_of_part(const Nodes<dim> &nodes, const PartCells<dim> &part_cells, const unsigned int part)
  {
    std::vector<typename Nodes<dim>::Cell> cells;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      if (cell->is_locally_owned() && part_cells.part_of(cell) == part)
        cells.push_back(cell);
    return cells;
  }

  extern template class Nodes<2>;
  extern template class Nodes<3>;
} // namespace tombolo
