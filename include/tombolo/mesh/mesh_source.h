// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/mesh/mesh.h>

namespace tombolo
{
  /** Where a mesh comes from: a plug-in, `set Type = ...` in section Mesh. */
  template <int dim>
  class MeshSource
  {
  public:
    virtual ~MeshSource() = default;

    /** Fills an empty mesh on every rank. Throws InputError. Collective. */
    virtual void create(Mesh<dim> &mesh) const = 0;
  };

  template <int dim>
  struct PluginKind<MeshSource<dim>>
  {
    static constexpr const char *name = "mesh";
  };
} // namespace tombolo
