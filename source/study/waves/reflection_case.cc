// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/reflection_case.h>

#include <tombolo/physics/mechanics/step_size.h>

#include <deal.II/base/numbers.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using dealii::numbers::PI;

  namespace
  {
    // Slower waves than this fraction of the speed of P waves are not waited for.
    constexpr double slowest = 0.1;
    constexpr double fastest = 1.1;

    /** Columns begin ... end-1 where waves are measured. */
    struct Window
    {
      int begin, end;

      double weight(const int column) const
      {
        return 0.5 - 0.5 * std::cos(2. * PI * (column - begin + 0.5) / (end - begin));
      }
    };

    /** Three waves with the wave numbers k and k ± 2π/length, whose sum is one branch's wave of
     * number k under a Hann envelope. */
    struct Burst
    {
      std::array<LatticeMode, 3> modes;
      std::array<double, 3> weights = {{0.5, -0.25, -0.25}};
      double begin, length;

      Burst(const LatticeWaves &waves, const LatticeMode &carrier, const double begin,
            const double length)
          : modes{{carrier, waves.continued(carrier, carrier.wave_number + 2. * PI / length),
                   waves.continued(carrier, carrier.wave_number - 2. * PI / length)}},
            begin(begin), length(length)
      {}

      /** Sets e at t = 0 and v̂ at t = -Δt/2 of a lattice with columns @p spacing apart. */
      void set(const double spacing, const double time_step, ChainField &displacement,
               ChainField &velocity) const
      {
        const int first = static_cast<int>(std::ceil(begin / spacing));
        const int last = static_cast<int>(std::floor((begin + length) / spacing));
        for (int column = first; column <= last; ++column)
          for (unsigned int c = 0; c < 2; ++c)
          {
            std::complex<double> e = 0., v = 0.;
            for (unsigned int m = 0; m < 3; ++m)
            {
              const std::complex<double> term =
                  weights[m] * modes[m].polarization[c] *
                  std::polar(1., modes[m].wave_number * (column * spacing - begin));
              e += term;
              v += term * (1. - std::polar(1., modes[m].frequency * time_step)) / time_step;
            }
            displacement.set(column, c, e);
            velocity.set(column, c, v);
          }
      }
    };

    /** The run of one chain: the transform of v̂ at a frequency, and v̂ at the end. */
    struct Record
    {
      ChainField spectrum, last_velocity;
    };

    Record run_chain(BlochMotion &motion, const Burst &burst, const double spacing,
                     const double frequency, const double time_step, const unsigned int n_steps)
    {
      ChainField displacement = motion.make_field(), velocity = motion.make_field(),
                 spectrum = motion.make_field();
      burst.set(spacing, time_step, displacement, velocity);
      for (unsigned int step = 0; step < n_steps; ++step)
      {
        motion.advance(displacement, velocity);
        spectrum.add(std::polar(1., frequency * (step + 0.5) * time_step), velocity);
      }
      return {std::move(spectrum), std::move(velocity)};
    }

    /** Root of the weighted mean square of a field in a window. */
    double amplitude(const ChainField &field, const Window &window)
    {
      double sum = 0, weights = 0;
      for (int column = window.begin; column < window.end; ++column)
      {
        const double weight = window.weight(column);
        weights += weight;
        sum += weight * (std::norm(field.get(column, 0)) + std::norm(field.get(column, 1)));
      }
      return std::sqrt(sum / weights);
    }

    /** The amplitudes at x = 0 of @p modes that together come nearest to a field in a window. */
    struct Fit
    {
      std::vector<double> amplitudes;
      double error = 0; ///< root mean square of what is left
    };

    using Vector = std::vector<std::complex<double>>;

    std::complex<double> product(const Vector &a, const Vector &b)
    {
      std::complex<double> sum = 0.;
      for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::conj(a[i]) * b[i];
      return sum;
    }

    /** a += factor b */
    void add(Vector &a, const std::complex<double> factor, const Vector &b)
    {
      for (std::size_t i = 0; i < a.size(); ++i)
        a[i] += factor * b[i];
    }

    Fit fit(const ChainField &field, const Window &window, const std::vector<LatticeMode> &modes,
            const double spacing)
    {
      Vector rest;
      std::vector<Vector> basis(modes.size());
      double weights = 0;
      for (int column = window.begin; column < window.end; ++column)
      {
        const double weight = window.weight(column);
        weights += weight;
        for (unsigned int c = 0; c < 2; ++c)
        {
          rest.push_back(std::sqrt(weight) * field.get(column, c));
          for (std::size_t m = 0; m < modes.size(); ++m)
            basis[m].push_back(std::sqrt(weight) * modes[m].polarization[c] *
                               std::polar(1., modes[m].wave_number * spacing * column));
        }
      }

      // Least squares by orthogonalization, twice for the sake of round-off: basis = q r
      const std::size_t n = modes.size();
      std::vector<Vector> r(n, Vector(n, 0.));
      Vector projection(n, 0.);
      for (std::size_t m = 0; m < n; ++m)
      {
        for (unsigned int pass = 0; pass < 2; ++pass)
          for (std::size_t k = 0; k < m; ++k)
          {
            const std::complex<double> overlap = product(basis[k], basis[m]);
            r[k][m] += overlap;
            add(basis[m], -overlap, basis[k]);
          }
        const double length = std::sqrt(product(basis[m], basis[m]).real());
        r[m][m] = length;
        for (auto &entry : basis[m])
          entry /= length;
        projection[m] = product(basis[m], rest);
        add(rest, -projection[m], basis[m]);
      }
      Fit result;
      result.error = std::sqrt(product(rest, rest).real() / weights);
      result.amplitudes.resize(n);
      for (std::size_t m = n; m-- > 0;)
      {
        for (std::size_t k = m + 1; k < n; ++k)
          projection[m] -= r[m][k] * projection[k];
        projection[m] /= r[m][m];
        result.amplitudes[m] = std::abs(projection[m]);
      }
      return result;
    }

    /** Energy flux of the waves of a fit: density and energy per length are alike on both sides. */
    double energy_flux(const Fit &fit, const std::vector<LatticeMode> &modes)
    {
      double flux = 0;
      for (std::size_t m = 0; m < modes.size(); ++m)
        flux += fit.amplitudes[m] * fit.amplitudes[m] * std::abs(modes[m].group_velocity);
      return flux;
    }

    double slowest_of(const std::vector<LatticeMode> &modes)
    {
      double velocity = 1.;
      for (const LatticeMode &mode : modes)
        velocity = std::min(velocity, std::abs(mode.group_velocity));
      return std::max(velocity, slowest);
    }

    ChainField zero_like(const ChainField &field)
    {
      ChainField result = field;
      result.set_zero();
      return result;
    }

    ChainField smoothed(const BlochOperator &smoothing, const ChainField &field)
    {
      ChainField result = zero_like(field);
      ChainSweep(smoothing, field.first(), field.last()).add(1., field, result);
      return result;
    }

    Window window_of(const double near, const double width, const double spacing)
    {
      const int begin = static_cast<int>(std::ceil(near / spacing));
      return {begin, begin + static_cast<int>(std::ceil(width / spacing))};
    }

    /** The waves of one frequency and one wave number along the interface. */
    struct PartialWaves
    {
      LatticeMode carrier; ///< of the burst
      std::vector<LatticeMode> reflected, transmitted;
      std::vector<LatticeMode> incident; ///< all that travel on the left side to the right
    };

    /** Where the burst starts and waves are measured, and the columns and steps that this takes. */
    struct Layout
    {
      Window incident, reflected, transmitted;
      double burst_begin, burst_length;
      unsigned int n_steps;
      int first, last;  ///< columns with the interface
      int last_without; ///< likewise without it

      Layout(const ReflectionCase &of_case, const PartialWaves &waves, double time_step);
    };

    Layout::Layout(const ReflectionCase &of_case, const PartialWaves &waves, const double time_step)
    {
      const double spacing = of_case.left_spacing();
      const double right_spacing = of_case.right_spacing();

      // Places. The incident wave is measured in the mirror image of the window of the reflected
      // one, so that both have travelled equally far.
      const double period_along = 2. * PI / waves.carrier.wave_number;
      const double width = 2. * period_along;
      const auto near = [&](const double h) { return std::max(of_case.wavelength, 10. * h); };
      incident = window_of(near(spacing), width, spacing);
      reflected = {-incident.end + 1, -incident.begin + 1};
      transmitted = window_of(near(right_spacing), width, right_spacing);
      const double far = incident.end * spacing;
      const double far_right = transmitted.end * right_spacing;
      const double gap = 10. * spacing;
      burst_length = of_case.cycles * period_along;
      burst_begin = -far - gap - burst_length;

      // Times
      const double speed = waves.carrier.group_velocity;
      const double arrival = (far + gap) / (fastest * speed);
      const double passed = (far + gap + burst_length) / speed;
      const double end =
          1.15 * std::max({passed + far / speed, passed + far / slowest_of(waves.reflected),
                           passed + far_right / slowest_of(waves.transmitted)});
      n_steps = static_cast<unsigned int>(std::ceil(end / time_step));

      // Rows long enough that nothing comes back from their ends
      const double way = fastest * (end - arrival);
      const auto columns = [](const double distance, const double h)
      { return static_cast<int>(std::ceil(distance / h)); };
      first = -columns(std::max(far + gap + burst_length + of_case.wavelength, 0.5 * (way + far)),
                       spacing);
      last = columns(0.5 * (way + std::max(far, far_right)), right_spacing);
      last_without = columns(0.5 * (way + far), spacing);
    }

    /** The runs of one burst with the interface, and in the lattice of the left side alone. */
    struct ChainRecords
    {
      Record with, without;
    };

    BlochOperator without_interface(const BlochOperator &bloch_operator)
    {
      return bloch_operator.homogeneous(ChainSide::left);
    }

    ChainRecords run_chains(const ReducedOperators &reduced, const BlochMotion::Filter &filter,
                            const Burst &burst, const Layout &layout, const double spacing,
                            const double frequency, const double time_step)
    {
      BlochMotion motion(reduced.update, reduced.damping, reduced.short_wave_part, filter,
                         time_step, layout.first, layout.last);
      Record with = run_chain(motion, burst, spacing, frequency, time_step, layout.n_steps);
      BlochMotion motion_without(without_interface(reduced.update),
                                 without_interface(reduced.damping),
                                 without_interface(reduced.short_wave_part), filter, time_step,
                                 layout.first, layout.last_without);
      Record without =
          run_chain(motion_without, burst, spacing, frequency, time_step, layout.n_steps);
      return {std::move(with), std::move(without)};
    }

    /** The spectrum of the reflected wave, at the columns up to the interface. */
    ChainField reflected_spectrum(const ChainRecords &records)
    {
      ChainField reflected = zero_like(records.with.spectrum);
      for (int column = reflected.first(); column <= 0; ++column)
        for (unsigned int c = 0; c < 2; ++c)
          reflected.set(column, c,
                        records.with.spectrum.get(column, c) -
                            records.without.spectrum.get(column, c));
      return reflected;
    }

    /** The largest |v̂| of the reflected wave at the end of the runs. */
    double last_reflected_velocity(const ChainRecords &records, const Window &window)
    {
      double largest = 0;
      for (int column = window.begin; column < window.end; ++column)
        for (unsigned int c = 0; c < 2; ++c)
          largest = std::max(largest, std::abs(records.with.last_velocity.get(column, c) -
                                               records.without.last_velocity.get(column, c)));
      return largest;
    }

    /** The carrier's amplitude in a fit of the incident waves. */
    double carrier_amplitude(const Fit &fit, const PartialWaves &waves, const WaveType type)
    {
      const double k_x = waves.carrier.wave_number;
      double amplitude = 0;
      for (std::size_t m = 0; m < waves.incident.size(); ++m)
        if (std::abs(waves.incident[m].wave_number - k_x) < 1e-6 * k_x &&
            waves.incident[m].type == type)
          amplitude = fit.amplitudes[m];
      return amplitude;
    }

    /** Takes the reflected and the transmitted wave apart into the waves of the lattices. */
    void measure_partial_waves(const ReflectionCase &of_case, const PartialWaves &waves,
                               const Layout &layout, const ChainRecords &records,
                               const ChainField &reflected, ReflectionResult &result)
    {
      const double spacing = of_case.left_spacing();
      const Fit incident = fit(records.without.spectrum, layout.incident, waves.incident, spacing);
      const double incident_amplitude = carrier_amplitude(incident, waves, of_case.wave);
      const double incident_flux =
          incident_amplitude * incident_amplitude * waves.carrier.group_velocity;

      const Fit back = fit(reflected, layout.reflected, waves.reflected, spacing);
      result.reflection = result.converted = 0;
      for (std::size_t m = 0; m < waves.reflected.size(); ++m)
        if (!waves.reflected[m].is_short)
          (waves.reflected[m].type == of_case.wave ? result.reflection : result.converted) =
              back.amplitudes[m] / incident_amplitude;
      result.fit_error = back.error / incident_amplitude;
      result.total = std::sqrt(energy_flux(back, waves.reflected) / incident_flux);
      const Fit onward = fit(records.with.spectrum, layout.transmitted, waves.transmitted,
                             of_case.right_spacing());
      result.transmitted_energy = energy_flux(onward, waves.transmitted) / incident_flux;
    }

    /** Compares the reflected wave as a whole with the incident one. */
    void measure_fields(const BlochOperator &smoothing, const Layout &layout,
                        const ChainField &incident, const ChainField &reflected,
                        ReflectionResult &result)
    {
      result.unsmoothed =
          amplitude(reflected, layout.reflected) / amplitude(incident, layout.incident);
      // Far from the interface v is v̂ smoothed by the left side's lattice in both runs.
      const BlochOperator of_left = without_interface(smoothing);
      result.smoothed = amplitude(smoothed(of_left, reflected), layout.reflected) /
                        amplitude(smoothed(of_left, incident), layout.incident);
    }
  } // namespace

  double ReflectionCase::wave_speed(const WaveType type) const
  {
    return type == WaveType::P ? 1.
                               : std::sqrt((1. - 2. * poissons_ratio) / (2. - 2. * poissons_ratio));
  }

  unsigned int ReflectionCase::neighbour_reach() const
  {
    if (left == SideKind::elements && right == SideKind::elements)
      return 1;
    // Within one part a coarse particle's support covers fine ones.
    const double ratio = is_one_part ? std::max(spacing_ratio, 1. / spacing_ratio) : 1.;
    return static_cast<unsigned int>(std::max(1., std::ceil(dilation * ratio - 1e-9) - 1.));
  }

  std::string ReflectionCase::scene_text() const
  {
    const LinearizedOperators::StripSize size = LinearizedOperators::strip_size(neighbour_reach());
    const double n = size.columns_per_side;
    const double nu = poissons_ratio;
    std::ostringstream text;
    text.precision(17);
    const auto add_part =
        [&](const std::string &name, const SideKind kind, const std::string &cells)
    {
      text << "subsection Part: " << name << "\nset Cells = " << cells << "\nset Material = m\n";
      if (kind == SideKind::elements)
      {
        text << "set Formulation = " << element << "\n";
        // The chain has two unknowns a column.
        if (element == "lagrange hexahedron")
          text << "subsection lagrange hexahedron\nset Degree = 1\nend\n";
      }
      else
      {
        text << "set Formulation = momentum consistent particle\n"
             << "subsection momentum consistent particle\nset Dilation = " << dilation
             << "\nset Smoothing = " << smoothing << "\nset Shape functions = " << shape_functions
             << "\n";
        if (!kernel.empty())
          text << "set Kernel = " << kernel << "\n";
        text << "end\n";
      }
      text << "end\n";
    };
    text << "set Dimension = 2\nset Materials = m\nset Parts = "
         << (is_one_part ? "both sides" : "left side, right side")
         << "\nsubsection Mesh\nset Type = box\nsubsection box\n"
         << "set Lower corner = " << -n * left_spacing() << ", 0\n"
         << "set Upper corner = " << n * right_spacing() << ", " << size.rows * row_spacing << "\n"
         << "set Cells = " << n << " to 0 | " << n << "; " << size.rows << "\nend\nend\n";
    if (is_one_part)
      add_part("both sides", left, "all");
    else
    {
      add_part("left side", left, "x < 0");
      add_part("right side", right, "otherwise");
    }
    text << "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 1\n"
         << "set Young's modulus = " << (1. + nu) * (1. - 2. * nu) / (1. - nu)
         << "\nset Poisson's ratio = " << nu << "\nend\nend\n"
         << "subsection Coupling\nset Bridge = " << bridge << "\nend\n";
    return text.str();
  }

  double exact_reflection(const double frequency, const double time_step, const double wave_speed,
                          const double left_spacing, const double right_spacing)
  {
    const double omega = 2. / time_step * std::sin(0.5 * frequency * time_step);
    const auto impedance = [&](const double spacing)
    { return std::sqrt(1. - std::pow(0.5 * omega * spacing / wave_speed, 2)); };
    const double left = impedance(left_spacing), right = impedance(right_spacing);
    return std::abs((left - right) / (left + right));
  }

  ReflectionModel::ReflectionModel(const ReflectionCase &of_case) : text(of_case.scene_text())
  {
    Parameters parameters(MPI_COMM_SELF);
    parameters.read_text(text, "the strip of a reflection");
    Model<2>::declare_parameters(parameters);
    declare_section<StepSize<2>>(parameters, "Time step");
    parameters.assign();
    Model<2> model(parameters, MPI_COMM_SELF);
    SpectralEstimator<2> estimator(parameters.section("Time step").subsection("spectral"));
    largest_step = estimator.estimate(model).time_step;
    for (const ParticleFormulation<2> *const particles : model.particle_parts())
      filter_rate = std::max(filter_rate, particles->material().longitudinal_wave_speed() /
                                              particles->smallest_spacing());
    operators = std::make_unique<LinearizedOperators>(model, of_case.neighbour_reach());
  }

  bool ReflectionModel::fits(const ReflectionCase &other) const
  {
    return other.scene_text() == text;
  }

  const LinearizedOperators &ReflectionModel::update_operator() const
  {
    return *operators;
  }

  ReflectionResult ReflectionModel::run(const ReflectionCase &of_case) const
  {
    const double spacing = of_case.left_spacing();
    const double right_spacing = of_case.right_spacing();
    const double wave_number = 2. * PI / of_case.wavelength;
    const double k_x = wave_number * std::cos(of_case.angle);
    const double k_y = wave_number * std::sin(of_case.angle);
    const double time_step = of_case.step_factor * largest_step;
    const ReducedOperators reduced = operators->reduce(k_y);
    const LatticeWaves waves(reduced.update, ChainSide::left, spacing, k_y, time_step);
    const LatticeWaves right_waves(reduced.update, ChainSide::right, right_spacing, k_y, time_step);

    ReflectionResult result;
    const LatticeMode carrier = waves.mode(k_x, of_case.wave);
    result.time_step = time_step;
    result.frequency = carrier.frequency;
    result.group_velocity = carrier.group_velocity;
    result.phase_error =
        std::sqrt(carrier.eigenvalue) / (of_case.wave_speed(of_case.wave) * wave_number) - 1.;
    if (carrier.group_velocity < slowest * std::cos(of_case.angle))
      return result;
    const PartialWaves partial_waves{carrier, waves.outgoing(carrier.frequency, ChainSide::left),
                                     right_waves.outgoing(carrier.frequency, ChainSide::right),
                                     waves.outgoing(carrier.frequency, ChainSide::right)};

    const Layout layout(of_case, partial_waves, time_step);
    const Burst burst(waves, carrier, layout.burst_begin, layout.burst_length);
    const ReflectionCase::Filter &settings = of_case.filter;
    const BlochMotion::Filter filter{
        settings.power, settings.interval,
        std::min(1., settings.strength * filter_rate * settings.interval * time_step)};
    const ChainRecords records =
        run_chains(reduced, filter, burst, layout, spacing, carrier.frequency, time_step);
    result.n_steps = layout.n_steps;
    result.n_columns = layout.last - layout.first + 1;

    const ChainField reflected = reflected_spectrum(records);
    result.remaining =
        last_reflected_velocity(records, layout.reflected) / std::sqrt(carrier.eigenvalue);
    measure_partial_waves(of_case, partial_waves, layout, records, reflected, result);
    measure_fields(reduced.smoothing, layout, records.without.spectrum, reflected, result);

    if (of_case.left == SideKind::elements && of_case.right == SideKind::elements &&
        std::abs(of_case.angle) < 1e-12)
      result.exact = exact_reflection(carrier.frequency, time_step,
                                      of_case.wave_speed(of_case.wave), spacing, right_spacing);
    return result;
  }
} // namespace tombolo
