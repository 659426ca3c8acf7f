// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <gtest/gtest.h>

#include "model_scene.h"
#include "nodal_fields.h"

#include <tombolo/base/exceptions.h>
#include <tombolo/physics/failure/erosion.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/loads.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

/** Cells that are removed while a run goes on. */
namespace tombolo
{
  namespace
  {
    struct ErosionCase
    {
      std::string formulation = "hexahedron";
      std::string options = "";
      std::string material = "j2 plasticity";
      bool has_heat = false;
      bool has_particles = false; ///< those at x > 2
      std::string conditions = "";
      unsigned int n = 4; ///< cells along each axis, of size 1, with disorder
      double strain = 0.3;
      std::string more = ""; ///< further sections
    };

    std::string text_of(const ErosionCase &words)
    {
      const std::string n = std::to_string(words.n);
      std::ostringstream text;
      std::string names;
      std::istringstream lines(words.conditions);
      for (std::string line; std::getline(lines, line);)
        if (line.rfind("subsection Condition: ", 0) == 0)
          names += (names.empty() ? "" : ", ") + line.substr(22);
      text << "set Dimension = 3\nset Materials = m\nset Conditions = " << names
           << "\nset Parts = a" << (words.has_particles ? ", b" : "") << "\n"
           << words.conditions
           << "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = " << n << ", "
           << n << ", " << n << "\nset Cells = " << n << ", " << n << ", " << n
           << "\nset Disorder = 0.15\nset Surface nodes = slide\nend\nend\n"
           << "subsection Part: a\nset Cells = " << (words.has_particles ? "x < 2" : "all")
           << "\nset Formulation = " << words.formulation << "\nset Material = m\nsubsection "
           << words.formulation << "\n"
           << words.options;
      if (words.strain != 0.)
        text << "\nset Erosion strain = " << words.strain;
      text << "\nend\nend\n";
      if (words.has_particles)
        text << "subsection Part: b\nset Cells = otherwise\nset Formulation = momentum consistent "
                "particle\nset Material = m\nend\n";
      text << "subsection Material: m\nset Model = " << words.material << "\nsubsection "
           << words.material
           << "\nset Density = 2\nset Young's modulus = 100\nset Poisson's ratio = 0.3\n";
      if (words.material == "j2 plasticity")
        text << "set Taylor-Quinney coefficient = " << (words.has_heat ? "0.9" : "0")
             << "\nset Flow stress = linear hardening\nsubsection linear hardening\nset Yield "
                "stress = 1\nend\n";
      text << "end\n";
      if (words.has_heat)
        text << "subsection Heat\nset Specific heat capacity = 0: 2, 10: 3, 20: 8\nset "
                "Conductivity = 0.3\nset Initial temperature = 5\nend\n";
      text << "end\n" << words.more;
      return text.str();
    }

    /** A scene between two steps, and the cells that have been strained too much. */
    class ErodingBody : public testing::ModelScene<3>
    {
    public:
      explicit ErodingBody(const ErosionCase &words) : ModelScene(text_of(words))
      {
        set(model->state.unsmoothed_velocity, [](const double *x)
            { return dealii::Point<3>(1. + 0.3 * x[1], 0.2 * x[0] - 0.1 * x[2], std::sin(x[0])); });
      }

      Formulation<3> &part()
      {
        return *model->parts[0].formulation;
      }

      double *values(const std::string &field, const unsigned int component = 0)
      {
        MaterialPoints &points = part().points();
        return points.component(points.find_field(field), component);
      }

      /** Points are visited cell by cell, with their number and the middle of their cell. */
      void for_points(const std::function<void(unsigned int, const dealii::Point<3> &)> &action)
      {
        const unsigned int n_points = part().n_points_per_cell();
        for (unsigned int cell = 0; cell < part().n_cells(); ++cell)
        {
          dealii::Point<3> middle;
          for (unsigned int q = 0; q < n_points; ++q)
            middle += part().initial_point_positions()[part().point_of_cell(cell, q)] / n_points;
          for (unsigned int q = 0; q < n_points; ++q)
            action(part().point_of_cell(cell, q), middle);
        }
      }

