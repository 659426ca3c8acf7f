// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/smoothed_particle.h>

#include <tombolo/formulations/particles/particle_cost.h>
#include <tombolo/formulations/particles/smoothed_rows.h>

#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <array>
#include <limits>

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

  template <int dim>
  void SmoothedParticle<dim>::declare_parameters(const Entries &e)
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

  template <int dim>
  SmoothedParticle<dim>::SmoothedParticle(const Section &section)
      : ParticleMethod<dim>(section, std::make_unique<SmoothedRows<dim>>(section),
                            strain_measure_of(section)),
        terms(section), conduction(section)
  {}

  template <int dim>
  double SmoothedParticle<dim>::cost_per_cell(const Material &material,
                                              const double box_ratio) const
  {
    return particle_cost_per_cell<dim>(this->smoothing_settings, this->kernel,
                                       this->rows->dilation(), box_ratio) +
           material.cost_per_point();
  }

  template <int dim>
  NeighbourCounts SmoothedParticle<dim>::neighbour_counts() const
  {
    const Stencils &shape = this->stencils();
    NeighbourCounts counts;
    double sum = 0;
    counts.minimum = shape.n_particles() > 0 ? std::numeric_limits<unsigned int>::max() : 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      unsigned int n = 0;
      for (unsigned int k = 0; k < row.size; ++k)
        n += row.is_within_support(k) ? 1 : 0;
      counts.minimum = std::min(counts.minimum, n);
      counts.maximum = std::max(counts.maximum, n);
      sum += n;
    }
    counts.mean = shape.n_particles() > 0 ? sum / shape.n_particles() : 0.;
    return counts;
  }

  template <int dim>
  void SmoothedParticle<dim>::initialize(const PartSetup<dim> &setup)
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

  template <int dim>
  void SmoothedParticle<dim>::set_partition(const NodePartition &partition)
  {
    ParticleMethod<dim>::set_partition(partition);
    const Neighbourhoods<dim> &found = this->rows->neighbourhoods();
    const std::vector<double> &supports = found.support_at_search();
    node_volumes.assign(partition.n_local(), 0.);
    for (std::size_t place = 0; place < found.nodes().size(); ++place)
      node_volumes[found.nodes()[place]] =
          supports[place * node_stride + RadialRows<dim>::volume_slot];
  }

  template <int dim>
  const PairTerms<dim> &SmoothedParticle<dim>::pair_terms() const
  {
    return terms;
  }

  template <int dim>
  PairRows SmoothedParticle<dim>::pair_rows() const
  {
    const MaterialPoints &points = this->points();
    const double *const initial = this->set.initial_volumes().data();
    return {&this->stencils(), node_volumes.data(), initial,
            points.size() > 0 ? points.component(MaterialPoints::volume, 0) : initial,
            &kernel_slope};
  }

  template <int dim>
  void SmoothedParticle<dim>::add_conduction(const NodalVector &position,
                                             const NodalVector &of_conductivity,
                                             const NodalVector &temperature,
                                             NodalVector &heat_rate) const
  {
    if (conduction.is_on())
      conduction.add_conduction(pair_rows(), heat->conductivity(), position.data(),
                                of_conductivity.data(), temperature.data(), heat_rate.data());
    else
      ParticleMethod<dim>::add_conduction(position, of_conductivity, temperature, heat_rate);
  }

  template <int dim>
  bool SmoothedParticle<dim>::visit_conductances(
      const NodalVector &position, const NodalVector &of_conductivity,
      const typename PairConduction<dim>::Visitor &visit) const
  {
    if (!conduction.is_on())
      return false;
    conduction.for_each_pair(pair_rows(), heat->conductivity(), position.data(),
                             of_conductivity.data(), visit);
    return true;
  }

  template <int dim>
  StepLimit SmoothedParticle<dim>::diffusion_limit(const NodalVector &position) const
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

  template class SmoothedParticle<2>;
  template class SmoothedParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedParticle, "smoothed particle",
      "smoothed particle hydrodynamics (SPH) with corrected gradients, or those of the paper")
} // namespace tombolo
