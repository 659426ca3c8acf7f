// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/surface_damping.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/state/dependent_nodes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
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
  } // namespace

  template <int dim>
  SurfaceDamping<dim>::SurfaceDamping(const double coefficient, const Model<dim> &model)
      : damping(this->actions.add("surface damping", ActsAt::nodes))
  {
    this->roles.rest = ProcessRole::is_idle;
    damping.books("surface damping", EnergyKind::artificial);
    for (const ParticleFormulation<dim> *const particles : model.particle_parts())
    {
      const Material &material = particles->material();
      if (material.remembers("effective plastic strain"))
        continue;
      // A nearly incompressible body is not to be held by its speed of sound.
      const double impedance =
          material.inertial_density() *
          std::min(material.longitudinal_wave_speed(), 2. * material.shear_wave_speed());
      for (const SurfaceFibre &fibre : particles->surface_fibres())
        fibres.push_back({fibre.node, coefficient * impedance * fibre.length * fibre.volume});
    }
  }

  template <int dim>
  void SurfaceDamping<dim>::model_changed(const Model<dim> &model)
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

  template <int dim>
  void SurfaceDamping<dim>::add_to(const NodalVector &position, const NodalVector &velocity,
                                   NodalVector &result) const
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

  template <int dim>
  void SurfaceDamping<dim>::linearize(const Model<dim> &model, const Clock &, Tangent<dim> &tangent)
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

  namespace
  {
    constexpr const char *surface_section_name = "Surface damping";

    template <int dim>
    class SurfaceDampingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        const Entries e = Entries(parameters.handler()).subsection(surface_section_name);
        e.number(
            "Coefficient", "0.3", between(0., 1.), "",
            "b of the viscosity b ρ c h between the layers at the surface of particles whose shape "
            "functions are cell averages: it takes away the oscillation of the outermost layer "
            "that a sudden load leaves there. Materials that flow are left alone. 0: there is "
            "none. The stable step of particles alone is 6 to 9 % longer without it.");
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        for (const Part<dim> &part : parts)
          if (part.particles != nullptr && part.material->has_mechanics())
            parameters.section(surface_section_name)
                .get_double("Coefficient"); // this scene reads it
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const double coefficient =
            parameters.section(surface_section_name).get_double("Coefficient");
        if (!model.has_mechanics || coefficient == 0.)
          return nullptr;
        auto process = std::make_unique<SurfaceDamping<dim>>(coefficient, model);
        if (Utilities::MPI::max(process->has_fibres() ? 1 : 0, model.communicator) == 0)
          return nullptr;
        return process;
      }
    };
  } // namespace

  template class SurfaceDamping<2>;
  template class SurfaceDamping<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(SurfaceDampingKind, process_order::damping)
} // namespace tombolo
