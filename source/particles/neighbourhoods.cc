#include <tombolo/particles/neighbourhoods.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  Neighbourhoods<dim>::Neighbourhoods(const double skin) : skin(skin)
  {}

  template <int dim>
  void Neighbourhoods<dim>::search(const std::vector<types::global_dof_index> &particles,
                                   const std::vector<double> &position,
                                   const std::vector<double> &support, MPI_Comm communicator,
                                   ShapeFunctions &shape)
  {
    Assert(std::is_sorted(particles.begin(), particles.end()), ExcInternalError());
    Assert(position.size() == particles.size() * n_slots, ExcInternalError());
    Assert(support.size() == particles.size() * n_slots, ExcInternalError());
    const RemoteParticles remote =
        ghost_finder.exchange(particles, position.data(), support.data(), skin, communicator);
    n_own = static_cast<unsigned int>(particles.size());
    all_positions = position;
    all_supports = support;
    all_positions.insert(all_positions.end(), remote.position.begin(), remote.position.end());
    all_supports.insert(all_supports.end(), remote.support.begin(), remote.support.end());
    rows.resize(n_own);
    std::iota(rows.begin(), rows.end(), 0u);
    columns.resize(n_own + remote.node.size());
    std::iota(columns.begin(), columns.end(), 0u);
    finder.find(rows, columns, all_positions.data(), all_supports.data(), skin, shape.row_start,
                neighbour_place);

    // Of the particles received only those that are neighbours keep a place. They stay ascending by
    // global number, and so do the rows.
    constexpr unsigned int unused = std::numeric_limits<unsigned int>::max();
    std::vector<unsigned int> place(remote.node.size(), unused);
    for (const unsigned int j : neighbour_place)
      if (j >= n_own)
        place[j - n_own] = 0;
    all_nodes = particles;
    for (std::size_t k = 0; k < place.size(); ++k)
      if (place[k] != unused)
      {
        place[k] = static_cast<unsigned int>(all_nodes.size());
        all_nodes.push_back(remote.node[k]);
        std::copy_n(&remote.position[k * n_slots], n_slots, &all_positions[place[k] * n_slots]);
        std::copy_n(&remote.support[k * n_slots], n_slots, &all_supports[place[k] * n_slots]);
      }
    all_positions.resize(all_nodes.size() * n_slots);
    all_supports.resize(all_nodes.size() * n_slots);
    if (!place.empty())
      for (unsigned int &j : neighbour_place)
        if (j >= n_own)
          j = place[j - n_own];
    numbers_in_use.resize(all_nodes.size());
    std::iota(numbers_in_use.begin(), numbers_in_use.end(), 0u);
    shape.particle_node = rows;
    shape.neighbour = neighbour_place;
  }

  template <int dim>
  const std::vector<types::global_dof_index> &Neighbourhoods<dim>::global_nodes() const
  {
    return all_nodes;
  }

  template <int dim>
  const std::vector<double> &Neighbourhoods<dim>::position_at_search() const
  {
    return all_positions;
  }

  template <int dim>
  const std::vector<double> &Neighbourhoods<dim>::support_at_search() const
  {
    return all_supports;
  }

  template <int dim>
  void Neighbourhoods<dim>::set_partition(const NodePartition &partition, ShapeFunctions &shape)
  {
    for (std::size_t place = 0; place < all_nodes.size(); ++place)
      numbers_in_use[place] = partition.local_index(all_nodes[place]);
    std::copy_n(numbers_in_use.begin(), n_own, shape.particle_node.begin());
    for (std::size_t entry = 0; entry < neighbour_place.size(); ++entry)
      shape.neighbour[entry] = numbers_in_use[neighbour_place[entry]];
  }

  template <int dim>
  const std::vector<unsigned int> &Neighbourhoods<dim>::nodes() const
  {
    return numbers_in_use;
  }

  template <int dim>
  bool Neighbourhoods<dim>::candidates_hold(const std::vector<double> &position,
                                            const std::vector<double> &support,
                                            MPI_Comm communicator) const
  {
    // Largest displacement either way, largest growth beyond the skin, by axis.
    constexpr double lowest = std::numeric_limits<double>::lowest();
    std::array<double, 3 * dim> local;
    local.fill(lowest);
    for (unsigned int i = 0; i < n_own; ++i)
      for (unsigned int d = 0; d < dim; ++d)
      {
        const std::size_t slot = std::size_t(i) * n_slots + d;
        const double displacement = position[slot] - all_positions[slot];
        local[d] = std::max(local[d], displacement);
        local[dim + d] = std::max(local[dim + d], -displacement);
        local[2 * dim + d] =
            std::max(local[2 * dim + d], support[slot] - all_supports[slot] * (1. + skin));
      }
    std::array<double, 3 * dim> global;
    Utilities::MPI::max(ArrayView<const double>(local.data(), local.size()), communicator,
                        ArrayView<double>(global.data(), global.size()));
    for (unsigned int d = 0; d < dim; ++d)
      if (global[d] > lowest && !(global[d] + global[dim + d] + global[2 * dim + d] <= 0.))
        return false;
    return true;
  }

  template <int dim>
  std::size_t Neighbourhoods<dim>::memory_consumption() const
  {
    return finder.memory_consumption() +
           (all_positions.capacity() + all_supports.capacity()) * sizeof(double) +
           all_nodes.capacity() * sizeof(types::global_dof_index) +
           (rows.capacity() + columns.capacity() + numbers_in_use.capacity() +
            neighbour_place.capacity()) *
               sizeof(unsigned int);
  }

  template class Neighbourhoods<2>;
  template class Neighbourhoods<3>;
} // namespace tombolo
