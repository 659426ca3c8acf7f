// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/formulations/particles/rubbing_law.h>
#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/state/nodal_source.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The heat of a scene for contact between particles: null pointers without heat. */
  struct FragmentHeat
  {
    const NodalVector *temperature = nullptr; ///< θ^h at the present time, slot 0 of owned nodes
    const NodalEnthalpy *enthalpy = nullptr;
    /** Of owned nodes: heat received that no thermal step has applied yet, scalar [M L^2/T^2]. */
    const NodalVector *pending = nullptr;
    NodalSource *given = nullptr; ///< gets that of the step
  };

  /** The particles of this rank that can touch others: each node once, with all its parts. */
  struct TouchingRows
  {
    /** A row of the stencils of a part. */
    struct Site
    {
      unsigned int part; ///< its number among the parts in contact
      unsigned int row;
    };

    std::vector<unsigned int> nodes; ///< local numbers, ascending
    std::vector<std::uint64_t> ids;  ///< persistent identifiers
    std::vector<double> shares;      ///< in the piece of the body, of the particle in the whole one
    /** Of row i: sites[start[i]] to sites[start[i+1]], by part. The first is the particle's. */
    std::vector<Site> sites;
    std::vector<std::size_t> start;

    unsigned int size() const
    {
      return static_cast<unsigned int>(nodes.size());
    }
    const Site &site(const std::size_t i) const
    {
      return sites[start[i]];
    }
  };

  /** Pairs of particles that can touch. */
  struct FragmentPairs
  {
    std::vector<std::size_t> start;    ///< those of row i are start[i] to start[i+1]
    std::vector<unsigned int> partner; ///< local nodes, images of nodes among them
    std::vector<unsigned int> mirrors; ///< of the partner as an image, as bits; 0: it is none
  };

  /** Two particles of different bodies that touch, from the side of one of them. */
  template <int dim>
  struct FragmentTouch
  {
    unsigned int row;                ///< of this end
    std::size_t pair;                ///< its number
    unsigned int own, other;         ///< local nodes
    unsigned int own_law, other_law; ///< parts, among those in contact, whose laws hold
    dealii::Tensor<1, dim> normal;   ///< from this end to the other
    double own_lever, other_lever;   ///< distances of the centres from the point of contact [L]
    double normal_force;             ///< f_n of spring and damper [M L/T^2]
    double stiffness;                ///< of the spring along the normal [M/T^2]
    double area;                     ///< in contact [L^(dim-1)]
  };

  /**
   * Friction and conduction between particles of different bodies, beside the normal forces of
   * SphereContact.
   *
   * Along the surface two particles hang on a spring of half the stiffness k of that along the
   * normal. Its elongation s follows the motion of the two materials at the point of contact,
   *
   *   Δ = Δu_J + W_J r_J - Δu_I - W_I r_I,  without its normal component,
   *
   * with the displacements Δu of the step, the offsets r of the point of contact from the centres,
   * and the skew part W of Σ_K Δu_K ⊗ g_K by the present gradients g. Particles without a linear
   * basis (debris) are points without spin, W = 0. s turns with both materials and keeps its
   * length, and slips at |½ k s| = μ f_n. The forces act at the point of contact: their moments
   * about the centres are carried by the neighbours K as ½ (f ⊗ r - r ⊗ f) g_K, the adjoint of W.
   * So friction does not resist a rotation of a body, linear momentum is kept to round-off, and
   * angular momentum as well where neither end is debris. On debris it exerts the moment r × f that
   * would spin it, and that is lost.
   *
   * μ is that at the temperature of the hotter of the two, and of two parts the smaller one. Half
   * of the heat of friction is each end's, whatever the materials are. Conduction exchanges
   *
   *   q = e (1 - exp(-x))/x (T_J - T_I),  e = h A Δt,  x = Σ_I e/C_I + Σ_J e/C_J,
   *
   * with sums over all contacts of each end, the smaller h of two parts, and A = V^((dim-1)/dim) of
   * the smaller particle: the exact exchange of one pair, and never past the temperatures of all
   * that touch, whatever h. One end loses what the other receives, to round-off.
   */
  template <int dim>
  class FragmentFriction
  {
  public:
    struct Part
    {
      const RubbingLaw *law;
      FrictionOfPart<dim> *kept;
      const Stencils *shape;
    };

    explicit FragmentFriction(std::vector<Part> touching_parts) : parts(std::move(touching_parts))
    {
      for (const Part &part : parts)
      {
        any_rubs = any_rubs || part.law->rubs();
        any_conducts = any_conducts || part.law->conducts();
        part.kept->fetch_springs = [this] { return_springs(); };
      }
    }

    /** The pairs from now on, of @p pair_rows; local nodes are those of @p partition. Springs of
     * pairs that existed before are kept. Collective. */
    void set_pairs(const std::shared_ptr<const NodePartition> &partition,
                   const TouchingRows &pair_rows, const FragmentPairs &pairs)
    {
      return_springs();
      std::vector<KnownSpring> known;
      for (const Part &part : parts)
      {
        known.insert(known.end(), part.kept->springs.begin(), part.kept->springs.end());
        part.kept->springs.clear();
      }
      std::sort(known.begin(), known.end());
      rows = pair_rows;
      const NodalVector id_of_node = nodal_field(partition, Quantity::scalars, rows.nodes,
                                                 [&](const std::size_t i, double *const halves)
                                                 {
                                                   halves[0] = upper_half(rows.ids[i]);
                                                   halves[1] = lower_half(rows.ids[i]);
                                                 });
      row_of_pairs = pairs.start;
      partner_mirrors = pairs.mirrors;
      partner_ids.clear();
      for (const unsigned int node : pairs.partner)
        partner_ids.push_back(joined(id_of_node.node(node)[0], id_of_node.node(node)[1]));
      springs.assign(pairs.partner.size(), {});
      is_touching.assign(pairs.partner.size(), false);
      released_heat.assign(rows.size(), 0.);
      ends.fit_to(partition, Quantity::scalars);

      const auto find =
          [&](const std::uint64_t own, const std::uint64_t other, const unsigned int mirrors)
      {
        return std::lower_bound(known.begin(), known.end(), std::tie(own, other, mirrors),
                                [](const KnownSpring &a, const auto &pair)
                                { return std::tie(a.own, a.partner, a.mirrors) < pair; });
      };
      for (unsigned int i = 0; i < rows.size() && !known.empty(); ++i)
      {
        const std::uint64_t own = rows.ids[i];
        for (std::size_t pair = row_of_pairs[i]; pair < row_of_pairs[i + 1]; ++pair)
          if (const auto found = find(own, partner_ids[pair], partner_mirrors[pair]);
              found != known.end() && found->own == own && found->partner == partner_ids[pair] &&
              found->mirrors == partner_mirrors[pair])
            springs[pair] = std::exchange(found->spring, {});
        for (auto left = find(own, 0, 0); left != known.end() && left->own == own; ++left)
          release(i, left->spring);
      }
    }

    /** Whether pairs are set: they are not after a state was written or read. */
    bool has_pairs() const
    {
      return !row_of_pairs.empty();
    }

    /** Begins a step in which the particles have moved by @p moves. Rows with @p touches are in
     * contact; @p position, with the ghosts of the stencils, is that at its end. Collective. */
    void begin_step(const NodalVector &position, const std::vector<dealii::Tensor<1, dim>> &moves,
                    const std::vector<bool> &touches, const FragmentHeat &heat)
    {
      const auto set_move = [&](const std::size_t i, double *const node_move)
      {
        for (unsigned int d = 0; d < dim; ++d)
          node_move[d] = moves[i][d];
      };
      if (any_rubs)
      {
        displacement.fit_to(position.partition(), Quantity::vector);
        displacement.fill(rows.nodes, set_move);
        motion.fit_to(ends.partition(), Quantity::vector);
        motion.fill(rows.nodes, set_move);
        inverse_deformation.assign(rows.size(), {});
        couple.assign(rows.size(), {});
      }
      ends.fill(rows.nodes,
                [&](const std::size_t i, double *const end_values)
                {
                  if (touches[i])
                    set_end(static_cast<unsigned int>(i), position, heat, end_values);
                });
      reflect_spins();
      exchanges.clear();
      std::fill(is_touching.begin(), is_touching.end(), false);
    }

    /** The force of friction on this end in the whole body. Adds its half of the heat. */
    dealii::Tensor<1, dim> rub(const FragmentTouch<dim> &touch, const double time_step,
                               const FragmentHeat &heat)
    {
      const RubbingLaw &one = *parts[touch.own_law].law, &two = *parts[touch.other_law].law;
      const double share = rows.shares[touch.row];
      if (one.conducts() && two.conducts())
      {
        const double pressure = touch.normal_force / touch.area;
        const double conductance =
            std::min(one.conductance.value(pressure), two.conductance.value(pressure));
        exchanges.push_back({touch.own, touch.other, share * conductance * touch.area * time_step});
      }
      if (!one.rubs() || !two.rubs())
        return {};
      const double *const own_end = ends.node(touch.own), *const other_end = ends.node(touch.other);
      const dealii::Tensor<1, dim> &normal = touch.normal;
      const dealii::Tensor<1, dim> own_offset = touch.own_lever * normal,
                                   other_offset = -touch.other_lever * normal;
      dealii::Tensor<1, dim> slide =
          (vector_of<dim>(motion.node(touch.other)) - vector_of<dim>(motion.node(touch.own))) +
          (cross_product(other_end, other_offset) - cross_product(own_end, own_offset));
      slide -= (slide * normal) * normal;
      std::array<double, 3> spin;
      for (unsigned int c = 0; c < 3; ++c)
        spin[c] = 0.5 * (own_end[c] + other_end[c]);

      RubbingSpring<dim> &spring = springs[touch.pair];
      const RubbingSpring<dim> before{spring.stiffness, carried_along(spring.slip, spin, normal)};
      spring = {0.5 * touch.stiffness, before.slip + slide};
      const double hotter = std::max(own_end[temperature_slot], other_end[temperature_slot]);
      const double limit =
          std::min(one.friction.value(hotter), two.friction.value(hotter)) * touch.normal_force;
      const double trial = spring.stiffness * spring.slip.norm();
      if (trial > limit)
        spring.slip *= limit / trial;
      is_touching[touch.pair] = true;

      const double work =
          0.5 * (before.stiffness * before.slip + spring.stiffness * spring.slip) * slide;
      const double friction_heat = share * 0.5 *
                                   (work - 0.5 * spring.stiffness * spring.slip.norm_square() +
                                    0.5 * before.stiffness * before.slip.norm_square());
      kept_of(touch.row).dissipated += friction_heat;
      if (heat.given != nullptr)
        heat.given->add(touch.own, friction_heat);
      const dealii::Tensor<1, dim> force = spring.stiffness * spring.slip;
      if (inverse_deformation[touch.row] != dealii::Tensor<2, dim>())
        couple[touch.row] +=
            share * (outer_product(force, own_offset) - outer_product(own_offset, force));
      return force;
    }

    /** Ends the step: adds moments of forces to @p loads (also at ghosts), conducts. Collective. */
    void end_step(const FragmentHeat &heat, NodalVector &loads)
    {
      for (const Part &part : parts)
        part.kept->stored = 0;
      for (unsigned int i = 0; i < rows.size(); ++i)
      {
        double &stored = kept_of(i).stored;
        for (std::size_t pair = row_of_pairs[i]; pair < row_of_pairs[i + 1]; ++pair)
        {
          if (springs[pair].stiffness > 0. && !is_touching[pair])
            release(i, springs[pair]);
          stored +=
              rows.shares[i] * 0.25 * springs[pair].stiffness * springs[pair].slip.norm_square();
        }
        if (heat.given != nullptr && released_heat[i] != 0.)
          heat.given->add(rows.nodes[i], released_heat[i]);
        released_heat[i] = 0.;
      }
      if (any_rubs)
        spread_couples(loads);
      if (any_conducts)
        conduct(heat);
    }

  private:
    /** ω × r; in two dimensions ω is along z. */
    static dealii::Tensor<1, dim> cross_product(const double *const axial,
                                                const dealii::Tensor<1, dim> &r)
    {
      dealii::Tensor<1, dim> result;
      if constexpr (dim == 2)
      {
        result[0] = -axial[2] * r[1];
        result[1] = axial[2] * r[0];
      }
      else
        for (unsigned int d = 0; d < dim; ++d)
        {
          const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
          result[d] = axial[e] * r[f] - axial[f] * r[e];
        }
      return result;
    }

    /** g = F⁻ᵀ∇φ of entry @p k. */
    static dealii::Tensor<1, dim> gradient_at_present(const Stencils::Row &row,
                                                      const unsigned int k,
                                                      const dealii::Tensor<2, dim> &inverse)
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          result[a] += inverse[b][a] * row.gradient[k * Stencils::n_gradient + b];
      return result;
    }

    /** The axial vector of the skew part of Σ_K (Δu_K - Δu_I) ⊗ g_K. */
    static std::array<double, 3> spin_of_row(const Stencils &shape, const unsigned int i,
                                             const dealii::Tensor<2, dim> &inverse,
                                             const NodalVector &displacement)
    {
      const Stencils::Row row = shape.row(i);
      const auto own = vector_of<dim>(displacement.node(shape.particle_node[i]));
      dealii::Tensor<2, dim> gradient;
      for (unsigned int k = 0; k < row.size; ++k)
        gradient += outer_product(vector_of<dim>(displacement.node(row.neighbour[k])) - own,
                                  gradient_at_present(row, k, inverse));
      std::array<double, 3> axial{};
      axial[2] = 0.5 * (gradient[1][0] - gradient[0][1]);
      if constexpr (dim == 3)
      {
        axial[0] = 0.5 * (gradient[2][1] - gradient[1][2]);
        axial[1] = 0.5 * (gradient[0][2] - gradient[2][0]);
      }
      return axial;
    }

    static constexpr unsigned int temperature_slot = 3; // beside the axial vector of the spin

    /** @p slip turned by @p axial and into the plane across @p normal, as long as before. */
    static dealii::Tensor<1, dim> carried_along(const dealii::Tensor<1, dim> &slip,
                                                const std::array<double, 3> &axial,
                                                const dealii::Tensor<1, dim> &normal)
    {
      const double length = slip.norm();
      if (length == 0.)
        return slip;
      dealii::Tensor<1, dim> result = slip + cross_product(axial.data(), slip);
      result -= (result * normal) * normal;
      const double now = result.norm();
      return now > 0. ? result * (length / now) : result;
    }

    using KnownSpring = typename FrictionOfPart<dim>::KnownSpring;
    struct Exchange
    {
      unsigned int own, other; ///< local nodes
      double exposure;         ///< e = h A Δt [M L^2/(T^2 K)]
    };

    /** Moves the closed springs to those that the parts keep; there are no pairs then. */
    void return_springs()
    {
      for (unsigned int i = 0; i + 1 < row_of_pairs.size(); ++i)
        for (std::size_t pair = row_of_pairs[i]; pair < row_of_pairs[i + 1]; ++pair)
          if (springs[pair].stiffness > 0.)
            kept_of(i).springs.push_back(
                {rows.ids[i], partner_ids[pair], partner_mirrors[pair], springs[pair]});
      row_of_pairs.clear();
      for (const Part &part : parts)
        std::sort(part.kept->springs.begin(), part.kept->springs.end());
    }
    FrictionOfPart<dim> &kept_of(const unsigned int row)
    {
      return *parts[rows.site(row).part].kept;
    }
    /** Ends a contact of a row: the energy of the spring becomes heat. Half of it is this end's. */
    void release(const unsigned int row, RubbingSpring<dim> &spring)
    {
      const double spring_energy =
          rows.shares[row] * 0.25 * spring.stiffness * spring.slip.norm_square();
      kept_of(row).dissipated += spring_energy;
      released_heat[row] += spring_energy;
      spring = {};
    }
    /** Values of a particle in contact: axial vector of W, temperature. */
    void set_end(const unsigned int row, const NodalVector &position, const FragmentHeat &heat,
                 double *const end_values)
    {
      const unsigned int own = rows.nodes[row];
      std::fill_n(end_values, node_stride, 0.);
      if (heat.enthalpy != nullptr)
        end_values[temperature_slot] = heat.enthalpy->temperature(
            own,
            heat.enthalpy->enthalpy(own, *heat.temperature->node(own)) + *heat.pending->node(own));
      const auto [part, i] = rows.site(row);
      const Stencils &shape = *parts[part].shape;
      if (!any_rubs || shape.is_rigid(i))
        return;
      const dealii::Tensor<2, dim> deformation =
          shape.is_undeformed(i) ? dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>())
                                 : row_deformation<dim>(shape, i, position);
      if (!(determinant(deformation) > 0.))
        return;
      inverse_deformation[row] = invert(deformation);
      const std::array<double, 3> spin =
          spin_of_row(shape, i, inverse_deformation[row], displacement);
      std::copy(spin.begin(), spin.end(), end_values);
    }
    /** Images have the axial vectors of their nodes: reflects them. */
    void reflect_spins()
    {
      const NodePartition &partition = *ends.partition();
      unsigned int image = partition.n_owned() + partition.n_ghosts();
      for (const NodePartition::Reflected &of : partition.images())
      {
        const double *const sign = of.reflection.sign;
        double *const axial = ends.node(image++);
        for (unsigned int d = 0; d < 3; ++d)
          axial[d] *= sign[0] * sign[1] * sign[2] * sign[d];
      }
    }
    void spread_couples(NodalVector &loads)
    {
      for (unsigned int i = 0; i < rows.size(); ++i)
      {
        if (couple[i] == dealii::Tensor<2, dim>())
          continue;
        const unsigned int own = rows.nodes[i];
        const auto [part, part_row] = rows.site(i);
        const Stencils::Row row = parts[part].shape->row(part_row);
        dealii::Tensor<1, dim> sum;
        for (unsigned int k = 0; k < row.size; ++k)
        {
          if (row.neighbour[k] == own)
            continue;
          const dealii::Tensor<1, dim> force =
              0.5 * (couple[i] * gradient_at_present(row, k, inverse_deformation[i]));
          sum += force;
          for (unsigned int d = 0; d < dim; ++d)
            loads.node(row.neighbour[k])[d] += force[d];
        }
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(own)[d] -= sum[d];
      }
    }
    void conduct(const FragmentHeat &heat)
    {
      exposures.fit_to(ends.partition(), Quantity::scalar);
      exposures.set_zero();
      change_owned({&exposures},
                   [&]
                   {
                     for (const Exchange &exchange : exchanges)
                       *exposures.node(exchange.own) +=
                           exchange.exposure /
                           heat.enthalpy->capacity(exchange.own,
                                                   ends.node(exchange.own)[temperature_slot]);
                   });
      for (const Exchange &exchange : exchanges)
      {
        const double x = *exposures.node(exchange.own) + *exposures.node(exchange.other);
        const double share = x > 0. ? -std::expm1(-x) / x : 1.;
        heat.given->add(exchange.own, exchange.exposure * share *
                                          (ends.node(exchange.other)[temperature_slot] -
                                           ends.node(exchange.own)[temperature_slot]));
      }
    }

    std::vector<Part> parts;
    bool any_rubs = false, any_conducts = false;
    TouchingRows rows;
    std::vector<std::size_t> row_of_pairs;
    std::vector<std::uint64_t> partner_ids;
    std::vector<unsigned int> partner_mirrors;
    std::vector<RubbingSpring<dim>> springs; ///< of each pair
    std::vector<bool> is_touching;           ///< pairs, in this step
    // Of the step, by row: inverse of the deformation since the kernel's reference, zero where
    // there is none; sum of f ⊗ r - r ⊗ f; heat of contacts that ended.
    std::vector<dealii::Tensor<2, dim>> inverse_deformation, couple;
    std::vector<double> released_heat;
    NodalVector displacement; ///< Δu of the step, with the ghosts of the stencils
    NodalVector motion;       ///< the same with those of pairs
    NodalVector ends;         ///< axial vector of W, temperature
    NodalVector exposures;    ///< Σ e/C
    std::vector<Exchange> exchanges;
  };
} // namespace tombolo
