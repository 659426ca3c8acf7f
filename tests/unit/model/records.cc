// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include "output_test_directory.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

using namespace dealii;
using namespace tombolo;

namespace
{
  struct Spring
  {
    double stiffness = 0;
    bool is_bonded = false;
    Tensor<1, 2> slip;
    int buffer = 0;
  };

  struct Row
  {
    double time;
    std::string file;
    unsigned int part;
  };

  /** What has one variable of each kind; of three nodes on each rank. */
  struct RecordsOwner
  {
    explicit RecordsOwner(const bool has_new_kind = true)
    {
      IndexSet owned(3 * Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
      owned.add_range(first(), first() + 3);
      partition = std::make_shared<NodePartition>(owned, owned, MPI_COMM_WORLD);
      vector.reinit(partition);
      field.reinit(partition);
      Records &all = records.group("owner");
      all.value("time", time).continues();
      all.value("name", name);
      all.value("axis", axis);
      all.sums("shares", share, axis_shares);
      all.nodal("vector", 3, vector);
      all.at_nodes(nodes, springs)
          .numbers("stiffness", &Spring::stiffness, &Spring::is_bonded)
          .continues()
          .vector("slip", &Spring::slip)
          .samples_field(field);
      all.list(
          [this](Records &now)
          {
            if (time > 1.)
              now.value("late", late);
          });
      all.items(rows)
          .column("times", &Row::time)
          .column("files", &Row::file)
          .column("parts", &Row::part);
      all.on_reading([this] { was_read = late; });
      all.on_continuation([this] { is_continued = true; });
      if (has_new_kind)
        all.value("further", further).optional();
    }

    static unsigned int first()
    {
      return 3 * Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    }

    void fill()
    {
      time = 2.;
      name = "two";
      axis[1] = 3.;
      share = axis_shares[1] = 4. + first();
      vector.node(1)[2] = 5. + first();
      springs[1].stiffness = 6.;
      springs[1].is_bonded = true;
      springs[1].slip[1] = 7.;
      springs[1].buffer = 8;
      late = 9.;
      rows = {{0.5, "a", 1}, {1.5, "b", 2}};
      further = 10.;
    }

    static std::vector<std::uint64_t> ids()
    {
      return {first(), first() + 1u, first() + 2u};
    }

    void write(const std::string &file, const bool divides = false)
    {
      StateArchive archive(file, StateArchive::Mode::write, MPI_COMM_WORLD);
      if (divides)
        archive.divide({});
      archive.set_nodes(ids());
      records.serialize(archive);
      archive.close();
    }

    std::shared_ptr<const NodePartition> partition;
    double time = 0, share = 0, late = 0, further = 0, was_read = 0;
    std::string name;
    Tensor<1, 3> axis;
    std::array<double, 3> axis_shares{};
    NodalVector vector, field;
    std::vector<unsigned int> nodes{0, 1};
    std::vector<Spring> springs{2};
    std::vector<Row> rows;
    bool is_continued = false;
    Records records;
  };

  void expect_filled(const RecordsOwner &owner)
  {
    EXPECT_EQ(owner.time, 2.);
    EXPECT_EQ(owner.name, "two");
    EXPECT_EQ(owner.axis[1], 3.);
    EXPECT_EQ(owner.share, 4. + RecordsOwner::first());
    EXPECT_EQ(owner.axis_shares[1], 4. + RecordsOwner::first());
    EXPECT_EQ(owner.vector.node(1)[2], 5. + RecordsOwner::first());
    ASSERT_EQ(owner.springs.size(), 2u);
    EXPECT_EQ(owner.springs[1].stiffness, 6.);
    EXPECT_TRUE(owner.springs[1].is_bonded);
    EXPECT_FALSE(owner.springs[0].is_bonded);
    EXPECT_EQ(owner.springs[1].slip[1], 7.);
    EXPECT_EQ(owner.late, 9.);
  }

} // namespace

TEST(Records, come_back_from_a_checkpoint)
{
  const TestDirectory directory("records");
  const std::string file = directory.create("records.h5");
  RecordsOwner first(false), second;
  first.fill();
  first.write(file);
  StateArchive archive(file, StateArchive::Mode::read, MPI_COMM_WORLD);
  archive.set_nodes(RecordsOwner::ids());
  second.records.serialize(archive);
  expect_filled(second);
  EXPECT_EQ(second.was_read, 9.);
  EXPECT_EQ(second.further, 0.);
  EXPECT_FALSE(second.is_continued);
  ASSERT_EQ(second.rows.size(), 2u);
  EXPECT_EQ(second.rows[1].time, 1.5);
  EXPECT_EQ(second.rows[1].file, "b");
  EXPECT_EQ(second.rows[1].part, 2u);
}

TEST(Records, go_back_to_what_was_kept_any_number_of_times)
{
  RecordsOwner owner;
  owner.fill();
  owner.records.keep();
  for (unsigned int trial = 0; trial < 2; ++trial)
  {
    owner.time = owner.share = owner.late = -1.;
    owner.name = "other";
    owner.axis = Tensor<1, 3>();
    owner.axis_shares.fill(-1.);
    owner.vector.set_zero();
    owner.springs.assign(2, Spring());
    owner.records.restore();
    expect_filled(owner);
    EXPECT_EQ(owner.springs[1].buffer, 8);
  }
}

TEST(Records, a_run_that_starts_from_the_end_of_another_takes_what_continues_and_is_there)
{
  const TestDirectory directory("records_continued");
  const std::string file = directory.create("records.h5");
  RecordsOwner first, second;
  first.fill();
  first.write(file);
  second.records.group("of nobody").value("nothing", second.further).continues();
  StateArchive archive(file, StateArchive::Mode::read, MPI_COMM_WORLD);
  archive.set_nodes(RecordsOwner::ids());
  second.records.continue_from(archive);
  EXPECT_EQ(second.time, 2.);
  EXPECT_EQ(second.springs[1].stiffness, 6.);
  EXPECT_EQ(second.springs[1].slip[1], 0.);
  EXPECT_EQ(second.name, "");
  EXPECT_EQ(second.share, 0.);
  EXPECT_EQ(second.was_read, 0.);
  EXPECT_TRUE(second.is_continued);
}

TEST(Records, new_nodes_of_a_divided_mesh_get_zeros_or_the_mean_of_a_field)
{
  const TestDirectory directory("records_divided");
  const std::string file = directory.create("records.h5");
  RecordsOwner first, second;
  first.fill();
  first.field.node(2)[1] = 9.;
  first.write(file, true);
  StateArchive archive(file, StateArchive::Mode::read, MPI_COMM_WORLD);
  archive.divide({});
  const unsigned int n = RecordsOwner::first();
  archive.set_nodes(RowSources{{{n + 1u, 0.5}, {n + 2u, 0.5}}, {{n + 1u, 1.}}, {{n, 1.}}});
  second.records.serialize(archive);
  EXPECT_EQ(second.springs[1].stiffness, 6.);
  EXPECT_EQ(second.springs[1].slip[1], 7.);
  EXPECT_EQ(second.springs[0].stiffness, 0.);
  EXPECT_EQ(second.springs[0].slip[1], 8.); // between 7 of a spring and 9 of the field
  EXPECT_EQ(second.vector.node(0)[2], 0.5 * (5. + n));
  EXPECT_EQ(second.vector.node(1)[2], 5. + n);
}
