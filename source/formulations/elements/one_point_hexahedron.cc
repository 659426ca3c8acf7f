// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/one_point_hexahedron.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void OnePointHexahedron<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Hourglass", "stiffness", Patterns::Selection("stiffness|viscous"),
        "How modes without strain at the one point are resisted: by an elastic force "
        "that turns with the material, or by a viscous one (Flanagan and Belytschko "
        "1981).");
    handler.declare_entry("Hourglass stiffness", "0.05", Patterns::Double(0., 1.),
                          "Coefficient of the elastic hourglass force, of the modulus of plane "
                          "waves, at most of four "
                          "shear moduli; 0.03 to 0.05 is usual. Units: 1.");
    handler.declare_entry(
        "Hourglass limit", "0.5", Patterns::Double(0., 1000.),
        "The elastic hourglass force of a cell that flows plastically is at most this multiple of "
        "the one that belongs to its flow stress; 0 is no limit.");
    handler.declare_entry(
        "Hourglass viscosity", "0.1", Patterns::Double(0., 1.),
        "Coefficient of the viscous hourglass force; 0.05 to 0.15 is usual. Units: 1.");
  }

  template <int dim>
  OnePointHexahedron<dim>::OnePointHexahedron(const HourglassControl control,
                                              const double coefficient)
      : control(control), coefficient(coefficient)
  {}

  template <int dim>
  OnePointHexahedron<dim>::OnePointHexahedron(const Section &section)
  {
    if (section.get("Hourglass") == "viscous")
    {
      control = HourglassControl::viscous;
      coefficient = section.get_double("Hourglass viscosity");
    }
    else
    {
      coefficient = section.get_double("Hourglass stiffness");
      hourglass_limit = section.get_double("Hourglass limit");
    }
  }

  template <int dim>
  std::vector<FieldDescription> OnePointHexahedron<dim>::variables() const
  {
    std::vector<FieldDescription> fields;
    for (unsigned int alpha = 1; alpha <= n_hourglass_modes; ++alpha)
      fields.push_back({"hourglass force " + std::to_string(alpha), "M L/T^2",
                        FieldLocation::material_point, 3, true, 0., true, OnDivision::reset});
    if (control == HourglassControl::stiffness)
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
    impedance = material.inertial_density() * material.longitudinal_wave_speed();
  }

  template <int dim>
  void OnePointHexahedron<dim>::initialize_variables(const Work &work,
                                                     ElementVariables variables) const
  {
    if (control == HourglassControl::stiffness)
      store_lanes(0.5 * coefficient * modulus * squared_gradient(work) / work.volume,
                  variables[3 * n_hourglass_modes]);
  }

  template <int dim>
  void OnePointHexahedron<dim>::add_energies(ConstElementVariables variables, Lanes &stored,
                                             Lanes &dissipated) const
  {
    const Lanes last = load_lanes(variables[3 * n_hourglass_modes]);
    if (control == HourglassControl::viscous)
    {
      dissipated += last;
      return;
    }
    if (coefficient == 0.)
      return;
    Lanes sum = 0.;
    for (unsigned int c = 0; c < 3 * n_hourglass_modes; ++c)
      sum += load_lanes(variables[c]) * load_lanes(variables[c]);
    stored += 0.5 * sum / last;
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
