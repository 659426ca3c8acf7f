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
  void Neighbourhoods<dim>::reinit(const std::vector<unsigned int> &owned_particles,
                                   const NodePartition &partition, ShapeFunctions &shape) const
  {
    Assert(std::is_sorted(owned_particles.begin(), owned_particles.end()), ExcInternalError());
    Assert(owned_particles.empty() || owned_particles.back() < partition.n_owned(),
           ExcInternalError());
    (void)partition;
    shape.particle_node = owned_particles;
    shape.row_start.assign(owned_particles.size() + 1, 0);
    shape.neighbour.clear();
  }

  template <int dim>
  void Neighbourhoods<dim>::search(const NodalVector &position, const NodalVector &support,
                                   ShapeFunctions &shape)
  {
    const NodePartition &partition = *position.partition();
    n_own = shape.n_particles();
    n_owned_nodes = partition.n_owned();
    search_position.resize(std::size_t(n_own) * n_slots);
    search_support.resize(std::size_t(n_own) * n_slots);
    for (unsigned int i = 0; i < n_own; ++i)
    {
      std::copy_n(position.node(shape.particle_node[i]), n_slots, &search_position[i * n_slots]);
      std::copy_n(support.node(shape.particle_node[i]), n_slots, &search_support[i * n_slots]);
    }

    std::vector<types::global_dof_index> remote_node;
    if (Utilities::MPI::n_mpi_processes(partition.communicator()) > 1)
    {
      std::vector<types::global_dof_index> own_node(n_own);
      for (unsigned int i = 0; i < n_own; ++i)
        own_node[i] = partition.global_index(shape.particle_node[i]);
      RemoteParticles remote = ghost_finder.exchange(
          own_node, search_position.data(), search_support.data(), skin, partition.communicator());
      search_position.insert(search_position.end(), remote.position.begin(), remote.position.end());
      search_support.insert(search_support.end(), remote.support.begin(), remote.support.end());
      remote_node = std::move(remote.node);
    }
    search_rows.resize(n_own);
    std::iota(search_rows.begin(), search_rows.end(), 0u);
    search_columns.resize(n_own + remote_node.size());
    std::iota(search_columns.begin(), search_columns.end(), 0u);
    finder.find(search_rows, search_columns, search_position.data(), search_support.data(), skin,
                shape.row_start, shape.neighbour);

    // Of the particles received, those that are used become ghosts; until set_partition() they are
    // counted from the owned nodes on. Ascending global numbers keep rows ascending.
    constexpr unsigned int unused = std::numeric_limits<unsigned int>::max();
    std::vector<unsigned int> number(remote_node.size(), unused);
    for (const unsigned int j : shape.neighbour)
      if (j >= n_own)
        number[j - n_own] = 0;
    ghosts = IndexSet(partition.n_global());
    all_nodes = shape.particle_node;
    for (std::size_t r = 0; r < remote_node.size(); ++r)
      if (number[r] != unused)
      {
        number[r] = n_owned_nodes + static_cast<unsigned int>(all_nodes.size()) - n_own;
        ghosts.add_index(remote_node[r]);
        all_nodes.push_back(number[r]);
      }
    ghosts.compress();
    for (unsigned int &j : shape.neighbour)
      j = j < n_own ? shape.particle_node[j] : number[j - n_own];
    search_position.resize(std::size_t(n_own) * n_slots);
    search_support.resize(std::size_t(n_own) * n_slots);
  }

  template <int dim>
  const IndexSet &Neighbourhoods<dim>::required_ghosts() const
  {
    return ghosts;
  }

  template <int dim>
  void Neighbourhoods<dim>::set_partition(const NodePartition &partition, ShapeFunctions &shape)
  {
    Assert(partition.n_owned() == n_owned_nodes || n_own == 0, ExcInternalError());
    if (all_nodes.size() == n_own)
      return;
    std::vector<unsigned int> new_number(all_nodes.back() + 1 - n_owned_nodes, 0);
    auto global = ghosts.begin();
    for (std::size_t g = n_own; g < all_nodes.size(); ++g, ++global)
    {
      const unsigned int local = partition.local_index(*global);
      new_number[all_nodes[g] - n_owned_nodes] = local;
      all_nodes[g] = local;
    }
    for (unsigned int &j : shape.neighbour)
      if (j >= n_owned_nodes)
        j = new_number[j - n_owned_nodes];
  }

  template <int dim>
  const std::vector<unsigned int> &Neighbourhoods<dim>::nodes() const
  {
    return all_nodes;
  }

  template <int dim>
  bool Neighbourhoods<dim>::candidates_hold(const NodalVector &position,
                                            const NodalVector &support) const
  {
    // Largest displacement, largest negative displacement, largest growth beyond the skin, by axis.
    constexpr double lowest = std::numeric_limits<double>::lowest();
    std::array<double, 3 * dim> local;
    local.fill(lowest);
    for (unsigned int i = 0; i < n_own; ++i)
    {
      const double *const x = position.node(all_nodes[i]);
      const double *const a = support.node(all_nodes[i]);
      for (unsigned int d = 0; d < dim; ++d)
      {
        const std::size_t slot = std::size_t(i) * n_slots + d;
        const double displacement = x[d] - search_position[slot];
        local[d] = std::max(local[d], displacement);
        local[dim + d] = std::max(local[dim + d], -displacement);
        local[2 * dim + d] =
            std::max(local[2 * dim + d], a[d] - search_support[slot] * (1. + skin));
      }
    }
    std::array<double, 3 * dim> global;
    Utilities::MPI::max(ArrayView<const double>(local.data(), local.size()),
                        position.partition()->communicator(),
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
           (search_position.capacity() + search_support.capacity()) * sizeof(double) +
           (search_rows.capacity() + search_columns.capacity() + all_nodes.capacity()) *
               sizeof(unsigned int) +
           ghosts.memory_consumption();
  }

  template class Neighbourhoods<2>;
  template class Neighbourhoods<3>;
} // namespace tombolo
