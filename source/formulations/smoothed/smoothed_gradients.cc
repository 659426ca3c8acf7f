// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <tombolo/approximation/moved_convex_values.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/smoothed/cell_surroundings.h>

#include <algorithm>
#include <array>
#include <string>

namespace tombolo
{
  /** The gradients at one point of a cell, by node, and the volume of the point. */
  template <int dim>
  struct SmoothedRow
  {
    std::vector<std::pair<types::global_dof_index, Tensor<1, dim>>> entries;
    double volume = 0;
  };

  namespace
  {
    /** Computes the rows of one cell after the other. */
    template <int dim>
    class SmoothedRowBuilder
    {
    public:
      /** With the present @p position of the nodes, or null. */
      SmoothedRowBuilder(const CellSurroundings<dim> &surroundings,
                         const std::shared_ptr<const Kernel> &kernel, const NodalVector *position)
          : surroundings(surroundings), cloud(surroundings.cloud), approximation(kernel),
            moved_values(kernel), position(position)
      {
        if (position == nullptr)
          return;
        const std::vector<bool> is_there = surroundings.reaches_cells();
        present_cloud.resize(cloud.position.size());
        for (std::size_t i = 0; i < cloud.node.size(); ++i)
          if (is_there[i])
            std::copy_n(position->node(position->partition()->local_index(cloud.node[i])),
                        node_stride, present_cloud.begin() + std::ptrdiff_t(i * node_stride));
        shared_values.resize(surroundings.shared_facets.size());
        nodes_of_shared.reserve(8 * shared_values.size()); // as many as a facet has in a lattice
      }

      /** Appends the rows of cell number @p c. Returns an error message, or nothing. */
      std::string add_cell(const std::size_t c, const SmoothedIntegrationRule rule,
                           std::vector<SmoothedRow<dim>> &rows)
      {
        number_of_cell = c;
        cell = &surroundings.cells[c];
        corners = cell->corners;
        for (unsigned int k = 0; k < corners.size() && position != nullptr; ++k)
          corners[k] = present_position(cell->nodes[k]);
        surroundings.find_neighbours(c, hits);
        const auto gather =
            [this](const std::vector<double> &cloud_values, std::vector<double> &hit_values)
        {
          hit_values.clear();
          for (const std::size_t i : hits)
            hit_values.insert(hit_values.end(), &cloud_values[i * node_stride],
                              &cloud_values[i * node_stride] + node_stride);
        };
        gather(cloud.position, positions);
        gather(cloud.support, supports);
        if (position != nullptr)
          gather(present_cloud, present);
        values.resize(hits.size());
        return rule == SmoothedIntegrationRule::smoothed ? add_sub_cells(rows) : add_point(rows);
      }

    private:
      using Parts = SubCells<dim>;

      /** A facet of the sub-cells of the cell. */
      struct PlacedFacet
      {
        Point<dim> initial, now; ///< its centroid
        Tensor<1, dim> area;     ///< present one
        unsigned int from, to;   ///< as in SubCells::Facet
        bool is_on_boundary;
      };

      /** Neighbours, by their index among the hits, and their values. */
      using Values = std::vector<std::pair<std::size_t, double>>;

      /** Where the values of a facet of two cells are. */
      struct SharedValues
      {
        std::size_t first = 0, n = 0;
      };

      /** Values at a point that was at @p initial in the initial configuration, and gradients, with
       * @p inverse the derivative of that position with respect to the present one. */
      bool evaluate(const Point<dim> &initial, const Point<dim> &now,
                    Tensor<1, dim> *const gradient = nullptr,
                    const Tensor<2, dim> &inverse = Tensor<2, dim>())
      {
        const auto n = static_cast<unsigned int>(hits.size());
        return (position == nullptr
                    ? approximation.evaluate(now, n, positions.data(), supports.data(),
                                             values.data(), gradient)
                    : approximation.evaluate_moved(initial, n, positions.data(), supports.data(),
                                                   now, present.data(), values.data(), gradient,
                                                   inverse))
            .is_inside;
      }

      /** The row of a point whose neighbours have the coefficients @p sums, over @p volume. */
      SmoothedRow<dim> row_of(const std::vector<Tensor<1, dim>> &sums, const double volume) const
      {
        const auto counts = [](const Tensor<1, dim> &sum) { return sum.norm_square() > 0.; };
        SmoothedRow<dim> row;
        row.volume = volume;
        row.entries.reserve(
            static_cast<std::size_t>(std::count_if(sums.begin(), sums.end(), counts)));
        for (std::size_t k = 0; k < hits.size(); ++k)
          if (counts(sums[k]))
            row.entries.emplace_back(cloud.node[hits[k]], sums[k] / volume);
        return row;
      }

