// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "model_scene.h"
#include "nodal_fields.h"
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    using namespace dealii;

    constexpr double young = 2., poisson = 0.25;

    /** A plate of particles whose bonds break where the principal stress reaches 0.9 and a pair is
     * stretched by more than 1 %. */
    struct Plate
    {
      std::string cells = "7, 4";
      std::string lower = "0, 0";
      std::string options;
      std::string smoothing = "affine";
      std::string bridge; ///< elements where x < 2; empty: all particles
      std::string conditions;
      bool has_heat = false; ///< with a capacity that depends on the temperature
    };

    inline std::string text_of(const Plate &plate)
    {
      const bool is_coupled = !plate.bridge.empty();
      std::ostringstream text;
      text << "set Dimension = 2\nset Materials = m\nset Parts = " << (is_coupled ? "a, b" : "b")
           << "\n"
           << plate.conditions
           << "subsection Mesh\nset Type = box\nsubsection box\nset Lower corner = " << plate.lower
           << "\nset Upper corner = 7, 4\nset Cells = " << plate.cells << "\nend\nend\n"
           << "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 1\n"
           << "set Young's modulus = " << young << "\nset Poisson's ratio = " << poisson
           << "\nend\n"
           << (plate.has_heat ? "subsection Heat\nset Specific heat capacity = 0: 2, 1000: 4\n"
                                "set Conductivity = 0.1\nset Initial temperature = 300\nend\n"
                              : "")
           << "end\n";
      if (is_coupled)
        text << "subsection Coupling\nset Bridge = " << plate.bridge << "\nend\n"
             << "subsection Part: a\nset Cells = x < 2\nset Material = m\n"
             << "set Formulation = fully integrated hexahedron\nend\n";
      text << "subsection Part: b\nset Cells = " << (is_coupled ? "otherwise" : "all")
           << "\nset Material = m\nset Formulation = momentum consistent particle\n"
           << "subsection momentum consistent particle\nset Smoothing = " << plate.smoothing
           << "\nset Bond failure = principal stress\nset Steps between bond checks = 1\n"
           << "subsection principal stress\nset Limit = 0.9\nset Stretch = 1.01\nend\n"
           << plate.options << "\nend\nend\n";
      return text.str();
    }

    /** Particles on a lattice of spacing 1, whose stresses and positions a test sets. */
    class Body : public ModelScene<2>
    {
    public:
      using Site = std::array<long, 2>;

      explicit Body(const Plate &plate = {}) : ModelScene<2>(text_of(plate)) {}

      Part<2> &part()
      {
        return model->parts.back();
      }

      const Stencils &shape()
      {
        return part().particles->stencils();
      }

      /** Where a local node, image or not, was at the start. */
      Site site_of(const unsigned int node) const
      {
        const double *const x = model->state.initial_position.node(node);
        return {{std::lround(x[0]), std::lround(x[1])}};
      }

      void set_stress(const std::function<double(const Site &)> &stress)
      {
        MaterialPoints &points = part().formulation->points();
        for (unsigned int i = 0; i < shape().n_particles(); ++i)
          points.component(MaterialPoints::stress, 0)[i] =
              stress(site_of(shape().particle_node[i]));
      }

      void move(const std::function<Point<2>(const Point<2> &)> &motion)
      {
        NodalState &state = model->state;
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        {
          const double *const x = state.initial_position.node(i);
          const Point<2> to = motion({x[0], x[1]});
          for (unsigned int d = 0; d < 2; ++d)
            state.position.node(i)[d] = to[d];
        }
        state.position.update_ghosts();
        model->bridge->positions_have_changed();
      }

      void stretch(const double x, const double y)
      {
        move([&](const Point<2> &from) { return Point<2>(x * from[0], y * from[1]); });
      }

      /** Pairs with φ or ∇φ ≠ 0, of all ranks: the first is the row. */
      std::set<std::array<Site, 2>> pairs()
      {
        std::vector<std::array<Site, 2>> own;
        for (unsigned int i = 0; i < shape().n_particles(); ++i)
        {
          const Stencils::Row row = shape().row(i);
          for (unsigned int k = 0; k < row.size; ++k)
            if ((row.value[k] != 0. || row.gradient[3 * k] != 0. ||
                 row.gradient[3 * k + 1] != 0.) &&
                row.neighbour[k] != shape().particle_node[i])
              own.push_back({{site_of(shape().particle_node[i]), site_of(row.neighbour[k])}});
        }
        own = from_all_ranks(own, MPI_COMM_WORLD);
        return std::set<std::array<Site, 2>>(own.begin(), own.end());
      }

      BondCounts counts()
      {
        BondCounts result = part().particles->breaking_bonds()->counts();
        result.n_broken = Utilities::MPI::sum(result.n_broken, MPI_COMM_WORLD);
        result.n_debris = Utilities::MPI::sum(result.n_debris, MPI_COMM_WORLD);
        return result;
      }

      EnergyAccounts energies()
      {
        EnergyAccounts result = part().formulation->energies();
        result.sum_over_ranks(MPI_COMM_WORLD);
        return result;
      }

      /** Steps of 0.05; returns the time. */
      double run(const unsigned int n_steps)
      {
        Clock clock;
        clock.next_step = 0.05;
        for (unsigned int n = 0; n < n_steps; ++n)
        {
          step->evaluate(clock);
          step->complete(clock);
          step->advance(clock);
          clock.advance();
        }
        return clock.time;
      }

      EnergyLedger ledger;
      std::unique_ptr<MechanicalStep<2>> step = std::make_unique<MechanicalStep<2>>(*model);
    };
  } // namespace testing
} // namespace tombolo
