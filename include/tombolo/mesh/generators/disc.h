// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/generators/cylinder.h>

namespace tombolo
{
  /** A disc: in two dimensions the RoundSection itself, with the boundaries "side" and perhaps
   * "symmetry x" and "symmetry y"; in three a Cylinder with the words of a disc, whose ends are
   * called "lower face" and "upper face". */
  template <int dim>
  class Disc;

  template <>
  class Disc<2> : public MeshSource<2>
  {
  public:
    /** Throws InputError where the entries make no disc. */
    explicit Disc(const Entries &e);

    void create(Mesh<2> &mesh) const override;

  private:
    Section section;
    RoundSection round_section;
    dealii::Point<2> centre;
  };

  template <>
  class Disc<3> : public Cylinder
  {
  public:
    /** Throws InputError where the entries make no disc. */
    explicit Disc(const Entries &e);
  };
} // namespace tombolo
