// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/formulations/particles/particle_method.h>
#include <tombolo/formulations/particles/smoothed_rows.h>

#include <array>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    StrainMeasure strain_measure_of(const Section &section)
    {
      const std::string measure = section.get("Strain measure");
      const bool is_logarithmic = measure == "logarithmic" ||
                                  (measure == "automatic" && section.get("Gradient") != "paper");
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
    explicit SmoothedParticle(const Section &section)
        : ParticleMethod<dim>(section, std::make_unique<SmoothedRows<dim>>(section),
                              strain_measure_of(section)),
          terms(section), conduction(section)
    {}

    static void declare_parameters(const Entries &e)
    {
      ParticleMethod<dim>::declare_shared_parameters(e, "current");
      SmoothedRows<dim>::declare_parameters(e);
      declare<PairTerms<dim>>(e);
      declare<PairConduction<dim>>(e);
      e.choice("Strain measure", "automatic", "automatic|logarithmic|rate",
               "What the stress follows: the elastic logarithmic strain, from whose energy the "
               "forces derive, or the rate of deformation with an objective rate of the Cauchy "
               "stress. `automatic` is `rate` with `Gradient = paper`, and `logarithmic` else.");
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
      node_volumes.assign(partition.n_local(), 0.);
      for (std::size_t place = 0; place < found.nodes().size(); ++place)
        node_volumes[found.nodes()[place]] =
            supports[place * node_stride + RadialRows<dim>::volume_slot];
    }

    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      if (conduction.is_on())
        conduction.add_conduction(pair_rows(), heat->conductivity(), position.data(),
                                  of_conductivity.data(), temperature.data(), heat_rate.data());
      else
        ParticleMethod<dim>::add_conduction(position, of_conductivity, temperature, heat_rate);
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
      for (unsigned int i = 0; i < rows.shape->n_particles(); ++i)
      {
        const double step = 1. / (2. * diffusivity * conduction.decay(rows, i, position.data()));
        if (!(step < limit.time_step))
          continue;
        limit.time_step = step;
        for (unsigned int d = 0; d < dim; ++d)
          limit.place[d] = position.node(rows.shape->particle_node[i])[d];
      }
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
      return {&this->stencils(), node_volumes.data(), initial,
              points.size() > 0 ? points.component(MaterialPoints::volume, 0) : initial,
              &kernel_slope};
    }

    bool visit_conductances(const NodalVector &position, const NodalVector &of_conductivity,
                            const typename PairConduction<dim>::Visitor &visit) const override
    {
      if (!conduction.is_on())
        return false;
      conduction.for_each_pair(pair_rows(), heat->conductivity(), position.data(),
                               of_conductivity.data(), visit);
      return true;
    }

  private:
    PairTerms<dim> terms;
    PairConduction<dim> conduction;
    RadialTable kernel_slope;                      // |dW/dr|
    std::vector<double> node_volumes;              // V⁰ by local node, ghosts and images too
    std::shared_ptr<const ThermalProperties> heat; // null: a scene without heat
  };

  template class SmoothedParticle<2>;

  template class SmoothedParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedParticle, "smoothed particle",
      "smoothed particle hydrodynamics (SPH) with corrected gradients, or those of the paper")
} // namespace tombolo
