#include <tombolo/simulation/spectral_estimator.h>

#include <tombolo/base/vectorization.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** (a, b) in the inner product of M̂, for several pairs with one exchange; the same on all
     * ranks, in a fixed order. */
    template <std::size_t n>
    std::array<double, n>
    inner_products(const NodalVector &mass,
                   const std::array<std::pair<const NodalVector *, const NodalVector *>, n> &pairs)
    {
      std::array<double, n> local{};
      const unsigned int n_owned = mass.partition()->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
        for (std::size_t k = 0; k < n; ++k)
        {
          const double *const a = pairs[k].first->node(i);
          const double *const b = pairs[k].second->node(i);
          local[k] += *mass.node(i) * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        }
      std::array<double, n> total{};
      for (const auto &part : Utilities::MPI::all_gather(mass.partition()->communicator(), local))
        for (std::size_t k = 0; k < n; ++k)
          total[k] += part[k];
      return total;
    }

    void combine(const double a, NodalVector &x, const double b, const NodalVector &y, const double c,
                 const NodalVector &z)
    {
      const std::size_t n =
          static_cast<std::size_t>(x.partition()->n_local()) * x.n_slots_per_node();
      for (std::size_t i = 0; i < n; ++i)
        x.data()[i] = a * x.data()[i] + b * y.data()[i] + c * z.data()[i];
    }

    /** A number in (-1, 1) that depends on the position alone: the start vector is the same on any
     * number of ranks. */
    double noise(const double *position, const unsigned int component)
    {
      std::uint64_t hash = 0x9E3779B97F4A7C15ull * (component + 1);
      for (unsigned int d = 0; d < 3; ++d)
      {
        std::uint64_t bits;
        std::memcpy(&bits, position + d, sizeof(bits));
        hash ^= bits + 0x9E3779B97F4A7C15ull + (hash << 6) + (hash >> 2);
        hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9ull;
        hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBull;
        hash ^= hash >> 31;
      }
      return 2. * (static_cast<double>(hash >> 11) * 0x1.0p-53) - 1.;
    }
  } // namespace

  template <int dim>
  void SpectralEstimator<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Tolerance", "1e-4", Patterns::Double(1e-8, 0.01),
                          "The iteration ends when the eigenvalue has grown by less than this "
                          "fraction over ten iterations.");
    handler.declare_entry("Max iterations", "400", Patterns::Integer(10, 100000),
                          "Limit of the iterations of one estimate.");
  }

  template <int dim>
  SpectralEstimator<dim>::SpectralEstimator(const Section &section)
    : tolerance(section.get_double("Tolerance")),
      max_iterations(section.get_unsigned("Max iterations"))
  {}

  template <int dim>
  bool SpectralEstimator<dim>::is_cheap() const
  {
    return false;
  }

  template <int dim>
  unsigned int SpectralEstimator<dim>::n_applications() const
  {
    return count;
  }

  template <int dim>
  void SpectralEstimator<dim>::apply(Scene<dim> &scene, const NodalVector &v_hat,
                                     const double time_step, NodalVector &result)
  {
    ++count;
    Bridge &bridge = *scene.bridge;
    const auto &constrained = scene.conditions->constrained_components();
    const unsigned int n_owned = scene.state.partition()->n_owned();
    const auto remove_constrained = [&](NodalVector &vector)
    {
      if (constrained.empty())
        return;
      for (const unsigned int node : scene.conditions->constrained_nodes())
        for (unsigned int d = 0; d < 3; ++d)
          if ((constrained[node] >> d) & 1u)
            vector.node(node)[d] = 0.;
      vector.update_ghosts();
    };

    bridge.apply_smoothing(scene.state.position, v_hat, velocity);
    remove_constrained(velocity);
    force.set_zero();
    const NodalVector &seen_by_elements = bridge.element_velocity(velocity);
    if (bridge.is_trace())
      element_force.set_zero();
    for (const Part<dim> &part : scene.parts)
    {
      const bool sees_particles = part.particles == nullptr && bridge.is_trace();
      part.formulation->add_stiffness_action(
          scene.state.position, sees_particles ? seen_by_elements : velocity, time_step,
          sees_particles ? element_force : force);
    }
    force.add_to_owners();
    if (bridge.is_trace())
      bridge.collect_element_force(element_force, force);
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(force.node(i)) / load_node(bridge.nodal_mass().node(i)), force.node(i));
    force.update_ghosts();
    remove_constrained(force);
    bridge.apply_adjoint(scene.state.position, force, result);
    remove_constrained(result);
    force.set_zero();
  }

  template <int dim>
  double SpectralEstimator<dim>::largest_eigenvalue(Scene<dim> &scene, const double time_step,
                                                    const bool is_first)
  {
    const NodalVector &mass = scene.bridge->mass();
    const auto &partition = scene.state.partition();
    NodalVector image, residual, residual_image, direction, direction_image;
    for (NodalVector *vector : {&image, &residual, &residual_image, &direction, &direction_image})
      vector->reinit(partition);

    const auto normalize = [&](NodalVector &vector, NodalVector *its_image)
    {
      const double norm =
          std::sqrt(inner_products<1>(mass, {{{&vector, &vector}}})[0]);
      const double factor = norm > 0. ? 1. / norm : 0.;
      combine(factor, vector, 0., vector, 0., vector);
      if (its_image != nullptr)
        combine(factor, *its_image, 0., *its_image, 0., *its_image);
      return norm;
    };

    normalize(mode, nullptr);
    apply(scene, mode, time_step, image);
    double eigenvalue = inner_products<1>(mass, {{{&mode, &image}}})[0];
    std::vector<double> history{eigenvalue};
    const unsigned int look_back = is_first ? 10 : 4;
    bool has_direction = false;
    for (unsigned int iteration = 0; iteration < max_iterations; ++iteration)
    {
      residual.copy_from(image);
      combine(1., residual, -eigenvalue, mode, 0., mode);
      const double residual_norm = normalize(residual, nullptr);
      if (!(residual_norm > 1e-10 * std::abs(eigenvalue)))
        break;
      apply(scene, residual, time_step, residual_image);

      // Rayleigh-Ritz on span{mode, residual, direction}.
      const auto products = inner_products<9>(mass, {{{&mode, &residual},
                                                      {&mode, &direction},
                                                      {&residual, &direction},
                                                      {&residual, &image},
                                                      {&direction, &image},
                                                      {&residual, &residual_image},
                                                      {&direction, &residual_image},
                                                      {&direction, &direction_image},
                                                      {&mode, &image}}});
      Eigen::Matrix3d gram, projected;
      gram << 1., products[0], products[1], products[0], 1., products[2], products[1], products[2], 1.;
      projected << products[8], products[3], products[4], products[3], products[5], products[6],
          products[4], products[6], products[7];
      const int size = has_direction ? 3 : 2;
      // The eigenvectors of the Gram matrix with small eigenvalues are directions that the three
      // vectors do not really span.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_gram(gram.topLeftCorner(size, size));
      Eigen::MatrixXd basis(size, 0);
      for (int k = 0; k < size; ++k)
        if (of_gram.eigenvalues()[k] > 1e-12)
        {
          basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
          basis.col(basis.cols() - 1) =
              of_gram.eigenvectors().col(k) / std::sqrt(of_gram.eigenvalues()[k]);
        }
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(
          basis.transpose() * projected.topLeftCorner(size, size) * basis);
      const Eigen::VectorXd weights = basis * ritz.eigenvectors().col(basis.cols() - 1);
      const double of_direction = size == 3 ? weights[2] : 0.;

      // direction = what is added to the old mode
      combine(of_direction, direction, weights[1], residual, 0., residual);
      combine(of_direction, direction_image, weights[1], residual_image, 0., residual_image);
      combine(weights[0], mode, 1., direction, 0., direction);
      combine(weights[0], image, 1., direction_image, 0., direction_image);
      const double mode_norm = normalize(mode, nullptr);
      combine(1. / mode_norm, image, 0., image, 0., image);
      normalize(direction, &direction_image);
      has_direction = true;
      eigenvalue = inner_products<1>(mass, {{{&mode, &image}}})[0];
      history.push_back(eigenvalue);
      if (history.size() > look_back &&
          eigenvalue - history[history.size() - 1 - look_back] < tolerance * eigenvalue)
        break;
    }
    mode.update_ghosts();
    return eigenvalue;
  }

  template <int dim>
  StepLimit SpectralEstimator<dim>::estimate(Scene<dim> &scene)
  {
    count = 0;
    const auto &partition = scene.state.partition();
    const unsigned int n_owned = partition->n_owned();
    const bool is_first = mode.partition() == nullptr;
    if (is_first)
    {
      mode.reinit(partition);
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          mode.node(i)[d] = noise(scene.state.initial_position.node(i), d);
    }
    else if (mode.partition() != partition)
      mode.move_to(partition);
    mode.update_ghosts();
    for (NodalVector *vector : {&velocity, &force, &element_force})
      if (vector->partition() != partition)
        vector->reinit(partition);

    // The viscous part depends on the step itself.
    double time_step = courant_limit(scene).time_step;
    double eigenvalue = 0;
    for (unsigned int pass = 0; pass < 6; ++pass)
    {
      eigenvalue = largest_eigenvalue(scene, time_step, is_first && pass == 0);
      const double next = 2. / std::sqrt(eigenvalue);
      const bool has_converged = std::abs(next - time_step) < 1e-3 * next;
      const bool is_elastic = pass > 0 && std::abs(next - time_step) < 1e-2 * next;
      time_step = next;
      if (has_converged || is_elastic)
        break;
    }

    StepLimit limit;
    // The eigenvalue was approached from below: the margin covers what the tolerance may have missed.
    limit.time_step = time_step * 0.996;
    double largest = -1.;
    unsigned int node = 0;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const v = mode.node(i);
      const double share = *scene.bridge->mass().node(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      // Symmetric bodies have equal shares: round-off must not choose among them.
      if (share > largest * (1. + 1e-6))
      {
        largest = share;
        node = i;
      }
    }
    StepLimit of_rank = limit;
    if (n_owned > 0)
    {
      bool is_particle = false;
      for (const Part<dim> &part : scene.parts)
        if (part.particles != nullptr)
        {
          const auto &list = part.particles->shape_functions().particle_node;
          is_particle = is_particle || std::find(list.begin(), list.end(), node) != list.end();
        }
      const bool is_element_node = *scene.element_mass.node(node) > 0.;
      of_rank.entity = is_particle && is_element_node ? "shared node"
                       : is_particle                  ? "particle"
                                                      : "FE node";
      for (unsigned int d = 0; d < 3; ++d)
        of_rank.place[d] = scene.state.position.node(node)[d];
    }
    largest = -1.;
    for (const auto &[share, entity, place] : Utilities::MPI::all_gather(
             scene.communicator,
             std::make_tuple(n_owned > 0 ? *scene.bridge->mass().node(node) *
                                               (mode.node(node)[0] * mode.node(node)[0] +
                                                mode.node(node)[1] * mode.node(node)[1] +
                                                mode.node(node)[2] * mode.node(node)[2])
                                         : 0.,
                             of_rank.entity, of_rank.place)))
      if (share > largest * (1. + 1e-6))
      {
        largest = share;
        limit.entity = entity;
        limit.place = place;
      }
    return limit;
  }

  template class SpectralEstimator<2>;
  template class SpectralEstimator<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StepEstimator, SpectralEstimator, "spectral",
                                  "the stable step of the real update operator, from its spectrum")
} // namespace tombolo
