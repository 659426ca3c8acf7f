// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/smoothed_particle.h>

#include <tombolo/formulations/particles/particle_cost.h>
#include <tombolo/formulations/particles/smoothed_rows.h>

#include <algorithm>
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
  } // namespace

  template <int dim>
  void SmoothedParticle<dim>::declare_parameters(ParameterHandler &handler)
  {
    ParticleMethod<dim>::declare_shared_parameters(handler, "current");
    SmoothedRows<dim>::declare_parameters(handler);
    handler.declare_entry(
        "Strain measure", "automatic", Patterns::Selection("automatic|logarithmic|rate"),
        "What the stress follows: the elastic logarithmic strain, from whose energy the forces "
        "derive, or the rate of deformation with an objective rate of the Cauchy stress. "
        "`automatic` is `rate` with `Gradient = paper`, and `logarithmic` else.");
  }

  template <int dim>
  SmoothedParticle<dim>::SmoothedParticle(const Section &section)
      : ParticleMethod<dim>(section, std::make_unique<SmoothedRows<dim>>(section),
                            strain_measure_of(section))
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

  template class SmoothedParticle<2>;
  template class SmoothedParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedParticle, "smoothed particle",
      "smoothed particle hydrodynamics (SPH) with corrected gradients, or those of the paper")
} // namespace tombolo