      void set(NodalVector &vector, const std::function<dealii::Point<3>(const double *)> &value)
      {
        vector.fill(
            [&](const unsigned int i, double *const components)
            {
              const dealii::Point<3> point = value(model->state.initial_position.node(i));
              std::copy_n(&point[0], 3, components);
            });
      }

      /** A stress that is smooth and different everywhere. */
      void stress(const bool also_where_strained = true)
      {
        for_points(
            [&](const unsigned int i, const dealii::Point<3> &x)
            {
              const bool counts = also_where_strained || !is_strained(x);
              for (unsigned int c = 0; c < 6; ++c)
                values("stress", c)[i] = counts ? 0.1 * std::sin(c + x[0] + 2. * x[1] - x[2]) : 0.;
            });
      }

      /** The cells of two layers. */
      static bool is_strained(const dealii::Point<3> &x)
      {
        return (x[0] > 1. && x[0] < 2.) || (x[1] < 1. && x[0] < 1.);
      }

      void strain()
      {
        for_points([&](const unsigned int i, const dealii::Point<3> &x)
                   { values("effective plastic strain")[i] = is_strained(x) ? 0.31 : 0.1; });
      }

      tombolo::Erosion<3> &erosion()
      {
        return *model->find_process<tombolo::Erosion<3>>();
      }

      ErosionLoss erode(const double previous_step = 0.)
      {
        Clock clock;
        clock.previous_step = previous_step;
        const ErosionLoss before = erosion().loss();
        has_changed = erosion().erode(*model, clock);
        ErosionLoss loss = erosion().loss();
        loss.n_cells -= before.n_cells;
        loss.mass -= before.mass;
        loss.energy -= before.energy;
        for (unsigned int d = 0; d < 3; ++d)
        {
          loss.momentum[d] -= before.momentum[d];
          loss.angular_momentum[d] -= before.angular_momentum[d];
        }
        for (double *value : {&loss.n_cells, &loss.mass, &loss.energy})
          *value = sum(*value);
        for (unsigned int d = 0; d < 3; ++d)
        {
          loss.momentum[d] = sum(loss.momentum[d]);
          loss.angular_momentum[d] = sum(loss.angular_momentum[d]);
        }
        return loss;
      }

      static double sum(const double value)
      {
        return dealii::Utilities::MPI::sum(value, MPI_COMM_WORLD);
      }

      double volume_of_strained()
      {
        double volume = 0;
        for_points([&](const unsigned int i, const dealii::Point<3> &x)
                   { volume += is_strained(x) ? values("volume")[i] : 0.; });
        return sum(volume);
      }

      /** Mass, momentum, angular momentum and kinetic energy of the nodes. */
      std::vector<double> motion()
      {
        std::vector<double> result(8, 0.);
        const NodalState &state = model->state;
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        {
          const double mass = *state.mass.node(i);
          const double *const x = state.position.node(i);
          const double *const v = state.unsmoothed_velocity.node(i);
          result[0] += mass;
          for (unsigned int d = 0; d < 3; ++d)
          {
            const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
            result[1 + d] += mass * v[d];
            result[4 + d] += mass * (x[e] * v[f] - x[f] * v[e]);
            result[7] += 0.5 * mass * v[d] * v[d];
          }
        }
        for (double &value : result)
          value = sum(value);
        return result;
      }

      NodalVector force()
      {
        NodalVector result(model->state.partition());
        NodalVector velocity(model->state.partition());
        const NodalVector *temperature =
            model->heat ? &model->heat->state.present_temperature : nullptr;
        part().add_internal_force({&model->state.position, &velocity, 0., temperature}, result);
        result.add_to_owners();
        return result;
      }

      bool has_changed = false;
    };

    const std::vector<ErosionCase> all_elements = {
        {"hexahedron"},
        {"hexahedron", "set Linear bulk viscosity = 0.06"},
        {"fully integrated hexahedron"},
        {"lagrange hexahedron", "set Degree = 2"}};

