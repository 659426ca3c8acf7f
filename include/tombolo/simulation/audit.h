// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/log.h>
#include <tombolo/base/memory.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/contact/mortar_contact.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/mesh/extent.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/contact_nodes.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/advice.h>
#include <tombolo/simulation/spacings.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <set>
#include <sstream>

namespace tombolo
{
  inline std::string megabytes(const double bytes)
  {
    return as_text(std::setprecision(3), bytes / 1e6, " MB");
  }

  /** The wall time of a step [s], estimated from one evaluation that changes no state. */
  template <int dim>
  double seconds_per_step(const Model<dim> &model)
  {
    const Quantity quantity = model.has_mechanics ? Quantity::vector : Quantity::scalars;
    NodalVector velocity(model.state.partition(), quantity),
        force(model.state.partition(), quantity);
    const auto act = [&]()
    {
      if (!model.has_mechanics)
      {
        model.heat->apply_conduction(model.state.position, model.heat->state.temperature, 0.,
                                     velocity, force);
        return;
      }
      for (const Part<dim> &part : model.parts)
        part.formulation->apply_elastic_stiffness(model.state.position, velocity, 1., force);
      model.bridge->apply_smoothing(velocity, force);
      model.bridge->apply_adjoint(velocity, force);
    };
    // A short first one fills the caches for the next.
    constexpr double short_time = 0.05;
    double seconds = 0.;
    for (unsigned int round = 0; round < 2 && seconds < short_time; ++round)
    {
      const auto start = std::chrono::steady_clock::now();
      act();
      seconds = Utilities::MPI::max(seconds_since(start), model.communicator);
    }
    return seconds;
  }

  inline void print_limit(const StepLimit &limit, const std::string &by, std::ostream &text)
  {
    if (limit.entity.empty())
      return;
    text << " (limit " << limit.time_step << " " << by << "from the " << limit.entity;
    if (limit.entity != "spectrum")
      text << " at " << position_text(limit.position);
    text << ")";
  }

  /** Neighbours, bonds, fragments and patch test of the @p n_own particles of this rank.
   * Collective. */
  template <int dim>
  void print_particles(ParticleFormulation<dim> &particles, const unsigned long n_own,
                       const unsigned long n_points, const NodalVector &initial_position,
                       const MPI_Comm communicator, std::ostream &text)
  {
    const NeighbourCounts neighbours = particles.neighbour_counts();
    const double mean =
        Utilities::MPI::sum(neighbours.mean * static_cast<double>(n_own), communicator) /
        static_cast<double>(n_points);
    const bool has_some = n_own > 0;
    text << ", neighbours "
         << Utilities::MPI::min(has_some ? neighbours.minimum : 1000000u, communicator) << " / "
         << mean << " / " << Utilities::MPI::max(neighbours.maximum, communicator)
         << " (min / mean / max)";
    if (const std::string functions = particles.shape_functions(); !functions.empty())
      text << ", " << functions;
    if (const Bonds<dim> *const bonds = particles.breaking_bonds())
      text << ", bonds break by " << bonds->counts().criterion << " ("
           << Utilities::MPI::sum(bonds->counts().n_broken, communicator) << " broken, "
           << Utilities::MPI::sum(bonds->counts().n_debris, communicator) << " debris)";
    if (const SelfContact<dim> *const contact = particles.fragment_contact())
      text << ", fragments feel each other ("
           << Utilities::MPI::sum(contact->counts().n_fragments, communicator) << " now)";
    const PatchTest test = particles.patch_test(initial_position);
    if (test.is_known)
      text << ", patch-test defect " << test.defect;
  }

  template <int dim>
  void print_parts(const Model<dim> &model, std::ostream &text)
  {
    const MPI_Comm communicator = model.communicator;
    for (const Part<dim> &part : model.parts)
    {
      const auto n_own = static_cast<unsigned long>(
          part.particles != nullptr
              ? part.particles->stencils().n_particles()
              : part.formulation->n_cells() * part.formulation->n_points_per_cell());
      const unsigned long n_points = Utilities::MPI::sum(n_own, communicator);
      text << "  part \"" << part.name << "\": " << n_points << " material points";
      if (part.source)
        text << ", those of cells of \"" << model.parts[*part.source].name
             << "\" that become particles";
      if (part.particles != nullptr && n_points > 0)
        print_particles(*part.particles, n_own, n_points, model.state.initial_position,
                        communicator, text);
      if (model.has_mechanics && part.material->has_mechanics())
        text << ", wave speeds " << part.material->longitudinal_wave_speed() << " (P), "
             << part.material->shear_wave_speed() << " (S)";
      text << "\n";
    }
  }

  template <int dim>
  void print_mass_and_extent(const Model<dim> &model, std::ostream &text)
  {
    double mass = 0;
    if (model.has_mechanics)
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        mass += *model.body_mass().node(i);
    text << "  ";
    if (model.has_mechanics)
      text << "mass " << Utilities::MPI::sum(mass, model.communicator) << ", ";
    const Extent<dim> extent = extent_of<dim>(model.state.initial_position);
    text << "extent ";
    for (unsigned int d = 0; d < dim; ++d)
      text << (d > 0 ? " x " : "") << "[" << extent.lowest[d] << ", " << extent.highest[d] << "]";
    text << "\n";
  }

