// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/moment.h>

namespace tombolo
{
  /**
   * A history of balances that know until when their impulses go, `time_of_impulse`: mean force and
   * mean moment since the row before, impulse since the start.
   */
  template <int dim, typename Balance>
  class ImpulseHistory : public BalanceHistory<dim, Balance>
  {
  public:
    ImpulseHistory(const Entries &e, const std::string &file_name,
                   const typename BalanceHistory<dim, Balance>::Summary &summary)
        : BalanceHistory<dim, Balance>(e, file_name, {"times of row", &Balance::time_of_impulse},
                                       summary)
    {}

  protected:
    void begin(const OutputView<dim> &view) override
    {
      BalanceHistory<dim, Balance>::begin(view);
      if (!this->table.is_continued())
        for (Balance &balance : this->last)
          balance.time_of_impulse = view.time;
    }

    void add_balance(const OutputView<dim> & /*view*/, std::size_t /*k*/, const Balance &now,
                     const Balance &before) override
    {
      const double elapsed = now.time_of_impulse - before.time_of_impulse;
      this->add_mean(now.name + " mean force", "M L/T^2", now.impulse, before.impulse, elapsed);
      this->add_mean(now.name + " mean moment", "M L^2/T^2", now.angular_impulse,
                     before.angular_impulse, elapsed, true);
      this->add_vector(now.name + " impulse", "M L/T", now.impulse);
    }
  };

  /**
   * What holds, drives and loads the bodies: `conditions.csv`, with the mean force and the mean
   * moment on the bodies since the row before, the impulse and the work since the start of each
   * mechanical condition; of those that prescribe motion also the mean displacement of their nodes.
   * Those come first, then loads, each in the order of `Conditions`. Moments are about the entry
   * `Moments about`. Impulses are those until t_{n-1/2}, as the momenta of `statistics.csv`. Part
   * of every scene that has mechanical conditions.
   */
  template <int dim>
  class ConditionHistory : public ImpulseHistory<dim, ConditionBalance>
  {
  public:
    explicit ConditionHistory(const Entries &e)
        : ImpulseHistory<dim, ConditionBalance>(e, "conditions.csv",
                                                {"conditions", {&ConditionBalance::work}})
    {
      const std::vector<double> point =
          e.numbers("Moments about", dim == 2 ? "0, 0" : "0, 0, 0", dim, "L",
                    "The point that moments in conditions.csv are about; it does not move.");
      std::copy(point.begin(), point.end(), reference_point.begin_raw());
    }

  private:
    std::vector<ConditionBalance> balances(const OutputView<dim> &view) const override
    {
      std::vector<ConditionBalance> result;
      for (const auto &of_kind : view.condition_balances)
      {
        const std::vector<ConditionBalance> balances = of_kind();
        result.insert(result.end(), balances.begin(), balances.end());
      }
      double from_point[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
        from_point[d] = -reference_point[d];
      for (ConditionBalance &balance : result)
        add_moment(from_point, balance.impulse.data(), balance.angular_impulse);
      return result;
    }

    void add_balance(const OutputView<dim> &view, const std::size_t k, const ConditionBalance &now,
                     const ConditionBalance &before) override
    {
      ImpulseHistory<dim, ConditionBalance>::add_balance(view, k, now, before);
      this->table.add(now.name + " work", "M L^2/T^2", now.work);
      if (now.prescribes_motion)
        this->add_vector(now.name + " mean displacement", "L", now.displacement);
    }

    void add_to_summary(std::size_t /*k*/, const ConditionBalance &at_output, Json &entry) override
    {
      entry["work"] = at_output.work;
    }

    dealii::Tensor<1, dim> reference_point; ///< of moments [L]
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, ConditionHistory, "condition history",
      "Forces, moments, impulses and works of mechanical conditions, displacements of those that "
      "prescribe motion (conditions.csv); in every scene that has such.")

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
        : ImpulseHistory<dim, SectionBalance>(e, "sections.csv", {"sections", {}})
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
