// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <tombolo/mesh/cells_of_part.h>
#include <tombolo/model/persistent_cell_ids.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A number of a cell that depends on nothing but its coarse cell and its place in it: the path
     * through the children, behind a leading one that tells its length. */
    std::uint64_t persistent_id(const CellId &cell, const unsigned int bits_per_level)
    {
      constexpr unsigned int path_bits = 37;
      std::uint64_t path = 1;
      const auto children = cell.get_child_indices();
      AssertThrow(children.size() * bits_per_level < path_bits, ExcNotImplemented());
      for (const auto child : children)
        path = (path << bits_per_level) | static_cast<std::uint64_t>(child);
      return (static_cast<std::uint64_t>(cell.get_coarse_cell_id()) << path_bits) | path;
    }
  } // namespace

  template <int dim>
  std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<dim> &nodes,
                                                     const PartCells<dim> &part_cells,
                                                     const unsigned int part)
  {
    std::vector<std::uint64_t> ids;
    for (const auto &cell : cells_of_part(nodes, part_cells, part))
      ids.push_back(persistent_id(cell->id(), dim));
    return ids;
  }

  template <int dim>
  std::vector<std::uint64_t> Model<dim>::persistent_ids_of_points(const unsigned int part) const
  {
    if (parts[part].particles == nullptr)
      return persistent_ids_of_cells(*nodes, *part_cells, part);
    std::vector<std::uint64_t> ids;
    for (const unsigned int node : parts[part].formulation->particle_nodes())
      ids.push_back(nodes->persistent_ids()[node]);
    return ids;
  }

  template <int dim>
  void Model<dim>::serialize_points(StateArchive &archive, Part<dim> &part,
                                    const unsigned int index)
  {
    Formulation<dim> &formulation = *part.formulation;
    MaterialPoints &points = formulation.points();

    // Rows are cells, with all their points, or particles; place[row * n_points + q] is the point.
    const std::vector<std::uint64_t> ids = persistent_ids_of_points(index);
    std::vector<unsigned int> places;
    const bool is_of_particles = part.particles != nullptr;
    const unsigned int n_points = is_of_particles ? 1 : formulation.n_points_per_cell();
    for (unsigned int row = 0; row < ids.size(); ++row)
      for (unsigned int q = 0; q < n_points; ++q)
        places.push_back(is_of_particles ? row : formulation.point_of_cell(row, q));
    archive.set_rows(ids);

    std::vector<double> values;
    const auto n_rows = static_cast<unsigned int>(ids.size());
    for (unsigned int f = 0; f < points.fields().size(); ++f)
    {
      const FieldDescription &field = points.fields()[f];
      if (!field.persistent || !has_mechanics)
        continue;
      values.clear();
      for (const unsigned int place : places)
        for (unsigned int c = 0; c < field.n_components; ++c)
          values.push_back(points.component(f, c)[place]);
      archive.rows(field.name, n_points * field.n_components, values);
      if (!archive.is_reading())
        continue;
      for (std::size_t k = 0; k < places.size(); ++k)
        for (unsigned int c = 0; c < field.n_components; ++c)
          points.component(f, c)[places[k]] = values[k * field.n_components + c];
      // Unused lanes of the last batch of cells repeat its last cell, with volume zero.
      if (!is_of_particles && n_rows > 0 && f != MaterialPoints::volume)
        for (unsigned int cell = n_rows;
             formulation.point_of_cell(cell, n_points - 1) < points.size(); ++cell)
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int c = 0; c < field.n_components; ++c)
              points.component(f, c)[formulation.point_of_cell(cell, q)] =
                  points.component(f, c)[formulation.point_of_cell(n_rows - 1, q)];
    }
    formulation.serialize(archive);
  }

  template <int dim>
  void Model<dim>::serialize(StateArchive &archive)
  {
    archive.set_nodes(nodes->persistent_ids());
    NodalVector built;
    built.reinit(partition);
    built.copy_from(state.initial_position);
    for (const auto &process : processes)
      process->serialize_structure(*this, archive);
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const auto group = archive.group("part " + parts[p].name);
      serialize_points(archive, parts[p], p);
    }
    if (archive.is_reading())
    {
      for (const auto &process : processes)
        process->parts_were_read(*this);
      set_partition();
      state.move_to(partition);
      for (const Part<dim> &part : parts)
        part.formulation->complete_reading(state.position); // read below
      renew_masses();
    }

    {
      const auto group = archive.group("nodes");
      for (const auto &[description, vector] : state.fields())
        if (description.persistent)
          archive.nodal(description.name, description.n_components, *vector);
      if (heat)
      {
        const auto of_heat = archive.group("heat");
        for (const auto &[description, vector] : heat->state.fields())
          if (description.persistent)
            archive.nodal(description.name, description.n_components, *vector);
      }
    }
    if (archive.is_reading())
      refuse_other_mesh(built, archive);
    impulses.serialize(archive);
    for (const auto &process : processes)
      process->serialize(*this, archive);
  }

  template <int dim>
  void Model<dim>::refuse_other_mesh(const NodalVector &built, const StateArchive &archive) const
  {
    // The same parameters can give another mesh, from a file that has changed.
    double extent = 0, distance = 0;
    const auto n_values = std::size_t(partition->n_owned()) * node_stride;
    for (std::size_t i = 0; i < n_values; ++i)
    {
      extent = std::max(extent, std::abs(built.data()[i]));
      distance = std::max(distance, std::abs(built.data()[i] - state.initial_position.data()[i]));
    }
    extent = Utilities::MPI::max(extent, communicator);
    distance = Utilities::MPI::max(distance, communicator);
    if (distance <= 1e-10 * extent)
      return;
    std::ostringstream message;
    message << "it is of another mesh: nodes of the same numbers are up to " << distance
            << " apart. Has the mesh file changed since?";
    archive.fail(message.str());
  }

  template std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<2> &,
                                                              const PartCells<2> &, unsigned int);
  template std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<3> &,
                                                              const PartCells<3> &, unsigned int);
  template std::vector<std::uint64_t> Model<2>::persistent_ids_of_points(unsigned int) const;
  template std::vector<std::uint64_t> Model<3>::persistent_ids_of_points(unsigned int) const;
  template void Model<2>::serialize(StateArchive &);
  template void Model<3>::serialize(StateArchive &);
} // namespace tombolo
