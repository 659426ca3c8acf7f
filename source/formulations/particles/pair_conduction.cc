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
  void PairConduction<dim>::find_factors(const PairRows &rows, const double *position) const
  {
    // Sums of the rows: of the squared distances, and of one, times V⁰ of the row.
    of_nodes.resize_fast(rows.n_nodes * node_stride);
    of_nodes.fill(0.);
    const Stencils &shape = *rows.shape;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      Lanes squares = 0., sum = 0., of_other[2];
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                            {
                              squares += pairs.of_row * pairs.squared;
                              sum += pairs.of_row;
                              of_other[0] = pairs.of_other * pairs.squared;
                              of_other[1] = pairs.of_other;
                              add_to_nodes(of_other, pairs.node, pairs.n, of_nodes.data());
                            });
      double *const own = &of_nodes[std::size_t(shape.particle_node[row]) * node_stride];
      own[0] += reduce(squares);
      own[1] += reduce(sum);
    }
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      double *const own = &of_nodes[std::size_t(shape.particle_node[row]) * node_stride];
      const double moment = own[0] / rows.initial_volume[row];
      own[0] = rows.volume_ratio(row) * (method == Method::paper         ? 1.
                                         : moment * largest_factor > dim ? dim / moment
                                                                         : largest_factor);
      own[1] /= rows.initial_volume[row];
    }
  }

  template <int dim>
  template <typename Use>
  void PairConduction<dim>::visit_pairs(const PairRows &rows, const TemperatureTable &conductivity,
                                        const double *position, const double *of_conductivity,
                                        const Use &use) const
  {
    if (conductivity.largest() == 0.)
      return;
    find_factors(rows, position);
    for (std::size_t slot = 0; slot < rows.n_nodes * node_stride; slot += node_stride)
      of_nodes[slot + 1] = conductivity.is_constant() ? conductivity.largest()
                                                      : conductivity.value(of_conductivity[slot]);
    const Stencils &shape = *rows.shape;
    Lanes other[2];
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double *const own = &of_nodes[std::size_t(shape.particle_node[row]) * node_stride];
      for_pairs_of_row<dim>(rows, row, position,
                            [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                            {
                              gather_nodes(of_nodes.data(), pairs.node, other);
                              const Lanes sum = own[1] + other[1];
                              Lanes conductance =
                                  2. * own[1] * other[1] *
                                  (own[0] * pairs.of_row + other[0] * pairs.of_other) / sum;
                              where(!(sum > 0.), conductance) = 0.;
                              use(shape.particle_node[row], pairs, conductance);
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
                [&](const unsigned int i, const RowPairs<dim> &pairs, const Lanes &conductance)
                {
                  Lanes heat[1];
                  gather_nodes(temperature, pairs.node, heat);
                  heat[0] = conductance * (temperature[std::size_t(i) * node_stride] - heat[0]);
                  add_to_nodes(heat, pairs.node, pairs.n, heat_rate);
                  heat_rate[std::size_t(i) * node_stride] -= reduce(heat[0]);
                });
  }

  template <int dim>
  void PairConduction<dim>::for_each_pair(const PairRows &rows,
                                          const TemperatureTable &conductivity,
                                          const double *position, const double *of_conductivity,
                                          const Visitor &visit) const
  {
    visit_pairs(rows, conductivity, position, of_conductivity,
                [&](const unsigned int i, const RowPairs<dim> &pairs, const Lanes &conductance)
                {
                  for (unsigned int lane = 0; lane < pairs.n; ++lane)
                    if (conductance[lane] > 0.)
                      visit(i, pairs.node[lane], conductance[lane]);
                });
  }

  template <int dim>
  void
  PairConduction<dim>::for_each_decay(const PairRows &rows, const double *position,
                                      const std::function<void(unsigned int, double)> &use) const
  {
    find_factors(rows, position);
    for (unsigned int row = 0; row < rows.shape->n_particles(); ++row)
    {
      const double *const own =
          &of_nodes[std::size_t(rows.shape->particle_node[row]) * node_stride];
      use(row, own[0] / rows.volume_ratio(row) * own[1]);
    }
  }

  template class PairConduction<2>;
  template class PairConduction<3>;
} // namespace tombolo
