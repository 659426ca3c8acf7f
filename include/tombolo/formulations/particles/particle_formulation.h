// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/smoothing_settings.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/patch_test.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

namespace tombolo
{
  /** A line from a node on the surface through the two next ones inside, along edges of cells. */
  struct SurfaceFibre
  {
    std::array<dealii::types::global_dof_index, 3> node; ///< from the surface inwards
    double volume; ///< that the cell at the surface has around the first node [L^dim]
    double length; ///< of its edge between the first two nodes [L]
  };

  template <int dim>
  class Bonds;

  template <int dim>
  class PairInteractions;

  template <int dim>
  class SelfContact;

  /** Numbers of neighbours of the particles of a part, for the audit. */
  struct NeighbourCounts
  {
    unsigned int minimum = 0;
    double mean = 0;
    unsigned int maximum = 0;
  };

  /**
   * A formulation whose material points are the nodes of its cells: what the bridge needs of it
   * beyond Formulation. A particle method has a set of particles and stencils; what follows from
   * them has a default here, that of a method without smoothing.
   */
  template <int dim>
  class ParticleFormulation : public Formulation<dim>
  {
  public:
    virtual const ParticleSet<dim> &particle_set() const = 0;

    /** The rows, one a particle; update_neighbourhoods() and set_partition() change them. */
    virtual const Stencils &stencils() const = 0;
    virtual Stencils &stencils() = 0;

    /** Until the next call, apply_elastic_stiffness() is called with this position alone; null:
     * with any, and all is as before. What depends on the position is computed once. */
    virtual void hold_position(const NodalVector * /* position */) {}

    const char *phase() const override
    {
      return "particle forces";
    }
    ParticleFormulation *as_particles() override
    {
      return this;
    }
    const std::vector<unsigned int> &particle_nodes() const override
    {
      return stencils().particle_node;
    }

    /** The interactions of particles in pairs; null: none. */
    virtual const PairInteractions<dim> *pairs() const
    {
      return nullptr;
    }

    /** How the bridge smooths velocities by the rows; by default not at all. */
    virtual SmoothingSettings smoothing() const
    {
      SmoothingSettings none;
      none.is_active = false;
      return none;
    }

    /** Smallest initial distance between neighbouring particles over this rank [L]. */
    virtual double smallest_spacing() const
    {
      return particle_set().smallest_spacing();
    }

    /** Whether forces follow from positions, which a velocity that is changed after the motion does
     * not move, and not from velocities alone. */
    virtual bool follows_positions() const
    {
      return false;
    }

    /** Present support half width of particle @p i [L]. */
    virtual dealii::Point<dim> support(unsigned int i) const = 0;

    /** Over this rank's particles: neighbours with φ ≠ 0. */
    virtual NeighbourCounts neighbour_counts() const
    {
      return count_neighbours([](const Stencils::Row &row, const unsigned int k)
                              { return row.value[k] != 0.; });
    }

    /** F of particle @p i from the start to @p position (current ghosts), for pictures. */
    virtual dealii::Tensor<2, dim> deformation(unsigned int i,
                                               const NodalVector &position) const = 0;

    unsigned int degree() const override
    {
      return 0;
    }
    /** Of Stencils::mass. */
    void add_mass(NodalVector &mass) const override
    {
      const Stencils &shape = stencils();
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        *mass.node(shape.particle_node[i]) += shape.mass[i];
    }
    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &points) const override
    {
      const Stencils &shape = stencils();
      points.resize(shape.n_particles());
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        points[i] = point_of<dim>(position.node(shape.particle_node[i]));
    }
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return particle_set().initial_positions();
    }
    unsigned int n_cells() const override
    {
      return 0;
    }
    unsigned int n_points_per_cell() const override
    {
      return 0;
    }

    /** Makes the nodes of the cells of @p is_taken particles, those of the cells that it took
     * before among them, while the run goes on. Where nodes of new cells are particles already,
     * these gain mass and the mean of both states, by volume. @p position has current ghosts; @p
     * state is that of the new cells. Null when a checkpoint is read: the state follows. @p volumes
     * are the initial ones of all particles at owned nodes [L^dim]; null: those of the mesh.
     * Afterwards other nodes are needed than before, as when update_neighbourhoods() finds other
     * neighbours. Only where can_add_particles() and PartSetup::source is given. Collective. */
    virtual void add_particles(const CellSelection<dim> & /*is_taken*/,
                               const NodalVector & /*position*/, const StateTransfer * /*state*/,
                               const NodalVector * /*volumes*/)
    {}

    /** Whether its particles are neighbours of those of other bodies of the mesh, too. */
    virtual bool reaches_other_bodies() const
    {
      return false;
    }

    virtual bool can_add_particles() const
    {
      return false;
    }

    /** Its bonds; null: none can break. */
    virtual Bonds<dim> *breaking_bonds()
    {
      return nullptr;
    }

    /** Contact between its fragments; null: there is none. */
    virtual SelfContact<dim> *fragment_contact()
    {
      return nullptr;
    }

    /** Sets what update_neighbourhoods() calls before shape functions change, on all ranks. */
    virtual void set_before_change(const std::function<void()> & /*before_change*/) {}

    /** The shape functions, for the audit; empty: the name of the formulation is enough. */
    virtual std::string shape_functions() const
    {
      return {};
    }

    /** Lines at the surface that can oscillate by themselves (SurfaceDamping), of this rank. */
    virtual const std::vector<SurfaceFibre> &surface_fibres() const
    {
      static const std::vector<SurfaceFibre> none;
      return none;
    }

    /** Of the rows at the start, at initial positions (current ghosts). Collective. */
    virtual PatchTest patch_test(const NodalVector & /*position*/) const
    {
      return {};
    }

  protected:
    /** Of neighbours for which is_neighbour(row, k) holds. */
    template <typename IsNeighbour>
    NeighbourCounts count_neighbours(const IsNeighbour &is_neighbour) const
    {
      NeighbourCounts counts;
      const unsigned int n_rows = stencils().n_particles();
      for (unsigned int i = 0; i < n_rows; ++i)
      {
        const Stencils::Row row = stencils().row(i);
        unsigned int n = 0;
        for (unsigned int k = 0; k < row.size; ++k)
          n += is_neighbour(row, k) ? 1 : 0;
        counts.minimum = i == 0 ? n : std::min(counts.minimum, n);
        counts.maximum = std::max(counts.maximum, n);
        counts.mean += n;
      }
      counts.mean /= std::max(n_rows, 1u);
      return counts;
    }
  };
} // namespace tombolo
