#include <tombolo/simulation/audit.h>

#include <tombolo/simulation/scaling_report.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    std::string megabytes(const double bytes)
    {
      std::ostringstream text;
      text.precision(3);
      text << bytes / 1e6 << " MB";
      return text.str();
    }

    template <int dim>
    std::string extent_of(const Scene<dim> &scene)
    {
      std::array<double, 3> lower, upper;
      lower.fill(1e300);
      upper.fill(-1e300);
      for (unsigned int i = 0; i < scene.state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double x = scene.state.initial_position.node(i)[d];
          lower[d] = std::min(lower[d], x);
          upper[d] = std::max(upper[d], x);
        }
      std::ostringstream text;
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? " x " : "") << "[" << Utilities::MPI::min(lower[d], scene.communicator)
             << ", " << Utilities::MPI::max(upper[d], scene.communicator) << "]";
      return text.str();
    }

    /** What a step of this scene costs, for the estimate of the wall time [s]: one evaluation,
     * timed without changing any state. */
    template <int dim>
    double seconds_per_step(Scene<dim> &scene)
    {
      const UnderReflection reflection =
          scene.has_mechanics ? UnderReflection::vector : UnderReflection::even;
      NodalVector velocity, force;
      velocity.reinit(scene.state.partition(), n_slots, reflection);
      force.reinit(scene.state.partition(), n_slots, reflection);
      const auto act = [&]()
      {
        if (!scene.has_mechanics)
        {
          scene.heat->apply_conduction(scene.state.position, scene.heat->state.temperature, 0.,
                                       velocity, force);
          return;
        }
        for (const Part<dim> &part : scene.parts)
          part.formulation->add_stiffness_action(scene.state.position, velocity, 1., force);
        scene.bridge->apply_smoothing(scene.state.position, velocity, force);
        scene.bridge->apply_adjoint(scene.state.position, velocity, force);
      };
      act();
      const auto start = std::chrono::steady_clock::now();
      act();
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return Utilities::MPI::max(seconds, scene.communicator);
    }
    void print_limit(const StepLimit &limit, const std::string &by, std::ostream &text)
    {
      if (limit.entity.empty())
        return;
      text << " (limit " << limit.time_step << " " << by << "from the " << limit.entity;
      if (limit.entity != "spectrum")
        text << " at (" << limit.place[0] << ", " << limit.place[1] << ", " << limit.place[2]
             << ")";
      text << ")";
    }
  } // namespace

  template <int dim>
  void print_audit(Scene<dim> &scene, StepSize<dim> &step_size, ThermalStep<dim> *thermal_step,
                   const double end_time, Log &log)
  {
    const MPI_Comm communicator = scene.communicator;
    const auto counts = scene.counts();
    std::ostringstream text;
    text.precision(6);
    text << "Model: " << counts.nodes << " nodes (" << counts.element_nodes << " of elements, "
         << counts.particles << " particles, " << counts.shared_nodes << " shared), "
         << counts.cells << " elements, degree " << scene.degree << "\n";
    for (const Part<dim> &part : scene.parts)
    {
      const auto n_own = static_cast<unsigned long>(
          part.particles != nullptr
              ? part.particles->shape_functions().n_particles()
              : part.formulation->n_cells() * part.formulation->n_points_per_cell());
      const unsigned long n_points = Utilities::MPI::sum(n_own, communicator);
      text << "  part \"" << part.name << "\": " << n_points << " material points";
      if (part.source)
        text << ", those of cells of \"" << scene.parts[*part.source].name
             << "\" that become particles";
      if (part.particles != nullptr && n_points > 0)
      {
        const NeighbourCounts neighbours = part.particles->neighbour_counts();
        const double mean =
            Utilities::MPI::sum(neighbours.mean * static_cast<double>(n_own), communicator) /
            static_cast<double>(n_points);
        const bool has_some = n_own > 0;
        text << ", neighbours "
             << Utilities::MPI::min(has_some ? neighbours.minimum : 1000000u, communicator) << " / "
             << mean << " / " << Utilities::MPI::max(neighbours.maximum, communicator)
             << " (min / mean / max)";
        if (const BondCounts bonds = part.particles->bond_counts(); !bonds.criterion.empty())
          text << ", bonds break by " << bonds.criterion << " ("
               << Utilities::MPI::sum(bonds.n_broken, communicator) << " broken, "
               << Utilities::MPI::sum(bonds.n_debris, communicator) << " debris)";
        if (const FragmentCounts fragments = part.particles->fragment_counts();
            fragments.has_contact)
          text << ", fragments feel each other ("
               << Utilities::MPI::sum(fragments.n_fragments, communicator) << " now)";
        if (const GradientConsistency *const consistency = part.particles->gradient_consistency())
          text << ", consistent gradients: defect " << consistency->defect_before << " -> "
               << consistency->defect << " after " << consistency->iterations << " iterations"
               << (consistency->converged ? "" : ", not converged");
      }
      if (scene.has_mechanics)
        text << ", wave speeds " << part.material->longitudinal_wave_speed() << " (P), "
             << part.material->shear_wave_speed() << " (S)";
      text << "\n";
    }
    for (const auto &contact : scene.contacts)
    {
      const std::string description = contact->contact_surface().description();
      if (!description.empty())
        text << "  contact \"" << contact->name() << "\": " << description << "\n";
    }
    double mass = 0;
    if (scene.has_mechanics)
      for (unsigned int i = 0; i < scene.state.partition()->n_owned(); ++i)
        mass += *(scene.scaling ? scene.true_mass : scene.state.mass).node(i);
    text << "  ";
    if (scene.has_mechanics)
      text << "mass " << Utilities::MPI::sum(mass, communicator) << ", ";
    text << "extent " << extent_of(scene) << "\n";

    if (scene.scaling)
      ScalingReport<dim>(scene).print(text);

    Clock clock;
    double n_steps = 0;
    if (scene.has_mechanics)
    {
      const double step = step_size.next(scene, clock, end_time, false);
      n_steps = std::ceil(end_time / step);
      text << "  time step " << step;
      print_limit(step_size.limit(), "by the " + step_size.estimator_name() + " estimate, ", text);
      text << ", about " << n_steps << " steps\n";
    }
    if (thermal_step != nullptr)
    {
      const double step = std::min(thermal_step->allowed_step(scene), end_time);
      const double n_thermal = std::ceil(end_time / step);
      text << "  thermal step at most " << step;
      if (thermal_step->limit().time_step < 1e299)
        print_limit(thermal_step->limit(), "", text);
      text << ", at least " << n_thermal << " steps\n";
      n_steps = scene.has_mechanics ? n_steps : n_thermal;
    }

    std::size_t bytes = scene.state.memory_consumption();
    if (scene.has_mechanics)
      bytes += scene.bridge->memory_consumption();
    if (scene.heat)
      bytes += scene.heat->memory_consumption();
    std::size_t mesh_bytes = scene.mesh.triangulation.memory_consumption() +
                             scene.nodes->dof_handler().memory_consumption();
    for (const Part<dim> &part : scene.parts)
      bytes += part.formulation->memory_consumption();
    for (const auto &contact : scene.contacts)
      bytes += contact->contact_surface().memory_consumption();
    const auto bytes_of_ranks =
        Utilities::MPI::min_max_avg(static_cast<double>(bytes), communicator);
    text << "  memory " << megabytes(bytes_of_ranks.sum) << " for nodes, points and tools ("
         << bytes_of_ranks.sum / static_cast<double>(counts.nodes) << " bytes a node), "
         << megabytes(Utilities::MPI::sum(static_cast<double>(mesh_bytes), communicator))
         << " for the mesh\n";
    if (scene.symmetry != nullptr)
    {
      text << "  planes of symmetry";
      for (const SymmetryPlane &plane : scene.symmetry->planes)
        text << " "
             << "xyz"[plane.axis] << " = " << plane.coordinate;
      text << ", images of particles "
           << Utilities::MPI::sum(static_cast<unsigned long>(scene.state.partition()->n_images()),
                                  communicator)
           << "\n";
    }
    if (Utilities::MPI::n_mpi_processes(communicator) > 1)
    {
      const double ghosts = Utilities::MPI::sum(
          static_cast<double>(scene.state.partition()->n_ghosts()), communicator);
      text << "  ranks " << Utilities::MPI::n_mpi_processes(communicator)
           << ", largest share of bytes " << bytes_of_ranks.max / bytes_of_ranks.sum
           << ", ghost nodes " << ghosts << " in all\n";
    }
    text << "  wall time about " << format_duration(n_steps * seconds_per_step(scene));
    log.print(text.str());
    for (const std::string &remark : scene.mesh.remarks)
      log.warn(remark);
    for (const auto &contact : scene.contacts)
      for (const std::string &remark : contact->contact_surface().remarks())
        log.warn("Surface of the contact \"" + contact->name() + "\": " + remark);
  }

  template void print_audit<2>(Scene<2> &, StepSize<2> &, ThermalStep<2> *, double, Log &);
  template void print_audit<3>(Scene<3> &, StepSize<3> &, ThermalStep<3> *, double, Log &);
} // namespace tombolo
