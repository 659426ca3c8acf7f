// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Watches the strain of elastic parts whose stress follows the rate of deformation
   * (StrainMeasure::rate). Such a stress is the derivative of no energy: at a large strain the
   * balance of energy is off by a like share, with any step. Says so once, before the run where
   * prescribed displacements tell the strain.
   */
  template <int dim>
  class ElasticStrain : public Process<dim>
  {
  public:
    /** A part and the change of its section that gives its stress an energy. */
    struct WatchedPart
    {
      unsigned int part; ///< in the model
      std::string cure;  ///< entry and value
      bool is_told = false;
    };

    /** @p foreseen: the largest strain that prescribed displacements tell. */
    ElasticStrain(std::vector<WatchedPart> parts, double foreseen);

    std::vector<std::string> warnings(const Model<dim> &model, const Clock &clock,
                                      typename Process<dim>::Occasion occasion) override;

  private:
    /** What to say where the balance of energy stops a run: of the part with the largest strain, or
     * nothing where all are small. Collective. */
    std::vector<std::string> advice(const Model<dim> &model) const;

    std::vector<WatchedPart> parts;
    double foreseen;
  };
} // namespace tombolo
