// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/model/trial.h>

#include <deal.II/base/tensor.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The orthonormal frames of nodes of which directions are prescribed that are no axes of the
   * coordinates (ObliqueNodes). Equations of such nodes are along their frames: vectors A u and
   * matrices A K Aᵀ, where A has the axes as rows. All ranks have all of them.
   */
  template <int dim>
  class NodalFrames
  {
  public:
    NodalFrames() = default;

    /** Those of the conditions as they act now. Collective. */
    explicit NodalFrames(const Model<dim> &model)
    {
      struct Frame
      {
        dealii::types::global_dof_index node;
        dealii::Tensor<2, dim> axes;
      };
      std::vector<Frame> rank_frames;
      for (const ObliqueNode &oblique : model.conditions->oblique_nodes().all())
      {
        Frame &frame = rank_frames.emplace_back();
        frame.node = model.state.partition()->global_index(oblique.node);
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            frame.axes[k][d] = oblique.axes[k][d];
      }
      for (const auto &[node, axes] : from_all_ranks(rank_frames, model.communicator))
        frames[node] = axes;
    }

    bool is_empty() const
    {
      return frames.empty();
    }

    /** The axes of a node with a global number, by rows; null where they are those of the
     * coordinates. */
    const dealii::Tensor<2, dim> *find(const dealii::types::global_dof_index node) const
    {
      const auto found = frames.find(node);
      return found == frames.end() ? nullptr : &found->second;
    }

    /** Components along the frame from those along the axes of the coordinates. */
    void turn(const dealii::types::global_dof_index node, double *const vector) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(node))
        apply(*axes, vector);
    }

    /** The inverse. */
    void turn_back(const dealii::types::global_dof_index node, double *const vector) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(node))
        apply(dealii::transpose(*axes), vector);
    }

    /** A matrix with dim rows and columns for each of the @p nodes, by rows. */
    void turn(const std::vector<dealii::types::global_dof_index> &nodes,
              std::vector<double> &entries) const
    {
      if (std::none_of(nodes.begin(), nodes.end(),
                       [this](const dealii::types::global_dof_index node)
                       { return find(node) != nullptr; }))
        return;
      const std::size_t n_rows = nodes.size() * dim;
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b)
        {
          if (find(nodes[a]) == nullptr && find(nodes[b]) == nullptr)
            continue;
          const auto entry = [&](const unsigned int k, const unsigned int l) -> double &
          { return entries[(a * dim + k) * n_rows + b * dim + l]; };
          dealii::Tensor<2, dim> block;
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int l = 0; l < dim; ++l)
              block[k][l] = entry(k, l);
          turn(nodes[a], nodes[b], block);
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int l = 0; l < dim; ++l)
              entry(k, l) = block[k][l];
        }
    }

    /** A block of rows of one node and columns of another. */
    void turn(const dealii::types::global_dof_index row,
              const dealii::types::global_dof_index column, dealii::Tensor<2, dim> &block) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(row))
        block = *axes * block;
      if (const dealii::Tensor<2, dim> *const axes = find(column))
        block = block * dealii::transpose(*axes);
    }

    /** The rows and columns of two nodes of a spring. */
    dealii::Tensor<2, dim> block(const ContactStiffness<dim> &spring,
                                 const typename ContactStiffness<dim>::Entry &row,
                                 const typename ContactStiffness<dim>::Entry &column) const
    {
      dealii::Tensor<2, dim> result;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          result[a][b] = (spring.normal * row.normal[a] + row.weight * spring.slip[a]) *
                             (column.normal[b] + column.shift[b]) +
                         row.weight * (column.weight * spring.along[a][b] + column.shares[a][b]);
      turn(row.node, column.node, result);
      return result;
    }

    /** A vector of nodes to one of rows, dim for each owned node. */
    void turn(const NodalVector &nodes,
              dealii::LinearAlgebra::distributed::Vector<double> &rows) const
    {
      for (unsigned int i = 0; i < nodes.partition()->n_owned(); ++i)
      {
        std::array<double, dim> components;
        std::copy_n(nodes.node(i), dim, components.begin());
        turn(nodes.partition()->global_index(i), components.data());
        for (unsigned int d = 0; d < dim; ++d)
          rows.local_element(i * dim + d) = components[d];
      }
    }

  private:
    static void apply(const dealii::Tensor<2, dim> &matrix, double *const vector)
    {
      dealii::Tensor<1, dim> values;
      for (unsigned int d = 0; d < dim; ++d)
        values[d] = vector[d];
      values = matrix * values;
      for (unsigned int d = 0; d < dim; ++d)
        vector[d] = values[d];
    }

    std::unordered_map<dealii::types::global_dof_index, dealii::Tensor<2, dim>> frames;
  };

  /**
   * The nodes of an equation, and a matrix of it, by nodes that move: the motion of an image in
   * planes of symmetry is the reflected motion of its source, u_I' = R u_I, and a force on it is
   * one on its source. So with the rows R of all nodes the matrix is Pᵀ K P.
   */
  struct EquationsOfSources
  {
    /** The local @p nodes with images replaced by their sources. */
    static std::vector<unsigned int> sources_of(const NodePartition &partition,
                                                const std::vector<unsigned int> &nodes)
    {
      std::vector<unsigned int> result = nodes;
      for (unsigned int &node : result)
        if (const NodePartition::Reflected *const of = image(partition, node))
          node = of->source;
      return result;
    }

    /** The source of an image; null for other nodes. */
    static const NodePartition::Reflected *image(const NodePartition &partition,
                                                 const unsigned int node)
    {
      const unsigned int n_nodes = partition.n_owned() + partition.n_ghosts();
      return node < n_nodes ? nullptr : &partition.images()[node - n_nodes];
    }

    /** @p n_components rows and columns of @p all_entries for each of the local nodes. */
    EquationsOfSources(const NodePartition &partition,
                       const std::vector<unsigned int> &nodes_and_images,
                       const std::vector<double> &all_entries, const unsigned int n_components)
    {
      const std::vector<unsigned int> sources = sources_of(partition, nodes_and_images);
      nodes = sources;
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      // For each row: the row of its source, and the sign of the reflection.
      std::vector<std::pair<std::size_t, double>> rows;
      for (std::size_t k = 0; k < sources.size(); ++k)
      {
        const NodePartition::Reflected *const of = image(partition, nodes_and_images[k]);
        const auto first = static_cast<std::size_t>(
            std::lower_bound(nodes.begin(), nodes.end(), sources[k]) - nodes.begin());
        for (unsigned int d = 0; d < n_components; ++d)
          rows.emplace_back(first * n_components + d, of == nullptr ? 1. : of->reflection.sign[d]);
      }
      const std::size_t n_rows = nodes.size() * n_components;
      matrix.assign(n_rows * n_rows, 0.);
      for (std::size_t a = 0; a < rows.size(); ++a)
        for (std::size_t b = 0; b < rows.size(); ++b)
          matrix[rows[a].first * n_rows + rows[b].first] +=
              rows[a].second * rows[b].second * all_entries[a * rows.size() + b];
    }

    std::vector<unsigned int> nodes; ///< local numbers, without images, each once
    std::vector<double> matrix;      ///< by rows
  };

  /** A step of a body at rest, from one time to the next. */
  struct StaticInterval
  {
    double begin = 0, end = 0;
    unsigned long step = 0; ///< its number, for messages
    /** Prescribed velocities move nothing: the initial state goes to its equilibrium. */
    bool is_start = false;
    const NodalVector *temperature = nullptr; ///< at the end, ghosts current; null without heat

    double duration() const
    {
      return end - begin;
    }
  };

  /**
   * The equations of a static step, R(u) = F_int(x_n + u) + F_ext(x_n + u) = 0 at the components of
   * nodes that nothing prescribes, where u is the displacement of the step, and u itself at the
   * others: the force evaluation of explicit steps with the velocity u/Δt from the material points
   * as they were at the start (Trial), so that it can be evaluated at any u, any number of times,
   * as can processes (ModelSignals::trials). Springs of contacts are those of explicit steps at the
   * step of eq. (41), α m c²/h² at a node, which no longer depends on any time, times a factor.
   *
   * Vectors have the partition of the model, without images; ghosts of u must be current.
   */
  template <int dim>
  class StaticProblem
  {
  public:
    /** Springs of contacts are by @p spring_factor stiffer than those of explicit steps.
     * Collective. */
    StaticProblem(Model<dim> &model, double spring_factor);

    /** Begins a step from the present state. Collective. */
    void begin(const StaticInterval &interval);

    /** Evaluates R at @p displacement. Returns false, on all ranks, where there is none: a cell is
     * turned inside out, for example; see failure(). Collective. */
    bool evaluate(const NodalVector &displacement);

    /** Keeps the last evaluation. */
    void commit()
    {
      trial->commit();
      trial.reset();
      model.state.velocity.set_zero();
    }

    /** Restores positions and points of the start of the step. Collective. */
    void undo();

    /** Restores the material points of the start of the step, before parts are evaluated from
     * outside. */
    void restart_points()
    {
      trial->restart();
    }

    /** R of owned nodes, zero at prescribed components [M L/T^2]. */
    const NodalVector &residual() const
    {
      return free_force;
    }

    /** |R| over all ranks; the same bits on all. Collective. */
    double residual_norm() const;

    /** A node with the largest R, for a message. Collective. */
    std::string largest_residual() const;

    /** The prescribed displacements of the step, zero elsewhere; ghosts current. */
    const NodalVector &prescribed() const
    {
      return prescribed_displacement;
    }

    /** Whether any of them is not zero. */
    bool is_driven() const
    {
      return has_driven_nodes;
    }

    /** The frames of nodes of which directions are prescribed that are no axes. */
    const NodalFrames<dim> &frames() const
    {
      return nodal_frames;
    }

    /** One at prescribed components of nodes, along their frames, zero at the others; ghosts
     * current. */
    const NodalVector &constrained() const
    {
      return mask;
    }

    /** The largest sum of forces of cells at the nodes so far (its norm): the scale of residuals [M
     * L/T^2]. */
    double force_scale = 0;

    /** The effect of rounded positions on R; zero before the stiffness of the step is computed [M
     * L/T^2]. */
    double round_off = 0;

    /** The forces that R is compared with where it may be @p tolerance of them: the force scale,
     * or, where strains nearly vanish, those of which round-off is such a part. */
    double scale(const double tolerance) const
    {
      return std::max(force_scale, round_off / tolerance);
    }

    /** @p norm over this scale, at most @p tolerance where R with that norm is small. */
    double relative(const double norm, const double tolerance) const
    {
      const double reference = scale(tolerance);
      return reference > 0. ? norm / reference : norm > 0. ? 1. : 0.;
    }

    /** The work of the residual of the last evaluation, or of its round-off, over the displacement
     * of the step: the uncertainty of all works [M L^2/T^2]. Collective. */
    double unresolved_work() const;

    /** Whether a stop is requested, the same on all ranks; null: never. Collective. */
    std::function<bool()> must_stop;

    Model<dim> &model;
    /** How the forces of processes in the last evaluation change with positions: @p springs, and
     * in @p bound a diagonal matrix at owned nodes. Collective. */
    void linearize_processes(std::vector<ContactStiffness<dim>> &springs, NodalVector &bound)
    {
      linearize(process_clock(), springs, bound);
    }

    /** The springs of processes in the present state, at the start of the run. Collective. */
    std::vector<ContactStiffness<dim>> springs_at_start();

    const std::string &failure() const
    {
      return failure_text;
    }
    std::uint64_t n_evaluations() const
    {
      return count;
    }

    MechanicalInput input() const
    {
      return {&model.state.position, &model.state.velocity, present.duration(),
              present.temperature};
    }

  private:
    void set_constrained();
    /** Sets the prescribed components of an owned node to zero. */
    void remove_constrained(unsigned int node, double *vector) const;
    std::string evaluate_parts();
    /** The step as a clock for processes. */
    Clock process_clock() const;
    void begin_trials(const Clock &clock);
    void restart_processes();
    void linearize(const Clock &clock, std::vector<ContactStiffness<dim>> &springs,
                   NodalVector &bound);
    /** Calls @p use for processes that act in such steps. */
    template <typename Use>
    void for_acting(const Use &use)
    {
      for (const auto &process : model.processes)
        if (process->roles.rest == ProcessRole::acts)
          use(*process);
    }

    Assembly<dim> assembly;
    std::unique_ptr<Trial<dim>> trial;
    StaticInterval present;
    NodalVector start_position;
    NodalFrames<dim> nodal_frames;
    NodalVector mask, prescribed_displacement, free_force;
    Records node_records;  ///< of the heat that processes add
    double spring_time;    ///< for the stiffness of springs of contacts [T]
    double touch_distance; ///< bodies nearer than this touch [L]
    bool has_driven_nodes = false;
    std::string failure_text;
    std::uint64_t count = 0;
  };

  /** How the solution of a static step went. */
  struct StaticSolution
  {
    bool has_converged = false;
    unsigned int n_iterations = 0;
    double residual = 0;      ///< |R| over the scale of forces
    std::string report;       ///< norms by iteration, or the failure
    std::string advice;       ///< where it has not converged: an entry that may help, as a sentence
    bool was_stopped = false; ///< by StaticProblem::must_stop
  };

  /** Finds the equilibrium of a static step: a plug-in, `Time integration`. */
  template <int dim>
  class StaticSolver
  {
  public:
    virtual ~StaticSolver() = default;

    /** Solves R(u) = 0 up to |R| <= @p tolerance times the force scale, from u = 0. The last
     * evaluation of the problem is that of the solution, where there is one. The same on all ranks.
     * Collective. */
    virtual StaticSolution solve(StaticProblem<dim> &problem, double tolerance) = 0;

    /** Whether so many iterations are few, so that the next step may be longer. */
    virtual bool was_easy(const StaticSolution &solution) const = 0;

    /** Evaluations of the forces of all cells beside those of the problem: a matrix costs as many
     * as a cell has components. */
    virtual double further_evaluations() const
    {
      return 0.;
    }

    /** Adds its costs so far. */
    virtual void add_to_summary(Json & /*summary*/) const {}
  };

  template <int dim>
  struct PluginKind<StaticSolver<dim>>
  {
    static constexpr const char *name = "static solver";
  };
} // namespace tombolo
