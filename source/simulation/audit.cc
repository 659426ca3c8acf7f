#include <tombolo/simulation/audit.h>

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
      NodalVector velocity, force;
      velocity.reinit(scene.state.partition());
      force.reinit(scene.state.partition());
      const auto act = [&]()
      {
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
  } // namespace

  template <int dim>
  void print_audit(Scene<dim> &scene, StepSize<dim> &step_size, const double end_time, Log &log)
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
      const unsigned long n_points = Utilities::MPI::sum(
          static_cast<unsigned long>(part.formulation->points().size()), communicator);
      text << "  part \"" << part.name << "\": " << n_points << " material points";
      if (part.particles != nullptr)
      {
        const NeighbourCounts neighbours = part.particles->neighbour_counts();
        const double mean =
            Utilities::MPI::sum(neighbours.mean * part.formulation->points().size(), communicator) /
            static_cast<double>(n_points);
        const bool has_some = part.formulation->points().size() > 0;
        text << ", neighbours "
             << Utilities::MPI::min(has_some ? neighbours.minimum : 1000000u, communicator) << " / "
             << mean << " / " << Utilities::MPI::max(neighbours.maximum, communicator)
             << " (min / mean / max)";
      }
      text << ", wave speeds " << part.material->longitudinal_wave_speed() << " (P), "
           << part.material->shear_wave_speed() << " (S)\n";
    }
    double mass = 0;
    for (unsigned int i = 0; i < scene.state.partition()->n_owned(); ++i)
      mass += *scene.state.mass.node(i);
    text << "  mass " << Utilities::MPI::sum(mass, communicator) << ", extent " << extent_of(scene)
         << "\n";

    Clock clock;
    const double step = step_size.next(scene, clock, end_time, false);
    const StepLimit &limit = step_size.limit();
    const double n_steps = std::ceil(end_time / step);
    text << "  time step " << step;
    if (!limit.entity.empty())
    {
      text << " (limit " << limit.time_step << " by the " << step_size.estimator_name()
           << " estimate, from the " << limit.entity << " at (";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? ", " : "") << limit.place[d];
      text << "))";
    }
    text << ", about " << n_steps << " steps\n";

    std::size_t bytes = scene.state.memory_consumption() + scene.bridge->memory_consumption();
    std::size_t mesh_bytes = scene.mesh.triangulation.memory_consumption() +
                             scene.nodes->dof_handler().memory_consumption();
    for (const Part<dim> &part : scene.parts)
      bytes += part.formulation->memory_consumption();
    const auto bytes_of_ranks =
        Utilities::MPI::min_max_avg(static_cast<double>(bytes), communicator);
    text << "  memory " << megabytes(bytes_of_ranks.sum) << " for nodes and points ("
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
  }

  template void print_audit<2>(Scene<2> &, StepSize<2> &, double, Log &);
  template void print_audit<3>(Scene<3> &, StepSize<3> &, double, Log &);
} // namespace tombolo
