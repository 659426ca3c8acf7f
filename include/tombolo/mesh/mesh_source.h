// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/mesh/mesh.h>

#include <memory>
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

  /** Declares what chooses the cells of a scene: section Mesh, or several meshes. */
  template <int dim>
  void declare_mesh_sources(Parameters &parameters);

  /** The source of the mesh of the whole scene. Throws InputError. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters);
} // namespace tombolo
