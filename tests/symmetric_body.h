// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "model_scene.h"

#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>

namespace tombolo
{
  namespace testing
  {
    /** A block, of which one or more planes of symmetry leave a piece. */
    struct SymmetricBlock
    {
      std::string lower, upper, cells;
      std::string planes; ///< predicates, separated by commas
    };

    struct Method
    {
      const char *smoothing;
      const char *bridge = "";    ///< of a block that is half elements; empty: all particles
      const char *filter = "0";   ///< power
      bool is_loaded = false;     ///< pulled at one end, clamped at the other
      const char *rebuild = "17"; ///< interval, or "never": then shape functions are cell averages
      unsigned int n_steps = 300;
      /** Entries of smoothed particles of metal, instead of the others; null: those. */
      const char *smoothed_entries = nullptr;
    };

    inline std::ostream &operator<<(std::ostream &out, const Method &method)
    {
      return out << method.smoothing << (method.bridge[0] != '\0' ? ", coupled by bridge " : "")
                 << method.bridge << ", filter " << method.filter
                 << (method.is_loaded ? ", pulled and clamped" : "") << ", rows renewed "
                 << method.rebuild
                 << (method.smoothed_entries == nullptr
                         ? ""
                         : std::string(", smoothed particles: ") + method.smoothed_entries);
    }

    inline std::string material_of(const Method &method)
    {
      const std::string elastic =
          "set Density = 2\nset Young's modulus = 3\nset Poisson's ratio = 0.3\n";
      return "subsection Material: m\n" +
             (method.smoothed_entries == nullptr
                  ? "set Model = elastic\nsubsection elastic\n" + elastic
                  : "set Model = j2 plasticity\nsubsection j2 plasticity\n" + elastic +
                        "set Flow stress = linear hardening\nsubsection linear hardening\n"
                        "set Yield stress = 0.05\nset Hardening modulus = 0.1\nend\n") +
             "end\nend\n";
    }

    inline std::string particles_of(const Method &method)
    {
      const bool is_smoothed = method.smoothed_entries != nullptr;
      const std::string name = is_smoothed ? "smoothed particle" : "momentum consistent particle";
      std::string entries = is_smoothed ? method.smoothed_entries
                                        : std::string("set Smoothing = ") + method.smoothing;
      if (!is_smoothed && method.rebuild != std::string("never"))
        entries += "\nset Configuration = updated Lagrangian\nset Rebuild interval = " +
                   std::string(method.rebuild);
      if (!is_smoothed && method.filter != std::string("0"))
        entries += "\nset Dilatation = of particles";
      return "set Formulation = " + name + "\nset Material = m\nsubsection " + name + "\n" +
             entries + "\nend\n";
    }

    inline std::string parameters_of(const SymmetricBlock &block, const Method &method,
                                     const unsigned int dim)
    {
      std::ostringstream text;
      const std::string last = dim == 2 ? "y" : "z";
      const bool is_coupled = method.bridge[0] != '\0';
      std::string names = method.is_loaded ? "pull, clamp" : "", sections;
      std::istringstream planes(block.planes);
      std::string plane;
      for (unsigned int p = 0; std::getline(planes, plane, ','); ++p)
      {
        names += (names.empty() ? "" : ", ") + ("plane " + std::to_string(p));
        sections += "subsection Condition: plane " + std::to_string(p) +
                    "\nset Type = symmetry\nset Where = " + plane + "\nend\n";
      }
      if (method.is_loaded)
        sections +=
            "subsection Condition: pull\nset Type = traction\nset Where = " + last +
            " > 1.49\nset Function = 0.01 * x * t; " + (dim == 2 ? "" : "0.03 * y * (1 - y^2); ") +
            "0.06 * (1 + x^2)\nend\nsubsection Condition: clamp\nset Type = clamp\nset Where "
            "= " +
            last + " < 1e-9\nend\n";
      text << "set Dimension = " << dim
           << "\nset Materials = m\nset Parts = " << (is_coupled ? "a, b" : "b")
           << "\nset Conditions = " << names << "\n"
           << sections
           << "subsection Mesh\nset Type = box\nsubsection box\nset Lower corner = " << block.lower
           << "\nset Upper corner = " << block.upper << "\nset Cells = " << block.cells
           << "\nend\nend\n";
      if (is_coupled)
        text << "subsection Part: a\nset Cells = " << last
             << " < 0.75\nset Formulation = fully integrated hexahedron\nset Material = m\nend\n";
      text << "subsection Part: b\nset Cells = " << (is_coupled ? "otherwise" : "all") << "\n"
           << particles_of(method) << "end\n"
           << material_of(method);
      if (is_coupled)
        text << "subsection Coupling\nset Bridge = " << method.bridge << "\nend\n";
      if (method.filter != std::string("0"))
        text << "subsection Lattice filter\nset Power = " << method.filter << "\nend\n";
      return text.str();
    }

    template <int dim>
    class Body : public ModelScene<dim>
    {
    public:
      using ModelScene<dim>::model;

      Body(const SymmetricBlock &block, const Method &method)
          : ModelScene<dim>(parameters_of(block, method, dim)), n_steps(method.n_steps)
      {}

