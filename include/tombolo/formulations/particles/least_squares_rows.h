// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/cell_averages.h>
#include <tombolo/formulations/particles/particle_rows.h>

namespace tombolo
{
  /**
   * Rows of moving least squares in the reference of the kernels, or of averages over cells. Equal
   * rows are kept once where that pays.
   */
  template <int dim>
  class LeastSquaresRows : public ParticleRows<dim>
  {
  public:
    /** `Kernel`, `Dilation`, and those of averages. */
    static void declare_parameters(const Entries &e);

    /** Throws InputError. */
    explicit LeastSquaresRows(const Section &section);

    void fill(const Neighbourhoods<dim> &found, const double *position, const double *support,
              Stencils &stencils) override;
    double dilation() const override
    {
      return support_dilation;
    }
    const char *support_entry() const override
    {
      return "Dilation";
    }
    bool choose_functions(const PartSetup<dim> &setup, ParticleSet<dim> &particles) override;
    std::string functions() const override
    {
      return averages.description();
    }
    PatchTest patch_test(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                         const KernelConfiguration<dim> &kernel, bool smooths,
                         const NodalVector &position) const override;

    const Kernel &kernel() const
    {
      return least_squares.kernel();
    }

  private:
    using ParticleRows<dim>::section;
    using ParticleRows<dim>::shape;
    using ParticleRows<dim>::neighbours;

    void restrict_neighbours() override
    {
      if (averages.is_on())
        averages.restrict(neighbours, shape);
    }
    std::string describe_defects(const double *position, const double *support) const override;

    double support_dilation;
    bool shares_rows;
    CellAverages<dim> averages;
    MovingLeastSquares<dim> least_squares;
    const std::vector<BasisDefect> *defects = nullptr; // of the last fill(), in least_squares
  };
} // namespace tombolo
