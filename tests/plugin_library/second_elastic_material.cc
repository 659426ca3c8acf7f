#include <tombolo/base/registry.h>
#include <tombolo/materials/linear_elastic.h>

namespace tombolo
{
  TOMBOLO_REGISTER(Material, LinearElastic, "elastic", "a name that the library has already")
} // namespace tombolo
