// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/plastic_heating.h>

namespace tombolo
{
  namespace
  {
    /** Volumes follow from masses. What viscosity has dissipated is not of the material, and heat
     * that nodes have not got goes by itself. */
    bool carries_over(const std::string &field)
    {
      return field != "volume" && field != BulkViscosity::dissipation_name &&
             field != PlasticHeating::given_name;
    }
  } // namespace

  StateTransfer::StateTransfer(const std::shared_ptr<const NodePartition> &partition,
                               const MaterialPoints &source, const MaterialPoints &target)
  {
    volume.reinit(partition, Quantity::scalar);
    pending_heat.reinit(partition, Quantity::scalar);
    for (unsigned int f = 0; f < target.fields().size(); ++f)
    {
      const FieldDescription &field = target.fields()[f];
      const unsigned int in_source = source.find_field(field.name);
      if (in_source == source.fields().size() || !carries_over(field.name))
        continue;
      for (unsigned int c = 0; c < field.n_components; ++c)
      {
        components.push_back({in_source, f, c, {}});
        components.back().sum.reinit(partition, Quantity::scalar);
      }
    }
  }

  std::vector<NodalVector *> StateTransfer::sums()
  {
    std::vector<NodalVector *> result{&volume, &pending_heat};
    for (Component &component : components)
      result.push_back(&component.sum);
    return result;
  }
} // namespace tombolo
