// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/approximation/row_sharing.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/particles/cell_dilatation.h>
#include <tombolo/formulations/particles/cell_integrals.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/zero_energy_control.h>
#include <tombolo/mesh/nodes.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace internal
  {
    /** Whether nodes on which nodes of @p part depend do so themselves. Collective. */
    template <int dim>
    bool has_cells_of_three_sizes(const PartSetup<dim> &setup, const unsigned int part)
    {
      if (!setup.nodes->has_dependent_nodes())
        return false;
      std::vector<dealii::types::global_dof_index> referenced_nodes;
      for (const auto &cell : setup.nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() && setup.part_cells->part_of(cell) == part)
          for (const unsigned int v : cell->vertex_indices())
            if (const DependentNode *const row =
                    setup.nodes->dependent_node(cell->vertex_dof_index(v, 0)))
              for (const auto &weight : row->weights)
                referenced_nodes.push_back(weight.first);
      return any_of_all_ranks(
          from_all_ranks(referenced_nodes, setup.communicator),
          [&](const dealii::types::global_dof_index node)
          { return setup.nodes->dependent_node(node) != nullptr; },
          setup.communicator);
    }
  } // namespace internal

  /**
   * φ and ∇φ of particles as averages over the cells around them, without a kernel and without a
   * direction: with the functions N of the linear cells, weights w of their Gauss points,
   *
   * @verbatim
   *   V_I ∇φ_J(x_I) = Σ_q w_q χ_I(ξ_q) ∇N_J(x_q),     V_I = Σ_q w_q χ_I(ξ_q)
   *   φ_J(x_I) = Σ_q w_q ψ_I(ξ_q) N_J(x_q) / Σ_q w_q ψ_I(ξ_q) - d_I · ∇φ_J(x_I)
   *   χ_I = Π_k (1 ± 2 ξ_k) / 2,   ψ_I = Π_k (1 ± 3/2 ξ_k) / 2
   * @endverbatim
   *
   * where d_I is the centre of ψ_I relative to x_I. As Σ_I χ_I = 1, the nodal forces of a constant
   * stress are those of its tractions at the boundary, lumped as by linear elements: the patch test
   * is passed to round-off in any mesh. The centre of χ_I of a particle at a plane surface is a
   * sixth of a cell inside, for which the second moments of a layered body are exact but for
   * (h/6)²: bending is not too stiff. Inside a lattice ∂φ is the central difference, averaged
   * across by (1, 10, 1)/12, and φ is (1, 6, 1)/8 an axis, for which affine smoothing has the phase
   * speed of linear elements with lumped mass.
   *
   * Corners of cells that depend on others are no particles: with N = Σ C N of the others, χ and ψ
   * of these have their shares C of those of such a corner, and all of the above stays.
   *
   * The functions are those of the initial configuration. With CellDilatation the 3/2 of ψ is 2.
   * doc/method.md, section 2.
   */
  template <int dim>
  class CellAverages
  {
  public:
    CellAverages() = default;
    explicit CellAverages(const Entries &e) : section(e.section())
    {
      requested = e.choice(
          "Shape functions", "automatic", "automatic|cell averages|moving least squares",
          "`moving least squares` on boxes along the axes (`Kernel`, `Dilation`), which can be "
          "renewed, or `cell averages` of the initial cells around a particle: these pass the "
          "patch test in any mesh, do not depend on the direction of the axes, and bend as the "
          "body does. They are there for the smoothings affine and none, a total Lagrangian "
          "configuration without bonds that fail, the bridge of the paper and cells that stay "
          "what they are. `automatic` chooses them where they are there and something moves.");
      requested_dilatation = e.choice(
          "Dilatation", "automatic", "automatic|of cells|of particles",
          "Whether the volume of a particle changes as those of the cells around it, and each cell "
          "resists a change of its volume by the bulk modulus, or `of particles`: as its own "
          "gradient says. `of cells`, nearly incompressible bodies neither lock nor have pressures "
          "that alternate, and surfaces that flow do not zigzag; it takes a fifth more time. "
          "`automatic` is `of cells` where cell averages are the functions and something moves.");
      control = ZeroEnergyControl(e);
    }

    /** Decides whether the particles have these functions, and removes equal parts without them
     * from @p setup. Throws InputError where they are requested but not possible. Collective. */
    void choose(PartSetup<dim> &setup)
    {
      reason = requested == "moving least squares" ? std::string() : obstacle(setup);
      if (requested == "cell averages" && !reason.empty())
        section.fail("Shape functions", "`cell averages` are not there with " + reason +
                                            "; allowed is `moving least squares`, or `automatic`");
      // Heated faces of a lattice are a third of a percent nearer with moving least squares.
      is_chosen = reason.empty() && (requested == "cell averages" ||
                                     (requested == "automatic" && setup.has_mechanics));
      shares_dilatation = requested_dilatation == "of cells" ||
                          (requested_dilatation == "automatic" && is_chosen && setup.has_mechanics);
      if (shares_dilatation && !is_chosen)
        section.fail("Dilatation",
                     "`of cells` needs cell averages as `Shape functions`" +
                         (reason.empty() ? std::string() : ", which are not there with " + reason));
      if (!shares_dilatation)
        if (const std::string entry = control.changed_entry(); !entry.empty())
          section.fail(entry, "it is for `Dilatation = of cells` and cell averages.");
      const auto ends = [&](const unsigned int part)
      { return !is_chosen || internal::has_cells_of_three_sizes(setup, part); };
      for (std::vector<unsigned int> *parts : {&setup.equal_parts, &setup.parts_of_other_material})
        parts->erase(std::remove_if(parts->begin(), parts->end(), ends), parts->end());
      // Where nothing is smoothed, values would only stiffen the kink between materials.
      if (section.get("Smoothing") == "none")
        setup.parts_of_other_material.clear();
      part_setup = setup;
      nodes = setup.nodes;
    }
    /** Why the part cannot have these functions; empty if it can. */
    std::string obstacle(const PartSetup<dim> &setup) const
    {
      const auto is_not = [&](const std::string &entry, const std::string &value)
      { return section.get(entry) != value ? "`" + entry + " = " + section.get(entry) + "`" : ""; };
      if (const std::string smoothing = section.get("Smoothing");
          smoothing != "affine" && smoothing != "none")
        return is_not("Smoothing", "affine");
      for (const auto &[entry, value] : {std::pair{"Configuration", "total Lagrangian"},
                                         std::pair{"Kernels across gaps", "false"}})
        if (const std::string other = is_not(entry, value); !other.empty())
          return other;
      if (section.get("Bond failure") != "none")
        return "`Bond failure`";
      if (setup.trace_bridge)
        return "the trace bridge";
      if (setup.source || setup.cells_can_leave)
        return "cells that become particles or are removed while the run goes on";
      if (internal::has_cells_of_three_sizes(setup, setup.index))
        return "cells of three sizes side by side";
      return setup.nodes->degree() > 1 ? "cells of a degree above 1" : "";
    }
    bool is_on() const
    {
      return is_chosen;
    }
    /** What the functions are and, where they could be others, why they are not, for the audit. */
    std::string description() const
    {
      if (is_chosen)
        return shares_dilatation ? "cell averages" : "cell averages, dilatation of particles";
      return "moving least squares" + (reason.empty()
                                           ? std::string()
                                           : " (cell averages are not there with " + reason + ")");
    }

    /** Computes the functions of @p particles, the nodes of the part of choose(), and sets their
     * volumes V_I, and supports that reach all in whose rows they are; with @p rounds, the rows of
     * their cells are kept in single precision. Collective. */
    void establish(ParticleSet<dim> &particles, const bool rounds)
    {
      accelerated_share = find_accelerated_shares(particles);
      std::vector<Sums> sums(particles.size());
      CellQuadrature<dim> quadrature(*nodes, value_sharpness());
      const auto sums_of = [&](const Node node)
      {
        const std::size_t index = particles.index_of(node);
        return index < sums.size() ? &sums[index] : nullptr;
      };
      // The owner of a particle has all cells around it, but not those around nodes that depend on
      // it.
      node_positions = nodes->points_depended_on();
      std::map<Node, Sums> rank_sums;
      std::vector<NodeOfCell> entries_of_cells, entries_of_dependent;
      if (shares_dilatation)
        entries_of_cells.reserve(
            std::size_t(nodes->dof_handler().get_triangulation().n_active_cells()) << dim);
      std::vector<Node> cell_nodes;
      std::vector<dealii::Point<dim>> points;
      CellIntegrals<dim> dependent_integrals({}, {});
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        const unsigned int part = part_setup.part_cells->part_of(cell);
        const bool is_own = part == part_setup.index;
        if (!part_setup.smooths_over(part))
          continue;
        nodes->cell_nodes(cell, cell_nodes);
        const bool follows =
            std::any_of(cell_nodes.begin(), cell_nodes.end(),
                        [&](const Node node) { return nodes->dependent_node(node) != nullptr; });
        if (follows ? !cell->is_locally_owned()
                    : !is_own && std::none_of(cell_nodes.begin(), cell_nodes.end(), sums_of))
          continue;
        nodes->cell_points(cell, points);
        const CellIntegrals<dim> &cell_integrals = quadrature.integrate(cell, cell_nodes, points);
        const CellIntegrals<dim> &integrals =
            follows
                ? dependent_integrals = cell_integrals.on_independent_nodes(*nodes, node_positions)
                : cell_integrals;
        if (follows)
        {
          add_cell(integrals, part, [&](const Node node) { return &rank_sums[node]; });
          for (std::size_t j = 0; j < integrals.nodes.size(); ++j)
            node_positions.emplace(integrals.nodes[j], integrals.points[j]);
        }
        else
          add_cell(integrals, part, sums_of);
        if (shares_dilatation && part_setup.is_of_equals(part))
          integrals.list_nodes(follows ? entries_of_dependent : entries_of_cells);
      }
      if (nodes->has_dependent_nodes())
        add_from_ranks(rank_sums, sums_of);
      if (shares_dilatation && nodes->has_dependent_nodes())
        for (const NodeOfCell &node : from_all_ranks(entries_of_dependent, nodes->communicator()))
          entries_of_cells.push_back(node);

      std::vector<double> volumes, squared_edges;
      make_rows(sums, volumes, squared_edges);
      if (shares_dilatation)
        dilatation.reset([&](const auto &use)
                         { for_cells_around(entries_of_cells, particles, use); },
                         particles.size(), rounds);
      particles.set_initial_volumes(volumes);
      control.reset(volumes, squared_edges);
      widen_supports(particles);
    }

    /** The dilatation of the cells around the particles; null: particles have their own. */
    CellDilatation<dim> *dilatation_of_cells()
    {
      return is_chosen && shares_dilatation ? &dilatation : nullptr;
    }

    /** Null: none is needed. */
    ZeroEnergyControl *zero_energy_control()
    {
      return is_chosen && shares_dilatation && control.is_requested() ? &control : nullptr;
    }

    /** The share of the own part in the volume of the cells around each particle. */
    const std::vector<double> &own_shares() const
    {
      return own_share;
    }

    /** Sets the rows of @p found to the nodes that have functions, once after establish(). */
    void assign(const ParticleSet<dim> &particles, const std::vector<double> &position,
                const std::vector<double> &support, Neighbourhoods<dim> &found, Stencils &stencils)
    {
      found.assign(particles.nodes(), position, support, rows, node_positions, stencils);
      node_positions.clear();
    }

    /** Fills the rows of @p stencils, once after establish(); @p share_rows: same ones once. */
    void fill(const Neighbourhoods<dim> &found, const bool share_rows, Stencils &stencils)
    {
      stencils.is_lumped = true;
      stencils.accelerated_share = accelerated_share;
      if (!share_rows || !fill_shared(found, stencils))
      {
        const std::size_t n_entries = found.neighbour_indices().size();
        stencils.value.resize_fast(n_entries);
        stencils.gradient.resize_fast(Stencils::n_gradient * n_entries + 1);
        stencils.gradient.back() = 0.;
        stencils.coefficient_start.assign(stencils.row_start.begin(), stencils.row_start.end() - 1);
        for (unsigned int row = 0; row < rows.size(); ++row)
        {
          const std::size_t start = stencils.row_start[row];
          copy_row(found, stencils, row, stencils.value.data() + start,
                   stencils.gradient.data() + Stencils::n_gradient * start);
        }
      }
      std::vector<std::vector<Entry>>().swap(rows);
    }

  private:
    /** s of ψ: on long waves S and the stiffness of cells together have the phase speed of linear
     * elements, or S alone has. */
    double value_sharpness() const
    {
      return shares_dilatation ? 2. : 1.5;
    }

    struct Entry
    {
      ImageNode node;
      double value = 0;
      double gradient[3] = {};
    };
    /** Sums over the cells around a particle; all but volumes include images of cells. Cells of
     * other materials count for values alone. */
    struct Totals
    {
      bool has_other_materials = false;
      double volume = 0, own_volume = 0, image_volume = 0, weight = 0, squared_edge = 0;
      double moment[dim] = {};
    };
    struct Sums : Totals
    {
      Entry &at(const ImageNode &node)
      {
        if (entries.empty())
          entries.reserve(dim == 2 ? 9 : 27); // of a lattice
        const auto found =
            std::lower_bound(entries.begin(), entries.end(), node,
                             [](const Entry &a, const ImageNode &b) { return a.node < b; });
        if (found != entries.end() && found->node == node)
          return *found;
        Entry entry;
        entry.node = node;
        return *entries.insert(found, entry);
      }

      std::vector<Entry> entries; // by node
    };
    using Node = dealii::types::global_dof_index;
    using NodeOfCell = typename CellIntegrals<dim>::NodeOfCell;
    /** Calls @p use with those of the listed cells that have some of @p particles. */
    template <typename Use>
    void for_cells_around(const std::vector<NodeOfCell> &list, const ParticleSet<dim> &particles,
                          const Use &use) const
    {
      typename CellDilatation<dim>::Cell cell;
      for (std::size_t begin = 0; begin < list.size(); begin += list[begin].n_nodes)
      {
        cell.nodes.clear();
        cell.gradient.clear();
        cell.shares.clear();
        for (std::size_t i = begin; i < begin + list[begin].n_nodes; ++i)
        {
          cell.nodes.push_back(list[i].node);
          cell.gradient.emplace_back();
          for (unsigned int d = 0; d < dim; ++d)
            cell.gradient.back()[d] = list[i].gradient[d];
          if (const auto p = static_cast<unsigned int>(particles.index_of(list[i].node));
              p < particles.size())
            cell.shares.emplace_back(p, own_share[p] * list[i].volume);
        }
        if (!cell.shares.empty())
          use(cell);
      }
    }
    void copy_row(const Neighbourhoods<dim> &found, const Stencils &stencils,
                  const unsigned int row, double *value, double *gradient) const
    {
      for (std::size_t k = stencils.row_start[row]; k < stencils.row_start[row + 1]; ++k)
      {
        const Entry &entry = entry_at(found, row, found.neighbour_indices()[k]);
        *value++ = entry.value;
        gradient = std::copy_n(entry.gradient, Stencils::n_gradient, gradient);
      }
    }
    /** Fills the rows of @p stencils, same ones kept once; false if most are not the same. */
    bool fill_shared(const Neighbourhoods<dim> &found, Stencils &stencils) const
    {
      RowSharing kept;
      std::vector<std::size_t> start;
      std::vector<double> value, gradient;
      for (unsigned int row = 0; row < rows.size(); ++row)
      {
        const std::size_t n = rows[row].size();
        value.resize(n);
        gradient.resize(Stencils::n_gradient * n);
        copy_row(found, stencils, row, value.data(), gradient.data());
        start.push_back(kept.add(static_cast<unsigned int>(n), value.data(), gradient.data()));
        if (2 * kept.size() > found.neighbour_indices().size())
          return false;
      }
      stencils.coefficient_start = start;
      kept.store(stencils);
      return true;
    }
    void make_rows(std::vector<Sums> &sums, std::vector<double> &volumes,
                   std::vector<double> &squared_edges)
    {
      rows.clear();
      own_share.clear();
      for (Sums &sum : sums)
      {
        volumes.push_back(sum.own_volume);
        own_share.push_back(sum.own_volume / sum.volume);
        // Displacements have a kink between materials, which must not be resisted.
        squared_edges.push_back(sum.has_other_materials ? 1e100 : sum.squared_edge / sum.volume);
        for (Entry &entry : sum.entries)
        {
          entry.value /= sum.weight;
          for (unsigned int d = 0; d < dim; ++d)
          {
            entry.gradient[d] /= sum.image_volume;
            entry.value -= sum.moment[d] / sum.weight * entry.gradient[d];
          }
        }
        rows.push_back(std::move(sum.entries));
      }
    }
    /** Stencils::accelerated_share of @p particles with lumped volumes. Collective. */
    std::vector<double> find_accelerated_shares(const ParticleSet<dim> &particles) const
    {
      // S_A is 1 + κ h² ∂² on long waves, with κ the value of φ at the next node of a lattice. The
      // energy of v̂ is that of v but for its gradient in the bulk and, where this ends within the
      // body, v ∂v there: a layer of mass κ h in the wrong position.
      const double kappa = 0.25 - value_sharpness() / 12.;
      NodalVector shift(partition_of(*nodes, nodes->relevant()), Quantity::scalar);
      const NodePartition &partition = *shift.partition();
      std::vector<dealii::types::global_dof_index> cell_nodes;
      for (const auto &cell : part_setup.cells())
      {
        nodes->cell_nodes(cell, cell_nodes);
        const double volume = kappa * cell->measure() / (1u << (dim - 1));
        for (const unsigned int face : cell->face_indices())
          if (!cell->at_boundary(face) &&
              !part_setup.smooths_over(part_setup.part_cells->part_beyond(cell, face)))
            for (const unsigned int corner : nodes->face_node_indices(face))
            {
              const unsigned int opposite = corner ^ (1u << (face / 2));
              *shift.node(partition.local_index(cell_nodes[corner])) += volume;
              *shift.node(partition.local_index(cell_nodes[opposite])) -= volume;
            }
      }
      shift.collect();
      std::vector<double> shares;
      for (unsigned int i = 0; i < particles.size(); ++i)
        shares.push_back(1. + *shift.node(partition.local_index(particles.nodes()[i])) /
                                  particles.initial_volumes()[i]);
      return shares;
    }
    /** Adds the integrals of a cell to the sums of its nodes, where @p sums_of has some. */
    template <typename SumsOf>
    void add_cell(const CellIntegrals<dim> &integrals, const unsigned int part,
                  const SumsOf &sums_of)
    {
      const bool is_own = part == part_setup.index, is_of_equals = part_setup.is_of_equals(part);
      const auto n = static_cast<unsigned int>(integrals.nodes.size());
      const double tolerance = 1e-6 * integrals.points.front().distance(integrals.points.back());
      const Images &images = *nodes->images();
      std::vector<unsigned int> mirrors;
      for (const dealii::Point<dim> &point : integrals.points)
        mirrors.push_back(images.at(point, tolerance));
      for (unsigned int i = 0; i < n; ++i)
      {
        Sums *const sum = sums_of(integrals.nodes[i]);
        if (sum == nullptr)
        {
          node_positions.emplace(integrals.nodes[i], integrals.points[i]);
          continue;
        }
        const double volume = is_of_equals ? integrals.volume[i] : 0.;
        sum->has_other_materials = sum->has_other_materials || !is_of_equals;
        sum->volume += volume;
        sum->own_volume += is_own ? integrals.volume[i] : 0.;
        sum->squared_edge += volume * integrals.squared_edge;
        // With the images of the cell in all combinations of the mirrors of the particle.
        for (unsigned int through = 0; through <= mirrors[i]; ++through)
        {
          if ((through & ~mirrors[i]) != 0)
            continue;
          const Images::Map map = images.map(through);
          sum->image_volume += volume;
          sum->weight += integrals.weight[i];
          for (unsigned int d = 0; d < dim; ++d)
            sum->moment[d] += map.sign[d] * integrals.moment[i][d];
          for (unsigned int j = 0; j < n; ++j)
          {
            Entry &target = sum->at({integrals.nodes[j], through & ~mirrors[j]});
            target.value += integrals.value[i * n + j];
            for (unsigned int d = 0; is_of_equals && d < dim; ++d)
              target.gradient[d] += map.sign[d] * integrals.gradient[i * n + j][d];
          }
        }
      }
    }
    /** Adds the sums of all ranks for particles. Collective. */
    void add_from_ranks(const std::map<Node, Sums> &rank_sums,
                        const std::function<Sums *(Node)> &sums_of)
    {
      struct TotalsOfNode
      {
        Node node;
        Totals totals;
      };
      struct EntryOfNode
      {
        Node node;
        Entry entry;
        double position[3]; // of the node of the entry
      };
      std::vector<TotalsOfNode> totals_of_rank;
      std::vector<EntryOfNode> entries_of_rank;
      for (const auto &[node, sum] : rank_sums)
      {
        totals_of_rank.push_back({node, sum});
        for (const Entry &entry : sum.entries)
        {
          entries_of_rank.push_back({node, entry, {}});
          std::copy_n(node_positions.at(entry.node.source).begin_raw(), dim,
                      entries_of_rank.back().position);
        }
      }
      for (const auto &[node, totals] : from_all_ranks(totals_of_rank, nodes->communicator()))
        if (Sums *const sum = sums_of(node))
        {
          sum->has_other_materials = sum->has_other_materials || totals.has_other_materials;
          sum->volume += totals.volume;
          sum->own_volume += totals.own_volume;
          sum->squared_edge += totals.squared_edge;
          sum->image_volume += totals.image_volume;
          sum->weight += totals.weight;
          for (unsigned int d = 0; d < dim; ++d)
            sum->moment[d] += totals.moment[d];
        }
      for (const auto &[node, entry, position] :
           from_all_ranks(entries_of_rank, nodes->communicator()))
        if (Sums *const sum = sums_of(node))
        {
          std::copy_n(position, dim, node_positions[entry.node.source].begin_raw());
          Entry &target = sum->at(entry.node);
          target.value += entry.value;
          for (unsigned int d = 0; d < dim; ++d)
            target.gradient[d] += entry.gradient[d];
        }
    }
    /** Widens supports of @p particles so that they reach the rows that contain them. */
    void widen_supports(ParticleSet<dim> &particles) const
    {
      if (!nodes->has_dependent_nodes())
        return;
      // A particle is in the rows of those that are in its own.
      constexpr double beyond = 1.01;
      std::vector<double> supports = particles.initial_supports();
      for (unsigned int i = 0; i < particles.size(); ++i)
        for (const Entry &entry : rows[i])
        {
          const Images::Map map = nodes->images()->map(entry.node.mirrors);
          const std::size_t particle = particles.index_of(entry.node.source);
          const dealii::Point<dim> &source = particle < particles.size()
                                                 ? particles.initial_positions()[particle]
                                                 : node_positions.at(entry.node.source);
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double other = map.sign[d] * source[d] + map.offset[d];
            double &support = supports[std::size_t(i) * node_stride + d];
            support =
                std::max(support, beyond * std::abs(other - particles.initial_positions()[i][d]));
          }
        }
      particles.set_initial_supports(supports);
    }
    /** The entry of a neighbour that assign() has set. */
    const Entry &entry_at(const Neighbourhoods<dim> &found, const unsigned int row,
                          const unsigned int index) const
    {
      const auto n_nodes = static_cast<unsigned int>(found.global_nodes().size());
      const ImageNode node = index < n_nodes ? ImageNode{found.global_nodes()[index], 0}
                                             : found.images()[index - n_nodes];
      return *std::lower_bound(rows[row].begin(), rows[row].end(), node,
                               [](const Entry &a, const ImageNode &b) { return a.node < b; });
    }

    Section section;
    std::string requested, requested_dilatation, reason;
    bool is_chosen = false, shares_dilatation = false;
    CellDilatation<dim> dilatation;
    ZeroEnergyControl control;
    const Nodes<dim> *nodes = nullptr;
    PartSetup<dim> part_setup;
    std::vector<std::vector<Entry>> rows;              // by particle, ascending by node
    std::map<Node, dealii::Point<dim>> node_positions; // of rows, and others; not of all particles
    std::vector<double> accelerated_share, own_share;  // by particle
  };
} // namespace tombolo
