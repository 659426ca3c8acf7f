// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/surfaces/rigid_motion.h>

namespace tombolo
{
  /** A rigid surface that moves as a whole by a RigidMotion: what tools of any shape share. */
  template <int dim>
  class RigidTool : public ContactSurface<dim>
  {
  public:
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, const double from,
                                  const double to) const override
    {
      return rigid_motion.motion(point, from, to);
    }

    dealii::Tensor<1, dim> reference_point(const double time) const override
    {
      return rigid_motion.origin(time);
    }

    RigidTranslation<dim> &translation() override
    {
      return rigid_motion.translation();
    }

  protected:
    RigidMotion<dim> rigid_motion;
  };
} // namespace tombolo
