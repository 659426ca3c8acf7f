// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>

namespace tombolo
{
  /** How pictures are written, and which fields they have only because they are asked for: entries
   * `Format`, `Precision` and `Further fields`. */
  struct PictureFields
  {
    bool xdmf = false; ///< in one file for all ranks and times of a kind
    bool double_precision = false;
    bool logarithmic_strain = false;
    bool principal_stresses = false;
    bool internal_fields = false; ///< FieldDescription::is_internal

    PictureFields() = default;

    /** Throws InputError for a field that cannot be asked for. */
    explicit PictureFields(const Entries &e);
  };
} // namespace tombolo
