// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/registry.h>
#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/contact/surfaces/rigid_translation.h>
#include <tombolo/state/nodal_vector.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class PartSurface;

  /** A surface that bodies come into contact with: a plug-in, `set Surface = ...` in a
   * section "Contact: NAME". Known to every rank as a whole. */
  template <int dim>
  class ContactSurface
  {
  public:
    virtual ~ContactSurface() = default;

    /** Reads the files of the surface, before all that follows. Throws InputError. Collective. */
    virtual void load(MPI_Comm) {}

    /** The text about the surface in the audit; empty if its entries are enough. */
    virtual std::string description() const
    {
      return "";
    }

    /** What was repaired in its files: sentences. */
    virtual std::vector<std::string> remarks() const
    {
      return {};
    }

    /** The signed distance of nodes to the surface at @p time, positive outside of the rigid body
     * [L]; gap[k] is that of node nodes[k]. One call per step, for all candidates. */
    virtual void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                               double time, std::vector<double> &gap) const = 0;

    /** From now on gaps up to this distance [L] outside of the body are exact as well, and so are
     * the normals there; beyond it a gap may be any positive number below the true one. */
    virtual void set_reach(double /*distance*/) {}

    /** The unit normal at the point of the surface next to @p point, out of the rigid body. */
    virtual dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point,
                                          double time) const = 0;

    /** How far the point of the rigid body that is at @p point moves from time @p from to time @p
     * to [L], in the direction of the middle of the time. */
    virtual dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, double from,
                                          double to) const = 0;

    /** The reference point of torques of the surface at @p time [L]. */
    virtual dealii::Tensor<1, dim> reference_point(double time) const = 0;

    /** The surface at @p time, for pictures; of one without end the part next to the box from
     * @p low to @p high, in which the bodies are. Empty where a surface cannot be drawn. */
    virtual FacetList<dim> picture(double /*time*/, const dealii::Tensor<1, dim> & /*low*/,
                                   const dealii::Tensor<1, dim> & /*high*/) const
    {
      return {};
    }

    /** Moves candidates of which @p slides is positive and whose gap @p from (positions) was
     * negative along the normal of the surface until it is as it was; where @p slides is less than
     * one, only if the surface of the body and this one differ in slope by little. Moves others
     * with a negative gap out of the surface. Marks those with a gap that is or was negative in @p
     * is_bound. */
    void push_out(const std::vector<unsigned int> &candidates, const std::vector<double> &was,
                  const std::vector<double> &gap, const double time, const NodalVector &slides,
                  const NodalVector &from, NodalVector &position, NodalVector &is_bound) const
    {
      constexpr double clearance = 1e-6, largest_slope = 0.3;
      for (std::size_t k = 0; k < candidates.size(); ++k)
      {
        if (!(was[k] < 0. || gap[k] < 0.) || !(*slides.node(candidates[k]) > 0.))
          continue;
        *is_bound.node(candidates[k]) = 1.;
        double *const x = position.node(candidates[k]);
        // Beyond the surface by some of its way: on it, round-off would decide whether a node
        // touches.
        double excess = -(1. + clearance) * gap[k];
        if (was[k] < 0.)
        {
          // Faces are chords of a round surface, and beside the last node that touches they go away
          // from it: what touched it touches it still.
          const double along =
              (vector_of<dim>(x) - vector_of<dim>(from.node(candidates[k]))).norm();
          const bool may_leave = *slides.node(candidates[k]) < 1.;
          excess = may_leave && gap[k] - was[k] > largest_slope * along ? 0. : was[k] - gap[k];
        }
        const dealii::Tensor<1, dim> way = excess * normal(vector_of<dim>(x), time);
        for (unsigned int d = 0; d < dim; ++d)
          x[d] += way[d];
      }
    }

    /** The translation of the surface as a whole: a contact advances it where it has a mass, and
     * evaluate_gaps() and the others must follow its displacement. */
    virtual RigidTranslation<dim> &translation() = 0;

    /** The same surface where it is the boundary of a part of the scene, else null. */
    virtual PartSurface<dim> *part_surface()
    {
      return nullptr;
    }
  };

  /** -∂f/∂x of a force f along the normal of @p surface at @p point, where the normal turns with
   * the point: by differences over @p way. */
  template <int dim>
  dealii::Tensor<2, dim>
  curvature_stiffness(const ContactSurface<dim> &surface, const dealii::Tensor<1, dim> &point,
                      const double force, const double time, const double way)
  {
    dealii::Tensor<2, dim> result;
    for (unsigned int b = 0; b < dim; ++b)
    {
      dealii::Tensor<1, dim> step;
      step[b] = way;
      const dealii::Tensor<1, dim> difference =
          surface.normal(point + step, time) - surface.normal(point - step, time);
      for (unsigned int a = 0; a < dim; ++a)
        result[a][b] = -force * difference[a] / (2. * way);
    }
    return result;
  }

  template <int dim>
  struct PluginKind<ContactSurface<dim>>
  {
    static constexpr const char *name = "contact surface";
  };
} // namespace tombolo
