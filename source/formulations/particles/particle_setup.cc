// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/approximation/support_size.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The cells between the support points of a cell of some degree: lists of 2^dim places in its
     * lexicographic nodes. */
    template <int dim>
    std::vector<std::vector<unsigned int>> subcells(const unsigned int degree)
    {
      const unsigned int n = degree + 1;
      std::vector<std::vector<unsigned int>> result;
      for (unsigned int k = 0; k < (dim == 3 ? degree : 1); ++k)
        for (unsigned int j = 0; j < degree; ++j)
          for (unsigned int i = 0; i < degree; ++i)
          {
            std::vector<unsigned int> corners;
            for (unsigned int corner = 0; corner < (1u << dim); ++corner)
            {
              const unsigned int x = i + (corner & 1u);
              const unsigned int y = j + ((corner >> 1) & 1u);
              const unsigned int z = dim == 3 ? k + ((corner >> 2) & 1u) : 0;
              corners.push_back(x + n * (y + n * z));
            }
            result.push_back(corners);
          }
      return result;
    }
  } // namespace

  template <int dim>
  void MomentumConsistentParticle<dim>::collect_particles(const CellSelection<dim> &is_taken)
  {
    const Nodes<dim> &nodes = *setup.nodes;

    // The owner of a node sees all cells around it, owned or ghost, so that masses and supports of
    // its particles need no exchange.
    std::map<types::global_dof_index, unsigned int> place_of_node;
    std::vector<types::global_dof_index> seen_nodes;
    std::vector<double> positions;
    std::vector<double> masses;
    std::vector<unsigned int> corners;
    const auto subcell_nodes = subcells<dim>(nodes.degree());
    std::unique_ptr<Quadrature<dim>> quadrature;
    if (nodes.degree() == 1)
      quadrature = std::make_unique<QGauss<dim>>(2);
    else
      quadrature = std::make_unique<QGaussLobatto<dim>>(nodes.degree() + 1);
    FEValues<dim> fe_values(nodes.dof_handler().get_fe(), *quadrature,
                            update_values | update_JxW_values);
    std::vector<types::global_dof_index> cell_nodes, hierarchic_nodes(fe_values.dofs_per_cell);
    std::vector<Point<dim>> cell_points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial() || !is_taken(cell))
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, cell_points);
      std::vector<unsigned int> places;
      for (unsigned int k = 0; k < cell_nodes.size(); ++k)
      {
        const auto [entry, is_new] =
            place_of_node.try_emplace(cell_nodes[k], static_cast<unsigned int>(seen_nodes.size()));
        if (is_new)
        {
          seen_nodes.push_back(cell_nodes[k]);
          for (unsigned int c = 0; c < node_stride; ++c)
            positions.push_back(c < dim ? cell_points[k][c] : 0.);
          masses.push_back(0.);
        }
        places.push_back(entry->second);
      }
      for (const auto &subcell : subcell_nodes)
        for (const unsigned int corner : subcell)
          corners.push_back(places[corner]);
      fe_values.reinit(cell);
      cell->get_dof_indices(hierarchic_nodes);
      for (unsigned int k = 0; k < fe_values.dofs_per_cell; ++k)
        for (const unsigned int q : fe_values.quadrature_point_indices())
          masses[place_of_node[hierarchic_nodes[k]]] +=
              part_material->density() * fe_values.shape_value(k, q) * fe_values.JxW(q);
    }
    std::vector<double> half_widths(positions.size(), 0.);
    SupportSize::accumulate<dim>(corners, 1u << dim, positions.data(), half_widths.data());

    shape = Stencils();
    particle_global.clear();
    initial_positions.clear();
    initial_support.clear();
    spacing = std::numeric_limits<double>::max();
    for (const auto &[node, place] : place_of_node)
    {
      if (!nodes.owned().is_element(node))
        continue;
      particle_global.push_back(node);
      shape.mass.push_back(masses[place]);
      Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double half_width = half_widths[place * node_stride + d];
        point[d] = positions[place * node_stride + d];
        spacing = std::min(spacing, half_width);
        initial_support.push_back(dilation * half_width);
      }
      for (unsigned int d = dim; d < node_stride; ++d)
        initial_support.push_back(0.);
      initial_positions.push_back(point);
    }
    initial_volume.resize(particle_global.size());
    for (std::size_t i = 0; i < particle_global.size(); ++i)
      initial_volume[i] = shape.mass[i] / part_material->density();
    present_support = initial_support;
    reference_deformation.assign(particle_global.size(), unit_symmetric_tensor<dim>());
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::create_points()
  {
    std::vector<FieldDescription> variables = part_material->internal_variables();
    for (const FieldDescription &field : bulk_viscosity.variables())
      variables.push_back(field);
    for (const FieldDescription &field : plastic_heating.variables())
      variables.push_back(field);
    for (const FieldDescription &field : zero_energy_stabilization.variables())
      variables.push_back(field);
    if (bonds)
      for (const FieldDescription &field : bonds->variables())
        variables.push_back(field);
    if (self_contact)
      for (const FieldDescription &field : self_contact->variables())
        variables.push_back(field);
    material_points.reinit(static_cast<unsigned int>(particle_global.size()), variables);
    std::copy(initial_volume.begin(), initial_volume.end(),
              material_points.component(MaterialPoints::volume, 0));
    bulk_viscosity.initialize(*part_material, dim, material_points);
    plastic_heating.initialize(material_points);
    zero_energy_stabilization.initialize(*part_material, material_points);
  }

  template <int dim>
  std::vector<double> MomentumConsistentParticle<dim>::spread_initial_positions() const
  {
    std::vector<double> positions(particle_global.size() * node_stride, 0.);
    for (std::size_t i = 0; i < particle_global.size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        positions[i * node_stride + d] = initial_positions[i][d];
    return positions;
  }

  template <int dim>
  std::vector<std::uint64_t> MomentumConsistentParticle<dim>::persistent_ids() const
  {
    std::vector<std::uint64_t> ids;
    for (const types::global_dof_index node : particle_global)
      ids.push_back(setup.nodes->persistent_ids()[owned_nodes.index_within_set(node)]);
    return ids;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::initialize(const PartSetup<dim> &of_part)
  {
    setup = of_part;
    part_material = setup.material;
    thermal_properties = setup.heat;
    has_points = setup.has_mechanics;
    communicator = setup.communicator;
    owned_nodes = setup.nodes->owned();
    n_global_nodes = owned_nodes.size();
    symmetry = setup.symmetry;
    if (setup.source)
      for (const auto &[entry, is_on] :
           {std::pair{"Gradient", has_consistent_gradients},
            std::pair{"Pair residual", zero_energy_stabilization.is_on()}})
        if (is_on)
          section.fail(entry, "not for particles that cells become while the run goes on: allowed "
                              "are gradients of `moving least squares` and no pair residual");

    const unsigned int index = setup.source.value_or(setup.index);
    collect_particles([&](const typename Nodes<dim>::Cell &cell)
                      { return setup.part_cells->part_of(cell) == index; });
    if (!has_points)
    {
      if (bonds)
        section.fail("Bond failure", "the scene has heat alone, and no stresses that could break "
                                     "a bond");
      if (self_contact)
        section.fail("Self-contact", "the scene has heat alone, and nothing that moves");
      zero_energy_stabilization = ZeroEnergyStabilization();
    }
    if (self_contact && symmetry != nullptr)
      section.fail("Self-contact",
                   "not with planes of symmetry: fragments are not followed through "
                   "them. Model the whole body");
    if (self_contact && setup.scales_inertia)
      section.fail("Self-contact", "not with a target time step: springs between particles that "
                                   "have not got their mass would take it back");
    if (has_consistent_gradients)
    {
      boundary.initialize(setup);
      trace_bridge = setup.trace_bridge;
      has_unit_row.clear();
      for (const types::global_dof_index node : particle_global)
        has_unit_row.push_back(setup.prescribed_nodes.size() > 0 &&
                               setup.prescribed_nodes.is_element(node));
    }
    if (setup.symmetry != nullptr)
      check_symmetry(*setup.symmetry);
    neighbourhoods.set_symmetry(setup.symmetry);
    if (setup.source)
    {
      // Whether the supports would do is known before the first cell becomes particles.
      find_neighbours(spread_initial_positions());
      smallest_spacing_at_start = spacing;
      collect_particles([](const typename Nodes<dim>::Cell &) { return false; });
    }
    if (has_points)
    {
      plastic_heating.set(setup.heat, *part_material);
      create_points();
    }
    else
      material_points.reinit(0, {});
    find_neighbours(spread_initial_positions());
    if (bonds)
      bonds->initialize(persistent_ids(), shape, material_points, communicator);
    if (!setup.source)
      smallest_spacing_at_start = spacing;
    if (tell_self_contact() > 1 && configuration != Configuration::total_lagrangian)
      section.fail("Self-contact", "the part has several bodies, and with a kernel that is renewed "
                                   "those that come near each other grow together; choose `total "
                                   "Lagrangian` as `Configuration`");
  }

  template <int dim>
  unsigned long MomentumConsistentParticle<dim>::tell_self_contact()
  {
    if (!self_contact)
      return 0;
    std::vector<double> inertia;
    for (const double mass : shape.mass)
      inertia.push_back(mass * part_material->inertial_density() / part_material->density());
    self_contact->set_particles(
        {particle_global, persistent_ids(), initial_volume, inertia},
        part_material->longitudinal_wave_speed() / smallest_spacing_at_start, communicator);
    const auto partition = partition_of_rows();
    set_partition(*partition);
    return self_contact->set_start(setup.source.has_value(), shape, *partition);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::check_symmetry(const Symmetry &symmetry) const
  {
    // Between two planes an image has images of its own, which are not made. The nearest one of a
    // particle is as far as the planes are apart, and its distance to one of them, from others.
    for (const SymmetryPlane &lower : symmetry.planes)
      for (const SymmetryPlane &upper : symmetry.planes)
      {
        if (lower.axis != upper.axis || !(lower.coordinate < upper.coordinate))
          continue;
        const double thickness = upper.coordinate - lower.coordinate;
        double excess = 0;
        for (unsigned int i = 0; i < particle_global.size(); ++i)
        {
          const double support = initial_support[std::size_t(i) * node_stride + lower.axis];
          for (const SymmetryPlane &plane : {lower, upper})
          {
            const double distance = std::abs(initial_positions[i][lower.axis] - plane.coordinate);
            if (distance > 1e-6 * support)
              excess = std::max(excess, support - thickness - distance);
          }
        }
        if (Utilities::MPI::max(excess, communicator) > 1e-9 * thickness)
          section.fail("Dilation",
                       "supports reach across the whole slab between two planes of symmetry; make "
                       "it thicker, or model it with one plane.");
      }
  }

  template void MomentumConsistentParticle<2>::initialize(const PartSetup<2> &);
  template void MomentumConsistentParticle<2>::collect_particles(const CellSelection<2> &);
  template void MomentumConsistentParticle<2>::create_points();
  template unsigned long MomentumConsistentParticle<2>::tell_self_contact();
  template std::vector<double> MomentumConsistentParticle<2>::spread_initial_positions() const;
  template std::vector<std::uint64_t> MomentumConsistentParticle<2>::persistent_ids() const;
  template void MomentumConsistentParticle<3>::initialize(const PartSetup<3> &);
  template void MomentumConsistentParticle<3>::collect_particles(const CellSelection<3> &);
  template void MomentumConsistentParticle<3>::create_points();
  template unsigned long MomentumConsistentParticle<3>::tell_self_contact();
  template std::vector<double> MomentumConsistentParticle<3>::spread_initial_positions() const;
  template std::vector<std::uint64_t> MomentumConsistentParticle<3>::persistent_ids() const;
} // namespace tombolo
