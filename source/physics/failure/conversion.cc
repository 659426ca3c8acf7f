// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/conversion.h>

#include <tombolo/base/input/name_hints.h>
#include <tombolo/model/model_input.h>

#include <optional>
#include <string>

namespace tombolo
{
  namespace
  {
    const std::string cells_entry = "Cells";

    /** The formulation, if its cells are to become particles. */
    template <int dim>
    const ConvertingCells<dim> *converting_cells_of(const Part<dim> &part)
    {
      const auto *const cells = part.template as<ConvertingCells>();
      return cells != nullptr && cells->conversion().is_on() ? cells : nullptr;
    }

    /** Refuses a name that is no contact. */
    void check_contact(const Parameters &parameters, const ConversionCriterion &criterion)
    {
      const std::vector<std::string> names = parameters.raw_list("Contacts");
      if (std::find(names.begin(), names.end(), criterion.contact) != names.end())
        return;
      criterion.refuse(names.empty()
                           ? "nearness is that to the surface of a contact, and the scene has no "
                             "`Contacts`."
                           : "allowed is one of `Contacts`: " + in_quotes(names) + "." +
                                 did_you_mean(criterion.contact, names));
    }

    template <int dim>
    class ConversionKind : public ProcessKind<dim>
    {
    public:
      /** Finds the parts whose particles are converted cells of others. */
      void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
      {
        const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
        Receivers receiver(parts.size(), nullptr);
        for (unsigned int p = 0; p < parts.size(); ++p)
          if (const std::optional<std::string> name = source_of_cells(sections[p].get(cells_entry)))
            link(sections[p], *name, p, parts, receiver);
        for (unsigned int p = 0; p < parts.size(); ++p)
        {
          const ConvertingCells<dim> *const cells = converting_cells_of(parts[p]);
          if (cells == nullptr)
            continue;
          if (receiver[p] == nullptr)
            cells->conversion().refuse("no part takes the cells of part \"" + parts[p].name +
                                       "\": add one of particles with `Cells = from " +
                                       parts[p].name + "`.");
          if (cells->conversion().smallest_gap)
            check_contact(parameters, cells->conversion());
        }
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (std::none_of(model.parts.begin(), model.parts.end(),
                         [](const Part<dim> &part) { return part.source.has_value(); }))
          return nullptr;
        return std::make_unique<Conversion<dim>>(model);
      }

    private:
      using Receivers = std::vector<const Section *>;

      static void link(const Section &section, const std::string &name, const unsigned int target,
                       std::vector<Part<dim>> &parts, Receivers &receiver)
      {
        if (name.empty())
          section.fail(cells_entry, "the name of the part is missing whose cells become particles: "
                                    "allowed is `from NAME`.");
        std::vector<std::string> names;
        for (const Part<dim> &part : parts)
          names.push_back(part.name);
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
          section.fail(cells_entry, "there is no part of this name." + did_you_mean(name, names));
        const auto source = static_cast<unsigned int>(found - names.begin());
        if (parts[target].particles == nullptr || !parts[target].particles->can_add_particles())
          section.fail("Formulation",
                       "cells of another part become particles only, of a method that can take "
                       "them; allowed "
                       "with `Cells = from " +
                           name +
                           "` are \"momentum consistent particle\" and \"smoothed particle\".");
        if (converting_cells_of(parts[source]) == nullptr)
          section.fail(cells_entry,
                       "no cell of part \"" + name +
                           "\" would ever become particles: it needs an element type, or "
                           "smoothed cells, and one of the entries \"Conversion strain\", "
                           "\"Conversion damage\", "
                           "\"Conversion scaled Jacobian\", \"Conversion time step\" and "
                           "\"Conversion gap\" in its section.");
        if (receiver[source] != nullptr)
          section.fail(cells_entry, "part \"" + receiver[source]->name() +
                                        "\" takes the cells of \"" + name +
                                        "\" already; only one part can.");
        if (parts[source].material != parts[target].material)
          section.fail("Material", "the part takes over the state of part \"" + name +
                                       "\" and has to have its material.");
        receiver[source] = &section;
        parts[target].source = source;
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(ConversionKind, process_order::conversion)
} // namespace tombolo
