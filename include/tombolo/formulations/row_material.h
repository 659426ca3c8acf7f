// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/strain_measure.h>
#include <tombolo/state/material_points.h>

#include <vector>

namespace tombolo
{
  /** The material of the points whose stiffness is asked for. */
  struct RowMaterial
  {
    const Material *material;
    StrainMeasure measure;
    const PlasticHeating *plastic_heating;
    MaterialPoints *points;
    std::vector<double *> variables; ///< first address of each component of the material's own
    /** Whether points of a cell share their dilatation and volumes follow from their places; else
     * the volume of a point is that of the reference times its volume ratio. */
    bool shares_volume;
  };
} // namespace tombolo
