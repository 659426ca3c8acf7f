// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <tombolo/base/exceptions.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/study/waves/reflection_case.h>
#include <tombolo/study/waves/reflection_study.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/numbers.h>

#include <gtest/gtest.h>

#include <iostream>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

using namespace tombolo;
using dealii::numbers::PI;

namespace
{
  ReflectionCase elements(const double ratio, const double wavelength)
  {
    ReflectionCase result;
    result.spacing_ratio = ratio;
    result.wavelength = wavelength;
    return result;
  }

  ReflectionCase into_particles(const std::string &smoothing, const std::string &bridge = "paper")
  {
    ReflectionCase result;
    result.right = SideKind::particles;
    result.smoothing = smoothing;
    result.bridge = bridge;
    return result;
  }

  ReflectionResult run(const ReflectionCase &of_case)
  {
    return ReflectionModel(of_case).run(of_case);
  }

  /** Largest entry of a - b^H, where the blocks of a are weighted by the mass of the target of
   * component and column and those of b alike. */
  template <typename MassA, typename MassB>
  double adjointness_error(const BlochOperator &a, const MassA &mass_of_a, const BlochOperator &b,
                           const MassB &mass_of_b)
  {
    double error = 0;
    for (int row = -30; row <= 30; ++row)
      for (int column = -30; column <= 30; ++column)
        for (unsigned int i = 0; i < 2; ++i)
          for (unsigned int j = 0; j < 2; ++j)
            error = std::max(
                error, std::abs(mass_of_a(row, i) * a.block(row, column)[2 * i + j] -
                                std::conj(mass_of_b(column, j) * b.block(column, row)[2 * j + i])));
    return error;
  }

  struct Discretization
  {
    const char *smoothing;
    const char *bridge;
  };

  class ReducedOperator : public ::testing::TestWithParam<Discretization>
  {};
} // namespace

TEST(Reflection, of_elements_of_unequal_size_is_within_two_percent_of_the_exact_value)
{
  for (const char *const element :
       {"fully integrated hexahedron", "hexahedron", "lagrange hexahedron"})
    for (const double ratio : {2., 3., 0.5, 1. / 3.})
    {
      ReflectionCase of_case = elements(ratio, 10.);
      of_case.element = element;
      of_case.poissons_ratio = 0.3;
      const ReflectionModel model(of_case);
      for (const WaveType wave : {WaveType::P, WaveType::S})
        for (const double wavelength : {10., 20.})
        {
          of_case.wave = wave;
          of_case.wavelength = wavelength;
          const ReflectionResult result = model.run(of_case);
          EXPECT_GT(result.exact, 1e-3);
          EXPECT_NEAR(result.reflection / result.exact, 1., 0.02) << element << ratio << wavelength;
          EXPECT_NEAR(result.unsmoothed, result.reflection, 0.02 * result.reflection);
        }
    }
}

TEST(Reflection, is_the_same_from_both_sides_at_one_frequency)
{
  const ReflectionCase from_coarse = elements(1. / 3., 10.);
  ReflectionCase from_fine = elements(3., 10.);
  // sin(k h/2)/h is the same.
  const double sine = std::sin(PI / 10.) / 3.;
  from_fine.wavelength = 2. * PI / (6. * std::asin(sine));
  const ReflectionResult coarse = run(from_coarse), fine = run(from_fine);
  EXPECT_NEAR(coarse.frequency, fine.frequency, 1e-6);
  EXPECT_NEAR(coarse.reflection, fine.reflection, 1e-3 * coarse.reflection);
}

TEST(Reflection, is_zero_without_an_interface)
{
  ReflectionCase oblique = elements(1., 10.);
  oblique.poissons_ratio = 0.3;
  oblique.angle = PI / 6.;
  EXPECT_LT(run(oblique).unsmoothed, 1e-10);
  ReflectionCase particles = into_particles("affine");
  particles.left = SideKind::particles;
  particles.is_one_part = true;
  particles.angle = PI / 4.;
  particles.filter.power = 4;
  particles.filter.strength = 0.5;
  EXPECT_LT(run(particles).unsmoothed, 1e-10);
}

