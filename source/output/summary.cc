// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/summary.h>

#include <tombolo/output/unit_labels.h>
#include <tombolo/version.h>

#include <deal.II/base/config.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <Trilinos_version.h>
#include <nlohmann/json.hpp>
#include <p4est_config.h>

namespace tombolo
{
  Json version_information()
  {
    char library[MPI_MAX_LIBRARY_VERSION_STRING];
    int length = 0;
    MPI_Get_library_version(library, &length);
    const std::string mpi(library, static_cast<std::size_t>(length));

    Json result;
    result["tombolo"] = TOMBOLO_VERSION;
    result["git"] = TOMBOLO_GIT_HASH;
    result["build_type"] = TOMBOLO_BUILD_TYPE;
    result["architecture"] = TOMBOLO_ARCHITECTURE;
    result["compiler"] = __VERSION__;
    result["deal.II"] = DEAL_II_PACKAGE_VERSION;
    result["Trilinos"] = TRILINOS_VERSION_STRING;
    result["p4est"] = P4EST_PACKAGE_VERSION;
    result["MPI"] = mpi.substr(0, mpi.find_first_of(",\n"));
    return result;
  }

  Summary::Summary(const MPI_Comm communicator)
      : communicator(communicator), root(std::make_unique<Json>()),
        case_results(std::make_unique<Json>(Json::object())),
        start(std::chrono::steady_clock::now())
  {
    (*root)["versions"] = version_information();
    (*root)["ranks"] = Utilities::MPI::n_mpi_processes(communicator);
  }

  Summary::~Summary() = default;

  Json &Summary::operator[](const std::string &key)
  {
    return (*root)[key];
  }

  void Summary::set_units(const UnitLabels &labels)
  {
    Json units = Json::object();
    for (const auto &label : labels.labels())
      units[label.first] = label.second;
    (*root)["units"] = units;
  }

  void Summary::write(const OutputDirectory &directory)
  {
    if (!root->contains("wall_seconds"))
      (*root)["wall_seconds"] =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    Utilities::System::MemoryStats memory;
    Utilities::System::get_memory_stats(memory);
    // VmHWM, in kibibytes: the largest resident size of this process so far.
    (*root)["peak_memory_bytes"] =
        Utilities::MPI::sum(static_cast<std::uint64_t>(memory.VmHWM) * 1024, communicator);

    // Last, where a reader expects them.
    (*root)["results"] = *case_results;
    directory.write("summary.json", [&](std::ostream &out) { out << json_text(*root); });
  }
} // namespace tombolo
