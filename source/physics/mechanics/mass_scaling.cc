// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mass_scaling.h>

#include <tombolo/base/format.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  MassScaling<dim>::MassScaling(const Section &section, const ScalingSettings &settings,
                                const std::vector<Part<dim>> &parts, const MPI_Comm communicator)
      : section(section), chosen(settings), parts(parts), communicator(communicator)
  {}

  template <int dim>
  const ScalingSettings &MassScaling<dim>::settings() const
  {
    return chosen;
  }

  template <int dim>
  void MassScaling<dim>::start(const NodalVector &position)
  {
    if (!chosen.is_selective())
      return;
    factors.resize(parts.size());
    std::vector<double> steps;
    double smallest = 1e300;
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      parts[p].formulation->courant_limits(position, steps);
      factors[p].assign(steps.size(), 1.);
      for (const double step : steps)
        smallest = std::min(smallest, step);
    }
    smallest = Utilities::MPI::min(smallest, communicator);
    if (smallest >= chosen.target_time_step)
      section.fail("Target time step",
                   "it would do nothing: the smallest stable step of a cell or particle is " +
                       format_number(smallest) + " already; allowed are larger ones.");
    const double largest = std::pow(chosen.target_time_step / smallest, 2);
    if (!(largest <= ScalingSettings::largest_factor))
      section.fail("Target time step", "the smallest stable step of a cell or particle is " +
                                           format_number(smallest) +
                                           "; allowed are up to a million times as many.");
    raise(position);
  }

  template <int dim>
  bool MassScaling<dim>::is_due(const unsigned long step) const
  {
    return chosen.is_selective() && step > 0 && step % chosen.interval == 0;
  }

  template <int dim>
  bool MassScaling<dim>::raise(const NodalVector &position)
  {
    int has_risen = 0;
    std::vector<double> steps;
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      parts[p].formulation->courant_limits(position, steps);
      for (std::size_t i = 0; i < steps.size(); ++i)
      {
        const double ratio = chosen.target_time_step / steps[i];
        // A cell turned inside out has no step; the forces say so.
        const double wanted = std::min(ratio * ratio, ScalingSettings::largest_factor);
        if (!(steps[i] > 0.) || !(wanted > factors[p][i]))
          continue;
        factors[p][i] = wanted;
        has_risen = 1;
      }
      parts[p].formulation->scale_inertia(factors[p]);
    }
    return Utilities::MPI::max(has_risen, communicator) == 1;
  }

  template <int dim>
  void MassScaling<dim>::complete_element_mass(NodalVector &element_mass) const
  {
    if (chosen.is_selective())
      for (const Part<dim> &part : parts)
        if (part.particles == nullptr)
          part.formulation->add_extra_mass(element_mass);
    element_mass.add_to_owners();
    const double factor = chosen.inertia_factor();
    for (unsigned int i = 0; i < element_mass.partition()->n_owned(); ++i)
      *element_mass.node(i) *= factor;
  }

  template <int dim>
  std::vector<double> MassScaling<dim>::particle_factors() const
  {
    const auto n = std::count_if(parts.begin(), parts.end(),
                                 [](const Part<dim> &part) { return part.particles != nullptr; });
    return std::vector<double>(static_cast<std::size_t>(n), chosen.inertia_factor());
  }

  template <int dim>
  std::vector<std::vector<double>> MassScaling<dim>::row_factors() const
  {
    std::vector<std::vector<double>> result;
    if (chosen.is_selective())
      for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p].particles != nullptr)
          result.push_back(factors[p]);
    return result;
  }

  template <int dim>
  typename MassScaling<dim>::Extent MassScaling<dim>::extent(const NodalVector &position) const
  {
    Extent extent;
    double smallest = 1e300;
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      if (chosen.is_selective())
      {
        unsigned long &count = parts[p].particles != nullptr ? extent.particles : extent.cells;
        std::vector<double> steps;
        parts[p].formulation->courant_limits(position, steps);
        for (std::size_t i = 0; i < steps.size(); ++i)
        {
          constexpr double of_removed_cells = 1e299;
          if (factors[p][i] > 1. && steps[i] < of_removed_cells)
            ++count;
          smallest = std::min(smallest, steps[i]);
        }
      }
      else
        smallest = std::min(smallest, parts[p].formulation->courant_limit(position).time_step);
    }
    extent.cells = Utilities::MPI::sum(extent.cells, communicator);
    extent.particles = Utilities::MPI::sum(extent.particles, communicator);
    extent.smallest_step =
        Utilities::MPI::min(smallest, communicator) / std::sqrt(chosen.inertia_factor());
    return extent;
  }

  template <int dim>
  void MassScaling<dim>::serialize(StateArchive &archive, const unsigned int part)
  {
    if (!chosen.is_selective())
      return;
    archive.rows("inertia factors", 1, factors[part]);
    if (archive.is_reading())
      parts[part].formulation->scale_inertia(factors[part]);
  }

  template class MassScaling<2>;
  template class MassScaling<3>;
} // namespace tombolo
