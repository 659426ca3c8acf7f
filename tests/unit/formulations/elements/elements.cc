// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include "dimensions.h"
#include "element_block.h"
#include "text_testing.h"

#include <gtest/gtest.h>

#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/logarithmic_strain.h>

namespace tombolo
{
  namespace
  {
    using testing::contains;

    /** A test of every element in two and three dimensions. */
    template <typename TestedDimension>
    class Elements : public ::testing::Test
    {
    public:
      static constexpr int dim = TestedDimension::value;

      template <typename Check>
      void for_all(const Check &check, const BlockSettings &settings = {})
      {
        for (const ElementChoice &choice : all_elements())
          for (const std::string measure : {"rate", "logarithmic"})
          {
            const std::string entries = choice.entries + "\nset Strain measure = " + measure;
            SCOPED_TRACE(choice.name + " " + entries);
            ElementBlock<dim> block({choice.name, entries}, settings);
            check(block);
          }
      }
    };
    TYPED_TEST_SUITE(Elements, testing::Dimensions);

    /** Components of a linear map that moves, shears and turns; in the plane for dim = 2. */
    template <int dim>
    Vector3 linear_map(const Vector3 &x)
    {
      const double a[3][3] = {{0.3, -0.5, 0.2}, {0.4, -0.2, 0.7}, {-0.6, 0.1, 0.5}};
      Vector3 result = {1., -2., 0.5};
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i] += a[i][j] * x[j];
      for (unsigned int i = dim; i < 3; ++i)
        result[i] = 0.;
      return result;
    }

    /** Turns by an angle, about an oblique axis in three dimensions. */
    template <int dim>
    Matrix3<double> turn(const double angle)
    {
      const double length = std::sqrt(14.);
      const double axis[3] = {dim == 3 ? 1. / length : 0., dim == 3 ? -2. / length : 0.,
                              dim == 3 ? 3. / length : 1.};
      const double c = std::cos(angle), s = std::sin(angle);
      Matrix3<double> result;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          result(i, j) = (i == j ? c : 0.) + (1. - c) * axis[i] * axis[j];
      for (unsigned int i = 0; i < 3; ++i)
      {
        const unsigned int j = (i + 1) % 3, k = (i + 2) % 3;
        result(j, i) += s * axis[k];
        result(i, j) -= s * axis[k];
      }
      return result;
    }

    Vector3 apply(const Matrix3<double> &matrix, const Vector3 &x)
    {
      Vector3 result{};
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          result[i] += matrix(i, j) * x[j];
      return result;
    }

    TYPED_TEST(Elements,
               a_distorted_patch_under_a_linear_velocity_has_constant_stress_and_no_force_inside)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            const double dt = 0.01;
            block.set(block.velocity, linear_map<dim>);
            block.compute_force(dt);

