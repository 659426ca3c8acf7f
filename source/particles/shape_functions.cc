#include <tombolo/particles/shape_functions.h>

namespace tombolo
{
  std::size_t ShapeFunctions::memory_consumption() const
  {
    return particle_node.capacity() * sizeof(unsigned int) +
           (row_start.capacity() + coefficient_start.capacity()) * sizeof(std::size_t) +
           neighbour.capacity() * sizeof(unsigned int) + value.memory_consumption() +
           gradient.memory_consumption() + mass.capacity() * sizeof(double) +
           inverse_deformation.memory_consumption();
  }
} // namespace tombolo
