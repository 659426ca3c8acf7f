// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/tool_piece.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The corners of the box around all nodes. Collective. */
    template <int dim>
    std::pair<Tensor<1, dim>, Tensor<1, dim>> box_of(const NodalVector &position)
    {
      std::array<double, dim> low, high;
      low.fill(std::numeric_limits<double>::max());
      high.fill(std::numeric_limits<double>::lowest());
      for (unsigned int node = 0; node < position.partition()->n_owned(); ++node)
        for (unsigned int d = 0; d < dim; ++d)
        {
          low[d] = std::min(low[d], position.node(node)[d]);
          high[d] = std::max(high[d], position.node(node)[d]);
        }
      std::pair<Tensor<1, dim>, Tensor<1, dim>> result;
      for (unsigned int d = 0; d < dim; ++d)
      {
        result.first[d] = Utilities::MPI::min(low[d], position.partition()->communicator());
        result.second[d] = Utilities::MPI::max(high[d], position.partition()->communicator());
      }
      return result;
    }
  } // namespace

  template <int dim>
  VtuPiece make_tool_piece(const OutputView<dim> &view, const bool double_precision,
                           const bool with_facets)
  {
    VtuPiece piece(dim == 2 ? 3 : 5, dim, double_precision);
    const auto [low, high] = box_of<dim>(view.state->position);
    std::vector<std::string> names;
    std::vector<std::int64_t> numbers;
    std::vector<double> forces, penetrations;
    for (std::size_t c = 0; c < view.contacts.size(); ++c)
    {
      const SurfaceContact<dim> &contact = *view.contacts[c];
      names.push_back(contact.name());
      const ContactBalance balance = contact.balance(view.state->partition()->communicator());
      const FacetList<dim> facets =
          with_facets ? contact.contact_surface().picture(view.time, low, high) : FacetList<dim>();
      const auto first = static_cast<std::int64_t>(piece.n_points());
      for (const Tensor<1, dim> &vertex : facets.vertices)
        for (unsigned int d = 0; d < 3; ++d)
          piece.points.push_back(d < dim ? vertex[d] : 0.);
      for (const auto &facet : facets.facets)
      {
        for (const unsigned int vertex : facet.vertex)
          piece.connectivity.push_back(first + vertex);
        numbers.push_back(static_cast<std::int64_t>(c));
        forces.insert(forces.end(), balance.force.begin(), balance.force.end());
        penetrations.push_back(balance.penetration);
      }
    }
    piece.add_cell_data("contact", std::move(numbers));
    piece.add_cell_data("force on the bodies", "M L/T^2", 3, std::move(forces));
    piece.add_cell_data("penetration", "L", 1, std::move(penetrations));
    piece.add_names("contact names", names);
    return piece;
  }

  template VtuPiece make_tool_piece(const OutputView<2> &, bool, bool);
  template VtuPiece make_tool_piece(const OutputView<3> &, bool, bool);
} // namespace tombolo
