// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_rows.h>

#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    std::shared_ptr<const Kernel> create_kernel(const Section &section)
    {
      std::shared_ptr<const Kernel> kernel =
          Registry<Kernel>::instance().create(section.get("Kernel"), section);
      if (!kernel->is_smooth_at_zero())
        section.fail("Kernel", "it has a kink at zero, where moving least squares need its "
                               "derivative; allowed are smooth kernels, such as `cubic spline` and "
                               "`quintic spline`");
      return kernel;
    }
  } // namespace

  template <int dim>
  void ParticleRows<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Kernel", "cubic spline",
                          Patterns::Selection(Registry<Kernel>::instance().selection()),
                          "The kernel of the moving least squares.");
    handler.declare_entry(
        "Dilation", "1.8", Patterns::Double(),
        "Half width of a support over the largest distance to a neighbouring node, "
        "axis by axis; above 1, usually 1.5 to 1.9.");
    handler.declare_entry("Kernels across gaps", "false", Patterns::Bool(),
                          "Whether particles are neighbours of those in another body of the mesh, "
                          "one that no common node joins to their own: as if they were glued.");
  }

  template <int dim>
  ParticleRows<dim>::ParticleRows(const Section &section)
      : section(section), support_dilation(section.get_double("Dilation")),
        crosses_gaps(section.get_bool("Kernels across gaps")), averages(section),
        consistent_gradients(section),
        neighbours(section.get("Configuration") == "current" ? 0.1 : 0.),
        least_squares(create_kernel(section))
  {
    // Looking for equal rows pays where they stay, and where they are not changed one by one.
    shares_rows =
        section.get("Configuration") == "total Lagrangian" && !consistent_gradients.is_on();
    if (shares_rows)
      neighbours.order_by_offset();
  }

  template <int dim>
  void ParticleRows<dim>::check_dilation() const
  {
    if (!(support_dilation > 1. && support_dilation <= 10.))
      section.fail("Dilation",
                   "allowed is a number above 1 and up to 10; usual are 1.5 to 1.9. At 1 or "
                   "below a particle has no neighbours along an axis");
  }

  template <int dim>
  void ParticleRows<dim>::check_gradients() const
  {
    if (consistent_gradients.is_on() && section.get("Configuration") == "current")
      section.fail("Gradient", "consistent gradients take hundreds of sweeps over the particles; "
                               "with a kernel in the current configuration that would be at every "
                               "step. Choose another `Configuration`, or `moving least squares`");
  }

  template <int dim>
  void ParticleRows<dim>::set_symmetry(const std::shared_ptr<const Symmetry> &symmetry)
  {
    neighbours.set_symmetry(symmetry);
  }

  template <int dim>
  void ParticleRows<dim>::reset(const std::vector<double> &masses)
  {
    shape = Stencils();
    shape.mass = masses;
  }

  template <int dim>
  void ParticleRows<dim>::search(const ParticleSet<dim> &particles,
                                 const std::vector<double> &position,
                                 const std::vector<double> &support)
  {
    communicator = particles.communicator();
    neighbours.search(particles.nodes(), position, support, communicator, shape);
    if (bodies != nullptr)
      separate_bodies(partition(particles), neighbours, shape);
    if (averages.is_on())
      averages.restrict(neighbours, shape);
  }

  template <int dim>
  std::string ParticleRows<dim>::functions() const
  {
    return averages.description();
  }

  template <int dim>
  bool ParticleRows<dim>::choose_functions(const PartSetup<dim> &setup, ParticleSet<dim> &particles)
  {
    averages.choose(setup);
    if (averages.is_on())
      averages.establish(particles);
    return averages.is_on();
  }

  template <int dim>
  void ParticleRows<dim>::set_bodies(const Bodies<dim> &of_mesh)
  {
    bodies = of_mesh.n_bodies() > 1 && !crosses_gaps ? &of_mesh : nullptr;
  }

  template <int dim>
  void ParticleRows<dim>::separate_bodies(const std::shared_ptr<const NodePartition> &partition,
                                          Neighbourhoods<dim> &found, Stencils &stencils) const
  {
    if (bodies == nullptr)
      return;
    NodalVector body;
    body.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *body.node(i) = static_cast<double>(bodies->body_of(partition->global_index(i)));
    body.update_ghosts();
    const auto n_nodes = static_cast<unsigned int>(found.global_nodes().size());
    const auto body_at = [&](const unsigned int place)
    {
      return *body.node(place < n_nodes ? partition->local_index(found.global_nodes()[place])
                                        : partition->local_index(found.images()[place - n_nodes]));
    };
    found.remove_neighbours([&](const unsigned int row, const unsigned int place)
                            { return body_at(row) != body_at(place); },
                            stencils);
  }

  template <int dim>
  void ParticleRows<dim>::compute_at_search()
  {
    compute(neighbours.position_at_search().data(), neighbours.support_at_search().data());
  }

  template <int dim>
  void ParticleRows<dim>::compute_at(const NodalVector &position,
                                     const std::vector<double> &support)
  {
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      std::copy_n(support.begin() + std::ptrdiff_t(i) * node_stride, node_stride,
                  support_of_node.node(shape.particle_node[i]));
    support_of_node.update_ghosts();
    compute(position.data(), support_of_node.data());
  }

  template <int dim>
  void ParticleRows<dim>::compute_in_reference(const ParticleSet<dim> &particles,
                                               const KernelConfiguration<dim> &kernel,
                                               NodalVector &buffer)
  {
    find_reference(particles, kernel, buffer);
    compute_at(buffer, kernel.supports());
  }

  template <int dim>
  void ParticleRows<dim>::find_reference(const ParticleSet<dim> &particles,
                                         const KernelConfiguration<dim> &kernel,
                                         NodalVector &reference) const
  {
    const bool is_renewed = !kernel.positions().empty();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      if (double *const target = reference.node(shape.particle_node[i]); is_renewed)
        std::copy_n(kernel.positions().begin() + std::ptrdiff_t(i) * node_stride, node_stride,
                    target);
      else
        for (unsigned int d = 0; d < dim; ++d)
          target[d] = particles.initial_positions()[i][d];
    reference.update_ghosts();
  }

  template <int dim>
  void ParticleRows<dim>::compute(const double *position, const double *support)
  {
    if (averages.is_on())
    {
      averages.fill(neighbours, shares_rows, shape);
      shape.inverse_deformation_is_current = false;
      return;
    }
    const std::vector<BasisDefect> &defects =
        least_squares.compute(neighbours.nodes(), position, support, shape, shares_rows);
    shape.inverse_deformation_is_current = false;
    shape.rank_deficient_rows.clear();
    shape.non_negative_rows.clear();
    for (const BasisDefect &defect : defects)
      shape.rank_deficient_rows.push_back(defect.row);
    if (has_started)
      return;
    const std::string message = describe(defects, position, support);
    for (const std::string &of_rank : Utilities::MPI::all_gather(communicator, message))
      if (!of_rank.empty())
        section.fail("Dilation", of_rank);
  }

  template <int dim>
  std::string ParticleRows<dim>::describe(const std::vector<BasisDefect> &defects,
                                          const double *position, const double *support) const
  {
    if (defects.empty())
      return {};
    const BasisDefect &defect = defects.front();
    const unsigned int node = shape.particle_node[defect.row];
    std::ostringstream text;
    text << "The particle at (";
    for (unsigned int d = 0; d < dim; ++d)
      text << (d > 0 ? ", " : "") << position[std::size_t(node) * node_stride + d];
    text << ") has " << defect.n_neighbours
         << " neighbours (itself included), which do not carry a linear basis at dilation "
         << support_dilation << ".";
    const double factor =
        least_squares.sufficient_support_factor(node, neighbours.nodes(), position, support);
    if (factor > 0.)
      text << " A dilation of " << std::ceil(100. * support_dilation * factor) / 100.
           << " would do there.";
    else
      text << " No dilation up to eight times that one would do: are its cells a single layer?";
    return text.str();
  }

  template <int dim>
  void ParticleRows<dim>::make_gradients_consistent(const ParticleSet<dim> &particles,
                                                    const KernelConfiguration<dim> &kernel,
                                                    const NodalVector &position)
  {
    if (consistent_gradients.is_on())
      consistent_gradients.establish(kernel.volumes(particles), position, shape);
  }

  template <int dim>
  void ParticleRows<dim>::make_gradients_consistent(const ParticleSet<dim> &particles,
                                                    const KernelConfiguration<dim> &kernel,
                                                    const std::vector<double> &positions)
  {
    if (!consistent_gradients.is_on())
      return;
    const auto of_rows = partition(particles);
    set_partition(*of_rows);
    NodalVector position;
    position.reinit(of_rows, node_stride, ReflectionParity::point);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      std::copy_n(positions.begin() + std::ptrdiff_t(i) * node_stride, node_stride,
                  position.node(shape.particle_node[i]));
    position.update_ghosts();
    make_gradients_consistent(particles, kernel, position);
  }

  template <int dim>
  PatchTest ParticleRows<dim>::patch_test(const PartSetup<dim> &setup,
                                          const ParticleSet<dim> &particles,
                                          const KernelConfiguration<dim> &kernel,
                                          const bool smooths, const NodalVector &position) const
  {
    PatchTest result;
    result.consistency = consistent_gradients.consistency();
    if (setup.source || !setup.has_mechanics)
      return result;
    PatchTestGradients<dim> test;
    test.initialize(setup, particles, smooths);
    result.is_known = true;
    result.defect = test.defect(kernel.volumes(particles), position, shape);
    if (result.consistency != nullptr || averages.is_on())
      return result;
    if (averages.obstacle(setup).empty())
      result.cure = "Shape functions = cell averages";
    else if (kernel.is_total_lagrangian() && section.get("Bond failure") == "none")
      result.cure = "Gradient = consistent";
    return result;
  }

  template <int dim>
  void ParticleRows<dim>::finish_start()
  {
    has_started = true;
  }

  template <int dim>
  IndexSet ParticleRows<dim>::required_nodes(const ParticleSet<dim> &particles) const
  {
    IndexSet nodes(particles.owned_nodes().size());
    const auto &of_rows = neighbours.global_nodes();
    nodes.add_indices(of_rows.begin(), of_rows.end());
    if (consistent_gradients.is_on())
      nodes.add_indices(consistent_gradients.required_nodes());
    nodes.compress();
    return nodes;
  }

  template <int dim>
  const std::vector<MirrorNode> &ParticleRows<dim>::required_images() const
  {
    return neighbours.images();
  }

  template <int dim>
  void ParticleRows<dim>::store_reference(const ParticleSet<dim> &particles,
                                          const KernelConfiguration<dim> &kernel,
                                          const std::shared_ptr<const NodePartition> &partition)
  {
    shape.reference_position.reinit(partition, node_stride, ReflectionParity::point);
    find_reference(particles, kernel, shape.reference_position);
  }

  template <int dim>
  void ParticleRows<dim>::set_partition(const NodePartition &partition)
  {
    neighbours.set_partition(partition, shape);
    support_of_node.reinit(std::make_shared<const NodePartition>(partition), node_stride,
                           ReflectionParity::even);
  }

  template <int dim>
  std::shared_ptr<const NodePartition>
  ParticleRows<dim>::partition(const ParticleSet<dim> &particles) const
  {
    return particles.partition(required_nodes(particles), required_images());
  }

  template <int dim>
  void ParticleRows<dim>::serialize_start(StateArchive &archive)
  {
    archive("has started", has_started);
  }

  template <int dim>
  void ParticleRows<dim>::serialize_extrapolation(StateArchive &archive)
  {
    // Which rows lose their negative values depends on the masses that there were at that time.
    std::vector<double> flags(shape.mass.size(), 0.);
    for (const unsigned int row : shape.non_negative_rows)
      flags[row] = 1.;
    archive.rows("is kept from extrapolating", 1, flags);
    if (!archive.is_reading())
      return;
    rows_to_change.clear();
    for (unsigned int row = 0; row < flags.size(); ++row)
      if (flags[row] != 0.)
        rows_to_change.push_back(row);
  }

  template <int dim>
  void ParticleRows<dim>::serialize_search(StateArchive &archive, std::vector<double> &position,
                                           std::vector<double> &support) const
  {
    const auto n_own = static_cast<std::ptrdiff_t>(shape.mass.size() * node_stride);
    const std::vector<double> &all_positions = neighbours.position_at_search();
    const std::vector<double> &all_supports = neighbours.support_at_search();
    position.assign(all_positions.begin(), all_positions.begin() + n_own);
    support.assign(all_supports.begin(), all_supports.begin() + n_own);
    archive.rows("position at search", node_stride, position);
    archive.rows("support at search", node_stride, support);
  }

  template <int dim>
  void ParticleRows<dim>::complete_reading()
  {
    for (const unsigned int row : rows_to_change)
      shape.remove_negative_values(row);
    rows_to_change.clear();
  }

  template <int dim>
  const Stencils &ParticleRows<dim>::stencils() const
  {
    return shape;
  }

  template <int dim>
  Stencils &ParticleRows<dim>::stencils()
  {
    return shape;
  }

  template <int dim>
  const Neighbourhoods<dim> &ParticleRows<dim>::neighbourhoods() const
  {
    return neighbours;
  }

  template <int dim>
  Neighbourhoods<dim> &ParticleRows<dim>::neighbourhoods()
  {
    return neighbours;
  }

  template <int dim>
  const NodalVector &ParticleRows<dim>::nodal_supports() const
  {
    return support_of_node;
  }

  template <int dim>
  MovingLeastSquares<dim> &ParticleRows<dim>::moving_least_squares()
  {
    return least_squares;
  }

  template <int dim>
  PatchTestGradients<dim> &ParticleRows<dim>::gradients()
  {
    return consistent_gradients;
  }

  template <int dim>
  const PatchTestGradients<dim> &ParticleRows<dim>::gradients() const
  {
    return consistent_gradients;
  }

  template <int dim>
  double ParticleRows<dim>::dilation() const
  {
    return support_dilation;
  }

  template <int dim>
  std::size_t ParticleRows<dim>::memory_consumption() const
  {
    return shape.memory_consumption() + least_squares.memory_consumption() +
           neighbours.memory_consumption() + support_of_node.memory_consumption() +
           averages.memory_consumption() + consistent_gradients.memory_consumption();
  }

  template class ParticleRows<2>;
  template class ParticleRows<3>;
} // namespace tombolo
