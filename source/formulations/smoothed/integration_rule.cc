// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/integration_rule.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>

namespace tombolo
{
  using namespace dealii;

  SmoothedIntegrationRule smoothed_integration_rule(const std::string &name)
  {
    return name == "smoothed"    ? SmoothedIntegrationRule::smoothed
           : name == "one point" ? SmoothedIntegrationRule::one_point
                                 : SmoothedIntegrationRule::gauss;
  }

  template <int dim>
  Quadrature<dim> quadrature_of(const SmoothedIntegrationRule rule)
  {
    return rule == SmoothedIntegrationRule::one_point ? Quadrature<dim>(QMidpoint<dim>())
                                                      : Quadrature<dim>(QGauss<dim>(2));
  }

  template <int dim>
  PointOfCell<dim>::PointOfCell(const Point<dim> &unit,
                                const typename SubCells<dim>::Corners &corners)
  {
    for (unsigned int corner = 0; corner < SubCells<dim>::n_corners; ++corner)
    {
      place += GeometryInfo<dim>::d_linear_shape_function(unit, corner) * corners[corner];
      jacobian += outer_product(Tensor<1, dim>(corners[corner]),
                                GeometryInfo<dim>::d_linear_shape_function_gradient(unit, corner));
    }
  }

  template <int dim>
  std::vector<double> volumes_of_points(const SmoothedIntegrationRule rule,
                                        const typename SubCells<dim>::Corners &corners)
  {
    const Quadrature<dim> quadrature = quadrature_of<dim>(rule);
    std::vector<double> result;
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      result.push_back(determinant(PointOfCell<dim>(quadrature.point(q), corners).jacobian) *
                       quadrature.weight(q));
    return result;
  }

  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(const SmoothedIntegrationRule rule)
  {
    std::vector<std::vector<double>> result;
    if (rule == SmoothedIntegrationRule::smoothed)
      for (const auto &shares : SubCells<dim>::centroids())
        result.emplace_back(shares.begin(), shares.end());
    else
    {
      const Quadrature<dim> quadrature = quadrature_of<dim>(rule);
      for (const Point<dim> &point : quadrature.get_points())
      {
        result.emplace_back();
        for (unsigned int corner = 0; corner < SubCells<dim>::n_corners; ++corner)
          result.back().push_back(GeometryInfo<dim>::d_linear_shape_function(point, corner));
      }
    }
    return result;
  }

  template struct PointOfCell<2>;
  template struct PointOfCell<3>;
  template std::vector<double> volumes_of_points<2>(SmoothedIntegrationRule,
                                                    const SubCells<2>::Corners &);
  template std::vector<double> volumes_of_points<3>(SmoothedIntegrationRule,
                                                    const SubCells<3>::Corners &);
  template Quadrature<2> quadrature_of<2>(SmoothedIntegrationRule);
  template Quadrature<3> quadrature_of<3>(SmoothedIntegrationRule);
  template std::vector<std::vector<double>> corner_shares_of_points<2>(SmoothedIntegrationRule);
  template std::vector<std::vector<double>> corner_shares_of_points<3>(SmoothedIntegrationRule);
} // namespace tombolo