TEST(Reflection, and_transmission_share_the_energy_of_the_incident_wave)
{
  ReflectionCase of_case = into_particles("paper");
  of_case.poissons_ratio = 0.3;
  of_case.wavelength = 16;
  of_case.angle = PI / 6.;
  const ReflectionModel model(of_case);
  for (const WaveType wave : {WaveType::P, WaveType::S})
  {
    of_case.wave = wave;
    const ReflectionResult result = model.run(of_case);
    EXPECT_GT(result.total, 0.005);
    EXPECT_NEAR(result.total * result.total + result.transmitted_energy, 1., 1e-4);
    EXPECT_LT(result.fit_error, 1e-3);
  }
}

TEST(Reflection, from_particles_is_mostly_of_short_waves_that_the_filter_removes)
{
  ReflectionCase of_case = into_particles("affine");
  std::swap(of_case.left, of_case.right);
  const ReflectionModel model(of_case);
  const ReflectionResult without_filter = model.run(of_case);
  EXPECT_GT(without_filter.unsmoothed, 5. * without_filter.reflection);
  EXPECT_GT(without_filter.unsmoothed, 0.01);
  of_case.filter.power = 4;
  of_case.filter.strength = 0.5;
  EXPECT_LT(model.run(of_case).unsmoothed, 0.002);
}

TEST(Reflection, of_cell_averages_is_as_small_as_of_moving_least_squares)
{
  ReflectionCase of_case = into_particles("affine");
  const double of_least_squares = run(of_case).reflection;
  of_case.shape_functions = "cell averages";
  const double of_averages = run(of_case).reflection;
  std::cout << "reflected: " << of_least_squares << " and " << of_averages << std::endl;
  EXPECT_LT(of_averages, 1.5 * of_least_squares);
}

TEST(Reflection, of_a_wave_that_the_lattice_does_not_carry_is_not_a_number)
{
  // At the largest frequency of the paper's particles energy stands still.
  ReflectionCase of_case = into_particles("paper");
  std::swap(of_case.left, of_case.right);
  of_case.wavelength = 4.2;
  EXPECT_TRUE(std::isnan(run(of_case).reflection));
}

TEST_P(ReducedOperator, is_adjoint_in_the_masses)
{
  ReflectionCase of_case = into_particles(GetParam().smoothing, GetParam().bridge);
  of_case.poissons_ratio = 0.3;
  of_case.spacing_ratio = 0.5;
  const ReflectionModel model(of_case);
  const LinearizedOperators &operators = model.update_operator();
  const ReducedOperators reduced = operators.reduce(0.7);
  const auto mass = [&](const int column, unsigned int) { return operators.mass(column); };
  const auto nodal_mass = [&](const int column, const unsigned int component)
  { return operators.nodal_mass(column, component); };
  EXPECT_LT(adjointness_error(reduced.update, mass, reduced.update, mass), 1e-12);
  EXPECT_LT(adjointness_error(reduced.short_wave_part, mass, reduced.short_wave_part, mass), 1e-13);
  EXPECT_LT(adjointness_error(reduced.smoothing, nodal_mass, reduced.interpolation, mass), 1e-13);
  EXPECT_LT(adjointness_error(reduced.stiffness, nodal_mass, reduced.stiffness, nodal_mass), 1e-12);
  EXPECT_GT(reduced.update.largest_entry(), 0.1);
}

TEST_P(ReducedOperator, leaves_translations_alone)
{
  const ReflectionModel model(into_particles(GetParam().smoothing, GetParam().bridge));
  const ReducedOperators reduced = model.update_operator().reduce(0.);
  for (int row = -20; row <= 20; ++row)
    for (unsigned int i = 0; i < 2; ++i)
    {
      std::complex<double> smoothed = 0., force = 0., short_wave = 0.;
      for (int column = row - 20; column <= row + 20; ++column)
      {
        smoothed += reduced.smoothing.block(row, column)[3 * i];
        force += reduced.update.block(row, column)[3 * i];
        short_wave += reduced.short_wave_part.block(row, column)[3 * i];
      }
      EXPECT_NEAR(std::abs(smoothed - 1.), 0., 1e-12);
      EXPECT_NEAR(std::abs(force), 0., 1e-12);
      EXPECT_NEAR(std::abs(short_wave), 0., 1e-12);
    }
}

