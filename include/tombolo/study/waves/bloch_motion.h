// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/study/waves/bloch_operator.h>

#include <array>
#include <complex>
#include <vector>

namespace tombolo
{
  /** Two complex unknowns at each of a row of columns, and zeros beyond both ends: real and
   * imaginary parts of each in an array of their own. */
  class ChainField
  {
  public:
    /** Zero at columns @p first ... @p last, with @p padding more columns beyond the ends. */
    ChainField(int first, int last, int padding);

    int first() const;
    int last() const;

    std::complex<double> get(int column, unsigned int component) const;
    void set(int column, unsigned int component, std::complex<double> value);

    /** Address of column 0 of the real (@p part 0) or imaginary (1) part of a component. */
    double *part(unsigned int component, unsigned int part);
    const double *part(unsigned int component, unsigned int part) const;

    void set_zero();

    /** this += factor · other */
    void add(std::complex<double> factor, const ChainField &other);

  private:
    int first_column, last_column, padding;
    std::array<dealii::AlignedVector<double>, 4> values;
  };

  /** A BlochOperator cut off at the ends of a row of columns, made ready to be applied many times.
   */
  class ChainSweep
  {
  public:
    ChainSweep(const BlochOperator &bloch_operator, int first, int last);

    /** @p result += factor · operator @p field. The padding of @p field must be at least the reach.
     */
    void add(double factor, const ChainField &field, ChainField &result) const;

    int reach() const;
    bool is_zero() const;

  private:
    /** One entry of the blocks of a uniform stretch of rows. */
    struct Coefficient
    {
      int offset; // of the source column
      unsigned int to, from;
      std::complex<double> value;
    };
    struct Stretch
    {
      int begin, end; // rows
      std::vector<Coefficient> coefficients;
    };

    int operator_reach;
    std::vector<Stretch> stretches; // one row each near the interface
  };

  /**
   * The central difference scheme of the program for fields of one wave number along the interface:
   *
   *   d += Δt S v̂,   v̂ -= Δt Φ M⁻¹ (K d + C S v̂),   every n steps v̂ -= δ T^p v̂.
   *
   * It is written with the unsmoothed displacement e, d = S e, so that one operator A = Φ M⁻¹ K S
   * remains.
   */
  class BlochMotion
  {
  public:
    struct Filter
    {
      unsigned int power = 0;    ///< 0: no filter
      unsigned int interval = 1; ///< steps
      double fraction = 0;       ///< δ, at most 1
    };

    /** Columns @p first ... @p last. @p damping may be zero. */
    BlochMotion(const BlochOperator &update, const BlochOperator &damping,
                const BlochOperator &short_wave_part, const Filter &filter, double time_step,
                int first, int last);

    /** One step; @p displacement is e at t_n before and at t_{n+1} after it, @p velocity is v̂ at
     * t_{n-1/2} and t_{n+1/2}. */
    void advance(ChainField &displacement, ChainField &velocity);

    /** A zero field that the sweeps of this motion can be applied to. */
    ChainField make_field() const;

  private:
    ChainSweep update, damping, short_wave_part;
    Filter filter;
    double time_step;
    unsigned long step = 0;
    int first, last;
    ChainField force, work, second_work;
  };
} // namespace tombolo