      /** A velocity that is symmetric in the planes x = 0 and y = 0 and, in three dimensions, in
       * all z = 0, 1, 2 ... */
      void set_velocity(const double amplitude)
      {
        NodalVector &v = model->state.unsmoothed_velocity;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
        {
          const double *const x = model->state.initial_position.node(i);
          const double wave = dim == 2 ? 1. : std::cos(M_PI * x[2]);
          v.node(i)[0] =
              -amplitude * std::sin(1.1 * x[0]) * (1. + 0.4 * std::cos(2. * x[1])) * wave;
          v.node(i)[1] = amplitude * std::sin(1.4 * x[1]) * std::cos(0.8 * x[0]);
          if (dim == 3)
            v.node(i)[2] = -amplitude * std::sin(M_PI * x[2]) *
                           (1. + 0.5 * std::cos(1.7 * x[0]) * x[1] * x[1]);
        }
        model->conditions->prescribe_initial_velocity(model->state, 0., 1e-3);
        v.update_ghosts();
      }

      void run(const double time_step)
      {
        clock.next_step = time_step;
        for (unsigned int n = 0; n < n_steps; ++n)
        {
          n_rebuilds += step->evaluate(clock).stencils ? 1 : 0;
          step->complete(clock);
          step->advance(clock);
          clock.advance();
        }
        step->evaluate(clock);
        step->complete(clock);
      }

      EnergyBalance balance()
      {
        return ledger.balance(*model, clock);
      }

      bool images_have_ghosts_as_sources() const
      {
        const NodePartition &partition = *model->state.partition();
        bool result = false;
        for (const auto &image : partition.images())
          result = result || image.source >= partition.n_owned();
        return dealii::Utilities::MPI::max(result ? 1 : 0, MPI_COMM_WORLD) == 1;
      }

      using PositionKey = std::array<long, 3>;
      using Records = std::map<PositionKey, std::vector<double>>;

      static PositionKey key_of(const double *x)
      {
        return {{std::lround(1e6 * x[0]), std::lround(1e6 * x[1]),
                 dim == 3 ? std::lround(1e6 * x[2]) : 0}};
      }

      /** Of all nodes, by their initial position; the same on all ranks. */
      Records values_at_nodes(const std::vector<const NodalVector *> &fields) const
      {
        std::map<PositionKey, std::vector<double>> local;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
        {
          std::vector<double> &record = local[key_of(model->state.initial_position.node(i))];
          for (const NodalVector *field : fields)
            record.insert(record.end(), field->node(i),
                          field->node(i) + (field->n_slots_per_node() == 1 ? 1 : dim));
        }
        return gather(local);
      }

      Records stresses() const
      {
        std::map<PositionKey, std::vector<double>> local;
        for (const Part<dim> &part : model->parts)
        {
          const auto &point_positions = part.formulation->initial_point_positions();
          for (unsigned int i = 0; i < point_positions.size(); ++i)
          {
            double x[3] = {};
            for (unsigned int d = 0; d < dim; ++d)
              x[d] = point_positions[i][d];
            // The padding of the last batch of cells repeats a point.
            std::vector<double> &record = local[key_of(x)];
            if (!record.empty())
              continue;
            for (unsigned int c = 0; c < 6; ++c)
              record.push_back(part.formulation->points().component(MaterialPoints::stress, c)[i]);
          }
        }
        return gather(local);
      }

      static Records gather(const Records &local)
      {
        Records result;
        for (const auto &records : dealii::Utilities::MPI::all_gather(
                 MPI_COMM_WORLD, std::vector<std::pair<PositionKey, std::vector<double>>>(
                                     local.begin(), local.end())))
          result.insert(records.begin(), records.end());
        return result;
      }

      unsigned int n_steps;
      unsigned int n_rebuilds = 0;
      EnergyLedger ledger;
      std::unique_ptr<MechanicalStep<dim>> step = std::make_unique<MechanicalStep<dim>>(*model);
      Clock clock;
    };

    /** Largest difference over the records of a piece, over the largest value of the whole. */
    template <typename Records>
    double difference(const Records &piece, const Records &whole)
    {
      double largest = 0, scale = 0;
      for (const auto &[key, values] : piece)
      {
        const auto found = whole.find(key);
        if (found == whole.end() || found->second.size() != values.size())
          return 1e300;
        for (std::size_t k = 0; k < values.size(); ++k)
        {
          largest = std::max(largest, std::abs(values[k] - found->second[k]));
          scale = std::max(scale, std::abs(found->second[k]));
        }
      }
      return piece.empty() ? 1e300 : largest / scale;
    }

    const SymmetricBlock whole_3d{"-1, -0.75, 0", "1, 0.75, 1.5", "8, 6, 6", ""};
    const SymmetricBlock half_3d{"0, -0.75, 0", "1, 0.75, 1.5", "4, 6, 6", "x < 1e-9"};
    const SymmetricBlock other_half_3d{"-1, -0.75, 0", "0, 0.75, 1.5", "4, 6, 6", "x > -1e-9"};
    const SymmetricBlock quarter_3d{"0, 0, 0", "1, 0.75, 1.5", "4, 3, 6", "x < 1e-9, y < 1e-9"};
    const SymmetricBlock whole_2d{"-1, 0", "1, 1.5", "12, 8", ""};
    const SymmetricBlock half_2d{"0, 0", "1, 1.5", "6, 8", "x < 1e-9"};
  } // namespace testing
} // namespace tombolo
