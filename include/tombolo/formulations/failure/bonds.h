// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/failure/bond_check.h>
#include <tombolo/formulations/failure/partner_lists.h>
#include <tombolo/formulations/part_points.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/particle_rows.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Bonds between particles that have failed. */
  struct BondCounts
  {
    std::string criterion;      ///< empty: bonds do not break
    double n_broken = 0;        ///< one of ½ for each end
    unsigned long n_debris = 0; ///< particles with broken bonds and without a basis
  };

  /**
   * The bonds of the particles of one part that have broken, for good. A bond is between a particle
   * and a neighbour, or the image of one in planes of symmetry; it belongs to both of its ends,
   * whatever their supports are, and so it is broken in the lists of both, on whichever ranks they
   * are. Particles go by their persistent identifiers here.
   *
   * A check compares each pair with a BondFailure. Pairs that break leave the rows of the shape
   * functions, which are then computed from the remaining neighbours, in the reference that the
   * kernel has: stress, mass and momentum of the particles stay. A particle that has lost bonds
   * gets no new ones, by a search or by coming nearer: what has separated does not grow together.
   *
   * A particle without a basis (its row is rigid) that has lost bonds is debris. Its stress does
   * not act any more: it is put to zero, and its elastic energy is booked as lost to failure. One
   * whose remaining neighbours nearly carry no basis, or that would be turned inside out, loses all
   * its bonds and becomes debris too; where this is requested, also one that has lost no bond
   * before. Where no bond can break, all calls do nothing.
   */
  template <int dim>
  class Bonds
  {
  public:
    static constexpr const char *dissipation_name = "failure dissipation";

    /** A particle with broken bonds loses all where its present gradients, √Σ_J |F⁻ᵀ∇φ_J|², are
     * this many times the initial ones. At the corner of a lattice they are twice those inside. */
    static constexpr double largest_gradient_growth = 3.;

    /** Reads the criterion in the section of the formulation; there may be none. The other
     * arguments must outlive this object, which changes rows and points. Throws InputError. */
    Bonds(const Entries &e, const ParticleSet<dim> &particles,
          const KernelConfiguration<dim> &kernel, ParticleRows<dim> &rows, PartPoints &points)
        : particles(particles), kernel(kernel), rows(rows), points(points)
    {
      if (e.when(e.given("Bond failure") != "none"))
        check = std::make_unique<BondCheck<dim>>(e);
    }

    /** Whether bonds can break. */
    bool is_on() const
    {
      return check != nullptr;
    }
    /** Whether any bond is broken on any rank. */
    bool any() const
    {
      return is_broken_anywhere;
    }

    /** The fields that points need; none if off. */
    std::vector<FieldDescription> variables() const
    {
      if (!is_on())
        return {};
      return {{fraction_name, "1", FieldLocation::material_point, 1, true},
              energy_field(dissipation_name)};
    }

    /** Sets the bonds to the initial neighbours with φ ≠ 0. Throws InputError for unfit points. */
    void initialize()
    {
      if (!is_on())
        return;
      check->start(points.points());
      fraction_field = points.points().find_field(fraction_name);
      dissipation_field = points.points().find_field(dissipation_name);
      own_ids = particles.persistent_ids();
      broken.reset(own_ids.size());
      refused.reset(own_ids.size());
      n_initial_bonds.assign(own_ids.size(), 0);
      initial_gradient.assign(own_ids.size(), 0.);
      measure_rows(rows.stencils());
    }

    /** Sets a function to call before stencils change in a run, on all ranks. */
    void set_before_change(const std::function<void()> &to_call)
    {
      before_change = to_call;
    }
    /** Calls it, and stores the present rows. */
    void prepare_change()
    {
      reference_gradient.clear();
      if (before_change)
        before_change();
      if (is_broken_anywhere)
        former_rows.remember(rows.stencils());
    }

    /** Before a search: stores the bonds that particles with broken ones still have. Collective. */
    void prepare_search()
    {
      if (!is_broken_anywhere)
        return;
      // Which particles are damaged may have changed since.
      partners.find(rows.partition(particles), rows.neighbourhoods(), own_ids, broken, growth);
      previous.reset(own_ids.size());
      add_pairs([&](const unsigned int i, const unsigned int neighbour, std::size_t)
                { return is_damaged(i, neighbour); },
                previous);
    }
    /** After it: removes broken bonds, and new ones of particles that lost some. Collective. */
    void finish_search()
    {
      partners.forget();
      reference_gradient.clear();
      if (is_broken_anywhere)
      {
        const auto partition = rows.partition(particles);
        partners.find(partition, rows.neighbourhoods(), own_ids, broken, growth);
        previous.resize(own_ids.size());
        refused.reset(own_ids.size());
        add_pairs(
            [&](const unsigned int i, const unsigned int neighbour, std::size_t)
            { return is_refused(i, neighbour) && !broken.has(i, partners[neighbour].partner); },
            refused);
        previous.reset(0);
        remove_broken(partition);
      }
      growth.clear();
    }

    /** Checks the bonds at @p position (current ghosts) if that is due; where any breaks, rows,
     * values and gradients change. Returns whether they did, the same on all ranks. Collective. */
    bool update(const NodalVector &position)
    {
      const bool has_broken = is_on() && check->is_due() && break_bonds(position);
      return isolate_distorted(position) || has_broken;
    }

    /** Breaks all bonds of particles that are not sound any more at @p position (current ghosts):
     * of those that have lost some, or of all; until none is left. As update(). Collective. */
    bool isolate_distorted(const NodalVector &position)
    {
      const auto &partition = position.partition();
      const Stencils &shape = rows.stencils();
      bool has_changed = false;
      // A bond that one particle loses is lost by others, too; each pass leaves one less to
      // isolate.
      for (; can_isolate(); has_changed = true)
      {
        NodalSmoothing::try_inverse_deformation<dim>(position.data(), rows.stencils());
        for (auto i = static_cast<unsigned int>(reference_gradient.size()); i < shape.n_particles();
             ++i)
          reference_gradient.push_back(gradient_of_reference<dim>(shape, i));
        std::vector<unsigned int> distorted;
        for (unsigned int i = 0; i < shape.n_particles(); ++i)
          if ((check->isolates_all() || !broken[i].empty()) && !shape.is_undeformed(i) &&
              exceeds_gradient<dim>(shape, i, position, reference_gradient[i],
                                    largest_gradient_growth * initial_gradient[i]))
            distorted.push_back(shape.particle_node[i]);
        if (dealii::Utilities::MPI::max(distorted.empty() ? 0 : 1, particles.communicator()) == 0)
          break;

        // Also from rows that contain such a particle without being in its row.
        if (!partners.are_current())
          partners.find(partition, rows.neighbourhoods(), own_ids, broken, growth);
        const NodalVector mark =
            marked_nodes(partition, [&](const auto &mark_node)
                         { std::for_each(distorted.begin(), distorted.end(), mark_node); });
        std::vector<PartnerMessage> messages;
        for (unsigned int i = 0; i < shape.n_particles(); ++i)
        {
          const unsigned int own = shape.particle_node[i];
          for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
            if (shape.neighbour[entry] != own &&
                (*mark.node(own) > 0. || *mark.node(shape.neighbour[entry]) > 0.))
              break_entry(i, entry, messages);
        }
        if (!complete_breaking(partition, messages))
          break;
      }
      return has_changed;
    }
    /** The same in the reference, after a search; rows get numbers of a partition. Collective. */
    void isolate_distorted_in_reference()
    {
      if (!can_isolate())
        return;
      const auto partition = rows.partition(particles);
      rows.set_partition(*partition);
      isolate_distorted(nodal_field(partition, Quantity::position, rows.stencils().particle_node,
                                    [&](const std::size_t i, double *const position) {
                                      std::copy_n(&kernel.positions()[i * node_stride], node_stride,
                                                  position);
                                    }));
    }

    /** Books the elastic energy of debris, and sets its stress to zero. */
    void release_debris()
    {
      const std::vector<unsigned int> released = debris();
      if (released.empty())
        return;
      MaterialPoints &material_points = points.points();
      const std::vector<double> elastic_energies = points.elastic_energies();
      const unsigned int work_field = material_points.find_field("pressure work"); // stored, too
      for (const unsigned int row : released)
      {
        if (work_field < material_points.fields().size())
          material_points.component(work_field, 0)[row] = 0.;
        material_points.component(dissipation_field, 0)[row] +=
            elastic_energies[row] / particles.initial_volumes()[row];
        for (unsigned int c = 0; c < 6; ++c)
          material_points.component(MaterialPoints::stress, c)[row] = 0.;
      }
    }

    /** There are more particles; number old_index[i] is now number i, others are new. Where
     * gains[i] it is a node of new cells. Follows prepare_search(); with the search after it a new
     * particle gets a bond also with a damaged one if both got cells, which have joined them. */
    void add_particles(const std::vector<unsigned int> &old_index, const std::vector<bool> &gains)
    {
      if (!is_on())
        return;
      const std::vector<std::uint64_t> ids = particles.persistent_ids();
      const std::size_t n_old = own_ids.size();
      for (PartnerLists *const lists : {&broken, &refused, &previous})
        lists->rearrange(old_index);
      rearrange(old_index, n_initial_bonds);
      rearrange(old_index, initial_gradient);
      own_ids = ids;
      growth.clear();
      for (std::size_t i = 0; i < ids.size(); ++i)
        growth.push_back(old_index[i] >= n_old ? ParticleGrowth::is_new
                         : gains[i]            ? ParticleGrowth::gains
                                               : ParticleGrowth::none);
      has_grown = true;
      partners.forget();
    }

    /** Between add_particles() and finish_search(): removes pairs that the latter will refuse from
     * rows in another configuration. @p partition has all their nodes and images. Collective. */
    void remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
    {
      if (!is_broken_anywhere)
        return;
      partners.find(partition, neighbourhoods, own_ids, broken, growth);
      neighbourhoods.remove_neighbours(
          [&](const unsigned int row, const unsigned int neighbour)
          { return broken.has(row, partners[neighbour].partner) || is_refused(row, neighbour); },
          shape);
      partners.forget();
    }

    /** Uses @p shape as the rows of the start, for particles without broken bonds. */
    void measure_rows(const Stencils &shape)
    {
      for (unsigned int i = 0; i < own_ids.size(); ++i)
      {
        if (!broken[i].empty())
          continue;
        const Stencils::Row row = shape.row(i);
        n_initial_bonds[i] = 0;
        for (unsigned int k = 0; k < row.size; ++k)
          if (row.is_within_support(k) && row.neighbour[k] != shape.particle_node[i])
            ++n_initial_bonds[i];
        initial_gradient[i] = gradient_of_reference<dim>(shape, i);
      }
    }

    /** Rigid rows with broken bonds, ascending. */
    std::vector<unsigned int> debris() const
    {
      std::vector<unsigned int> result;
      for (const unsigned int row : rows.stencils().rank_deficient_rows)
        if (is_broken_anywhere && !broken[row].empty())
          result.push_back(row);
      return result;
    }
    /** Of debris() those that the last update made or from which it removed neighbours. */
    std::vector<LeavingParticle> leaving_particles()
    {
      return former_rows.leaving(rows.stencils(), debris());
    }
    /** Over this rank's particles. */
    BondCounts counts() const
    {
      BondCounts result;
      result.criterion = is_on() ? check->criterion_name() : "";
      for (std::size_t i = 0; i < broken.size(); ++i)
        for (const BondPartner &partner : broken[i])
          result.n_broken += partner.id == own_ids[i] ? 1. : 0.5;
      result.n_debris = debris().size();
      return result;
    }
    /** Elastic energy of debris, over this rank. */
    double dissipated_energy() const
    {
      return integral_over_initial_volume(points.points(), dissipation_name);
    }

    /** Lists the state that is kept from step to step; rows are the particles. */
    void list(Records &records)
    {
      if (!is_on())
        return;
      check->list(records);
      records.archived(
          [this](StateArchive &archive)
          {
            broken.serialize(archive, "partners that broke off");
            refused.serialize(archive, "partners that were refused");
          });
      records.value("has grown", has_grown);
      records.list(
          [this](Records &now)
          {
            if (!has_grown)
              return;
            now.rows("bonds at the start", 1, n_initial_bonds);
            now.rows("gradient at the start", 1, initial_gradient);
          });
      records.on_reading(
          [this]
          {
            partners.forget();
            bool is_broken = false;
            for (std::size_t i = 0; i < broken.size(); ++i)
              is_broken = is_broken || !broken[i].empty();
            is_broken_anywhere =
                dealii::Utilities::MPI::max(is_broken ? 1 : 0, particles.communicator()) == 1;
          });
    }
    /** Removes broken bonds from rows searched anew. Whether any rank has some. Collective. */
    bool complete_reading(const std::shared_ptr<const NodePartition> &partition)
    {
      reference_gradient.clear();
      if (is_broken_anywhere)
        remove_broken(partition);
      return is_broken_anywhere;
    }

  private:
    static constexpr char fraction_name[] = "broken bonds";

    bool can_isolate() const
    {
      return is_broken_anywhere || (is_on() && check->isolates_all());
    }
    /** Breaks bonds by the criterion. Returns whether any broke on any rank. Collective. */
    bool break_bonds(const NodalVector &position)
    {
      const Stencils &shape = rows.stencils();
      std::vector<dealii::Tensor<2, 3>> deformation;
      for (unsigned int i = 0; i < shape.n_particles() && check->needs_deformation(); ++i)
      {
        const dealii::Tensor<2, dim> total = kernel.total_deformation(i, shape, position);
        deformation.emplace_back(dealii::unit_symmetric_tensor<3>());
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            deformation.back()[a][b] = total[a][b];
      }
      if (!check->measure(points.points(), deformation, particles.communicator()))
        return false;
      const auto &partition = position.partition();
      check->exchange(partition, particles.initial_positions(), shape);
      if (!partners.are_current())
        partners.find(partition, rows.neighbourhoods(), own_ids, broken, growth);
      std::vector<PartnerMessage> messages;
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        for (const unsigned int k : check->find_breaking(i, position, shape))
          break_entry(i, shape.row_start[i] + k, messages);
      return complete_breaking(partition, messages);
    }
    /** Breaks the bond at an entry of the rows; its other end goes to @p messages. */
    void break_entry(const unsigned int row, const std::size_t entry,
                     std::vector<PartnerMessage> &messages)
    {
      const auto &nodes = rows.neighbourhoods().global_nodes();
      const auto &images = rows.neighbourhoods().images();
      const unsigned int neighbour = rows.neighbourhoods().neighbour_indices()[entry];
      const BondPartner partner = partners[neighbour].partner;
      // The mirror image of the bond of I to an image of J is that of J to the image of I.
      if (broken.add(row, partner))
        messages.push_back(
            {neighbour < nodes.size() ? nodes[neighbour] : images[neighbour - nodes.size()].source,
             {own_ids[row], partner.planes}});
    }
    /** Completes break_entry(): renews the rows. Whether any bond broke on any rank. Collective. */
    bool complete_breaking(const std::shared_ptr<const NodePartition> &partition,
                           const std::vector<PartnerMessage> &messages)
    {
      if (dealii::Utilities::MPI::max(messages.empty() ? 0 : 1, particles.communicator()) == 0)
        return false;
      broken.add_at_owners(*partition, particles.nodes(), messages);
      is_broken_anywhere = true;
      double *const fraction = points.points().component(fraction_field, 0);
      for (unsigned int i = 0; i < broken.size(); ++i)
        if (!broken[i].empty())
          fraction[i] = std::min(1., static_cast<double>(broken[i].size()) /
                                         std::max(n_initial_bonds[i], 1u));
      prepare_change();
      // Of particles with broken bonds, neighbours that the last search found out of the support
      // (φ = 0) stay without a bond, wherever they move. Other particles are damaged now.
      const Stencils &shape = rows.stencils();
      partners.find(partition, rows.neighbourhoods(), own_ids, broken, growth);
      add_pairs(
          [&](const unsigned int i, const unsigned int neighbour, const std::size_t entry)
          {
            return is_damaged(i, neighbour) && !broken.has(i, partners[neighbour].partner) &&
                   !shape.row(i).is_within_support(
                       static_cast<unsigned int>(entry - shape.row_start[i]));
          },
          refused);
      remove_broken(partition);
      NodalVector reference(partition, Quantity::position);
      rows.compute_in_reference(particles, kernel, reference);
      release_debris();
      return true;
    }
    /** Removes broken bonds from the rows, which are of @p partition. Collective. */
    void remove_broken(const std::shared_ptr<const NodePartition> &partition)
    {
      if (!partners.are_current())
        partners.find(partition, rows.neighbourhoods(), own_ids, broken, growth);
      rows.neighbourhoods().remove_neighbours(
          [&](const unsigned int row, const unsigned int neighbour)
          {
            return broken.has(row, partners[neighbour].partner) ||
                   refused.has(row, partners[neighbour].partner);
          },
          rows.stencils());
    }
    /** Adds to @p lists the neighbours of which is_such(row, neighbour, entry) holds. */
    template <typename IsSuch>
    void add_pairs(const IsSuch &is_such, PartnerLists &lists) const
    {
      const Stencils &shape = rows.stencils();
      for (unsigned int i = 0; i < own_ids.size(); ++i)
        for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
          if (const unsigned int neighbour = rows.neighbourhoods().neighbour_indices()[entry];
              is_such(i, neighbour, entry))
            lists.add(i, partners[neighbour].partner);
    }
    bool is_damaged(const unsigned int row, const unsigned int neighbour) const
    {
      return !broken[row].empty() || partners[neighbour].is_damaged;
    }
    /** Whether a pair whose bond is not known is none, since one of its ends is damaged. */
    bool is_refused(const unsigned int row, const unsigned int neighbour) const
    {
      if (neighbour == row || !is_damaged(row, neighbour) ||
          previous.has(row, partners[neighbour].partner))
        return false;
      const ParticleGrowth a = partners[row].growth, b = partners[neighbour].growth;
      return a == ParticleGrowth::none || b == ParticleGrowth::none ||
             (a != ParticleGrowth::is_new && b != ParticleGrowth::is_new);
    }

    const ParticleSet<dim> &particles;
    const KernelConfiguration<dim> &kernel;
    ParticleRows<dim> &rows;
    PartPoints &points;
    std::unique_ptr<BondCheck<dim>> check; // null: bonds do not break
    bool is_broken_anywhere = false;
    unsigned int fraction_field = 0, dissipation_field = 0;
    std::function<void()> before_change;
    FormerRows former_rows; // only during an update

    // By particle.
    std::vector<std::uint64_t> own_ids;
    std::vector<unsigned int> n_initial_bonds;
    std::vector<double> initial_gradient;   // √Σ_J |∇φ_J|² [1/L]
    std::vector<double> reference_gradient; // the same of the rows as they are; empty: not found
    PartnerLists broken;
    PartnerLists refused;               // found by the last search, but never to be bonded
    PartnerLists previous;              // of bonds with a damaged end, only during a search
    std::vector<ParticleGrowth> growth; // since the last search; empty: none
    bool has_grown = false;

    NeighbourPartners<dim> partners;
  };
} // namespace tombolo
