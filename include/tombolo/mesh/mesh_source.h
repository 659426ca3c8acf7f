// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/mesh/mesh.h>

#include <vector>

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

    /** The numbers that its nodes have at the source, by the vertices of the mesh that create()
     * makes; empty where they have none. What is not requested is not kept: a file is read again.
     * Throws InputError. Collective. */
    virtual std::vector<long long> node_numbers() const
    {
      return {};
    }
  };

  template <int dim>
  struct PluginKind<MeshSource<dim>>
  {
    static constexpr const char *name = "mesh";
  };
} // namespace tombolo
