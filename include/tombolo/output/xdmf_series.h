// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/output_directory.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/output/vtu_piece.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * All grids of one kind over time in two files: NAME.h5, which all ranks write together by
   * parallel HDF5, and NAME.xdmf, which names the datasets and their times for ParaView (XDMF 2).
   *
   * The file has a group for each output, `output_NNNNNN`, with the datasets of points, cells and
   * data, and the text of the grid in NAME.xdmf, so that a resumed run continues both from the file
   * alone. The index of the file is written when it is closed, after the data: a run that is killed
   * while it writes data leaves the outputs before as they were.
   *
   * Arrays of six components are matrices in the order of VTK, XX, YY, ZZ, XY, YZ, XZ: ParaView's
   * readers take those of the type Tensor6 in two different orders. All whole numbers are signed,
   * since these readers know unsigned ones of 32 bits only.
   */
  class XdmfSeries
  {
  public:
    explicit XdmfSeries(const std::string &name);

    /** Continues the files of @p directory after its first @p n_outputs outputs; without them the
     * series begins anew. Returns a sentence for the user where the file is damaged and was put
     * aside. Collective. */
    std::string resume(const OutputDirectory &directory, unsigned int n_outputs);

    /** Adds the grid of output number @p output, the pieces of all ranks one after the other.
     * Nothing is added where they have no cells. Throws RunError on every rank where it cannot be
     * written. Collective. */
    void write(const OutputDirectory &directory, const VtuPiece &piece, unsigned int output,
               double time, const UnitLabels &unit_labels);

  private:
    void write_index(const OutputDirectory &directory) const;

    std::string name;
    std::vector<std::string> grids; ///< XML, by time
  };
} // namespace tombolo
