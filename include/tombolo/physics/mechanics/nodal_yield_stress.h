// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/model.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The present yield stress at nodes, for a limit of shear in contacts: the flow stress of a slow
   * test at the plastic strain and the temperature there. That strain is that of the particle, or
   * the mean of the points of all cells at the node; of several materials it is their mean by the
   * number of points.
   */
  template <int dim>
  class NodalYieldStress
  {
  public:
    using Contacts = std::vector<std::unique_ptr<SurfaceContact<dim>>>;

    /** Throws InputError where a contact asks for what no material of the parts has. */
    static void validate(const Section &contact, const std::vector<Part<dim>> &parts);

    /** Null where no contact asks for it. */
    static std::unique_ptr<NodalYieldStress> create(const Contacts &contacts);

    /** Finds it at the nodes of contacts that ask for it, and tells them; as large as numbers are
     * where no material flows. Collective. */
    void update(const Model<dim> &model, const Contacts &contacts);

  private:
    /** Sums strain, number and temperature of the points of a part at nodes. Collective. */
    void sum_points(const Model<dim> &model, unsigned int part);

    NodalVector sums; ///< plastic strain, number, temperature that points keep
    std::vector<double> yield_stress, n_points; ///< of owned nodes
  };
} // namespace tombolo
