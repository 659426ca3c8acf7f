// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/read_vector.h>

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** A component of a condition that prescribes the motion of a node along a direction. */
  template <int dim>
  struct PrescribedRow
  {
    int condition; ///< its number
    unsigned int component;
    dealii::Tensor<1, dim> direction; ///< of length one
  };

  /**
   * The motion of one node prescribed by several conditions: an orthonormal frame with some
   * prescribed axes. An axis of the coordinates that is prescribed is one of the frame, and where
   * one condition prescribes all of the motion, the frame is that of the coordinates.
   */
  template <int dim>
  struct PrescribedFrame
  {
    dealii::Tensor<2, dim> axes;          ///< by rows
    std::array<int, dim> condition;       ///< that prescribes along an axis, or -1
    std::array<bool, dim> is_turned;      ///< whether an axis is not that of the coordinates
    std::vector<PrescribedRow<dim>> rows; ///< that act, at most dim
    /** The value along axis k is Σ_r weights[k][r] times the value of row r. */
    dealii::Tensor<2, dim> weights;

    /** Of the rows of one node; of those that are not independent the later conditions act. */
    explicit PrescribedFrame(std::vector<PrescribedRow<dim>> all)
    {
      condition.fill(-1);
      is_turned.fill(false);
      choose(std::move(all));
      if (rows.size() == dim && std::all_of(rows.begin(), rows.end(),
                                            [this](const PrescribedRow<dim> &row)
                                            { return row.condition == rows.front().condition; }))
        prescribe_all();
      else
        prescribe_some();
    }

    /** Sets the prescribed part of a vector by the values of the rows. */
    void prescribe(const dealii::Tensor<1, dim> &values, double *const vector) const
    {
      for (unsigned int k = 0; k < dim; ++k)
      {
        if (condition[k] < 0)
          continue;
        const double target = weights[k] * values;
        if (!is_turned[k])
        {
          vector[k] = target;
          continue;
        }
        double change = target;
        for (unsigned int d = 0; d < dim; ++d)
          change -= axes[k][d] * vector[d];
        for (unsigned int d = 0; d < dim; ++d)
          vector[d] += change * axes[k][d];
      }
    }

  private:
    /** The axis of the coordinates along which a direction is, either way; dim: none. */
    static unsigned int axis_along(const dealii::Tensor<1, dim> &direction)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(direction[d]) == 1.)
          return d;
      return dim;
    }

    void choose(std::vector<PrescribedRow<dim>> all)
    {
      constexpr double smallest_sine = 1e-6; // of a direction and what later ones span
      std::stable_sort(all.begin(), all.end(),
                       [](const auto &a, const auto &b) { return a.condition > b.condition; });
      std::vector<dealii::Tensor<1, dim>> spanned;
      for (const PrescribedRow<dim> &row : all)
      {
        dealii::Tensor<1, dim> rest = row.direction;
        for (const dealii::Tensor<1, dim> &other : spanned)
          rest -= (rest * other) * other;
        if (!(rest.norm() > smallest_sine))
          continue;
        spanned.push_back(rest / rest.norm());
        rows.push_back(row);
      }
      // Axes of the coordinates are used as they are, others normal to them.
      std::stable_sort(rows.begin(), rows.end(),
                       [](const auto &a, const auto &b)
                       { return axis_along(a.direction) < axis_along(b.direction); });
    }

    void prescribe_all()
    {
      dealii::Tensor<2, dim> directions;
      for (unsigned int d = 0; d < dim; ++d)
      {
        axes[d][d] = 1.;
        directions[d] = rows[d].direction;
        condition[d] = rows[d].condition;
      }
      weights = invert(directions);
    }

    void prescribe_some()
    {
      for (unsigned int r = 0; r < rows.size(); ++r)
      {
        dealii::Tensor<1, dim> rest = rows[r].direction, value;
        value[r] = 1.;
        unsigned int component = axis_along(rest);
        if (component < dim)
        {
          value[r] = rest[component];
          rest = dealii::Tensor<1, dim>();
          rest[component] = 1.;
        }
        else
        {
          for (unsigned int k = 0; k < dim; ++k)
            if (condition[k] >= 0)
            {
              const double share = rows[r].direction * axes[k];
              rest -= share * axes[k];
              value -= share * weights[k];
            }
          value /= rest.norm();
          rest /= rest.norm();
          for (unsigned int k = 0; k < dim; ++k)
            if (condition[k] < 0 &&
                (component == dim || std::abs(rest[k]) > std::abs(rest[component])))
              component = k;
          is_turned[component] = true;
        }
        axes[component] = rest;
        weights[component] = value;
        condition[component] = rows[r].condition;
      }
      complete();
    }

    void complete()
    {
      std::array<bool, dim> is_set{};
      for (unsigned int k = 0; k < dim; ++k)
        is_set[k] = condition[k] >= 0;
      for (unsigned int k = 0; k < dim; ++k)
      {
        if (is_set[k])
          continue;
        dealii::Tensor<1, dim> best;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const unsigned int from = (k + d) % dim; // the own one where others are as good
          dealii::Tensor<1, dim> rest;
          rest[from] = 1.;
          for (unsigned int twice = 0; twice < 2; ++twice)
            for (unsigned int other = 0; other < dim; ++other)
              if (is_set[other])
                rest -= (rest * axes[other]) * axes[other];
          if (rest.norm() > best.norm() + 1e-9)
            best = rest;
        }
        axes[k] = best / best.norm();
        is_set[k] = true;
        is_turned[k] = axis_along(axes[k]) != k;
      }
    }
  };

  class Entries;

  /**
   * The axes along which the components of a condition are: those of the coordinates, other fixed
   * directions, or the radial, the circumferential and the axial direction about an axis at the
   * initial position of a node.
   */
  template <int dim>
  class LocalAxes
  {
  public:
    /** Those of the coordinates. */
    LocalAxes() = default;

    static void declare_parameters(const Entries &e)
    {
      e.text(
          "Axes", "", "",
          "Of a velocity, a displacement, a traction or a body force: the directions of its "
          "components, where these are not along the axes of the coordinates. Two directions, "
          "separated by `;`, of which the second gives the plane of the first two components (one "
          "direction in two dimensions), or `cylindrical`: radial, circumferential and axial at "
          "the initial position, about the `Axis` through `Centre`.");
    }

    /** Reads `Axes`, and `Axis` and `Centre` of cylindrical ones. Throws InputError. */
    explicit LocalAxes(const Section &section)
    {
      const std::string text = section.get("Axes");
      if (text.empty())
        return;
      if (text == "cylindrical")
      {
        cylinder.emplace();
        cylinder->centre = dealii::Point<dim>(read_vector<dim>(section, "Centre"));
        if constexpr (dim == 3)
          cylinder->axis = cleaned(read_direction<3>(section, "Axis"));
        return;
      }
      const std::vector<dealii::Tensor<1, dim>> directions = read_vectors<dim>(section, "Axes");
      if (directions.size() != dim - 1)
        section.fail("Axes", std::string("allowed is `cylindrical`, or ") +
                                 (dim == 2 ? "one direction: of the first component."
                                           : "two directions, separated by `;`: of the first "
                                             "component, and another one in the plane of the first "
                                             "two."));
      for (const dealii::Tensor<1, dim> &direction : directions)
        if (!(direction.norm() > 0.) || !std::isfinite(direction.norm()))
          section.fail("Axes", "a direction needs a length above zero.");
      dealii::Tensor<2, dim> axes;
      axes[0] = cleaned(directions[0]);
      if constexpr (dim == 2)
        axes[1] = dealii::Tensor<1, 2>({-axes[0][1], axes[0][0]});
      else
      {
        const dealii::Tensor<1, dim> normal =
            cross_product_3d(axes[0], directions[1] / directions[1].norm());
        if (!(normal.norm() > smallest_sine))
          section.fail("Axes", "its two directions are parallel, and span no plane.");
        axes[2] = cleaned(normal);
        axes[1] = cleaned(dealii::Tensor<1, dim>(cross_product_3d(axes[2], axes[0])));
      }
      fixed = axes;
    }

    /** Whether they are others than those of the coordinates. */
    bool are_local() const
    {
      return fixed || cylinder;
    }

    bool depend_on_position() const
    {
      return cylinder.has_value();
    }

    /** Whether there are directions at @p initial: not on the axis of cylindrical ones. */
    bool are_defined_at(const dealii::Point<dim> &initial) const
    {
      return !cylinder || radius(initial).norm() > 1e-9 * (initial - cylinder->centre).norm();
    }

    /** The axes at a position where they are defined, by rows: orthonormal. */
    dealii::Tensor<2, dim> at(const dealii::Point<dim> &initial) const
    {
      dealii::Tensor<2, dim> result;
      if (fixed)
        return *fixed;
      if (!cylinder)
      {
        for (unsigned int d = 0; d < dim; ++d)
          result[d][d] = 1.;
        return result;
      }
      result[0] = cleaned(radius(initial));
      if constexpr (dim == 2)
        result[1] = dealii::Tensor<1, 2>({-result[0][1], result[0][0]});
      else
      {
        result[2] = cylinder->axis;
        result[1] = cleaned(dealii::Tensor<1, dim>(cross_product_3d(result[2], result[0])));
      }
      return result;
    }

  private:
    static constexpr double smallest_sine = 1e-6; // of two directions that span a plane

    /** Without what is round-off of zero, of length one. */
    static dealii::Tensor<1, dim> cleaned(dealii::Tensor<1, dim> direction)
    {
      static constexpr double round_off = 1e-14;
      direction /= direction.norm();
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(direction[d]) < round_off)
          direction[d] = 0.;
      return direction / direction.norm();
    }

    struct Cylinder
    {
      dealii::Point<dim> centre;
      dealii::Tensor<1, dim> axis; ///< of length one; zero in two dimensions
    };

    /** From the axis, normal to it. */
    dealii::Tensor<1, dim> radius(const dealii::Point<dim> &initial) const
    {
      const dealii::Tensor<1, dim> arm = initial - cylinder->centre;
      return arm - (arm * cylinder->axis) * cylinder->axis;
    }

    std::optional<dealii::Tensor<2, dim>> fixed;
    std::optional<Cylinder> cylinder;
  };
} // namespace tombolo
