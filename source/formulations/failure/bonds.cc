// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/bonds.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr char fraction_name[] = "broken bonds";
  } // namespace

  template <int dim>
  std::unique_ptr<Bonds<dim>> Bonds<dim>::create(const Entries &e)
  {
    if (e.given("Bond failure") == "none")
      return nullptr;
    return std::unique_ptr<Bonds<dim>>(new Bonds<dim>(e));
  }

  template <int dim>
  Bonds<dim>::Bonds(const Entries &e) : check(e)
  {
    isolates_all =
        e.choice("Isolate distorted", "with broken bonds", "with broken bonds|all",
                 "Bond failure: which particles lose all their bonds where they are turned inside "
                 "out, or where their gradients grow to three times those of the start: `with "
                 "broken bonds`, or `all`, in flows that tear the neighbours of a particle away. A "
                 "particle that is turned inside out otherwise ends the run.") == "all";
  }

  template <int dim>
  std::vector<FieldDescription> Bonds<dim>::variables() const
  {
    return {{fraction_name, "1", FieldLocation::material_point, 1, true},
            {dissipation_name, "M/(L T^2)", FieldLocation::material_point, 1, true, 0., false,
             OnDivision::held}};
  }

  template <int dim>
  void Bonds<dim>::initialize(const std::vector<std::uint64_t> &ids, const Stencils &shape,
                              const MaterialPoints &points, const MPI_Comm mpi_communicator)
  {
    check.start(points);
    communicator = mpi_communicator;
    fraction_field = points.find_field(fraction_name);
    dissipation_field = points.find_field(dissipation_name);
    own_ids = ids;
    broken.reset(ids.size());
    refused.reset(ids.size());
    n_initial_bonds.assign(ids.size(), 0);
    initial_gradient.assign(ids.size(), 0.);
    measure_rows(shape);
    is_broken_anywhere = false;
    partners.forget();
  }

  template <int dim>
  void Bonds<dim>::measure_rows(const Stencils &shape)
  {
    for (unsigned int i = 0; i < own_ids.size(); ++i)
    {
      if (!broken[i].empty())
        continue;
      const Stencils::Row row = shape.row(i);
      double squared = 0;
      n_initial_bonds[i] = 0;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        if (row.is_within_support(k) && row.neighbour[k] != shape.particle_node[i])
          ++n_initial_bonds[i];
        for (unsigned int d = 0; d < dim; ++d)
          squared += row.gradient[k * Stencils::n_gradient + d] *
                     row.gradient[k * Stencils::n_gradient + d];
      }
      initial_gradient[i] = std::sqrt(squared);
    }
  }

  template <int dim>
  void Bonds<dim>::find_partners(const std::shared_ptr<const NodePartition> &partition,
                                 const Neighbourhoods<dim> &neighbourhoods)
  {
    partners.find(partition, neighbourhoods, own_ids, broken, growth);
  }

  template <int dim>
  bool Bonds<dim>::break_bonds(const NodalVector &position,
                               const std::vector<types::global_dof_index> &particles,
                               const std::vector<Point<dim>> &initial_positions,
                               const std::vector<Tensor<2, 3>> &deformation,
                               const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape,
                               MaterialPoints &points)
  {
    if (!check.measure(points, deformation, communicator))
      return false;
    const auto &partition = position.partition();
    check.exchange(partition, initial_positions, shape);
    if (!partners.are_current())
      find_partners(partition, neighbourhoods);
    std::vector<PartnerMessage> messages;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      for (const unsigned int k : check.find_breaking(i, position, shape))
        break_entry(i, shape.row_start[i] + k, neighbourhoods, messages);
    return complete_breaking(*partition, particles, messages, points);
  }

  template <int dim>
  bool Bonds<dim>::isolate_distorted(const NodalVector &position,
                                     const std::vector<types::global_dof_index> &particles,
                                     const Neighbourhoods<dim> &neighbourhoods,
                                     const Stencils &shape, MaterialPoints &points)
  {
    if (!can_isolate())
      return false;
    std::vector<unsigned int> distorted;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      if ((isolates_all || !broken[i].empty()) && !shape.is_undeformed(i) &&
          !(present_gradient<dim>(shape, i, position) / initial_gradient[i] <=
            largest_gradient_growth))
        distorted.push_back(i);
    if (Utilities::MPI::max(distorted.empty() ? 0 : 1, communicator) == 0)
      return false;

    // Also from the rows of others, who may have such a particle without being in its row.
    const auto &partition = position.partition();
    if (!partners.are_current())
      find_partners(partition, neighbourhoods);
    const NodalVector mark = marked_nodes(partition,
                                          [&](const auto &mark_node)
                                          {
                                            for (const unsigned int i : distorted)
                                              mark_node(shape.particle_node[i]);
                                          });
    std::vector<PartnerMessage> messages;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const unsigned int own = shape.particle_node[i];
      for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
        if (shape.neighbour[entry] != own &&
            (*mark.node(own) > 0. || *mark.node(shape.neighbour[entry]) > 0.))
          break_entry(i, entry, neighbourhoods, messages);
    }
    return complete_breaking(*partition, particles, messages, points);
  }

  template <int dim>
  void Bonds<dim>::break_entry(const unsigned int row, const std::size_t entry,
                               const Neighbourhoods<dim> &neighbourhoods,
                               std::vector<PartnerMessage> &messages)
  {
    const auto &nodes = neighbourhoods.global_nodes();
    const unsigned int place = neighbourhoods.places()[entry];
    const BondPartner partner = partners.partner(place);
    if (!broken.add(row, partner))
      return;
    // The mirror image of the bond of I to an image of J is that of J to the image of I.
    messages.push_back(
        {place < nodes.size() ? nodes[place] : neighbourhoods.images()[place - nodes.size()].source,
         {own_ids[row], partner.planes}});
  }

  template <int dim>
  bool Bonds<dim>::complete_breaking(const NodePartition &partition,
                                     const std::vector<types::global_dof_index> &particles,
                                     const std::vector<PartnerMessage> &messages,
                                     MaterialPoints &points)
  {
    if (Utilities::MPI::max(messages.empty() ? 0 : 1, communicator) == 0)
      return false;
    broken.add_at_owners(partition, particles, messages);
    is_broken_anywhere = true;
    double *const fraction = points.component(fraction_field, 0);
    for (unsigned int i = 0; i < broken.size(); ++i)
      if (!broken[i].empty())
        fraction[i] =
            std::min(1., static_cast<double>(broken[i].size()) / std::max(n_initial_bonds[i], 1u));
    return true;
  }

  template <int dim>
  void Bonds<dim>::remove_broken(const std::shared_ptr<const NodePartition> &partition,
                                 Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
  {
    if (!partners.are_current())
      find_partners(partition, neighbourhoods);
    neighbourhoods.remove_neighbours(
        [&](const unsigned int row, const unsigned int place) {
          return broken.has(row, partners.partner(place)) ||
                 refused.has(row, partners.partner(place));
        },
        shape);
  }

  template <int dim>
  void Bonds<dim>::refuse_unbonded(const std::shared_ptr<const NodePartition> &partition,
                                   const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape)
  {
    find_partners(partition, neighbourhoods); // who is damaged has changed
    for (unsigned int i = 0; i < own_ids.size(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const unsigned int place = neighbourhoods.places()[shape.row_start[i] + k];
        if (!row.is_within_support(k) && (!broken[i].empty() || partners.is_damaged(place)) &&
            !broken.has(i, partners.partner(place)))
          refused.add(i, partners.partner(place));
      }
    }
  }

  template <int dim>
  void Bonds<dim>::prepare_search(const std::shared_ptr<const NodePartition> &partition,
                                  const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape)
  {
    if (!is_broken_anywhere)
      return;
    find_partners(partition, neighbourhoods); // who is damaged may have changed since
    previous.reset(own_ids.size());
    for (unsigned int i = 0; i < own_ids.size(); ++i)
    {
      PartnerLists::List list;
      for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
      {
        const unsigned int place = neighbourhoods.places()[entry];
        if (!broken[i].empty() || partners.is_damaged(place))
          list.push_back(partners.partner(place));
      }
      previous.set(i, std::move(list));
    }
  }

  template <int dim>
  void Bonds<dim>::finish_search(const std::shared_ptr<const NodePartition> &partition,
                                 Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
  {
    partners.forget();
    if (!is_broken_anywhere)
    {
      growth.clear();
      return;
    }
    find_partners(partition, neighbourhoods);
    previous.resize(own_ids.size());
    refused.reset(own_ids.size());
    for (unsigned int i = 0; i < own_ids.size(); ++i)
      for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
      {
        const unsigned int place = neighbourhoods.places()[entry];
        if (is_refused(i, place) && !broken.has(i, partners.partner(place)))
          refused.add(i, partners.partner(place));
      }
    previous.reset(0);
    growth.clear();
    remove_broken(partition, neighbourhoods, shape);
  }

  template <int dim>
  std::vector<unsigned int> Bonds<dim>::debris(const Stencils &shape) const
  {
    std::vector<unsigned int> rows;
    for (const unsigned int row : shape.rank_deficient_rows)
      if (!broken[row].empty())
        rows.push_back(row);
    return rows;
  }

  template <int dim>
  bool Bonds<dim>::is_refused(const unsigned int row, const unsigned int place) const
  {
    if (place == row || (broken[row].empty() && !partners.is_damaged(place)) ||
        previous.has(row, partners.partner(place)))
      return false;
    const ParticleGrowth a = partners.growth(row), b = partners.growth(place);
    return a == ParticleGrowth::none || b == ParticleGrowth::none ||
           (a != ParticleGrowth::is_new && b != ParticleGrowth::is_new);
  }

  template <int dim>
  void Bonds<dim>::release_debris(const Stencils &shape,
                                  const std::vector<double> &elastic_energies,
                                  const std::vector<double> &initial_volume,
                                  MaterialPoints &points) const
  {
    double *const dissipation = points.component(dissipation_field, 0);
    const unsigned int work_field = points.find_field("pressure work"); // stored, too
    for (const unsigned int row : debris(shape))
    {
      if (work_field < points.fields().size())
        points.component(work_field, 0)[row] = 0.;
      dissipation[row] += elastic_energies[row] / initial_volume[row];
      for (unsigned int c = 0; c < 6; ++c)
        points.component(MaterialPoints::stress, c)[row] = 0.;
    }
  }

  template <int dim>
  BondCounts Bonds<dim>::counts(const Stencils &shape) const
  {
    BondCounts result;
    result.criterion = check.criterion_name();
    for (std::size_t i = 0; i < broken.size(); ++i)
      for (const BondPartner &partner : broken[i])
        result.n_broken += partner.id == own_ids[i] ? 1. : 0.5;
    result.n_debris = debris(shape).size();
    return result;
  }

  template <int dim>
  void Bonds<dim>::add_particles(const std::vector<std::uint64_t> &ids,
                                 const std::vector<unsigned int> &old_place,
                                 const std::vector<bool> &gains)
  {
    const std::size_t n_old = own_ids.size();
    const auto rearrange = [&](auto &values)
    {
      const auto old = std::exchange(values, {});
      values.resize(ids.size());
      for (std::size_t i = 0; i < ids.size(); ++i)
        if (old_place[i] < old.size())
          values[i] = old[old_place[i]];
    };
    for (PartnerLists *const lists : {&broken, &refused, &previous})
      lists->rearrange(old_place);
    rearrange(n_initial_bonds);
    rearrange(initial_gradient);
    own_ids = ids;
    growth.clear();
    for (std::size_t i = 0; i < ids.size(); ++i)
      growth.push_back(old_place[i] >= n_old ? ParticleGrowth::is_new
                       : gains[i]            ? ParticleGrowth::gains
                                             : ParticleGrowth::none);
    has_grown = true;
    partners.forget();
  }

  template <int dim>
  void Bonds<dim>::remove_unbonded(const std::shared_ptr<const NodePartition> &partition,
                                   Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
  {
    if (!is_broken_anywhere)
      return;
    find_partners(partition, neighbourhoods);
    neighbourhoods.remove_neighbours(
        [&](const unsigned int row, const unsigned int place)
        { return broken.has(row, partners.partner(place)) || is_refused(row, place); },
        shape);
    partners.forget();
  }

  template <int dim>
  void Bonds<dim>::list(Records &records)
  {
    check.list(records);
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
          is_broken_anywhere = Utilities::MPI::max(is_broken ? 1 : 0, communicator) == 1;
        });
  }

  template class Bonds<2>;
  template class Bonds<3>;
} // namespace tombolo
