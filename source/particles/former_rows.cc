#include <tombolo/particles/former_rows.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    std::ptrdiff_t n_neighbours(const ShapeFunctions::Row &row)
    {
      return row.size - std::count(row.value, row.value + row.size, 0.);
    }
  } // namespace

  void LeavingParticles::add(const unsigned int of_row, const ShapeFunctions::Row &former)
  {
    if (row_start.empty())
      row_start.push_back(0);
    row.push_back(of_row);
    neighbour.insert(neighbour.end(), former.neighbour, former.neighbour + former.size);
    value.insert(value.end(), former.value, former.value + former.size);
    row_start.push_back(neighbour.size());
  }

  void FormerRows::remember(const ShapeFunctions &shape)
  {
    if (is_kept)
      return;
    is_kept = true;
    row_start = shape.row_start;
    coefficient_start = shape.coefficient_start;
    neighbour = shape.neighbour;
    rigid_rows = shape.rigid_rows;
    value = shape.value;
  }

  ShapeFunctions::Row FormerRows::former_row(const unsigned int i) const
  {
    return {static_cast<unsigned int>(row_start[i + 1] - row_start[i]),
            neighbour.data() + row_start[i], value.data() + coefficient_start[i], nullptr};
  }

  LeavingParticles FormerRows::leaving(const ShapeFunctions &shape,
                                       const std::vector<unsigned int> &candidates)
  {
    LeavingParticles result;
    if (!is_kept)
      return result;
    is_kept = false;
    for (const unsigned int row : candidates)
    {
      const ShapeFunctions::Row former = former_row(row);
      if (!std::binary_search(rigid_rows.begin(), rigid_rows.end(), row) ||
          n_neighbours(shape.row(row)) < n_neighbours(former))
        result.add(row, former);
    }
    return result;
  }

  std::size_t FormerRows::memory_consumption() const
  {
    return (row_start.capacity() + coefficient_start.capacity()) * sizeof(std::size_t) +
           (neighbour.capacity() + rigid_rows.capacity()) * sizeof(unsigned int) +
           value.memory_consumption();
  }
} // namespace tombolo
