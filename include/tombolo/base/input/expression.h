// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>

#include <tombolo/base/input/parameters.h>

#include <memory>
#include <string>

namespace tombolo
{
  /**
   * Expressions of (x, y, z, t) from the parameter file, through dealii::FunctionParser: one or
   * several components separated by ';'. Parsed and evaluated when made, so that a mistake is an
   * InputError with the position of its entry, not a message of muParser in the middle of a run.
   * What muParser reads otherwise than its author is refused, too: "=" for "==", "0 < x < 1",
   * random numbers. Several threads may evaluate one expression at the same time.
   *
   * `table(FILE, argument)` is the piecewise linear function of a file (TableFunction), which is
   * searched in the directory of the parameter file; making an expression is collective.
   */
  template <int dim>
  class Expression
  {
  public:
    /** Reads @p entry of @p section. @p n_components components are required, unless a component
     * may be the word "free" (see is_free). Constants: pi. */
    Expression(const Section &section, const std::string &entry, unsigned int n_components,
               bool allow_free = false);

    /** Throws RunError, on the one rank that evaluates it, naming the entry and position, where the
     * value is not finite. Zero for free components. */
    double value(const dealii::Point<dim> &point, double time, unsigned int component = 0) const;

    /** Whether the component is the word "free": not prescribed. */
    bool is_free(unsigned int component) const;

    /** Whether the text of a component contains the variable t. */
    bool depends_on_time() const;

    /** Whether the text of a component contains a coordinate. */
    bool depends_on_position() const;

    unsigned int n_components() const;

  private:
    struct Implementation;
    std::shared_ptr<const Implementation> implementation; // nothing changes it
  };

  /** A truth value over points, from an expression such as `x < 5 && y > 0`. Evaluation throws
   * InputError, on the one rank that evaluates it, where the value is not finite. */
  template <int dim>
  class Predicate
  {
  public:
    Predicate(const Section &section, const std::string &entry);
    bool operator()(const dealii::Point<dim> &point) const;

  private:
    Expression<dim> expression;
  };
} // namespace tombolo
