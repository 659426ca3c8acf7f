// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model_checkpoint.h>

#include <tombolo/base/format.h>
#include <tombolo/model/mesh_transfer.h>
#include <tombolo/model/model.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace tombolo
{
  namespace
  {
    template <int dim>
    void serialize_points(StateArchive &archive, Model<dim> &model, const unsigned int index)
    {
      const Part<dim> &part = model.parts[index];
      Formulation<dim> &formulation = *part.formulation;
      MaterialPoints &points = formulation.points();

      // Rows are cells, with all their points, or particles; point q of a row is
      // point_indices[row * n_points + q].
      const std::vector<std::uint64_t> ids = model.persistent_ids_of_points(index);
      std::vector<unsigned int> point_indices;
      const bool is_of_particles = part.particles != nullptr;
      const unsigned int n_points = is_of_particles ? 1 : formulation.n_points_per_cell();
      for (unsigned int row = 0; row < ids.size(); ++row)
        for (unsigned int q = 0; q < n_points; ++q)
          point_indices.push_back(is_of_particles ? row : formulation.point_of_cell(row, q));
      archive.set_rows(ids);

      std::vector<double> values;
      for (unsigned int f = 0; f < points.fields().size(); ++f)
      {
        const FieldDescription &field = points.fields()[f];
        if (!field.persistent || !model.has_mechanics || n_points == 0)
          continue;
        values.clear();
        for (const unsigned int point : point_indices)
          for (unsigned int c = 0; c < field.n_components; ++c)
            values.push_back(points.component(f, c)[point]);
        archive.rows(field.name, n_points * field.n_components, values);
        if (!archive.is_reading())
          continue;
        for (std::size_t k = 0; k < point_indices.size(); ++k)
          for (unsigned int c = 0; c < field.n_components; ++c)
            points.component(f, c)[point_indices[k]] = values[k * field.n_components + c];
        if (!is_of_particles && f != MaterialPoints::volume)
          formulation.fill_unused_lanes(f);
      }
      Records beside_points;
      formulation.list(beside_points);
      beside_points.serialize(archive);
    }

    template <int dim>
    void serialize_parts(StateArchive &archive, Model<dim> &model,
                         const MeshTransfer<dim> *const transfer)
    {
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const auto group = archive.group("part " + model.parts[p].name);
        if (transfer != nullptr)
          transfer->read_points(model, p, archive);
        else
          serialize_points(archive, model, p);
      }
    }

    /** As a sum: nodes that a division has made have none. */
    void serialize_pending_heat(StateArchive &archive, NodalVector &pending, const bool is_needed)
    {
      const std::string name = "pending heat";
      if (!archive.has(name) && is_needed)
        archive.fail("it is of a version in which contacts, pairs, fragments and refills each kept "
                     "the heat that nodes had not got yet; this one keeps it with the nodes "
                     "(\"nodes/heat/" +
                     name + "\"). Its run can be finished with that version.");
      if (!archive.has(name))
        return;
      std::vector<unsigned int> nodes(pending.partition()->n_owned());
      std::iota(nodes.begin(), nodes.end(), 0u);
      std::vector<std::array<double, 3>> values;
      for (const unsigned int node : nodes)
        values.push_back({{*pending.node(node), 0., 0.}});
      archive.nodal(name, nodes, values);
      for (const unsigned int node : nodes)
        *pending.node(node) = values[node][0];
    }

    template <int dim>
    void serialize_nodes(StateArchive &archive, Model<dim> &model)
    {
      const auto group = archive.group("nodes");
      for (const auto &[description, vector] : model.state.fields())
        if (description.persistent)
          archive.nodal(description.name, description.n_components, *vector);
      if (StateArchive::Division *const division = archive.division();
          division != nullptr && model.has_mechanics)
      {
        division->mass.reinit_like(model.state.mass);
        division->mass.copy_from(model.state.mass);
        archive.nodal("mass before the division", 1, division->mass);
      }
      if (!model.heat || !archive.has("heat"))
        return;
      const auto heat_group = archive.group("heat");
      for (const auto &[description, vector] : model.heat->state.fields())
        if (description.persistent)
          archive.nodal(description.name, description.n_components, *vector);
      const bool has_waited =
          std::any_of(model.processes.begin(), model.processes.end(),
                      [](const auto &process) { return process->actions.has_heat(); });
      serialize_pending_heat(archive, model.heat->state.pending, has_waited);
    }

    template <int dim>
    void refuse_other_mesh(const NodalVector &built, const Model<dim> &model,
                           const StateArchive &archive)
    {
      // The same parameters can give another mesh, from a file that has changed.
      double extent = 0, distance = 0;
      const auto n_values = std::size_t(model.state.partition()->n_owned()) * node_stride;
      for (std::size_t i = 0; i < n_values; ++i)
      {
        extent = std::max(extent, std::abs(built.data()[i]));
        distance =
            std::max(distance, std::abs(built.data()[i] - model.state.initial_position.data()[i]));
      }
      extent = Utilities::MPI::max(extent, model.communicator);
      distance = Utilities::MPI::max(distance, model.communicator);
      if (distance <= 1e-10 * extent)
        return;
      archive.fail(as_text("it is of another mesh: nodes of the same numbers are up to ", distance,
                           " apart. Has the mesh file changed since?"));
    }
  } // namespace

  template <int dim>
  void serialize_model(Model<dim> &model, StateArchive &archive,
                       const MeshTransfer<dim> *const transfer)
  {
    if (transfer != nullptr)
      archive.set_nodes(transfer->nodes());
    else
      archive.set_nodes(model.nodes->persistent_ids());
    NodalVector built(model.state.partition());
    built.copy_from(model.state.initial_position);
    for (const auto &process : model.processes)
      process->structure.serialize(archive);
    serialize_parts(archive, model, transfer);
    if (archive.is_reading())
      model.parts_were_read();
    archive.set_partition(model.state.partition());

    serialize_nodes(archive, model);
    if (archive.is_reading())
      refuse_other_mesh(built, model, archive);
    Records impulses;
    model.impulses.list(impulses);
    impulses.serialize(archive);
    for (const auto &process : model.processes)
    {
      process->records.serialize(archive);
      process->actions.records.serialize(archive);
    }
  }

  template <int dim>
  void read_initial_state(Model<dim> &model, StateArchive &archive)
  {
    archive.set_nodes(model.nodes->persistent_ids());
    NodalVector built(model.state.partition());
    built.copy_from(model.state.initial_position);
    serialize_parts<dim>(archive, model, nullptr);
    model.parts_were_read();
    serialize_nodes(archive, model);
    refuse_other_mesh(built, model, archive);
  }

  template void serialize_model(Model<2> &, StateArchive &, const MeshTransfer<2> *);
  template void serialize_model(Model<3> &, StateArchive &, const MeshTransfer<3> *);
  template void read_initial_state(Model<2> &, StateArchive &);
  template void read_initial_state(Model<3> &, StateArchive &);
} // namespace tombolo
