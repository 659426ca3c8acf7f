// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/bridge.h>
#include <tombolo/study/waves/bloch_operator.h>
#include <tombolo/study/waves/lattice_waves.h>
#include <tombolo/study/waves/linearized_operators.h>

#include <limits>
#include <memory>
#include <string>

namespace tombolo
{
  /** What fills one side of the interface. */
  enum class SideKind
  {
    elements,
    particles
  };

  /** One wave at one interface. The coarser of the two spacings across the interface is 1; the
   * density and the speed of P waves are 1. */
  struct ReflectionCase
  {
    SideKind left = SideKind::elements; ///< where the wave comes from
    SideKind right = SideKind::elements;
    bool is_one_part = false; ///< particles on both sides that see each other
    std::string element = "fully integrated hexahedron";
    double spacing_ratio = 1; ///< spacing of the right side over that of the left
    double row_spacing = 1;   ///< spacing along the interface, of both sides
    double dilation = 1.8;
    std::string kernel; ///< empty: the default
    std::string smoothing = "paper";
    std::string bridge = "paper";
    std::string shape_functions = "moving least squares";
    double poissons_ratio = 0;
    double step_factor = 0.9; ///< of the stable step of the strip, by its spectrum

    /** v̂ ← v̂ - δ (I - ΦS)^power v̂ every few steps (doc/method.md, section 9). */
    struct Filter
    {
      unsigned int power = 0;    ///< 0: no filter
      double strength = 0;       ///< β in δ = β c Δt n / h
      unsigned int interval = 1; ///< n
    };
    Filter filter;

    WaveType wave = WaveType::P;
    double wavelength = 20; ///< over the coarser spacing
    double angle = 0;       ///< between the wave's direction and the normal, in radians
    double cycles = 8;      ///< wavelengths in the Hann burst, counted along the normal

    double left_spacing() const
    {
      return spacing_ratio > 1. ? 1. / spacing_ratio : 1.;
    }

    double right_spacing() const
    {
      return spacing_ratio > 1. ? 1. : spacing_ratio;
    }

    /** Speed of a type of wave in the continuum. */
    double wave_speed(WaveType type) const;
    /** The parameter file of the strip that the operators are probed in. */
    std::string scene_text() const;
    /** How many columns the shape functions reach. */
    unsigned int neighbour_reach() const;
  };

  /**
   * What came back. Amplitudes are those of discrete Fourier transforms in time at the frequency of
   * the carrier, over that of the incident wave. The reflected wave is the difference to a run
   * without an interface; it is looked at in a window on the left side, at least a wavelength and
   * ten spacings from the interface, and is taken apart into the lattice's exact waves there.
   * Values are NaN where the lattice carries no such incident wave.
   */
  struct ReflectionResult
  {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    double reflection = none; ///< of the wave of the incident type; the same in v and in v̂
    double converted = none;  ///< of the other type
    double total = none;      ///< of all waves: root of reflected over incident energy flux
    double smoothed = none;   ///< of all of v: root mean square over the window
    double unsmoothed = none; ///< of all of v̂, short waves included
    double transmitted_energy = none; ///< over the incident energy flux, all waves
    double fit_error = none;          ///< of v̂ in the window, what is none of the lattice's waves
    double remaining = none; ///< largest |v̂| of the reflected wave in the window at the end, over
                             ///< that of the incident burst at its start
    double exact = none;     ///< where the exact reflection is known: elements, normal incidence
    double phase_error = none; ///< of the incident wave: ω/(c k) - 1 without the error of the step
    double frequency = none;
    double time_step = none;
    double group_velocity = none; ///< of the incident wave, along the normal
    double n_steps = 0;
    double n_columns = 0;

    /** For the exchange between ranks. */
    template <typename Archive>
    void serialize(Archive &archive, unsigned int /*version*/)
    {
      archive &reflection &converted &smoothed &total &unsmoothed &transmitted_energy &fit_error
          &remaining &exact &phase_error &frequency &time_step &group_velocity &n_steps &n_columns;
    }
  };

  /** |R| of elements with lumped mass under central differences at normal incidence, at a
   * frequency: Ω = (2/Δt) sin(ωΔt/2), Z = √(1 - (Ω h / 2c)²), R = (Z₁ - Z₂)/(Z₁ + Z₂) for equal
   * material on both sides. */
  double exact_reflection(double frequency, double time_step, double wave_speed,
                          double left_spacing, double right_spacing);

  /** The interface of one or several cases that differ in their wave only: the strip, its stable
   * step and its operators. */
  class ReflectionModel
  {
  public:
    /** Builds the strip on this rank alone. Throws InputError where it cannot be built. */
    explicit ReflectionModel(const ReflectionCase &of_case);

    /** Whether a case has the same strip. */
    bool fits(const ReflectionCase &other) const;

    const LinearizedOperators &update_operator() const;

    /** The stable step of the strip, by its spectrum [T]. */
    double stable_step() const
    {
      return largest_step;
    }

    /** Sends the burst. */
    ReflectionResult run(const ReflectionCase &of_case) const;

  private:
    std::string text;
    std::unique_ptr<LinearizedOperators> operators;
    double largest_step = 0;
    double filter_rate = 0; // c/h of the particles
  };
} // namespace tombolo
