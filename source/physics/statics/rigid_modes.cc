// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/rigid_modes.h>

#include <tombolo/base/input/parameter_scanner.h>
#include <tombolo/mesh/bodies.h>

#include <deal.II/lac/lapack_full_matrix.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <sstream>

namespace tombolo
{
  namespace
  {
    /** Sums over the nodes of a body: number and positions of held components, the largest
     * distance, their displacements by rigid motions. */
    using BodySums = std::map<types::global_dof_index, std::vector<double>>;

    BodySums sum_over_ranks(const BodySums &local, const MPI_Comm communicator)
    {
      BodySums result;
      for (const BodySums &rank_sums : Utilities::MPI::all_gather(communicator, local))
        for (const auto &[body, values] : rank_sums)
        {
          std::vector<double> &sums = result[body];
          sums.resize(values.size(), 0.);
          for (std::size_t i = 0; i < values.size(); ++i)
            sums[i] += values[i];
        }
      return result;
    }

    template <int dim>
    std::vector<std::string> free_motions(const std::vector<double> &gram, const double extent)
    {
      constexpr unsigned int n = n_rigid_modes<dim>;
      LAPACKFullMatrix<double> matrix(n, n);
      double trace = 0;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          matrix(i, j) = gram[i * n + j] / ((i < dim ? 1. : extent) * (j < dim ? 1. : extent));
      for (unsigned int i = 0; i < n; ++i)
        trace += matrix(i, i);
      const double small = 1e-12 * std::max(trace, 1e-300);
      std::vector<std::string> result;
      for (unsigned int i = 0; i < n; ++i)
        if (!(matrix(i, i) > small))
        {
          const unsigned int axis = i < dim ? i : dim == 2 ? 2 : i - dim;
          result.push_back(std::string(i < dim ? "move along " : "turn about ") + "xyz"[axis]);
        }
      matrix.compute_eigenvalues();
      std::size_t n_free = 0;
      for (unsigned int i = 0; i < n; ++i)
        n_free += matrix.eigenvalue(i).real() > small ? 0 : 1;
      if (n_free > result.size())
        result.emplace_back("turn about a point or an axis elsewhere");
      return result;
    }
    /** Holds a body along a direction at a position. */
    template <int dim>
    struct Hold
    {
      types::global_dof_index body;
      std::array<double, 3> position;
      Tensor<1, dim> direction;
    };

    /** An axis of the frame of an owned node. */
    template <int dim>
    Tensor<1, dim> axis_at(const Model<dim> &model, const unsigned int node, const unsigned int d)
    {
      Tensor<1, dim> result = Point<dim>::unit_vector(d);
      if (const ObliqueNode *const oblique = model.conditions->oblique_nodes().find(node))
        for (unsigned int e = 0; e < dim; ++e)
          result[e] = oblique->axes[d][e];
      return result;
    }

    using BodyOfNode = std::function<types::global_dof_index(types::global_dof_index)>;

    /** The rigid motions of bodies that none of these holds prevents, in words. Collective. */
    template <int dim>
    std::string free_motions_of_bodies(const Model<dim> &model, const BodyOfNode &body_of,
                                       const std::vector<Hold<dim>> &holds)
    {
      const NodePartition &partition = *model.state.partition();
      const NodalVector &position = model.state.position;
      BodySums position_sums; // number of nodes, their sum, number of holds, their sum
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
      {
        std::vector<double> &sums = position_sums[body_of(partition.global_index(i))];
        sums.resize(8, 0.);
        sums[0] += 1.;
        for (unsigned int d = 0; d < dim; ++d)
          sums[1 + d] += position.node(i)[d];
      }
      for (const Hold<dim> &hold : holds)
      {
        std::vector<double> &sums = position_sums[hold.body];
        sums.resize(8, 0.);
        sums[4] += 1.;
        for (unsigned int d = 0; d < dim; ++d)
          sums[5 + d] += hold.position[d];
      }
      position_sums = sum_over_ranks(position_sums, model.communicator);

      constexpr unsigned int n = n_rigid_modes<dim>;
      BodySums grams; // and the sum of squared distances from the middle of the nodes
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
      {
        const types::global_dof_index body = body_of(partition.global_index(i));
        const std::vector<double> &sums = position_sums[body];
        std::vector<double> &gram = grams[body];
        gram.resize(n * n + 1, 0.);
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double from_middle = position.node(i)[d] - sums[1 + d] / sums[0];
          gram[n * n] += from_middle * from_middle / sums[0];
        }
      }
      for (const Hold<dim> &hold : holds)
      {
        const std::vector<double> &sums = position_sums[hold.body];
        std::vector<double> &gram = grams[hold.body];
        gram.resize(n * n + 1, 0.);
        std::array<double, 3> arm{};
        for (unsigned int d = 0; d < dim; ++d)
          arm[d] = hold.position[d] - sums[5 + d] / sums[4];
        std::array<double, 6> motion{};
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::array<double, 6> along = rigid_motion_along<dim>(d, arm);
          for (unsigned int a = 0; a < n; ++a)
            motion[a] += hold.direction[d] * along[a];
        }
        for (unsigned int a = 0; a < n; ++a)
          for (unsigned int b = 0; b < n; ++b)
            gram[a * n + b] += motion[a] * motion[b];
      }
      grams = sum_over_ranks(grams, model.communicator);