    TEST(Erosion, mass_momentum_and_energy_are_either_left_or_lost)
    {
      for (ErosionCase words : all_elements)
        for (const bool has_particles : {false, true})
        {
          if (has_particles && words.formulation == "lagrange hexahedron")
            continue;
          words.has_particles = has_particles;
          SCOPED_TRACE(words.formulation + words.options + (has_particles ? " particles" : ""));
          ErodingBody body(words);
          body.stress();
          body.strain();
          for (unsigned int i = 0; i < body.part().points().size(); ++i)
            body.values("plastic work")[i] = 0.2;
          const double volume = body.volume_of_strained();
          const std::vector<double> before = body.motion();
          const EnergyAccounts energies_before = body.part().energies();
          const ErosionLoss loss = body.erode();
          const std::vector<double> after = body.motion();
          const EnergyAccounts energies_after = body.part().energies();

          EXPECT_TRUE(body.has_changed);
          EXPECT_EQ(loss.n_cells, 20.);
          EXPECT_EQ(body.erosion().n_removed_cells(), 20u);
          EXPECT_NEAR(loss.mass, 2. * volume, 1e-12 * before[0]);
          EXPECT_NEAR(after[0] + loss.mass, before[0], 1e-13 * before[0]);
          for (unsigned int d = 0; d < 3; ++d)
          {
            EXPECT_GT(std::abs(loss.momentum[d]), 0.1);
            EXPECT_NEAR(after[1 + d] + loss.momentum[d], before[1 + d], 1e-12 * before[0]);
            EXPECT_NEAR(after[4 + d] + loss.angular_momentum[d], before[4 + d], 1e-12 * before[0]);
          }
          const auto stored = [](const EnergyAccounts &energies)
          { return ErodingBody::sum(energies["elastic energy"] + energies["hourglass energy"]); };
          EXPECT_GT(stored(energies_before) - stored(energies_after), 1e-4);
          EXPECT_NEAR(after[7] + stored(energies_after) + loss.energy,
                      before[7] + stored(energies_before), 1e-13 * before[7]);
          EXPECT_NEAR(ErodingBody::sum(energies_after["plastic dissipation"]),
                      ErodingBody::sum(energies_before["plastic dissipation"]), 1e-13 * before[0]);

          body.erode();
          EXPECT_FALSE(body.has_changed);
        }
    }

    TEST(Erosion, under_scaled_mass_what_moves_is_lost_with_its_inertia)
    {
      for (ErosionCase words : all_elements)
      {
        SCOPED_TRACE(words.formulation + words.options);
        words.more = "subsection Scaling\nset Mass factor = 3\nset Target time step = 0.5\nend\n";
        ErodingBody body(words);
        body.strain();
        const double volume = body.volume_of_strained();
        const std::vector<double> before = body.motion();
        const ErosionLoss loss = body.erode();
        const std::vector<double> after = body.motion();
        EXPECT_GT(before[0] - after[0], 3.1 * 2. * volume);
        EXPECT_NEAR(loss.mass, 2. * volume, 1e-12 * before[0]);
        for (unsigned int d = 0; d < 3; ++d)
          EXPECT_NEAR(after[1 + d] + loss.momentum[d], before[1 + d], 1e-12 * before[0]);
        EXPECT_NEAR(after[7] + loss.energy, before[7], 1e-13 * before[7]);
      }
    }

    TEST(Erosion, every_rank_knows_that_nodes_without_mass_stand_still)
    {
      for (const ErosionCase &words : all_elements)
      {
        SCOPED_TRACE(words.formulation + words.options);
        ErodingBody body(words);
        body.strain();
        const NodalVector &v = body.model->state.unsmoothed_velocity;
        body.erode();
        NodalVector current, mass;
        current = v.copy();
        current.update_ghosts();
        mass = body.model->state.mass.copy();
        mass.update_ghosts();
        unsigned int n_massless_ghosts = 0;
        for (unsigned int i = 0; i < v.partition()->n_local(); ++i)
        {
          n_massless_ghosts += i >= v.partition()->n_owned() && *mass.node(i) == 0. ? 1 : 0;
          for (unsigned int d = 0; d < 3; ++d)
            EXPECT_EQ(v.node(i)[d], current.node(i)[d]);
        }
        if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
        {
          EXPECT_GT(dealii::Utilities::MPI::sum(n_massless_ghosts, MPI_COMM_WORLD), 0u);
        }
      }
    }