      static std::string outside_of_hull(const Point<dim> &x)
      {
        return "the point at " + position_text(x) +
               " is outside of the convex hull of the nodes whose supports reach it: the "
               "approximation does not exist there. A larger `Dilation` may help.";
      }

      std::string without_volume(const double volume) const
      {
        return describe_unusable_cell<dim>(cell->centre(), cell->centre(), volume) + ".";
      }

      /** The vertices of SubCells::facets(), which several of them have. */
      struct FacetVertices
      {
        std::vector<typename Parts::Shares> shares;
        std::vector<std::array<std::size_t, dim>> numbers; // by facet

        FacetVertices()
        {
          for (const auto &facet : Parts::facets())
          {
            numbers.emplace_back();
            for (unsigned int v = 0; v < dim; ++v)
            {
              const auto found = std::find(shares.begin(), shares.end(), facet.vertices[v]);
              numbers.back()[v] = static_cast<std::size_t>(found - shares.begin());
              if (found == shares.end())
                shares.push_back(facet.vertices[v]);
            }
          }
        }
      };

      /** The facets of the cell; those with further nodes go to further_facets. */
      void place_facets()
      {
        facets.clear();
        further_facets.clear();
        const auto add = [this](const auto &facet, const Point<dim> &initial, const Point<dim> &now,
                                const Tensor<1, dim> &area)
        {
          facets.push_back({initial, now, area, facet.from, facet.to,
                            facet.to == Parts::outside && cell->is_on_boundary[facet.face]});
        };
        // Further nodes are in the middle of edges at the start.
        if (position == nullptr ? !cell->face_nodes.empty() : cell->has_further_nodes())
        {
          const std::vector<CellFacet<dim>> initial_facets = facets_of(*cell, position != nullptr);
          further_facets = position == nullptr
                               ? initial_facets
                               : present_facets(*cell, [this](const types::global_dof_index node)
                                                { return present_position(node); });
          for (std::size_t f = 0; f < initial_facets.size(); ++f)
            add(further_facets[f], initial_facets[f].centroid(), further_facets[f].centroid(),
                further_facets[f].area());
          return;
        }
        static const FacetVertices facet_vertices;
        std::vector<Point<dim>> vertices;
        for (const typename Parts::Shares &shares : facet_vertices.shares)
          vertices.push_back(Parts::point_at(shares, corners));
        for (std::size_t f = 0; f < Parts::facets().size(); ++f)
        {
          const typename Parts::Facet &facet = Parts::facets()[f];
          std::array<Point<dim>, dim> points;
          for (unsigned int v = 0; v < dim; ++v)
            points[v] = vertices[facet_vertices.numbers[f][v]];
          const Point<dim> now = Parts::point_at(facet.centroid, corners);
          add(facet, position == nullptr ? now : Parts::point_at(facet.centroid, cell->corners),
              now, Parts::area_of(points, facet.orientation));
        }
      }

      /** Values at the centroids of facets without further nodes that are not on the boundary, as
       * many at a time as there are lanes, before evaluate_facet(). */
      void prepare_facets()
      {
        is_known.assign(facets.size(), false);
        if (position == nullptr || !further_facets.empty())
          return;
        constexpr unsigned int most_points = MovedConvexValues<dim>::most_points;
        moved_values.set_neighbours(static_cast<unsigned int>(hits.size()), positions.data(),
                                    supports.data(), present.data());
        known_values.resize(facets.size());
        std::array<std::size_t, most_points> numbers{};
        typename MovedConvexValues<dim>::Points initial, now;
        unsigned int n = 0;
        for (std::size_t f = 0; f < facets.size(); ++f)
        {
          if (!facets[f].is_on_boundary && shared_values_of(f) == nullptr)
          {
            numbers[n] = f;
            initial[n] = facets[f].initial;
            now[n++] = facets[f].now;
          }
          if (n < most_points && (n == 0 || f + 1 < facets.size()))
            continue;
          const unsigned int is_found = moved_values.evaluate(n, initial, now);
          for (unsigned int slot = 0; slot < n; ++slot)
          {
            is_known[numbers[slot]] = ((is_found >> slot) & 1u) != 0;
            Values &values_of_facet = known_values[numbers[slot]];
            values_of_facet.clear();
            for (unsigned int k = 0; k < moved_values.n_values(slot); ++k)
              values_of_facet.emplace_back(moved_values.neighbour(slot, k),
                                           moved_values.value(slot, k));
          }
          n = 0;
        }
      }

