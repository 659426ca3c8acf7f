// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/sphere_contact.h>
#include <tombolo/model/process.h>

namespace tombolo
{
  /** Contact between particles: fragments of a part, bodies that no chain of bonds connects, and
   * bodies of different parts with self-contact push each other away, and rub and conduct where
   * their parts have such entries. Its stored and dissipated energies are among those of the parts.
   */
  template <int dim>
  class FragmentContact : public Process<dim>
  {
  public:
    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &force) override;

    explicit FragmentContact(const Model<dim> &model);

    SphereContact<dim> &between_particles()
    {
      return contact;
    }

  private:
    const Model<dim> &model;
    unsigned long revision_of_cells;
    SphereContact<dim> contact;
    Action &forces;
    HeatAction *heat = nullptr; // null where nothing heats
  };
} // namespace tombolo
