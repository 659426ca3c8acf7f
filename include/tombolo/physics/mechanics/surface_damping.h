// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/model/tangent.h>
#include <tombolo/state/dependent_nodes.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Viscosity at the surface of particles whose shape functions are cell averages. Their outermost
   * layer has a mode of its own: it is half as heavy as the others and as stiff, so that it
   * oscillates faster than any wave of the layers inside, which therefore cannot remove the energy
   * of a sudden load from it. A fibre from a node I on the surface through the next nodes A and B
   * inside, with the rate
   *
   * @verbatim
   *   r = e_IA · (v_I - v_A) / l_IA - e_AB · (v_A - v_B) / l_AB
   * @endverbatim
   *
   * of the difference of its two stretches, dissipates η V r² with η = b ρ h min(c_P, 2 c_S): the
   * mode vanishes within some ten spacings, while the loss of waves grows only with the fourth
   * power of their number. Forces are along the edges: linear and angular momentum are those
   * without it, and a rigid motion makes none. Materials that flow plastically have none of it:
   * their flow damps the mode, and the stresses by a viscosity of elastic impedance would be as
   * large as their yield stress. b is the entry `Coefficient` of the section `Surface damping`.
   */
  template <int dim>
  class SurfaceDamping : public Process<dim>
  {
  public:
    SurfaceDamping(const double coefficient, const Model<dim> &model)
        : damping(this->actions.add("surface damping", ActsAt::nodes))
    {
      this->roles.rest = ProcessRole::is_idle;
      damping.books("surface damping", EnergyKind::artificial);
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
      {
        const Material &material = particles->material();
        if (material.remembers("effective plastic strain"))
          continue;
        // The speed of sound would damp a nearly incompressible body too much.
        const double impedance =
            material.inertial_density() *
            std::min(material.longitudinal_wave_speed(), 2. * material.shear_wave_speed());
        for (const SurfaceFibre &fibre : particles->surface_fibres())
          fibres.push_back({fibre.node, coefficient * impedance * fibre.length * fibre.volume});
      }
    }

    void model_changed(const Model<dim> &model) override
    {
      const auto &partition = model.state.partition();
      viscous_force.reinit(partition);
      local.clear();
      for (const Fibre &fibre : fibres)
      {
        auto &nodes = local.emplace_back();
        for (unsigned int k = 0; k < 3; ++k)
          nodes[k] = partition->local_index(fibre.node[k]);
      }
      touched = owned_marked_nodes(partition,
                                   [&](const auto &mark)
                                   {
                                     for (const auto &nodes : local)
                                       std::for_each(nodes.begin(), nodes.end(), mark);
                                   });
      touched = with_nodes_depended_on(partition, touched);
    }

    void add_forces(const Model<dim> &model, const Clock &, const NodalVector &) override
    {
      damping.touched_nodes() = touched;
      add_to(model.state.position, model.state.velocity, damping.at_touched_nodes());
    }

    void linearize(const Model<dim> &model, const Clock &, Tangent<dim> &tangent) override
    {
      if (tangent.velocity == nullptr)
        return;
      for (const unsigned int node : touched)
        std::fill_n(viscous_force.node(node), node_stride, 0.);
      add_to(model.state.position, *tangent.velocity, viscous_force);
      viscous_force.collect();
      for (const unsigned int node : touched)
        for (unsigned int d = 0; d < dim; ++d)
          tangent.force->node(node)[d] -= tangent.factor * viscous_force.node(node)[d];
    }

    static void declare_parameters(Parameters &parameters)
    {
      read(Entries(parameters.handler()).subsection(section_name));
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      for (const Part<dim> &part : parts)
        if (part.particles != nullptr && part.material->has_mechanics())
          read(parameters.section(section_name)); // marks it as read
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const double coefficient = read(parameters.section(section_name));
      if (!model.has_mechanics || coefficient == 0.)
        return nullptr;
      auto process = std::make_unique<SurfaceDamping>(coefficient, model);
      if (dealii::Utilities::MPI::max(process->fibres.size(), model.communicator) == 0)
        return nullptr;
      return process;
    }

  private:
    static constexpr const char *section_name = "Surface damping";
    static double read(const Entries &e)
    {
      return e.number(
          "Coefficient", "0.3", between(0., 1.), "",
          "b of the viscosity b ρ c h between the layers at the surface of particles whose shape "
          "functions are cell averages: it takes away the oscillation of the outermost layer "
          "that a sudden load leaves there. Materials that flow are left alone. 0: there is "
          "none. The stable step of particles alone is 6 to 9 % longer without it.");
    }

    /** The unit vector from @p b to @p a over their distance, and the rate of stretch along it. */
    struct Edge
    {
      Edge(const double *a, const double *b, const double *velocity_a, const double *velocity_b)
      {
        double square = 0;
        for (unsigned int d = 0; d < 3; ++d)
        {
          direction[d] = a[d] - b[d];
          square += direction[d] * direction[d];
        }
        for (unsigned int d = 0; d < 3; ++d)
        {
          direction[d] /= square;
          rate += direction[d] * (velocity_a[d] - velocity_b[d]);
        }
      }

      double direction[3];
      double rate = 0;
    };

    struct Fibre
    {
      std::array<dealii::types::global_dof_index, 3> node;
      double viscosity; ///< η V [M L^2/T]
    };

    /** Adds -C @p velocity at @p position to local nodes. */
    void add_to(const NodalVector &position, const NodalVector &velocity, NodalVector &result) const
    {
      for (std::size_t f = 0; f < fibres.size(); ++f)
      {
        const auto &[i, a, b] = local[f];
        const Edge outer(position.node(i), position.node(a), velocity.node(i), velocity.node(a));
        const Edge inner(position.node(a), position.node(b), velocity.node(a), velocity.node(b));
        const double force = fibres[f].viscosity * (outer.rate - inner.rate);
        for (unsigned int d = 0; d < 3; ++d)
        {
          result.node(i)[d] -= force * outer.direction[d];
          result.node(a)[d] += force * (outer.direction[d] + inner.direction[d]);
          result.node(b)[d] -= force * inner.direction[d];
        }
      }
    }

    std::vector<Fibre> fibres;
    std::vector<std::array<unsigned int, 3>> local; ///< nodes of each fibre
    std::vector<unsigned int> touched; ///< owned nodes of fibres of any rank, ascending
    NodalVector viscous_force;         ///< buffer of linearize()
    Action &damping;
  };
} // namespace tombolo
