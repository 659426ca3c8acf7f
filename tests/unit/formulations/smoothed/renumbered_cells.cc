// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "frozen_body.h"
#include <mesh_file_testing.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace renumbered_cells
{
  using namespace tombolo;
  using namespace tombolo::testing;
  using dealii::Point;
  using dealii::Tensor;

  constexpr unsigned int n_cells = 3; // along each axis
  constexpr unsigned int n_points = n_cells + 1;

  /** By rotation of a cube: where its corners go, numbered by the bits of their positions. */
  std::vector<std::array<unsigned int, 8>> rotations()
  {
    std::vector<std::array<unsigned int, 8>> result;
    std::array<unsigned int, 3> axes = {{0, 1, 2}};
    do
      for (unsigned int reversed = 0; reversed < 8; ++reversed)
      {
        const bool is_cyclic = (axes[1] + 3 - axes[0]) % 3 == 1;
        const unsigned int n_reversed = (reversed & 1u) + ((reversed >> 1) & 1u) + (reversed >> 2);
        if ((n_reversed % 2 == 0) != is_cyclic)
          continue;
        std::array<unsigned int, 8> rotation{};
        for (unsigned int corner = 0; corner < 8; ++corner)
        {
          for (unsigned int d = 0; d < 3; ++d)
            rotation[corner] |= ((corner >> d) & 1u) << axes[d];
          rotation[corner] ^= reversed;
        }
        result.push_back(rotation);
      }
    while (std::next_permutation(axes.begin(), axes.end()));
    return result;
  }

  /** A file of a block with warped faces; @p rotation_of is that of each cell. */
  template <typename RotationOf>
  std::string mesh_of_block(const RotationOf &rotation_of, const bool is_shuffled)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.2, 0.2);
    std::ostringstream text;
    text.precision(17);
    text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n"
         << n_points * n_points * n_points << "\n";
    for (unsigned int n = 0; n < n_points * n_points * n_points; ++n)
    {
      text << n + 1;
      for (const unsigned int i : {n % n_points, n / n_points % n_points, n / n_points / n_points})
        text << ' ' << i + shift(random);
      text << "\n";
    }
    std::vector<unsigned int> cells(n_cells * n_cells * n_cells);
    std::iota(cells.begin(), cells.end(), 0u);
    if (is_shuffled)
      std::shuffle(cells.begin(), cells.end(), random);
    text << "$EndNodes\n$Elements\n" << cells.size() << "\n";
    constexpr unsigned int corner_in_file[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const auto all = rotations();
    for (const unsigned int c : cells)
    {
      const unsigned int first = c % n_cells + n_points * (c / n_cells % n_cells) +
                                 n_points * n_points * (c / n_cells / n_cells);
      text << c + 1 << " 5 2 1 1";
      for (const unsigned int k : corner_in_file)
      {
        const unsigned int corner = all[rotation_of(c)][k];
        text << ' '
             << first + (corner & 1u) + n_points * ((corner >> 1) & 1u) +
                    n_points * n_points * (corner >> 2) + 1;
      }
      text << "\n";
    }
    text << "$EndElements\n";
    return text.str();
  }

  struct Answer
  {
    std::map<std::array<double, 3>, Tensor<1, 3>> force; // by position, of all ranks
    double volume = 0;
    double largest = 0;
  };

  /** The forces of a motion that is not uniform, after a first step of it. */
  Answer answer_of(const std::string &mesh)
  {
    const TemporaryFile file(mesh, ".msh");
    Block block;
    block.formulation = "smoothed cells";
    block.cells = {1, 1, 1};
    std::string text = parameters_of(block);
    const auto begin = text.find("set Type = box"), end = text.find("end\nend\n", begin);
    text.replace(begin, end - begin,
                 "set Type = file\nsubsection file\nset File = " + file.path + "\n");
    FrozenBody<3> body(text);
    Model<3> &model = *body.model;
    constexpr double time_increment = 1e-9;
    NodalVector velocity(model.state.partition()), force(model.state.partition());
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const x = model.state.position.node(i);
      velocity.node(i)[0] = std::sin(x[0]) * x[1];
      velocity.node(i)[1] = std::cos(x[2]) * x[0];
      velocity.node(i)[2] = x[0] * x[1] + 0.3 * std::sin(2. * x[2]);
    }
    velocity.update_ghosts();
    Answer answer;
    for (Part<3> &part : model.parts)
    {
      part.formulation->add_internal_force({&model.state.position, &velocity, time_increment},
                                           force);
      const MaterialPoints &points = part.formulation->points();
      for (unsigned int i = 0; i < points.size(); ++i)
        answer.volume += points.component(MaterialPoints::volume, 0)[i];
    }
    answer.volume = sum_over_ranks(answer.volume);
    force.add_to_owners();
    std::vector<double> values;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      values.insert(values.end(), model.state.position.node(i), model.state.position.node(i) + 3);
      values.insert(values.end(), force.node(i), force.node(i) + 3);
    }
    values = from_all_ranks(values, MPI_COMM_WORLD);
    for (std::size_t i = 0; i < values.size(); i += 6)
    {
      const double *const v = &values[i];
      const Tensor<1, 3> at_node(
          {v[3] / time_increment, v[4] / time_increment, v[5] / time_increment});
      answer.force[{{v[0], v[1], v[2]}}] = at_node;
      answer.largest = std::max(answer.largest, at_node.norm());
    }
    return answer;
  }

  void expect_same(const Answer &found, const Answer &expected)
  {
    EXPECT_NEAR(found.volume, expected.volume, 1e-13 * expected.volume);
    ASSERT_EQ(found.force.size(), expected.force.size());
    for (const auto &[position, force] : expected.force)
    {
      const auto same = found.force.find(position);
      ASSERT_TRUE(same != found.force.end());
      EXPECT_LT((same->second - force).norm(), 1e-10 * expected.largest);
    }
  }

  TEST(RenumberedCells, of_smoothed_parts_have_the_same_forces)
  {
    const Answer expected = answer_of(mesh_of_block([](unsigned int) { return 0u; }, false));
    EXPECT_EQ(rotations().size(), 24u);
    for (unsigned int rotation = 1; rotation < 24; ++rotation)
    {
      SCOPED_TRACE(rotation);
      expect_same(answer_of(mesh_of_block([&](unsigned int) { return rotation; }, false)),
                  expected);
    }
    for (unsigned int seed = 0; seed < 3; ++seed)
    {
      SCOPED_TRACE(seed);
      std::mt19937 random(seed);
      std::vector<unsigned int> cell_rotations;
      for (unsigned int c = 0; c < n_cells * n_cells * n_cells; ++c)
        cell_rotations.push_back(static_cast<unsigned int>(random() % 24));
      expect_same(
          answer_of(mesh_of_block([&](const unsigned int c) { return cell_rotations[c]; }, true)),
          expected);
    }
  }
} // namespace renumbered_cells
