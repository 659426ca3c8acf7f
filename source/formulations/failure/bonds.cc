// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/formulations/failure/bonds.h>

#include <tombolo/approximation/row_deformation.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr char fraction_name[] = "broken bonds";
  } // namespace

  template <int dim>
  struct Bonds<dim>::Message
  {
    types::global_dof_index end; ///< whose list it is for
    Partner other;
  };

  template <int dim>
  void Bonds<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Bond failure", "none",
        Patterns::Selection("none|" + Registry<BondFailure>::instance().selection()),
        "When bonds between particles break, for good: a criterion with a section of its own, or "
        "`none`. Broken bonds leave the supports of both particles; mass, momentum and stress "
        "stay. Not with consistent gradients or the pair residual.");
    handler.declare_entry("Steps between bond checks", "5", Patterns::Integer(1, 1000000),
                          "Bond failure: bonds are checked every so many steps.");
    Registry<BondFailure>::instance().declare_all(handler);
  }

  template <int dim>
  std::unique_ptr<Bonds<dim>> Bonds<dim>::create(const Section &section)
  {
    if (section.get("Bond failure") == "none")
      return nullptr;
    if (section.get("Gradient") == "consistent")
      section.fail("Bond failure", "where bonds break the part has surfaces that its mesh does not "
                                   "have, and gradients cannot be made consistent with them; "
                                   "choose `moving least squares` as `Gradient`");
    if (section.get_double("Pair residual") > 0.)
      section.fail("Bond failure", "a pair residual stores energy in the pairs that would break; "
                                   "put it to 0, or use the lattice filter");
    return std::unique_ptr<Bonds<dim>>(new Bonds<dim>(section));
  }

  template <int dim>
  Bonds<dim>::Bonds(const Section &section)
      : criterion_name(section.get("Bond failure")),
        criterion(Registry<BondFailure>::instance().create(criterion_name,
                                                           section.subsection(criterion_name))),
        check_interval(section.get_unsigned("Steps between bond checks"))
  {}

  template <int dim>
  std::vector<FieldDescription> Bonds<dim>::variables() const
  {
    return {{fraction_name, "1", FieldLocation::material_point, 1, true},
            {dissipation_name, "M/(L T^2)", FieldLocation::material_point, 1, true}};
  }

  template <int dim>
  void Bonds<dim>::initialize(const std::vector<std::uint64_t> &ids, const Stencils &shape,
                              const MaterialPoints &points, const MPI_Comm mpi_communicator)
  {
    criterion->check(points);
    communicator = mpi_communicator;
    fraction_field = points.find_field(fraction_name);
    dissipation_field = points.find_field(dissipation_name);
    own_ids = ids;
    broken.assign(ids.size(), {});
    refused.assign(ids.size(), {});
    n_initial_bonds.assign(ids.size(), 0);
    initial_gradient.assign(ids.size(), 0.);
    measure_rows(shape);
    is_broken_anywhere = false;
    partners_are_current = false;
    steps_since_check = 0;
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
  bool Bonds<dim>::is_due()
  {
    if (++steps_since_check < check_interval)
      return false;
    steps_since_check = 0;
    return true;
  }

  template <int dim>
  bool Bonds<dim>::needs_deformation() const
  {
    return criterion->needs_deformation();
  }

  template <int dim>
  bool Bonds<dim>::add(Partners &partners, const Partner &partner)
  {
    const auto place = std::lower_bound(partners.begin(), partners.end(), partner);
    if (place != partners.end() && *place == partner)
      return false;
    partners.insert(place, partner);
    return true;
  }

  template <int dim>
  bool Bonds<dim>::has(const Partners &partners, const Partner &partner)
  {
    return !partners.empty() && std::binary_search(partners.begin(), partners.end(), partner);
  }

  template <int dim>
  void Bonds<dim>::find_partners(const std::shared_ptr<const NodePartition> &partition,
                                 const Neighbourhoods<dim> &neighbourhoods)
  {
    NodalVector tags;
    tags.reinit(partition, node_stride, ReflectionParity::even);
    const auto &nodes = neighbourhoods.global_nodes();
    for (unsigned int i = 0; i < own_ids.size(); ++i)
    {
      double *const tag = tags.node(partition->local_index(nodes[i]));
      tag[0] = upper_half(own_ids[i]);
      tag[1] = lower_half(own_ids[i]);
      tag[2] = broken[i].empty() ? 0. : 1.;
      tag[3] = growth.empty() ? 0. : static_cast<double>(growth[i]);
    }
    tags.update_ghosts();
    partner_of_place.clear();
    is_damaged.clear();
    growth_of_place.clear();
    const auto add_place = [&](const types::global_dof_index node, const unsigned int planes)
    {
      const double *const tag = tags.node(partition->local_index(node));
      partner_of_place.push_back({joined(tag[0], tag[1]), planes});
      is_damaged.push_back(tag[2] > 0.);
      growth_of_place.push_back(static_cast<Growth>(tag[3]));
    };
    for (const types::global_dof_index node : nodes)
      add_place(node, 0);
    for (const MirrorNode &image : neighbourhoods.images())
      add_place(image.source, image.planes);
    partners_are_current = true;
  }

  template <int dim>
  bool Bonds<dim>::break_bonds(const NodalVector &position,
                               const std::vector<types::global_dof_index> &particles,
                               const std::vector<Point<dim>> &initial_positions,
                               const std::vector<Tensor<2, 3>> &deformation,
                               const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape,
                               MaterialPoints &points)
  {
    std::vector<double> measure;
    criterion->measure(points, deformation, measure);
    const double threshold = criterion->threshold();
    double largest = std::numeric_limits<double>::lowest();
    for (const double value : measure)
      largest = std::max(largest, value);
    if (Utilities::MPI::max(largest, communicator) < threshold)
      return false;

    const auto &partition = position.partition();
    if (pair_data.partition() != partition)
      pair_data.reinit(partition, node_stride, ReflectionParity::point);
    const unsigned int n_particles = shape.n_particles();
    for (unsigned int i = 0; i < n_particles; ++i)
    {
      double *const data = pair_data.node(shape.particle_node[i]);
      for (unsigned int d = 0; d < dim; ++d)
        data[d] = initial_positions[i][d];
      data[node_stride - 1] = measure[i];
    }
    pair_data.update_ghosts();
    if (!partners_are_current)
      find_partners(partition, neighbourhoods);

    std::vector<Message> messages;
    std::vector<unsigned int> entries;
    std::vector<double> mean, stretch;
    std::vector<std::uint8_t> breaks;
    for (unsigned int i = 0; i < n_particles; ++i)
    {
      const unsigned int own = shape.particle_node[i];
      const double *const own_data = pair_data.node(own), *const own_place = position.node(own);
      const Stencils::Row row = shape.row(i);
      entries.clear();
      mean.clear();
      stretch.clear();
      for (unsigned int k = 0; k < row.size; ++k)
      {
        if (!row.is_within_support(k) || row.neighbour[k] == own)
          continue;
        const double *const data = pair_data.node(row.neighbour[k]);
        const double of_pair = 0.5 * (own_data[node_stride - 1] + data[node_stride - 1]);
        if (of_pair < threshold)
          continue;
        const double *const place = position.node(row.neighbour[k]);
        double now = 0, before = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          now += (place[d] - own_place[d]) * (place[d] - own_place[d]);
          before += (data[d] - own_data[d]) * (data[d] - own_data[d]);
        }
        entries.push_back(k);
        mean.push_back(of_pair);
        stretch.push_back(std::sqrt(now / before));
      }
      if (entries.empty())
        continue;
      breaks.resize(entries.size());
      criterion->judge(static_cast<unsigned int>(entries.size()), mean.data(), stretch.data(),
                       breaks.data());
      for (std::size_t n = 0; n < entries.size(); ++n)
        if (breaks[n] != 0)
          break_entry(i, shape.row_start[i] + entries[n], neighbourhoods, messages);
    }
    return complete_breaking(*partition, particles, messages, points);
  }

  template <int dim>
  bool Bonds<dim>::isolate_distorted(const NodalVector &position,
                                     const std::vector<types::global_dof_index> &particles,
                                     const Neighbourhoods<dim> &neighbourhoods,
                                     const Stencils &shape, MaterialPoints &points)
  {
    if (!is_broken_anywhere)
      return false;
    std::vector<unsigned int> distorted;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      if (!broken[i].empty() && !shape.is_rigid(i) &&
          !(gradient_growth(i, position, shape) <= largest_gradient_growth))
        distorted.push_back(i);
    if (Utilities::MPI::max(distorted.empty() ? 0 : 1, communicator) == 0)
      return false;

    // Also from the rows of others, who may have such a particle without being in its row.
    const auto &partition = position.partition();
    if (!partners_are_current)
      find_partners(partition, neighbourhoods);
    NodalVector mark;
    mark.reinit(partition, 1);
    for (const unsigned int i : distorted)
      *mark.node(shape.particle_node[i]) = 1.;
    mark.update_ghosts();
    std::vector<Message> messages;
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
  double Bonds<dim>::gradient_growth(const unsigned int row, const NodalVector &position,
                                     const Stencils &shape) const
  {
    const Stencils::Row of_row = shape.row(row);
    const Tensor<2, dim> deformation = row_deformation<dim>(shape, row, position);
    if (!(determinant(deformation) > 0.))
      return std::numeric_limits<double>::infinity();
    const Tensor<2, dim> inverse = invert(deformation);
    double squared = 0;
    for (unsigned int k = 0; k < of_row.size; ++k)
      for (unsigned int a = 0; a < dim; ++a)
      {
        double component = 0;
        for (unsigned int b = 0; b < dim; ++b)
          component += inverse[b][a] * of_row.gradient[k * Stencils::n_gradient + b];
        squared += component * component;
      }
    return std::sqrt(squared) / initial_gradient[row];
  }

  template <int dim>
  void Bonds<dim>::break_entry(const unsigned int row, const std::size_t entry,
                               const Neighbourhoods<dim> &neighbourhoods,
                               std::vector<Message> &messages)
  {
    const auto &nodes = neighbourhoods.global_nodes();
    const unsigned int place = neighbourhoods.places()[entry];
    const Partner partner = partner_of_place[place];
    if (!add(broken[row], partner))
      return;
    // The mirror image of the bond of I to an image of J is that of J to the image of I.
    messages.push_back(
        {place < nodes.size() ? nodes[place] : neighbourhoods.images()[place - nodes.size()].source,
         {own_ids[row], partner.planes}});
  }

  template <int dim>
  bool Bonds<dim>::complete_breaking(const NodePartition &partition,
                                     const std::vector<types::global_dof_index> &particles,
                                     const std::vector<Message> &messages, MaterialPoints &points)
  {
    if (Utilities::MPI::max(messages.empty() ? 0 : 1, communicator) == 0)
      return false;
    exchange(partition, particles, messages);
    is_broken_anywhere = true;
    double *const fraction = points.component(fraction_field, 0);
    for (unsigned int i = 0; i < broken.size(); ++i)
      if (!broken[i].empty())
        fraction[i] =
            std::min(1., static_cast<double>(broken[i].size()) / std::max(n_initial_bonds[i], 1u));
    return true;
  }

  template <int dim>
  void Bonds<dim>::exchange(const NodePartition &partition,
                            const std::vector<types::global_dof_index> &particles,
                            const std::vector<Message> &messages)
  {
    const auto take = [&](const types::global_dof_index end, const Partner &other)
    {
      const auto place = std::lower_bound(particles.begin(), particles.end(), end);
      AssertThrow(place != particles.end() && *place == end, ExcInternalError());
      add(broken[static_cast<std::size_t>(place - particles.begin())], other);
    };
    std::vector<unsigned int> rank_of_ghost;
    for (const auto &[rank, n] : partition.scalars()->ghost_targets())
      rank_of_ghost.insert(rank_of_ghost.end(), n, rank);
    std::map<unsigned int, std::vector<std::array<std::uint64_t, 3>>> to_ranks;
    for (const Message &message : messages)
      if (partition.owned().is_element(message.end))
        take(message.end, message.other);
      else
        to_ranks[rank_of_ghost[partition.local_index(message.end) - partition.n_owned()]].push_back(
            {{message.end, message.other.id, message.other.planes}});
    for (const auto &[rank, received] : Utilities::MPI::some_to_some(communicator, to_ranks))
      for (const auto &[end, id, planes] : received)
        take(static_cast<types::global_dof_index>(end), {id, planes});
  }

  template <int dim>
  void Bonds<dim>::remove_broken(const std::shared_ptr<const NodePartition> &partition,
                                 Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
  {
    if (!partners_are_current)
      find_partners(partition, neighbourhoods);
    neighbourhoods.remove_neighbours(
        [&](const unsigned int row, const unsigned int place) {
          return has(broken[row], partner_of_place[place]) ||
                 has(refused[row], partner_of_place[place]);
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
        if (!row.is_within_support(k) && (!broken[i].empty() || is_damaged[place]) &&
            !has(broken[i], partner_of_place[place]))
          add(refused[i], partner_of_place[place]);
      }
    }
  }

  template <int dim>
  bool Bonds<dim>::any() const
  {
    return is_broken_anywhere;
  }

  template <int dim>
  void Bonds<dim>::prepare_search(const std::shared_ptr<const NodePartition> &partition,
                                  const Neighbourhoods<dim> &neighbourhoods, const Stencils &shape)
  {
    if (!is_broken_anywhere)
      return;
    find_partners(partition, neighbourhoods); // who is damaged may have changed since
    previous.assign(own_ids.size(), {});
    for (unsigned int i = 0; i < own_ids.size(); ++i)
    {
      for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
      {
        const unsigned int place = neighbourhoods.places()[entry];
        if (!broken[i].empty() || is_damaged[place])
          previous[i].push_back(partner_of_place[place]);
      }
      std::sort(previous[i].begin(), previous[i].end());
    }
  }

  template <int dim>
  void Bonds<dim>::finish_search(const std::shared_ptr<const NodePartition> &partition,
                                 Neighbourhoods<dim> &neighbourhoods, Stencils &shape)
  {
    partners_are_current = false;
    if (!is_broken_anywhere)
    {
      growth.clear();
      return;
    }
    find_partners(partition, neighbourhoods);
    previous.resize(own_ids.size());
    refused.assign(own_ids.size(), {});
    for (unsigned int i = 0; i < own_ids.size(); ++i)
      for (std::size_t entry = shape.row_start[i]; entry < shape.row_start[i + 1]; ++entry)
      {
        const unsigned int place = neighbourhoods.places()[entry];
        if (is_refused(i, place) && !has(broken[i], partner_of_place[place]))
          add(refused[i], partner_of_place[place]);
      }
    previous.clear();
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
    if (place == row || (broken[row].empty() && !is_damaged[place]) ||
        has(previous[row], partner_of_place[place]))
      return false;
    const Growth a = growth_of_place[row], b = growth_of_place[place];
    return a == Growth::none || b == Growth::none || (a != Growth::is_new && b != Growth::is_new);
  }

  template <int dim>
  void Bonds<dim>::release_debris(const Stencils &shape, const Material &material,
                                  const double *temperature,
                                  const std::vector<double> &initial_volume,
                                  MaterialPoints &points) const
  {
    const std::vector<unsigned int> rows = debris(shape);
    if (rows.empty())
      return;
    double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);
    std::vector<double> density(points.padded_size());
    const double *const of_points[6] = {stress[0], stress[1], stress[2],
                                        stress[3], stress[4], stress[5]};
    material.elastic_energy_density(points.padded_size(), of_points, temperature, density.data());
    const double *const volume = points.component(MaterialPoints::volume, 0);
    double *const dissipation = points.component(dissipation_field, 0);
    for (const unsigned int row : rows)
    {
      dissipation[row] += density[row] * volume[row] / initial_volume[row];
      for (double *const component : stress)
        component[row] = 0.;
    }
  }

  template <int dim>
  BondCounts Bonds<dim>::counts(const Stencils &shape) const
  {
    BondCounts result;
    result.criterion = criterion_name;
    for (std::size_t i = 0; i < broken.size(); ++i)
      for (const Partner &partner : broken[i])
        result.n_broken += partner.id == own_ids[i] ? 1. : 0.5;
    result.n_debris = debris(shape).size();
    return result;
  }

  template <int dim>
  std::size_t Bonds<dim>::memory_consumption() const
  {
    std::size_t bytes = own_ids.capacity() * sizeof(std::uint64_t) +
                        n_initial_bonds.capacity() * sizeof(unsigned int) +
                        initial_gradient.capacity() * sizeof(double) +
                        partner_of_place.capacity() * sizeof(Partner) +
                        pair_data.memory_consumption();
    for (const auto *lists : {&broken, &refused, &previous})
    {
      bytes += lists->capacity() * sizeof(Partners);
      for (const Partners &partners : *lists)
        bytes += partners.capacity() * sizeof(Partner);
    }
    return bytes;
  }

  template class Bonds<2>;
  template class Bonds<3>;
} // namespace tombolo