  /** How stiff the springs of contacts are against the bodies. Collective. */
  template <int dim>
  void print_contact_stiffness(const Model<dim> &model, const double stable_step,
                               std::ostream &text)
  {
    const auto contacts = shown_by_processes<SurfaceContact<dim>>(model);
    if (contacts.empty() || !(stable_step > 0.))
      return;
    for (const Part<dim> &part : model.parts)
    {
      if (!part.material->has_mechanics())
        continue;
      const auto spacings = spacings_of(part, model.communicator);
      if (!(spacings[1] > 0.)) // of a rigid part, or one that has no cells yet
        continue;
      const double p = std::pow(part.material->longitudinal_wave_speed(), 2),
                   s = std::pow(part.material->shear_wave_speed(), 2);
      if (!(p > s))
        continue;
      const double squared_bar_speed = s * (3. * p - 4. * s) / (p - s);
      for (const auto *const contact : contacts)
        if (!contact->contact_settings().is_kinematic)
          text << "  contact \"" << contact->name() << "\": springs of nodes inside of part \""
               << part.name << "\" have "
               << contact->stiffness_over_modulus(spacings[0], squared_bar_speed, stable_step)
               << " to "
               << contact->stiffness_over_modulus(spacings[1], squared_bar_speed, stable_step)
               << " times Young's modulus" << (dim == 3 ? " and spacing" : "") << " (PFAC)\n";
    }
  }

  /** Returns how many steps are expected. Collective. */
  template <int dim>
  double print_steps(const Model<dim> &model, StepSize<dim> &step_size,
                     ThermalStep<dim> *thermal_step, const StaticSteps<dim> *statics,
                     const double end_time, std::ostream &text)
  {
    Clock clock;
    double n_steps = 0;
    if (statics != nullptr)
    {
      n_steps = statics->n_steps(end_time);
      text << "  static steps, at least " << n_steps << "\n";
    }
    else if (model.has_mechanics)
    {
      const double step = step_size.next(model, clock, end_time, false);
      n_steps = std::ceil(end_time / step);
      text << "  time step " << step;
      print_limit(step_size.limit(), "by the spectral estimate, ", text);
      // Bodies that are compressed need more of them.
      text << ", about " << n_steps << " steps"
           << (step_size.is_given() ? "" : " at the initial step") << "\n";
    }
    if (thermal_step != nullptr)
    {
      const double step = std::min(thermal_step->allowed_step(model), end_time);
      const double n_thermal = std::ceil(end_time / step);
      text << "  thermal step at most " << step;
      if (thermal_step->limit().time_step < 1e299)
        print_limit(thermal_step->limit(), "", text);
      text << ", at least " << n_thermal << " steps\n";
      n_steps = model.has_mechanics ? n_steps : n_thermal;
    }
    return n_steps;
  }

  /** Returns the bytes of nodes, points and tools of the ranks. Collective. */
  template <int dim>
  Utilities::MPI::MinMaxAvg print_memory(const Model<dim> &model, const std::size_t bytes_before,
                                         const unsigned long n_nodes, std::ostream &text)
  {
    const MPI_Comm communicator = model.communicator;
    const auto mesh_bytes = static_cast<double>(model.mesh.triangulation.memory_consumption() +
                                                model.nodes->dof_handler().memory_consumption());
    const double bytes =
        static_cast<double>(allocated_bytes()) - static_cast<double>(bytes_before) - mesh_bytes;
    const auto bytes_of_ranks = Utilities::MPI::min_max_avg(std::max(bytes, 0.), communicator);
    text << "  memory " << megabytes(bytes_of_ranks.sum) << " for nodes, points and tools ("
         << bytes_of_ranks.sum / static_cast<double>(n_nodes) << " bytes a node), "
         << megabytes(Utilities::MPI::sum(mesh_bytes, communicator)) << " for the mesh\n";
    return bytes_of_ranks;
  }

  template <int dim>
  void print_images(const Model<dim> &model, std::ostream &text)
  {
    if (model.nodes->images()->empty())
      return;
    text << "  ";
    model.nodes->images()->describe(text);
    text << ", images of particles "
         << Utilities::MPI::sum(static_cast<unsigned long>(model.state.partition()->n_images()),
                                model.communicator)
         << "\n";
  }

  template <int dim>
  void print_ranks(const Model<dim> &model, const Utilities::MPI::MinMaxAvg &bytes_of_ranks,
                   std::ostream &text)
  {
    const MPI_Comm communicator = model.communicator;
    if (Utilities::MPI::n_mpi_processes(communicator) == 1)
      return;
    const double ghosts =
        Utilities::MPI::sum(static_cast<double>(model.state.partition()->n_ghosts()), communicator);
    text << "  ranks " << Utilities::MPI::n_mpi_processes(communicator)
         << ", largest share of bytes " << bytes_of_ranks.max / bytes_of_ranks.sum
         << ", ghost nodes " << ghosts << " in all\n";
  }