    TEST(Erosion, the_forces_left_are_those_of_the_cells_left)
    {
      for (const ErosionCase &words : all_elements)
      {
        SCOPED_TRACE(words.formulation + words.options);
        ErodingBody eroded(words), soft(words);
        eroded.stress();
        eroded.strain();
        eroded.erode();
        soft.stress(false);
        const NodalVector force = eroded.force(), expected = soft.force();
        double largest = 0;
        unsigned int n_massless = 0;
        for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
        {
          for (unsigned int d = 0; d < 3; ++d)
          {
            largest = std::max(largest, std::abs(expected.node(i)[d]));
            ASSERT_NEAR(force.node(i)[d], expected.node(i)[d], 1e-14);
          }
          if (*eroded.model->state.mass.node(i) == 0.)
          {
            ++n_massless;
            for (unsigned int d = 0; d < 3; ++d)
            {
              EXPECT_EQ(force.node(i)[d], 0.);
              EXPECT_EQ(eroded.model->state.unsmoothed_velocity.node(i)[d], 0.);
            }
          }
        }
        EXPECT_GT(dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD), 1e-3);
        EXPECT_GE(dealii::Utilities::MPI::sum(n_massless, MPI_COMM_WORLD), 10u);

        // The points of cells that are left are where they were.
        eroded.for_points(
            [&](const unsigned int i, const dealii::Point<3> &x)
            {
              ASSERT_EQ(eroded.values("effective plastic strain")[i],
                        ErodingBody::is_strained(x) ? 0.31 : 0.1);
              ASSERT_EQ(eroded.values("volume")[i] == 0., ErodingBody::is_strained(x));
            });
      }
    }

    TEST(Erosion, no_operator_makes_anything_of_a_node_without_mass)
    {
      for (const bool has_particles : {false, true})
      {
        ErosionCase words;
        words.has_particles = has_particles;
        words.conditions = "subsection Condition: hold\nset Type = velocity\nset Where = y < "
                           "1e-9\nset Function = 1; free; 2\nend\n";
        ErodingBody body(words);
        body.strain();
        body.erode();
        MechanicalStep<3> step(*body.model);
        NodalState &state = body.model->state;
        NodalVector before = state.position.copy();
        Clock clock;
        clock.next_step = clock.stable_step = 1e-3;
        for (unsigned int n = 0; n < 3; ++n)
        {
          step.evaluate(clock);
          step.complete(clock);
          step.check_now();
          step.advance(clock);
          clock.advance();
        }
        double moved = 0;
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          for (unsigned int d = 0; d < 3; ++d)
          {
            ASSERT_TRUE(std::isfinite(state.position.node(i)[d]));
            const double way = std::abs(state.position.node(i)[d] - before.node(i)[d]);
            if (*state.mass.node(i) == 0.)
            {
              ASSERT_EQ(way, 0.);
            }
            moved = std::max(moved, way);
          }
        EXPECT_GT(dealii::Utilities::MPI::max(moved, MPI_COMM_WORLD), 1e-3);
        SpectralEstimator<3> estimator(body.parameters.section("Time step").subsection("spectral"));
        const double limit = estimator.estimate(*body.model).time_step;
        EXPECT_GT(limit, 0.01);
        EXPECT_LT(limit, 1.);
      }
    }

    TEST(Erosion, a_cell_inside_out_is_removed_where_the_run_would_end)
    {
      for (const double strain : {0., 0.3})
        for (ErosionCase words : all_elements)
        {
          SCOPED_TRACE(words.formulation + words.options);
          words.strain = strain;
          ErodingBody body(words);
          // The corner at the origin is pushed through its cell, whose points recorded the loss.
          body.set(body.model->state.position,
                   [](const double *x)
                   {
                     const bool is_corner = x[0] < 0.8 && x[1] < 0.8 && x[2] < 0.8;
                     return is_corner ? dealii::Point<3>(6. - x[0], 6. - x[1], 6. - x[2])
                                      : dealii::Point<3>(x[0], x[1], x[2]);
                   });
          body.for_points([&](const unsigned int i, const dealii::Point<3> &x)
                          { body.values("volume ratio")[i] = x.norm() < 2. ? 0.4 : 1.; });
          if (strain > 0.)
          {
            EXPECT_EQ(body.erode().n_cells, 1.);
          }
          body.force();
          const int has_failed = body.part().failure().empty() ? 0 : 1;
          EXPECT_EQ(dealii::Utilities::MPI::max(has_failed, MPI_COMM_WORLD), strain > 0. ? 0 : 1);
        }
    }