INSTANTIATE_TEST_SUITE_P(
    of_all_smoothings, ReducedOperator,
    ::testing::Values(Discretization{"paper", "paper"}, Discretization{"fe matched", "paper"},
                      Discretization{"affine", "paper"}, Discretization{"none", "paper"},
                      Discretization{"fe matched", "trace"}, Discretization{"affine", "trace"}));

TEST(LatticeWaves, have_the_dispersion_of_the_lattice)
{
  const ReflectionModel model(into_particles("paper"));
  const ReducedOperators reduced = model.update_operator().reduce(0.);
  const LatticeWaves of_elements(reduced.update, ChainSide::left, 1., 0., 0.1);
  const LatticeWaves of_particles(reduced.update, ChainSide::right, 1., 0., 0.1);
  const double phi = std::abs(reduced.smoothing.symbol(ChainSide::right, PI)[0] - 1.) / 4.;
  for (const double k : {0.2, 0.5, 1.})
  {
    EXPECT_NEAR(std::sqrt(of_elements.mode(k, WaveType::P).eigenvalue), 2. * std::sin(k / 2.),
                1e-12);
    const double symbol = 1. - 2. * phi * (1. - std::cos(k));
    EXPECT_NEAR(std::sqrt(of_particles.mode(k, WaveType::P).eigenvalue), symbol * std::sin(k),
                1e-12);
  }
  // Under central differences the group velocity is cos(k/2)/cos(ωΔt/2).
  const LatticeMode mode = of_elements.mode(1., WaveType::P);
  EXPECT_NEAR(mode.group_velocity, std::cos(0.5) / std::cos(0.05 * mode.frequency), 1e-8);
  // Every frequency has a physical and a short wave of P and of S type among particles.
  EXPECT_EQ(of_particles.outgoing(0.3, ChainSide::left).size(), 4u);
  EXPECT_EQ(of_elements.outgoing(0.3, ChainSide::left).size(), 2u);
}

namespace
{
  constexpr double wavelength = 12., length = 48., gap = 12., station = -9., end_time = 92.;

  /** The transform at @p frequency of the axial velocity at the station, in the middle of a plate
   * through which the program sends a Hann burst from the left; the edges of the plate are so far
   * away that nothing arrives from them. */
  std::complex<double> transform_in_plate(const std::string &smoothing, const double time_step,
                                          const double frequency)
  {
    const std::string right =
        smoothing.empty()
            ? "fully integrated hexahedron\n"
            : "momentum consistent particle\nsubsection momentum consistent "
              "particle\nset Shape functions = moving least squares\nset Smoothing = " +
                  smoothing + "\nend\n";
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text(
        "set Dimension = 2\nset Parts = a, b\nset Materials = m\n"
        "subsection Mesh\nset Type = box\nsubsection box\nset Lower corner = -96, 0\n"
        "set Upper corner = 44, 160\nset Cells = 140, 160\nend\nend\n"
        "subsection Part: a\nset Cells = x < 0\nset Formulation = fully integrated hexahedron\n"
        "set Material = m\nend\n"
        "subsection Part: b\nset Cells = otherwise\nset Material = m\nset Formulation = " +
            right +
            "end\n"
            "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 1\n"
            "set Young's modulus = 1\nset Poisson's ratio = 0\nend\nend\n",
        "plate.prm");
    Model<2>::declare_parameters(parameters);
    parameters.assign();
    Model<2> model(parameters, MPI_COMM_WORLD);
    const double k = 2. * PI / wavelength;
    constexpr double amplitude = 1e-8;
    unsigned int station_node = dealii::numbers::invalid_unsigned_int;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const x = model.state.initial_position.node(i);
      const double place = (x[0] + gap + length) / length;
      if (place > 0. && place < 1.)
        model.state.unsmoothed_velocity.node(i)[0] =
            amplitude * (0.5 - 0.5 * std::cos(2. * PI * place)) * std::cos(k * x[0]);
      if (std::abs(x[0] - station) < 1e-6 && std::abs(x[1] - 80.) < 1e-6)
        station_node = i;
    }
    model.state.unsmoothed_velocity.update_ghosts();