      /** The number of a facet that another cell has, too, and that has not moved apart. */
      unsigned int shared_number(const std::size_t f) const
      {
        return position == nullptr || !further_facets.empty()
                   ? SharedFacets<dim>::none
                   : surroundings.shared_facets.number(number_of_cell, f);
      }

      /** The values of this facet that the cell before has found, or null. */
      const SharedValues *shared_values_of(const std::size_t f) const
      {
        const unsigned int number = shared_number(f);
        return number == SharedFacets<dim>::none || shared_values[number].n == 0
                   ? nullptr
                   : &shared_values[number];
      }

      /** Values at the centroid of facet number @p f, to facet_values. */
      bool evaluate_facet(const std::size_t f)
      {
        facet_values.clear();
        if (const SharedValues *const shared = shared_values_of(f))
        {
          std::size_t k = 0;
          for (std::size_t i = shared->first; i < shared->first + shared->n; ++i)
          {
            while (hits[k] != nodes_of_shared[i].first)
              ++k;
            facet_values.emplace_back(k, nodes_of_shared[i].second);
          }
          return true;
        }
        if (is_known[f])
          facet_values.swap(known_values[f]);
        else if (evaluate(facets[f].initial, facets[f].now))
        {
          for (std::size_t k = 0; k < hits.size(); ++k)
            if (values[k] != 0.)
              facet_values.emplace_back(k, values[k]);
        }
        else
          return false;
        if (const unsigned int number = shared_number(f); number != SharedFacets<dim>::none)
        {
          shared_values[number] = {nodes_of_shared.size(), facet_values.size()};
          for (const auto &[k, value] : facet_values)
            nodes_of_shared.emplace_back(hits[k], value);
        }
        return true;
      }

      /** The linear interpolation of the nodes of a face, to facet_values. */
      void interpolate_linearly(const std::size_t f)
      {
        facet_values.clear();
        const auto add = [this](const types::global_dof_index node, const double share)
        {
          const auto found = std::lower_bound(hits.begin(), hits.end(), cloud.index_of(node));
          facet_values.emplace_back(static_cast<std::size_t>(found - hits.begin()), share);
        };
        if (further_facets.empty())
        {
          const typename Parts::Shares &shares = Parts::facets()[f].centroid;
          for (unsigned int corner = 0; corner < Parts::n_corners; ++corner)
            if (shares[corner] != 0.)
              add(cell->nodes[corner], shares[corner]);
          return;
        }
        for (const auto &vertex : further_facets[f].vertices)
          for (const auto &[node, share] : vertex.row)
            add(node, share / dim);
      }

      std::string add_sub_cells(std::vector<SmoothedRow<dim>> &rows)
      {
        place_facets();
        prepare_facets();
        const Point<dim> centre = Parts::centre(corners);
        std::array<std::vector<Tensor<1, dim>>, Parts::n_sub_cells> areas; // of each neighbour
        std::array<double, Parts::n_sub_cells> volumes{};
        for (auto &part_areas : areas)
          part_areas.resize(hits.size());
        for (std::size_t f = 0; f < facets.size(); ++f)
        {
          const PlacedFacet &facet = facets[f];
          if (facet.is_on_boundary)
            interpolate_linearly(f);
          else if (!evaluate_facet(f))
            return outside_of_hull(facet.now);
          const auto add = [&](const unsigned int part, const double sign)
          {
            volumes[part] += sign / dim * (facet.area * (facet.now - centre));
            for (const auto &[k, value] : facet_values)
              areas[part][k] += sign * value * facet.area;
          };
          add(facet.from, 1.);
          if (facet.to != Parts::outside)
            add(facet.to, -1.);
        }
        for (unsigned int part = 0; part < Parts::n_sub_cells; ++part)
        {
          if (!(volumes[part] > 0.))
            return without_volume(volumes[part]);
          rows.push_back(row_of(areas[part], volumes[part]));
        }
        return {};
      }

      Point<dim> present_position(const types::global_dof_index node) const
      {
        return point_of<dim>(position->node(position->partition()->local_index(node)));
      }

