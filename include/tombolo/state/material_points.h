// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/state/field.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The state at the material points of one part on this rank: integration points of its cells or
   * its particles. Structure of arrays: component c of field f of point i is
   * component(f, c)[i]. Arrays are padded to whole Lanes with harmless values (the padding holds
   * volume 0 and volume ratio 1).
   */
  class MaterialPoints
  {
  public:
    /** Fields every part has, in this order; then the internal variables of the material. */
    enum StandardField : unsigned int
    {
      stress,       ///< Cauchy stress, 6: xx, yy, zz, yz, xz, xy [M/(L T^2)]
      volume,       ///< current volume that the point integrates [L^3]
      volume_ratio, ///< J = current over initial volume; density = initial density / J
      n_standard_fields
    };

    /** @p internal_variables of the material follow the standard fields; points and padding have
     * their initial values. */
    void reinit(unsigned int n_points, const std::vector<FieldDescription> &internal_variables);

    unsigned int size() const
    {
      return n_points;
    }

    unsigned int padded_size() const
    {
      return static_cast<unsigned int>(n_padded);
    }

    const std::vector<FieldDescription> &fields() const
    {
      return descriptions;
    }

    /** The number of the field of this name; fields().size() if there is none. */
    unsigned int find_field(const std::string &name) const;

    double *component(const unsigned int field, const unsigned int component)
    {
      return data.data() + (first_component[field] + component) * n_padded;
    }
    const double *component(const unsigned int field, const unsigned int component) const
    {
      return data.data() + (first_component[field] + component) * n_padded;
    }

    /** Makes the present state the committed one; what follows is a trial. Takes the memory of a
     * second state until the trial ends; without a trial there is none. */
    void begin_trial()
    {
      committed = data;
    }

    /** Makes the present state the committed one of begin_trial() again, for another evaluation. */
    void restart_trial();

    /** Ends the trial with the present state as the committed one. */
    void commit_trial()
    {
      committed.resize(0);
    }

  private:
    unsigned int n_points = 0;
    std::size_t n_padded = 0;
    std::vector<FieldDescription> descriptions;
    std::vector<std::size_t> first_component;
    dealii::AlignedVector<double> data;
    dealii::AlignedVector<double> committed; ///< empty: no trial
  };
} // namespace tombolo
