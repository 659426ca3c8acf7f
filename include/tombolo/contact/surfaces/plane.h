// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

namespace tombolo
{
  /** A rigid plane (a line in two dimensions), at rest or moved by a RigidTranslation. */
  template <int dim>
  class Plane : public ContactSurface<dim>
  {
  public:
    /** Throws InputError for a normal of no length. */
    explicit Plane(const Entries &e);

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       double time, std::vector<double> &gap) const override;
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point, double time) const override;
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, double from,
                                  double to) const override;
    dealii::Tensor<1, dim> reference_point(double time) const override;
    FacetList<dim> picture(double time, const dealii::Tensor<1, dim> &low,
                           const dealii::Tensor<1, dim> &high) const override;
    RigidTranslation<dim> &translation() override;

  private:
    dealii::Tensor<1, dim> point;
    dealii::Tensor<1, dim> unit_normal;
    RigidTranslation<dim> rigid_translation;
  };
} // namespace tombolo
