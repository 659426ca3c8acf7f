// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/mesh/mesh_source.h>

#include <memory>

namespace tombolo
{
  /** The source that the entry `Type` of a section chooses: declares it and the entries of all
   * sources, or reads. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> chosen_mesh_source(const Entries &e);

  /** Declares what chooses the cells of a scene: section Mesh, or several meshes. */
  template <int dim>
  void declare_mesh_sources(Parameters &parameters);

  /** The source of the mesh of the whole scene. Throws InputError. */
  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters);
} // namespace tombolo
