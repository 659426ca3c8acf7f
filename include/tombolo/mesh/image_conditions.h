// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/images.h>
#include <tombolo/mesh/nodes.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** Whether the section of a condition is one that makes images of the body. */
  bool makes_images(const Section &condition);

  /** Checks what can be checked without a mesh. */
  template <int dim>
  void validate_images(const Section &condition);

  /**
   * The mirrors that the conditions of a @p scene name. `Boundary` or `Where` of each must select
   * all nodes on one plane normal to an axis, and the body must not reach beyond it. Two planes can
   * have the same axis: the body is then the slab between them. Throws InputError. Collective.
   */
  template <int dim>
  std::shared_ptr<const Images> find_images(const Parameters &scene, const Mesh<dim> &mesh,
                                            const Nodes<dim> &nodes);

  /** Throws the InputError of @p entry of @p section that boxes of these half widths, node_stride
   * for each of the points, reach images of images, which are not made. Collective. */
  template <int dim>
  void refuse_images_of_images(const Section &section, const char *entry, const Images &images,
                               const std::vector<dealii::Point<dim>> &points,
                               const std::vector<double> &half_widths, MPI_Comm communicator);

  /** The name of the boundary at which mesh sources cut a body normal to an axis. */
  std::string name_of_cut(char axis);
} // namespace tombolo
