// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>

#include <memory>
#include <string>

namespace tombolo
{
  class Entries;

  /**
   * A kernel w(r) of one normalized coordinate r = (x_J - x)/a_J, zero for |r| >= 1; on a cuboidal
   * support the product over the axes. Its scale cancels in moving least squares. A plug-in; one
   * virtual call evaluates the neighbours of a batch of particles.
   */
  class Kernel
  {
  public:
    virtual ~Kernel() = default;

    /** w(r) and dw/dr at @p n coordinates, a multiple of n_lanes; exactly zero for |r| >= 1. */
    virtual void evaluate(std::size_t n, const double *r, double *w, double *dw) const = 0;

    /** Whether w is differentiable at r = 0. Shape functions of moving least squares need that,
     * because they differentiate the weight of the particle itself; smoothed particles do not. */
    virtual bool is_smooth_at_zero() const
    {
      return true;
    }
  };

  template <>
  struct PluginKind<Kernel>
  {
    static constexpr const char *name = "kernel";
  };

  /** The kernel that the entry `Kernel` names, with its own entries in a section of its name; the
   * default, which has none, while entries are declared. */
  std::unique_ptr<Kernel> read_kernel(const Entries &e, const std::string &by_default,
                                      const std::string &documentation);

  /** The kernel of this name without parameters of its own, for code that has no parameter file.
   * Throws InputError, naming the nearest, for "no such kernel". */
  std::unique_ptr<Kernel> make_kernel(const std::string &name);
} // namespace tombolo
