// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/adaptive_refinement.h>

#include <tombolo/model/process.h>

namespace tombolo
{
  template <int dim>
  void AdaptiveRefinement<dim>::refuse_unfit(const std::vector<Part<dim>> &parts) const
  {
    const Parameters &parameters = section.all();
    if (const std::string missing = criterion->missing(parts); !missing.empty())
      section.fail("Criterion", missing + ", so that the criterion is zero everywhere.");
    for (const Part<dim> &part : parts)
    {
      const Section part_section = parameters.section("Part: " + part.name);
      const bool becomes_other =
          part.source ||
          std::any_of(parts.begin(), parts.end(),
                      [&](const Part<dim> &other)
                      { return other.source && parts[*other.source].name == part.name; });
      if (!part.formulation->can_be_divided() || part.formulation->degree() > 1)
        part_section.fail("Formulation", "cells of this part cannot be divided in a run (\"" +
                                             std::string(adaptive_path) +
                                             "\"); allowed are elements of degree one and smoothed "
                                             "cells.");
      if (becomes_other || part.formulation->can_lose_cells())
        part_section.fail("Formulation", "cells of this part can leave, by erosion, conversion or "
                                         "refills, which excludes \"" +
                                             std::string(adaptive_path) + "\".");
    }
    for (const Section &contact : named_sections(parameters, "Contacts", "Contact"))
    {
      const std::string surface = contact.get("Surface");
      if (surface == surface_of_part)
        contact.fail("Surface", "that of a part keeps a state of one mesh, which excludes \"" +
                                    std::string(adaptive_path) + "\"; allowed are rigid ones.");
      if (contact.get("Method") == "kinematic" && surface != "plane")
        contact.fail("Method", "a node that divides the face between two others can lie behind a "
                               "surface that is not plane, and would jump out of it; allowed with "
                               "\"" +
                                   std::string(adaptive_path) + "\" is penalty or surface.");
    }
    if (parameters.section("").get("Time integration") != "explicit")
      parameters.fail("Time integration",
                      "allowed with \"" + std::string(adaptive_path) + "\" is `explicit`.");
  }

  template <int dim>
  void AdaptiveRefinement<dim>::book(const ModelContent &before, const ModelContent &after,
                                     const Model<dim> &model)
  {
    ++n_meshes;
    count_cells(model); // after the data of the former mesh were read
    if (Utilities::MPI::this_mpi_process(model.communicator) != 0)
      return;
    lost += before.energy - after.energy;
    if (model.heat)
    {
      const double now = before.enthalpy - after.enthalpy;
      model.heat->eroded_heat += now;
      model.heat->eroding_heat += before.next_enthalpy - after.next_enthalpy - now;
    }
    for (unsigned int d = 0; d < 3; ++d)
    {
      lost_momentum[d] += before.momentum[d] - after.momentum[d];
      lost_angular_momentum[d] += before.angular_momentum[d] - after.angular_momentum[d];
    }
  }

  template class AdaptiveRefinement<2>;
  template class AdaptiveRefinement<3>;

  TOMBOLO_REGISTER_PROCESS(AdaptiveRefinement, process_order::conversion + 6)

  namespace
  {
    const char *const plastic_strain_name = "effective plastic strain";

    /** The gradient in the middle of a cell of a field with @p values at the corners @p positions,
     * in their order. Zero where the cell has no volume. */
    template <int dim>
    Tensor<1, dim> gradient_in_the_middle(const std::vector<Tensor<1, dim>> &positions,
                                          const std::vector<double> &values)
    {
      Point<dim> middle;
      for (unsigned int d = 0; d < dim; ++d)
        middle[d] = 0.5;
      Tensor<2, dim> jacobian;
      Tensor<1, dim> along_axes;
      for (unsigned int k = 0; k < positions.size(); ++k)
      {
        const Tensor<1, dim> shape = GeometryInfo<dim>::d_linear_shape_function_gradient(middle, k);
        jacobian += outer_product(positions[k], shape);
        along_axes += values[k] * shape;
      }
      if (!(std::abs(determinant(jacobian)) > 0.))
        return Tensor<1, dim>();
      return along_axes * invert(jacobian);
    }

