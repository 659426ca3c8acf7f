// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/element_modes.h>

using namespace tombolo;

/**
 * An element of its own in a shared object: a hexahedron (quadrilateral) with one point, the mean
 * gradient, and dashpots of one strength against its hourglass modes. doc/add_an_element.md walks
 * through it.
 */
template <int dim>
class PlainElement : public ElementDefaults
{
public:
  static constexpr unsigned int degree = 1, n_nodes = 1 << dim, n_points = 1;

  struct Work
  {
    Lanes volume, gradient[n_nodes][dim], x[n_nodes][dim]; // of modes
    Lanes rate[n_nodes][dim], dashpot[n_nodes][dim];       // of hourglass modes
  };

  static void declare_parameters(dealii::ParameterHandler &handler)
  {
    handler.declare_entry("Damping", "0.1", dealii::Patterns::Double(0., 1.),
                          "Strength of the dashpots against hourglass modes. Units: 1.");
  }

  explicit PlainElement(const Section &section) : damping(section.get_double("Damping")) {}

  static std::vector<dealii::Point<dim>> reference_points()
  {
    return {dealii::Point<dim>()};
  }

  std::vector<FieldDescription> variables() const
  {
    return {{"hourglass dissipation", "M L^2/T^2", FieldLocation::material_point, 1, true}};
  }

  void set_material(const Material &material)
  {
    impedance = material.inertial_density() * material.longitudinal_wave_speed();
  }

  /** Dashpots resist rates: static steps refuse the element. */
  bool is_viscous() const
  {
    return true;
  }

  void evaluate(const Lanes (&x)[n_nodes][dim], const Lanes (&v)[n_nodes][dim], Work &work,
                Lanes (&volume)[1], Matrix3<Lanes> (&gradient)[1]) const
  {
    Lanes v_modes[n_nodes][dim];
    to_modes(x, work.x);
    to_modes(v, v_modes);
    volume_gradient(work.x, work.gradient, work.volume);
    volume[0] = work.volume;
    gradient[0] = zero_matrix<Lanes>();
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int m = 1; m < n_nodes - 1; ++m)
          gradient[0](i, j) += v_modes[m][i] * work.gradient[m][j] / work.volume;
    for (unsigned int m = 0; m < n_nodes; ++m)
      for (unsigned int i = 0; i < dim && is_hourglass_mode(m); ++i)
      {
        work.rate[m][i] = v_modes[m][i]; // less the linear field, which is no hourglass
        for (unsigned int j = 0; j < dim; ++j)
          work.rate[m][i] -= gradient[0](i, j) * work.x[m][j];
      }
  }

  void advance(Work &work, const Lanes (&/*spin*/)[1][3], const double time_increment,
               ElementVariables variables) const
  {
    Lanes power = 0.;
    resist(work, 1., power);
    store_lanes(load_lanes(variables[0]) + time_increment * power, variables[0]);
  }

  void linearize(Work &work, const double time_step, ConstElementVariables /*variables*/) const
  {
    Lanes power = 0.;
    resist(work, 2. / time_step, power);
  }

  void add_energies(ConstElementVariables variables, Lanes & /*stored*/, Lanes &dissipated) const
  {
    dissipated += load_lanes(variables[0]);
  }

  void integrate(const Work &work, const Lanes (&stress)[1][6], Lanes (&force)[n_nodes][dim]) const
  {
    constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    for (unsigned int i = 0; i < dim; ++i)
    {
      Lanes modes[n_nodes];
      for (unsigned int m = 0; m < n_nodes; ++m)
        modes[m] = is_hourglass_mode(m) ? work.dashpot[m][i] : 0.;
      for (unsigned int j = 0; j < dim; ++j)
      {
        Lanes row = stress[0][component[i][j]];
        for (unsigned int m = 0; m < n_nodes; ++m)
          if (is_hourglass_mode(m))
            row -= work.dashpot[m][i] * work.x[m][j];
        for (unsigned int m = 1; m < n_nodes - 1; ++m)
          modes[m] += row * work.gradient[m][j] / work.volume;
      }
      expand_to_nodes(modes);
      for (unsigned int k = 0; k < n_nodes; ++k)
        force[k][i] = modes[k] / n_nodes;
    }
  }

private:
  static void to_modes(const Lanes (&values)[n_nodes][dim], Lanes (&modes)[n_nodes][dim])
  {
    for (unsigned int d = 0; d < dim; ++d)
    {
      Lanes component_values[n_nodes];
      for (unsigned int k = 0; k < n_nodes; ++k)
        component_values[k] = values[k][d] / n_nodes;
      sum_to_modes(component_values);
      for (unsigned int m = 0; m < n_nodes; ++m)
        modes[m][d] = component_values[m];
    }
  }

  /** Dashpot forces of hourglass modes, conjugate to their rates. */
  void resist(Work &work, const double factor, Lanes &power) const
  {
    Lanes squared_area = 0.; // (2 A)² of a mid-plane
    for (unsigned int d = 0; d < dim; ++d)
      squared_area += work.gradient[1][d] * work.gradient[1][d];
    const Lanes strength = factor * damping * impedance * n_nodes * square_root(squared_area);
    for (unsigned int m = 0; m < n_nodes; ++m)
      for (unsigned int i = 0; i < dim && is_hourglass_mode(m); ++i)
      {
        work.dashpot[m][i] = strength * work.rate[m][i];
        power += work.dashpot[m][i] * work.rate[m][i];
      }
  }

  double damping, impedance = 0;
};

template <int dim>
using PlainHexahedron = CellFormulation<dim, PlainElement<dim>>;

TOMBOLO_REGISTER_FOR_DIMENSIONS(Formulation, PlainHexahedron, "plain hexahedron",
                                "one point and dashpots against hourglass modes")
