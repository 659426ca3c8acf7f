// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "text_testing.h"

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/present_headers.h>
#include <tombolo/materials/material.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace
{
  using namespace tombolo;
  using tombolo::testing::contains;
  using tombolo::testing::input_error;

  /** The directory that tests/plugin_library/tests.cmake builds the libraries in. */
  std::string directory()
  {
    const char *const build = std::getenv("TOMBOLO_BINARY_DIR");
    return build == nullptr ? "." : std::string(build) + "/tests/plugin_library";
  }

  /** Loads what a parameter file beside the libraries names. */
  std::string loading(const std::string &names)
  {
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("\nset Plugin libraries = " + names + "\n", directory() + "/case.prm");
    return input_error([&] { load_plugin_libraries(parameters, MPI_COMM_WORLD); });
  }

  TEST(PluginLibrary, library_beside_the_parameter_file_adds_its_plugins_once)
  {
    EXPECT_FALSE(Registry<Material>::instance().has("twin"));
    EXPECT_EQ(loading("libtwin_material.so"), "");
    ASSERT_TRUE(Registry<Material>::instance().has("twin"));
    EXPECT_EQ(loading(directory() + "/libtwin_material.so"), "");

    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("subsection twin\nset Density = 2\nset Young's modulus = 3\nset Poisson's "
                         "ratio = 0\nend\n",
                         "case.prm");
    Registry<Material>::instance().declare_all(parameters.handler());
    parameters.assign();
    const auto material = Registry<Material>::instance().create("twin", parameters.section("twin"));
    EXPECT_EQ(material->density(), 4.);
  }

  TEST(PluginLibrary, missing_library_is_refused_with_the_places_that_were_tried)
  {
    const std::string message = loading("libnowhere.so");
    EXPECT_EQ(message.find(directory() + "/case.prm:2: entry \"Plugin libraries\" = "
                                         "\"libnowhere.so\": there is no library"),
              0u)
        << message;
    EXPECT_TRUE(contains(message, directory() + "/libnowhere.so\", nor \"libnowhere.so\", nor \""));
    EXPECT_TRUE(contains(message, "/lib/libnowhere.so\"."));
    EXPECT_TRUE(contains(loading("a.so, a.so"), "the name \"a.so\" stands twice."));
  }

  TEST(PluginLibrary, file_that_is_no_library_or_lacks_a_function_is_refused_with_the_reason)
  {
    EXPECT_TRUE(contains(loading("CTestTestfile.txt"), "there is no library"));
    EXPECT_TRUE(contains(loading("text.so"), "the library cannot be loaded: "));
    EXPECT_TRUE(contains(loading("libincomplete_material.so"), "function_that_nothing_defines"));
  }

  std::string content_of(const std::string &library)
  {
    std::ifstream file(directory() + "/" + library, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /** How a library of this content is refused. Collective. */
  std::string loading_content(const std::string &kind, const std::string &content)
  {
    using namespace dealii::Utilities::MPI;
    const std::string name = kind + "_" + std::to_string(this_mpi_process(MPI_COMM_WORLD)) +
                             "_of_" + std::to_string(n_mpi_processes(MPI_COMM_WORLD)) + ".so";
    std::ofstream(directory() + "/" + name, std::ios::binary) << content;
    MPI_Barrier(MPI_COMM_WORLD);
    return loading(broadcast(MPI_COMM_WORLD, name));
  }

  TEST(PluginLibrary, library_of_other_headers_is_refused_before_anything_in_it_runs)
  {
    std::string content = content_of("libexiting_material.so");
    const std::size_t position = content.find(present_headers());
    ASSERT_NE(position, std::string::npos);
    content[position] = content[position] == '0' ? '1' : '0';
    EXPECT_TRUE(contains(loading_content("stale", content),
                         "was built with other headers of Tombolo than this program"));
  }

  TEST(PluginLibrary, library_that_ends_early_is_refused_before_the_loader_crashes)
  {
    const std::string content = content_of("libtwin_material.so");
    EXPECT_TRUE(contains(loading_content("cut", content.substr(0, content.size() / 2)),
                         "the library ends early"));
  }

  TEST(PluginLibrary, library_that_throws_or_leaves_while_it_loads_ends_in_words)
  {
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
    {
      EXPECT_EXIT(loading("libthrowing_material.so"), ::testing::ExitedWithCode(1),
                  "libthrowing_material.so throws an exception while it is loaded: no licence");
      EXPECT_EXIT(loading("libexiting_material.so"), ::testing::ExitedWithCode(1),
                  "libexiting_material.so ends the program while it is loaded");
    }
  }

  TEST(PluginLibrary, plugin_of_a_name_that_is_taken_is_refused)
  {
    EXPECT_TRUE(contains(loading("libsecond_elastic_material.so"),
                         "Two plug-ins of kind material are called \"elastic\"."));
  }
} // namespace
