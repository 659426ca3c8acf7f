// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/place_function.h>

#include <tombolo/base/input/expression_tokens.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/base/input/table_function.h>

#include <deal.II/base/function_parser.h>
#include <deal.II/base/numbers.h>

#include <stdexcept>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** FunctionParser with the time as an argument instead of a state, so that several threads
     * may evaluate at different times. */
    template <int n>
    class Parser : public FunctionParser<n>
    {
    public:
      Parser(const std::string &text, const std::vector<std::string> &names)
      {
        FunctionParser<n>::initialize(joined(names, ","), std::vector<std::string>{text},
                                      {{"pi", numbers::PI}}, true);
      }

      double evaluate(const Point<n> &point, const double time) const
      {
        return this->do_value(point, time, 0);
      }
    };

    template <int dim>
    class WithoutTables : public PlaceFunction<dim>
    {
    public:
      explicit WithoutTables(const std::string &text) : parser(text, variables_of_expressions(dim))
      {}

      double evaluate(const Point<dim> &point, const double time) const override
      {
        return parser.evaluate(point, time);
      }

    private:
      Parser<dim> parser;
    };

    /** Values of tables are further variables, in the places of variables that are not used: the
     * parser has four. */
    template <int dim>
    class WithTables : public PlaceFunction<dim>
    {
    public:
      WithTables(const TableCalls &calls, const Section &section, const std::string &entry)
      {
        const std::vector<std::string> variables = variables_of_expressions(dim);
        const std::vector<ExpressionToken> tokens = split_into_tokens(calls.text);
        std::vector<std::string> names;
        for (unsigned int v = 0; v < variables.size(); ++v)
          if (has_name(tokens, variables[v]))
          {
            names.push_back(variables[v]);
            slots.push_back({v, nullptr, nullptr});
          }
        for (const TableCalls::Call &call : calls.calls)
        {
          names.push_back(call.name);
          slots.push_back({dim + 1,
                           PlaceFunction<dim>::create(TableCalls(call.argument), section, entry),
                           read_table(call.file, section, entry)});
        }
        if (names.size() > n_slots)
          section.fail(entry, "an expression can have four tables and variables in all, not "
                              "counting those in the arguments of tables; found " +
                                  std::to_string(names.size()) + ".");
        while (names.size() < n_slots)
          names.push_back("unused_" + std::to_string(names.size()));
        parser = std::make_unique<Parser<n_slots - 1>>(calls.text, names);
      }

      double evaluate(const Point<dim> &point, const double time) const override
      {
        double values[n_slots] = {0, 0, 0, 0};
        for (std::size_t i = 0; i < slots.size(); ++i)
          values[i] = slots[i].variable < dim ? point[slots[i].variable]
                      : slots[i].table == nullptr
                          ? time
                          : slots[i].table->value(slots[i].argument->evaluate(point, time));
        return parser->evaluate(Point<3>(values[0], values[1], values[2]), values[3]);
      }

    private:
      static constexpr int n_slots = 4;

      struct Slot
      {
        unsigned int variable; ///< a coordinate, dim the time, dim + 1 a table
        std::unique_ptr<const PlaceFunction<dim>> argument;
        std::shared_ptr<const TableFunction> table;
      };

      static std::shared_ptr<const TableFunction>
      read_table(const std::string &file, const Section &section, const std::string &entry)
      {
        const std::string text =
            read_input_file(section, entry, file, section.all().communicator());
        try
        {
          return std::make_shared<const TableFunction>(text);
        }
        catch (const std::invalid_argument &error)
        {
          section.fail(entry, "in the table \"" + file + "\", " + error.what());
        }
      }

      std::vector<Slot> slots;
      std::unique_ptr<Parser<n_slots - 1>> parser;
    };
  } // namespace

  std::vector<std::string> variables_of_expressions(const unsigned int dim)
  {
    if (dim == 2)
      return {"x", "y", "t"};
    return {"x", "y", "z", "t"};
  }

  template <int dim>
  std::unique_ptr<PlaceFunction<dim>> PlaceFunction<dim>::create(const TableCalls &calls,
                                                                 const Section &section,
                                                                 const std::string &entry)
  {
    if (!calls.problem.empty())
      section.fail(entry, calls.problem);
    if (calls.calls.empty())
      return std::make_unique<WithoutTables<dim>>(calls.text);
    return std::make_unique<WithTables<dim>>(calls, section, entry);
  }

  template class PlaceFunction<2>;
  template class PlaceFunction<3>;
} // namespace tombolo
