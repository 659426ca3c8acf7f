// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/formulations/particles/particle_method.h>

namespace tombolo
{
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
    explicit SmoothedParticle(const Section &section);
    static void declare_parameters(const Entries &e);

    double cost_per_cell(const Material &material, double box_ratio) const override;
    NeighbourCounts neighbour_counts() const override;
    void initialize(const PartSetup<dim> &setup) override;
    void set_partition(const NodePartition &partition) override;
    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override;
    StepLimit diffusion_limit(const NodalVector &position) const override;

    const PairInteractions<dim> *pairs() const override
    {
      return this;
    }
    const PairTerms<dim> &pair_terms() const override;
    PairRows pair_rows() const override;
    bool visit_conductances(const NodalVector &position, const NodalVector &of_conductivity,
                            const typename PairConduction<dim>::Visitor &visit) const override;

  private:
    PairTerms<dim> terms;
    PairConduction<dim> conduction;
    RadialTable kernel_slope;                      // |dW/dr|
    std::vector<double> node_volumes;              // V⁰ by local node, ghosts and images too
    std::shared_ptr<const ThermalProperties> heat; // null: a scene without heat
  };
} // namespace tombolo
