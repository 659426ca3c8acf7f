// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/one_point_hexahedron.h>

#include <algorithm>

namespace tombolo
{
  template <int dim>
  OnePointHexahedron<dim>::OnePointHexahedron(const Entries &e)
  {
    coefficient = e.number(
        "Hourglass stiffness", "0.05", between(0., 1.), "1",
        "Modes without strain at the one point are resisted by an elastic force that turns "
        "with the material (Flanagan and Belytschko 1981): its coefficient, of the modulus of "
        "plane waves, at most of four shear moduli; 0.03 to 0.05 is usual.");
    hourglass_limit =
        e.number("Hourglass limit", "0.5", between(0., 1000.), "",
                 "The elastic hourglass force of a cell that flows plastically is at most this "
                 "multiple of the one that belongs to its flow stress; 0 is no limit.");
  }

  template <int dim>
  OnePointHexahedron<dim>::OnePointHexahedron(const double coefficient) : coefficient(coefficient)
  {}

  template <int dim>
  std::vector<FieldDescription> OnePointHexahedron<dim>::variables() const
  {
    std::vector<FieldDescription> fields;
    for (unsigned int alpha = 1; alpha <= n_hourglass_modes; ++alpha)
      fields.push_back({"hourglass force " + std::to_string(alpha), "M L/T^2",
                        FieldLocation::material_point, 3, true, 0., true, OnDivision::reset});
    fields.push_back(
        {"hourglass stiffness", "M/T^2", FieldLocation::material_point, 1, false, 0., true});
    fields.push_back({"hourglass dissipation", "M L^2/T^2", FieldLocation::material_point, 1, true,
                      0., true, OnDivision::shared});
    return fields;
  }

  template <int dim>
  void OnePointHexahedron<dim>::set_material(const Material &material)
  {
    // Hourglass modes bend the cell, which a nearly incompressible material must not resist by its
    // bulk modulus: the cap is K + 4G/3 at ν = 1/3.
    modulus = std::min(material.bulk_modulus() + 4. / 3. * material.shear_modulus(),
                       4. * material.shear_modulus());
    shear_modulus = material.shear_modulus();
  }

  template <int dim>
  void OnePointHexahedron<dim>::initialize_variables(const Work &work,
                                                     ElementVariables variables) const
  {
    Lanes squared_gradient = 0.; // Σ (V b_iI)² over directions and nodes
    for (unsigned int m = 1; m < n_nodes - 1; ++m)
      for (unsigned int d = 0; d < dim; ++d)
        squared_gradient += work.gradient[m][d] * work.gradient[m][d];
    store_lanes(0.5 * coefficient * modulus * ((1. / n_nodes) * squared_gradient) / work.volume,
                variables[3 * n_hourglass_modes]);
  }

  template <int dim>
  void OnePointHexahedron<dim>::add_energies(ConstElementVariables variables, Lanes &stored,
                                             Lanes &dissipated) const
  {
    if (coefficient == 0.)
      return;
    Lanes sum = 0.;
    for (unsigned int c = 0; c < 3 * n_hourglass_modes; ++c)
      sum += load_lanes(variables[c]) * load_lanes(variables[c]);
    stored += 0.5 * sum / load_lanes(variables[3 * n_hourglass_modes]);
    dissipated += load_lanes(variables[3 * n_hourglass_modes + 1]);
  }

  template class OnePointHexahedron<2>;
  template class OnePointHexahedron<3>;

  /** The plug-in. */
  template <int dim>
  using Hexahedron = CellFormulation<dim, OnePointHexahedron<dim>>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, Hexahedron, "hexahedron",
      "one integration point with hourglass control: the fastest element")
} // namespace tombolo
