// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/fully_integrated_hexahedron.h>
#include <tombolo/formulations/elements/lagrange_hexahedron.h>

namespace tombolo
{
  namespace
  {
    void declare_parameters(ParameterHandler &handler)
    {
      const Entries e(handler);
      e.integer("Degree", "2", between(1, 3),
                "Polynomial degree. All parts of a scene need nodes of the same degree.");
      declare<PartPoints>(handler, StrainMeasure::logarithmic);
      declare<ErosionCriterion>(e);
      declare<ConversionCriterion>(e);
    }

    /** One class a degree: the choice is made here, not in a loop. */
    template <int dim>
    std::unique_ptr<Formulation<dim>> create(const Section &section)
    {
      switch (section.get_unsigned("Degree"))
      {
      case 1:
        // The Gauss-Lobatto rule of degree 1 fails the patch test on distorted hexahedra, that of
        // Gauss passes it at the same cost.
        return std::make_unique<CellFormulation<dim, FullyIntegratedHexahedron<dim, false>>>(
            section);
      case 2:
        return std::make_unique<CellFormulation<dim, LagrangeHexahedron<dim, 2>>>(section);
      default:
        return std::make_unique<CellFormulation<dim, LagrangeHexahedron<dim, 3>>>(section);
      }
    }

    template <int dim>
    bool add_to_registry()
    {
      Registry<Formulation<dim>>::instance().add(
          "lagrange hexahedron",
          {"degree 1 to 3 with nodes at Gauss-Lobatto points and diagonal mass (spectral element)",
           &declare_parameters, &create<dim>});
      return true;
    }

    const bool is_registered = add_to_registry<2>() && add_to_registry<3>();
  } // namespace
} // namespace tombolo
