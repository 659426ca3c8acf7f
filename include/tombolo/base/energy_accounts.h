// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  /** What an energy is in the balance. */
  enum class EnergyKind
  {
    stored,     ///< can be recovered
    dissipated, ///< taken by the physics: plastic flow, friction, failure
    artificial, ///< stored or taken by the method: hourglass control, viscosity, filters
    removed,    ///< has left with what was removed from the model
    external    ///< was added from outside since the start
  };

  /** Whether an energy of this kind counts in the total that the external ones must explain. */
  constexpr bool is_held(const EnergyKind kind)
  {
    return kind != EnergyKind::external;
  }

  /**
   * Energies by name and kind, and impulses. Everything that has an energy adds it under the name
   * of its column in the tables; what is added under one name is summed. Values are the shares of
   * this rank until sum_over_ranks(). The names, and their order, must be the same on all ranks.
   */
  class EnergyAccounts
  {
  public:
    struct Account
    {
      std::string name;
      EnergyKind kind;
      double value; ///< [M L^2/T^2]
    };

    /** Adds the share of this rank. */
    void add(const std::string &name, EnergyKind kind, double value);

    /** Adds a value that is the same on all ranks, and that counts once. */
    void add_replicated(const std::string &name, EnergyKind kind, double value);

    /** Adds @p factor times all that @p other holds, before any sum over ranks. */
    void add(const EnergyAccounts &other, double factor = 1.);

    /** Adds this rank's share of the impulse [M L/T] that bodies were given from outside, and of
     * its moment about the origin [M L^2/T]. */
    void add_impulse(const std::array<double, 3> &impulse,
                     const std::array<double, 3> &angular_impulse);

    /** The same of what has left with what was removed from the model. */
    void add_removed_momentum(const std::array<double, 3> &momentum,
                              const std::array<double, 3> &angular_momentum);

    /** Replaces the shares of the ranks by their sums, in one ordered sum. Collective. */
    void sum_over_ranks(MPI_Comm communicator);

    /** Zero where there is no such account. */
    double operator[](const std::string &name) const;

    /** The sum of all accounts of this kind, in the order in which they were added. */
    double sum_of(EnergyKind kind) const;

    /** The sum of all accounts that are held. */
    double total() const;

    const std::vector<Account> &accounts() const
    {
      return entries;
    }

    std::array<double, 3> impulse{}, angular_impulse{};
    std::array<double, 3> removed_momentum{}, removed_angular_momentum{};

  private:
    std::vector<Account> entries;
    std::vector<Account> replicated; ///< joined with the others in sum_over_ranks()
  };
} // namespace tombolo
