// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/expression.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/expression_tokens.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/input/table_function.h>

#include <deal.II/base/function_parser.h>
#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/io/ios_state.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace tombolo
{
  namespace
  {
    std::vector<std::string> variables_of_expressions(const unsigned int dim)
    {
      if (dim == 2)
        return {"x", "y", "t"};
      return {"x", "y", "z", "t"};
    }

    /** FunctionParser with the time as an argument instead of a state, so that several threads
     * may evaluate at different times. */
    class Parser : public FunctionParser<3>
    {
    public:
      Parser(const std::string &text, const std::vector<std::string> &names)
      {
        initialize(joined(names, ","), std::vector<std::string>{text}, {{"pi", numbers::PI}}, true);
      }

      double evaluate(const std::array<double, 4> &values) const
      {
        return do_value(Point<3>(values[0], values[1], values[2]), values[3], 0);
      }
    };

    /** The function of position and time that a text means, as muParser reads it. Values of tables
     * from files are further variables, in the slots of variables that are not used: the parser
     * has four. Several threads may evaluate it at the same time. */
    template <int dim>
    class SpaceTimeFunction
    {
    public:
      /** @p entry of @p section has the text, and its files are searched as read_input_file()
       * does. Throws InputError for a table that cannot be read, and what muParser throws for a
       * text that it cannot read. Collective where there are tables. */
      SpaceTimeFunction(const TableCalls &calls, const Section &section, const std::string &entry)
      {
        if (!calls.problem.empty())
          section.fail(entry, calls.problem);
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
          slots.push_back(
              {dim + 1,
               std::make_unique<const SpaceTimeFunction>(TableCalls(call.argument), section, entry),
               read_table(call.file, section, entry)});
        }
        if (names.size() > n_slots)
          section.fail(entry, "an expression can have four tables and variables in all, not "
                              "counting those in the arguments of tables; found " +
                                  std::to_string(names.size()) + ".");
        while (names.size() < n_slots)
          names.push_back("unused_" + std::to_string(names.size()));
        parser = std::make_unique<Parser>(calls.text, names);
      }

      double evaluate(const Point<dim> &point, const double time) const
      {
        std::array<double, n_slots> values{};
        for (std::size_t i = 0; i < slots.size(); ++i)
          values[i] = slots[i].variable < dim ? point[slots[i].variable]
                      : slots[i].table == nullptr
                          ? time
                          : slots[i].table->value(slots[i].argument->evaluate(point, time));
        return parser->evaluate(values);
      }

    private:
      static constexpr unsigned int n_slots = 4;

      struct Slot
      {
        unsigned int variable; ///< a coordinate, dim the time, dim + 1 a table
        std::unique_ptr<const SpaceTimeFunction> argument;
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
      std::unique_ptr<Parser> parser;
    };

    bool is_one_of(const std::string &text, const std::vector<std::string> &list)
    {
      return std::find(list.begin(), list.end(), text) != list.end();
    }

    bool is_comparison(const ExpressionToken &token)
    {
      static const std::vector<std::string> comparisons = {"<", ">", "<=", ">=", "==", "!="};
      return token.kind == ExpressionToken::sign && is_one_of(token.text, comparisons);
    }

    /** What the parser accepts in another sense than the user's; empty if there is nothing. */
    std::string misunderstanding(const std::vector<ExpressionToken> &tokens)
    {
      std::vector<bool> has_comparison(1, false); // by depth of parentheses
      for (const auto &token : tokens)
        if (token.kind == ExpressionToken::name)
        {
          if (token.text == "rand" || token.text == "rand_seed")
            return "random numbers differ from run to run and from rank to rank.";
        }
        else if (token.text == "=")
          return "\"=\" compares nothing. Write \"==\" to ask whether two values are equal.";
        else if (token.text == "&" || token.text == "|")
          // Known to FunctionParser, but '|' before '&', and with rounded operands.
          return "write " + in_quotes(token.text + token.text) + " instead of " +
                 in_quotes(token.text) + ".";
        else if (token.text == "(")
          has_comparison.push_back(false);
        else if (token.text == ")")
        {
          if (has_comparison.size() > 1)
            has_comparison.pop_back();
        }
        else if (token.text == "," && has_comparison.size() == 1)
          return "components are separated by \";\", found \",\".";
        else if (is_one_of(token.text, {"&&", "||", "?", ":", ","}))
          has_comparison.back() = false;
        else if (is_comparison(token))
        {
          if (has_comparison.back())
            return "two comparisons in a row. Write \"0 < x && x < 1\" instead of \"0 < x < 1\".";
          has_comparison.back() = true;
        }
      return "";
    }

    /** Those of the text and of the arguments of tables. */
    std::vector<ExpressionToken> tokens_of(const TableCalls &calls)
    {
      std::vector<ExpressionToken> tokens = split_into_tokens(calls.text);
      for (const TableCalls::Call &call : calls.calls)
      {
        // Not one expression with what is before it.
        tokens.push_back({ExpressionToken::sign, "&&"});
        const std::vector<ExpressionToken> argument_tokens = tokens_of(TableCalls(call.argument));
        tokens.insert(tokens.end(), argument_tokens.begin(), argument_tokens.end());
      }
      return tokens;
    }

    /** Why the parser may have refused an expression; begins with a blank, or is empty. */
    std::string hint_about(const std::vector<ExpressionToken> &tokens, const unsigned int dim)
    {
      static const std::vector<std::string> functions = []
      {
        std::vector<std::string> names = {
            "sin",   "cos",   "tan",   "asin", "acos",  "atan", "atan2", "sinh", "cosh", "tanh",
            "asinh", "acosh", "atanh", "log2", "log10", "log",  "ln",    "exp",  "sqrt", "sign",
            "rint",  "abs",   "min",   "max",  "sum",   "avg",  "_e",    "_pi",  "pi",   "table"};
        for (const auto &name : dealii::internal::FunctionParser::get_function_names())
          names.push_back(name);
        return names;
      }();
      for (const auto &token : tokens)
        if (token.kind == ExpressionToken::name)
        {
          const auto &name = token.text;
          const std::string lower = boost::to_lower_copy(name);
          if (lower == "and" || lower == "or")
            return " Write " + in_quotes(lower == "and" ? "&&" : "||") + " instead of " +
                   in_quotes(name) + ".";
          if (lower == "not")
            return " Write \"(...) == 0\" instead of \"not\".";
          if (name == "z" && dim == 2)
            return " There is no z in two dimensions: the variables are x, y and t.";
          if (name.rfind("table_", 0) == 0 || is_one_of(name, functions) ||
              is_one_of(name, variables_of_expressions(dim)))
            continue;
          std::vector<std::string> known = variables_of_expressions(dim);
          known.insert(known.end(), functions.begin(), functions.end());
          return " The name " + in_quotes(name) + " is unknown." + did_you_mean(name, known) +
                 " The variables are " + joined(variables_of_expressions(dim), ", ") +
                 ", the constant is pi.";
        }
        else if (token.text == "!")
          return " Write \"(...) == 0\" instead of \"!(...)\".";
        else if (token.text == "**")
          return " Write \"^\" instead of \"**\".";
      return "";
    }

    std::string parser_message(const ExceptionBase &exception)
    {
      std::ostringstream out;
      exception.print_info(out);
      std::string text = out.str();
      const std::string lead = "The parser said: ";
      const std::size_t begin = text.find(lead);
      if (begin != std::string::npos)
        text.erase(0, begin + lead.size());
      text = Utilities::trim(text);
      while (!text.empty() && text.back() == '.')
        text.pop_back();
      return text;
    }

    constexpr unsigned int n_probes = 4000;

    /** Whether there is a finite value at one of many points and times, small and large. */
    template <int dim>
    bool is_finite_somewhere(const SpaceTimeFunction<dim> &function)
    {
      std::uint64_t state = 1;
      const auto uniform = [&state]
      {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) / 9007199254740992.;
      };
      for (unsigned int probe = 0; probe < n_probes; ++probe)
      {
        // Probe 0 is the origin. Every second one has coordinates below ten, the others are spread
        // over orders of magnitude.
        const auto coordinate = [&](const bool may_be_negative)
        {
          const double sign = may_be_negative && uniform() < 0.5 ? -1. : 1.;
          const double size =
              probe % 2 == 0 ? 10. * uniform() : std::pow(10., -6. + 12. * uniform());
          return probe == 0 ? 0. : sign * size;
        };
        Point<dim> point;
        for (unsigned int d = 0; d < dim; ++d)
          point[d] = coordinate(true);
        if (std::isfinite(function.evaluate(point, coordinate(false))))
          return true;
      }
      return false;
    }

    void check_number(const std::vector<std::string> &texts, const unsigned int n_components,
                      const Section &section, const std::string &entry)
    {
      if (texts.size() != n_components)
        section.fail(
            entry, (n_components == 1 ? "one expression is needed"
                                      : std::to_string(n_components) +
                                            " components, separated by \";\", are needed") +
                       ", found " + (texts.empty() ? "none" : std::to_string(texts.size())) + ".");
    }
  } // namespace

  template <int dim>
  struct Expression<dim>::Implementation
  {
    struct Component
    {
      bool is_free = false;
      bool depends_on_time = false;
      bool depends_on_position = false;
      double constant = 0;
      std::unique_ptr<SpaceTimeFunction<dim>> function; ///< null: the component is constant
    };

    std::vector<Component> components;
    std::string description; ///< of the entry, for messages
  };

  template <int dim>
  Expression<dim>::Expression(const Section &section, const std::string &entry,
                              const unsigned int n_components, const bool allow_free)
  {
    const auto parts = std::make_shared<Implementation>();
    implementation = parts;
    const auto texts = split_list(section.get(entry), ';');
    parts->description = section.describe(entry);
    check_number(texts, n_components, section, entry);

    for (unsigned int c = 0; c < n_components; ++c)
    {
      const std::string which =
          n_components == 1 ? "" : "component " + std::to_string(c + 1) + ": ";
      auto &component = parts->components.emplace_back();
      if (texts[c].empty())
        section.fail(entry, which + "there is no expression.");
      if (texts[c] == "free")
      {
        if (!allow_free)
          section.fail(entry, which + "\"free\" is not allowed here: a value is needed.");
        component.is_free = true;
        continue;
      }
      const TableCalls calls(texts[c]);
      const auto tokens = tokens_of(calls);
      const auto names = variables_of_expressions(dim);
      component.depends_on_time = has_name(tokens, "t");
      component.depends_on_position = std::any_of(
          names.begin(), names.end(),
          [&](const std::string &name) { return name != "t" && has_name(tokens, name); });
      const bool is_constant = !component.depends_on_time && !component.depends_on_position;

      bool is_parsed = false;
      bool is_finite = false;
      std::string message = "the parser cannot read it";
      try
      {
        // The parser reports to std::cerr, too.
        const boost::io::ios_rdbuf_saver silent(std::cerr, nullptr);
        component.function = std::make_unique<SpaceTimeFunction<dim>>(calls, section, entry);
        component.constant = component.function->evaluate(Point<dim>(), 0.);
        is_parsed = true;
        is_finite = std::isfinite(component.constant) ||
                    (!is_constant && is_finite_somewhere(*component.function));
      }
      catch (const InputError &)
      {
        throw; // about a table
      }
      catch (const ExceptionBase &exception)
      {
        message = parser_message(exception);
      }
      catch (...)
      {
        // The parser's own exceptions are no std::exception and contain no more than this.
      }
      if (!is_parsed)
        section.fail(entry, which + "this is not an expression: " + message + "." +
                                hint_about(tokens, dim));
      const std::string problem = misunderstanding(tokens);
      if (!problem.empty())
        section.fail(entry, which + problem);
      if (!is_finite && is_constant)
        section.fail(entry, which + "the value is not finite.");
      if (!is_finite)
        section.fail(entry, which + "the value is not finite at any of " +
                                std::to_string(n_probes) +
                                " points and times that were tried. If it is finite in the body, "
                                "write \"if(condition, expression, 0)\".");
      if (is_constant)
        component.function.reset();
    }
  }

  template <int dim>
  double Expression<dim>::value(const Point<dim> &point, const double time,
                                const unsigned int component) const
  {
    AssertIndexRange(component, n_components());
    const auto &data = implementation->components[component];
    if (data.function == nullptr)
      return data.constant;
    const double result = data.function->evaluate(point, time);
    if (!std::isfinite(result))
      throw RunError(
          as_text(implementation->description, ": ",
                  n_components() > 1 ? "component " + std::to_string(component + 1) : "the value",
                  " is not finite (", result, ") at (", point, "), t = ", time, "."));
    return result;
  }

  template <int dim>
  bool Expression<dim>::is_free(const unsigned int component) const
  {
    AssertIndexRange(component, n_components());
    return implementation->components[component].is_free;
  }

  template <int dim>
  bool Expression<dim>::depends_on_time() const
  {
    return std::any_of(implementation->components.begin(), implementation->components.end(),
                       [](const auto &component) { return component.depends_on_time; });
  }

  template <int dim>
  bool Expression<dim>::depends_on_position() const
  {
    return std::any_of(implementation->components.begin(), implementation->components.end(),
                       [](const auto &component) { return component.depends_on_position; });
  }

  template <int dim>
  unsigned int Expression<dim>::n_components() const
  {
    return static_cast<unsigned int>(implementation->components.size());
  }

  template <int dim>
  Predicate<dim>::Predicate(const Section &section, const std::string &entry)
      : expression(section, entry, 1)
  {
    const auto tokens = tokens_of(TableCalls(section.get(entry)));
    if (expression.depends_on_time())
      section.fail(entry, "a condition on points cannot depend on t.");
    if (expression.depends_on_position() &&
        std::none_of(tokens.begin(), tokens.end(), is_comparison))
      section.fail(entry, "a condition is needed, for example \"x < 5 && y > 0\"; this is a number "
                          "that is compared with nothing.");
  }

  template <int dim>
  bool Predicate<dim>::operator()(const Point<dim> &point) const
  {
    try
    {
      return expression.value(point, 0.) != 0.;
    }
    catch (const RunError &error)
    {
      throw InputError(error.what());
    }
  }

  template class Expression<2>;
  template class Expression<3>;
  template class Predicate<2>;
  template class Predicate<3>;
} // namespace tombolo
