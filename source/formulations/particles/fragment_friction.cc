// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/fragment_friction.h>

#include <deal.II/base/mpi.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace tombolo
{
  /** ω × r; in two dimensions ω is along z. */
  template <int dim>
  dealii::Tensor<1, dim> cross_product(const double *const axial, const dealii::Tensor<1, dim> &r)
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

  template <int dim>
  dealii::Tensor<1, dim> components_at(const NodalVector &vector, const unsigned int node)
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = vector.node(node)[d];
    return result;
  }

  /** g = F⁻ᵀ∇φ of entry @p k. */
  template <int dim>
  dealii::Tensor<1, dim> gradient_at_present(const Stencils::Row &row, const unsigned int k,
                                             const dealii::Tensor<2, dim> &inverse)
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        result[a] += inverse[b][a] * row.gradient[k * Stencils::n_gradient + b];
    return result;
  }

  /** The axial vector of the skew part of Σ_K (Δu_K - Δu_I) ⊗ g_K. */
  template <int dim>
  std::array<double, 3> spin_of_row(const Stencils &shape, const unsigned int i,
                                    const dealii::Tensor<2, dim> &inverse,
                                    const NodalVector &displacement)
  {
    const Stencils::Row row = shape.row(i);
    const auto own = components_at<dim>(displacement, shape.particle_node[i]);
    dealii::Tensor<2, dim> gradient;
    for (unsigned int k = 0; k < row.size; ++k)
      gradient += outer_product(components_at<dim>(displacement, row.neighbour[k]) - own,
                                gradient_at_present<dim>(row, k, inverse));
    std::array<double, 3> axial{};
    axial[2] = 0.5 * (gradient[1][0] - gradient[0][1]);
    if constexpr (dim == 3)
    {
      axial[0] = 0.5 * (gradient[2][1] - gradient[1][2]);
      axial[1] = 0.5 * (gradient[0][2] - gradient[2][0]);
    }
    return axial;
  }

  namespace
  {
    constexpr unsigned int temperature_slot = 3; // beside the axial vector of the spin
    constexpr double mirror_unit = 4294967296.;  // of mirrors in checkpoints, above half a number

    /** @p slip turned by @p axial and into the plane across @p normal, as long as before. */
    template <int dim>
    Tensor<1, dim> carried_along(const Tensor<1, dim> &slip, const std::array<double, 3> &axial,
                                 const Tensor<1, dim> &normal)
    {
      const double length = slip.norm();
      if (length == 0.)
        return slip;
      Tensor<1, dim> result = slip + cross_product<dim>(axial.data(), slip);
      result -= (result * normal) * normal;
      const double now = result.norm();
      return now > 0. ? result * (length / now) : result;
    }

    template <typename KnownSpring>
    bool is_before(const KnownSpring &a, const KnownSpring &b)
    {
      return std::tie(a.own, a.partner, a.mirrors) < std::tie(b.own, b.partner, b.mirrors);
    }
  } // namespace

  RubbingLaw RubbingLaw::create(const Entries &e)
  {
    auto friction = e.object<TemperatureTable>(
        "Self-contact friction", "0", "",
        "Coulomb's coefficient between particles that touch, from 0 to 10; 0 is frictionless "
        "contact. In scenes with heat also pairs `temperature: value` separated by commas, over "
        "the temperature of the hotter particle, joined by straight lines; the heat of friction is "
        "that of both particles, half each. Of two parts the smaller one. Only with "
        "`Self-contact`.");
    e.refuse(!(friction.smallest() >= 0. && friction.largest() <= 10.), "Self-contact friction",
             friction.is_constant() ? "allowed is a number from 0 to 10."
                                    : "allowed are coefficients from 0 to 10.");
    auto conductance = e.object<TemperatureTable>(
        "Self-contact conductance", "0", "M/(T^3 temperature)",
        "h of the heat h (difference of temperatures) that goes from one particle to the other per "
        "area in contact and time: one number, or pairs `pressure: value` separated by commas, "
        "joined by straight lines. 0: nothing is conducted. Of two parts the smaller one. Only in "
        "scenes with heat.",
        "pressure");
    e.refuse(!(conductance.smallest() >= 0.), "Self-contact conductance",
             "allowed are numbers from zero on.");
    return {std::move(friction), std::move(conductance)};
  }

  void RubbingLaw::refuse_without_heat(const Section &section)
  {
    const RubbingLaw law = create(section);
    if (!law.rubs() && !law.conducts())
      return;
    if (!law.friction.is_constant())
      section.fail("Self-contact friction",
                   "the scene has no temperature; allowed is one number, or materials with a "
                   "section \"Heat\".");
    if (law.conducts())
      section.fail("Self-contact conductance",
                   "the scene has no temperature; allowed is 0, or materials with a section "
                   "\"Heat\".");
  }

  template <int dim>
  FragmentFriction<dim>::FragmentFriction(std::vector<Part> of_parts) : parts(std::move(of_parts))
  {
    for (const Part &part : parts)
    {
      any_rubs = any_rubs || part.law->rubs();
      any_conducts = any_conducts || part.law->conducts();
      part.kept->fetch_springs = [this] { give_back_springs(); };
    }
  }

  template <int dim>
  void FragmentFriction<dim>::give_back_springs()
  {
    for (unsigned int i = 0; i + 1 < row_of_pairs.size(); ++i)
      for (std::size_t pair = row_of_pairs[i]; pair < row_of_pairs[i + 1]; ++pair)
        if (springs[pair].stiffness > 0.)
          kept_of(i).springs.push_back(
              {rows.ids[i], partner_ids[pair], partner_mirrors[pair], springs[pair]});
    row_of_pairs.clear();
    for (const Part &part : parts)
      std::sort(part.kept->springs.begin(), part.kept->springs.end(), is_before<KnownSpring>);
  }

  template <int dim>
  void FragmentFriction<dim>::set_pairs(const std::shared_ptr<const NodePartition> &partition,
                                        const TouchingRows &of_pairs, const FragmentPairs &pairs)
  {
    give_back_springs();
    std::vector<KnownSpring> known;
    for (const Part &part : parts)
    {
      known.insert(known.end(), part.kept->springs.begin(), part.kept->springs.end());
      part.kept->springs.clear();
    }
    std::sort(known.begin(), known.end(), is_before<KnownSpring>);
    rows = of_pairs;
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

  template <int dim>
  void FragmentFriction<dim>::begin_step(const NodalVector &position,
                                         const std::vector<Tensor<1, dim>> &moves,
                                         const std::vector<bool> &touches, const FragmentHeat &heat)
  {
    const auto set_move = [&](const std::size_t i, double *const of_node)
    {
      for (unsigned int d = 0; d < dim; ++d)
        of_node[d] = moves[i][d];
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
              [&](const std::size_t i, double *const of_end)
              {
                if (touches[i])
                  set_end(static_cast<unsigned int>(i), position, heat, of_end);
              });
    reflect_spins();
    exchanges.clear();
    std::fill(is_touching.begin(), is_touching.end(), false);
  }

  template <int dim>
  void FragmentFriction<dim>::set_end(const unsigned int row, const NodalVector &position,
                                      const FragmentHeat &heat, double *const of_end)
  {
    const unsigned int own = rows.nodes[row];
    std::fill_n(of_end, node_stride, 0.);
    if (heat.enthalpy != nullptr)
      of_end[temperature_slot] = heat.enthalpy->temperature(
          own,
          heat.enthalpy->enthalpy(own, *heat.temperature->node(own)) + *heat.pending->node(own));
    const auto [part, i] = rows.site(row);
    const Stencils &shape = *parts[part].shape;
    if (!any_rubs || shape.is_rigid(i))
      return;
    const Tensor<2, dim> deformation = shape.is_undeformed(i)
                                           ? Tensor<2, dim>(unit_symmetric_tensor<dim>())
                                           : row_deformation<dim>(shape, i, position);
    if (!(determinant(deformation) > 0.))
      return;
    inverse_deformation[row] = invert(deformation);
    const std::array<double, 3> spin =
        spin_of_row<dim>(shape, i, inverse_deformation[row], displacement);
    std::copy(spin.begin(), spin.end(), of_end);
  }

  template <int dim>
  void FragmentFriction<dim>::reflect_spins()
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

  template <int dim>
  Tensor<1, dim> FragmentFriction<dim>::rub(const FragmentTouch<dim> &touch, const double time_step,
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
    const Tensor<1, dim> &normal = touch.normal;
    const Tensor<1, dim> own_offset = touch.own_lever * normal,
                         other_offset = -touch.other_lever * normal;
    Tensor<1, dim> slide =
        (components_at<dim>(motion, touch.other) - components_at<dim>(motion, touch.own)) +
        (cross_product<dim>(other_end, other_offset) - cross_product<dim>(own_end, own_offset));
    slide -= (slide * normal) * normal;
    std::array<double, 3> spin;
    for (unsigned int c = 0; c < 3; ++c)
      spin[c] = 0.5 * (own_end[c] + other_end[c]);

    RubbingSpring<dim> &spring = springs[touch.pair];
    const RubbingSpring<dim> before{spring.stiffness,
                                    carried_along<dim>(spring.slip, spin, normal)};
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
    const double taken = share * 0.5 *
                         (work - 0.5 * spring.stiffness * spring.slip.norm_square() +
                          0.5 * before.stiffness * before.slip.norm_square());
    kept_of(touch.row).dissipated += taken;
    if (heat.given != nullptr)
      heat.given->add(touch.own, taken);
    const Tensor<1, dim> force = spring.stiffness * spring.slip;
    if (inverse_deformation[touch.row] != Tensor<2, dim>())
      couple[touch.row] +=
          share * (outer_product(force, own_offset) - outer_product(own_offset, force));
    return force;
  }

  template <int dim>
  void FragmentFriction<dim>::end_step(const FragmentHeat &heat, NodalVector &loads)
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

  template <int dim>
  void FragmentFriction<dim>::spread_couples(NodalVector &loads)
  {
    for (unsigned int i = 0; i < rows.size(); ++i)
    {
      if (couple[i] == Tensor<2, dim>())
        continue;
      const unsigned int own = rows.nodes[i];
      const auto [part, of_part] = rows.site(i);
      const Stencils::Row row = parts[part].shape->row(of_part);
      Tensor<1, dim> sum;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        if (row.neighbour[k] == own)
          continue;
        const Tensor<1, dim> force =
            0.5 * (couple[i] * gradient_at_present<dim>(row, k, inverse_deformation[i]));
        sum += force;
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(row.neighbour[k])[d] += force[d];
      }
      for (unsigned int d = 0; d < dim; ++d)
        loads.node(own)[d] -= sum[d];
    }
  }

  template <int dim>
  void FragmentFriction<dim>::conduct(const FragmentHeat &heat)
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

  template <int dim>
  void FrictionOfPart<dim>::serialize(StateArchive &archive,
                                      const std::vector<std::uint64_t> &own_ids)
  {
    const auto group = archive.group("friction between fragments");
    archive.sums("energies", {&stored, &dissipated});
    if (fetch_springs)
      fetch_springs();
    if (archive.is_reading())
      springs.clear();
    // Rows of the file are of one length, that of the particle with most springs.
    std::vector<std::vector<double>> of_row(own_ids.size());
    for (std::size_t i = 0; i < own_ids.size() && !springs.empty(); ++i)
      for (auto known = std::lower_bound(springs.begin(), springs.end(), own_ids[i],
                                         [](const KnownSpring &spring, const std::uint64_t id)
                                         { return spring.own < id; });
           known != springs.end() && known->own == own_ids[i]; ++known)
      {
        of_row[i].insert(of_row[i].end(),
                         {upper_half(known->partner) + mirror_unit * known->mirrors,
                          lower_half(known->partner), known->spring.stiffness});
        for (unsigned int d = 0; d < dim; ++d)
          of_row[i].push_back(known->spring.slip[d]);
      }
    constexpr unsigned int n_numbers = 3 + dim;
    unsigned int longest = 0;
    for (const std::vector<double> &row : of_row)
      longest = std::max(longest, static_cast<unsigned int>(row.size()));
    longest = Utilities::MPI::max(longest, archive.communicator());
    archive("numbers of a row", longest);
    if (longest == 0)
      return;
    std::vector<double> values;
    for (std::vector<double> &row : of_row)
    {
      row.resize(longest, 0.);
      values.insert(values.end(), row.begin(), row.end());
    }
    archive.rows("springs", longest, values);
    if (!archive.is_reading())
      return;
    for (std::size_t i = 0; i < own_ids.size(); ++i)
      for (std::size_t k = i * longest; k < (i + 1) * longest; k += n_numbers)
        if (values[k + 2] > 0.)
        {
          RubbingSpring<dim> spring{values[k + 2], {}};
          for (unsigned int d = 0; d < dim; ++d)
            spring.slip[d] = values[k + 3 + d];
          const double mirrors = std::floor(values[k] / mirror_unit);
          springs.push_back({own_ids[i], joined(values[k] - mirrors * mirror_unit, values[k + 1]),
                             static_cast<unsigned int>(mirrors), spring});
        }
    std::sort(springs.begin(), springs.end(), is_before<KnownSpring>);
  }

  template struct FrictionOfPart<2>;
  template struct FrictionOfPart<3>;
  template class FragmentFriction<2>;
  template class FragmentFriction<3>;
} // namespace tombolo
