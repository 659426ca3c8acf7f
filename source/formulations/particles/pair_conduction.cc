// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/pair_interactions.h>

#include <tombolo/base/input/entries.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    /** Σ_j V |x_j| |W'(x_j)| / dim of a cubic lattice of this spacing. */
    template <int dim>
    double lattice_sum(const std::function<double(double)> &slope, const double radius,
                       const double spacing)
    {
      const int n = static_cast<int>(std::ceil(radius / spacing));
      const int n_in_depth = dim == 3 ? n : 0;
      double sum = 0;
      for (int i = -n; i <= n; ++i)
        for (int j = -n; j <= n; ++j)
          for (int k = -n_in_depth; k <= n_in_depth; ++k)
          {
            const double distance = spacing * std::sqrt(double(i * i + j * j + k * k));
            if (distance > 0. && distance < radius)
              sum += distance * slope(distance);
          }
      return sum * std::pow(spacing, dim) / dim;
    }
  } // namespace

  template <int dim>
  PairConduction<dim>::PairConduction(const Entries &e)
  {
    const std::string name =
        e.choice("Conduction", "corrected", "corrected|paper|gradients",
                 "How heat passes between particles: in pairs as in SPH, `corrected` by what the "
                 "sum over a lattice misses, or as in the `paper`, which conducts too little by "
                 "some percent at every spacing; or by the `gradients` of the rows, which do not "
                 "see temperatures that alternate from particle to particle. Pairs need a kernel "
                 "in the current configuration; others take `gradients` unless it is set.");
    const bool is_current = e.given("Configuration") == "current";
    if (e.declares() || name == "gradients" || (!is_current && !e.is_set("Conduction")))
      return;
    e.refuse(!is_current, "Conduction",
             "the distances of pairs do not fit the gradients of a kernel that keeps its "
             "reference; allowed is `gradients`, or `Configuration = current`.");
    method = name == "paper" ? Method::paper : Method::corrected;
  }

  template <int dim>
  void PairConduction<dim>::initialize(const std::function<double(double)> &slope,
                                       const double radius, const double spacing)
  {
    largest_factor =
        method == Method::corrected ? 1. / lattice_sum<dim>(slope, radius, spacing) : 1.;
  }

  template <int dim>
  double PairConduction<dim>::factor(const PairRows &rows, const unsigned int row,
                                     const double *position) const
  {
    if (method == Method::paper)
      return 1.;
    Lanes sum = 0.;
    for_pairs_of_row<dim>(rows, row, position,
                          [&](const RowPairs<dim> &pairs) { sum += pairs.weight * pairs.squared; });
    const double trace = sum_of_lanes(sum);
    return trace * largest_factor > dim ? dim / trace : largest_factor;
  }

  template <int dim>
  template <typename AnyVisitor>
  void PairConduction<dim>::visit_pairs(const PairRows &rows, const TemperatureTable &conductivity,
                                        const double *position, const double *of_conductivity,
                                        const AnyVisitor &visit) const
  {
    const auto conductivity_at = [&](const unsigned int node)
    {
      return conductivity.is_constant()
                 ? conductivity.largest()
                 : conductivity.value(of_conductivity[std::size_t(node) * node_stride]);
    };
    for (unsigned int row = 0; row < rows.shape->n_particles(); ++row)
    {
      const unsigned int particle = rows.shape->particle_node[row];
      const double own_conductivity = conductivity_at(particle);
      const double scale = 2. * rows.volume[row] * factor(rows, row, position) * own_conductivity;
      if (scale == 0.)
        continue;
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs)
                            {
                              for (unsigned int lane = 0; lane < pairs.n; ++lane)
                                if (const double weight = pairs.weight[lane]; weight > 0.)
                                {
                                  const double other = conductivity_at(pairs.node[lane]);
                                  visit(particle, pairs.node[lane],
                                        scale * weight * other / (own_conductivity + other));
                                }
                            });
    }
  }

  template <int dim>
  void PairConduction<dim>::add_conduction(const PairRows &rows,
                                           const TemperatureTable &conductivity,
                                           const double *position, const double *of_conductivity,
                                           const double *temperature, double *heat_rate) const
  {
    visit_pairs(rows, conductivity, position, of_conductivity,
                [&](const unsigned int i, const unsigned int j, const double conductance)
                {
                  const std::size_t own = std::size_t(i) * node_stride,
                                    other = std::size_t(j) * node_stride;
                  const double heat = conductance * (temperature[other] - temperature[own]);
                  heat_rate[own] += heat;
                  heat_rate[other] -= heat;
                });
  }

  template <int dim>
  void PairConduction<dim>::for_each_pair(const PairRows &rows,
                                          const TemperatureTable &conductivity,
                                          const double *position, const double *of_conductivity,
                                          const Visitor &visit) const
  {
    visit_pairs(rows, conductivity, position, of_conductivity, visit);
  }

  template <int dim>
  double PairConduction<dim>::decay(const PairRows &rows, const unsigned int row,
                                    const double *position) const
  {
    Lanes sum = 0.;
    for_pairs_of_row<dim>(rows, row, position,
                          [&](const RowPairs<dim> &pairs) { sum += pairs.weight; });
    return factor(rows, row, position) * sum_of_lanes(sum);
  }

  template class PairConduction<2>;
  template class PairConduction<3>;
} // namespace tombolo
