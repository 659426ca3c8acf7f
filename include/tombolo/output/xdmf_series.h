// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/file_stream.h>
#include <tombolo/base/format.h>
#include <tombolo/base/hdf5_handle.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/output/vtu_piece.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <sstream>
#include <string>
#include <type_traits>
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
    explicit XdmfSeries(const std::string &name) : name(name) {}

    /** Continues the files of @p directory after its first @p n_outputs outputs, or begins them.
     * Returns a sentence for the user where a damaged file was put aside. Collective. */
    std::string resume(const OutputDirectory &directory, const unsigned int n_outputs)
    {
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); // errors are told by return values
      const std::string file = directory.file(name + ".h5");
      std::string remark;
      const auto read = [&]
      {
        std::vector<std::string> result;
        if (!reason_not_a_file(file).empty() || read_grids(file, n_outputs, result))
          return result;
        const std::string aside = directory.file(name + ".damaged.h5");
        remark = "The pictures in " + file + " are damaged: they are in " + aside +
                 " now, and those from here on are in a new file.";
        if (std::rename(file.c_str(), aside.c_str()) != 0)
          remark = "The pictures in " + file + " are damaged and are written anew from here on.";
        return std::vector<std::string>();
      };
      grids = from_first_rank(directory.communicator(), read);
      if (!grids.empty())
        write_index(directory);
      return from_first_rank(directory.communicator(), [&] { return remark; });
    }

    /** Adds the grid of output number @p output, the pieces of all ranks one after the other, if
     * they have cells. Throws RunError on every rank where it cannot be written. Collective. */
    void write(const OutputDirectory &directory, const VtuPiece &piece, const unsigned int output,
               const double time, const UnitLabels &unit_labels)
    {
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      const MPI_Comm communicator = directory.communicator();
      piece.check_sizes();
      if (Utilities::MPI::sum(static_cast<unsigned long>(piece.n_cells()), communicator) == 0)
        return;
      const std::string file_name = name + ".h5", path = directory.file(file_name);
      std::string problem;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        if (!grids.empty())
          problem = reason_not_a_file(path);
        else if (const int descriptor = open_new_file(path, problem); descriptor >= 0)
          ::close(descriptor);
      }
      throw_on_all_ranks<RunError>(
          problem.empty() ? "" : "Cannot write " + path + ": " + problem + ".", communicator);

      std::string grid;
      bool is_written = false;
      {
        const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
        H5Pset_fapl_mpio(access, communicator, MPI_INFO_NULL);
        Hdf5Handle file(grids.empty() ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                                      : H5Fopen(path.c_str(), H5F_ACC_RDWR, access),
                        H5Fclose);
        throw_on_all_ranks<RunError>(
            file >= 0 ? "" : "Cannot write " + path + ": HDF5 does not open it. Is the disk full?",
            communicator);
        const std::string group_name = group_of(output);
        if (H5Lexists(file, group_name.c_str(), H5P_DEFAULT) >
            0) // of a run that was resumed before
          H5Ldelete(file, group_name.c_str(), H5P_DEFAULT);
        {
          ParallelGroup group(file, file_name, group_name, communicator);
          grid = write_grid(piece, name, time, unit_labels, group);
          const auto size = Utilities::MPI::this_mpi_process(communicator) == 0 ? grid.size() : 0;
          group.write(name_of_text, std::vector<char>(grid.data(), grid.data() + size), 1);
          is_written = group.is_written;
        }
        is_written = file.close_now() && is_written;
      }
      throw_on_all_ranks<RunError>(
          is_written ? "" : "Cannot write " + path + ": HDF5 fails. Is the disk full?",
          communicator);
      grids.push_back(grid);
      write_index(directory);
    }

  private:
    static constexpr const char *name_of_text = "grid";

    static std::string group_of(const unsigned int output)
    {
      return "output_" + Utilities::int_to_string(output, 6);
    }

    /** A group of the file that all ranks write rows of their own to, one rank after the other. */
    class ParallelGroup
    {
    public:
      ParallelGroup(const hid_t file, const std::string &file_name, const std::string &name,
                    MPI_Comm communicator)
          : group_path(file_name + ":/" + name + "/"), communicator(communicator),
            group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose),
            transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose)
      {
        H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
        is_written = group >= 0;
      }

      /** Writes a dataset; returns the element of XDMF that names it. Collective. */
      template <typename Number>
      std::string write(const std::string &name, const std::vector<Number> &values,
                        const unsigned int n_columns)
      {
        const std::uint64_t n_own = values.size() / n_columns;
        const std::uint64_t first = first_row(n_own), n_rows = sum(n_own);
        const hsize_t dimensions[2] = {n_rows, n_columns}, start[2] = {first, 0},
                      count[2] = {n_own, n_columns};
        const int rank = n_columns == 1 ? 1 : 2;
        const Hdf5Handle in_file(H5Screate_simple(rank, dimensions, nullptr), H5Sclose);
        const Hdf5Handle in_memory(H5Screate_simple(rank, count, nullptr), H5Sclose);
        if (n_own == 0)
        {
          H5Sselect_none(in_file);
          H5Sselect_none(in_memory);
        }
        else
          H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, nullptr, count, nullptr);
        const Hdf5Handle dataset(H5Dcreate2(group, name.c_str(), hdf5_type_of(values.data()),
                                            in_file, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                 H5Dclose);
        is_written = is_written && dataset >= 0 &&
                     H5Dwrite(dataset, hdf5_type_of(values.data()), in_memory, in_file, transfer,
                              values.data()) >= 0;
        return std::string("<DataItem Format=\"HDF\" NumberType=\"") +
               (std::is_floating_point_v<Number> ? "Float" : "Int") + "\" Precision=\"" +
               std::to_string(sizeof(Number)) + "\" Dimensions=\"" + std::to_string(n_rows) +
               (n_columns == 1 ? "" : " " + std::to_string(n_columns)) + "\">" +
               xml_escaped(group_path + name) + "</DataItem>";
      }

      /** Real numbers in double precision or in single. Collective. */
      std::string write(const std::string &name, const VtuPiece::Values &values,
                        const unsigned int n_columns, const bool double_precision)
      {
        return std::visit(
            [&](const auto &numbers)
            {
              using Number = typename std::decay_t<decltype(numbers)>::value_type;
              if constexpr (!std::is_same_v<Number, double>)
                return write(name, std::vector<std::int64_t>(numbers.begin(), numbers.end()),
                             n_columns);
              else if (double_precision)
                return write(name, numbers, n_columns);
              else
                return write(name, std::vector<float>(numbers.begin(), numbers.end()), n_columns);
            },
            values);
      }

      /** The rows of the ranks before. Collective. */
      std::uint64_t first_row(const std::uint64_t n_own) const
      {
        std::uint64_t first = 0; // MPI leaves it as it is on rank 0
        MPI_Exscan(&n_own, &first, 1, MPI_UINT64_T, MPI_SUM, communicator);
        return first;
      }

      std::uint64_t sum(const std::uint64_t n_own) const
      {
        std::uint64_t n_rows = 0;
        MPI_Allreduce(&n_own, &n_rows, 1, MPI_UINT64_T, MPI_SUM, communicator);
        return n_rows;
      }

      bool is_written = true; ///< by this rank, so far

    private:
      std::string group_path;
      MPI_Comm communicator;
      Hdf5Handle group, transfer;
    };

    static const char *topology_of(const unsigned int vtk_cell_type)
    {
      return vtk_cell_type == 1   ? "TopologyType=\"Polyvertex\" NodesPerElement=\"1\""
             : vtk_cell_type == 3 ? "TopologyType=\"Polyline\" NodesPerElement=\"2\""
             : vtk_cell_type == 5 ? "TopologyType=\"Triangle\""
             : vtk_cell_type == 9 ? "TopologyType=\"Quadrilateral\""
                                  : "TopologyType=\"Hexahedron\"";
    }

    static const char *type_of_attribute(const unsigned int n_components)
    {
      return n_components == 1   ? "Scalar"
             : n_components == 3 ? "Vector"
             : n_components == 9 ? "Tensor"
                                 : "Matrix";
    }

    /** Names of datasets have no blanks, which readers could take for the end of the name. */
    static std::string dataset_name(const char kind, const std::size_t number,
                                    const std::string &name)
    {
      std::string result = kind + Utilities::int_to_string(static_cast<unsigned int>(number), 2);
      result += '_';
      for (const char character : name)
        result += std::isalnum(static_cast<unsigned char>(character)) != 0 ? character : '_';
      return result;
    }

    /** Writes a grid; returns its element of XDMF. Collective. */
    static std::string write_grid(const VtuPiece &piece, const std::string &name, const double time,
                                  const UnitLabels &unit_labels, ParallelGroup &group)
    {
      const std::uint64_t n_cells = group.sum(piece.n_cells());
      std::vector<std::int64_t> connectivity = piece.connectivity;
      const auto first_point = static_cast<std::int64_t>(group.first_row(piece.n_points()));
      for (std::int64_t &point : connectivity)
        point += first_point;
      std::ostringstream text;
      text << "<Grid Name=\"" << name << "\" GridType=\"Uniform\">\n<Time Value=\""
           << format_number(time) << "\"/>\n<Topology " << topology_of(piece.vtk_cell_type)
           << " NumberOfElements=\"" << n_cells << "\">"
           << group.write("connectivity", connectivity, piece.n_vertices_per_cell)
           << "</Topology>\n<Geometry GeometryType=\"XYZ\">"
           << group.write("points", VtuPiece::Values(piece.points), 3, piece.double_precision)
           << "</Geometry>\n";
      for (const bool is_on_cells : {false, true})
      {
        const std::vector<VtuPiece::Array> &arrays =
            is_on_cells ? piece.cell_data : piece.point_data;
        for (std::size_t i = 0; i < arrays.size(); ++i)
        {
          const VtuPiece::Array &array = arrays[i];
          text << "<Attribute Name=\"" << xml_escaped(array.name) << "\" AttributeType=\""
               << type_of_attribute(array.n_components) << "\" Center=\""
               << (is_on_cells ? "Cell" : "Node") << "\">"
               << group.write(dataset_name(is_on_cells ? 'c' : 'p', i, array.name), array.values,
                              array.n_components, piece.double_precision);
          if (array.unit != "1")
            text << "<Information Name=\"unit\" Value=\""
                 << xml_escaped(unit_labels.heading(array.name, array.unit)) << "\"/>";
          text << "</Attribute>\n";
        }
      }
      for (const auto &[title, list] : piece.names)
        for (const std::string &entry : list)
          text << "<Information Name=\"" << xml_escaped(title) << "\" Value=\""
               << xml_escaped(entry) << "\"/>\n";
      text << "</Grid>\n";
      return text.str();
    }

    /** The texts of the grids of the first outputs in a file; false where it is damaged. */
    static bool read_grids(const std::string &file, const unsigned int n_outputs,
                           std::vector<std::string> &grids)
    {
      const Hdf5Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
      if (opened < 0)
        return false;
      for (unsigned int output = 0; output < n_outputs; ++output)
      {
        if (H5Lexists(opened, group_of(output).c_str(), H5P_DEFAULT) <= 0)
          continue; // without cells
        const Hdf5Handle dataset(
            H5Dopen2(opened, (group_of(output) + "/" + name_of_text).c_str(), H5P_DEFAULT),
            H5Dclose);
        if (dataset < 0)
          return false;
        const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
        std::string text(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), ' ');
        if (H5Dread(dataset, H5T_NATIVE_CHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
          return false;
        grids.push_back(text);
      }
      return true;
    }

    void write_index(const OutputDirectory &directory) const
    {
      directory.write(name + ".xdmf",
                      [&](std::ostream &out)
                      {
                        out << "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n<Grid "
                               "Name=\""
                            << name << "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
                        for (const std::string &grid : grids)
                          out << grid;
                        out << "</Grid>\n</Domain>\n</Xdmf>\n";
                      });
    }

    std::string name;
    std::vector<std::string> grids; ///< XML, by time
  };
} // namespace tombolo
