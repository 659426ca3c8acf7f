// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/model/part.h>
#include <tombolo/model/process.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** The selected plug-in of a kind, made from the subsection of its name. */
  template <typename Interface>
  std::unique_ptr<Interface> create_selected(const Section &section, const std::string &entry)
  {
    const std::string name = section.get(entry);
    return Registry<Interface>::instance().create(name, section.subsection(name));
  }

  /** The sections "PREFIX: NAME" of the names in an entry. */
  std::vector<Section> named_sections(const Parameters &parameters, const std::string &list,
                                      const std::string &prefix);

  /** The parts with their materials and formulations, not yet initialized. Throws InputError. While
   * mistakes are collected, parts without a material are missing, and others may have no
   * formulation.
   */
  template <int dim>
  std::vector<Part<dim>> create_parts(const Parameters &parameters);

  /** What the parts together are: with stresses, with heat, or both. Throws the InputError that
   * they do not fit together. */
  template <int dim>
  struct Physics
  {
    /** Of parts that are not known: anything. */
    Physics() : has_mechanics(true), has_heat(true) {}
    Physics(const std::vector<Part<dim>> &parts, const std::vector<Section> &part_sections);

    bool has_mechanics = false;
    bool has_heat = false;
  };

  /** The degree of the nodes, which all parts share. Throws the InputError that they do not. */
  template <int dim>
  unsigned int common_degree(const std::vector<Part<dim>> &parts,
                             const std::vector<Section> &part_sections);

  /** Whether cells can be divided while the run goes on (`Mesh/Adaptive refinement`). */
  bool divides_cells_in_run(const Parameters &parameters);

  /** Fills an empty mesh by the section "Mesh", and refines it. Throws InputError, also where
   * vertices are so far away that volumes would overflow. Collective. */
  template <int dim>
  void read_mesh(const Section &section, Mesh<dim> &mesh, MPI_Comm communicator);
} // namespace tombolo
