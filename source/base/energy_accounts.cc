// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/energy_accounts.h>

#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/exceptions.h>

namespace tombolo
{
  namespace
  {
    EnergyAccounts::Account &find_or_append(const std::string &name, const EnergyKind kind,
                                            std::vector<EnergyAccounts::Account> &list)
    {
      for (EnergyAccounts::Account &account : list)
        if (account.name == name)
        {
          Assert(account.kind == kind, dealii::ExcInternalError());
          return account;
        }
      list.push_back({name, kind, 0.});
      return list.back();
    }

    constexpr std::array<double, 3> EnergyAccounts::*vectors[] = {
        &EnergyAccounts::impulse, &EnergyAccounts::angular_impulse,
        &EnergyAccounts::removed_momentum, &EnergyAccounts::removed_angular_momentum};
  } // namespace

  void EnergyAccounts::add(const std::string &name, const EnergyKind kind, const double value)
  {
    find_or_append(name, kind, entries).value += value;
  }

  void EnergyAccounts::add_replicated(const std::string &name, const EnergyKind kind,
                                      const double value)
  {
    find_or_append(name, kind, entries); // keeps its position in the order
    find_or_append(name, kind, replicated).value += value;
  }

  void EnergyAccounts::add(const EnergyAccounts &other, const double factor)
  {
    for (const Account &entry : other.entries)
      add(entry.name, entry.kind, factor * entry.value);
    for (const Account &entry : other.replicated)
      add_replicated(entry.name, entry.kind, factor * entry.value);
    for (const auto vector : vectors)
      for (unsigned int d = 0; d < 3; ++d)
        (this->*vector)[d] += factor * (other.*vector)[d];
  }

  void EnergyAccounts::add_impulse(const std::array<double, 3> &force_impulse,
                                   const std::array<double, 3> &moment_impulse)
  {
    for (unsigned int d = 0; d < 3; ++d)
    {
      impulse[d] += force_impulse[d];
      angular_impulse[d] += moment_impulse[d];
    }
  }

  void EnergyAccounts::add_removed_momentum(const std::array<double, 3> &momentum,
                                            const std::array<double, 3> &angular_momentum)
  {
    for (unsigned int d = 0; d < 3; ++d)
    {
      removed_momentum[d] += momentum[d];
      removed_angular_momentum[d] += angular_momentum[d];
    }
  }

  void EnergyAccounts::sum_over_ranks(const MPI_Comm communicator)
  {
    std::vector<double> values;
    for (const Account &entry : entries)
      values.push_back(entry.value);
    for (const auto vector : vectors)
      values.insert(values.end(), (this->*vector).begin(), (this->*vector).end());
    values = ordered_sum(values, communicator);
    std::size_t next = 0;
    for (Account &entry : entries)
      entry.value = values[next++];
    for (const auto vector : vectors)
      for (double &component : this->*vector)
        component = values[next++];
    for (const Account &entry : replicated)
      add(entry.name, entry.kind, entry.value);
    replicated.clear();
  }

  double EnergyAccounts::operator[](const std::string &name) const
  {
    double value = 0.;
    for (const auto *const list : {&entries, &replicated})
      for (const Account &entry : *list)
        if (entry.name == name)
          value += entry.value;
    return value;
  }

  double EnergyAccounts::sum_of(const EnergyKind kind) const
  {
    double sum = 0.;
    for (const Account &entry : entries)
      if (entry.kind == kind)
        sum += entry.value;
    return sum;
  }

  double EnergyAccounts::total() const
  {
    double sum = 0.;
    for (const Account &entry : entries)
      if (is_held(entry.kind))
        sum += entry.value;
    return sum;
  }
} // namespace tombolo
