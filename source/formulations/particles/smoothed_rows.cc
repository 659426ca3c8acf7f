// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/smoothed_rows.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Candidates of kernels at present positions, beyond the support. */
    constexpr double skin_of_current = 0.1;

    /** The mean volume of the cells of @p is_taken over all ranks, or of those between the nodes of
     * cells of a higher degree; zero without cells. Collective. */
    template <int dim>
    double mean_cell_volume(const PartSetup<dim> &setup, const CellSelection<dim> &is_taken,
                            const std::vector<double> &particle_volumes)
    {
      double n_cells = 0, volume = 0;
      for (const auto &cell : setup.nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() && is_taken(cell))
          n_cells += std::pow(setup.nodes->degree(), dim);
      for (const double of_particle : particle_volumes)
        volume += of_particle;
      n_cells = Utilities::MPI::sum(n_cells, setup.communicator);
      volume = Utilities::MPI::sum(volume, setup.communicator);
      return n_cells > 0. ? volume / n_cells : 0.;
    }
  } // namespace

  template <int dim>
  void SmoothedRows<dim>::declare_parameters(const Entries &e)
  {
    e.choice("Kernel", "hyperbolic spline", Registry<Kernel>::instance().selection(),
             "The kernel, as a function of the distance over two smoothing lengths.");
    e.number("Smoothing length", "1.5", any_number(), "",
             "Smoothing length over the spacing of the particles, the dim-th root of the mean "
             "volume of their cells; at least 1, usually 1.2 to 1.5. Particles within two "
             "smoothing lengths are neighbours.");
    e.choice("Gradient", "corrected", "corrected|paper",
             "Whether gradients are corrected so that those of linear fields are exact and angular "
             "momentum is conserved, or those of the kernel alone, as in the paper.");
    e.number("Correction limit", "0.5", between(0., 1.), "",
             "A gradient is not corrected where det F of the moment F = sum of (x_J - x_I) x grad "
             "W_J V_J falls below this times (tr F/dim)^dim: where neighbours lie to few sides. 1 "
             "is a particle with the same neighbours on all axes.");
  }

  template <int dim>
  SmoothedRows<dim>::SmoothedRows(const Section &section)
      : ParticleRows<dim>(section,
                          section.get("Configuration") == "current" ? skin_of_current : 0.),
        kernel(Registry<Kernel>::instance().create(section.get("Kernel"), section)),
        relative_length(section.get_double("Smoothing length")),
        is_corrected(section.get("Gradient") == "corrected"),
        is_current(section.get("Configuration") == "current"),
        is_compact(is_current && section.get("Bond failure") == "none"),
        correction_limit(section.get_double("Correction limit"))
  {
    if (!(relative_length >= 1. && relative_length <= 10.))
      section.fail("Smoothing length",
                   "allowed is a number from 1 to 10; usual are 1.2 to 1.5. Below the spacing a "
                   "particle has no neighbours on the diagonals of a lattice");
    if (!is_corrected && !is_current)
      section.fail("Gradient", "gradients of the kernel alone belong to present positions; with a "
                               "Lagrangian kernel a body at rest would be strained. Choose "
                               "`corrected`, or `Configuration = current`");
  }

  template <int dim>
  bool SmoothedRows<dim>::choose_supports(const PartSetup<dim> &setup,
                                          const CellSelection<dim> &is_taken,
                                          ParticleSet<dim> &particles)
  {
    // Particles that come later get the length of the part.
    if (radial_rows == nullptr)
    {
      const double volume = mean_cell_volume<dim>(setup, is_taken, particles.initial_volumes());
      if (volume > 0.)
        radial_rows = std::make_unique<RadialRows<dim>>(
            RadialKernel<dim>(kernel, relative_length * std::pow(volume, 1. / dim)), is_corrected,
            correction_limit,
            is_current ? RadialRows<dim>::Uncorrected::raw : RadialRows<dim>::Uncorrected::empty);
    }
    copies.clear();
    for (unsigned int i = 0; i < particles.size(); ++i)
      copies.push_back(particles.copies_in_whole_body(i));
    std::vector<double> supports(particles.size() * node_stride, 0.);
    for (unsigned int i = 0; i < particles.size(); ++i)
    {
      std::fill_n(supports.begin() + std::ptrdiff_t(i) * node_stride, dim,
                  radial_rows->kernel().support());
      supports[i * node_stride + RadialRows<dim>::volume_slot] =
          copies[i] * particles.initial_volumes()[i];
    }
    particles.set_initial_supports(supports);
    present_volumes.clear();
    return true;
  }

  template <int dim>
  void SmoothedRows<dim>::fill(const Neighbourhoods<dim> &found, const double *const position,
                               const double *const support, Stencils &stencils)
  {
    static const std::vector<double> initial_ones;
    const bool is_own = &stencils == &this->shape;
    const bool is_present = is_own && !present_volumes.empty();
    defects = &radial_rows->compute(found.nodes(), position, support,
                                    is_present ? present_volumes : initial_ones,
                                    is_own ? searched() : stencils, stencils);
  }

  template <int dim>
  void SmoothedRows<dim>::renumber(const NodePartition &partition)
  {
    if (!is_compact)
    {
      ParticleRows<dim>::renumber(partition);
      return;
    }
    // The rows are some of the candidates, in their order.
    Stencils &shape = this->shape;
    std::vector<std::size_t> candidate(shape.row_start.back());
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      std::size_t place = candidates.row_start[row];
      for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
      {
        while (candidates.neighbour[place] != shape.neighbour[entry])
          ++place;
        candidate[entry] = place;
      }
    }
    this->neighbours.set_partition(partition, candidates);
    shape.particle_node = candidates.particle_node;
    for (std::size_t entry = 0; entry < candidate.size(); ++entry)
      shape.neighbour[entry] = candidates.neighbour[candidate[entry]];
  }

  template <int dim>
  void SmoothedRows<dim>::restrict_neighbours()
  {
    // Candidates hold while offsets change by at most the skin on each axis.
    const double reach =
        is_current ? radial_rows->kernel().support() * (1. + skin_of_current * std::sqrt(1. * dim))
                   : radial_rows->reach();
    const std::vector<double> &x = this->neighbours.position_at_search();
    this->neighbours.remove_neighbours(
        [&](const unsigned int row, const unsigned int place)
        {
          double squared = 0;
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double offset =
                x[std::size_t(place) * node_stride + d] - x[std::size_t(row) * node_stride + d];
            squared += offset * offset;
          }
          return squared >= reach * reach;
        },
        searched());
    if (!is_compact)
      return;
    // Until they are computed the rows are all that was found.
    this->shape.particle_node = candidates.particle_node;
    this->shape.row_start = candidates.row_start;
    this->shape.neighbour = candidates.neighbour;
  }

  template <int dim>
  std::string SmoothedRows<dim>::describe_defects(const double *const position,
                                                  const double *) const
  {
    if (defects == nullptr || defects->empty())
      return {};
    const auto &defect = defects->front();
    const unsigned int node = this->shape.particle_node[defect.row];
    std::ostringstream text;
    text << "The particle at (";
    for (unsigned int d = 0; d < dim; ++d)
      text << (d > 0 ? ", " : "") << position[std::size_t(node) * node_stride + d];
    text << ") has " << defect.n_neighbours
         << " neighbours within two smoothing lengths, which do not carry a gradient at a "
            "`Correction limit` of "
         << correction_limit
         << ". Allowed are larger lengths and smaller limits; where cells differ much in size, the "
            "largest ones decide.";
    return text.str();
  }

  template <int dim>
  std::string SmoothedRows<dim>::functions() const
  {
    std::ostringstream text;
    text << "smoothing length " << radial_rows->kernel().smoothing_length() << ", "
         << (is_corrected ? "corrected gradients" : "gradients of the kernel alone");
    return text.str();
  }

  template <int dim>
  bool SmoothedRows<dim>::are_undeformed_when_new() const
  {
    return true; // corrected rows have it, and others are not corrected
  }

  template <int dim>
  void SmoothedRows<dim>::set_present_volumes(const std::vector<double> &volumes)
  {
    if (!is_current)
      return;
    present_volumes = volumes;
    for (std::size_t i = 0; i < present_volumes.size(); ++i)
      present_volumes[i] *= copies[i];
  }

  template class SmoothedRows<2>;
  template class SmoothedRows<3>;
} // namespace tombolo
