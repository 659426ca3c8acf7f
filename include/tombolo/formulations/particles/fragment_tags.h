// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/formulations/particles/fragments.h>

#include <cmath>

namespace tombolo
{
  // What ranks tell each other of the fragment of a particle: four numbers at its node.
  enum FragmentTag : unsigned int
  {
    upper_label,
    lower_label,
    has_elements, ///< and twice the upper half of the copies
    lower_copies, ///< with planes of symmetry alone
  };
  constexpr double is_unknown = -1.; // no half of a label

  inline void set_tags(const FragmentOfParticle &fragment, const bool of_elements,
                       double *const tag)
  {
    tag[upper_label] = upper_half(fragment.label);
    tag[lower_label] = lower_half(fragment.label);
    tag[has_elements] = (of_elements ? 1. : 0.) + 2. * upper_half(fragment.copies);
    tag[lower_copies] = lower_half(fragment.copies);
  }

  inline FragmentOfParticle fragment_of(const double *const tag)
  {
    return {joined(tag[upper_label], tag[lower_label]),
            joined(std::floor(0.5 * tag[has_elements]), tag[lower_copies])};
  }

  inline bool is_of_elements(const double *const tag)
  {
    return std::fmod(tag[has_elements], 2.) != 0.;
  }

  /** Whether a node with the first tags and the image of one with the others in @p mirrors (0: that
   * node itself) are of different fragments, without elements between them. */
  inline bool is_pair(const double *const of_one, const double *const of_other,
                      const unsigned int mirrors)
  {
    // Most are of one fragment.
    const bool can_be_one = of_one[upper_label] == of_other[upper_label] &&
                            of_one[lower_label] == of_other[lower_label];
    return !(can_be_one && fragment_of(of_one).has(fragment_of(of_other), mirrors)) &&
           !(is_of_elements(of_one) && is_of_elements(of_other));
  }
} // namespace tombolo
