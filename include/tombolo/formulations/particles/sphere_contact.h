// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/fragment_friction.h>
#include <tombolo/formulations/particles/sphere_pairs.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Contact between particles of different bodies (SpherePairs). Each is a sphere (a disc) of the
   * radius ½ V^(1/dim) of its initial volume. Where those of two particles overlap by δ, a spring
   * and a damper push both apart along the line between them,
   *
   *   f = k δ + b ⟨δ̇⟩,  k = μ ω²,  b = 2 ζ √(k μ),  μ = m̂_I m̂_J / (m̂_I + m̂_J),
   *
   * with ω = √s c/h of the part (the speed c of longitudinal waves, the smallest spacing h of its
   * particles), the smaller one of two parts, the damping ζ of the part, of two the mean, and the
   * speed of approach ⟨δ̇⟩. There is no adhesion; friction and conduction are those of
   * FragmentFriction. Both ends compute the same force from the same numbers, so that momentum is
   * kept to round-off. Two particles that overlap initially, when they come apart, or when cells
   * make one of them, get smaller spheres, so that bodies begin to touch without a force.
   *
   * A particle on a plane of symmetry has the sphere and the mass that it has in the whole body,
   * and gets its share of the force.
   *
   * Damping dissipates the work of the normal forces, by the mean of those at both ends of each
   * step, less the change of the energy of their springs. Each end books its half with its part.
   */
  template <int dim>
  class SphereContact
  {
  public:
    /** Between these @p parts of a mesh, which must outlive this. Collective. */
    SphereContact(std::vector<typename SpherePairs<dim>::Part> parts, const Nodes<dim> &nodes,
                  const Bodies<dim> &bodies)
        : pairing(std::move(parts), nodes, bodies), columns(pairing.parts().size())
    {
      std::vector<typename FragmentFriction<dim>::Part> rubbing_parts;
      bool any = false;
      for (const auto &part : pairing.parts())
      {
        any = any || part.contact->rubs();
        rubbing_parts.push_back(
            {&part.contact->rubbing(), &part.contact->kept.friction, &part.particles->stencils()});
        for (const auto &other : pairing.parts())
          laws.push_back({std::min(part.contact->frequency(), other.contact->frequency()),
                          0.5 * (part.contact->damping() + other.contact->damping())});
      }
      if (any)
        friction = std::make_unique<FragmentFriction<dim>>(std::move(rubbing_parts));
    }

    /** After elements were removed: fragments and pairs must be found again. */
    void reset_pairs()
    {
      pairing.forget();
    }

    /** Adds the forces on this rank's particles to @p loads, forces at positions, and their nodes
     * to @p loaded_nodes; with friction, loads of other nodes, also ghosts. @p element_mass is that
     * of elements at owned nodes. Points keep forces and fragments. Collective. */
    void add_forces(const MechanicalInput &input, const NodalVector &element_mass,
                    NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                    const FragmentHeat &heat)
    {
      if (!pairing.find_candidates(*input.position))
        return;
      const auto &parts = pairing.parts();
      for (unsigned int p = 0; p < parts.size(); ++p)
        columns[p] = parts[p].contact->columns(parts[p].particles->points());
      const Motion ends = motion_of_ends(input);
      const bool are_new = !pairing.is_current();
      if (are_new)
      {
        pairing.find_pairs(*input.position, element_mass, columns);
        shrink_spheres(*ends.position);
      }
      if (friction && (are_new || !friction->has_pairs()))
        friction->set_pairs(pairing.partition(), pairing.rows(), pairing.pairs());
      if (friction)
        begin_friction(input, *ends.position, heat);
      std::vector<Sums> sums(parts.size());
      const TouchingRows &rows = pairing.rows();
      for (unsigned int i = 0; i < rows.size(); ++i)
      {
        Sums &part_sums = sums[rows.site(i).part];
        dealii::Tensor<1, dim> along;
        const dealii::Tensor<1, dim> force =
            rows.shares[i] *
            force_on(i, ends, input.time_increment, heat, part_sums.elastic, along);
        replace_force(i, force, input.position->node(rows.nodes[i]), part_sums.work);
        for (unsigned int d = 0; d < dim; ++d)
          loads.node(rows.nodes[i])[d] += force[d] + rows.shares[i] * along[d];
        if (force == dealii::Tensor<1, dim>())
          continue;
        loaded_nodes.push_back(rows.nodes[i]);
        ++part_sums.n_touching;
      }
      for (unsigned int p = 0; p < parts.size(); ++p)
        if (parts[p].acts)
        {
          ContactOfPart<dim> &kept = parts[p].contact->kept;
          kept.dissipated -= sums[p].work + sums[p].elastic - kept.stored;
          kept.stored = sums[p].elastic;
          kept.counts.n_touching = sums[p].n_touching;
        }
      if (friction)
        friction->end_step(heat, loads);
    }

    /** The share of @p stable_step, the limit without contact, that springs and dampers leave. */
    double stable_fraction(const double stable_step) const
    {
      double fraction = 1.;
      for (const auto &one : pairing.parts())
      {
        fraction = std::min(fraction, one.contact->stable_fraction(stable_step));
        for (const auto &other : pairing.parts())
        {
          if (&one == &other || !pairing.are_between_parts())
            continue;
          // Springs are 2μ/m times those between two equal masses m.
          constexpr double on_free_side = 5.;
          const double own = one.contact->largest_mass(),
                       other_mass = other.contact->largest_mass();
          const double ratio = own > 0. ? 2. * other_mass / (own + other_mass) : 2.;
          const double angle =
              std::min(one.contact->frequency(), other.contact->frequency()) * stable_step;
          fraction =
              std::min(fraction, SelfContact<dim>::stable_fraction(
                                     4., on_free_side * ratio, angle,
                                     0.5 * (one.contact->damping() + other.contact->damping())));
        }
      }
      return fraction;
    }

    /** The sums over the parts, of this rank. */
    FragmentCounts counts() const
    {
      FragmentCounts sum;
      for (const auto &part : pairing.parts())
      {
        sum.n_fragments += part.contact->counts().n_fragments;
        sum.n_touching += part.contact->counts().n_touching;
      }
      return sum;
    }

    /** The largest speed so far at which two spheres that overlap approached each other, over ω and
     * the sum of their radii: what a spring of ω alone gives way by. On this rank. */
    double fastest_approach() const
    {
      return fastest;
    }

    /** Whether any particles rub or conduct. */
    bool rubs() const
    {
      return friction != nullptr;
    }

  private:
    enum Sphere : unsigned int
    {
      radius,
      mass,
      contact_area,
      law_of_sphere ///< number of a part
    };

    static double distance(const double *const a, const double *const b)
    {
      double squared = 0;
      for (unsigned int d = 0; d < dim; ++d)
        squared += (b[d] - a[d]) * (b[d] - a[d]);
      return std::sqrt(squared);
    }

    /** Whether spheres at a distance overlap, by more than the round-off of those that were shrunk
     * until they touch: dampers act as soon as they do. */
    static bool overlap(const double distance, const double sum_of_radii)
    {
      constexpr double round_off = 1e-12;
      return distance < (1. - round_off) * sum_of_radii;
    }

    using Columns = typename SelfContact<dim>::Columns;

    /** Of two parts. */
    struct PairLaw
    {
      double frequency, damping;
    };

    struct Motion
    {
      const NodalVector *position, *velocity;
    };

    /** Sums of a step, by part. */
    struct Sums
    {
      double elastic = 0, work = 0;
      unsigned long n_touching = 0;
    };

    double shrinkage(const unsigned int row) const
    {
      const auto [part, i] = pairing.rows().site(row);
      return columns[part].shrinkage[i];
    }
    /** Shrinks the spheres of new pairs until they do not overlap. Collective. */
    void shrink_spheres(const NodalVector &position)
    {
      const TouchingRows &rows = pairing.rows();
      const FragmentPairs &pairs = pairing.pairs();
      const auto &particles = pairing.spheres();
      const auto radius_of = [&](const std::size_t i)
      {
        return 0.5 * std::pow(particles.volumes[i], 1. / dim) *
               (1. - shrinkage(static_cast<unsigned int>(i)));
      };
      spheres = nodal_field(pairing.partition(), Quantity::scalars, rows.nodes,
                            [&](const std::size_t i, double *const sphere)
                            {
                              sphere[radius] = radius_of(i);
                              sphere[mass] = particles.masses[i];
                              sphere[contact_area] =
                                  std::pow(particles.volumes[i], (dim - 1.) / dim);
                              sphere[law_of_sphere] = particles.laws[i];
                            });
      std::vector<double> factor(rows.size(), 1.);
      for (unsigned int i = 0; i < factor.size(); ++i)
      {
        const unsigned int own = rows.nodes[i];
        for (std::size_t entry = pairs.start[i]; entry < pairs.start[i + 1]; ++entry)
        {
          const unsigned int other = pairs.partner[entry];
          if (!pairing.were_pair(own, other, pairs.mirrors[entry]))
            factor[i] =
                std::min(factor[i], distance(position.node(own), position.node(other)) /
                                        (spheres.node(own)[radius] + spheres.node(other)[radius]));
        }
      }
      spheres.fill(rows.nodes,
                   [&](const std::size_t i, double *const sphere)
                   {
                     const double now =
                         1. - (1. - shrinkage(static_cast<unsigned int>(i))) * factor[i];
                     for (std::size_t k = rows.start[i]; k < rows.start[i + 1]; ++k)
                       columns[rows.sites[k].part].shrinkage[rows.sites[k].row] = now;
                     sphere[radius] = radius_of(i);
                   });
    }
    /** With the ghosts of pairs. Collective. */
    Motion motion_of_ends(const MechanicalInput &input)
    {
      const TouchingRows &rows = pairing.rows();
      const auto &partition = pairing.partition();
      if (!pairing.has_ghosts())
        return {input.position, input.velocity};
      positions.fit_to(partition, Quantity::position);
      velocities.fit_to(partition, Quantity::vector);
      for (const auto &[to, from] : {std::make_pair(&positions, input.position),
                                     std::make_pair(&velocities, input.velocity)})
        to->fill(rows.nodes, [&, from = from](const std::size_t i, double *const value)
                 { std::copy_n(from->node(rows.nodes[i]), node_stride, value); });
      return {&positions, &velocities};
    }
    void begin_friction(const MechanicalInput &input, const NodalVector &position,
                        const FragmentHeat &heat)
    {
      const TouchingRows &rows = pairing.rows();
      const FragmentPairs &pairs = pairing.pairs();
      std::vector<dealii::Tensor<1, dim>> moves(rows.size());
      std::vector<bool> is_touching(rows.size(), false);
      for (unsigned int i = 0; i < rows.size(); ++i)
      {
        const unsigned int own = rows.nodes[i];
        const auto [part, row] = rows.site(i);
        for (unsigned int d = 0; d < dim; ++d)
          moves[i][d] = position.node(own)[d] - columns[part].position[d][row];
        for (std::size_t entry = pairs.start[i]; entry < pairs.start[i + 1] && !is_touching[i];
             ++entry)
          is_touching[i] =
              overlap(distance(position.node(own), position.node(pairs.partner[entry])),
                      spheres.node(own)[radius] + spheres.node(pairs.partner[entry])[radius]);
      }
      friction->begin_step(*input.position, moves, is_touching, heat);
    }
    /** The normal force on the particle of a row in the whole body; adds friction to @p along. */
    dealii::Tensor<1, dim> force_on(const unsigned int row, const Motion &ends,
                                    const double time_step, const FragmentHeat &heat,
                                    double &elastic, dealii::Tensor<1, dim> &along)
    {
      const TouchingRows &rows = pairing.rows();
      const FragmentPairs &pairs = pairing.pairs();
      const NodalVector &position = *ends.position, &velocity = *ends.velocity;
      const unsigned int own = rows.nodes[row], own_law = pairing.spheres().laws[row];
      const double *const x = position.node(own), *const v = velocity.node(own);
      const double *const sphere = spheres.node(own);
      dealii::Tensor<1, dim> force;
      for (std::size_t entry = pairs.start[row]; entry < pairs.start[row + 1]; ++entry)
      {
        const unsigned int other = pairs.partner[entry];
        const double *const other_sphere = spheres.node(other);
        const double reach = sphere[radius] + other_sphere[radius];
        const double r = distance(x, position.node(other));
        if (!overlap(r, reach) || r == 0.)
          continue;
        dealii::Tensor<1, dim> normal;
        double approach = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          normal[d] = (position.node(other)[d] - x[d]) / r;
          approach -= (velocity.node(other)[d] - v[d]) * normal[d];
        }
        const auto other_law = static_cast<unsigned int>(other_sphere[law_of_sphere]);
        const auto [frequency, damping] = laws[own_law * pairing.parts().size() + other_law];
        fastest = std::max(fastest, approach / (frequency * reach));
        const double reduced =
            sphere[mass] * other_sphere[mass] / (sphere[mass] + other_sphere[mass]);
        const double spring = reduced * frequency * frequency;
        const double push =
            spring * (reach - r) + 2. * damping * reduced * frequency * std::max(approach, 0.);
        for (unsigned int d = 0; d < dim; ++d)
          force[d] -= push * normal[d];
        elastic += rows.shares[row] * 0.25 * spring * (reach - r) * (reach - r); // of this end
        if (friction)
          along +=
              friction->rub({row, entry, own, other, own_law, other_law, normal,
                             r * sphere[radius] / reach, r * other_sphere[radius] / reach, push,
                             spring, std::min(sphere[contact_area], other_sphere[contact_area])},
                            time_step, heat);
      }
      return force;
    }
    /** Replaces force and position of the step before. Adds the work in between. */
    void replace_force(const unsigned int row, const dealii::Tensor<1, dim> &force,
                       const double *const position, double &work)
    {
      const TouchingRows &rows = pairing.rows();
      const auto [part, part_row] = rows.site(row);
      const Columns &before = columns[part];
      for (unsigned int d = 0; d < dim; ++d)
        work += 0.5 * (before.force[d][part_row] + force[d]) *
                (position[d] - before.position[d][part_row]);
      for (std::size_t k = rows.start[row]; k < rows.start[row + 1]; ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          columns[rows.sites[k].part].force[d][rows.sites[k].row] = force[d];
          columns[rows.sites[k].part].position[d][rows.sites[k].row] = position[d];
        }
    }

    SpherePairs<dim> pairing;
    std::vector<PairLaw> laws;                       // of all pairs of parts
    std::vector<Columns> columns;                    // by part, in this step
    NodalVector spheres;                             // radius, mass, area, law
    NodalVector positions, velocities;               // with ghosts and images, where there are any
    double fastest = 0;                              // see fastest_approach()
    std::unique_ptr<FragmentFriction<dim>> friction; // null: nothing rubs or conducts
  };
} // namespace tombolo