      std::string add_point(std::vector<SmoothedRow<dim>> &rows)
      {
        const PointOfCell<dim> initial(cell->corners), now(corners);
        const double volume = determinant(now.jacobian);
        if (!(volume > 0.))
          return without_volume(volume);
        std::vector<Tensor<1, dim>> gradients(hits.size());
        if (!evaluate(initial.position, now.position, gradients.data(),
                      initial.jacobian * invert(now.jacobian)))
          return outside_of_hull(now.position);
        rows.push_back(row_of(gradients, 1.));
        rows.back().volume = volume;
        return {};
      }

      const CellSurroundings<dim> &surroundings;
      const NodeCloud<dim> &cloud;
      ConvexApproximation<dim> approximation;
      MovedConvexValues<dim> moved_values;
      const NodalVector *position;
      const SmoothedCell<dim> *cell = nullptr;
      std::size_t number_of_cell = 0;
      typename SubCells<dim>::Corners corners;    // present ones
      std::vector<double> present_cloud, present; // of all nodes and of neighbours, likewise
      std::vector<std::size_t> hits; // neighbours of the cell, indices in the cloud, ascending
      std::vector<double> positions, supports, values;
      std::vector<PlacedFacet> facets;
      std::vector<CellFacet<dim>> further_facets; // empty without further nodes
      std::vector<bool> is_known;                 // of facets, whether their values are
      std::vector<Values> known_values;           // of facets
      Values facet_values;                        // of the present one
      std::vector<SharedValues> shared_values; // of facets of two cells, once one of them has them
      Values nodes_of_shared;                  // indices in the cloud
    };
  } // namespace

  template <int dim>
  SmoothedGradients<dim>::SmoothedGradients(const Entries &e)
  {
    kernel = read_kernel(e, "cubic spline", "The kernel of the convex approximation.");
    dilation = e.number("Dilation", "1.1", any_number(), "",
                        "Half width of a support over the largest distance to a neighbouring node, "
                        "axis by axis; 1.05 to 2. 1.1 has the waves of elements; 1.5 halves static "
                        "errors and has longer steps, at three times the cost.");
    e.refuse(!(dilation >= 1.05 && dilation <= 2.), "Dilation",
             "allowed is a number from 1.05 to 2; below, cells have points that no support "
             "reaches, and above, weak modes appear");
    rule =
        e.choice("Integration", "smoothed", "smoothed|one point",
                 "smoothed: four sub-cells a cell, with gradients from the functions on their "
                 "facets, which pass the patch test in every mesh; one point: the gradients at the "
                 "middle of the cell, as in Wu et al. 2015, which are exact on lattices only.") ==
                "smoothed"
            ? SmoothedIntegrationRule::smoothed
            : SmoothedIntegrationRule::one_point;
    shares_of_points = corner_shares_of_points<dim>(rule);
  }

  template <int dim>
  void SmoothedGradients<dim>::initialize(const PartSetup<dim> &setup,
                                          const NodalVector *const position)
  {
    // Void cells change, and with them the surroundings of their neighbours.
    if (position == nullptr || setup.void_cells != nullptr || !surroundings)
      surroundings = std::make_shared<const CellSurroundings<dim>>(setup, dilation);
    const std::vector<SmoothedCell<dim>> &cells = surroundings->cells;
    SmoothedRowBuilder<dim> builder(*surroundings, kernel, position);
    std::vector<SmoothedRow<dim>> rows_of_cells;
    rows_of_cells.reserve(cells.size() * n_points_per_cell());
    std::vector<types::global_dof_index> first_node;
    std::string failure;
    for (std::size_t c = 0; c < cells.size() && failure.empty(); ++c)
      if (!cells[c].is_void)
      {
        failure = builder.add_cell(c, rule, rows_of_cells);
        first_node.push_back(cells[c].nodes.front());
      }
    if (!failure.empty())
      failure = "The part \"" + setup.name + "\" cannot be made of this mesh: " + failure;
    throw_on_all_ranks<InputError>(failure, setup.communicator);

    if (position == nullptr || node_set.size() == 0)
      find_node_set(rows_of_cells, setup.nodes->dof_handler().n_dofs());
    arrange(rows_of_cells, first_node);
    if (!can_move)
      surroundings.reset();
  }