    MechanicalStep<2> step(model);
    Clock clock;
    clock.next_step = time_step;
    std::complex<double> transform = 0.;
    step.evaluate(clock);
    while (clock.time < end_time)
    {
      step.complete(clock);
      step.advance(clock);
      // What rings at other frequencies is faded out.
      const double rest = std::min(1., (end_time - clock.time) / 18.);
      const double taper = 0.5 - 0.5 * std::cos(PI * rest);
      if (station_node != dealii::numbers::invalid_unsigned_int)
        transform += taper * model.state.unsmoothed_velocity.node(station_node)[0] / amplitude *
                     time_step * std::polar(1., frequency * (clock.time + 0.5 * time_step));
      clock.advance();
      step.evaluate(clock);
    }
    return dealii::Utilities::MPI::sum(transform, MPI_COMM_WORLD);
  }
} // namespace

TEST(Reflection, is_the_same_in_a_plate_that_the_program_runs)
{
  for (const char *const smoothing : {"paper", "affine"})
  {
    ReflectionCase of_case = into_particles(smoothing);
    of_case.wavelength = wavelength;
    const ReflectionResult reduced = run(of_case);
    const auto with = transform_in_plate(smoothing, reduced.time_step, reduced.frequency);
    const auto without = transform_in_plate("", reduced.time_step, reduced.frequency);
    EXPECT_GT(std::abs(without), 5.);
    EXPECT_GT(reduced.reflection, 0.004);
    EXPECT_NEAR(std::abs(with - without) / std::abs(without), reduced.reflection,
                0.01 * reduced.reflection);
  }
}

namespace
{
  std::string message_of(const std::string &group)
  {
    try
    {
      Parameters parameters(MPI_COMM_WORLD);
      parameters.read_text("set Groups = one\nsubsection Group: one\n" + group + "end\n",
                           "study.prm");
      ReflectionStudy::declare_parameters(parameters);
      parameters.assign();
      ReflectionStudy study(parameters, MPI_COMM_WORLD);
      return "no message, " + std::to_string(study.n_cases()) + " cases";
    }
    catch (const InputError &error)
    {
      return error.what();
    }
  }
} // namespace

TEST(ReflectionStudy, makes_the_product_of_the_lists)
{
  EXPECT_EQ(message_of("set Pairs = FE-FE, FE-particles\nset Spacing ratios = 1/3, 2\n"
                       "set Waves = P, S\nset Angles = 0, 30, 60\n"),
            "no message, 24 cases");
}

TEST(ReflectionStudy, refuses_what_is_wrong_with_its_entry_and_what_is_allowed)
{
  const auto expect = [](const std::string &group, const std::vector<std::string> &parts)
  {
    const std::string message = message_of(group);
    for (const std::string &part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << "\nis not in: " << message;
  };
  expect("set Pairs = FE-FE\nset Wavelength = 10\n", {"study.prm:4", "Wavelengths"});
  expect("set Waves = P\n", {"Pairs"});
  expect("set Pairs = FE-FE\nset Wavelengths = 10, 2\n",
         {"study.prm:4", "2 is outside", "4 to 1000"});
  expect("set Pairs = FE-FE\nset Angles = 90\n", {"study.prm:4", "0 to 80"});
  expect("set Pairs = FE-FE\nset Spacing ratios = 1/x\n", {"study.prm:4", "\"x\" is not a number"});
  expect("set Pairs = FE-FE\nset Reference = 1, 2\n", {"2 values for the 1 cases"});
  expect("set Pairs = FE-FE\nset Filter powers = 1.5\n", {"whole number"});
}
