// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/visualization.h>

#include <tombolo/output/output.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    constexpr const char *tools = "tools";
  } // namespace

  const OutputOfScene of_visualization(0, "visualization", "Output/Write solution",
                                       [](const Section &output)
                                       { return output.get_bool("Write solution"); });

  template <int dim>
  Visualization<dim>::Visualization(const Entries &e)
      : wanted(e), xdmf_cells("cells"), xdmf_particles("particles"), xdmf_tools(tools)
  {
    using Entry = VtuSeries::Entry;
    this->records.value("outputs", n_outputs);
    this->records.items(series.entries)
        .column("times", &Entry::time)
        .column("files", &Entry::file)
        .column("names", &Entry::name)
        .column("parts", &Entry::part);
  }

  template <int dim>
  void Visualization<dim>::start(const OutputView<dim> & /*view*/, const OutputDirectory &directory,
                                 const UnitLabels &labels)
  {
    unit_labels = labels;
    this->directory = std::make_unique<OutputDirectory>(directory);
    if (!wanted.xdmf)
      directory.create_subdirectory("solution");
    if (n_outputs == 0)
      return;
    // Resumed: without those after the checkpoint.
    write_series();
    for (XdmfSeries *const grids : {&xdmf_cells, &xdmf_particles, &xdmf_tools})
      if (const std::string found = grids->resume(directory, n_outputs); !found.empty())
        remark += (remark.empty() ? "" : "\n") + found;
  }

  template <int dim>
  void Visualization<dim>::write(const OutputView<dim> &view, TimeTable & /*statistics*/)
  {
    if (remark_is_told)
      remark.clear();
    remark_is_told = true;
    const auto is_particles = [](const OutputPart<dim> &part) { return part.particles != nullptr; };
    if (!std::all_of(view.parts.begin(), view.parts.end(), is_particles))
      write_bodies(view, false);
    if (std::any_of(view.parts.begin(), view.parts.end(), is_particles))
      write_bodies(view, true);
    if (!view.surfaces.empty())
      write_tools(view);
    write_series();
    ++n_outputs;
  }

  template <int dim>
  void Visualization<dim>::write_bodies(const OutputView<dim> &view, const bool are_particles)
  {
    const VtuPiece piece =
        are_particles ? make_particle_piece(view, wanted) : make_cell_piece(view, wanted);
    if (wanted.xdmf)
      (are_particles ? xdmf_particles : xdmf_cells)
          .write(*directory, piece, n_outputs, view.time, unit_labels);
    else
      write_grid(piece, are_particles ? "particles" : "cells", view.time);
  }

  template <int dim>
  void Visualization<dim>::write_tools(const OutputView<dim> &view)
  {
    if (wanted.xdmf)
    {
      // All ranks have all surfaces; the first writes them.
      const bool is_first = Utilities::MPI::this_mpi_process(directory->communicator()) == 0;
      const VtuPiece piece = make_tool_piece(view, wanted.double_precision, is_first);
      xdmf_tools.write(*directory, piece, n_outputs, view.time, unit_labels);
      return;
    }
    const std::string file =
        std::string("solution/") + tools + "_" + Utilities::int_to_string(n_outputs, 4) + ".vtu";
    const VtuPiece piece = make_tool_piece(view, wanted.double_precision);
    directory->write(file, [&](std::ostream &out) { piece.write(out, view.time, unit_labels); });
    series.entries.push_back({view.time, file, tools, 0});
  }

  template <int dim>
  void Visualization<dim>::write_series()
  {
    VtuSeries of_bodies, of_tools;
    for (const VtuSeries::Entry &entry : series.entries)
      (entry.name == tools ? of_tools : of_bodies).entries.push_back(entry);
    if (!wanted.xdmf || !of_bodies.entries.empty())
      directory->write("solution.pvd", [&](std::ostream &out) { of_bodies.write(out); });
    if (!of_tools.entries.empty())
      directory->write("tools.pvd", [&](std::ostream &out) { of_tools.write(out); });
  }

  template <int dim>
  void Visualization<dim>::write_grid(const VtuPiece &piece, const std::string &kind,
                                      const double time)
  {
    const MPI_Comm communicator = directory->communicator();
    const std::string name = kind + "_" + Utilities::int_to_string(n_outputs, 4);
    std::vector<std::string> piece_files;
    for (unsigned int rank = 0; rank < Utilities::MPI::n_mpi_processes(communicator); ++rank)
      piece_files.push_back(name + "." + Utilities::int_to_string(rank, 4) + ".vtu");

    directory->write_pieces("solution/" +
                                piece_files[Utilities::MPI::this_mpi_process(communicator)],
                            [&](std::ostream &out) { piece.write(out, time, unit_labels); });
    directory->write("solution/" + name + ".pvtu",
                     [&](std::ostream &out) { piece.write_parallel(out, piece_files); });
    series.entries.push_back({time, "solution/" + name + ".pvtu", kind, kind == "cells" ? 0u : 1u});
  }

  template class Visualization<2>;
  template class Visualization<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, Visualization, "visualization",
                                  "Cells and particles with all their fields, for ParaView (.pvtu, "
                                  ".pvd).")
} // namespace tombolo
