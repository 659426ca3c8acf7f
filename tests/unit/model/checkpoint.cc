// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
// Every dataset of a checkpoint is guarded, and rows reach their nodes on whatever rank has them.

#include <tombolo/simulation/simulation.h>
#include <tombolo/state/state_archive.h>

#include "output_test_directory.h"
#include "text_testing.h"

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

using namespace tombolo;
using tombolo::testing::contains;
using namespace dealii;

namespace
{
  unsigned int this_rank()
  {
    return Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  }

  /** A particle block beside elements, with a load and a clamp, whose kernels are rebuilt: it has
   * state of every kind. */
  std::string model(const std::string &directory)
  {
    return "set Dimension = 2\nset Parts = left, right\nset Materials = m\nset End time = 0.4\n"
           "set Conditions = pull, wall\nset Largest energy error = 0\nset Output directory = " +
           directory +
           "\nsubsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 2, 0.4\n"
           "set Cells = 10, 2\nend\nend\n"
           "subsection Part: left\nset Cells = x < 1\nset Formulation = hexahedron\n"
           "set Material = m\nend\n"
           "subsection Part: right\nset Cells = otherwise\nset Material = m\n"
           "set Formulation = momentum consistent particle\n"
           "subsection momentum consistent particle\nset Configuration = updated Lagrangian\n"
           "set Rebuild interval = 2\nend\nend\n"
           "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 100\n"
           "set Young's modulus = 100\nset Poisson's ratio = 0.3\nend\nend\n"
           "subsection Condition: pull\nset Where = x > 1.999\nset Type = traction\n"
           "set Function = 5*t; 0\nend\n"
           "subsection Condition: wall\nset Where = x < 1e-9\nset Type = clamp\nend\n"
           "subsection Checkpoint\nset Step interval = 7\nset Keep = 1\nend\n";
  }

  struct CheckpointedRun
  {
    explicit CheckpointedRun(const std::string &directory)
        : parameters(MPI_COMM_WORLD), log(MPI_COMM_WORLD, true, screen, false)
    {
      parameters.read_text(model(directory), "scene.prm");
      declare_run_parameters<2>(parameters);
      parameters.assign();
      simulation = create_simulation<2>(parameters, log, MPI_COMM_WORLD);
    }

    std::ostringstream screen;
    Parameters parameters;
    Log log;
    std::unique_ptr<Simulation<2>> simulation;
  };

  struct Dataset
  {
    std::string name;
    haddr_t offset;
    hsize_t size;
  };

  std::vector<Dataset> datasets_of(const std::string &file)
  {
    std::vector<Dataset> result;
    const hid_t handle = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    EXPECT_GE(handle, 0);
    const auto collect = [](hid_t group, const char *name, const H5O_info_t *info, void *list)
    {
      if (info->type == H5O_TYPE_DATASET)
      {
        const hid_t dataset = H5Dopen2(group, name, H5P_DEFAULT);
        static_cast<std::vector<Dataset> *>(list)->push_back(
            {name, H5Dget_offset(dataset), H5Dget_storage_size(dataset)});
        H5Dclose(dataset);
      }
      return herr_t(0);
    };
    H5Ovisit(handle, H5_INDEX_NAME, H5_ITER_INC, collect, &result);
    H5Fclose(handle);
    return result;
  }

  void flip_a_bit(const std::string &file, const haddr_t offset)
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (this_rank() == 0)
    {
      std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
      stream.seekg(static_cast<std::streamoff>(offset));
      const char byte = static_cast<char>(stream.get() ^ 4);
      stream.seekp(static_cast<std::streamoff>(offset));
      stream.put(byte);
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }

  std::string refusal(const std::string &file)
  {
    try
    {
      StateArchive::verify(file, MPI_COMM_WORLD);
      return "";
    }
    catch (const DamagedCheckpoint &error)
    {
      return error.what();
    }
  }
} // namespace

