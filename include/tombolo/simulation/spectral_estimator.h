#pragma once

#include <tombolo/simulation/step_estimator.h>

namespace tombolo
{
  /**
   * The stable step from the spectrum of the real update operator, 2/√λ with λ the largest
   * eigenvalue of A = Φ_γ M⁻¹ (K + 2C/Δt) S_γ, which is self-adjoint in the inner product of M̂
   * (section 5 of the method page). With artificial viscosity C, velocities lag by half a step and
   * the limit is the Δt at which λ(Δt) Δt² = 4; a few fixed-point passes find it.
   *
   * λ is found by the locally optimal conjugate gradient method (Knyazev 2001) without
   * preconditioner, on three vectors: the estimate, its residual and the last direction. It is
   * approached from below, so that the result is scaled by a margin. A later call starts from the
   * eigenvector of the last.
   */
  template <int dim>
  class SpectralEstimator : public StepEstimator<dim>
  {
  public:
    explicit SpectralEstimator(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);
    StepLimit estimate(Scene<dim> &scene) override;
    bool is_cheap() const override;

    /** Applications of the operator in the last call. */
    unsigned int n_applications() const;

  private:
    /** result = A v̂, v̂ with current ghosts. */
    void apply(Scene<dim> &scene, const NodalVector &v_hat, double time_step, NodalVector &result);
    /** Largest eigenvalue; the eigenvector goes into mode. */
    double largest_eigenvalue(Scene<dim> &scene, double time_step, bool is_first);

    double tolerance;
    unsigned int max_iterations;
    unsigned int count = 0;
    NodalVector mode;                 // the last eigenvector, v̂
    NodalVector velocity, force, element_force;
  };
} // namespace tombolo
