#include <tombolo/simulation/spectral_estimator.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/vectorization.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

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
      return ordered_sum(local, mass.partition()->communicator());
    }

    void combine(const double a, NodalVector &x, const double b, const NodalVector &y,
                 const double c, const NodalVector &z)
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
    handler.declare_entry(
        "Tolerance", "1e-4", Patterns::Double(1e-8, 0.01),
        "The iteration ends when the eigenvalue has grown by less than this "
        "fraction over ten iterations (four, where it starts from an earlier mode).");
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
  void SpectralEstimator<dim>::serialize(StateArchive &archive, const Scene<dim> &scene)
  {
    const auto group = archive.group("spectral estimator");
    archive("calls", n_calls);
    archive("has viscosity", has_viscosity);
    archive("last time step", last_time_step);
    if (n_calls == 0)
      return;
    if (archive.is_reading())
      mode.reinit(scene.state.partition());
    archive.nodal("mode", 3, mode);
  }

  template <int dim>
  unsigned int SpectralEstimator<dim>::n_applications() const
  {
    return count;
  }

  template <int dim>
  void SpectralEstimator<dim>::remove_constrained(const Scene<dim> &scene,
                                                  NodalVector &vector) const
  {
    const auto &constrained = scene.conditions->constrained_components();
    if (constrained.empty())
      return;
    for (const unsigned int node : scene.conditions->constrained_nodes())
      for (unsigned int d = 0; d < 3; ++d)
        if ((constrained[node] >> d) & 1u)
          vector.node(node)[d] = 0.;
    vector.update_ghosts();
  }

  template <int dim>
  void SpectralEstimator<dim>::apply(Scene<dim> &scene, const NodalVector &v_hat,
                                     const double time_step, NodalVector &result)
  {
    ++count;
    Bridge &bridge = *scene.bridge;
    const unsigned int n_owned = scene.state.partition()->n_owned();

    bridge.apply_smoothing(scene.state.position, v_hat, velocity);
    remove_constrained(scene, velocity);
    force.set_zero();
    const NodalVector &seen_by_elements = bridge.element_velocity(velocity);
    if (bridge.is_trace())
      element_force.set_zero();
    for (const Part<dim> &part : scene.parts)
    {
      const bool sees_particles = part.particles == nullptr && bridge.is_trace();
      part.formulation->add_stiffness_action(scene.state.position,
                                             sees_particles ? seen_by_elements : velocity,
                                             time_step, sees_particles ? element_force : force);
    }
    force.add_to_owners();
    if (bridge.is_trace())
      bridge.collect_element_force(element_force, force);
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(force.node(i)) / load_node(bridge.nodal_mass().node(i)), force.node(i));
    force.update_ghosts();
    remove_constrained(scene, force);
    bridge.apply_adjoint(scene.state.position, force, result);
    remove_constrained(scene, result);
    force.set_zero();
  }

  template <int dim>
  double SpectralEstimator<dim>::largest_eigenvalue(Scene<dim> &scene, const double time_step,
                                                    const unsigned int min_iterations)
  {
    const NodalVector &mass = scene.bridge->mass();
    const auto &partition = scene.state.partition();
    NodalVector image, residual, residual_image, direction, direction_image;
    for (NodalVector *vector : {&image, &residual, &residual_image, &direction, &direction_image})
      vector->reinit(partition);

    const auto normalize = [&](NodalVector &vector, NodalVector *its_image)
    {
      const double norm = std::sqrt(inner_products<1>(mass, {{{&vector, &vector}}})[0]);
      const double factor = norm > 0. ? 1. / norm : 0.;
      combine(factor, vector, 0., vector, 0., vector);
      if (its_image != nullptr)
        combine(factor, *its_image, 0., *its_image, 0., *its_image);
      return norm;
    };

    remove_constrained(scene, mode);
    normalize(mode, nullptr);
    apply(scene, mode, time_step, image);
    double eigenvalue = inner_products<1>(mass, {{{&mode, &image}}})[0];
    std::vector<double> history{eigenvalue};
    const unsigned int look_back = min_iterations > 10 ? 10 : 4;
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
      gram << 1., products[0], products[1], products[0], 1., products[2], products[1], products[2],
          1.;
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
      if (history.size() > std::max(look_back, min_iterations) &&
          eigenvalue - history[history.size() - 1 - look_back] < tolerance * eigenvalue)
        break;
    }
    mode.update_ghosts();
    return eigenvalue;
  }

  template <int dim>
  void SpectralEstimator<dim>::add_noise(Scene<dim> &scene, const double share)
  {
    const NodalVector &mass = scene.bridge->mass();
    const unsigned int n_owned = scene.state.partition()->n_owned();
    NodalVector random;
    random.reinit(scene.state.partition());
    for (unsigned int i = 0; i < n_owned; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        random.node(i)[d] = noise(scene.state.initial_position.node(i), 3 * n_calls + d);
    const auto products = inner_products<2>(mass, {{{&mode, &mode}, {&random, &random}}});
    combine(products[0] > 0. ? 1. / std::sqrt(products[0]) : 0., mode,
            share / std::sqrt(products[1]), random, 0., random);
    mode.update_ghosts();
  }

  template <int dim>
  double SpectralEstimator<dim>::viscous_part(Scene<dim> &scene, const double time_step)
  {
    NodalVector image;
    image.reinit(scene.state.partition());
    const NodalVector &mass = scene.bridge->mass();
    double quotient[2];
    for (const int k : {0, 1})
    {
      apply(scene, mode, (k + 1) * time_step, image);
      const auto products = inner_products<2>(mass, {{{&mode, &image}, {&mode, &mode}}});
      quotient[k] = products[0] / products[1];
    }
    // K + 2C/Δt and K + C/Δt
    const double difference = quotient[0] - quotient[1];
    return difference > 1e-9 * quotient[0] ? difference * time_step : 0.;
  }

  template <int dim>
  StepLimit SpectralEstimator<dim>::estimate(Scene<dim> &scene)
  {
    count = 0;
    const auto &partition = scene.state.partition();
    const bool is_first = n_calls == 0;
    if (is_first)
      mode.reinit(partition);
    else if (mode.partition() != partition)
      mode.move_to(partition);
    for (NodalVector *vector : {&velocity, &force, &element_force})
      if (vector->partition() != partition)
        vector->reinit(partition);
    add_noise(scene, is_first ? 1. : 0.1);
    ++n_calls;

    double time_step = is_first ? courant_limit(scene).time_step : last_time_step;
    unsigned int min_iterations = 6;
    if (is_first)
    {
      has_viscosity = viscous_part(scene, time_step) > 0.;
      // For n unknowns a Krylov space of dimension k, started from noise, misses the relative gap ε
      // with a probability below 1.65 √n exp(-√ε (2k - 1)): here 1e-3 for ε = 0.02.
      const double n = static_cast<double>(partition->n_global()) * dim;
      min_iterations =
          static_cast<unsigned int>(0.5 * (1. + std::log(1.65e3 * std::sqrt(n)) / std::sqrt(0.02)));
    }
    for (unsigned int pass = 0; pass < 12; ++pass)
    {
      const double eigenvalue = largest_eigenvalue(scene, time_step, min_iterations);
      min_iterations = 6;
      const double last = time_step;
      time_step = 2. / std::sqrt(eigenvalue);
      if (!has_viscosity)
        break;
      // For a given mode, Δt² k + 2 Δt c = 4; the mode depends on Δt to second order.
      const double viscous = viscous_part(scene, last);
      const double elastic = eigenvalue - 2. * viscous / last;
      time_step = 4. / (viscous + std::sqrt(viscous * viscous + 4. * elastic));
      if (std::abs(time_step - last) < 1e-4 * time_step)
        break;
    }
    last_time_step = time_step;

    StepLimit limit;
    // The eigenvalue was approached from below: the margin covers what the tolerance may have
    // missed.
    limit.time_step = time_step * 0.994;
    find_entity(scene, limit);
    return limit;
  }

  template <int dim>
  void SpectralEstimator<dim>::find_entity(Scene<dim> &scene, StepLimit &limit) const
  {
    const unsigned int n_owned = scene.state.partition()->n_owned();
    const auto share = [&](const unsigned int i)
    {
      const double *const v = mode.node(i);
      return *scene.bridge->mass().node(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    };
    double largest = 0.;
    for (unsigned int i = 0; i < n_owned; ++i)
      largest = std::max(largest, share(i));
    largest = Utilities::MPI::max(largest, scene.communicator);

    // Symmetric bodies have nearly equal shares; neither round-off nor the numbers that the ranks
    // give to their nodes must choose among them: of all that come close, the smallest persistent
    // id.
    const auto &ids = scene.nodes->persistent_ids();
    auto first = std::numeric_limits<std::uint64_t>::max();
    unsigned int node = 0;
    for (unsigned int i = 0; i < n_owned; ++i)
      if (share(i) >= 0.999 * largest && ids[i] < first)
      {
        first = ids[i];
        node = i;
      }
    std::string entity;
    Point<3> place;
    if (first != std::numeric_limits<std::uint64_t>::max())
    {
      bool is_particle = false;
      for (const Part<dim> &part : scene.parts)
        if (part.particles != nullptr)
        {
          const auto &list = part.particles->shape_functions().particle_node;
          is_particle = is_particle || std::find(list.begin(), list.end(), node) != list.end();
        }
      const bool is_element_node = *scene.element_mass.node(node) > 0.;
      entity = is_particle && is_element_node ? "shared node"
               : is_particle                  ? "particle"
                                              : "FE node";
      for (unsigned int d = 0; d < 3; ++d)
        place[d] = scene.state.position.node(node)[d];
    }
    auto smallest = std::numeric_limits<std::uint64_t>::max();
    for (const auto &[id, its_entity, its_place] :
         Utilities::MPI::all_gather(scene.communicator, std::make_tuple(first, entity, place)))
      if (id < smallest)
      {
        smallest = id;
        limit.entity = its_entity;
        limit.place = its_place;
      }
  }

  template class SpectralEstimator<2>;
  template class SpectralEstimator<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StepEstimator, SpectralEstimator, "spectral",
                                  "the stable step of the real update operator, from its spectrum")
} // namespace tombolo
