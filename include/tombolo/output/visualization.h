// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/output/output.h>
#include <tombolo/output/solution_pieces.h>
#include <tombolo/output/vtu_piece.h>
#include <tombolo/output/xdmf_series.h>

#include <memory>
#include <string>

namespace tombolo
{
  /**
   * The solution for ParaView: `solution/cells_NNNN.pvtu` (finite elements on their present
   * positions), `solution/particles_NNNN.pvtu` (particles as vertices), each with one piece per
   * rank, and `solution.pvd`, which lists them by time. A scene without elements, or without
   * particles, writes no files of them; a rank without them writes empty pieces. In scenes with
   * contacts, `solution/tools_NNNN.vtu` and `tools.pvd` have the surfaces (make_tool_piece()). With
   * `Format = xdmf` these grids are in `cells.xdmf`, `particles.xdmf` and `tools.xdmf`, each with
   * its file .h5, over all times (XdmfSeries).
   *
   * Symmetric tensors have the components of VTK, XX, YY, ZZ, XY, YZ, XZ. The field data `units`
   * has the units of arrays.
   *
   * Cells, of which one of degree p becomes p^dim linear ones: at points `displacement`,
   * `velocity`, `initial position`, `contact force` and `reaction` where the scene has contacts and
   * prescribed motion; on cells `stress`, `exact stress` where there is one, `pressure` and `von
   * Mises stress` of that stress, `volume ratio`, the material's internal variables, `part`, `owner
   * rank`. Cell values are means over the cell's material points by volume; where these lie at the
   * nodes of a cell of higher degree, means over the corners of each of its linear cells.
   *
   * Particles: `persistent id` (64 bits, exact), `initial position`, `displacement`, `velocity` (v)
   * and `unsmoothed velocity` (v̂), `contact force`, `reaction`, `stress`, `exact stress`,
   * `pressure`, `von Mises stress`, `volume ratio`, `support` (half widths), `volume`, `mass` (m̂),
   * internal variables, `part`, `shared node` (1 where the node belongs to elements too), `owner
   * rank`.
   *
   * A variable that the material of a part does not have is NaN there. Velocities are those of half
   * a step before the time of the file. Further fields are those of PictureFields.
   */
  template <int dim>
  class Visualization : public Output<dim>
  {
  public:
    explicit Visualization(const Entries &e);

    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;

    void write(const OutputView<dim> &view, TimeTable &statistics) override;

    std::string report() const override
    {
      return remark;
    }

  private:
    void write_bodies(const OutputView<dim> &view, bool are_particles);
    void write_grid(const VtuPiece &piece, const std::string &kind, double time);
    void write_tools(const OutputView<dim> &view);
    void write_series();

    PictureFields wanted;
    UnitLabels unit_labels;
    std::unique_ptr<OutputDirectory> directory;
    unsigned int n_outputs = 0;
    VtuSeries series; ///< of bodies and tools, in two files
    XdmfSeries xdmf_cells, xdmf_particles, xdmf_tools;
    std::string remark; ///< what was found when the series was resumed; until it was told
    bool remark_is_told = false;
  };
} // namespace tombolo