    TEST(Erosion, small_cells_limit_the_step_until_they_are_removed)
    {
      ErodingBody body{ErosionCase()};
      const double before = courant_limit(*body.model).time_step;
      // The strained layer is squeezed to a tenth.
      body.set(body.model->state.position, [](const double *x)
               { return dealii::Point<3>(x[0] > 1.5 ? x[0] - 0.9 : x[0], x[1], x[2]); });
      body.strain();
      const double squeezed = courant_limit(*body.model).time_step;
      EXPECT_LT(squeezed, 0.5 * before);
      body.erode();
      EXPECT_GT(courant_limit(*body.model).time_step, 0.9 * before);
    }

    TEST(Erosion, the_stable_step_of_a_fragment_is_found_from_that_of_the_whole)
    {
      for (const ErosionCase &words : all_elements)
      {
        SCOPED_TRACE(words.formulation + words.options);
        ErodingBody body(words);
        const Section section = body.parameters.section("Time step").subsection("spectral");
        SpectralEstimator<3> estimator(section), fresh(section);
        estimator.estimate(*body.model);
        // One cell is left alone in a corner, and half of the block.
        body.for_points(
            [&](const unsigned int i, const dealii::Point<3> &x)
            {
              const bool is_left = x[0] > 2. || (x[0] < 1. && x[1] < 1. && x[2] < 1.);
              body.values("effective plastic strain")[i] = is_left ? 0. : 1.;
            });
        EXPECT_EQ(body.erode().n_cells, 31.);
        const double limit = fresh.estimate(*body.model).time_step;
        EXPECT_NEAR(estimator.estimate(*body.model).time_step, limit, 0.01 * limit);
      }
    }

    TEST(Erosion, a_body_of_which_nothing_is_left_does_nothing)
    {
      ErodingBody body{ErosionCase()};
      body.for_points([&](const unsigned int i, const dealii::Point<3> &)
                      { body.values("effective plastic strain")[i] = 0.3; });
      const std::vector<double> before = body.motion();
      const ErosionLoss loss = body.erode();
      EXPECT_EQ(loss.n_cells, 64.);
      EXPECT_NEAR(loss.mass, before[0], 1e-12);
      EXPECT_EQ(body.motion()[0], 0.);
      const NodalVector force = body.force();
      for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
        EXPECT_EQ(force.node(i)[0], 0.);
      SpectralEstimator<3> estimator(body.parameters.section("Time step").subsection("spectral"));
      EXPECT_GT(estimator.estimate(*body.model).time_step, 1e100);
    }

    TEST(Erosion, the_work_of_half_a_step_is_lost_with_a_cell)
    {
      // A free cell that has moved with its velocity: in half a step its internal force does the
      // work ½ Δt Σ σ : D V.
      for (const ErosionCase &words : all_elements)
      {
        SCOPED_TRACE(words.formulation + words.options);
        ErodingBody body(words);
        body.set(body.model->state.unsmoothed_velocity,
                 [](const double *x) { return dealii::Point<3>(0.1 * x[0], 0., 0.05 * x[1]); });
        body.for_points(
            [&](const unsigned int i, const dealii::Point<3> &)
            {
              body.values("stress", 0)[i] = 0.2;
              body.values("stress", 3)[i] = 0.1;
            });
        body.strain();
        const double volume = body.volume_of_strained();
        const double dt = 0.01;
        const NodalVector &v = body.model->state.unsmoothed_velocity;
        body.set(body.model->state.position,
                 [&](const double *x) {
                   return dealii::Point<3>(x[0] * (1. + 0.1 * dt), x[1], x[2] + 0.05 * dt * x[1]);
                 });
        const std::vector<double> before = body.motion();
        const double stored = ErodingBody::sum(body.part().energies()["elastic energy"]);
        ASSERT_EQ(v.partition(), body.model->state.partition());
        const ErosionLoss loss = body.erode(dt);
        const double work = 0.5 * dt * volume * (0.2 * 0.1 + 0.1 * 0.05);
        EXPECT_NEAR(loss.energy - (before[7] - body.motion()[7]) -
                        (stored - ErodingBody::sum(body.part().energies()["elastic energy"])),
                    work, 1e-12 * before[7]);
        EXPECT_GT(work, 1e-6 * before[7]);
      }
    }

