// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_contact.h>

#include <tombolo/base/format.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** Masses per area are found again every so many steps. */
    constexpr unsigned long steps_between_masses = 16;

    /** The least mass over area of these nodes. */
    double least_mass_per_area(const std::vector<unsigned int> &nodes,
                               const std::vector<double> &areas, const NodalVector &mass)
    {
      double least = std::numeric_limits<double>::max();
      for (std::size_t k = 0; k < nodes.size(); ++k)
        if (*mass.node(nodes[k]) > 0. && areas[k] > 0.)
          least = std::min(least, *mass.node(nodes[k]) / areas[k]);
      return least;
    }
  } // namespace

  template <int dim>
  void MortarStiffness<dim>::find(const NodalState &state, const Clock &clock,
                                  const ContactLaw &law, const double share, const bool touches,
                                  ContactFaces<dim> &slaves, ContactFaces<dim> &masters)
  {
    if (clock.step % steps_between_masses == 0 || mass_per_area == 0.)
    {
      slaves.find_areas(state.position, slave_areas);
      masters.find_areas(state.position, master_areas);
      std::vector<double> least{
          least_mass_per_area(slaves.owned_nodes(), slave_areas, state.mass),
          least_mass_per_area(masters.owned_nodes(), master_areas, state.mass), touches ? -1. : 0.};
      Utilities::MPI::min(least, state.partition()->communicator(), least);
      mass_per_area = 1. / (1. / least[0] + 1. / least[1]);
      if (least[2] == 0.)
        stiffness = 0.;
    }
    const double allowed = law.stiffness(share * mass_per_area, clock.stable_step);
    stiffness = stiffness > 0. ? std::min(stiffness, allowed) : allowed;
  }

  template <int dim>
  void MortarStiffness<dim>::list(Records &records, const ContactFaces<dim> &slaves,
                                  const ContactFaces<dim> &masters, const bool continues)
  {
    const auto number = [](double &value) -> double & { return value; };
    records.value("mass per area", mass_per_area);
    auto &of_springs = records.value("stiffness", stiffness);
    if (continues)
      of_springs.continues();
    records.at_nodes(slaves.owned_nodes(), slave_areas).numbers("areas of the slave", number);
    records.at_nodes(masters.owned_nodes(), master_areas).numbers("areas of the master", number);
  }

  template class MortarStiffness<2>;
  template class MortarStiffness<3>;

  template <int dim>
  void MortarHistory<dim>::list(Records &records, const std::vector<unsigned int> &nodes,
                                std::vector<MortarHistory> &histories, const bool continue_them)
  {
    using History = MortarHistory;
    auto columns = records.at_nodes(nodes, histories);
    columns
        .numbers(
            "stiffness, depth, damping force",
            [](History &h) -> double & { return h.spring.stiffness; },
            [](History &h) -> double & { return h.spring.depth; },
            [](History &h) -> double & { return h.spring.damping_force; })
        .numbers("gap, area, offset", &History::gap, &History::area, &History::offset)
        .vector(
            "elastic slip", [](History & h) -> auto & { return h.spring.elastic_slip; })
        .vector("traction", &History::traction)
        .vector("normal", &History::normal)
        .numbers("is bonded", &History::is_bonded);
    if (continue_them)
      columns.continues();
  }

  template <int dim>
  double MortarHistory<dim>::move(const std::vector<unsigned int> &former,
                                  const std::vector<unsigned int> &nodes,
                                  std::vector<MortarHistory> &histories)
  {
    double cut = 0;
    const std::vector<MortarHistory> before = std::move(histories);
    histories.assign(nodes.size(), {});
    for (std::size_t k = 0; k < former.size(); ++k)
    {
      const auto found = std::lower_bound(nodes.begin(), nodes.end(), former[k]);
      if (found != nodes.end() && *found == former[k])
        histories[static_cast<std::size_t>(found - nodes.begin())] = before[k];
      else
        cut += before[k].area * before[k].spring.elastic_energy();
    }
    return cut;
  }

  template <int dim>
  void MortarHistory<dim>::place(const NodalVector &before, const NodalVector &position,
                                 const std::vector<unsigned int> &nodes,
                                 MortarSegments<dim> &segments,
                                 std::vector<MortarHistory<dim>> &histories)
  {
    const auto gap_at = [&](const unsigned int node, Tensor<1, dim> &normal)
    {
      return segments.find_normal(node, normal)
                 ? std::optional<double>(
                       -(vector_of<dim>(segments.sums().gap.node(node)) * normal) /
                       segments.area_of(node))
                 : std::nullopt;
    };
    Tensor<1, dim> normal;
    std::vector<std::optional<double>> gaps;
    segments.gather(before, before, nullptr);
    for (const unsigned int node : nodes)
      gaps.push_back(gap_at(node, normal));
    segments.gather(position, position, nullptr);
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      MortarHistory<dim> &history = histories[k];
      const auto gap = gap_at(nodes[k], normal);
      if (!gap || !gaps[k])
        continue; // the next forces release it
      ContactSpring<dim> &spring = history.spring;
      if (spring.is_closed())
      {
        spring.elastic_slip = rotated_tangent(spring.elastic_slip, history.normal, normal);
        spring.depth = std::max(0., spring.depth + *gaps[k] - *gap);
        history.area = segments.area_of(nodes[k]);
      }
      else
        history.offset = std::max(history.offset, -*gap);
      history.normal = normal;
      history.gap += *gap - *gaps[k];
    }
  }

  template <int dim>
  std::array<double, 2>
  MortarHistory<dim>::temperatures(const NodalVector *const of_slave,
                                   const std::vector<unsigned int> &nodes,
                                   const std::vector<MortarHistory<dim>> &histories,
                                   const MortarSegments<dim> &segments, const MPI_Comm communicator)
  {
    using Segments = MortarSegments<dim>;
    std::vector<double> values;
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      if (!histories[k].spring.is_closed())
        continue;
      const double *const sums = segments.sums().scalars.node(nodes[k]);
      if (of_slave != nullptr)
        values.push_back(*of_slave->node(nodes[k]));
      else if (sums[Segments::area] > 0.)
        values.push_back(
            (sums[Segments::mean_temperature] + 0.5 * sums[Segments::temperature_difference]) /
            sums[Segments::area]);
    }
    return mean_and_largest(values, communicator);
  }

  template <int dim>
  std::string MortarHistory<dim>::describe_tie(const NodalVector &position,
                                               const std::vector<unsigned int> &slave_nodes,
                                               const std::vector<MortarHistory> &histories,
                                               const MPI_Comm communicator)
  {
    unsigned long n_tied = 0;
    std::vector<double> first; // of the free ones
    for (std::size_t k = 0; k < slave_nodes.size(); ++k)
    {
      const double *const x = position.node(slave_nodes[k]);
      if (histories[k].area > 0.)
        ++n_tied;
      else if (const std::vector<double> place(x, x + dim); first.empty() || place < first)
        first = place;
    }
    for (const std::vector<double> &of_rank : Utilities::MPI::all_gather(communicator, first))
      if (!of_rank.empty() && (first.empty() || of_rank < first))
        first = of_rank;
    n_tied = Utilities::MPI::sum(n_tied, communicator);
    const unsigned long n_nodes = Utilities::MPI::sum(slave_nodes.size(), communicator);
    const std::string text =
        std::to_string(n_tied) + " of " + std::to_string(n_nodes) + " slave nodes are tied";
    return first.empty() ? text
                         : text + ", " + std::to_string(n_nodes - n_tied) +
                               " not, where no master is near: the first at " +
                               place_text(vector_of<dim>(first.data()));
  }

  template struct MortarHistory<2>;
  template struct MortarHistory<3>;
} // namespace tombolo
