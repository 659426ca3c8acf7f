// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "text_testing.h"

#include <deal.II/base/mpi.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/mesh/mesh_source.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>
#include <tombolo/state/nodal_state.h>

#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    /** A scene that has a mesh and perhaps parts, read from text as from a parameter file. */
    template <int dim>
    class MeshScene
    {
    public:
      /** @p entries are lines for the subsection of the source; @p parts names and their Cells. */
      MeshScene(const std::string &source, const std::string &entries,
                const std::vector<std::pair<std::string, std::string>> &parts = {})
          : source(source), parameters(MPI_COMM_WORLD)
      {
        std::string text =
            "subsection Mesh\nsubsection " + source + "\n" + entries + "\nend\nend\n";
        for (const auto &part : parts)
          text += "subsection Part: " + part.first + "\nset Cells = " + part.second + "\nend\n";
        parameters.read_text(text, "scene.prm");

        auto &handler = parameters.handler();
        handler.enter_subsection("Mesh");
        Registry<MeshSource<dim>>::instance().declare_all(handler);
        handler.leave_subsection();
        for (const auto &part : parts)
        {
          handler.enter_subsection("Part: " + part.first);
          handler.declare_entry("Cells", "", dealii::Patterns::Anything());
          handler.leave_subsection();
        }
        parameters.assign();
        for (const auto &part : parts)
          part_sections.push_back(parameters.section("Part: " + part.first));
      }

      std::unique_ptr<Mesh<dim>> create_mesh(MPI_Comm communicator = MPI_COMM_WORLD) const
      {
        auto mesh = std::make_unique<Mesh<dim>>(communicator);
        Registry<MeshSource<dim>>::instance()
            .create(source, parameters.section("Mesh/" + source))
            ->create(*mesh);
        return mesh;
      }

      std::string source;
      Parameters parameters;
      std::vector<Section> part_sections;
    };

    extern template class MeshScene<2>;
    extern template class MeshScene<3>;

    inline std::string source_directory()
    {
      return std::getenv("TOMBOLO_SOURCE_DIR");
    }

    inline std::string read_text_file(const std::string &name)
    {
      std::ifstream stream(name);
      EXPECT_TRUE(stream.good()) << name;
      std::stringstream text;
      text << stream.rdbuf();
      return text.str();
    }

    /** Calls @p use(number, point) of the owned nodes of all cells that this rank has, of a node
     * as often as it has such cells. */
    template <int dim, typename Use>
    void for_owned_nodes(const Nodes<dim> &nodes, const Use &use)
    {
      std::vector<dealii::types::global_dof_index> numbers;
      std::vector<dealii::Point<dim>> points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        if (!cell->is_artificial())
        {
          nodes.cell_nodes(cell, numbers);
          nodes.cell_points(cell, points);
          for (unsigned int k = 0; k < numbers.size(); ++k)
            if (nodes.owned().is_element(numbers[k]))
              use(numbers[k], points[k]);
        }
    }

    /** Where the mesh has the nodes. Collective. */
    template <int dim>
    NodalVector initial_positions(const Nodes<dim> &nodes,
                                  const std::shared_ptr<const NodePartition> &partition)
    {
      NodalVector result(partition);
      for_owned_nodes(nodes,
                      [&](const auto number, const dealii::Point<dim> &point) {
                        std::copy_n(&point[0], dim, result.node(partition->local_index(number)));
                      });
      result.update_ghosts();
      return result;
    }

    /** Positions of all nodes by persistent id, on every rank. */
    template <int dim>
    std::map<std::uint64_t, std::vector<double>> nodes_by_id(const Nodes<dim> &nodes)
    {
      std::vector<std::pair<std::uint64_t, std::vector<double>>> local;
      std::vector<bool> seen(nodes.owned().n_elements(), false);
      for_owned_nodes(nodes,
                      [&](const auto number, const dealii::Point<dim> &point)
                      {
                        const auto i = nodes.owned().index_within_set(number);
                        if (!seen[i])
                          local.emplace_back(nodes.persistent_ids()[i],
                                             std::vector<double>(&point[0], &point[0] + dim));
                        seen[i] = true;
                      });
      std::map<std::uint64_t, std::vector<double>> result;
      for (const auto &rank_nodes : dealii::Utilities::MPI::all_gather(nodes.communicator(), local))
        for (const auto &node : rank_nodes)
          EXPECT_TRUE(result.insert(node).second) << "the id " << node.first << " stands twice";
      return result;
    }

    /** Begins a state in which nodes are where the mesh has them, with masses of 1 + x. Collective.
     */
    template <int dim>
    void start_at(const Nodes<dim> &nodes, NodalState &state)
    {
      state.reinit(std::make_shared<const NodePartition>(nodes.owned(), nodes.relevant(),
                                                         nodes.communicator()));
      for_owned_nodes(nodes,
                      [&](const auto number, const dealii::Point<dim> &point)
                      {
                        const unsigned int i = state.partition()->local_index(number);
                        std::copy_n(&point[0], dim, state.initial_position.node(i));
                        *state.mass.node(i) = 1. + point[0];
                      });
      state.initial_position.update_ghosts();
      state.position.copy_from(state.initial_position);
    }
  } // namespace testing
} // namespace tombolo