    TEST(Erosion, grips_and_loads_on_removed_cells_have_done_the_work_of_half_a_step)
    {
      // All nodes have one prescribed velocity, so that stresses stay what they are and the balance
      // has no error of the step.
      for (ErosionCase words : all_elements)
        for (const bool has_particles : {false, true})
        {
          if (has_particles && words.formulation == "lagrange hexahedron")
            continue;
          words.has_particles = has_particles;
          SCOPED_TRACE(words.formulation + words.options + (has_particles ? " particles" : ""));
          words.conditions = "subsection Condition: lead\nset Type = velocity\nset Where = x > "
                             "-1\nset Function = 1; 0.5; -2\nend\n"
                             "subsection Condition: pull\nset Type = traction\nset Boundary = y "
                             "min\nset Function = 0.3; 0.7*cos(20*t); 0.2\nend\n";
          words.more = "subsection Damping\nset Rate = 0.4\nend\n";
          ErodingBody body(words);
          body.set(body.model->state.unsmoothed_velocity,
                   [](const double *) { return dealii::Point<3>(1., 0.5, -2.); });
          body.stress();
          EnergyLedger ledger;
          MechanicalStep<3> step(*body.model);
          Clock clock;
          EnergyBalance balance;
          for (unsigned int n = 0; n < 8; ++n)
          {
            clock.next_step = n % 2 == 0 ? 0.01 : 0.02;
            clock.stable_step = 0.02;
            if (n == 3)
              body.strain();
            step.evaluate(clock);
            step.complete(clock);
            step.check_now();
            balance = ledger.balance(*body.model, clock);
            EXPECT_NEAR(balance.error, 0., 1e-13);
            EXPECT_LT(balance.momentum_drift, 1e-13);
            step.advance(clock);
            clock.advance();
          }
          EXPECT_EQ(ErodingBody::sum(body.erosion().loss().n_cells), 20.);
        }
    }

    TEST(Erosion, tractions_act_on_what_is_left_of_a_surface)
    {
      ErosionCase words;
      words.conditions = "subsection Condition: push\nset Type = traction\nset Boundary = y "
                         "min\nset Function = 0; 2; 0\nend\n";
      ErodingBody body(words);
      auto &loads = *body.model->find_process<Loads<3>>();
      const auto total = [&]()
      {
        Model<3> &model = *body.model;
        loads.act(model, Clock(), model.state.force);
        double force = 0;
        for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
          force += loads.action().nodal_force(i)[1];
        return ErodingBody::sum(force);
      };
      body.strain();
      EXPECT_NEAR(total(), 2. * 16., 1e-12);
      body.erode();
      const double area = total() / 2.; // of the faces with x > 2, whose edge there is disordered
      EXPECT_GT(area, 7.);
      EXPECT_LT(area, 9.);
      const NodalVector &mass = body.model->state.mass;
      for (unsigned int i = 0; i < mass.partition()->n_owned(); ++i)
        if (*mass.node(i) == 0.)
        {
          EXPECT_EQ(loads.action().nodal_force(i)[1], 0.);
        }
    }