TEST(Checkpoint, names_the_damaged_dataset_whichever_it_is)
{
  const TestDirectory directory("damage");
  CheckpointedRun run(directory.path);
  run.simulation->run();
  const std::string file = run.simulation->last_checkpoint();
  ASSERT_FALSE(file.empty());
  EXPECT_EQ(refusal(file), "");
  const std::vector<Dataset> datasets = datasets_of(file);
  unsigned int n_damaged = 0;
  for (const Dataset &dataset : datasets)
    if (dataset.size > 0)
      for (const hsize_t damaged_byte : {hsize_t(0), dataset.size / 2, dataset.size - 1})
      {
        flip_a_bit(file, dataset.offset + damaged_byte);
        EXPECT_TRUE(contains(refusal(file), "\"" + dataset.name + "\"")) << dataset.name;
        flip_a_bit(file, dataset.offset + damaged_byte);
        ++n_damaged;
      }
  EXPECT_EQ(refusal(file), "");
  EXPECT_GT(n_damaged, 3 * 40u);
  for (const char *const name :
       {"nodes/position", "nodes/unsmoothed velocity", "part left/stress", "part right/stress",
        "part right/deformation at rebuild", "impulses", "prescribed motion/previous force",
        "time step/spectral estimator/mode", "clock/time"})
    EXPECT_EQ(std::count_if(datasets.begin(), datasets.end(),
                            [&](const Dataset &dataset) { return dataset.name == name; }),
              1)
        << name;
}

TEST(Checkpoint, is_refused_where_any_of_its_bytes_was_changed_or_is_missing)
{
  const TestDirectory directory("bytes");
  CheckpointedRun run(directory.path);
  run.simulation->run();
  const std::string file = run.simulation->last_checkpoint();
  const auto size = std::filesystem::file_size(file);
  // The descriptions of datasets have their own checksums. Some bytes of a file mean nothing.
  unsigned int n_noticed = 0;
  for (unsigned int k = 0; k < 60; ++k)
  {
    const auto offset = static_cast<haddr_t>(size * k / 60);
    flip_a_bit(file, offset);
    n_noticed += refusal(file).empty() ? 0 : 1;
    flip_a_bit(file, offset);
  }
  EXPECT_GT(n_noticed, 10u);
  EXPECT_EQ(refusal(file), "");
  for (const double share : {0.999, 0.5, 0.01, 0.})
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (this_rank() == 0)
      std::filesystem::resize_file(file,
                                   static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_TRUE(contains(refusal(file), "truncated")) << share;
  }
}

TEST(Checkpoint, holds_every_persistent_field)
{
  const TestDirectory directory("fields");
  CheckpointedRun run(directory.path);
  run.simulation->run();
  std::vector<std::string> names;
  for (const Dataset &dataset : datasets_of(run.simulation->last_checkpoint()))
    names.push_back(dataset.name);
  const auto has = [&](const std::string &name)
  { return std::find(names.begin(), names.end(), name) != names.end(); };
  for (const auto &[description, vector] : run.simulation->get_model().state.fields())
    EXPECT_EQ(has("nodes/" + description.name), description.persistent) << description.name;
  for (const Part<2> &part : run.simulation->get_model().parts)
    for (const FieldDescription &field : part.formulation->points().fields())
      EXPECT_EQ(has("part " + part.name + "/" + field.name), field.persistent) << field.name;
}

