// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/radial_rows.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/particle_rows.h>

#include <memory>

namespace tombolo
{
  /**
   * Rows of smoothed particle hydrodynamics (RadialRows), with one smoothing length for all
   * particles of the part: a multiple of their spacing, the dim-th root of the mean volume of the
   * cells that they come from.
   *
   * Where planes of symmetry leave a piece of a body, a particle on a plane has that part of its
   * volume (and mass) that is in the piece, with which its stress acts on its neighbours and on
   * their images alike. Its neighbours see all of it: V⁰ in RadialRows is that of the whole body.
   */
  template <int dim>
  class SmoothedRows : public ParticleRows<dim>
  {
  public:
    /** `Kernel`, `Smoothing length`, `Gradient` and `Correction limit`. */
    static void declare_parameters(const Entries &e);

    /** Throws InputError. */
    explicit SmoothedRows(const Section &section);

    void fill(const Neighbourhoods<dim> &found, const double *position, const double *support,
              Stencils &stencils) override;
    double dilation() const override
    {
      return 2. * relative_length;
    }
    const char *support_entry() const override
    {
      return "Smoothing length";
    }
    bool choose_supports(const PartSetup<dim> &setup, const CellSelection<dim> &is_taken,
                         ParticleSet<dim> &particles) override;
    std::string functions() const override;
    bool are_undeformed_when_new() const override;
    bool depend_on_volumes() const override
    {
      return is_current;
    }
    void set_present_volumes(const std::vector<double> &volumes) override;

    bool are_corrected() const
    {
      return is_corrected;
    }
    const RadialKernel<dim> &radial_kernel() const
    {
      return radial_rows->kernel();
    }

  private:
    /** With kernels at present positions rows hold those of their candidates that are within two
     * smoothing lengths now: sweeps over rows are shorter. Not with bonds, which know neighbours by
     * their place among the candidates. */
    Stencils &searched() override
    {
      return is_compact ? candidates : this->shape;
    }
    void renumber(const NodePartition &partition) override;
    /** Leaves those neighbours that can come within the support while candidates hold. */
    void restrict_neighbours() override;
    std::string describe_defects(const double *position, const double *support) const override;

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
} // namespace tombolo