    /** The root of the sum of the squared gradients of nodal fields in the middle of each cell,
     * each with its weight. */
    template <int dim>
    std::vector<double> gradients(const Model<dim> &model,
                                  const std::vector<std::pair<const NodalVector *, double>> &fields)
    {
      std::vector<double> result;
      for_cells(model,
                [&](const auto &, const std::vector<unsigned int> &nodes)
                {
                  std::vector<Tensor<1, dim>> positions;
                  for (const unsigned int node : nodes)
                    positions.push_back(vector_of<dim>(model.state.position.node(node)));
                  double squared = 0;
                  std::vector<double> at_nodes(nodes.size());
                  for (const auto &[field, weight] : fields)
                  {
                    for (std::size_t k = 0; k < nodes.size(); ++k)
                      at_nodes[k] = *field->node(nodes[k]);
                    squared += weight * gradient_in_the_middle(positions, at_nodes).norm_square();
                  }
                  result.push_back(std::sqrt(squared));
                });
      return result;
    }
  } // namespace

  /** The largest plastic strain of the points of a cell. */
  template <int dim>
  class PlasticStrainCriterion : public RefinementCriterion<dim>
  {
  public:
    std::vector<double> values(const Model<dim> &model) const override
    {
      std::vector<double> result;
      for (const Part<dim> &part : model.parts)
      {
        const Formulation<dim> &formulation = *part.formulation;
        const MaterialPoints &points = formulation.points();
        const unsigned int field = points.find_field(plastic_strain_name);
        const bool has_field = field < points.fields().size();
        for (unsigned int cell = 0; cell < formulation.n_cells(); ++cell)
        {
          double largest = 0;
          for (unsigned int q = 0; has_field && q < formulation.n_points_per_cell(); ++q)
            largest =
                std::max(largest, points.component(field, 0)[formulation.point_of_cell(cell, q)]);
          result.push_back(largest);
        }
      }
      return result;
    }

  private:
    std::string lack(const Part<dim> &part) const override
    {
      return part.material->remembers(plastic_strain_name)
                 ? ""
                 : "no material of the scene has plastic strain";
    }
  };

  /** The magnitude of the gradient of the temperature in the middle of a cell. */
  template <int dim>
  class TemperatureGradientCriterion : public RefinementCriterion<dim>
  {
  public:
    std::vector<double> values(const Model<dim> &model) const override
    {
      return gradients(model, {{&model.heat->state.temperature, 1.}});
    }

  private:
    std::string lack(const Part<dim> &part) const override
    {
      return part.heat != nullptr ? "" : "the scene has no heat";
    }
  };

  /** The magnitude of the gradient of the stress in the middle of a cell, from the means of the
   * cells around its nodes. */
  template <int dim>
  class StressGradientCriterion : public RefinementCriterion<dim>
  {
  public:
    std::vector<double> values(const Model<dim> &model) const override
    {
      std::vector<unsigned int> parts(model.parts.size());
      std::iota(parts.begin(), parts.end(), 0u);
      const std::array<NodalVector, 6> stress = stress_at_nodes(model, parts);
      std::vector<std::pair<const NodalVector *, double>> fields;
      for (unsigned int c = 0; c < 6; ++c)
        fields.emplace_back(&stress[c], c < 3 ? 1. : 2.); // entries off the diagonal stand twice
      return gradients(model, fields);
    }

  private:
    std::string lack(const Part<dim> &part) const override
    {
      return part.material->has_mechanics() ? "" : "the scene has no mechanics";
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(RefinementCriterion, PlasticStrainCriterion, "plastic strain",
                                  "the largest plastic strain of the points of the cell")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      RefinementCriterion, TemperatureGradientCriterion, "temperature gradient",
      "the magnitude of the gradient of the temperature in the middle of the cell")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      RefinementCriterion, StressGradientCriterion, "stress gradient",
      "the magnitude of the gradient of the stress, averaged at the nodes, in the middle")
} // namespace tombolo
