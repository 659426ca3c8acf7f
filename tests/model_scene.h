// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/step_size.h>

#include <memory>
#include <string>

namespace tombolo
{
  namespace testing
  {
    /** A model that is read from text as from a parameter file, which may have a section "Time
     * step". */
    template <int dim>
    class ModelScene
    {
    public:
      explicit ModelScene(const std::string &text, const MPI_Comm communicator = MPI_COMM_WORLD)
          : parameters(communicator)
      {
        parameters.read_text(text, "test.prm");
        declare_model<dim>(parameters);
        declare_section<StepSize<dim>>(parameters, "Time step");
        parameters.assign();
        model = std::make_unique<Model<dim>>(parameters, communicator);
      }

      Parameters parameters;
      std::unique_ptr<Model<dim>> model;
    };

    template <int dim>
    std::unique_ptr<Model<dim>> make_model(const std::string &text)
    {
      return std::move(ModelScene<dim>(text).model);
    }
  } // namespace testing
} // namespace tombolo
