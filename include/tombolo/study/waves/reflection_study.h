// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/study/waves/reflection_case.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Named groups of reflection cases, each the product of the lists in its section "Group: NAME",
   * with one table `reflection.csv` of all of them. Ranks share the cases of a group.
   */
  class ReflectionStudy
  {
  public:
    static void declare_parameters(Parameters &parameters);

    /** Reads all groups. Throws InputError. */
    explicit ReflectionStudy(const Parameters &parameters, MPI_Comm communicator);

    unsigned int n_cases() const;

    /** Runs all cases, prints a table of each group and writes the results. Throws InputError where
     * the strip of a case cannot be built. Collective. */
    void run(Log &log, const OutputDirectory &directory);

    /** A case with its place in the table. */
    struct Row
    {
      ReflectionCase settings;
      std::string ratio; ///< as it was given
      double degrees = 0;
      double reference = ReflectionResult::none; ///< the value of a publication, in %
      ReflectionResult result;
      double seconds = 0;
    };

    struct Group
    {
      std::string name;
      std::string title;
      std::vector<Row> rows;
    };

    const std::vector<Group> &groups() const
    {
      return all_groups;
    }

  private:
    Group read_group(const Section &section) const;
    void compute(Group &group) const;
    std::string table_of(const Group &group) const;
    void write_csv(std::ostream &out) const;

    const Parameters &parameters;
    MPI_Comm communicator;
    std::vector<Group> all_groups;
  };
} // namespace tombolo
