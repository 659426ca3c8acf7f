// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/generators/round_section.h>
#include <tombolo/mesh/mesh_source.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A cylinder of hexahedra along a coordinate axis, from its foot in the positive direction: the
   * cells of a RoundSection, repeated in layers. Boundaries are called "foot", "rear", "side", and
   * the cuts of a half or quarter model "symmetry x", and so on, by their normal. All cells are
   * coarse, so that all vertices of layers keep their places.
   */
  class Cylinder : public MeshSource<3>
  {
  public:
    /** The words for what a cylinder and a disc have both, in entries and as boundary names. */
    struct Words
    {
      const char *body;
      const char *length;
      const char *layers;
      const char *position;
      const char *lower_boundary;
      const char *upper_boundary;
    };

    /** Throws InputError where the entries make no cylinder. */
    explicit Cylinder(const Entries &e);

    void create(Mesh<3> &mesh) const override;

  protected:
    Cylinder(const Entries &e, const Words &words);

  private:
    Words words;
    Section section;
    unsigned int axis;
    std::array<unsigned int, 2> across; ///< the axes of the section; with `axis` right-handed
    std::unique_ptr<RoundSection> round_section;
    dealii::Point<3> foot;
    std::vector<double> heights; ///< of the vertices above the foot
  };
} // namespace tombolo
