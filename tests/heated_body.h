// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "model_scene.h"
#include "nodal_fields.h"

#include <tombolo/physics/heat/thermal_step.h>

#include <deal.II/base/mpi.h>

#include <memory>
#include <ostream>
#include <sstream>
#include <string>

namespace tombolo
{
  namespace testing
  {
    /** A disordered box of dimension dim: elements below x = 1, particles above, or one of them. */
    struct HeatedMethod
    {
      const char *parts; ///< "elements", "particles" or "coupled"
      const char *smoothing = "affine";
      const char *bridge = "paper";
      const char *element = "fully integrated hexahedron";
      bool has_tables = false; ///< properties that depend on the temperature
      const char *integration = "explicit";
      const char *mesh_options = ""; ///< lines for the section Mesh
    };

    inline std::ostream &operator<<(std::ostream &out, const HeatedMethod &method)
    {
      return out << method.parts << " " << method.smoothing << " " << method.bridge << " "
                 << method.element << (method.has_tables ? " tables " : " ") << method.integration;
    }

    template <int dim>
    std::string parameters_of(const HeatedMethod &method, const std::string &conditions)
    {
      const std::string parts = method.parts;
      const bool has_elements = parts != "particles", has_particles = parts != "elements";
      std::ostringstream text;
      std::string names;
      std::istringstream lines(conditions);
      for (std::string line; std::getline(lines, line);)
        if (line.rfind("subsection Condition: ", 0) == 0)
          names += (names.empty() ? "" : ", ") + line.substr(22);
      text << "set Dimension = " << dim << "\nset Materials = m, n\nset Conditions = " << names
           << "\nset Parts = " << (has_elements ? "a" : "")
           << (has_elements && has_particles ? ", " : "") << (has_particles ? "b" : "") << "\n"
           << conditions << "subsection Mesh\nset Type = box\n"
           << method.mesh_options << "subsection box\nset Upper corner = 2, 1"
           << (dim == 3 ? ", 1" : "") << "\nset Cells = 12, 6" << (dim == 3 ? ", 6" : "")
           << "\nset Disorder = 0.15\nend\nend\n";
      if (has_elements)
        text << "subsection Part: a\nset Cells = " << (has_particles ? "x < 1" : "all")
             << "\nset Formulation = " << method.element << "\nset Material = m\n"
             << (std::string(method.element) == "lagrange hexahedron"
                     ? "subsection lagrange hexahedron\nset Degree = 3\nend\n"
                     : "")
             << "end\n";
      if (has_particles)
        text << "subsection Part: b\nset Cells = " << (has_elements ? "otherwise" : "all")
             << "\nset Formulation = momentum consistent particle\nset Material = n\n"
                "subsection momentum consistent particle\nset Smoothing = "
             << method.smoothing << "\nend\nend\n";
      // A material that no part uses would be an input that does nothing; both are read here.
      for (const char *const material : {"m", "n"})
        text << "subsection Material: " << material
             << "\nset Model = heat conductor\nsubsection heat conductor\nset Density = "
             << (material[0] == 'm' ? "2" : "3")
             << "\nend\nsubsection Heat\nset Initial temperature = 5\n"
             << (method.has_tables
                     ? "set Specific heat capacity = 0: 2, 10: 3, 20: 8\nset Conductivity = 0: "
                       "0.3, 10: 0.6, 15: 0.2\n"
                     : (material[0] == 'm' ? "set Specific heat capacity = 2\nset Conductivity = "
                                             "0.3\n"
                                           : "set Specific heat capacity = 0.5\nset Conductivity "
                                             "= 0.7\n"))
             << "end\nend\n";
      text << "subsection Coupling\nset Bridge = " << method.bridge
           << "\nend\nsubsection Heat\nset Absolute zero = -3\nset Time integration = "
           << method.integration << "\n";
      if (std::string(method.integration) != "explicit")
        text << "subsection " << method.integration << "\nset Step = 0.05\nend\n";
      text << "end\n";
      return text.str();
    }

    template <int dim>
    class HeatedBody : public ModelScene<dim>
    {
    public:
      using ModelScene<dim>::model;
      HeatedBody(const HeatedMethod &method, const std::string &conditions = "")
          : ModelScene<dim>(parameters_of<dim>(method, conditions))
      {}

      ThermalModel<dim> &heat()
      {
        return *model->heat;
      }

      NodalVector vector(const Quantity quantity = Quantity::scalars) const
      {
        return NodalVector(model->state.partition(), quantity);
      }

      /** Sets θ̂ and the enthalpy. */
      template <typename Function>
      void set_temperature(const Function &function)
      {
        ThermalState &state = heat().state;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
        {
          const double value = function(model->state.initial_position.node(i));
          *state.unsmoothed_temperature.node(i) = value;
          *state.enthalpy.node(i) = heat().nodal_enthalpy.enthalpy(i, value);
        }
      }

      double product(const NodalVector &a, const NodalVector &b) const
      {
        double local = 0;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
          local += *a.node(i) * *b.node(i);
        return dealii::Utilities::MPI::sum(local, MPI_COMM_WORLD);
      }

      std::unique_ptr<ThermalStep<dim>> step =
          std::make_unique<ThermalStep<dim>>(this->parameters.section("Heat"));
    };
  } // namespace testing
} // namespace tombolo