      std::string result;
      for (const auto &[body, gram] : grams)
      {
        const std::vector<std::string> free = free_motions<dim>(gram, std::sqrt(gram[n * n]));
        if (free.empty())
          continue;
        std::ostringstream text;
        const std::vector<double> &sums = position_sums[body];
        text << "the body around (" << sums[1] / sums[0];
        for (unsigned int d = 1; d < dim; ++d)
          text << ", " << sums[1 + d] / sums[0];
        text << "), which can " << joined(free, ", ");
        result += (result.empty() ? "" : "; ") + text.str();
      }
      return result;
    }

    /** Sets of bodies that contacts join: the smallest number in each, by body. */
    std::map<types::global_dof_index, types::global_dof_index>
    joined_bodies(const std::vector<std::array<types::global_dof_index, 2>> &pairs,
                  const MPI_Comm communicator)
    {
      std::map<types::global_dof_index, types::global_dof_index> result;
      const auto all = from_all_ranks(pairs, communicator);
      const auto of = [&](const types::global_dof_index body)
      { return result.try_emplace(body, body).first->second; };
      for (bool has_changed = true; has_changed;)
      {
        has_changed = false;
        for (const auto &[one, other] : all)
        {
          const types::global_dof_index smallest = std::min(of(one), of(other));
          has_changed = has_changed || of(one) != of(other);
          result[one] = result[other] = smallest;
        }
      }
      return result;
    }

    /** The numbers of the bodies of nodes, with ghosts: Bodies has those of own cells, and contacts
     * name nodes of any rank. Collective. */
    template <int dim>
    NodalVector bodies_of_nodes(const Bodies<dim> &bodies,
                                const std::shared_ptr<const NodePartition> &partition)
    {
      return scalar_field(partition,
                          [&](const unsigned int i) {
                            return static_cast<double>(bodies.body_of(partition->global_index(i)));
                          });
    }
  } // namespace

  template <int dim>
  std::string free_rigid_modes(const Model<dim> &model, const NodalVector &constrained,
                               const std::vector<ContactStiffness<dim>> &contacts)
  {
    std::optional<Bodies<dim>> mesh_bodies;
    if (model.bodies == nullptr)
      mesh_bodies.emplace(*model.nodes);
    const Bodies<dim> &bodies = mesh_bodies ? *mesh_bodies : *model.bodies;
    const NodePartition &partition = *model.state.partition();
    const auto position_of = [&](const unsigned int i)
    {
      std::array<double, 3> position{};
      std::copy_n(model.state.position.node(i), dim, position.begin());
      return position;
    };

    std::vector<Hold<dim>> by_conditions, by_partners, by_surfaces;
    for (unsigned int i = 0; i < partition.n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        if (constrained.node(i)[d] > 0.)
          by_conditions.push_back(
              {bodies.body_of(partition.global_index(i)), position_of(i), axis_at(model, i, d)});

    const NodalVector body_of_node = bodies_of_nodes(bodies, model.state.partition());
    const auto body_at = [&](const unsigned int i)
    { return static_cast<types::global_dof_index>(*body_of_node.node(i)); };
    const std::vector<types::global_dof_index> nodes = nodes_of_contacts(contacts);
    const auto far = values_of_far_nodes<types::global_dof_index>(nodes, partition, body_at);
    std::vector<std::array<types::global_dof_index, 2>> pairs;
    for (const ContactStiffness<dim> &contact : contacts)
    {
      if (!(contact.direction.norm() > 0.))
        continue;
      const types::global_dof_index body = body_at(contact.node);
      std::set<types::global_dof_index> touched{body};
      for (const auto &entry : contact.entries)
        touched.insert(partition.has(entry.node) ? body_at(partition.local_index(entry.node))
                                                 : far.at(entry.node));
      std::vector<Tensor<1, dim>> directions{contact.direction};
      for (unsigned int d = 0; contact.is_tied && d < dim; ++d)
        directions.push_back(Point<dim>::unit_vector(d));
      for (const types::global_dof_index other : touched)
      {
        pairs.push_back({{body, other}});
        for (const Tensor<1, dim> &direction : directions)
          (touched.size() > 1 ? by_partners : by_surfaces)
              .push_back({other, position_of(contact.node), direction});
      }
    }

    // Each body with its partners at rest; then bodies that contacts join, as one.
    const auto united = joined_bodies(pairs, model.communicator);
    const auto all_of = [&](std::vector<Hold<dim>> holds, const std::vector<Hold<dim>> &others)
    {
      holds.insert(holds.end(), others.begin(), others.end());
      return holds;
    };
    const std::vector<Hold<dim>> outer = all_of(by_conditions, by_surfaces);
    const std::string single_motions = free_motions_of_bodies<dim>(
        model, [&](const auto node) { return bodies.body_of(node); }, all_of(outer, by_partners));
    if (!single_motions.empty())
      return single_motions;
    const auto set_of = [&](const types::global_dof_index body)
    {
      const auto found = united.find(body);
      return found == united.end() ? body : found->second;
    };
    std::vector<Hold<dim>> set_holds = outer;
    for (Hold<dim> &hold : set_holds)
      hold.body = set_of(hold.body);
    return free_motions_of_bodies<dim>(
        model, [&](const auto node) { return set_of(bodies.body_of(node)); }, set_holds);
  }

  template std::string free_rigid_modes(const Model<2> &, const NodalVector &,
                                        const std::vector<ContactStiffness<2>> &);
  template std::string free_rigid_modes(const Model<3> &, const NodalVector &,
                                        const std::vector<ContactStiffness<3>> &);
} // namespace tombolo
