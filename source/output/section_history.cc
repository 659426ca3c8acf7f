// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

namespace tombolo
{
  /**
   * What passes through sections of the bodies: `sections.csv`, with the mean force and the mean
   * moment since the row before and the impulse since the start of each section, in the order of
   * `Sections`. Impulses are those until t_{n-1/2}, as the momenta of `statistics.csv`. Part of
   * every scene that has sections.
   */
  template <int dim>
  class SectionHistory : public ImpulseHistory<dim, SectionBalance>
  {
  public:
    explicit SectionHistory(const Entries &e)
        : ImpulseHistory<dim, SectionBalance>(
              "sections.csv", History<dim>::interval(e, "sections.csv"), {"sections", {}})
    {}

  private:
    std::vector<SectionBalance> balances(const OutputView<dim> &view) const override
    {
      return view.section_balances();
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, SectionHistory, "section history",
      "Forces, moments and impulses through sections and interfaces of parts (sections.csv); in "
      "every scene that has `Sections`.")
} // namespace tombolo
