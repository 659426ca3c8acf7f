// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/state/material_points.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * When the bond between two particles breaks: a function of a measure at both of them, of which
   * the mean counts, and of the stretch of the pair, its present over its initial distance. Both
   * are the same seen from either end, and so on every rank. In batches; it has no neighbourhoods.
   */
  class BondFailure
  {
  public:
    virtual ~BondFailure() = default;

    /** Throws the InputError that points with these fields cannot be judged. */
    virtual void check(const MaterialPoints & /*points*/) const {}

    virtual bool needs_deformation() const
    {
      return false;
    }

    /** By particle. @p deformation: F since the start, 3×3 always; empty unless it is needed. */
    virtual void measure(const MaterialPoints &points,
                         const std::vector<dealii::Tensor<2, 3>> &deformation,
                         std::vector<double> &value) const = 0;

    /** No pair is checked where no measure reaches this; minus infinity: there is no such bound. */
    virtual double threshold() const = 0;

    /** Which of @p n pairs break, 1 or 0, by the mean of their measures and their stretches. */
    virtual void judge(unsigned int n, const double *mean, const double *stretch,
                       std::uint8_t *breaks) const = 0;
  };

  template <>
  struct PluginKind<BondFailure>
  {
    static constexpr const char *name = "bond failure";
  };

  /** When bonds are checked, and which of them the chosen BondFailure breaks. */
  template <int dim>
  class BondCheck
  {
  public:
    explicit BondCheck(const Entries &e)
    {
      criterion =
          e.plugin<BondFailure>("Bond failure", "none",
                                "When bonds between particles break, for good: a criterion with a "
                                "section of its own, or `none`. Broken bonds leave the supports of "
                                "both particles; mass, momentum and stress stay.",
                                "none");
      name = e.given("Bond failure");
      interval = e.integer("Steps between bond checks", "5", between(1, 1000000),
                           "Bond failure: bonds are checked every so many steps.");
      e.plugins<BondFailure>();
      isolates_without_broken =
          e.choice(
              "Isolate distorted", "with broken bonds", "with broken bonds|all",
              "Bond failure: which particles lose all their bonds where they are turned inside "
              "out, or where their gradients grow to three times those of the start: `with "
              "broken bonds`, or `all`, in flows that tear the neighbours of a particle away. A "
              "particle that is turned inside out otherwise ends the run.") == "all";
    }

    const std::string &criterion_name() const
    {
      return name;
    }
    bool needs_deformation() const
    {
      return criterion->needs_deformation();
    }

    /** Whether also particles without broken bonds are isolated where they are distorted. */
    bool isolates_all() const
    {
      return isolates_without_broken;
    }

    /** Begins to count steps. Throws InputError where @p points cannot be judged. */
    void start(const MaterialPoints &points)
    {
      criterion->check(points);
      steps_since_check = 0;
    }

    /** Counts a step; whether its bonds are checked. */
    bool is_due()
    {
      if (++steps_since_check < interval)
        return false;
      steps_since_check = 0;
      return true;
    }

    /** Computes the measure of each particle; whether any on any rank reaches the threshold, so
     * that find_breaking() is due. @p deformation as in BondFailure. Collective. */
    bool measure(const MaterialPoints &points, const std::vector<dealii::Tensor<2, 3>> &deformation,
                 const MPI_Comm communicator)
    {
      criterion->measure(points, deformation, measures);
      double largest = std::numeric_limits<double>::lowest();
      for (const double value : measures)
        largest = std::max(largest, value);
      return !(dealii::Utilities::MPI::max(largest, communicator) < criterion->threshold());
    }

    /** Sends the measures and the initial positions of particles to other ranks. Collective. */
    void exchange(const std::shared_ptr<const NodePartition> &partition,
                  const std::vector<dealii::Point<dim>> &initial_positions, const Stencils &shape)
    {
      pair_data.fit_to(partition, Quantity::position);
      pair_data.fill(shape.particle_node,
                     [&](const std::size_t i, double *const data)
                     {
                       std::copy_n(initial_positions[i].begin_raw(), dim, data);
                       data[node_stride - 1] = measures[i];
                     });
    }

    /** Entries of row @p i whose bonds break at @p position, with ghosts as of exchange(). */
    const std::vector<unsigned int> &
    find_breaking(const unsigned int i, const NodalVector &position, const Stencils &shape)
    {
      const double threshold = criterion->threshold();
      const unsigned int own = shape.particle_node[i];
      const double *const own_data = pair_data.node(own), *const own_position = position.node(own);
      const Stencils::Row row = shape.row(i);
      entries.clear();
      mean.clear();
      stretch.clear();
      breaking.clear();
      for (unsigned int k = 0; k < row.size; ++k)
      {
        if (!row.is_within_support(k) || row.neighbour[k] == own)
          continue;
        const double *const data = pair_data.node(row.neighbour[k]);
        const double pair_mean = 0.5 * (own_data[node_stride - 1] + data[node_stride - 1]);
        if (pair_mean < threshold)
          continue;
        const double *const other_position = position.node(row.neighbour[k]);
        double now = 0, before = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          now += (other_position[d] - own_position[d]) * (other_position[d] - own_position[d]);
          before += (data[d] - own_data[d]) * (data[d] - own_data[d]);
        }
        entries.push_back(k);
        mean.push_back(pair_mean);
        stretch.push_back(std::sqrt(now / before));
      }
      if (entries.empty())
        return breaking;
      verdict.resize(entries.size());
      criterion->judge(static_cast<unsigned int>(entries.size()), mean.data(), stretch.data(),
                       verdict.data());
      for (std::size_t n = 0; n < entries.size(); ++n)
        if (verdict[n] != 0)
          breaking.push_back(entries[n]);
      return breaking;
    }

    void list(Records &records)
    {
      records.value("steps since bond check", steps_since_check);
    }

  private:
    std::string name;
    std::unique_ptr<BondFailure> criterion;
    unsigned int interval;
    bool isolates_without_broken;
    unsigned int steps_since_check = 0;
    std::vector<double> measures;
    NodalVector pair_data; // initial position, and the measure in the pad

    // Of the pairs of a row.
    std::vector<unsigned int> entries, breaking;
    std::vector<double> mean, stretch;
    std::vector<std::uint8_t> verdict;
  };
} // namespace tombolo
