// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/integration_rule.h>

#include <deal.II/base/geometry_info.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Point<dim> middle_of_unit_cell()
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = 0.5;
      return result;
    }
  } // namespace

  SmoothedIntegrationRule smoothed_integration_rule(const std::string &name)
  {
    return name == "smoothed" ? SmoothedIntegrationRule::smoothed
                              : SmoothedIntegrationRule::one_point;
  }

  template <int dim>
  PointOfCell<dim>::PointOfCell(const typename SubCells<dim>::Corners &corners)
  {
    const Point<dim> unit = middle_of_unit_cell<dim>();
    for (unsigned int corner = 0; corner < SubCells<dim>::n_corners; ++corner)
    {
      place += GeometryInfo<dim>::d_linear_shape_function(unit, corner) * corners[corner];
      jacobian += outer_product(Tensor<1, dim>(corners[corner]),
                                GeometryInfo<dim>::d_linear_shape_function_gradient(unit, corner));
    }
  }

  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(const SmoothedIntegrationRule rule)
  {
    std::vector<std::vector<double>> result;
    if (rule == SmoothedIntegrationRule::smoothed)
      for (const auto &shares : SubCells<dim>::centroids())
        result.emplace_back(shares.begin(), shares.end());
    else
      result.emplace_back(SubCells<dim>::n_corners, 1. / SubCells<dim>::n_corners);
    return result;
  }

  template struct PointOfCell<2>;
  template struct PointOfCell<3>;
  template std::vector<std::vector<double>> corner_shares_of_points<2>(SmoothedIntegrationRule);
  template std::vector<std::vector<double>> corner_shares_of_points<3>(SmoothedIntegrationRule);
} // namespace tombolo
