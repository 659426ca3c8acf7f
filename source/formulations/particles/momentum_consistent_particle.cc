// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/least_squares_rows.h>
#include <tombolo/formulations/particles/particle_method.h>

#include <string>

namespace tombolo
{
  using namespace dealii;

  /** `Strain measure` of particles, whose default follows `Smoothing`. Throws the InputError of a
   * logarithmic measure with a smoothing by which positions do not move with the velocity that
   * strains. */
  StrainMeasure particle_strain_measure(const Entries &e)
  {
    const std::string measure = e.choice(
        "Strain measure", "automatic", "automatic|logarithmic|rate",
        "What the stress follows: the elastic logarithmic strain, from whose energy the forces "
        "derive, or the rate of deformation with an objective rate of the Cauchy stress. The first "
        "needs positions that move with the velocity that strains: `automatic` is `logarithmic` "
        "with the smoothings affine and none, and `rate` with others.");
    const std::string smoothing = e.given("Smoothing");
    const bool positions_follow = smoothing == "affine" || smoothing == "none";
    e.refuse(measure == "logarithmic" && !positions_follow, "Strain measure",
             "the logarithmic strain is that of the positions, and with `Smoothing = " + smoothing +
                 "` these do not move with the velocity that strains; allowed is rate, or "
                 "the smoothing affine or none");
    return measure != "rate" && positions_follow ? StrainMeasure::logarithmic : StrainMeasure::rate;
  }

  /**
   * The particle method of Pan et al. 2019 (doc/method.md, sections 2 and 6): moving least squares
   * shape functions on cuboidal supports, direct nodal integration with one point at every node,
   * momentum-consistent smoothing (done by the bridge).
   */
  template <int dim>
  class MomentumConsistentParticle : public ParticleMethod<dim>
  {
  public:
    explicit MomentumConsistentParticle(const Section &section)
        : ParticleMethod<dim>(section, std::make_unique<LeastSquaresRows<dim>>(section),
                              particle_strain_measure(section))
    {
      const auto &of_method = static_cast<const LeastSquaresRows<dim> &>(*this->rows);
      const Kernel &kernel_function = of_method.kernel();
      this->smoothing_settings =
          SmoothingSettings::read(section, kernel_function, of_method.dilation());
    }

    static void declare_parameters(const Entries &e)
    {
      ParticleMethod<dim>::declare_shared_parameters(e, "total Lagrangian");
      LeastSquaresRows<dim>::declare_parameters(e);
      SmoothingSettings::declare_parameters(e);
      particle_strain_measure(e);
    }
  };

  template class MomentumConsistentParticle<2>;

  template class MomentumConsistentParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, MomentumConsistentParticle, "momentum consistent particle",
      "moving least squares particles, nodally integrated, with momentum-consistent smoothing")
} // namespace tombolo
