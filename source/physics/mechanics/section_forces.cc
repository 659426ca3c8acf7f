// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/section_forces.h>

#include <tombolo/base/input/section_names.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/output/output.h>

#include <algorithm>
#include <ostream>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  SectionForces<dim>::SectionForces(std::vector<BodySection<dim>> sections, const Model<dim> &model)
      : model(model), members(std::move(sections)), impulses(members.size())
  {
    Records &all = this->records.group("sections");
    for (std::size_t k = 0; k < members.size(); ++k)
      impulses[k].list(all.group(std::to_string(k)));
    all.value("time of impulse", time_of_impulse);
  }

  template <int dim>
  const std::vector<BodySection<dim>> &SectionForces<dim>::sections() const
  {
    return members;
  }

  template <int dim>
  void SectionForces<dim>::model_changed(Model<dim> &changed)
  {
    for (BodySection<dim> &member : members)
      member.model_changed(changed);
  }

  template <int dim>
  void SectionForces<dim>::part_force(const std::size_t part, const NodalVector &force,
                                      const bool is_added)
  {
    for (BodySection<dim> &member : members)
      if (is_added)
        member.after_part_force(part, force, model.state.position);
      else
        member.before_part_force(part, force);
  }

  template <int dim>
  void SectionForces<dim>::add_forces(Model<dim> &, const Clock &, const NodalVector &force)
  {
    for (BodySection<dim> &member : members)
      member.take_internal_force(force, model.state.position);
  }

  template <int dim>
  void SectionForces<dim>::after_acceleration(Model<dim> &, const Clock &clock)
  {
    time_of_impulse = clock.time - 0.5 * clock.previous_step;
    for (std::size_t k = 0; k < members.size(); ++k)
    {
      LoadSum impulse = members[k].sum();
      for (unsigned int d = 0; d < 3; ++d)
      {
        impulse.force[d] *= clock.velocity_step();
        impulse.moment[d] *= clock.velocity_step();
      }
      impulses[k].begin_step();
      impulses[k].add(impulse.force, impulse.moment);
    }
  }

  template <int dim>
  std::vector<SectionBalance> SectionForces<dim>::balances() const
  {
    std::vector<double> sums;
    for (const ImpulseAccount &account : impulses)
    {
      EnergyAccounts shares;
      account.account(shares);
      sums.insert(sums.end(), shares.impulse.begin(), shares.impulse.end());
      sums.insert(sums.end(), shares.angular_impulse.begin(), shares.angular_impulse.end());
    }
    sums = ordered_sum(sums, model.communicator);
    std::vector<SectionBalance> result(members.size());
    for (std::size_t k = 0; k < members.size(); ++k)
    {
      result[k].name = members[k].name();
      result[k].time_of_impulse = time_of_impulse;
      std::copy_n(sums.data() + 6 * k, 3, result[k].impulse.begin());
      std::copy_n(sums.data() + 6 * k + 3, 3, result[k].angular_impulse.begin());
    }
    return result;
  }

  template <int dim>
  void SectionForces<dim>::describe(const Model<dim> &, std::ostream &text) const
  {
    for (const BodySection<dim> &member : members)
      text << "  section \"" << member.name() << "\": " << member.description() << "\n";
  }

  template <int dim>
  std::vector<std::string>
  SectionForces<dim>::warnings(const Model<dim> &, const Clock &,
                               const typename Process<dim>::Occasion occasion)
  {
    std::vector<std::string> result;
    if (occasion != Process<dim>::Occasion::audit)
      return result;
    for (const BodySection<dim> &member : members)
      if (const std::string remark = member.remark(); !remark.empty())
        result.push_back(remark);
    return result;
  }

  template <int dim>
  void SectionForces<dim>::show(OutputView<dim> &view) const
  {
    view.section_balances = [this]() { return balances(); };
  }

  namespace
  {
    constexpr const char *list_of_sections = "Sections";

    template <int dim>
    class SectionForcesKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        parameters.handler().declare_entry(
            list_of_sections, "", Patterns::Anything(),
            "Names of sections of the bodies, each with a section `Section: NAME`: forces and "
            "moments through them are in sections.csv.");
        for (const std::string &name : section_names(parameters, list_of_sections))
          declare_section<BodySection<dim>>(parameters, "Section: " + name,
                                            std::vector<Part<dim>>());
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        for (const Section &section : named_sections(parameters, list_of_sections, "Section"))
        {
          BodySection<dim>(section, parts);
          if (std::none_of(parts.begin(), parts.end(),
                           [](const Part<dim> &part) { return part.material->has_mechanics(); }))
            section.fail("", "the scene has no mechanics, since its materials have no stresses; "
                             "no force passes through a section.");
        }
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        std::vector<BodySection<dim>> sections;
        for (const Section &section : named_sections(parameters, list_of_sections, "Section"))
        {
          sections.emplace_back(section, model.parts);
          sections.back().find_side(section, model);
        }
        if (sections.empty())
          return nullptr;
        return std::make_unique<SectionForces<dim>>(std::move(sections), model);
      }
    };
  } // namespace

  template class SectionForces<2>;
  template class SectionForces<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(SectionForcesKind, process_order::sections)
} // namespace tombolo
