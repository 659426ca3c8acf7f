// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/chosen_mesh.h>

#include <tombolo/mesh/joined_meshes.h>

namespace tombolo
{
  template <int dim>
  std::unique_ptr<MeshSource<dim>> chosen_mesh_source(const Entries &e)
  {
    auto source = e.plugin<MeshSource<dim>>("Type", mandatory, "Where the mesh comes from.");
    e.plugins<MeshSource<dim>>();
    return source;
  }

  template <int dim>
  void declare_mesh_sources(Parameters &parameters)
  {
    chosen_mesh_source<dim>(Entries(parameters.handler()).subsection("Mesh"));
    JoinedMeshes<dim>::declare_parameters(parameters);
  }

  template <int dim>
  std::unique_ptr<MeshSource<dim>> mesh_source(const Parameters &parameters)
  {
    if (auto joined = JoinedMeshes<dim>::read(parameters))
      return joined;
    return chosen_mesh_source<dim>(parameters.section("Mesh"));
  }

  template std::unique_ptr<MeshSource<2>> chosen_mesh_source<2>(const Entries &);
  template std::unique_ptr<MeshSource<3>> chosen_mesh_source<3>(const Entries &);
  template void declare_mesh_sources<2>(Parameters &);
  template void declare_mesh_sources<3>(Parameters &);
  template std::unique_ptr<MeshSource<2>> mesh_source<2>(const Parameters &);
  template std::unique_ptr<MeshSource<3>> mesh_source<3>(const Parameters &);
} // namespace tombolo
