// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace tombolo
{
  /**
   * Cells of elements that become particles of another part (`Cells = from PART`) before the forces
   * at t_n, where they fulfil the criterion of their part, with layers of cells around them. Mass,
   * momentum, heat and dissipated energy stay.
   */
  template <int dim>
  class Conversion : public Process<dim>
  {
  public:
    explicit Conversion(Model<dim> &model) : communicator(model.communicator)
    {
      for (unsigned int p = 0; p < model.parts.size(); ++p)
        if (const auto source = model.parts[p].source)
          pairs.push_back({*source, p, model.parts[*source].template as<ConvertingCells>(),
                           model.parts[p].particles});
      this->structure.archived([this, &model](StateArchive &archive)
                               { serialize_structure(model, archive); });
      this->records.group("conversion").sums("lost", lost);
      this->observed.energy("conversion loss", EnergyKind::removed, lost);
      this->observed.column("converted cells", "1",
                            [this] { return static_cast<double>(n_converted_cells()); });
      this->observed.result("converted_cells", [this] { return n_converted_cells(); });
      this->observed.result("conversion_loss",
                            [this] { return dealii::Utilities::MPI::sum(lost, communicator); });
    }

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      ModelChange change;
      if (!find_converting_cells(model, clock))
        return change;
      model.begin_change();
      const double before = internal_power(model, clock.previous_step);
      convert(model);
      model.bridge->smooth_velocity(model.state);
      lost += energy_of_change(before, internal_power(model, clock.previous_step),
                               clock.previous_step, communicator);
      change.cells = change.stencils = true;
      return change;
    }

    /** Finds the cells that fulfil the criterion of their part, where the step is one in which the
     * check is made, with the layers around them. Returns whether there are any on any rank.
     * Collective. */
    bool find_converting_cells(Model<dim> &model, const Clock &clock)
    {
      bool are_found = false;
      converting_cells.assign(pairs.size(), {});
      for (std::size_t k = 0; k < pairs.size(); ++k)
      {
        const ConvertingCells<dim> &source = *pairs[k].cells;
        const ConversionCriterion &criterion = source.conversion();
        std::vector<unsigned int> &cells = converting_cells[k];
        if (clock.step % criterion.interval != 0)
          continue;
        cells = source.find_converting_cells(model.state.position);
        if (!criterion.smallest_gap && !is_on_any_rank(cells, communicator))
          continue;
        const LocalNodes nodes = nodes_of_cells(source, model, pairs[k].source);
        std::vector<bool> is_chosen(nodes.size(), false);
        for (const unsigned int cell : cells)
          is_chosen[cell] = true;
        if (criterion.smallest_gap)
          add_near_cells(model, criterion, nodes, clock.time, is_chosen);
        for (unsigned int layer = 0; layer < criterion.layers; ++layer)
          is_chosen = CellMarks::cells_marked(
              nodes, CellMarks::nodes_of(model.state.partition(), nodes, is_chosen));
        cells.clear();
        for (unsigned int cell = 0; cell < is_chosen.size(); ++cell)
          if (is_chosen[cell])
            cells.push_back(cell);
        if (!model.step_groups.keep_ready(model, pairs[k].source, cells))
          cells.clear(); // all go together, at the next check
        are_found = is_on_any_rank(cells, communicator) || are_found;
      }
      return are_found;
    }

    /** Makes particles of the cells of find_converting_cells(). Collective. */
    void convert(Model<dim> &model)
    {
      for (std::size_t k = 0; k < pairs.size(); ++k)
      {
        const Pair &pair = pairs[k];
        const std::vector<unsigned int> &cells = converting_cells[k];
        if (!is_on_any_rank(cells, communicator))
          continue;
        const Part<dim> &source = model.parts[pair.source];
        Part<dim> &target = model.parts[pair.target];
        EnergyAccounts change = energies_of(source, target);
        const NodalVector extra = extra_mass(model, source),
                          particle_mass = extra_mass(model, target);
        StateTransfer converted(model.state.partition(), source.formulation->points(),
                                target.formulation->points());
        add_up(converted.sums(), [&] { pair.cells->add_state(cells, converted); });
        if (model.heat)
          converted.temperature = &model.heat->state.present_temperature;
        pair.cells->deactivate_cells(cells);
        note_conversion(model, pair.source, cells);
        NodalVector volumes;
        if (pair.cells->masses_move())
          volumes = volumes_of_particles(model, pair, &converted);
        update_particles(model, pair, &converted, pair.cells->masses_move() ? &volumes : nullptr);
        if (!model.inertia_is_mass)
        {
          NodalVector moved = extra_mass(model, source);
          for (unsigned int i = 0; i < moved.partition()->n_owned(); ++i)
            *moved.node(i) = *extra.node(i) + *particle_mass.node(i) - *moved.node(i);
          set_inertia(moved, target);
        }
        change.add(energies_of(source, target), -1.);
        pair.cells->keep_dissipated(change);
        lost += change.sum_of(EnergyKind::stored) + change["failure dissipation"];
      }
      ++model.revisions.cells;
      ++model.revisions.stencils;
      model.renew_partition();
      if (model.heat)
        model.heat->limit_is_outdated = true;
    }

    /** Over all ranks. Collective. */
    unsigned long n_converted_cells() const
    {
      unsigned long count = 0;
      for (const Pair &pair : pairs)
        count += pair.cells->n_converted_cells();
      return dealii::Utilities::MPI::sum(count, communicator);
    }

  private:
    /** A part of elements and the part of particles that its cells become. */
    struct Pair
    {
      unsigned int source, target;
      ConvertingCells<dim> *cells;
      ParticleFormulation<dim> *particles;
    };

    using LocalNodes = std::vector<std::vector<unsigned int>>;

    /** Adds the cells that are too near to the surface of the criterion to those that are chosen.
     */
    static void add_near_cells(Model<dim> &model, const ConversionCriterion &criterion,
                               const LocalNodes &nodes_by_cell, const double time,
                               std::vector<bool> &is_chosen)
    {
      std::vector<unsigned int> nodes;
      for (const auto &cell_nodes : nodes_by_cell)
        nodes.insert(nodes.end(), cell_nodes.begin(), cell_nodes.end());
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      const auto contacts = shown_by_processes<SurfaceContact<dim>>(model);
      const auto contact =
          std::find_if(contacts.begin(), contacts.end(),
                       [&](const auto *one) { return one->name() == criterion.contact; });
      if (contact == contacts.end())
        criterion.refuse("there is no such contact.");
      (*contact)->require_gaps(*criterion.smallest_gap);
      std::vector<double> gaps(nodes.size(), std::numeric_limits<double>::max());
      (*contact)->contact_surface().evaluate_gaps(model.state.position, nodes, time, gaps);
      std::vector<bool> is_near(model.state.partition()->n_local(), false);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        is_near[nodes[k]] = gaps[k] < *criterion.smallest_gap;
      for (std::size_t cell = 0; cell < nodes_by_cell.size(); ++cell)
        for (const unsigned int node : nodes_by_cell[cell])
          is_chosen[cell] = is_chosen[cell] || is_near[node];
    }

    /** Notes that these cells of a part became particles, on all ranks that have them.
     * Collective. */
    void note_conversion(const Model<dim> &model, const unsigned int source,
                         const std::vector<unsigned int> &cells)
    {
      is_converted.resize(model.mesh.triangulation.n_active_cells(), false);
      const auto source_cells = cells_of_part(*model.nodes, *model.part_cells, source);
      for (const unsigned int cell : cells)
        is_converted[source_cells[cell]->active_cell_index()] = true;
      update_ghost_flags(*model.nodes, is_converted);
    }

    /** Makes the particles of the pair those of the converted cells. Collective. */
    void update_particles(const Model<dim> &model, const Pair &pair,
                          const StateTransfer *const converted, const NodalVector *const volumes)
    {
      pair.particles->add_particles(
          [&](const typename Nodes<dim>::Cell &cell)
          {
            return is_converted[cell->active_cell_index()] &&
                   model.part_cells->part_of(cell) == pair.source;
          },
          model.state.position, converted, volumes);
    }

    /** The initial volumes of the particles of a pair at owned nodes, with those of the cells that
     * become particles now, if any do [L^dim]. */
    static NodalVector volumes_of_particles(const Model<dim> &model, const Pair &pair,
                                            const StateTransfer *const converted)
    {
      NodalVector result(model.state.partition(), Quantity::scalar);
      const ParticleSet<dim> &particles = pair.particles->particle_set();
      for (unsigned int i = 0; i < particles.size(); ++i)
        *result.node(static_cast<unsigned int>(particles.owned_nodes().index_within_set(
            particles.nodes()[i]))) = particles.initial_volumes()[i];
      for (unsigned int i = 0; converted != nullptr && i < result.partition()->n_owned(); ++i)
        *result.node(i) += *converted->volume.node(i);
      return result;
    }

    /** Writes to a checkpoint, or reads from it, which cells have become particles. Collective. */
    void serialize_structure(Model<dim> &model, StateArchive &archive)
    {
      bool has_read = false;
      for (const Pair &pair : pairs)
      {
        const auto group = archive.group("cells from " + model.parts[pair.source].name);
        const auto source_cells = cells_of_part(*model.nodes, *model.part_cells, pair.source);
        archive.set_rows(model.persistent_ids_of_points(pair.source));
        std::vector<double> flags;
        for (const auto &cell : source_cells)
          flags.push_back(!is_converted.empty() && is_converted[cell->active_cell_index()] ? 1.
                                                                                           : 0.);
        archive.rows("is converted", 1, flags);
        NodalVector volumes;
        if (pair.cells->masses_move())
        {
          volumes = volumes_of_particles(model, pair, nullptr);
          archive.nodal("volumes of particles", 1, volumes);
        }
        if (!archive.is_reading())
          continue;
        std::vector<unsigned int> cells;
        for (unsigned int cell = 0; cell < flags.size(); ++cell)
          if (flags[cell] != 0.)
            cells.push_back(cell);
        if (!is_on_any_rank(cells, communicator))
          continue;
        pair.cells->set_converted_cells(cells);
        note_conversion(model, pair.source, cells);
        update_particles(model, pair, nullptr, pair.cells->masses_move() ? &volumes : nullptr);
        has_read = true;
      }
      if (has_read)
        model.set_partition();
    }

    /** Of both parts on this rank. */
    static EnergyAccounts energies_of(const Part<dim> &a, const Part<dim> &b)
    {
      EnergyAccounts sum = a.formulation->energies();
      sum.add(b.formulation->energies());
      return sum;
    }

    static bool is_on_any_rank(const std::vector<unsigned int> &cells, const MPI_Comm communicator)
    {
      return dealii::Utilities::MPI::max(cells.empty() ? 0 : 1, communicator) == 1;
    }

    /** The inertia of the cells or particles of a part beyond that of their inertial density, at
     * owned nodes [M]. Collective. */
    static NodalVector extra_mass(const Model<dim> &model, const Part<dim> &part)
    {
      const auto add = [&](NodalVector &sums)
      {
        for (unsigned int i = 0; part.particles != nullptr && i < part.inertia.size(); ++i)
        {
          const Stencils &rows = part.particles->stencils();
          *sums.node(rows.particle_node[i]) += (part.inertia[i] - 1.) * rows.mass[i];
        }
        if (part.particles == nullptr && !part.inertia.empty())
          part.formulation->add_extra_mass(part.inertia, sums);
      };
      return sums_at_owners(model.state.partition(), Quantity::scalar, add);
    }

    /** Particles have the mean inertia of the cells and particles of which they are made, with @p
     * extra mass. */
    static void set_inertia(const NodalVector &extra, Part<dim> &part)
    {
      const ParticleSet<dim> &particles = part.particles->particle_set();
      part.inertia.assign(particles.size(), 1.);
      for (unsigned int i = 0; i < particles.size(); ++i)
        part.inertia[i] += *extra.node(static_cast<unsigned int>(
                               particles.owned_nodes().index_within_set(particles.nodes()[i]))) /
                           part.particles->stencils().mass[i];
    }

    /** The nodes of all cells of a part, none of those that were removed. */
    static std::vector<std::vector<unsigned int>> nodes_of_cells(const ConvertingCells<dim> &part,
                                                                 const Model<dim> &model,
                                                                 const unsigned int number)
    {
      std::vector<std::vector<unsigned int>> result(model.parts[number].formulation->n_cells());
      for (unsigned int cell = 0; cell < result.size(); ++cell)
        if (!part.is_removed(cell))
          for (const dealii::types::global_dof_index node : part.nodes_of_cell(cell))
            result[cell].push_back(model.state.partition()->local_index(node));
      return result;
    }

    MPI_Comm communicator;
    std::vector<Pair> pairs;
    std::vector<bool> is_converted; ///< by active cell, ghosts included; empty before the first
    std::vector<std::vector<unsigned int>> converting_cells; ///< of each pair, in this step
    double lost = 0;
  };
} // namespace tombolo