    TEST(Erosion, heat_is_either_left_or_lost)
    {
      for (const bool has_particles : {false, true})
      {
        ErosionCase words;
        words.has_heat = true;
        words.has_particles = has_particles;
        words.formulation = "fully integrated hexahedron";
        ErodingBody body(words);
        ThermalModel<3> &heat = *body.model->heat;
        const unsigned int n_owned = body.model->state.partition()->n_owned();
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          const double *const x = body.model->state.initial_position.node(i);
          for (const bool next : {false, true})
          {
            ThermalState &state = heat.state;
            const double temperature = 5. + 2. * x[0] + x[1] + (next ? 3. : 0.);
            *(next ? state.next_unsmoothed_temperature : state.unsmoothed_temperature).node(i) =
                temperature;
            *(next ? state.next_enthalpy : state.enthalpy).node(i) =
                heat.nodal_enthalpy.enthalpy(i, temperature);
          }
        }
        body.for_points([&](const unsigned int i, const dealii::Point<3> &)
                        { body.values("plastic work")[i] = 0.2; });
        body.strain();
        const auto content = [](const NodalVector &enthalpy)
        { return testing::sum_of_nodes(enthalpy); };
        const double now = content(heat.state.enthalpy), next = content(heat.state.next_enthalpy);
        const double pending = ErodingBody::sum(body.part().pending_plastic_heat());
        body.erode();
        const double lost = ErodingBody::sum(heat.eroded_heat);
        const double lost_at_end = lost + ErodingBody::sum(heat.eroding_heat);
        const double left = ErodingBody::sum(body.part().pending_plastic_heat());
        EXPECT_LT(left, 0.8 * pending);
        EXPECT_GT(now - content(heat.state.enthalpy), 0.1 * now);
        EXPECT_NEAR(content(heat.state.enthalpy) + left + lost, now + pending, 1e-12 * now);
        EXPECT_NEAR(content(heat.state.next_enthalpy) + left + lost_at_end, next + pending,
                    1e-12 * next);
        // The temperatures of nodes with mass stay.
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          const double temperature =
              heat.nodal_enthalpy.temperature(i, *heat.state.enthalpy.node(i));
          ASSERT_TRUE(std::isfinite(temperature));
          if (*body.model->state.mass.node(i) > 0.)
            ASSERT_NEAR(temperature, *heat.state.unsmoothed_temperature.node(i),
                        1e-12 * temperature);
          else
            ASSERT_EQ(*heat.state.enthalpy.node(i), 0.);
        }
        // No heat flows to nodes without mass.
        NodalVector rate(body.model->state.partition(), Quantity::scalar);
        std::vector<double> heats;
        heat.find_field(heat.state.unsmoothed_temperature, heat.state.temperature);
        heat.heat_rate(body.model->state.position, heat.state.temperature, 0., rate, heats);
        for (unsigned int i = 0; i < n_owned; ++i)
          EXPECT_TRUE(*body.model->state.mass.node(i) != 0. || *rate.node(i) == 0.);
        EXPECT_GT(testing::largest_magnitude(rate), 1e-2);
        EXPECT_NEAR(testing::sum_of_nodes(rate), 0., 1e-10);
      }
    }

    TEST(Erosion, pending_heat_of_cells_that_are_left_reaches_the_nodes)
    {
      ErosionCase words;
      words.has_heat = true;
      ErodingBody body(words);
      body.for_points([&](const unsigned int i, const dealii::Point<3> &x)
                      { body.values("plastic work")[i] = 0.2 + 0.1 * x[0]; });
      body.strain();
      body.erode();
      NodalVector given(body.model->state.partition(), Quantity::scalar);
      const double pending = ErodingBody::sum(body.part().pending_plastic_heat());
      EXPECT_GT(pending, 1.);
      body.model->heat->add_plastic_heat(given);
      EXPECT_NEAR(testing::sum_of_nodes(given), pending, 1e-12 * pending);
      EXPECT_NEAR(body.part().pending_plastic_heat(), 0., 1e-14 * pending);
    }

    TEST(Erosion, is_off_without_a_strain_and_refused_where_there_is_none)
    {
      ErosionCase words;
      words.strain = 0.;
      EXPECT_EQ(ErodingBody(words).model->find_process<tombolo::Erosion<3>>(), nullptr);
      words.strain = 0.3;
      EXPECT_NE(ErodingBody(words).model->find_process<tombolo::Erosion<3>>(), nullptr);
      words.material = "elastic";
      EXPECT_THROW(ErodingBody{words}, InputError);
      words.material = "j2 plasticity";
      words.strain = -0.1;
      EXPECT_THROW(ErodingBody{words}, InputError);
    }
  } // namespace
} // namespace tombolo
