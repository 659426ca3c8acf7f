// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/point_data.h>
#include <tombolo/output/xdmf_series.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The surfaces of all contacts of a scene at the present time, for pictures: triangles, lines in
   * two dimensions, and of planes the part next to the bodies. Cells have `contact`, the number of
   * the contact in the field data `contact names`, and of the whole contact `force on the bodies`
   * and `penetration`, the largest. The same on all ranks; without points and cells on those where
   * @p with_facets is false. Collective.
   */
  template <int dim>
  VtuPiece make_tool_piece(const OutputView<dim> &view, bool double_precision,
                           bool with_facets = true);

  /** The cells of this rank, with the data that Visualization describes. Collective. */
  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const PictureFields &requested);

  /** The particles of this rank, with the data that Visualization describes. Collective. */
  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const PictureFields &requested);

  /**
   * The solution for ParaView: `solution/cells_NNNN.pvtu` (finite elements on their present
   * positions), `solution/particles_NNNN.pvtu` (particles as vertices), each with one piece per
   * rank, and `solution.pvd`, which lists them by time. A scene without elements, or without
   * particles, writes no files of them; a rank without them writes empty pieces. In scenes with
   * contacts, `solution/tools_NNNN.vtu` and `tools.pvd` have the surfaces (make_tool_piece()). With
   * `Format = xdmf` these grids are in `cells.xdmf`, `particles.xdmf` and `tools.xdmf`, each with
   * its file .h5, over all times (XdmfSeries). doc/results.md lists the arrays.
   *
   * A cell of degree p becomes p^dim linear ones. Values of cells are means over the cell's
   * material points by volume; where these lie at the nodes of a cell of higher degree, means over
   * the corners of each of its linear cells.
   */
  template <int dim>
  class Visualization : public Output<dim>
  {
  public:
    explicit Visualization(const Entries &e)
        : requested(e), xdmf_cells("cells"), xdmf_particles("particles"), xdmf_tools(tools)
    {
      using Entry = VtuSeries::Entry;
      this->records.value("outputs", n_outputs);
      this->records.items(series.entries)
          .column("times", &Entry::time)
          .column("files", &Entry::file)
          .column("names", &Entry::name)
          .column("parts", &Entry::part);
    }

    void start(const OutputView<dim> & /*view*/, const OutputDirectory &directory,
               const UnitLabels &labels) override
    {
      unit_labels = labels;
      this->directory = std::make_unique<OutputDirectory>(directory);
      if (!requested.xdmf)
        directory.create_subdirectory("solution");
      if (n_outputs == 0)
        return;
      // Resumed: without those after the checkpoint.
      write_series();
      for (XdmfSeries *const grids : {&xdmf_cells, &xdmf_particles, &xdmf_tools})
        if (const std::string found = grids->resume(directory, n_outputs); !found.empty())
          remark += (remark.empty() ? "" : "\n") + found;
    }

    void write(const OutputView<dim> &view, TimeTable & /*statistics*/) override
    {
      if (remark_is_printed)
        remark.clear();
      remark_is_printed = true;
      const auto is_particles = [](const OutputPart<dim> &part)
      { return part.particles != nullptr; };
      if (!std::all_of(view.parts.begin(), view.parts.end(), is_particles))
        write_bodies(view, false);
      if (std::any_of(view.parts.begin(), view.parts.end(), is_particles))
        write_bodies(view, true);
      if (!view.surfaces.empty())
        write_tools(view);
      write_series();
      ++n_outputs;
    }

    std::string report() const override
    {
      return remark;
    }

  private:
    static constexpr const char *tools = "tools";

    void write_bodies(const OutputView<dim> &view, const bool are_particles)
    {
      const VtuPiece piece =
          are_particles ? make_particle_piece(view, requested) : make_cell_piece(view, requested);
      if (requested.xdmf)
        (are_particles ? xdmf_particles : xdmf_cells)
            .write(*directory, piece, n_outputs, view.time, unit_labels);
      else
        write_grid(piece, are_particles ? "particles" : "cells", view.time);
    }

    void write_grid(const VtuPiece &piece, const std::string &kind, const double time)
    {
      const MPI_Comm communicator = directory->communicator();
      const std::string name = kind + "_" + dealii::Utilities::int_to_string(n_outputs, 4);
      std::vector<std::string> piece_files;
      for (unsigned int rank = 0; rank < dealii::Utilities::MPI::n_mpi_processes(communicator);
           ++rank)
        piece_files.push_back(name + "." + dealii::Utilities::int_to_string(rank, 4) + ".vtu");

      directory->write_pieces(
          "solution/" + piece_files[dealii::Utilities::MPI::this_mpi_process(communicator)],
          [&](std::ostream &out) { piece.write(out, time, unit_labels); });
      directory->write("solution/" + name + ".pvtu",
                       [&](std::ostream &out) { piece.write_parallel(out, piece_files); });
      series.entries.push_back(
          {time, "solution/" + name + ".pvtu", kind, kind == "cells" ? 0u : 1u});
    }

    void write_tools(const OutputView<dim> &view)
    {
      if (requested.xdmf)
      {
        // All ranks have all surfaces; the first writes them.
        const bool is_first =
            dealii::Utilities::MPI::this_mpi_process(directory->communicator()) == 0;
        const VtuPiece piece = make_tool_piece(view, requested.double_precision, is_first);
        xdmf_tools.write(*directory, piece, n_outputs, view.time, unit_labels);
        return;
      }
      const std::string file = std::string("solution/") + tools + "_" +
                               dealii::Utilities::int_to_string(n_outputs, 4) + ".vtu";
      const VtuPiece piece = make_tool_piece(view, requested.double_precision);
      directory->write(file, [&](std::ostream &out) { piece.write(out, view.time, unit_labels); });
      series.entries.push_back({view.time, file, tools, 0});
    }

    void write_series()
    {
      VtuSeries body_series, tool_series;
      for (const VtuSeries::Entry &entry : series.entries)
        (entry.name == tools ? tool_series : body_series).entries.push_back(entry);
      if (!requested.xdmf || !body_series.entries.empty())
        directory->write("solution.pvd", [&](std::ostream &out) { body_series.write(out); });
      if (!tool_series.entries.empty())
        directory->write("tools.pvd", [&](std::ostream &out) { tool_series.write(out); });
    }

    PictureFields requested;
    UnitLabels unit_labels;
    std::unique_ptr<OutputDirectory> directory;
    unsigned int n_outputs = 0;
    VtuSeries series; ///< of bodies and tools, in two files
    XdmfSeries xdmf_cells, xdmf_particles, xdmf_tools;
    std::string remark; ///< what was found when the series was resumed; until it is printed
    bool remark_is_printed = false;
  };
} // namespace tombolo
