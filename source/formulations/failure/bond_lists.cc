// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <utility>

// What becomes of the lists of partners when there are more particles, and in checkpoints.
namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void Bonds<dim>::add_particles(const std::vector<std::uint64_t> &ids,
                                 const std::vector<unsigned int> &old_place,
                                 const std::vector<bool> &gains)
  {
    const auto move = [&](auto &values)
    {
      if (values.empty())
        return;
      auto old = std::exchange(values, {});
      values.resize(ids.size());
      for (std::size_t i = 0; i < ids.size(); ++i)
        if (old_place[i] < old.size())
          values[i] = std::move(old[old_place[i]]);
    };
    const std::size_t n_old = own_ids.size();
    for (auto *const lists : {&broken, &refused, &previous})
      move(*lists);
    move(n_initial_bonds);
    move(initial_gradient);
    own_ids = ids;
    for (auto *const lists : {&broken, &refused})
      lists->resize(ids.size());
    n_initial_bonds.resize(ids.size(), 0);
    initial_gradient.resize(ids.size(), 0.);
    growth.clear();
    for (std::size_t i = 0; i < ids.size(); ++i)
      growth.push_back(old_place[i] >= n_old ? Growth::is_new
                       : gains[i]            ? Growth::gains
                                             : Growth::none);
    has_grown = true;
    partners_are_current = false;
    previous.resize(ids.size());
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
        { return has(broken[row], partner_of_place[place]) || is_refused(row, place); },
        shape);
    partners_are_current = false;
  }

  template <int dim>
  void Bonds<dim>::serialize(StateArchive &archive)
  {
    archive("steps since bond check", steps_since_check);
    serialize(archive, "partners that broke off", broken);
    serialize(archive, "partners that were refused", refused);
    archive("has grown", has_grown);
    if (has_grown)
    {
      std::vector<double> n_bonds(n_initial_bonds.begin(), n_initial_bonds.end());
      archive.rows("bonds at the start", 1, n_bonds);
      archive.rows("gradient at the start", 1, initial_gradient);
      std::transform(n_bonds.begin(), n_bonds.end(), n_initial_bonds.begin(),
                     [](const double n) { return static_cast<unsigned int>(n); });
    }
    if (!archive.is_reading())
      return;
    partners_are_current = false;
    const bool is_broken = std::any_of(broken.begin(), broken.end(),
                                       [](const Partners &partners) { return !partners.empty(); });
    is_broken_anywhere = Utilities::MPI::max(is_broken ? 1 : 0, communicator) == 1;
  }

  template <int dim>
  void Bonds<dim>::serialize(StateArchive &archive, const std::string &name,
                             std::vector<Partners> &lists)
  {
    // Rows of the file are of one length, that of the longest list.
    unsigned int longest = 0;
    for (const Partners &partners : lists)
      longest = std::max(longest, static_cast<unsigned int>(partners.size()));
    longest = Utilities::MPI::max(longest, communicator);
    archive("most " + name, longest);
    if (archive.is_reading())
      lists.assign(lists.size(), {});
    if (longest == 0)
      return;
    constexpr unsigned int n_numbers = 3;
    constexpr double none = -1.;
    std::vector<double> values;
    for (const Partners &partners : lists)
    {
      for (const Partner &partner : partners)
        values.insert(values.end(), {upper_half(partner.id), lower_half(partner.id),
                                     static_cast<double>(partner.planes)});
      values.resize(values.size() + std::size_t(n_numbers) * (longest - partners.size()), none);
    }
    archive.rows(name, n_numbers * longest, values);
    if (!archive.is_reading())
      return;
    std::size_t next = 0;
    for (Partners &partners : lists)
      for (unsigned int k = 0; k < longest; ++k, next += n_numbers)
        if (values[next] != none)
          partners.push_back({joined(values[next], values[next + 1]),
                              static_cast<std::uint64_t>(values[next + 2])});
  }

  template void Bonds<2>::add_particles(const std::vector<std::uint64_t> &,
                                        const std::vector<unsigned int> &,
                                        const std::vector<bool> &);
  template void Bonds<3>::add_particles(const std::vector<std::uint64_t> &,
                                        const std::vector<unsigned int> &,
                                        const std::vector<bool> &);
  template void Bonds<2>::remove_unbonded(const std::shared_ptr<const NodePartition> &,
                                          Neighbourhoods<2> &, Stencils &);
  template void Bonds<3>::remove_unbonded(const std::shared_ptr<const NodePartition> &,
                                          Neighbourhoods<3> &, Stencils &);
  template void Bonds<2>::serialize(StateArchive &);
  template void Bonds<3>::serialize(StateArchive &);
} // namespace tombolo