            Matrix3<double> h = zero_matrix<double>();
            const Vector3 origin = linear_map<dim>({0., 0., 0.});
            for (unsigned int j = 0; j < dim; ++j)
            {
              Vector3 unit{};
              unit[j] = 1.;
              for (unsigned int i = 0; i < dim; ++i)
                h(i, j) = dt * (linear_map<dim>(unit)[i] - origin[i]);
            }
            MotionIncrement<double> motion = motion_increment(h);
            if (block.is_logarithmic)
            {
              Matrix3<Lanes> h_lanes;
              for (unsigned int k = 0; k < 9; ++k)
                h_lanes.entry[k] = h.entry[k];
              Lanes unstressed[6] = {0., 0., 0., 0., 0., 0.};
              const MotionIncrement<Lanes> logarithmic =
                  logarithmic_increment(h_lanes, {1., 1.}, unstressed);
              for (unsigned int c = 0; c < 6; ++c)
                motion.strain[c] = logarithmic.strain[c][0];
            }
            for (double &strain : motion.strain) // of the Kirchhoff stress
              strain /= motion.volume_factor;
            const double shear = block.material->shear_modulus();
            const double lambda = block.material->bulk_modulus() - 2. / 3. * shear;
            const double trace = motion.strain[0] + motion.strain[1] + motion.strain[2];
            for (const unsigned int i : block.point_numbers())
            {
              for (unsigned int c = 0; c < 6; ++c)
                ASSERT_NEAR(block.formulation->points().component(MaterialPoints::stress, c)[i],
                            2. * shear * motion.strain[c] + (c < 3 ? lambda * trace : 0.),
                            1e-12 * shear);
              ASSERT_NEAR(block.formulation->points().component(MaterialPoints::volume_ratio, 0)[i],
                          motion.volume_factor, 1e-12);
            }
            const double largest = block.maximum(block.force);
            EXPECT_GT(largest, 1e-3 * shear);
            for (const unsigned int i : block.interior_nodes())
              for (unsigned int d = 0; d < dim; ++d)
                ASSERT_NEAR(block.force.node(i)[d], 0., 1e-13 * largest);
          });
    }

    TYPED_TEST(Elements, a_turn_by_360_degrees_turns_stress_and_hourglass_forces_with_it)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            const double dt = 0.1;
            block.set(block.velocity, wavy);
            block.compute_force(dt);
            block.velocity.set_zero();
            block.compute_force(0.);
            NodalVector first_force = block.force.copy();
            const MaterialPoints &points = block.formulation->points();
            const std::vector<unsigned int> numbers = block.point_numbers();
            std::vector<Matrix3<double>> first_stress;
            const unsigned int voigt_index[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
            const auto stress_at = [&](const unsigned int i)
            {
              Matrix3<double> stress;
              for (unsigned int a = 0; a < 3; ++a)
                for (unsigned int b = 0; b < 3; ++b)
                  stress(a, b) = points.component(MaterialPoints::stress, voigt_index[a][b])[i];
              return stress;
            };
            double scale = 0;
            for (const unsigned int i : numbers)
            {
              first_stress.push_back(stress_at(i));
              for (const double entry : first_stress.back().entry)
                scale = std::max(scale, std::abs(entry));
            }
            const EnergyAccounts first_energies = block.formulation->energies();

            const unsigned int n_steps = 24;
            for (unsigned int step = 1; step <= n_steps; ++step)
            {
              const Matrix3<double> to_new = turn<dim>(2. * M_PI * step / n_steps);
              const Matrix3<double> to_old = turn<dim>(2. * M_PI * (step - 1) / n_steps);
              block.set(block.position, [&](const Vector3 &x) { return apply(to_new, x); });
              block.set(block.velocity,
                        [&](const Vector3 &x)
                        {
                          Vector3 result = apply(to_new, x);
                          for (unsigned int d = 0; d < 3; ++d)
                            result[d] = (result[d] - apply(to_old, x)[d]) / dt;
                          return result;
                        });
              block.compute_force(dt);
              if (step % 5 != 0 && step != n_steps)
                continue;
              for (unsigned int n = 0; n < numbers.size(); ++n)
              {
                const Matrix3<double> now = stress_at(numbers[n]);
                const Matrix3<double> half = multiply(to_new, first_stress[n]);
                for (unsigned int a = 0; a < 3; ++a)
                  for (unsigned int b = 0; b < 3; ++b)
                  {
                    double expected = 0;
                    for (unsigned int c = 0; c < 3; ++c)
                      expected += half(a, c) * to_new(b, c);
                    ASSERT_NEAR(now(a, b), expected, 1e-10 * scale) << "step " << step;
                  }
              }
            }
            first_force.update_ghosts();
            const double largest = block.maximum(first_force);
            for (unsigned int i = 0; i < block.partition->n_owned(); ++i)
              for (unsigned int d = 0; d < dim; ++d)
                ASSERT_NEAR(block.force.node(i)[d], first_force.node(i)[d], 1e-10 * largest);
            const EnergyAccounts energies = block.formulation->energies();
            EXPECT_NEAR(energies["elastic energy"], first_energies["elastic energy"],
                        1e-10 * first_energies["elastic energy"]);
            EXPECT_NEAR(energies["hourglass energy"], first_energies["hourglass energy"],
                        1e-10 * first_energies["elastic energy"]);
            EXPECT_NEAR(energies["viscous dissipation"], first_energies["viscous dissipation"],
                        1e-10 * first_energies["elastic energy"]);
          });
    }

    TYPED_TEST(Elements, forces_and_their_moments_sum_to_zero_in_any_state)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            block.set(block.velocity, wavy);
            block.compute_force(0.05);
            Vector3 sum{}, moment{};
            for (unsigned int i = 0; i < block.partition->n_owned(); ++i)
            {
              const double *const x = block.position.node(i);
              const double *const f = block.force.node(i);
              for (unsigned int d = 0; d < 3; ++d)
              {
                const unsigned int j = (d + 1) % 3, k = (d + 2) % 3;
                sum[d] += f[d];
                moment[d] += x[j] * f[k] - x[k] * f[j];
              }
            }
            const double largest = block.maximum(block.force);
            for (unsigned int d = 0; d < 3; ++d)
            {
              EXPECT_NEAR(dealii::Utilities::MPI::sum(sum[d], block.communicator), 0.,
                          1e-12 * largest);
              EXPECT_NEAR(dealii::Utilities::MPI::sum(moment[d], block.communicator), 0.,
                          1e-12 * largest);
            }
          });
    }

    TYPED_TEST(Elements, the_stiffness_action_is_symmetric_and_ignores_rigid_motion)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            NodalVector u(block.partition), v(block.partition), rigid(block.partition);
            block.set(u, wavy);
            block.set(v, other_wavy);
            const double u_k_v = u.dot(block.stiffness_action(v));
            const double v_k_u = v.dot(block.stiffness_action(u));
            const double u_k_u = u.dot(block.stiffness_action(u));
            EXPECT_GT(u_k_u, 0.);
            EXPECT_NEAR(u_k_v, v_k_u, 1e-12 * u_k_u);

            block.set(rigid,
                      [](const Vector3 &x)
                      {
                        return dim == 2 ? Vector3{1. - 2. * x[1], 2. * x[0] - 3., 0.}
                                        : Vector3{1. - 2. * x[1] + x[2], 2. * x[0] - 0.5 * x[2],
                                                  -x[0] + 0.5 * x[1]};
                      });
            EXPECT_LT(block.maximum(block.stiffness_action(rigid)),
                      1e-12 * block.maximum(block.stiffness_action(u)));
          });
    }

    TYPED_TEST(Elements, the_force_of_a_small_step_is_minus_the_stiffness_action)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            const double dt = 1e-7;
            block.set(block.velocity, wavy);
            block.compute_force(dt);
            const NodalVector action = block.stiffness_action(block.velocity);
            const double largest = block.maximum(action);
            for (unsigned int i = 0; i < block.partition->n_owned(); ++i)
              for (unsigned int d = 0; d < dim; ++d)
                ASSERT_NEAR(block.force.node(i)[d] / dt, -action.node(i)[d], 2e-6 * largest);
          });
    }

    TYPED_TEST(Elements, the_work_of_the_force_is_the_stored_and_dissipated_energy)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            const double dt = 1e-7;
            block.set(block.velocity, wavy);
            block.compute_force(dt);
            const EnergyAccounts energies = block.formulation->energies();
            const double energy = dealii::Utilities::MPI::sum(energies["elastic energy"] +
                                                                  energies["hourglass energy"] +
                                                                  energies["viscous dissipation"],
                                                              block.communicator);
            const double work = -0.5 * dt * block.force.dot(block.velocity);
            EXPECT_GT(work, 0.);
            EXPECT_NEAR(energy, work, 2e-6 * work);
          });
    }

    TYPED_TEST(Elements, a_vibrating_block_keeps_the_sum_of_its_energies)
    {
      constexpr int dim = TestFixture::dim;
      BlockSettings small;
      small.n_cells = 2;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            NodalVector mass(block.partition, Quantity::scalar);
            block.formulation->add_mass(mass);
            mass.add_to_owners();
            // So small an amplitude that the block is linear to five digits.
            block.set(block.velocity,
                      [](const Vector3 &x)
                      {
                        const Vector3 v = wavy(x);
                        return Vector3{1e-6 * v[0], 1e-6 * v[1], 1e-6 * v[2]};
                      });
            const double dt = 0.5 * dealii::Utilities::MPI::min(
                                        block.formulation->courant_limit(block.position).time_step,
                                        block.communicator);
            double first = 0, smallest_kinetic = 1e300;
            EnergyAccounts energies;
            for (unsigned int step = 0; step < 200; ++step)
            {
              block.compute_force(step == 0 ? 0. : dt);
              double kinetic = 0; // ½ v_{n-1/2} · m v_{n+1/2}
              for (unsigned int i = 0; i < block.partition->n_owned(); ++i)
                for (unsigned int d = 0; d < dim; ++d)
                {
                  double &v = block.velocity.node(i)[d];
                  const double next = v + dt / *mass.node(i) * block.force.node(i)[d];
                  kinetic += 0.5 * v * *mass.node(i) * next;
                  v = next;
                  block.position.node(i)[d] += dt * next;
                }
              block.velocity.update_ghosts();
              block.position.update_ghosts();
              energies = block.formulation->energies();
              energies.sum_over_ranks(block.communicator);
              kinetic = dealii::Utilities::MPI::sum(kinetic, block.communicator);
              const double total = kinetic + energies["elastic energy"] +
                                   energies["hourglass energy"] + energies["viscous dissipation"];
              if (step == 0)
                first = total;
              smallest_kinetic = std::min(smallest_kinetic, kinetic);
              ASSERT_NEAR(total, first, 1e-5 * first) << "step " << step;
            }
            EXPECT_LT(smallest_kinetic, 0.9 * first); // the rest is rigid motion
            if (block.formulation->n_points_per_cell() == 1)
            {
              EXPECT_GT(energies["hourglass energy"] + energies["viscous dissipation"],
                        1e-3 * first);
            }
          },
          small);
    }

    TYPED_TEST(Elements, volumes_follow_the_motion)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            // Finite differences of the volume against the integrated gradient, a velocity that is
            // not linear.
            const double first = block.volume();
            const double step = 1e-5;
            double volume[2];
            for (const unsigned int side : {0u, 1u})
            {
              block.set(block.position,
                        [&](const Vector3 &x)
                        {
                          Vector3 moved = x;
                          for (unsigned int d = 0; d < dim; ++d)
                            moved[d] += (side == 1 ? step : -step) * wavy(x)[d];
                          return moved;
                        });
              block.velocity.set_zero();
              block.compute_force(0.);
              volume[side] = block.volume();
            }
            block.position.copy_from(block.initial_position);
            block.set(block.velocity, wavy);
            block.compute_force(step);
            double rate = 0;
            const MaterialPoints &points = block.formulation->points();
            for (const unsigned int i : block.point_numbers())
              rate += points.component(MaterialPoints::volume, 0)[i] *
                      (points.component(MaterialPoints::volume_ratio, 0)[i] - 1.) / step;
            rate = dealii::Utilities::MPI::sum(rate, block.communicator);
            EXPECT_NEAR((volume[1] - volume[0]) / (2. * step), rate, 1e-4 * first);
            EXPECT_GT(std::abs(rate), 1e-2 * first);
          });
    }

    TYPED_TEST(Elements, a_large_linear_motion_keeps_the_mass_of_every_point)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            const std::vector<unsigned int> numbers = block.point_numbers();
            const MaterialPoints &points = block.formulation->points();
            std::vector<double> first;
            for (const unsigned int i : numbers)
              first.push_back(points.component(MaterialPoints::volume, 0)[i]);
            const double dt = 0.3;
            block.set(block.velocity, linear_map<dim>);
            block.set(block.position,
                      [&](const Vector3 &x)
                      {
                        Vector3 moved = x;
                        for (unsigned int d = 0; d < dim; ++d)
                          moved[d] += dt * linear_map<dim>(x)[d];
                        return moved;
                      });
            block.compute_force(dt);
            for (unsigned int n = 0; n < numbers.size(); ++n)
            {
              const double ratio = points.component(MaterialPoints::volume_ratio, 0)[numbers[n]];
              EXPECT_GT(std::abs(ratio - 1.), 0.01);
              ASSERT_NEAR(points.component(MaterialPoints::volume, 0)[numbers[n]], ratio * first[n],
                          1e-12 * first[n]);
            }
          });
    }

    TYPED_TEST(Elements, the_lumped_mass_has_the_mass_and_the_centre_of_the_block)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            NodalVector mass(block.partition, Quantity::scalar);
            block.formulation->add_mass(mass);
            mass.add_to_owners();
            double sum = 0, smallest = 1e300;
            Vector3 first_moment{};
            for (unsigned int i = 0; i < block.partition->n_owned(); ++i)
            {
              sum += *mass.node(i);
              smallest = std::min(smallest, *mass.node(i));
              for (unsigned int d = 0; d < dim; ++d)
                first_moment[d] += *mass.node(i) * block.position.node(i)[d];
            }
            sum = dealii::Utilities::MPI::sum(sum, block.communicator);
            const double density = block.material->density();
            EXPECT_NEAR(sum, density * block.volume(), 1e-12 * sum);
            EXPECT_GT(smallest, 0.);

            if (block.formulation->n_points_per_cell() == 1)
              return; // one point does not integrate x
            std::vector<dealii::Point<dim>> positions;
            block.formulation->point_positions(block.position, positions);
            Vector3 exact{};
            for (const unsigned int i : block.point_numbers())
              for (unsigned int d = 0; d < dim; ++d)
                exact[d] += density *
                            block.formulation->points().component(MaterialPoints::volume, 0)[i] *
                            positions[i][d];
            for (unsigned int d = 0; d < dim; ++d)
              EXPECT_NEAR(dealii::Utilities::MPI::sum(first_moment[d], block.communicator),
                          dealii::Utilities::MPI::sum(exact[d], block.communicator), 1e-12 * sum);
          });
    }

    TYPED_TEST(Elements, padded_lanes_are_no_cells)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            block.set(block.velocity, wavy);
            block.compute_force(0.01);
            const MaterialPoints &points = block.formulation->points();
            const double *const volume = points.component(MaterialPoints::volume, 0);
            std::vector<bool> belongs(points.size(), false);
            for (const unsigned int i : block.point_numbers())
              belongs[i] = true;
            double n_extra = 0;
            for (unsigned int i = 0; i < points.size(); ++i)
              if (belongs[i])
                ASSERT_GT(volume[i], 0.);
              else
              {
                ASSERT_EQ(volume[i], 0.);
                n_extra += 1.;
              }
            EXPECT_GT(dealii::Utilities::MPI::sum(n_extra, block.communicator), 0.);
            std::vector<dealii::Point<dim>> positions;
            block.formulation->point_positions(block.position, positions);
            ASSERT_EQ(positions.size(), block.formulation->initial_point_positions().size());
            for (unsigned int i = 0; i < positions.size(); ++i)
              ASSERT_LT(positions[i].distance(block.formulation->initial_point_positions()[i]),
                        1e-13);
          });
    }

    TYPED_TEST(Elements, all_ranks_together_compute_what_one_rank_computes)
    {
      constexpr int dim = TestFixture::dim;
      for (const ElementChoice &choice : all_elements())
      {
        SCOPED_TRACE(choice.name + " " + choice.entries);
        BlockSettings alone;
        alone.communicator = MPI_COMM_SELF;
        std::vector<double> results[2];
        for (const bool together : {false, true})
        {
          ElementBlock<dim> block(choice, together ? BlockSettings() : alone);
          NodalVector weight(block.partition);
          block.set(weight, other_wavy);
          block.set(block.velocity, wavy);
          block.compute_force(0.05);
          const EnergyAccounts energies = block.formulation->energies();
          const StepLimit limit = block.formulation->courant_limit(block.position);
          results[together] = {
              block.force.dot(weight), block.force.dot(block.force),
              dealii::Utilities::MPI::sum(energies["elastic energy"], block.communicator),
              dealii::Utilities::MPI::sum(energies["hourglass energy"] +
                                              energies["viscous dissipation"],
                                          block.communicator),
              dealii::Utilities::MPI::min(limit.time_step, block.communicator)};
        }
        for (unsigned int i = 0; i < 5; ++i)
          EXPECT_NEAR(results[1][i], results[0][i], 1e-12 * (1. + std::abs(results[0][i]))) << i;
      }
    }

    TYPED_TEST(Elements, an_inverted_or_lost_cell_is_reported_with_its_place)
    {
      constexpr int dim = TestFixture::dim;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            block.compute_force(0.);
            EXPECT_EQ(block.formulation->failure(), "");
            block.set(block.position, [](const Vector3 &x) { return Vector3{-x[0], x[1], x[2]}; });
            block.compute_force(0.);
            EXPECT_TRUE(contains(block.formulation->failure(), "turned inside out"));
            EXPECT_NE(block.formulation->failure().find("the cell at (-"), std::string::npos);
            block.set(block.position,
                      [](const Vector3 &x) {
                        return Vector3{x[0] / 0., x[1], x[2]};
                      });
            block.compute_force(0.);
            EXPECT_TRUE(contains(block.formulation->failure(), "not finite"));
            block.position.copy_from(block.initial_position);
            block.compute_force(0.);
            EXPECT_EQ(block.formulation->failure(), "");
          });
    }

    TYPED_TEST(Elements, the_courant_limit_is_the_crossing_time_of_the_smallest_cell)
    {
      constexpr int dim = TestFixture::dim;
      BlockSettings regular;
      regular.distortion = 0.;
      this->for_all(
          [](ElementBlock<dim> &block)
          {
            // The whole block stretched along y to 2, its first layer of cells squeezed to 1/4
            // along x.
            block.set(block.position,
                      [](const Vector3 &x) {
                        return Vector3{x[0] < 1. ? 0.25 * x[0] : x[0] - 0.75, 2. * x[1], x[2]};
                      });
            const StepLimit limit = block.formulation->courant_limit(block.position);
            const unsigned int degree = block.formulation->degree();
            const double length = degree == 1   ? 0.25
                                  : degree == 2 ? 0.125 * 0.8165
                                                : 0.25 * (0.5 - 0.5 / std::sqrt(5.)) * 0.8394;
            const double smallest =
                dealii::Utilities::MPI::min(limit.time_step, block.communicator);
            EXPECT_NEAR(smallest, length / block.material->longitudinal_wave_speed(),
                        1e-12 * smallest);
            EXPECT_EQ(limit.entity, "cell");
            if (limit.time_step < 1.001 * smallest)
            {
              EXPECT_NEAR(limit.position[0], 0.125, 1e-12);
            }
          },
          regular);
    }

    /** Elastic energy of the hourglass forces of a cell that is sheared beyond its yield stress. */
    double hourglass_energy(const std::string &limit)
    {
      BlockSettings settings;
      settings.n_cells = 1;
      settings.distortion = 0.;
      settings.yield_stress = 0.1;
      ElementBlock<3> block({"hexahedron", "set Hourglass limit = " + limit}, settings);
      const auto bend_and_shear = [](const Vector3 &x)
      { return Vector3(x[1] + 4. * (x[1] - 0.5) * (x[2] - 0.5)); };
      constexpr double step = 0.01;
      block.set(block.velocity, bend_and_shear);
      block.set(block.position, [&](const Vector3 &x)
                { return Vector3(x[0] + step * bend_and_shear(x)[0], x[1], x[2]); });
      block.compute_force(step);
      const MaterialPoints &points = block.formulation->points();
      const auto value = [&](const std::string &field, const unsigned int c, const unsigned int i)
      { return points.component(points.find_field(field), c)[i]; };
      double energy = 0;
      for (const unsigned int i : block.point_numbers())
        for (unsigned int mode = 1; mode <= 4; ++mode)
          for (unsigned int c = 0; c < 3; ++c)
            energy += 0.5 * std::pow(value("hourglass force " + std::to_string(mode), c, i), 2) /
                      value("hourglass stiffness", 0, i);
      return dealii::Utilities::MPI::sum(energy, block.communicator);
    }

    TEST(OnePointHexahedron, hourglass_energy_of_a_cell_that_flows_ends_at_the_limit)
    {
      const double most = hourglass_energy("0.2");
      EXPECT_GT(most, 0.);
      EXPECT_NEAR(hourglass_energy("0.4") / most, 4., 1e-9);
      EXPECT_GT(hourglass_energy("0"), 4. * most);
      // At most l² κ σ²/(6G) V, and the yield stress has not hardened.
      const double shear_modulus = 200. / 2.6;
      EXPECT_NEAR(most, 0.2 * 0.2 * 0.05 * 0.1 * 0.1 / (6. * shear_modulus), 1e-3 * most);
    }
  } // namespace
} // namespace tombolo
