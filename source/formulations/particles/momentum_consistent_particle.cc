// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/smoothing_strength.h>
#include <tombolo/approximation/support_size.h>
#include <tombolo/formulations/particles/particle_force.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr char gradient_documentation[] =
        "`moving least squares`, those of the shape functions, or `consistent`: changed as little "
        "as it takes for a constant stress to make no force inside and that of its traction at the "
        "boundary (the linear patch test). Worth it on disordered and turned lattices, at clamps "
        "and interfaces; inside a lattice they are the same. Solved for at the start and at each "
        "renewal of the reference, after which the test is passed approximately. Results on other "
        "numbers of ranks then agree to the tolerance only.";
    constexpr char tolerance_documentation[] =
        "Consistent gradients: what may remain of the defect in the patch test, over the vector "
        "areas of the boundary. 1e-4 is enough for accuracy; 1e-10 takes ten times the iterations.";

    std::shared_ptr<const Kernel> create_kernel(const Section &section)
    {
      return Registry<Kernel>::instance().create(section.get("Kernel"), section);
    }
  } // namespace

  template <int dim>
  void MomentumConsistentParticle<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Kernel", "cubic spline",
                          Patterns::Selection(Registry<Kernel>::instance().selection()),
                          "The kernel of the moving least squares.");
    handler.declare_entry(
        "Dilation", "1.8", Patterns::Double(),
        "Half width of a support over the largest distance to a neighbouring node, "
        "axis by axis; above 1, usually 1.5 to 1.9.");
    handler.declare_entry("Smoothing", "affine", Patterns::Anything(),
                          "How velocities are smoothed: `paper` (momentum-consistent smoothing of "
                          "Pan et al. 2019), `fe "
                          "matched` and `phase` (sharpened to the phase speed of finite elements, "
                          "and to fourth order), "
                          "`affine` (linear fields are reproduced, so that angular momentum is "
                          "conserved), `none`, or a "
                          "number gamma for S (I + gamma (I - Phi S)).");
    handler.declare_entry("Configuration", "total Lagrangian",
                          Patterns::Selection("total Lagrangian|updated Lagrangian|current"),
                          "The configuration in which kernels are: the initial one, one that is "
                          "renewed now and then (see the rebuild entries), or the current one.");
    handler.declare_entry(
        "Rebuild interval", "0", Patterns::Integer(0, 1000000000),
        "Updated Lagrangian: the reference is renewed every so many steps; 0 is never.");
    handler.declare_entry(
        "Rebuild deformation", "0", Patterns::Double(0., 10.),
        "Updated Lagrangian: the reference is renewed when a component of F - I since "
        "the last renewal exceeds this at any particle; 0 is never.");
    handler.declare_entry("Gradient", "moving least squares",
                          Patterns::Selection("moving least squares|consistent"),
                          gradient_documentation);
    handler.declare_entry("Gradient tolerance", "1e-4", Patterns::Double(1e-12, 0.1),
                          tolerance_documentation);
    BulkViscosity::declare_parameters(handler);
    ZeroEnergyStabilization::declare_parameters(handler);
    Bonds<dim>::declare_parameters(handler);
    SelfContact<dim>::declare_parameters(handler);
  }

  template <int dim>
  MomentumConsistentParticle<dim>::MomentumConsistentParticle(const Section &section)
      : section(section), dilation(section.get_double("Dilation")), bulk_viscosity(section),
        neighbourhoods(section.get("Configuration") == "current" ? 0.1 : 0.),
        moving_least_squares(create_kernel(section))
  {
    has_consistent_gradients = section.get("Gradient") == "consistent";
    if (has_consistent_gradients)
      gradient_tolerance = section.get_double("Gradient tolerance");
    if (!(dilation > 1. && dilation <= 10.))
      section.fail("Dilation",
                   "allowed is a number above 1 and up to 10; usual are 1.5 to 1.9. At 1 or "
                   "below a particle has no neighbours along an axis");
    zero_energy_stabilization =
        ZeroEnergyStabilization(section, moving_least_squares.kernel(), dilation);
    bonds = Bonds<dim>::create(section);
    self_contact = SelfContact<dim>::create(section);
    const std::string configuration_name = section.get("Configuration");
    configuration = configuration_name == "total Lagrangian"     ? Configuration::total_lagrangian
                    : configuration_name == "updated Lagrangian" ? Configuration::updated_lagrangian
                                                                 : Configuration::current;
    if (configuration == Configuration::updated_lagrangian)
    {
      rebuild_interval = section.get_unsigned("Rebuild interval");
      rebuild_deformation = section.get_double("Rebuild deformation");
      if (rebuild_interval == 0 && rebuild_deformation == 0.)
        section.fail("Configuration",
                     "an updated Lagrangian kernel needs `Rebuild interval` or `Rebuild "
                     "deformation`; with neither it is total Lagrangian");
    }

    if (has_consistent_gradients && configuration == Configuration::current)
      section.fail("Gradient", "consistent gradients take hundreds of sweeps over the particles; "
                               "with a kernel in the current configuration that would be at every "
                               "step. Choose another `Configuration`, or `moving least squares`");

    // Looking for equal rows pays where they stay, and where they are not changed one by one.
    shares_rows = configuration == Configuration::total_lagrangian && !has_consistent_gradients;
    if (shares_rows)
      neighbourhoods.order_by_offset();

    const std::string smoothing = section.get("Smoothing");
    if (smoothing == "none")
      smoothing_settings.is_active = false;
    else if (smoothing == "affine")
      smoothing_settings.affine = true;
    else if (smoothing == "fe matched")
      smoothing_settings.gamma = SmoothingStrength::fe_matched(
          SmoothingStrength::lattice_row(moving_least_squares.kernel(), dilation));
    else if (smoothing == "phase")
      smoothing_settings.gamma = SmoothingStrength::phase(
          SmoothingStrength::lattice_row(moving_least_squares.kernel(), dilation));
    else if (smoothing != "paper")
    {
      char *end = nullptr;
      smoothing_settings.gamma = std::strtod(smoothing.c_str(), &end);
      if (smoothing.empty() || *end != '\0' || !(std::abs(smoothing_settings.gamma) <= 10.))
      {
        const std::string nearest =
            nearest_name(smoothing, {"paper", "fe matched", "phase", "affine", "none"});
        section.fail("Smoothing",
                     "allowed is paper, fe matched, phase, affine, none, or a number "
                     "between -10 and 10" +
                         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
      }
    }
  }

  template <int dim>
  unsigned int MomentumConsistentParticle<dim>::degree() const
  {
    return 0;
  }

  template <int dim>
  IndexSet MomentumConsistentParticle<dim>::required_nodes() const
  {
    IndexSet nodes(n_global_nodes);
    const auto &row_nodes = neighbourhoods.global_nodes();
    nodes.add_indices(row_nodes.begin(), row_nodes.end());
    if (has_consistent_gradients)
      nodes.add_indices(boundary.required_nodes());
    if (self_contact)
    {
      std::vector<types::global_dof_index> near = self_contact->required_nodes();
      std::sort(near.begin(), near.end());
      nodes.add_indices(near.begin(), near.end());
    }
    nodes.compress();
    return nodes;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::set_partition(const NodePartition &partition)
  {
    neighbourhoods.set_partition(partition, shape);
    if (self_contact)
      self_contact->set_partition(partition);
    support_of_node.reinit(std::make_shared<const NodePartition>(partition), node_stride,
                           ReflectionParity::even);
  }

  template <int dim>
  std::vector<MirrorNode> MomentumConsistentParticle<dim>::required_images() const
  {
    return neighbourhoods.images();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::compute_shape_functions(const double *position,
                                                                const double *support)
  {
    const std::vector<unsigned int> &nodes = neighbourhoods.nodes();
    const std::vector<BasisDefect> &defects =
        moving_least_squares.compute(nodes, position, support, shape, shares_rows);
    shape.inverse_deformation_is_current = false;
    shape.rank_deficient_rows.clear();
    shape.non_negative_rows.clear();
    for (const BasisDefect &defect : defects)
      shape.rank_deficient_rows.push_back(defect.row);
    if (zero_energy_stabilization.is_on())
    {
      std::vector<double> volume = initial_volume;
      for (std::size_t i = 0; i < volume.size(); ++i)
        volume[i] *= determinant(reference_deformation[i]);
      zero_energy_stabilization.set_reference(dim, shape, volume, position, support);
    }
    if (has_started)
      return;
    std::string message;
    if (!defects.empty())
    {
      const BasisDefect &defect = defects.front();
      const unsigned int node = shape.particle_node[defect.row];
      std::ostringstream text;
      text << "The particle at (";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? ", " : "") << position[std::size_t(node) * node_stride + d];
      text << ") has " << defect.n_neighbours
           << " neighbours (itself included), which do not carry a linear basis at dilation "
           << dilation << ".";
      const double factor =
          moving_least_squares.sufficient_support_factor(node, nodes, position, support);
      if (factor > 0.)
        text << " A dilation of " << std::ceil(100. * dilation * factor) / 100.
             << " would do there.";
      else
        text << " No dilation up to eight times that one would do: are its cells a single layer?";
      message = text.str();
    }
    for (const std::string &of_rank : Utilities::MPI::all_gather(communicator, message))
      if (!of_rank.empty())
        section.fail("Dilation", of_rank);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::add_mass(NodalVector &mass) const
  {
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      *mass.node(shape.particle_node[i]) += shape.mass[i];
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::add_internal_force(const MechanicalInput &input,
                                                           NodalVector &force)
  {
    ParticleForce::add_internal_force<dim>(
        shape, initial_volume, *part_material, input.position->data(), input.velocity->data(),
        input.temperature == nullptr ? nullptr : input.temperature->data(), input.time_increment,
        bulk_viscosity, plastic_heating, material_points, force.data());
    if (zero_energy_stabilization.is_on())
      zero_energy_stabilization.add_force(shape, input.position->data(), input.velocity->data(),
                                          input.time_increment, material_points, force.data());
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                                const NodalVector &velocity,
                                                                const double time_step,
                                                                NodalVector &force) const
  {
    ParticleForce::apply_elastic_stiffness<dim>(shape, *part_material, material_points,
                                                position.data(), velocity.data(), time_step,
                                                bulk_viscosity, force.data());
    if (zero_energy_stabilization.is_on())
      zero_energy_stabilization.apply_elastic_stiffness(shape, position.data(), velocity.data(),
                                                        force.data());
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::add_conduction(const NodalVector &position,
                                                       const NodalVector &of_conductivity,
                                                       const NodalVector &temperature,
                                                       NodalVector &heat_rate) const
  {
    ParticleForce::add_conduction<dim>(shape, initial_volume, thermal_properties->conductivity(),
                                       has_points ? &material_points : nullptr, position.data(),
                                       of_conductivity.data(), temperature.data(),
                                       heat_rate.data());
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::add_plastic_heat(NodalVector &heat)
  {
    if (!plastic_heating.has_plastic_heat())
      return;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      *heat.node(shape.particle_node[i]) += plastic_heating.give(material_points, i);
  }

  template <int dim>
  double MomentumConsistentParticle<dim>::pending_plastic_heat() const
  {
    return plastic_heating.pending(material_points);
  }

  template <int dim>
  EnergyAccounts MomentumConsistentParticle<dim>::energies() const
  {
    EnergyAccounts result;
    double elastic = 0.;
    const unsigned int n = material_points.padded_size();
    std::vector<double> density(n);
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = material_points.component(MaterialPoints::stress, c);
    part_material->elastic_energy_density(n, stress, plastic_heating.temperature(material_points),
                                          density.data());
    const double *const volume = material_points.component(MaterialPoints::volume, 0);
    for (unsigned int i = 0; i < material_points.size(); ++i)
      elastic += density[i] * volume[i];
    result.add("elastic energy", EnergyKind::stored, elastic);
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored,
               zero_energy_stabilization.stored_energy(material_points));
    result.add("viscous dissipation", EnergyKind::artificial,
               integral_over_initial_volume(material_points, BulkViscosity::dissipation_name) +
                   zero_energy_stabilization.dissipation(material_points));
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(material_points, "thermal work"));
    if (bonds)
      result.add("failure dissipation", EnergyKind::dissipated,
                 integral_over_initial_volume(material_points, Bonds<dim>::dissipation_name));
    if (self_contact)
    {
      const SelfContactBalance balance = self_contact->balance();
      result.add("self-contact energy", EnergyKind::stored, balance.elastic);
      result.add("self-contact damping", EnergyKind::dissipated, balance.damping);
    }
    return result;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::point_positions(const NodalVector &position,
                                                        std::vector<Point<dim>> &points) const
  {
    points.resize(shape.n_particles());
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        points[i][d] = position.node(shape.particle_node[i])[d];
  }

  template <int dim>
  const std::vector<Point<dim>> &MomentumConsistentParticle<dim>::initial_point_positions() const
  {
    return initial_positions;
  }

  template <int dim>
  const MaterialPoints &MomentumConsistentParticle<dim>::points() const
  {
    return material_points;
  }

  template <int dim>
  MaterialPoints &MomentumConsistentParticle<dim>::points()
  {
    return material_points;
  }

  template <int dim>
  const Material &MomentumConsistentParticle<dim>::material() const
  {
    return *part_material;
  }

  template <int dim>
  unsigned int MomentumConsistentParticle<dim>::n_cells() const
  {
    return 0;
  }

  template <int dim>
  unsigned int MomentumConsistentParticle<dim>::n_points_per_cell() const
  {
    return 0;
  }

  template <int dim>
  std::size_t MomentumConsistentParticle<dim>::memory_consumption() const
  {
    return shape.memory_consumption() + material_points.memory_consumption() +
           moving_least_squares.memory_consumption() + neighbourhoods.memory_consumption() +
           support_of_node.memory_consumption() + boundary.memory_consumption() +
           zero_energy_stabilization.memory_consumption() +
           (bonds ? bonds->memory_consumption() : 0) +
           (self_contact ? self_contact->memory_consumption() : 0) +
           former_rows.memory_consumption() +
           (initial_support.capacity() + present_support.capacity() + present_position.capacity() +
            initial_volume.capacity()) *
               sizeof(double) +
           particle_global.capacity() * sizeof(types::global_dof_index) +
           reference_deformation.capacity() * sizeof(Tensor<2, dim>) +
           initial_positions.capacity() * sizeof(Point<dim>);
  }

  template <int dim>
  Stencils &MomentumConsistentParticle<dim>::stencils()
  {
    return shape;
  }

  template <int dim>
  SmoothingSettings MomentumConsistentParticle<dim>::smoothing() const
  {
    return smoothing_settings;
  }

  template <int dim>
  double MomentumConsistentParticle<dim>::smallest_spacing() const
  {
    return spacing;
  }

  template <int dim>
  NeighbourCounts MomentumConsistentParticle<dim>::neighbour_counts() const
  {
    NeighbourCounts counts;
    std::size_t sum = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Stencils::Row row = shape.row(i);
      const auto n =
          row.size - static_cast<unsigned int>(std::count(row.value, row.value + row.size, 0.));
      counts.minimum = i == 0 ? n : std::min(counts.minimum, n);
      counts.maximum = std::max(counts.maximum, n);
      sum += n;
    }
    if (shape.n_particles() > 0)
      counts.mean = static_cast<double>(sum) / shape.n_particles();
    return counts;
  }

  template <int dim>
  FragmentCounts MomentumConsistentParticle<dim>::fragment_counts() const
  {
    FragmentCounts counts;
    if (!self_contact)
      return counts;
    const SelfContactBalance balance = self_contact->balance();
    counts.has_contact = true;
    counts.n_fragments = balance.n_fragments;
    counts.n_touching = balance.n_touching;
    return counts;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::forget_fragments()
  {
    if (self_contact)
      self_contact->forget_fragments();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::add_self_contact(const MechanicalInput &input,
                                                         const NodalVector &element_mass,
                                                         NodalVector &loads,
                                                         std::vector<unsigned int> &loaded_nodes)
  {
    if (self_contact)
      self_contact->add_forces(*input.position, *input.velocity, element_mass, shape,
                               material_points, loads, loaded_nodes);
  }

  template <int dim>
  double MomentumConsistentParticle<dim>::stable_fraction(const double stable_step) const
  {
    return self_contact ? self_contact->stable_fraction(stable_step) : 1.;
  }

  template <int dim>
  Point<dim> MomentumConsistentParticle<dim>::support(const unsigned int i) const
  {
    Point<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = present_support[std::size_t(i) * node_stride + d];
    return result;
  }

  template class MomentumConsistentParticle<2>;
  template class MomentumConsistentParticle<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, MomentumConsistentParticle, "momentum consistent particle",
      "moving least squares particles, nodally integrated, with momentum-consistent smoothing")
} // namespace tombolo
