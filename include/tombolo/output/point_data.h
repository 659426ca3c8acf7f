// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/symmetric_tensors.h>
#include <tombolo/output/output.h>
#include <tombolo/output/vtu_piece.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** How pictures are written, and which fields they have only on request: entries
   * `Format`, `Precision` and `Further fields`. */
  struct PictureFields
  {
    bool xdmf = false; ///< in one file for all ranks and times of a kind
    bool double_precision = false;
    bool logarithmic_strain = false;
    bool principal_stresses = false;
    bool internal_fields = false; ///< FieldDescription::is_internal

    PictureFields() = default;

    /** Throws InputError for a field that cannot be requested. */
    explicit PictureFields(const Entries &e)
    {
      xdmf = e.choice("Format", "vtu", "vtu|xdmf",
                      "`vtu`: a file for each rank and output, compressed, listed in solution.pvd. "
                      "`xdmf`: HDF5 files that all ranks write together, one for cells, one for "
                      "particles and one for tools, each with all outputs of the run and a file "
                      ".xdmf to open; for big runs.") == "xdmf";
      double_precision =
          e.choice("Precision", "single", "single|double",
                   "How real numbers are written. Single precision has seven digits "
                   "and half of the size; identifiers are exact in both.") == "double";
      std::vector<std::string> names;
      std::string allowed;
      for (const auto &[name, field] : further_fields)
      {
        names.emplace_back(name);
        allowed += (allowed.empty() ? "" : ", ") + names.back();
      }
      for (const std::string &field_name : e.list(
               "Further fields", "",
               "Fields that are written only on request, separated by commas: `logarithmic "
               "strain` (Hencky's, ½ ln(F Fᵀ)), `principal stresses` (`principal stress 1` is the "
               "largest), `internal fields` (what elements and particles remember for themselves, "
               "such as hourglass forces)."))
      {
        bool is_known = false;
        for (const auto &[name, field] : further_fields)
          if (name == field_name)
            is_known = this->*field = true;
        if (is_known)
          continue;
        const std::string nearest = nearest_name(field_name, names);
        e.section().fail("Further fields",
                         "there is no field \"" + field_name + "\" that is written on request" +
                             (nearest.empty() ? "." : ", did you mean \"" + nearest + "\"?") +
                             " Allowed: " + allowed + ".");
      }
    }

  private:
    static constexpr std::pair<const char *, bool PictureFields::*> further_fields[] = {
        {"logarithmic strain", &PictureFields::logarithmic_strain},
        {"principal stresses", &PictureFields::principal_stresses},
        {"internal fields", &PictureFields::internal_fields}};
  };

  /**
   * Values of the fields of material points, and what follows from their stress, for each entity of
   * a picture (cell or particle): the weighted mean of one or several points. Fields are those of
   * all parts of elements, or of particles, the same on all ranks; a part that does not have one
   * has NaN there.
   */
  template <int dim>
  class PointData
  {
  public:
    PointData(const OutputView<dim> &view, const PictureFields &requested, const bool for_particles)
        : view(view), requested(requested),
          fields(point_fields(view, for_particles, requested.internal_fields)),
          values(fields.size())
    {}

    /** Sets the part of the points of the following add(). */
    void set_part(const unsigned int index)
    {
      part_index = index;
      points = &view.parts[index].formulation->points();
      initial_positions = &view.parts[index].formulation->initial_point_positions();
      const auto &own_fields = points->fields();
      own_field.clear();
      for (const FieldDescription &field : fields)
      {
        const auto own = find(own_fields, field.name);
        own_field.push_back(own == own_fields.end() || !has_points(view.parts[index])
                                ? -1
                                : static_cast<int>(std::distance(own_fields.begin(), own)));
      }
    }

    /** Adds an entity with the weighted mean over points of the part. @p deformation_gradient is
     * called where a strain is written. */
    void add(const std::vector<unsigned int> &indices, const std::vector<double> &weights,
             const std::function<dealii::Tensor<2, dim>()> &deformation_gradient)
    {
      double sum = 0;
      for (const double weight : weights)
        sum += weight;
      std::vector<double> shares;
      for (const double weight : weights)
        shares.push_back(weight / sum);
      for (std::size_t f = 0; f < fields.size(); ++f)
        for (unsigned int c = 0; c < fields[f].n_components; ++c)
        {
          double mean = own_field[f] < 0 ? std::numeric_limits<double>::quiet_NaN() : 0.;
          if (own_field[f] >= 0)
          {
            const double *const component =
                points->component(static_cast<unsigned int>(own_field[f]), c);
            for (std::size_t i = 0; i < indices.size(); ++i)
              mean += shares[i] * component[indices[i]];
          }
          values[f].push_back(mean);
        }
      parts.push_back(part_index);
      if (fields.empty())
        return;
      add_derived(indices, shares);
      if (requested.logarithmic_strain)
      {
        const SymmetricComponents strain = logarithmic_strain(deformation_gradient());
        strains.insert(strains.end(), strain.begin(), strain.end());
      }
    }

    /** Moves the fields to @p data, in the order of the files. Cells leave the volume out, since a
     * mean of the volumes of points has no meaning. */
    void move_to(const bool with_volume, VtuPiece::Arrays &data)
    {
      for (std::size_t f = 0; f < fields.size(); ++f)
      {
        if (f == MaterialPoints::volume && !with_volume)
          continue;
        data.add(fields[f].name, fields[f].unit, fields[f].n_components, std::move(values[f]));
        if (f != MaterialPoints::stress)
          continue;
        const std::string unit = fields[f].unit;
        if (view.exact_stress)
          data.add("exact stress", unit, 6, std::move(exact_stresses));
        data.add("pressure", unit, 1, std::move(pressures));
        data.add("von Mises stress", unit, 1, std::move(von_mises_stresses));
        if (requested.principal_stresses)
          for (unsigned int d = 0; d < 3; ++d)
            data.add("principal stress " + std::to_string(d + 1), unit, 1, std::move(principal[d]));
        if (requested.logarithmic_strain)
          data.add("logarithmic strain", "1", 6, std::move(strains));
      }
    }

    std::vector<std::int64_t> parts; ///< of each entity

  private:
    void add_derived(const std::vector<unsigned int> &indices, const std::vector<double> &shares)
    {
      const double *const stress = &*(values[MaterialPoints::stress].end() - 6);
      pressures.push_back(pressure(stress));
      von_mises_stresses.push_back(von_mises_stress(stress));
      if (requested.principal_stresses)
      {
        const std::array<double, 3> entity_principal = principal_values(stress);
        for (unsigned int d = 0; d < 3; ++d)
          principal[d].push_back(entity_principal[d]);
      }
      if (!view.exact_stress)
        return;
      SymmetricComponents mean{};
      for (std::size_t i = 0; i < indices.size(); ++i)
      {
        const auto exact =
            components_of(view.exact_stress((*initial_positions)[indices[i]], view.time));
        for (unsigned int c = 0; c < 6; ++c)
          mean[c] += shares[i] * exact[c];
      }
      exact_stresses.insert(exact_stresses.end(), mean.begin(), mean.end());
    }

    static SymmetricComponents components_of(const dealii::SymmetricTensor<2, 3> &tensor)
    {
      return {{tensor[0][0], tensor[1][1], tensor[2][2], tensor[1][2], tensor[0][2], tensor[0][1]}};
    }

    static auto find(const std::vector<FieldDescription> &fields, const std::string &name)
    {
      return std::find_if(fields.begin(), fields.end(),
                          [&](const FieldDescription &field) { return field.name == name; });
    }

    /** Rigid parts have none. */
    static bool has_points(const OutputPart<dim> &part)
    {
      return part.particles != nullptr || part.formulation->n_points_per_cell() > 0;
    }

    /** The standard fields, then internal variables by name. */
    static std::vector<FieldDescription>
    point_fields(const OutputView<dim> &view, const bool for_particles, const bool with_internal)
    {
      std::vector<FieldDescription> result;
      if (!view.has_mechanics)
        return result;
      for (const OutputPart<dim> &part : view.parts)
        if ((part.particles != nullptr) == for_particles && has_points(part))
          for (const FieldDescription &field : part.formulation->points().fields())
          {
            if (field.is_internal && !with_internal)
              continue;
            const auto known = find(result, field.name);
            if (known == result.end())
              result.push_back(field);
            else
              AssertThrow(known->n_components == field.n_components,
                          dealii::ExcMessage("Two materials have an internal variable \"" +
                                             field.name +
                                             "\" of different numbers of components."));
          }
      return result;
    }

    const OutputView<dim> &view;
    PictureFields requested;
    std::vector<FieldDescription> fields;
    std::vector<std::vector<double>> values;
    std::vector<double> pressures, von_mises_stresses, exact_stresses, strains;
    std::vector<double> principal[3];

    unsigned int part_index = 0;
    const MaterialPoints *points = nullptr;
    const std::vector<dealii::Point<dim>> *initial_positions = nullptr;
    std::vector<int> own_field; ///< the number of each field in this part, or -1
  };
} // namespace tombolo
