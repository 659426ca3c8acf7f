// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/specimen_shape.h>

namespace tombolo
{
  TOMBOLO_REGISTER(Output<3>, SpecimenShape, "specimen shape",
                   "Length, foot diameter and bulge of a specimen after impact (specimen.csv).")
} // namespace tombolo
