// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/input_file.h>

#include <tombolo/base/on_ranks.h>

#include <deal.II/base/mpi.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace tombolo
{
  namespace fs = std::filesystem;

  namespace
  {
    /** Returns what is wrong, or nothing. */
    std::string read(const Section &section, const std::string &entry, const std::string &file,
                     std::string &text)
    {
      // An entry of an included file means the directory of that file.
      const auto &parameters = section.all();
      std::vector<fs::path> candidates;
      for (const auto &beside :
           {parameters.location(section.path() + "/" + entry).file, parameters.file_name()})
        if (!beside.empty())
          candidates.push_back(fs::path(beside).parent_path() / file);
      candidates.push_back(file);

      std::error_code ignored;
      const auto found =
          std::find_if(candidates.begin(), candidates.end(),
                       [&](const fs::path &path) { return fs::exists(path, ignored); });
      if (found == candidates.end())
        return "There is no such file, neither in the directory of the parameter file nor in the "
               "working directory.";
      if (fs::is_directory(*found, ignored))
        return "This is a directory. The name of a file is needed.";
      // Others may have no end.
      if (!fs::is_regular_file(*found, ignored))
        return "This is a device or a pipe. The name of a file is needed.";
      std::ifstream stream(*found, std::ios::binary);
      text.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
      if (!stream && !stream.eof())
        return "The file cannot be read: check its permissions.";
      if (text.find_first_not_of(" \t\r\n") == text.npos)
        return "The file is empty.";
      return "";
    }
  } // namespace

  std::string read_input_file(const Section &section, const std::string &entry,
                              const MPI_Comm communicator)
  {
    return read_input_file(section, entry, section.get(entry), communicator);
  }

  std::string read_input_file(const Section &section, const std::string &entry,
                              const std::string &file, const MPI_Comm communicator)
  {
    std::string text;
    const std::string error =
        from_first_rank(communicator, [&] { return read(section, entry, file, text); });
    if (!error.empty())
      section.fail(entry, file == section.get(entry) ? error : "\"" + file + "\": " + error);
    const std::size_t size = dealii::Utilities::MPI::broadcast(communicator, text.size(), 0);
    text.resize(size);
    dealii::Utilities::MPI::broadcast(text.data(), size, 0, communicator);
    return text;
  }

  std::string extension_of(const std::string &file)
  {
    return boost::to_lower_copy(fs::path(file).extension().string());
  }
} // namespace tombolo
