// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/state/node_partition.h>

#include <bitset>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tombolo
{
  struct FragmentOfParticle
  {
    /** The smallest identifier of the particles in the fragment or in its images. */
    std::uint64_t label = 0;
    /** Bit c stands for the image of this particle in the mirrors whose bits c has, bit 0 for the
     * particle itself: whether a chain of bonds connects it to the particle of the label. */
    std::uint64_t copies = 0;

    /** How many of the images the fragment of the particle is one with, itself among them. */
    unsigned int n_copies() const
    {
      return static_cast<unsigned int>(std::bitset<64>(copies).count());
    }

    /** Whether the image of @p other in @p mirrors (0: itself) is of the same fragment. */
    bool has(const FragmentOfParticle &other, const unsigned int mirrors) const
    {
      if (label != other.label)
        return false;
      unsigned int own = 0;
      while (((copies >> own) & 1u) == 0)
        ++own;
      return ((other.copies >> (own ^ mirrors)) & 1u) != 0;
    }
  };

  /**
   * Finds the bodies that the particles of one part make: two are of one fragment where a chain of
   * bonds connects them, each bond in the row of either end; debris without bonds is a fragment of
   * its own. Row i of @p shape is the particle with the identifier ids[i], on @p partition. @p
   * images are those of the body: a fragment that bonds or nodes connect to its image is one with
   * it. The same whatever the number of ranks. Collective.
   */
  std::vector<FragmentOfParticle> find_fragments(const Stencils &shape,
                                                 const std::vector<std::uint64_t> &ids,
                                                 const NodePartition &partition,
                                                 const Images &images = *Images::none());

  /** How many fragments have their label from a particle of this rank, one of @p ids. */
  unsigned long n_labels_here(const std::vector<FragmentOfParticle> &fragments,
                              const std::vector<std::uint64_t> &ids);

  /** The mirrors of an image, as bits. */
  unsigned int mirrors_of(const Images::Map &reflection, const Images &images);

  // What ranks exchange about the fragment of a particle: four numbers at its node.
  enum FragmentTag : unsigned int
  {
    upper_label,
    lower_label,
    has_elements, ///< and twice the upper half of the copies
    lower_copies, ///< with planes of symmetry alone
  };
  constexpr double is_unknown = -1.; // no half of a label

  inline void set_tags(const FragmentOfParticle &fragment, const bool at_elements,
                       double *const tag)
  {
    tag[upper_label] = upper_half(fragment.label);
    tag[lower_label] = lower_half(fragment.label);
    tag[has_elements] = (at_elements ? 1. : 0.) + 2. * upper_half(fragment.copies);
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
  inline bool is_pair(const double *const own_tag, const double *const other_tag,
                      const unsigned int mirrors)
  {
    // Most are of one fragment.
    const bool can_be_one = own_tag[upper_label] == other_tag[upper_label] &&
                            own_tag[lower_label] == other_tag[lower_label];
    return !(can_be_one && fragment_of(own_tag).has(fragment_of(other_tag), mirrors)) &&
           !(is_of_elements(own_tag) && is_of_elements(other_tag));
  }
} // namespace tombolo
