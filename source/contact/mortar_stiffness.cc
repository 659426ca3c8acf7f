// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_stiffness.h>

#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>

namespace tombolo
{
  using namespace dealii;

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
} // namespace tombolo
