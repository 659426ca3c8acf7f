// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/radial_rows.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/formulations/particles/particle_method.h>
#include <tombolo/formulations/particles/particle_rows.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace tombolo
{
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
      for (const double particle_volume : particle_volumes)
        volume += particle_volume;
      n_cells = Utilities::MPI::sum(n_cells, setup.communicator);
      volume = Utilities::MPI::sum(volume, setup.communicator);
      return n_cells > 0. ? volume / n_cells : 0.;
    }
  } // namespace

  /**
   * Rows of smoothed particle hydrodynamics (RadialRows), with one smoothing length for all
   * particles of the part: a multiple of their spacing, the dim-th root of the mean volume of the
   * cells that they come from.
   *
   * Where planes of symmetry leave a piece of a body, a particle on a plane has that part of its
   * volume (and mass) that is in the piece, with which its stress acts on its neighbours and on
   * their images alike. All of it acts on its neighbours: V⁰ in RadialRows is that of the whole
   * body.
   */
  template <int dim>
  class SmoothedRows : public ParticleRows<dim>
  {
  public:
    /** Throws InputError. */
    explicit SmoothedRows(const Entries &e)
        : ParticleRows<dim>(e, e.given("Configuration") == "current" ? skin_of_current : 0.),
          kernel(
              read_kernel(e, "hyperbolic spline",
                          "The kernel, as a function of the distance over two smoothing lengths.")),
          relative_length(e.number(
              "Smoothing length", "1.5", any_number(), "",
              "Smoothing length over the spacing of the particles, the dim-th root of the mean "
              "volume of their cells; at least 1, usually 1.2 to 1.5. Particles within two "
              "smoothing lengths are neighbours.")),
          is_corrected(
              e.choice("Gradient", "corrected", "corrected|paper",
                       "Whether gradients are corrected so that those of linear fields are exact "
                       "and angular momentum is conserved, or those of the kernel alone, as in "
                       "the paper.") == "corrected"),
          is_current(e.given("Configuration") == "current"),
          is_compact(is_current && e.given("Bond failure") == "none"),
          correction_limit(e.number(
              "Correction limit", "0.5", between(0., 1.), "",
              "A gradient is not corrected where det F of the moment F = sum of (x_J - x_I) x grad "
              "W_J V_J falls below this times (tr F/dim)^dim: where neighbours lie to few sides. 1 "
              "is a particle with the same neighbours on all axes."))
    {
      e.refuse(!(relative_length >= 1. && relative_length <= 10.), "Smoothing length",
               "allowed is a number from 1 to 10; usual are 1.2 to 1.5. Below the spacing a "
               "particle has no neighbours on the diagonals of a lattice");
      e.refuse(!is_corrected && !is_current, "Gradient",
               "gradients of the kernel alone belong to present positions; with a "
               "Lagrangian kernel a body at rest would be strained. Choose "
               "`corrected`, or `Configuration = current`");
    }

    void fill(const Neighbourhoods<dim> &found, const double *const position,
              const double *const support, Stencils &stencils) override
    {
      static const std::vector<double> initial_ones;
      const bool is_own = &stencils == &this->shape;
      const bool is_present = is_own && !present_volumes.empty();
      defects = &radial_rows->compute(found.nodes(), position, support,
                                      is_present ? present_volumes : initial_ones,
                                      is_own ? searched() : stencils, stencils);
    }
    double dilation() const override
    {
      return 2. * relative_length;
    }
    const char *support_entry() const override
    {
      return "Smoothing length";
    }
    bool choose_supports(const PartSetup<dim> &setup, const CellSelection<dim> &is_taken,
                         ParticleSet<dim> &particles) override
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
    std::string functions() const override
    {
      return as_text("smoothing length ", radial_rows->kernel().smoothing_length(), ", ",
                     (is_corrected ? "corrected gradients" : "gradients of the kernel alone"));
    }
    bool are_undeformed_when_new() const override
    {
      return true; // corrected rows have it, and others are not corrected
    }
    bool depend_on_volumes() const override
    {
      return is_current;
    }
    void set_present_volumes(const double *const volumes) override
    {
      present_volumes.resize(is_current ? copies.size() : 0);
      for (std::size_t i = 0; i < present_volumes.size(); ++i)
        present_volumes[i] = copies[i] * volumes[i];
    }

    const RadialKernel<dim> &radial_kernel() const
    {
      return radial_rows->kernel();
    }
    const std::size_t *own_entries() const
    {
      return radial_rows ? radial_rows->own_entries() : nullptr;
    }

  private:
    /** With kernels at present positions rows hold the candidates within two smoothing lengths, for
     * short sweeps. Not with bonds, which number neighbours by their index among the candidates. */
    Stencils &searched() override
    {
      return is_compact ? candidates : this->shape;
    }
    void renumber(const NodePartition &partition) override
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
        std::size_t index = candidates.row_start[row];
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
        {
          while (candidates.neighbour[index] != shape.neighbour[entry])
            ++index;
          candidate[entry] = index;
        }
      }
      this->neighbours.set_partition(partition, candidates);
      shape.particle_node = candidates.particle_node;
      for (std::size_t entry = 0; entry < candidate.size(); ++entry)
        shape.neighbour[entry] = candidates.neighbour[candidate[entry]];
    }
    /** Leaves those neighbours that can come within the support while candidates hold. */
    void restrict_neighbours() override
    {
      // Candidates hold while offsets change by at most the skin on each axis.
      const double reach = is_current ? radial_rows->kernel().support() *
                                            (1. + skin_of_current * std::sqrt(1. * dim))
                                      : radial_rows->reach();
      const std::vector<double> &x = this->neighbours.position_at_search();
      this->neighbours.remove_neighbours(
          [&](const unsigned int row, const unsigned int neighbour)
          {
            double squared = 0;
            for (unsigned int d = 0; d < dim; ++d)
            {
              const double offset = x[std::size_t(neighbour) * node_stride + d] -
                                    x[std::size_t(row) * node_stride + d];
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
    std::string describe_defects(const double *const position, const double *) const override
    {
      if (defects == nullptr || defects->empty())
        return {};
      const auto &defect = defects->front();
      return as_text(this->particle_at(defect.row, position), " has ", defect.n_neighbours,
                     " neighbours within two smoothing lengths, which do not carry a gradient at a "
                     "`Correction limit` of ",
                     correction_limit,
                     ". Allowed are larger lengths and smaller limits; where cells differ much in "
                     "size, the largest ones decide.");
    }

    std::shared_ptr<const Kernel> kernel;
    double relative_length; // over the spacing
    bool is_corrected;
    bool is_current;
    bool is_compact;
    double correction_limit;
    Stencils candidates;                          // rows of the search; empty unless compact
    std::unique_ptr<RadialRows<dim>> radial_rows; // null until there is a spacing
    std::vector<double> copies;                   // volume in the whole body over that in its piece
    std::vector<double> present_volumes; // in the whole body; nothing: the initial ones [L^dim]
    const std::vector<typename RadialRows<dim>::Defect> *defects = nullptr; // of the last fill()
  };

  namespace
  {
    StrainMeasure strain_measure_of(const Entries &e)
    {
      const std::string measure = e.choice(
          "Strain measure", "automatic", "automatic|logarithmic|rate",
          "What the stress follows: the elastic logarithmic strain, from whose energy the "
          "forces derive, or the rate of deformation with an objective rate of the Kirchhoff "
          "stress. `automatic` is `rate` with `Gradient = paper`, and `logarithmic` else.");
      const bool is_logarithmic =
          measure == "logarithmic" || (measure == "automatic" && e.given("Gradient") != "paper");
      return is_logarithmic ? StrainMeasure::logarithmic : StrainMeasure::rate;
    }

    /** W and -dW/dr at one distance. */
    template <int dim>
    std::array<double, 2> values_at(const RadialKernel<dim> &kernel, const double distance)
    {
      std::array<double, n_lanes> r = {}, w, dw;
      r[0] = distance;
      kernel.evaluate(n_lanes, r.data(), w.data(), dw.data());
      return {{w[0], -dw[0]}};
    }
  } // namespace

  /**
   * Smoothed particle hydrodynamics of solids (doc/smoothed_particles.md): rows of a radial kernel
   * (RadialRows) and no smoothing of velocities, with the material, the integration, the bonds and
   * the conduction of all particles. Where volumes V_I = m_I/ρ_I follow the velocity gradient of
   * the rows, forces are those of the symmetric equation of momentum. Pairs of particles act on
   * each other, and conduct heat, where that is chosen (doc/pair_terms.md).
   */
  template <int dim>
  class SmoothedParticle : public ParticleMethod<dim>, public PairInteractions<dim>
  {
  public:
    explicit SmoothedParticle(const Entries &e)
        : ParticleMethod<dim>(e, std::make_unique<SmoothedRows<dim>>(e), "current"), terms(e),
          conduction(e)
    {
      this->part_points = PartPoints{BulkViscosity(e), strain_measure_of(e)};
    }

    NeighbourCounts neighbour_counts() const override
    {
      return this->count_neighbours([](const Stencils::Row &row, const unsigned int k)
                                    { return row.is_within_support(k); });
    }

    void initialize(const PartSetup<dim> &setup) override
    {
      ParticleMethod<dim>::initialize(setup);
      heat = setup.heat;
      const RadialKernel<dim> &kernel_function =
          static_cast<const SmoothedRows<dim> &>(*this->rows).radial_kernel();
      const double radius = kernel_function.support(), spacing = radius / this->rows->dilation();
      const auto slope = [&](const double distance)
      { return values_at(kernel_function, distance)[1]; };
      kernel_slope = RadialTable(radius, slope);
      conduction.initialize(slope, radius, spacing);
      if (setup.has_mechanics)
        terms.initialize(
            *setup.material,
            [&](const double distance) { return values_at(kernel_function, distance)[0]; }, radius,
            kernel_function.smoothing_length(), spacing);
    }

    void set_partition(const NodePartition &partition) override
    {
      ParticleMethod<dim>::set_partition(partition);
      const Neighbourhoods<dim> &found = this->rows->neighbourhoods();
      const std::vector<double> &supports = found.support_at_search();
      volumes.assign(std::size_t(partition.n_local()) * node_stride, 0.);
      for (std::size_t index = 0; index < found.nodes().size(); ++index)
        volumes[std::size_t(found.nodes()[index]) * node_stride] =
            supports[index * node_stride + RadialRows<dim>::volume_slot];
    }

    void add_conduction(const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      if (conduction.is_on())
        conduction.add_conduction(pair_rows(), heat->conductivity(), position.data(),
                                  conductivity_temperature.data(), temperature.data(),
                                  heat_rate.data());
      else
        ParticleMethod<dim>::add_conduction(position, conductivity_temperature, temperature,
                                            heat_rate);
    }

    StepLimit diffusion_limit(const NodalVector &position) const override
    {
      if (!conduction.is_on())
        return ParticleMethod<dim>::diffusion_limit(position);
      StepLimit limit;
      limit.entity = "particle";
      const double diffusivity = heat->largest_diffusivity() / this->material().density();
      if (diffusivity == 0.)
        return limit;
      const PairRows rows = pair_rows();
      conduction.for_each_decay(rows, position.data(),
                                [&](const unsigned int i, const double decay)
                                {
                                  const double step = 1. / (2. * diffusivity * decay);
                                  if (!(step < limit.time_step))
                                    return;
                                  limit.time_step = step;
                                  for (unsigned int d = 0; d < dim; ++d)
                                    limit.position[d] =
                                        position.node(rows.shape->particle_node[i])[d];
                                });
      return limit;
    }

    const PairInteractions<dim> *pairs() const override
    {
      return this;
    }

    const PairTerms<dim> &pair_terms() const override
    {
      return terms;
    }

    PairRows pair_rows() const override
    {
      const MaterialPoints &points = this->points();
      const double *const initial = this->set.initial_volumes().data();
      const double *const present =
          points.size() > 0 ? points.component(MaterialPoints::volume, 0) : initial;
      const Stencils &shape = this->stencils();
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        volumes[std::size_t(shape.particle_node[i]) * node_stride + 1] = present[i];
      return {&shape,
              static_cast<const SmoothedRows<dim> &>(*this->rows).own_entries(),
              volumes.size() / node_stride,
              volumes.data(),
              initial,
              &kernel_slope};
    }

    bool visit_conductances(const NodalVector &position,
                            const NodalVector &conductivity_temperature,
                            const typename PairConduction<dim>::Visitor &visit) const override
    {
      if (!conduction.is_on())
        return false;
      conduction.for_each_pair(pair_rows(), heat->conductivity(), position.data(),
                               conductivity_temperature.data(), visit);
      return true;
    }

  private:
    PairTerms<dim> terms;
    PairConduction<dim> conduction;
    RadialTable kernel_slope;                      // |dW/dr|
    mutable std::vector<double> volumes;           // of PairRows; V is set on request
    std::shared_ptr<const ThermalProperties> heat; // null: a scene without heat
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedParticle, "smoothed particle",
      "smoothed particle hydrodynamics (SPH) with corrected gradients, or those of the paper")
} // namespace tombolo
