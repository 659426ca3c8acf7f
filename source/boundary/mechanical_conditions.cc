#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/throw_together.h>
#include <tombolo/mesh/boundary_names.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/polynomial.h>
#include <deal.II/base/quadrature_lib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <set>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    enum class ConditionType
    {
      traction,
      body_force,
      velocity,
      displacement,
      clamp
    };

    ConditionType type_of(const std::string &name)
    {
      if (name == "traction")
        return ConditionType::traction;
      if (name == "body force")
        return ConditionType::body_force;
      if (name == "velocity")
        return ConditionType::velocity;
      if (name == "displacement")
        return ConditionType::displacement;
      return ConditionType::clamp;
    }

    bool prescribes(const ConditionType type)
    {
      return type == ConditionType::velocity || type == ConditionType::displacement ||
             type == ConditionType::clamp;
    }

    template <int dim>
    Point<dim> point_of(const double *node)
    {
      Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = node[d];
      return point;
    }
  } // namespace

  template <int dim>
  struct MechanicalConditions<dim>::Condition
  {
    ConditionType type;
    std::optional<Expression<dim>> function;
    std::optional<Predicate<dim>> where;
    std::set<types::boundary_id> boundaries;
    bool is_uniform = false; // the function does not depend on the place

    std::vector<unsigned int> nodes;            // local, of the faces of a traction
    mutable std::vector<double> tributary_area; // of each of them, by this rank's faces [L^(dim-1)]

    bool selects(const Point<dim> &point) const
    {
      return !where || (*where)(point);
    }
  };

  template <int dim>
  void MechanicalConditions<dim>::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(
        handler, "Type",
        Patterns::Selection("traction|body force|velocity|displacement|clamp|symmetry"),
        "What is prescribed: `traction` (force per current area, on faces of the boundary), `body "
        "force` (force per mass), `velocity`, `displacement`, `clamp` (no motion), or `symmetry` "
        "(the "
        "nodes that it selects are all those on one plane normal to an axis, beyond which the body "
        "is its own mirror image).");
    handler.declare_entry(
        "Where", "", Patterns::Anything(),
        "A predicate of the initial position, for example `x < 1e-9`. For a "
        "traction it selects faces of the boundary by their centre, otherwise nodes.");
    handler.declare_entry("Boundary", "", Patterns::Anything(),
                          "Names of boundaries, separated by commas, instead of or together with "
                          "`Where`.");
    handler.declare_entry(
        "Function", "", Patterns::Anything(),
        "Components separated by `;`, functions of the initial position x, y, z "
        "and of the time t. For a velocity or a displacement the word `free` leaves a "
        "component free. Units: M/(L T^2) for a traction, L/T^2 for a body force, L/T "
        "for a velocity, L for a displacement.");
  }

  template <int dim>
  typename MechanicalConditions<dim>::Condition
  MechanicalConditions<dim>::read(const Section &section)
  {
    Condition condition;
    condition.type = type_of(section.get("Type"));
    const bool has_where = !section.get("Where").empty();
    const bool has_boundary = !section.get("Boundary").empty();
    if (has_where)
      condition.where.emplace(section, "Where");
    if (!has_where && !has_boundary && condition.type != ConditionType::body_force)
      section.fail("", "a condition needs `Where`, a predicate such as \"x < 1e-9\", or "
                       "`Boundary`, the name of a boundary.");
    if (condition.type == ConditionType::body_force && has_boundary)
      section.fail("Boundary", "a body force acts on the volume; use `Where`, or neither.");
    if (condition.type == ConditionType::clamp)
    {
      if (section.is_set("Function"))
        section.fail("Function", "a clamp needs no function; for a prescribed motion use `Type = "
                                 "velocity` or `displacement`.");
      return condition;
    }
    condition.function.emplace(section, "Function", dim, prescribes(condition.type));
    condition.is_uniform = !std::regex_search(section.get("Function"),
                                              std::regex("(^|[^A-Za-z_])[xyz]($|[^A-Za-z_0-9(])"));
    return condition;
  }

  template <int dim>
  void MechanicalConditions<dim>::validate(const Section &section)
  {
    read(section);
  }

  template <int dim>
  MechanicalConditions<dim>::MechanicalConditions(const std::vector<Section> &sections,
                                                  const Mesh<dim> &mesh, const Nodes<dim> &nodes)
      : owned(nodes.owned()), nodes_of_faces(nodes.owned().size())
  {
    for (const Section &section : sections)
    {
      Condition condition = read(section);
      if (!section.get("Boundary").empty())
        condition.boundaries = boundary_ids(mesh, section, "Boundary");
      conditions.push_back(std::move(condition));
    }

    std::vector<unsigned long> n_selected(conditions.size(), 0);
    std::map<types::global_dof_index, Constraint> found;
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> cell_points;
    const auto mark =
        [&](const types::global_dof_index node, const Point<dim> &point, const unsigned int c)
    {
      const Condition &condition = conditions[c];
      if (!condition.selects(point))
        return;
      if (owned.is_element(node))
        ++n_selected[c];
      else
        return;
      if (!prescribes(condition.type))
        return;
      auto [position, is_new] = found.try_emplace(node);
      if (is_new)
      {
        position->second.global_node = node;
        position->second.condition.fill(-1);
      }
      for (unsigned int d = 0; d < dim; ++d)
        if (condition.type == ConditionType::clamp || !condition.function->is_free(d))
          position->second.condition[d] = static_cast<int>(c);
    };

    const auto select = [&](const auto &cell)
    {
      if (cell->is_artificial())
        return;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, cell_points);
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (conditions[c].boundaries.empty() && conditions[c].type != ConditionType::traction)
          for (unsigned int k = 0; k < cell_nodes.size(); ++k)
            mark(cell_nodes[k], cell_points[k], c);
      for (const unsigned int f : cell->face_indices())
      {
        if (!cell->face(f)->at_boundary())
          continue;
        const std::vector<unsigned int> &face_nodes = nodes.face_places(f);
        for (unsigned int c = 0; c < conditions.size(); ++c)
        {
          const Condition &condition = conditions[c];
          if (condition.type == ConditionType::traction)
          {
            if (!cell->is_locally_owned())
              continue;
            if (!condition.boundaries.empty() &&
                condition.boundaries.count(cell->face(f)->boundary_id()) == 0)
              continue;
            if (!condition.selects(cell->face(f)->center()))
              continue;
            ++n_selected[c];
            Face face;
            face.condition = c;
            for (const unsigned int k : face_nodes)
            {
              face.global_nodes.push_back(cell_nodes[k]);
              nodes_of_faces.add_index(cell_nodes[k]);
            }
            faces.push_back(face);
          }
          else if (condition.boundaries.count(cell->face(f)->boundary_id()) > 0)
            for (const unsigned int k : face_nodes)
              mark(cell_nodes[k], cell_points[k], c);
        }
      }
    };
    // A predicate can be without a value where only one rank looks.
    std::string failure;
    try
    {
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        select(cell);
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_together<InputError>(failure, nodes.communicator());
    nodes_of_faces.compress();

    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (Utilities::MPI::sum(n_selected[c], nodes.communicator()) == 0)
      {
        const bool is_traction = conditions[c].type == ConditionType::traction;
        const char *const entry = conditions[c].where ? "Where" : "Boundary";
        sections[c].fail(entry, std::string("the condition selects no ") +
                                    (is_traction ? "face of the boundary" : "node") +
                                    "; it would do nothing.");
      }

    for (auto &[node, constraint] : found)
      constraints.push_back(constraint);
    prepare_face_quadrature(nodes.degree());
  }

  template <int dim>
  MechanicalConditions<dim>::~MechanicalConditions() = default;

  template <int dim>
  void MechanicalConditions<dim>::prepare_face_quadrature(const unsigned int degree)
  {
    const QGaussLobatto<1> support_points(degree + 1);
    const auto polynomials =
        Polynomials::generate_complete_Lagrange_basis(support_points.get_points());
    const QGauss<dim - 1> quadrature(degree + 1);
    const unsigned int n = degree + 1;
    nodes_per_face = dim == 2 ? n : n * n;
    std::vector<double> value_and_derivative(2);
    for (unsigned int q = 0; q < quadrature.size(); ++q)
    {
      quadrature_weights.push_back(quadrature.weight(q));
      std::vector<double> values[2], derivatives[2];
      for (unsigned int d = 0; d < dim - 1; ++d)
        for (unsigned int i = 0; i < n; ++i)
        {
          polynomials[i].value(quadrature.point(q)[d], value_and_derivative);
          values[d].push_back(value_and_derivative[0]);
          derivatives[d].push_back(value_and_derivative[1]);
        }
      for (unsigned int k = 0; k < nodes_per_face; ++k)
        shape_values.push_back(dim == 2 ? values[0][k] : values[0][k % n] * values[1][k / n]);
      for (unsigned int d = 0; d < dim - 1; ++d)
        for (unsigned int k = 0; k < nodes_per_face; ++k)
          shape_derivatives.push_back(dim == 2 ? derivatives[0][k]
                                      : d == 0 ? derivatives[0][k % n] * values[1][k / n]
                                               : values[0][k % n] * derivatives[1][k / n]);
    }
  }

  template <int dim>
  IndexSet MechanicalConditions<dim>::required_nodes() const
  {
    return nodes_of_faces;
  }

  template <int dim>
  void MechanicalConditions<dim>::set_partition(const NodePartition &partition)
  {
    std::vector<std::map<unsigned int, unsigned int>> place_of_node(conditions.size());
    for (Condition &condition : conditions)
      condition.nodes.clear();
    for (Face &face : faces)
    {
      face.nodes.clear();
      face.places.clear();
      Condition &condition = conditions[face.condition];
      for (const types::global_dof_index global_node : face.global_nodes)
      {
        const unsigned int node = partition.local_index(global_node);
        const auto [place, is_new] = place_of_node[face.condition].try_emplace(
            node, static_cast<unsigned int>(condition.nodes.size()));
        if (is_new)
          condition.nodes.push_back(node);
        face.nodes.push_back(node);
        face.places.push_back(place->second);
      }
    }
    for (Condition &condition : conditions)
      condition.tributary_area.assign(condition.nodes.size(), 0.);
    constrained.clear();
    constraint_nodes.clear();
    if (Utilities::MPI::max(constraints.empty() ? 0 : 1, partition.communicator()) == 0)
      return;
    constrained.assign(partition.n_owned(), 0);
    for (Constraint &constraint : constraints)
    {
      constraint.node = partition.local_index(constraint.global_node);
      constraint_nodes.push_back(constraint.node);
      for (unsigned int d = 0; d < dim; ++d)
        if (constraint.condition[d] >= 0)
          constrained[constraint.node] =
              static_cast<std::uint8_t>(constrained[constraint.node] | (1u << d));
    }
  }

  template <int dim>
  const std::vector<std::uint8_t> &MechanicalConditions<dim>::constrained_components() const
  {
    return constrained;
  }

  template <int dim>
  const std::vector<unsigned int> &MechanicalConditions<dim>::constrained_nodes() const
  {
    return constraint_nodes;
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_loads() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const Condition &condition) { return !prescribes(condition.type); });
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_constraints() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const Condition &condition) { return prescribes(condition.type); });
  }

  template <int dim>
  std::vector<unsigned int> MechanicalConditions<dim>::loaded_nodes(const NodalState &state) const
  {
    NodalVector mark;
    mark.reinit(state.partition(), 1);
    for (const Face &face : faces)
      for (const unsigned int node : face.nodes)
        *mark.node(node) = 1.;
    mark.add_to_owners();
    std::vector<unsigned int> result;
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      bool is_loaded = *mark.node(i) > 0.;
      for (const Condition &condition : conditions)
        if (condition.type == ConditionType::body_force)
          is_loaded = is_loaded || condition.selects(point_of<dim>(state.initial_position.node(i)));
      if (is_loaded)
        result.push_back(i);
    }
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::compute_loads(const NodalState &state, const double time,
                                                NodalVector &loads) const
  {
    loads.set_zero();
    for (const Condition &condition : conditions)
      std::fill(condition.tributary_area.begin(), condition.tributary_area.end(), 0.);
    for (const Face &face : faces)
    {
      const Condition &condition = conditions[face.condition];
      for (unsigned int q = 0; q < quadrature_weights.size(); ++q)
      {
        Tensor<1, dim> tangents[dim - 1];
        for (unsigned int d = 0; d < dim - 1; ++d)
          for (unsigned int k = 0; k < nodes_per_face; ++k)
            tangents[d] += shape_derivatives[(q * (dim - 1) + d) * nodes_per_face + k] *
                           point_of<dim>(state.position.node(face.nodes[k]));
        double area = quadrature_weights[q];
        if constexpr (dim == 2)
          area *= tangents[0].norm();
        else
          area *= cross_product_3d(tangents[0], tangents[1]).norm();
        for (unsigned int k = 0; k < nodes_per_face; ++k)
          condition.tributary_area[face.places[k]] += area * shape_values[q * nodes_per_face + k];
      }
    }
    const auto add_tractions = [&]()
    {
      for (const Condition &condition : conditions)
      {
        if (condition.nodes.empty())
          continue;
        double traction[3] = {0, 0, 0};
        for (unsigned int k = 0; k < condition.nodes.size(); ++k)
        {
          if (k == 0 || !condition.is_uniform)
            for (unsigned int d = 0; d < dim; ++d)
              traction[d] = condition.function->value(
                  point_of<dim>(state.initial_position.node(condition.nodes[k])), time, d);
          for (unsigned int d = 0; d < dim; ++d)
            loads.node(condition.nodes[k])[d] += traction[d] * condition.tributary_area[k];
        }
      }
    };
    const auto add_body_forces = [&]()
    {
      for (const Condition &condition : conditions)
        if (condition.type == ConditionType::body_force)
          for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          {
            const Point<dim> initial = point_of<dim>(state.initial_position.node(i));
            if (condition.selects(initial))
              for (unsigned int d = 0; d < dim; ++d)
                loads.node(i)[d] +=
                    *state.mass.node(i) * condition.function->value(initial, time, d);
          }
    };
    evaluate(add_tractions);
    loads.add_to_owners();
    evaluate(add_body_forces);
  }

  template <int dim>
  void MechanicalConditions<dim>::evaluate(const std::function<void()> &action) const
  {
    try
    {
      action();
    }
    catch (const RunError &error)
    {
      if (local_failure.empty())
        local_failure = error.what();
    }
  }

  template <int dim>
  const std::string &MechanicalConditions<dim>::failure() const
  {
    return local_failure;
  }

  template <int dim>
  double MechanicalConditions<dim>::prescribed_velocity(
      const Condition &condition, const Point<dim> &initial, const double *position,
      const unsigned int component, const double time, const double position_time_step) const
  {
    if (condition.type == ConditionType::clamp)
      return 0.;
    if (condition.type == ConditionType::velocity)
      return condition.function->value(initial, time + 0.5 * position_time_step, component);
    return (initial[component] +
            condition.function->value(initial, time + position_time_step, component) -
            position[component]) /
           position_time_step;
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_acceleration(NodalState &state, const double time,
                                                         const double velocity_time_step,
                                                         const double position_time_step) const
  {
    const auto prescribe = [&]()
    {
      for (const Constraint &constraint : constraints)
        for (unsigned int d = 0; d < dim; ++d)
          if (constraint.condition[d] >= 0)
          {
            const double target = prescribed_velocity(
                conditions[static_cast<unsigned int>(constraint.condition[d])],
                point_of<dim>(state.initial_position.node(constraint.node)),
                state.position.node(constraint.node), d, time, position_time_step);
            state.acceleration.node(constraint.node)[d] =
                (target - state.unsmoothed_velocity.node(constraint.node)[d]) / velocity_time_step;
          }
    };
    evaluate(prescribe);
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_initial_velocity(NodalState &state,
                                                             const double time) const
  {
    const auto prescribe = [&]()
    {
      for (const Constraint &constraint : constraints)
        for (unsigned int d = 0; d < dim; ++d)
          if (constraint.condition[d] >= 0)
          {
            const Condition &condition =
                conditions[static_cast<unsigned int>(constraint.condition[d])];
            if (condition.type == ConditionType::displacement)
              continue;
            state.unsmoothed_velocity.node(constraint.node)[d] = prescribed_velocity(
                condition, point_of<dim>(state.initial_position.node(constraint.node)),
                state.position.node(constraint.node), d, time, 0.);
          }
    };
    evaluate(prescribe);
  }

  template class MechanicalConditions<2>;
  template class MechanicalConditions<3>;
} // namespace tombolo
