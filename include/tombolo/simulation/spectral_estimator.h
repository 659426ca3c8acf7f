#pragma once

#include <tombolo/simulation/step_estimator.h>

namespace tombolo
{
  /**
   * The stable step from the spectrum of the real update operator, 2/√λ with λ the largest
   * eigenvalue of A = Φ_γ M⁻¹ K S_γ, which is self-adjoint in the inner product of M̂ (section 5 of
   * the method page). Artificial viscosity C sees velocities that lag by half a step: the limit is
   * then the Δt at which the largest eigenvalue of Δt² K + 2 Δt C is 4, found by Newton's method.
   *
   * λ is found by the locally optimal conjugate gradient method (Knyazev 2001) without
   * preconditioner, on three vectors: the estimate, its residual and the last direction. It is
   * approached from below, so that the result is scaled by a margin. The first call starts from
   * noise and takes at least as many iterations as a Krylov space from noise needs for any
   * spectrum, however dense its upper end (Kuczyński and Woźniakowski 1992); a later call starts
   * from the last eigenvector with some noise, since another place may limit the step by now.
   */
  template <int dim>
  class SpectralEstimator : public StepEstimator<dim>
  {
  public:
    explicit SpectralEstimator(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);
    StepLimit estimate(Scene<dim> &scene) override;
    bool is_cheap() const override;
    void serialize(StateArchive &archive, const Scene<dim> &scene) override;

    /** Applications of the operator in the last call. */
    unsigned int n_applications() const;

  private:
    /** result = A v̂, v̂ with current ghosts. */
    /** Zero in prescribed components: what is left is the motion that is free. */
    void remove_constrained(const Scene<dim> &scene, NodalVector &vector) const;
    void apply(Scene<dim> &scene, const NodalVector &v_hat, double time_step, NodalVector &result);
    /** mode = mode / |mode| + share * noise of that norm. */
    void add_noise(Scene<dim> &scene, double share);
    /** Largest eigenvalue of A; the eigenvector goes into mode. */
    double largest_eigenvalue(Scene<dim> &scene, double time_step, unsigned int min_iterations);
    /** mode·C mode of the normalized mode, by two applications. */
    double viscous_part(Scene<dim> &scene, double time_step);
    /** Names the node that moves most in the mode; the same on any number of ranks. */
    void find_entity(Scene<dim> &scene, StepLimit &limit) const;

    double tolerance;
    unsigned int max_iterations;
    unsigned int count = 0;
    unsigned int n_calls = 0;
    bool has_viscosity = false;
    double last_time_step = 0; // before the margin
    NodalVector mode;          // the last eigenvector, v̂
    NodalVector velocity, force, element_force;
  };
} // namespace tombolo