  /** Warns of bodies of the mesh that could pass through each other. Collective. */
  template <int dim>
  void warn_of_bodies(const Model<dim> &model, Log &log)
  {
    if (!model.has_mechanics)
      return;
    std::optional<Bodies<dim>> element_bodies;
    if (model.bodies == nullptr)
      element_bodies.emplace(*model.nodes);
    const Bodies<dim> &bodies = element_bodies ? *element_bodies : *model.bodies;
    if (bodies.n_bodies() < 2)
      return;
    // Of a part whose fragments interact, all bodies are one here; so are those of
    // contacts between bodies.
    std::set<types::global_dof_index> touching = ContactNodes<dim>(model).bodies_of_contacts(
        shown_by_processes<SurfaceContact<dim>>(model), bodies);
    for (const auto *const contact : shown_by_processes<MortarContact<dim>>(model))
      for (const auto *const side : {&contact->slave_faces(), &contact->master_faces()})
        for (const auto &face : side->faces())
          touching.insert(bodies.body_of(face.global_nodes[0]));
    const std::vector<types::global_dof_index> own_bodies(touching.begin(), touching.end());
    for (const auto &rank_bodies : Utilities::MPI::all_gather(model.communicator, own_bodies))
      touching.insert(rank_bodies.begin(), rank_bodies.end());
    std::set<std::pair<types::global_dof_index, std::string>> found;
    std::vector<types::global_dof_index> cell_nodes;
    for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      if (cell->is_locally_owned())
      {
        const Part<dim> &part = model.parts[model.part_cells->part_of(cell)];
        model.nodes->cell_nodes(cell, cell_nodes);
        const auto body = bodies.body_of(cell_nodes.front());
        const bool has_contact =
            touching.count(body) > 0 ||
            (part.particles != nullptr && (part.particles->fragment_contact() != nullptr ||
                                           part.particles->reaches_other_bodies()));
        found.insert({has_contact ? numbers::invalid_dof_index : body, part.name});
      }
    std::set<types::global_dof_index> separate;
    std::set<std::string> names;
    for (const auto &rank_names : Utilities::MPI::all_gather(
             model.communicator, std::vector<std::pair<types::global_dof_index, std::string>>(
                                     found.begin(), found.end())))
      for (const auto &[body, name] : rank_names)
      {
        separate.insert(body);
        names.insert(name);
      }
    if (separate.size() < 2)
      return;
    log.warn("The mesh has " + std::to_string(bodies.n_bodies()) +
             " bodies that no common node joins (parts " +
             in_quotes(std::vector<std::string>(names.begin(), names.end())) +
             "), and no contact between them: where they meet they pass through each other. "
             "Name them in `Body contacts`; bodies of particles feel each other also with "
             "`Self-contact` in their parts.");
  }

  /** Prints the size of a model before its first step: nodes by label, cells, particles,
   * neighbours, mass, extent, wave speeds, the time step and what limits it, the number of steps
   * and the memory, the balance of the ranks, and the remarks of the reader of the mesh. @p
   * thermal_step is null in models without heat, @p statics where steps are explicit; @p
   * bytes_before were allocated before the model was built. Returns how many steps are expected.
   * Collective. */
  template <int dim>
  double print_audit(const Model<dim> &model, StepSize<dim> &step_size,
                     ThermalStep<dim> *thermal_step, const StaticSteps<dim> *statics,
                     const double end_time, const std::size_t bytes_before, Log &log)
  {
    const auto counts = model.counts();
    std::ostringstream text;
    text << "Model: " << counts.nodes << " nodes (" << counts.element_nodes << " of elements, "
         << counts.particles << " particles, " << counts.shared_nodes << " shared), "
         << counts.cells << " elements, degree " << model.degree << "\n";
    print_parts(model, text);
    print_mass_and_extent(model, text);
    for (const auto &process : model.processes)
      process->observed.audit(text);
    const double n_steps = print_steps(model, step_size, thermal_step, statics, end_time, text);
    if (statics == nullptr) // at rest springs do not follow from a step
      print_contact_stiffness(model, step_size.limit().time_step, text);
    const auto bytes_of_ranks = print_memory(model, bytes_before, counts.nodes, text);
    print_images(model, text);
    print_ranks(model, bytes_of_ranks, text);
    if (statics == nullptr)
      text << "  wall time about " << format_duration(n_steps * seconds_per_step(model));
    std::string audit = text.str();
    if (audit.back() == '\n')
      audit.pop_back();
    log.print(audit);
    warn_of_bodies(model, log);
    for (const std::string &remark : model.mesh.remarks)
      log.warn(remark);
    print_warnings(model, Clock(), Process<dim>::Occasion::audit, log);
    return n_steps;
  }
} // namespace tombolo
