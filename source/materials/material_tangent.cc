// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/material_tangent.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    /** The state of a batch before its update. */
    class KeptBatch
    {
    public:
      explicit KeptBatch(const MaterialBatch &batch)
          : n(batch.n), values((12 + batch.internal_variables.size()) * batch.n)
      {
        for (unsigned int c = 0; c < 6; ++c)
        {
          std::copy_n(batch.stress[c], n, place(c));
          std::copy_n(batch.strain_increment[c], n, place(6 + c));
        }
        for (std::size_t v = 0; v < batch.internal_variables.size(); ++v)
          std::copy_n(batch.internal_variables[v], n, place(12 + v));
      }

      double *strain(const unsigned int component)
      {
        return place(6 + component);
      }

      void restore(MaterialBatch &batch)
      {
        for (unsigned int c = 0; c < 6; ++c)
          std::copy_n(place(c), n, batch.stress[c]);
        for (std::size_t v = 0; v < batch.internal_variables.size(); ++v)
          std::copy_n(place(12 + v), n, batch.internal_variables[v]);
      }

    private:
      double *place(const std::size_t row)
      {
        return values.data() + row * n;
      }

      unsigned int n;
      dealii::AlignedVector<double> values;
    };
  } // namespace

  void Material::update_stress_and_tangent(MaterialBatch &batch,
                                           const MaterialTangent &tangent) const
  {
    constexpr double change = 1e-7;
    KeptBatch kept(batch);
    MaterialBatch changed = batch;
    for (unsigned int c = 0; c < 6; ++c)
      changed.strain_increment[c] = kept.strain(c);
    for (unsigned int column = 0; column < 6; ++column)
    {
      for (unsigned int i = 0; i < batch.n; ++i)
        kept.strain(column)[i] += change;
      update_stress(changed);
      for (unsigned int row = 0; row < 6; ++row)
        std::copy_n(batch.stress[row], batch.n, tangent[6 * row + column]);
      std::copy_n(batch.strain_increment[column], batch.n, kept.strain(column));
      kept.restore(batch);
    }
    update_stress(batch);
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        for (unsigned int i = 0; i < batch.n; ++i)
        {
          double &entry = tangent[6 * row + column][i];
          entry = (entry - batch.stress[row][i]) / change;
        }
  }
} // namespace tombolo
