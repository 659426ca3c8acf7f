// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <tombolo/formulations/add_energies.h>
#include <tombolo/mesh/cells_of_part.h>
#include <tombolo/model/model_input.h>
#include <tombolo/physics/mechanics/scaling_settings.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <optional>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const std::string cells_entry = "Cells";

    /** Of both parts on this rank. */
    template <int dim>
    PartEnergies sum_of(const Part<dim> &a, const Part<dim> &b)
    {
      PartEnergies sum = a.formulation->energies();
      add_energies(1., b.formulation->energies(), sum);
      return sum;
    }

    /** Adds layers of cells around @p cells. Collective. */
    template <int dim>
    void add_layers(const ConvertingCells<dim> &part, const unsigned int n_cells,
                    const std::shared_ptr<const NodePartition> &partition,
                    std::vector<unsigned int> &cells)
    {
      std::vector<bool> is_chosen(n_cells, false);
      for (const unsigned int cell : cells)
        is_chosen[cell] = true;
      NodalVector marks;
      for (unsigned int layer = 0; layer < part.conversion().n_layers(); ++layer)
      {
        marks.reinit(partition, 1);
        for (unsigned int cell = 0; cell < n_cells; ++cell)
          if (is_chosen[cell])
            for (const types::global_dof_index node : part.nodes_of_cell(cell))
              *marks.node(partition->local_index(node)) = 1.;
        marks.add_to_owners();
        marks.update_ghosts();
        for (unsigned int cell = 0; cell < n_cells; ++cell)
        {
          const auto nodes = part.nodes_of_cell(cell);
          if (!part.is_removed(cell) &&
              std::any_of(nodes.begin(), nodes.end(),
                          [&](const types::global_dof_index node)
                          { return *marks.node(partition->local_index(node)) > 0.; }))
            is_chosen[cell] = true;
        }
      }
      cells.clear();
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        if (is_chosen[cell])
          cells.push_back(cell);
    }
  } // namespace

  template <int dim>
  void link_conversions(const Parameters &parameters, std::vector<Part<dim>> &parts)
  {
    const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
    std::vector<std::string> names;
    for (const Part<dim> &part : parts)
      names.push_back(part.name);
    std::vector<const Section *> receiver(parts.size(), nullptr);
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const std::optional<std::string> given = source_of_cells(sections[p].get(cells_entry));
      if (!given)
        continue;
      const std::string &name = *given;
      if (name.empty())
        sections[p].fail(cells_entry,
                         "the name of the part is missing whose cells become particles: "
                         "allowed is `from NAME`.");
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
      {
        const std::string nearest = nearest_name(name, names);
        sections[p].fail(cells_entry,
                         "there is no part of this name." +
                             (nearest.empty() ? "" : " Did you mean \"" + nearest + "\"?"));
      }
      const auto source = static_cast<unsigned int>(found - names.begin());
      if (parts[p].particles == nullptr || !parts[p].particles->can_add_particles())
        sections[p].fail(
            "Formulation",
            "cells of another part become particles only, of a method that can take them; allowed "
            "with `Cells = from " +
                name + "` is \"momentum consistent particle\".");
      if (parts[source].converting == nullptr)
        sections[p].fail(cells_entry,
                         "no cell of part \"" + name +
                             "\" would ever become particles: it needs an element type and one of "
                             "the entries \"Conversion strain\", \"Conversion scaled Jacobian\" "
                             "and \"Conversion time step\" in its section.");
      if (receiver[source] != nullptr)
        sections[p].fail(cells_entry, "part \"" + receiver[source]->name() +
                                          "\" takes the cells of \"" + name +
                                          "\" already; only one part can.");
      if (parts[source].material != parts[p].material)
        sections[p].fail("Material", "the part takes over the state of part \"" + name +
                                         "\" and has to have its material.");
      receiver[source] = &sections[p];
      parts[p].source = source;
    }
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      if (parts[p].converting == nullptr)
        continue;
      if (receiver[p] == nullptr)
        parts[p].converting->conversion().refuse(
            "no part takes the cells of part \"" + parts[p].name +
            "\": add one of particles with `Cells = from " + parts[p].name + "`.");
      if (ScalingSettings(parameters.section("Scaling")).is_selective())
        parts[p].converting->conversion().refuse(
            "the mass of single cells is scaled (\"Scaling/Target time step\"), which particles "
            "could not take over; allowed is a uniform \"Mass factor\".");
    }
  }

  template <int dim>
  bool Model<dim>::converts() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return part.source.has_value(); });
  }

  template <int dim>
  unsigned long Model<dim>::n_converted_cells() const
  {
    unsigned long count = 0;
    for (const Part<dim> &part : parts)
      if (part.converting != nullptr)
        count += part.converting->n_converted_cells();
    return Utilities::MPI::sum(count, communicator);
  }

  template <int dim>
  void Model<dim>::note_conversion(const unsigned int source,
                                   const std::vector<unsigned int> &cells)
  {
    const DoFHandler<dim> &handler = nodes->dof_handler();
    is_converted.resize(mesh.triangulation.n_active_cells(), false);
    const auto of_part = cells_of_part(*nodes, *part_cells, source);
    for (const unsigned int cell : cells)
      is_converted[of_part[cell]->active_cell_index()] = true;
    using Cell = typename DoFHandler<dim>::active_cell_iterator;
    GridTools::exchange_cell_data_to_ghosts<std::uint8_t, DoFHandler<dim>>(
        handler,
        [&](const Cell &cell)
        { return std::uint8_t(is_converted[cell->active_cell_index()] ? 1 : 0); },
        [&](const Cell &cell, const std::uint8_t &flag)
        { is_converted[cell->active_cell_index()] = flag != 0; });
  }

  template <int dim>
  void Model<dim>::give_cells_to(Part<dim> &part, const StateTransfer *const converted)
  {
    part.particles->add_particles(
        [&](const typename Nodes<dim>::Cell &cell) {
          return is_converted[cell->active_cell_index()] &&
                 part_cells->part_of(cell) == part.source;
        },
        state.position, converted);
  }

  template <int dim>
  bool Model<dim>::find_converting_cells(const unsigned long step)
  {
    bool are_found = false;
    converting_cells.assign(parts.size(), {});
    for (const Part<dim> &part : parts)
    {
      if (!part.source)
        continue;
      const Part<dim> &source = parts[*part.source];
      if (step % source.converting->conversion().interval() != 0)
        continue;
      std::vector<unsigned int> &cells = converting_cells[*part.source];
      cells = source.converting->find_converting_cells(state.position);
      if (Utilities::MPI::max(cells.empty() ? 0 : 1, communicator) == 0)
        continue;
      add_layers(*source.converting, source.formulation->n_cells(), partition, cells);
      are_found = true;
    }
    return are_found;
  }

  template <int dim>
  void Model<dim>::convert(double &lost_energy)
  {
    for (Part<dim> &part : parts)
    {
      if (!part.source)
        continue;
      Part<dim> &source = parts[*part.source];
      ConvertingCells<dim> &converting = *source.converting;
      const std::vector<unsigned int> &cells = converting_cells[*part.source];
      if (Utilities::MPI::max(cells.empty() ? 0 : 1, communicator) == 0)
        continue;

      const PartEnergies before = sum_of(source, part);
      StateTransfer converted(partition, source.formulation->points(), part.formulation->points());
      converting.add_state(cells, converted);
      converted.add_to_owners();
      if (heat)
        converted.temperature = &heat->state.present_temperature;
      converting.deactivate_cells(cells);
      note_conversion(*part.source, cells);
      give_cells_to(part, &converted);
      PartEnergies lost = before;
      add_energies(-1., sum_of(source, part), lost);
      converting.keep_dissipated(lost);
      lost_energy += lost.elastic + lost.hourglass + lost.failure;
    }
    set_partition();
    state.move_to(partition);
    set_masses();
    set_filter_rate();
    if (heat)
      heat->limit_is_outdated = true;
    has_eroded = true;
  }

  template <int dim>
  void Model<dim>::serialize_conversions(StateArchive &archive)
  {
    bool has_read = false;
    for (Part<dim> &part : parts)
    {
      if (!part.source)
        continue;
      const Part<dim> &source = parts[*part.source];
      const auto group = archive.group("cells from " + source.name);
      const auto of_part = cells_of_part(*nodes, *part_cells, *part.source);
      archive.set_rows(persistent_ids_of_cells(*part.source));
      std::vector<double> flags;
      for (unsigned int cell = 0; cell < of_part.size(); ++cell)
        flags.push_back(
            !is_converted.empty() && is_converted[of_part[cell]->active_cell_index()] ? 1. : 0.);
      archive.rows("is converted", 1, flags);
      if (!archive.is_reading())
        continue;
      std::vector<unsigned int> cells;
      for (unsigned int cell = 0; cell < flags.size(); ++cell)
        if (flags[cell] != 0.)
          cells.push_back(cell);
      if (Utilities::MPI::max(cells.empty() ? 0 : 1, communicator) == 0)
        continue;
      note_conversion(*part.source, cells);
      give_cells_to(part, nullptr);
      has_read = true;
    }
    if (has_read)
      set_partition();
  }

  template void link_conversions<2>(const Parameters &, std::vector<Part<2>> &);
  template void link_conversions<3>(const Parameters &, std::vector<Part<3>> &);
  template bool Model<2>::converts() const;
  template bool Model<3>::converts() const;
  template unsigned long Model<2>::n_converted_cells() const;
  template unsigned long Model<3>::n_converted_cells() const;
  template bool Model<2>::find_converting_cells(unsigned long);
  template void Model<2>::convert(double &);
  template bool Model<3>::find_converting_cells(unsigned long);
  template void Model<3>::convert(double &);
  template void Model<2>::serialize_conversions(StateArchive &);
  template void Model<3>::serialize_conversions(StateArchive &);
} // namespace tombolo
