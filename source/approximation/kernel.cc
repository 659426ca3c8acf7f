// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/kernel.h>
#include <tombolo/base/input/parameters.h>

namespace tombolo
{
  std::unique_ptr<Kernel> make_kernel(const std::string &name)
  {
    const auto &registry = Registry<Kernel>::instance();
    if (!registry.has(name))
    {
      const std::string nearest = nearest_name(name, registry.names());
      throw InputError("There is no kernel \"" + name + "\"; known are " + registry.selection() +
                       (nearest.empty() ? "." : ". Did you mean \"" + nearest + "\"?"));
    }
    const Parameters parameters(MPI_COMM_SELF);
    return registry.create(name, parameters.section(""));
  }
} // namespace tombolo
