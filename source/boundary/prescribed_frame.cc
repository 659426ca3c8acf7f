// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/prescribed_frame.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/read_vector.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace tombolo
{
  namespace
  {
    /** The axis of the coordinates along which a direction is, either way; dim: none. */
    template <int dim>
    unsigned int axis_along(const Tensor<1, dim> &direction)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(direction[d]) == 1.)
          return d;
      return dim;
    }
  } // namespace

  template <int dim>
  PrescribedFrame<dim>::PrescribedFrame(std::vector<PrescribedRow<dim>> all)
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

  template <int dim>
  void PrescribedFrame<dim>::choose(std::vector<PrescribedRow<dim>> all)
  {
    constexpr double smallest_sine = 1e-6; // of a direction and what later ones span
    std::stable_sort(all.begin(), all.end(),
                     [](const auto &a, const auto &b) { return a.condition > b.condition; });
    std::vector<Tensor<1, dim>> spanned;
    for (const PrescribedRow<dim> &row : all)
    {
      Tensor<1, dim> rest = row.direction;
      for (const Tensor<1, dim> &other : spanned)
        rest -= (rest * other) * other;
      if (!(rest.norm() > smallest_sine))
        continue;
      spanned.push_back(rest / rest.norm());
      rows.push_back(row);
    }
    // Axes of the coordinates are taken as they are, others normal to them.
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto &a, const auto &b)
                     { return axis_along(a.direction) < axis_along(b.direction); });
  }

  template <int dim>
  void PrescribedFrame<dim>::prescribe_all()
  {
    Tensor<2, dim> directions;
    for (unsigned int d = 0; d < dim; ++d)
    {
      axes[d][d] = 1.;
      directions[d] = rows[d].direction;
      condition[d] = rows[d].condition;
    }
    weights = invert(directions);
  }

  template <int dim>
  void PrescribedFrame<dim>::prescribe_some()
  {
    for (unsigned int r = 0; r < rows.size(); ++r)
    {
      Tensor<1, dim> rest = rows[r].direction, value;
      value[r] = 1.;
      unsigned int place = axis_along(rest);
      if (place < dim)
      {
        value[r] = rest[place];
        rest = Tensor<1, dim>();
        rest[place] = 1.;
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
          if (condition[k] < 0 && (place == dim || std::abs(rest[k]) > std::abs(rest[place])))
            place = k;
        is_turned[place] = true;
      }
      axes[place] = rest;
      weights[place] = value;
      condition[place] = rows[r].condition;
    }
    complete();
  }

  template <int dim>
  void PrescribedFrame<dim>::complete()
  {
    std::array<bool, dim> is_set{};
    for (unsigned int k = 0; k < dim; ++k)
      is_set[k] = condition[k] >= 0;
    for (unsigned int k = 0; k < dim; ++k)
    {
      if (is_set[k])
        continue;
      Tensor<1, dim> best;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int from = (k + d) % dim; // the own one where others are as good
        Tensor<1, dim> rest;
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

  template struct PrescribedFrame<2>;
  template struct PrescribedFrame<3>;

  namespace
  {
    constexpr double smallest_sine = 1e-6; // of two directions that span a plane

    /** Without what is round-off of zero, of length one. */
    template <int dim>
    Tensor<1, dim> cleaned(Tensor<1, dim> direction)
    {
      constexpr double round_off = 1e-14;
      direction /= direction.norm();
      for (unsigned int d = 0; d < dim; ++d)
        if (std::abs(direction[d]) < round_off)
          direction[d] = 0.;
      return direction / direction.norm();
    }
  } // namespace

  template <int dim>
  void LocalAxes<dim>::declare_parameters(const Entries &e)
  {
    e.text("Axes", "", "",
           "Of a velocity, a displacement, a traction or a body force: the directions of its "
           "components, where these are not along the axes of the coordinates. Two directions, "
           "separated by `;`, of which the second gives the plane of the first two components (one "
           "direction in two dimensions), or `cylindrical`: radial, circumferential and axial at "
           "the initial position, about the `Axis` through `Centre`.");
  }

  template <int dim>
  LocalAxes<dim>::LocalAxes(const Section &section)
  {
    const std::string text = section.get("Axes");
    if (text.empty())
      return;
    if (text == "cylindrical")
    {
      cylinder.emplace();
      cylinder->centre = Point<dim>(read_vector<dim>(section, "Centre"));
      if constexpr (dim == 3)
        cylinder->axis = cleaned(read_direction<3>(section, "Axis"));
      return;
    }
    const std::vector<Tensor<1, dim>> directions = read_vectors<dim>(section, "Axes");
    if (directions.size() != dim - 1)
      section.fail("Axes", std::string("allowed is `cylindrical`, or ") +
                               (dim == 2 ? "one direction: of the first component."
                                         : "two directions, separated by `;`: of the first "
                                           "component, and another one in the plane of the first "
                                           "two."));
    for (const Tensor<1, dim> &direction : directions)
      if (!(direction.norm() > 0.) || !std::isfinite(direction.norm()))
        section.fail("Axes", "a direction needs a length above zero.");
    Tensor<2, dim> axes;
    axes[0] = cleaned(directions[0]);
    if constexpr (dim == 2)
      axes[1] = Tensor<1, 2>({-axes[0][1], axes[0][0]});
    else
    {
      const Tensor<1, dim> normal = cross_product_3d(axes[0], directions[1] / directions[1].norm());
      if (!(normal.norm() > smallest_sine))
        section.fail("Axes", "its two directions are parallel, and span no plane.");
      axes[2] = cleaned(normal);
      axes[1] = cleaned(Tensor<1, dim>(cross_product_3d(axes[2], axes[0])));
    }
    fixed = axes;
  }

  template <int dim>
  Tensor<1, dim> LocalAxes<dim>::radius(const Point<dim> &initial) const
  {
    const Tensor<1, dim> arm = initial - cylinder->centre;
    return arm - (arm * cylinder->axis) * cylinder->axis;
  }

  template <int dim>
  bool LocalAxes<dim>::are_defined_at(const Point<dim> &initial) const
  {
    return !cylinder || radius(initial).norm() > 1e-9 * (initial - cylinder->centre).norm();
  }

  template <int dim>
  Tensor<2, dim> LocalAxes<dim>::at(const Point<dim> &initial) const
  {
    Tensor<2, dim> result;
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
      result[1] = Tensor<1, 2>({-result[0][1], result[0][0]});
    else
    {
      result[2] = cylinder->axis;
      result[1] = cleaned(Tensor<1, dim>(cross_product_3d(result[2], result[0])));
    }
    return result;
  }

  template class LocalAxes<2>;
  template class LocalAxes<3>;
} // namespace tombolo