  template <int dim>
  void SmoothedGradients<dim>::find_node_set(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                                             const types::global_dof_index n_nodes)
  {
    // Single indices out of order make the time of an IndexSet quadratic.
    std::vector<types::global_dof_index> required;
    for (const SmoothedRow<dim> &row : rows_of_cells)
      for (const auto &entry : row.entries)
        required.push_back(entry.first);
    for (const SmoothedCell<dim> &cell : surroundings->cells)
      required.insert(required.end(), cell.nodes.begin(), cell.nodes.end());
    const std::vector<bool> is_neighbour =
        can_move ? surroundings->reaches_cells() : std::vector<bool>();
    for (std::size_t k = 0; k < is_neighbour.size(); ++k)
      if (is_neighbour[k])
        required.push_back(surroundings->cloud.node[k]);
    std::sort(required.begin(), required.end());
    required.erase(std::unique(required.begin(), required.end()), required.end());
    node_set = IndexSet(n_nodes);
    node_set.add_indices(required.begin(), required.end());
    node_set.compress();
  }

  template <int dim>
  void SmoothedGradients<dim>::arrange(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                                       const std::vector<types::global_dof_index> &first_node)
  {
    const unsigned int n_points = n_points_per_cell();
    const auto n_cells = static_cast<unsigned int>(first_node.size());
    const std::size_t n_rows = std::size_t(padded_to_lanes(n_cells)) * n_points;
    rows = Stencils();
    neighbour_nodes.clear();
    row_nodes.clear();
    point_volumes.assign(n_rows, 0.);
    rows.row_start.assign(1, 0);
    for (std::size_t row = 0; row < n_rows; ++row)
    {
      const auto lane = static_cast<unsigned int>(row % n_lanes);
      const auto q = static_cast<unsigned int>(row / n_lanes % n_points);
      // Unused lanes repeat the last cell.
      const auto cell = std::min(
          static_cast<unsigned int>(row / n_lanes / n_points) * n_lanes + lane, n_cells - 1);
      row_nodes.push_back(first_node[cell]);
      const SmoothedRow<dim> &found = rows_of_cells[std::size_t(cell) * n_points + q];
      point_volumes[row] = found.volume;
      for (const auto &entry : found.entries)
      {
        neighbour_nodes.push_back(entry.first);
        for (unsigned int d = 0; d < Stencils::n_gradient; ++d)
          rows.gradient.push_back(d < dim ? entry.second[d] : 0.);
      }
      rows.row_start.push_back(neighbour_nodes.size());
    }
    rows.gradient.push_back(0.);
    rows.coefficient_start.assign(rows.row_start.begin(), rows.row_start.end() - 1);
    rows.value.resize(neighbour_nodes.size());
    rows.neighbour.resize(neighbour_nodes.size());
    rows.particle_node.resize(row_nodes.size());
  }

  template <int dim>
  void SmoothedGradients<dim>::add_conduction(const CellBatches<dim> &cells,
                                              const TemperatureTable &conductivity,
                                              const NodalVector &position,
                                              const NodalVector &conductivity_temperature,
                                              const NodalVector &temperature,
                                              NodalVector &heat_rate) const
  {
    if (conductivity.largest() == 0.)
      return;
    const unsigned int n_points = n_points_per_cell();
    std::vector<double> at_points(std::size_t(n_points) * n_lanes);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      interpolate_at_points(cells.nodes(batch), shares_of_points, conductivity_temperature,
                            at_points.data());
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const unsigned int number = (batch * n_points + q) * n_lanes + lane;
          const double conducted =
              point_volumes[number] * conductivity.value(at_points[q * n_lanes + lane]);
          RowBlock::conduct<dim>(
              rows, number, false, position, temperature,
              [conducted](const double det) { return conducted * det; }, heat_rate);
        }
    }
  }

  template <int dim>
  void SmoothedGradients<dim>::find_couplings(const unsigned int n_cells,
                                              const NodeGroupAction &use) const
  {
    const unsigned int n_points = n_points_per_cell();
    std::vector<unsigned int> group;
    for (unsigned int cell = 0; cell < n_cells; ++cell)
    {
      group.clear();
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Stencils::Row row = rows.row(point_in_lanes(cell, n_points, q));
        group.insert(group.end(), row.neighbour, row.neighbour + row.size);
      }
      std::sort(group.begin(), group.end());
      group.erase(std::unique(group.begin(), group.end()), group.end());
      use(group);
    }
  }

  template <int dim>
  void SmoothedGradients<dim>::set_partition(const NodePartition &partition)
  {
    for (std::size_t k = 0; k < neighbour_nodes.size(); ++k)
      rows.neighbour[k] = partition.local_index(neighbour_nodes[k]);
    for (std::size_t row = 0; row < row_nodes.size(); ++row)
      rows.particle_node[row] = partition.local_index(row_nodes[row]);
  }

  template class SmoothedGradients<2>;
  template class SmoothedGradients<3>;
} // namespace tombolo
