// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <tombolo/approximation/moved_convex_values.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/smoothed/cell_surroundings.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::string describe_point(const Point<dim> &point)
    {
      std::ostringstream text;
      text << "(";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? ", " : "") << point[d];
      text << ")";
      return text.str();
    }
  } // namespace

  /** Computes the rows of one cell after the other. */
  template <int dim>
  class SmoothedGradients<dim>::Builder
  {
  public:
    /** With the present @p position of the nodes, or null. */
    Builder(const CellSurroundings<dim> &surroundings, ConvexApproximation<dim> approximation,
            MovedConvexValues<dim> moved_values, const NodalVector *position)
        : surroundings(surroundings), cloud(surroundings.cloud),
          approximation(std::move(approximation)), moved_values(std::move(moved_values)),
          position(position)
    {
      if (position != nullptr)
        find_present_cloud();
    }

    /** Rows of all points of cell number @p c go behind @p rows. Returns what is wrong, or
     * nothing. */
    std::string add_cell(const std::size_t c, const SmoothedIntegrationRule rule,
                         std::vector<Row> &rows)
    {
      const SmoothedCell<dim> &cell = surroundings.cells[c];
      find_neighbours(c);
      find_present_positions(cell);
      return rule == SmoothedIntegrationRule::smoothed ? add_sub_cells(cell, rows)
                                                       : add_points(cell, rule, rows);
    }

  private:
    void find_present_cloud()
    {
      const NodePartition &partition = *position->partition();
      const std::vector<bool> is_there = surroundings.reaches_cells();
      present_cloud.resize(cloud.position.size());
      for (std::size_t i = 0; i < cloud.node.size(); ++i)
        if (is_there[i])
          std::copy_n(position->node(partition.local_index(cloud.node[i])), node_stride,
                      present_cloud.begin() + std::ptrdiff_t(i * node_stride));
    }

    void find_neighbours(const std::size_t c)
    {
      surroundings.find_neighbours(c, hits);
      positions.clear();
      supports.clear();
      for (const std::size_t i : hits)
        for (unsigned int d = 0; d < node_stride; ++d)
        {
          positions.push_back(cloud.position[i * node_stride + d]);
          supports.push_back(cloud.support[i * node_stride + d]);
        }
      values.resize(hits.size());
      gradients.resize(hits.size());
    }

    void find_present_positions(const SmoothedCell<dim> &cell)
    {
      corners = cell.corners;
      if (position == nullptr)
        return;
      const NodePartition &partition = *position->partition();
      for (unsigned int k = 0; k < corners.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          corners[k][d] = position->node(partition.local_index(cell.nodes[k]))[d];
      present.clear();
      for (const std::size_t i : hits)
      {
        const double *const x = present_cloud.data() + i * node_stride;
        present.insert(present.end(), x, x + node_stride);
      }
    }

    /** Values at a place of the cell. */
    bool evaluate_share(const typename SubCells<dim>::Shares &share, const SmoothedCell<dim> &cell)
    {
      const Point<dim> x = SubCells<dim>::point_at(share, cell.corners);
      if (position == nullptr)
        return evaluate(x, false);
      return approximation
          .evaluate_moved(x, static_cast<unsigned int>(hits.size()), positions.data(),
                          supports.data(), SubCells<dim>::point_at(share, corners), present.data(),
                          values.data())
          .is_inside;
    }

    bool evaluate(const Point<dim> &x, const bool with_gradients)
    {
      return approximation
          .evaluate(x, static_cast<unsigned int>(hits.size()), positions.data(), supports.data(),
                    values.data(), with_gradients ? gradients.data() : nullptr)
          .is_inside;
    }

    /** Values and gradients at a point that was somewhere else in the initial configuration. */
    bool evaluate_point(const PointOfCell<dim> &of_start, const PointOfCell<dim> &now)
    {
      if (position == nullptr)
        return evaluate(now.place, true);
      return approximation
          .evaluate_moved(of_start.place, static_cast<unsigned int>(hits.size()), positions.data(),
                          supports.data(), now.place, present.data(), values.data(),
                          gradients.data(), of_start.jacobian * invert(now.jacobian))
          .is_inside;
    }

    /** The row of a point whose neighbours have the coefficients @p sums, over @p volume. */
    Row row_of(const std::vector<Tensor<1, dim>> &sums, const double volume) const
    {
      Row row;
      row.volume = volume;
      for (std::size_t k = 0; k < hits.size(); ++k)
        if (sums[k].norm_square() > 0.)
          row.entries.emplace_back(cloud.node[hits[k]], sums[k] / volume);
      return row;
    }

    static std::string outside_of_hull(const Point<dim> &x)
    {
      return "the point at " + describe_point(x) +
             " is outside of the convex hull of the nodes whose supports reach it: the "
             "approximation "
             "does not exist there. A larger `Dilation` may help.";
    }

    static std::string without_volume(const SmoothedCell<dim> &cell, const double volume)
    {
      return describe_unusable_cell<dim>(cell.centre(), cell.centre(), volume) + ".";
    }

    using Parts = SubCells<dim>;

    /** Neighbours, by their place among the hits, and their values. */
    using Values = std::vector<std::pair<std::size_t, double>>;

    /** Of each sub-cell. */
    struct FacetSums
    {
      std::array<std::vector<Tensor<1, dim>>, Parts::n_sub_cells> areas; // of each neighbour
      std::array<double, Parts::n_sub_cells> volumes{};
    };

    Point<dim> centroid_of(const typename Parts::Facet &facet) const
    {
      return Parts::point_at(facet.centroid, corners);
    }
    Point<dim> centroid_of(const GradedFacet<dim> &facet) const
    {
      return facet.centroid();
    }

    Tensor<1, dim> area_of(const typename Parts::Facet &facet) const
    {
      return Parts::area(facet, corners);
    }
    Tensor<1, dim> area_of(const GradedFacet<dim> &facet) const
    {
      return facet.area();
    }

    template <typename Facet>
    static bool is_on_boundary(const Facet &facet, const SmoothedCell<dim> &cell)
    {
      return facet.to == Parts::outside && cell.is_on_boundary[facet.face];
    }

    /** Values at the centroids of all facets that are not on the boundary, before
     * evaluate_facet(). */
    void prepare_facets(const std::vector<typename Parts::Facet> &facets,
                        const SmoothedCell<dim> &cell)
    {
      if (position == nullptr)
        return;
      constexpr unsigned int most_places = MovedConvexValues<dim>::most_places;
      moved_values.set_neighbours(static_cast<unsigned int>(hits.size()), positions.data(),
                                  supports.data(), present.data());
      is_known.assign(facets.size(), false);
      known_values.resize(facets.size());
      std::array<std::size_t, most_places> numbers{};
      typename MovedConvexValues<dim>::Places of_start, now;
      unsigned int n = 0;
      for (std::size_t f = 0; f < facets.size(); ++f)
      {
        if (!is_on_boundary(facets[f], cell))
        {
          numbers[n] = f;
          of_start[n] = Parts::point_at(facets[f].centroid, cell.corners);
          now[n++] = centroid_of(facets[f]);
        }
        if (n < most_places && (n == 0 || f + 1 < facets.size()))
          continue;
        const unsigned int is_found = moved_values.evaluate(n, of_start, now);
        for (unsigned int place = 0; place < n; ++place)
        {
          is_known[numbers[place]] = ((is_found >> place) & 1u) != 0;
          Values &of_facet = known_values[numbers[place]];
          of_facet.clear();
          for (unsigned int k = 0; k < moved_values.n_values(place); ++k)
            of_facet.emplace_back(moved_values.neighbour(place, k), moved_values.value(place, k));
        }
        n = 0;
      }
    }
    void prepare_facets(const std::vector<GradedFacet<dim>> & /*facets*/,
                        const SmoothedCell<dim> & /*cell*/)
    {}

    void take_values()
    {
      facet_values.clear();
      for (std::size_t k = 0; k < hits.size(); ++k)
        if (values[k] != 0.)
          facet_values.emplace_back(k, values[k]);
    }

    /** Values at the centroid of facet number @p f, to facet_values. */
    bool evaluate_facet(const typename Parts::Facet &facet, const std::size_t f,
                        const SmoothedCell<dim> &cell)
    {
      if (position != nullptr && is_known[f])
      {
        facet_values.swap(known_values[f]);
        return true;
      }
      const bool is_inside = evaluate_share(facet.centroid, cell);
      take_values();
      return is_inside;
    }
    bool evaluate_facet(const GradedFacet<dim> &facet, const std::size_t /*f*/,
                        const SmoothedCell<dim> & /*cell*/)
    {
      const bool is_inside = evaluate(facet.centroid(), false);
      take_values();
      return is_inside;
    }

    static typename Parts::Shares shares_of_centroid(const typename Parts::Facet &facet)
    {
      return facet.centroid;
    }
    static typename Parts::Shares shares_of_centroid(const GradedFacet<dim> &facet)
    {
      typename Parts::Shares shares{};
      for (const auto &vertex : facet.vertices)
        for (unsigned int k = 0; k < Parts::n_corners; ++k)
          shares[k] += vertex.of_corners[k] / dim;
      return shares;
    }

    /** Sums over the facets of a cell. Returns what is wrong, or nothing. */
    template <typename Facet>
    std::string add_facets(const SmoothedCell<dim> &cell, const std::vector<Facet> &facets,
                           FacetSums &sums)
    {
      Point<dim> centre;
      for (const Point<dim> &corner : corners)
        centre += corner / static_cast<double>(corners.size());
      prepare_facets(facets, cell);
      for (std::size_t f = 0; f < facets.size(); ++f)
      {
        const Facet &facet = facets[f];
        const Point<dim> x = centroid_of(facet);
        const Tensor<1, dim> area = area_of(facet);
        const auto add = [&](const unsigned int part, const double sign)
        {
          sums.volumes[part] += sign / dim * (area * (x - centre));
          for (const auto &of_node : facet_values)
            sums.areas[part][of_node.first] += sign * of_node.second * area;
        };
        if (is_on_boundary(facet, cell))
        {
          const typename Parts::Shares shares = shares_of_centroid(facet);
          facet_values.clear();
          for (unsigned int corner = 0; corner < Parts::n_corners; ++corner)
            if (shares[corner] != 0.)
              facet_values.emplace_back(place_among_hits(cell.nodes[corner]), shares[corner]);
        }
        else if (!evaluate_facet(facet, f, cell))
          return outside_of_hull(x);
        add(facet.from, 1.);
        if (facet.to != Parts::outside)
          add(facet.to, -1.);
      }
      return {};
    }

    std::string add_sub_cells(const SmoothedCell<dim> &cell, std::vector<Row> &rows)
    {
      FacetSums sums;
      for (auto &of_part : sums.areas)
        of_part.resize(hits.size());
      const std::string failure =
          cell.refined_faces.empty()
              ? add_facets(cell, Parts::facets(), sums)
              : add_facets(cell, graded_facets<dim>(cell.corners, cell.refined_faces), sums);
      if (!failure.empty())
        return failure;
      for (unsigned int part = 0; part < Parts::n_sub_cells; ++part)
      {
        if (!(sums.volumes[part] > 0.))
          return without_volume(cell, sums.volumes[part]);
        rows.push_back(row_of(sums.areas[part], sums.volumes[part]));
      }
      return {};
    }

    std::string add_points(const SmoothedCell<dim> &cell, const SmoothedIntegrationRule rule,
                           std::vector<Row> &rows)
    {
      const Quadrature<dim> quadrature = quadrature_of<dim>(rule);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
      {
        const PointOfCell<dim> of_start(quadrature.point(q), cell.corners);
        const PointOfCell<dim> now(quadrature.point(q), corners);
        const double volume = determinant(now.jacobian) * quadrature.weight(q);
        if (!(volume > 0.))
          return without_volume(cell, volume);
        if (!evaluate_point(of_start, now))
          return outside_of_hull(now.place);
        rows.push_back(row_of(gradients, 1.));
        rows.back().volume = volume;
      }
      return {};
    }

    std::size_t place_among_hits(const types::global_dof_index node) const
    {
      const auto found = std::lower_bound(hits.begin(), hits.end(), cloud.place_of(node));
      return static_cast<std::size_t>(found - hits.begin());
    }

    const CellSurroundings<dim> &surroundings;
    const NodeCloud<dim> &cloud;
    ConvexApproximation<dim> approximation;
    MovedConvexValues<dim> moved_values;
    const NodalVector *position;
    typename SubCells<dim>::Corners corners; // present ones
    std::vector<double> present_cloud, present; // of all nodes and of neighbours, likewise
    std::vector<std::size_t> hits; // neighbours of the cell, places in the cloud, ascending
    std::vector<double> positions, supports, values;
    std::vector<Tensor<1, dim>> gradients;
    std::vector<bool> is_known;       // of facets, whether their values are
    std::vector<Values> known_values; // of facets
    Values facet_values;              // of the present one
  };

  template <int dim>
  void SmoothedGradients<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry("Kernel", "cubic spline",
                          Patterns::Selection(Registry<Kernel>::instance().selection()),
                          "The kernel of the convex approximation.");
    handler.declare_entry(
        "Basis", "exponential", Patterns::Selection(convex_basis_selection()),
        "The function that makes the approximation convex: the exponential (largest entropy), or "
        "1 + 2/π atan (Wu et al. 2015), or 1 + tanh.");
    handler.declare_entry(
        "Dilation", "1.1", Patterns::Double(),
        "Half width of a support over the largest distance to a neighbouring node, axis by axis; "
        "1.05 to 2. 1.1 has the waves of elements; 1.5 halves static errors and has longer steps, "
        "at three times the cost.");
    handler.declare_entry(
        "Integration", "smoothed", Patterns::Selection("smoothed|one point|Gauss"),
        "smoothed: four sub-cells a cell, with gradients from the functions on their facets, which "
        "pass the patch test in every mesh; one point: the gradients at the middle of the cell, as "
        "in Wu et al. 2015; Gauss: those at 2^dim Gauss points. The last two are exact on lattices "
        "only.");
  }

  template <int dim>
  SmoothedGradients<dim>::SmoothedGradients(const Section &section)
      : dilation(section.get_double("Dilation")),
        rule(smoothed_integration_rule(section.get("Integration"))),
        kernel(Registry<Kernel>::instance().create(section.get("Kernel"), section)),
        basis(convex_basis_of(section.get("Basis"))),
        shares_of_points(corner_shares_of_points<dim>(rule))
  {
    if (!(dilation >= 1.05 && dilation <= 2.))
      section.fail("Dilation", "allowed is a number from 1.05 to 2; below, cells have points that "
                               "no support reaches, and above, weak modes appear");
  }

  template <int dim>
  SmoothedIntegrationRule SmoothedGradients<dim>::integration_rule() const
  {
    return rule;
  }

  template <int dim>
  unsigned int SmoothedGradients<dim>::n_points_per_cell() const
  {
    return static_cast<unsigned int>(shares_of_points.size());
  }

  template <int dim>
  void SmoothedGradients<dim>::prepare_positions()
  {
    can_move = true;
  }

  template <int dim>
  void SmoothedGradients<dim>::initialize(const PartSetup<dim> &setup,
                                          const NodalVector *const position)
  {
    // Void cells change, and what they are to their neighbours.
    if (position == nullptr || setup.void_cells != nullptr || !surroundings)
      surroundings = std::make_shared<const CellSurroundings<dim>>(setup, dilation);
    const std::vector<SmoothedCell<dim>> &cells = surroundings->cells;
    Builder builder(*surroundings, ConvexApproximation<dim>(kernel, basis),
                    MovedConvexValues<dim>(kernel, basis), position);
    std::vector<Row> rows_of_cells;
    std::vector<types::global_dof_index> first_node;
    std::string failure;
    for (std::size_t c = 0; c < cells.size() && failure.empty(); ++c)
      if (!cells[c].is_void)
      {
        failure = builder.add_cell(c, rule, rows_of_cells);
        first_node.push_back(cells[c].nodes.front());
      }
    for (const std::string &of_rank : Utilities::MPI::all_gather(setup.communicator, failure))
      if (!of_rank.empty())
        throw InputError("The part \"" + setup.name + "\" cannot be made of this mesh: " + of_rank);

    if (position == nullptr || node_set.size() == 0)
      find_node_set(rows_of_cells, setup.nodes->dof_handler().n_dofs());
    arrange(rows_of_cells, first_node);
    if (!can_move)
      surroundings.reset();
  }

  template <int dim>
  void SmoothedGradients<dim>::find_node_set(const std::vector<Row> &rows_of_cells,
                                             const types::global_dof_index n_nodes)
  {
    // Single indices out of order make the time of an IndexSet quadratic.
    std::vector<types::global_dof_index> required;
    for (const Row &row : rows_of_cells)
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
  void SmoothedGradients<dim>::arrange(const std::vector<Row> &rows_of_cells,
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
      const Row &found = rows_of_cells[std::size_t(cell) * n_points + q];
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
  const Stencils &SmoothedGradients<dim>::stencils() const
  {
    return rows;
  }

  template <int dim>
  const std::vector<double> &SmoothedGradients<dim>::volumes() const
  {
    return point_volumes;
  }

  template <int dim>
  const std::vector<std::vector<double>> &SmoothedGradients<dim>::corner_shares() const
  {
    return shares_of_points;
  }

  template <int dim>
  void SmoothedGradients<dim>::interpolate(const unsigned int *const nodes,
                                           const NodalVector &vector, double *const at_points) const
  {
    for (std::size_t q = 0; q < shares_of_points.size(); ++q)
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        double sum = 0;
        for (unsigned int k = 0; k < SubCells<dim>::n_corners; ++k)
          sum += shares_of_points[q][k] * *vector.node(nodes[k * n_lanes + lane]);
        at_points[q * n_lanes + lane] = sum;
      }
  }

  template <int dim>
  const IndexSet &SmoothedGradients<dim>::required_nodes() const
  {
    return node_set;
  }

  template <int dim>
  void SmoothedGradients<dim>::set_partition(const NodePartition &partition)
  {
    for (std::size_t k = 0; k < neighbour_nodes.size(); ++k)
      rows.neighbour[k] = partition.local_index(neighbour_nodes[k]);
    for (std::size_t row = 0; row < row_nodes.size(); ++row)
      rows.particle_node[row] = partition.local_index(row_nodes[row]);
  }

  template <int dim>
  std::size_t SmoothedGradients<dim>::memory_consumption() const
  {
    return rows.memory_consumption() + point_volumes.capacity() * sizeof(double) +
           (neighbour_nodes.capacity() + row_nodes.capacity()) * sizeof(types::global_dof_index) +
           (surroundings ? surroundings->memory_consumption() : 0);
  }

  template class SmoothedGradients<2>;
  template class SmoothedGradients<3>;
} // namespace tombolo
