// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/symmetric_tensor.h>

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/stencils.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * A kernel of the distance, W(r) = α w(r/(2h)) with the smoothing length h, zero for r >= 2h. The
   * factor α makes its integral over the plane or space one; it comes from a quadrature, and so
   * serves any Kernel.
   */
  template <int dim>
  class RadialKernel
  {
  public:
    RadialKernel(std::shared_ptr<const Kernel> kernel, double smoothing_length);

    /** W [1/L^dim] and dW/dr [1/L^(dim+1)] at @p n distances [L]. @p n is a multiple of n_lanes,
     * and no pointer may be the same. At r = 0 the slope is that of r → 0+. */
    void evaluate(std::size_t n, const double *distance, double *value, double *slope) const;

    /** h [L]. */
    double smoothing_length() const
    {
      return length;
    }
    /** 2h [L]. */
    double support() const
    {
      return 2. * length;
    }

  private:
    std::shared_ptr<const Kernel> kernel;
    double length;
    double scale; ///< α
  };

  /**
   * Rows of smoothed particle hydrodynamics: fills value and gradient of Stencils for given
   * neighbours with φ_I = 1, φ_J = 0 and, with d = x_J - x_I, r = |d| and masses over the common
   * initial density as volumes V⁰,
   *
   * @verbatim
   *   ∇φ_J = (m_J/ρ_I) ∇_I W(r) = -(V⁰_J V_I/V⁰_I) W'(r) d/r,     ∇φ_I = -Σ ∇φ_J
   * @endverbatim
   *
   * With V_I = m_I/ρ_I as the volume of a particle, L = Σ v_J ⊗ ∇φ_J is then the velocity gradient
   * of the equation of mass, dρ_I/dt = Σ m_J (v_I - v_J)·∇_IW, and -V_I σ_I ∇φ_J are the forces of
   * dv_I/dt = Σ m_J (σ_I/ρ_I² + σ_J/ρ_J²)·∇_IW: the pair is conjugate in energy, whatever the
   * volumes are. Corrected rows have F⁻¹∇φ_J with the symmetric F = Σ d ⊗ ∇φ_J (Randles and
   * Libersky 1996; Bonet and Lok 1999), so that Σ d ⊗ ∇φ_J = 1: linear fields have their gradients,
   * and angular momentum is conserved. V_I cancels there.
   *
   * F of a row can be nearly singular where a particle has few neighbours. A row is not corrected
   * where det F falls below a limit times (tr F/dim)^dim, which is one where F is isotropic and
   * does not depend on how many neighbours there are, or where it has fewer than dim + 2 of them.
   */
  template <int dim>
  class RadialRows
  {
  public:
    /** What becomes of rows that cannot be corrected. */
    enum class Uncorrected
    {
      raw,  ///< they keep ∇φ_J as it is, and are listed in Stencils::uncorrected_rows
      empty ///< they get no ∇φ, and are listed in Stencils::rank_deficient_rows
    };

    /** A row that cannot be corrected. */
    struct Defect
    {
      unsigned int row;          ///< index into Stencils::particle_node
      unsigned int n_neighbours; ///< within the support, without the particle itself
    };

    /** Without @p corrects all rows are raw (Stencils::is_uncorrected). */
    RadialRows(const RadialKernel<dim> &kernel, bool corrects, double correction_limit,
               Uncorrected uncorrected);

    /** Where component V⁰ of a node is in its support. */
    static constexpr unsigned int volume_slot = node_stride - 1;

    /**
     * Computes the rows of @p shape from @p position and @p support, node_stride doubles per local
     * node, of which only V⁰ in volume_slot counts [L^dim]. The rows of @p candidates have all
     * neighbours that can be within reach(); @p shape gets those that are, in their order, or keeps
     * all where both are the same object. @p nodes lists the local nodes that occur as particle or
     * neighbour. @p volume holds the present V_I of each row, or nothing: V⁰_I. Buffers are kept: a
     * second call of the same size allocates nothing. Returns the rows that cannot be corrected,
     * ascending, valid until the next call.
     */
    const std::vector<Defect> &compute(const std::vector<unsigned int> &nodes,
                                       const double *position, const double *support,
                                       const std::vector<double> &volume,
                                       const Stencils &candidates, Stencils &shape);

    const RadialKernel<dim> &kernel() const
    {
      return radial_kernel;
    }

    /** By row of the last call, the entry of the particle itself. */
    const std::size_t *own_entries() const
    {
      return own_entry.data();
    }

    /** Neighbours are nearer than this: 2h less a small share of it, since on a lattice particles
     * can be there exactly, and round-off is not to decide whether they are neighbours [L]. */
    double reach() const
    {
      constexpr double at_the_end = 1e-9; // the share of the support where nothing is a neighbour
      return (1. - at_the_end) * radial_kernel.support();
    }

  private:
    /** The neighbours of some row within the buffers. */
    struct Entries
    {
      std::size_t begin;          ///< in the buffers, a multiple of n_lanes
      std::size_t own;            ///< of the particle itself, from the beginning of the row on
      unsigned int size;          ///< with the particle itself
      std::size_t padded() const; ///< size in whole Lanes
    };

    /** Fills records of the nodes, and sizes what all rows of @p shape need. */
    void prepare(const std::vector<unsigned int> &nodes, const double *position,
                 const double *support, const Stencils &candidates, Stencils &shape);
    /** Offsets, their squares and volumes of the neighbours of a row, from entry @p begin of the
     * buffers on, and their numbers in @p shape. */
    Entries gather(unsigned int row, std::size_t begin, const Stencils &candidates,
                   Stencils &shape);
    /** Distances of @p n_entries of the buffers, and the slopes of the kernel there. */
    void evaluate_kernel(std::size_t n_entries);
    /** The factors c of ∇φ_J = c d of a row. Returns F = Σ c d dᵀ and counts the neighbours within
     * the support. */
    dealii::SymmetricTensor<2, dim> find_factors(const Entries &entries,
                                                 unsigned int &n_neighbours);
    /** Finds the factors of a row, and what they are multiplied with; notes rows that are not
     * corrected. */
    dealii::SymmetricTensor<2, dim> find_correction(unsigned int row, const Entries &entries,
                                                    const std::vector<double> &volume,
                                                    Stencils &shape);
    /** Writes the row from the buffers. */
    void write_row(unsigned int row, const Entries &entries,
                   const dealii::SymmetricTensor<2, dim> &correction, Stencils &shape) const;
    /** φ of the rows. */
    void write_values(Stencils &shape);

    RadialKernel<dim> radial_kernel;
    bool is_corrected;
    double limit;
    Uncorrected treatment;
    std::vector<Defect> defects;
    dealii::AlignedVector<double> records; // of each node: position and V⁰
    dealii::AlignedVector<double> offset[3], squared, factor, distance, value, slope;
    std::vector<Entries> of_block;
    std::vector<std::size_t> own_candidate; // by row, where it was last
    std::vector<std::size_t> own_entry;     // by row of shape
    /** Of the last call: the entries with φ = 1, and the values. */
    std::vector<std::size_t> last_own_entry;
    const double *last_values = nullptr;
  };
} // namespace tombolo
