// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/visualization.h>

#include <tombolo/output/solution_pieces.h>
#include <tombolo/output/tool_piece.h>

#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *tools = "tools";
  }

  template <int dim>
  void Visualization<dim>::declare_parameters(ParameterHandler &handler)
  {
    PictureFields::declare_parameters(handler);
  }

  template <int dim>
  Visualization<dim>::Visualization(const Section &section) : wanted(section)
  {}

  template <int dim>
  void Visualization<dim>::start(const OutputView<dim> & /*view*/, const OutputDirectory &directory,
                                 const UnitLabels &labels)
  {
    unit_labels = labels;
    this->directory = std::make_unique<OutputDirectory>(directory);
    directory.create_subdirectory("solution");
    if (n_outputs > 0) // resumed: without those after the checkpoint
      write_series();
  }

  template <int dim>
  void Visualization<dim>::serialize(StateArchive &archive)
  {
    std::vector<double> times;
    std::vector<std::string> files, names;
    std::vector<std::uint64_t> parts;
    for (const VtuSeries::Entry &entry : series.entries)
    {
      times.push_back(entry.time);
      files.push_back(entry.file);
      names.push_back(entry.name);
      parts.push_back(entry.part);
    }
    archive("outputs", n_outputs);
    archive("times", times);
    archive("files", files);
    archive("names", names);
    archive("parts", parts);
    if (files.size() != times.size() || names.size() != times.size() ||
        parts.size() != times.size())
      archive.fail("the lists \"times\", \"files\", \"names\" and \"parts\" of the pictures "
                   "are not of the same length.");
    series.entries.clear();
    for (std::size_t i = 0; i < times.size(); ++i)
      series.entries.push_back({times[i], files[i], names[i], static_cast<unsigned int>(parts[i])});
  }

  template <int dim>
  void Visualization<dim>::write(const OutputView<dim> &view, TimeTable & /*statistics*/)
  {
    const auto is_particles = [](const OutputPart<dim> &part) { return part.particles != nullptr; };
    if (!std::all_of(view.parts.begin(), view.parts.end(), is_particles))
      write_grid(make_cell_piece(view, wanted), "cells", view.time);
    if (std::any_of(view.parts.begin(), view.parts.end(), is_particles))
      write_grid(make_particle_piece(view, wanted), "particles", view.time);
    if (!view.contacts.empty())
      write_tools(view);
    write_series();
    ++n_outputs;
  }

  template <int dim>
  void Visualization<dim>::write_tools(const OutputView<dim> &view)
  {
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
