// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/patch_test_gradients.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr char gradient_documentation[] =
        "`automatic`: those of the shape functions. `moving least squares`: those, and not cell "
        "averages, which have gradients of their own. `consistent`: changed as little "
        "as it takes for a constant stress to make no force inside and that of its traction at the "
        "boundary (the linear patch test). Worth it on disordered and turned lattices, at clamps "
        "and interfaces; inside a lattice they are the same. Solved for at the start and at each "
        "renewal of the reference, after which the test is passed approximately. Results on other "
        "numbers of ranks then agree to the tolerance only.";
    constexpr char tolerance_documentation[] =
        "Consistent gradients: what may remain of the defect in the patch test, over the vector "
        "areas of the boundary. 1e-4 is enough for accuracy; 1e-10 takes ten times the iterations.";
  } // namespace

  template <int dim>
  void PatchTestGradients<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Gradient", "automatic",
                          Patterns::Selection("automatic|moving least squares|consistent"),
                          gradient_documentation);
    handler.declare_entry("Gradient tolerance", "1e-4", Patterns::Double(1e-12, 0.1),
                          tolerance_documentation);
  }

  template <int dim>
  PatchTestGradients<dim>::PatchTestGradients(const Section &section)
      : is_chosen(section.get("Gradient") == "consistent"),
        tolerance(section.get_double("Gradient tolerance"))
  {}

  template <int dim>
  bool PatchTestGradients<dim>::is_on() const
  {
    return is_chosen;
  }

  template <int dim>
  void PatchTestGradients<dim>::initialize(const PartSetup<dim> &setup,
                                           const ParticleSet<dim> &particles, const bool smooths)
  {
    boundary.initialize(setup);
    trace_bridge = setup.trace_bridge;
    smooths_velocity = smooths;
    has_unit_row.clear();
    for (const types::global_dof_index node : particles.nodes())
      has_unit_row.push_back(setup.prescribed_nodes.size() > 0 &&
                             setup.prescribed_nodes.is_element(node));
  }

  template <int dim>
  IndexSet PatchTestGradients<dim>::required_nodes() const
  {
    return boundary.required_nodes();
  }

  template <int dim>
  NodalVector PatchTestGradients<dim>::boundary_areas(const NodalVector &position,
                                                      const Stencils &shape) const
  {
    // A traction t enters the nodal forces as Φᵀ(t s), and so do the forces of elements with the
    // trace bridge; with the paper's they stay where they are. A prescribed particle, and any one
    // where nothing is smoothed, has a unit row of Φ. At lumped rows forces stay, too.
    const auto &partition = position.partition();
    NodalVector areas, target;
    areas.reinit(partition);
    target.reinit(partition);
    if (!smooths_velocity || shape.is_lumped)
      boundary.add_areas(position, target, target);
    else
      boundary.add_areas(position, areas, trace_bridge ? areas : target);
    areas.add_to_owners();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const double *const area = areas.node(shape.particle_node[i]);
      const auto add = [&](const unsigned int node, const double share)
      {
        for (unsigned int d = 0; d < dim; ++d)
          target.node(node)[d] += share * area[d];
      };
      if (has_unit_row[i])
        add(shape.particle_node[i], 1.);
      else if (std::any_of(area, area + dim,
                           [](const double component) { return component != 0.; }))
      {
        const Stencils::Row row = shape.row(i);
        for (unsigned int k = 0; k < row.size; ++k)
          add(row.neighbour[k], row.value[k]);
      }
    }
    target.add_to_owners();
    return target;
  }

  template <int dim>
  void PatchTestGradients<dim>::establish(const std::vector<double> &volume,
                                          const NodalVector &position, Stencils &shape)
  {
    constexpr unsigned int largest_n_iterations = 20000;
    result = ConsistentGradients<dim>::establish(volume, position, boundary_areas(position, shape),
                                                 tolerance, largest_n_iterations, shape);
  }

  template <int dim>
  double PatchTestGradients<dim>::defect(const std::vector<double> &volume,
                                         const NodalVector &position, const Stencils &shape) const
  {
    return ConsistentGradients<dim>::defect(volume, boundary_areas(position, shape), shape);
  }

  template <int dim>
  const GradientConsistency *PatchTestGradients<dim>::consistency() const
  {
    return is_chosen ? &result : nullptr;
  }

  template <int dim>
  std::size_t PatchTestGradients<dim>::memory_consumption() const
  {
    return boundary.memory_consumption();
  }

  template class PatchTestGradients<2>;
  template class PatchTestGradients<3>;
} // namespace tombolo
