// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/formulations/particles/cell_averages.h>
#include <tombolo/formulations/particles/particle_rows.h>
#include <tombolo/formulations/particles/patch_test_gradients.h>

namespace tombolo
{
  /**
   * Rows of moving least squares in the reference of the kernels, or of averages over cells, with
   * gradients that pass the patch test where these are chosen. Equal rows are kept once where that
   * pays.
   */
  template <int dim>
  class LeastSquaresRows : public ParticleRows<dim>
  {
  public:
    /** `Kernel`, `Dilation`, and those of averages and of gradients. */
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError. */
    explicit LeastSquaresRows(const Section &section);

    /** Throws the InputError of consistent gradients with a kernel that is renewed at each step. */
    void check_gradients() const;

    void fill(const Neighbourhoods<dim> &found, const double *position, const double *support,
              Stencils &stencils) override;
    double dilation() const override;
    const char *support_entry() const override;
    bool choose_functions(const PartSetup<dim> &setup, ParticleSet<dim> &particles) override;
    void initialize(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                    bool smooths) override;
    std::string functions() const override;
    bool needs_fixed_mesh() const override;
    void make_gradients_consistent(const ParticleSet<dim> &particles,
                                   const KernelConfiguration<dim> &kernel,
                                   const NodalVector &position) override;
    void make_gradients_consistent(const ParticleSet<dim> &particles,
                                   const KernelConfiguration<dim> &kernel,
                                   const std::vector<double> &position) override;
    PatchTest patch_test(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                         const KernelConfiguration<dim> &kernel, bool smooths,
                         const NodalVector &position) const override;
    dealii::IndexSet required_nodes(const ParticleSet<dim> &particles) const override;
    std::size_t memory_consumption() const override;

    const Kernel &kernel() const;

  private:
    using ParticleRows<dim>::section;
    using ParticleRows<dim>::shape;
    using ParticleRows<dim>::neighbours;

    void restrict_neighbours() override;
    std::string describe_defects(const double *position, const double *support) const override;

    double support_dilation;
    bool shares_rows;
    CellAverages<dim> averages;
    PatchTestGradients<dim> consistent_gradients;
    MovingLeastSquares<dim> least_squares;
    const std::vector<BasisDefect> *defects = nullptr; // of the last fill(), in least_squares
  };
} // namespace tombolo
