// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/cell_averages.h>
#include <tombolo/formulations/particles/particle_method.h>
#include <tombolo/formulations/particles/particle_rows.h>

#include <cmath>
#include <sstream>
#include <string>

namespace tombolo
{
  namespace
  {
    std::shared_ptr<const Kernel> create_kernel(const Entries &e)
    {
      std::shared_ptr<const Kernel> kernel =
          read_kernel(e, "cubic spline", "The kernel of the moving least squares.");
      e.refuse(!kernel->is_smooth_at_zero(), "Kernel",
               "it has a kink at zero, where moving least squares need its "
               "derivative; allowed are smooth kernels, such as `cubic spline` and "
               "`quintic spline`");
      return kernel;
    }
  } // namespace

  /** Rows of moving least squares in the reference of the kernels, or of averages over cells. */
  template <int dim>
  class LeastSquaresRows : public ParticleRows<dim>
  {
  public:
    /** `Row precision`. Throws the InputError of rows that are found anew in each step. */
    static bool is_rounded(const Entries &e)
    {
      const bool is_single =
          e.choice(
              "Row precision", "double", "double|single",
              "How shape functions are kept. `single`, with errors of 1e-7, is for large bodies "
              "whose particles have each its own, since meshes are no lattices; not for "
              "`current` kernels.") == "single";
      e.refuse(is_single && e.given("Configuration") == "current", "Row precision",
               "`single` is for rows that stay for some steps, which they do not with "
               "`Configuration = current`; allowed is double");
      return is_single;
    }

    /** Throws InputError. */
    explicit LeastSquaresRows(const Entries &e)
        : ParticleRows<dim>(e, e.given("Configuration") == "current" ? 0.1 : 0.),
          least_squares(create_kernel(e)),
          support_dilation(e.number(
              "Dilation", "1.8", any_number(), "",
              "Half width of a support over the largest distance to a neighbouring node, axis by "
              "axis; above 1, usually 1.5 to 1.9.")),
          rounds_rows(is_rounded(e)), averages(e),
          // A search for equal rows pays where they stay.
          shares_rows(e.given("Configuration") == "total Lagrangian")
    {
      e.refuse(!(support_dilation > 1. && support_dilation <= 10.), "Dilation",
               "allowed is a number above 1 and up to 10; usual are 1.5 to 1.9. At 1 or "
               "below a particle has no neighbours along an axis");
      if (shares_rows)
        neighbours.order_by_offset();
    }

    void fill(const Neighbourhoods<dim> &found, const double *const position,
              const double *const support, Stencils &stencils) override
    {
      defects = nullptr;
      stencils.inverse_deformation_is_current = false;
      stencils.rounded.clear();
      if (averages.is_on())
        averages.fill(found, shares_rows, stencils);
      else
        find_least_squares(found, position, support, stencils);
      if (rounds_rows)
        stencils.round();
    }
    double dilation() const override
    {
      return support_dilation;
    }
    const char *support_entry() const override
    {
      return "Dilation";
    }
    bool choose_functions(PartSetup<dim> &setup, ParticleSet<dim> &particles) override
    {
      averages.choose(setup);
      if (averages.is_on())
        averages.establish(particles, rounds_rows);
      return averages.is_on();
    }
    CellDilatation<dim> *dilatation_of_cells() override
    {
      return averages.dilatation_of_cells();
    }
    ZeroEnergyControl *zero_energy_control() override
    {
      return averages.zero_energy_control();
    }
    std::string functions() const override
    {
      return averages.description() + (rounds_rows ? ", in single precision" : "");
    }
    PatchTest patch_test(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                         const KernelConfiguration<dim> &kernel, const bool smooths,
                         const NodalVector &position) const override
    {
      PatchTest result;
      if (setup.source || !setup.has_mechanics)
        return result;
      result.is_known = true;
      result.defect = patch_test_defect(setup, particles, smooths, kernel.volumes(particles),
                                        position, shape, averages.own_shares());
      if (!averages.is_on() && averages.obstacle(setup).empty())
        result.cure = "Shape functions = cell averages";
      return result;
    }

    const Kernel &kernel() const
    {
      return least_squares.kernel();
    }

  private:
    using ParticleRows<dim>::section;
    using ParticleRows<dim>::shape;
    using ParticleRows<dim>::neighbours;

    void find_least_squares(const Neighbourhoods<dim> &found, const double *const position,
                            const double *const support, Stencils &stencils)
    {
      defects = &least_squares.compute(found.nodes(), position, support, stencils, shares_rows);
      stencils.rank_deficient_rows.clear();
      stencils.non_negative_rows.clear();
      for (const BasisDefect &defect : *defects)
        stencils.rank_deficient_rows.push_back(defect.row);
    }
    void renumber(const NodePartition &partition) override
    {
      ParticleRows<dim>::renumber(partition);
      if (CellDilatation<dim> *const cell_dilatation = averages.dilatation_of_cells())
        cell_dilatation->set_partition(partition);
    }
    bool assign_neighbours(const ParticleSet<dim> &particles, const std::vector<double> &position,
                           const std::vector<double> &support) override
    {
      if (averages.is_on())
        averages.assign(particles, position, support, neighbours, shape);
      return averages.is_on();
    }
    std::string describe_defects(const double *position, const double *support) const override
    {
      if (defects == nullptr || defects->empty())
        return {};
      const BasisDefect &defect = defects->front();
      const unsigned int node = shape.particle_node[defect.row];
      std::ostringstream text;
      text << this->particle_at(defect.row, position) << " has " << defect.n_neighbours
           << " neighbours (itself included), which do not carry a linear basis at dilation "
           << support_dilation << ".";
      const double factor =
          least_squares.sufficient_support_factor(node, neighbours.nodes(), position, support);
      if (factor > 0.)
        text << " A dilation of " << std::ceil(100. * support_dilation * factor) / 100.
             << " would do there.";
      else
        text << " No dilation up to eight times that one would do: are its cells a single layer?";
      return text.str();
    }

    MovingLeastSquares<dim> least_squares;
    double support_dilation;
    bool rounds_rows;
    CellAverages<dim> averages;
    bool shares_rows;
    const std::vector<BasisDefect> *defects = nullptr; // of the last fill(), in least_squares
  };

  /** `Strain measure` of particles, whose default follows `Smoothing`. Throws the InputError of a
   * logarithmic one with a smoothing by which positions do not move with the straining velocity. */
  StrainMeasure particle_strain_measure(const Entries &e)
  {
    const std::string measure = e.choice(
        "Strain measure", "automatic", "automatic|logarithmic|rate",
        "What the stress follows: the elastic logarithmic strain, from whose energy the forces "
        "derive, or the rate of deformation with an objective rate of the Kirchhoff stress. The "
        "first needs positions that move with the velocity that strains: `automatic` is "
        "`logarithmic` with the smoothings affine and none, and `rate` with others.");
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
    explicit MomentumConsistentParticle(const Entries &e)
        : ParticleMethod<dim>(e, std::make_unique<LeastSquaresRows<dim>>(e), "total Lagrangian")
    {
      const auto &method_rows = static_cast<const LeastSquaresRows<dim> &>(*this->rows);
      this->smoothing_settings =
          SmoothingSettings::read(e, method_rows.kernel(), method_rows.dilation());
      this->part_points = PartPoints{BulkViscosity(e), particle_strain_measure(e)};
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, MomentumConsistentParticle, "momentum consistent particle",
      "moving least squares particles, nodally integrated, with momentum-consistent smoothing")
} // namespace tombolo