TEST(StateArchive, rows_come_back_to_their_identifiers_on_any_rank)
{
  const TestDirectory directory("rows");
  const std::string file = directory.create("rows.h5");
  const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const auto value = [](const std::uint64_t id, const unsigned int c)
  { return 1. / (3. + static_cast<double>(id) + 0.25 * c); };
  // Identifiers with gaps, assigned to ranks in turn when writing and in blocks backwards when
  // reading.
  const auto ids_of_rank = [&](const bool is_reading)
  {
    std::vector<std::uint64_t> ids;
    for (std::uint64_t k = 0; k < 101; ++k)
      if (is_reading ? k * n_ranks / 101 == n_ranks - 1 - this_rank() : k % n_ranks == this_rank())
        ids.push_back((k * k + 7) << 30);
    if (is_reading)
      std::reverse(ids.begin(), ids.end());
    return ids;
  };
  for (const bool is_reading : {false, true})
  {
    StateArchive archive(file, is_reading ? StateArchive::Mode::read : StateArchive::Mode::write,
                         MPI_COMM_WORLD);
    const std::vector<std::uint64_t> ids = ids_of_rank(is_reading);
    std::vector<double> values;
    if (!is_reading)
      for (const std::uint64_t id : ids)
        for (unsigned int c = 0; c < 3; ++c)
          values.push_back(value(id, c));
    const auto group = archive.group("a part");
    archive.set_rows(ids);
    archive.rows("values", 3, values);
    ASSERT_EQ(values.size(), 3 * ids.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_EQ(values[i], value(ids[i / 3], static_cast<unsigned int>(i % 3)));
    double share = 0.1 * (this_rank() + 1);
    std::string text = is_reading ? "" : "set End time = 1\n";
    std::vector<std::string> lines;
    if (!is_reading)
      lines = {"", "two words", ""};
    bool truth = !is_reading;
    archive.sums("share", {&share});
    std::vector<double> nothing;
    archive("nothing", nothing);
    archive("text", text);
    archive("lines", lines);
    archive("truth", truth);
    EXPECT_EQ(share, 0.1 * (this_rank() + 1));
    EXPECT_EQ(text, "set End time = 1\n");
    EXPECT_EQ(lines, (std::vector<std::string>{"", "two words", ""}));
    EXPECT_TRUE(truth);
    if (!is_reading)
      archive.close();
  }
  StateArchive archive(file, StateArchive::Mode::read, MPI_COMM_WORLD);
  double value_of_nothing = 0;
  EXPECT_THROW(archive("not there", value_of_nothing), InputError);
  const auto group = archive.group("a part");
  EXPECT_THROW(archive.sums("nothing", {}), InputError);
  std::string text;
  EXPECT_THROW(archive("nothing", text), InputError);
  std::vector<std::uint64_t> others = ids_of_rank(true);
  if (!others.empty())
    others[0] += 1;
  EXPECT_THROW(archive.set_rows(others), InputError);
  others.push_back(5);
  EXPECT_THROW(archive.set_rows(others), InputError);
}

TEST(StateArchive, nodal_vectors_come_back_with_current_ghosts)
{
  const TestDirectory directory("nodal");
  const std::string file = directory.create("nodal.h5");
  constexpr unsigned int n_of_rank = 10;
  const unsigned int first = n_of_rank * this_rank();
  const unsigned int n = n_of_rank * Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  IndexSet owned(n);
  owned.add_range(first, first + n_of_rank);
  const auto partition =
      std::make_shared<NodePartition>(owned, complete_index_set(n), MPI_COMM_WORLD);
  std::vector<std::uint64_t> ids;
  for (unsigned int i = 0; i < n_of_rank; ++i)
    ids.push_back(first + i);
  for (const bool is_reading : {false, true})
  {
    NodalVector vector(partition);
    for (unsigned int i = 0; i < n_of_rank && !is_reading; ++i)
      vector.node(i)[1] = 0.3 + first + i;
    StateArchive archive(file, is_reading ? StateArchive::Mode::read : StateArchive::Mode::write,
                         MPI_COMM_WORLD);
    archive.set_nodes(ids);
    archive.nodal("vector", 3, vector);
    for (unsigned int i = 0; i < n && is_reading; ++i)
      EXPECT_EQ(vector.node(partition->local_index(types::global_dof_index(i)))[1], 0.3 + i);
    if (!is_reading)
      archive.close();
  }
}
