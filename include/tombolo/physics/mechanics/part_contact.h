// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Contact between bodies of different particle parts that have self-contact: the law of
   * SelfContact between two particles of parts A and B of bodies that no common node joins, with
   *
   * @verbatim
   *   k = μ min(ω_A, ω_B)²,  ω = √s c/h,  b = 2 ζ √(k μ),  ζ = ½ (ζ_A + ζ_B)
   * @endverbatim
   *
   * and the reduced mass μ. Both ends compute the same force from the same numbers, so that
   * momentum is kept to round-off. A particle of several parts takes the least of their ω and ζ.
   * Spheres that overlap initially are made smaller. Every rank gets the particles of all that are
   * in the box around another part: meant for bodies that meet in some places.
   */
  template <int dim>
  class PartContact : public Process<dim>
  {
  public:
    /** What a part contributes. */
    struct PartLaw
    {
      unsigned int part; ///< number in the model
      double stiffness;  ///< s
      double damping;    ///< ζ
      double frequency;  ///< ω [1/T], of all ranks
      double mass;       ///< the largest m̂ of its particles, of all ranks [M]
    };

    /** @p laws have the entries of the parts; the other numbers are found. Collective. */
    PartContact(std::vector<PartLaw> laws, Model<dim> &model);

    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    double stable_fraction(double stable_step) const override;
    void account(EnergyAccounts &accounts) const override;

  private:
    /** A particle of this rank: an owned node, once however many parts have it. */
    struct Particle
    {
      unsigned int node;   ///< local
      std::uint64_t parts; ///< a bit for each law
      std::uint64_t body;
      double volume = 0; ///< initial [L^dim]
      double radius = 0; ///< [L]
      bool has_elements = false;
      dealii::Tensor<1, dim> force, position; ///< of the step before
    };

    /** What other ranks know of a particle. */
    struct Sphere
    {
      std::uint64_t node, parts, body;
      bool has_elements;
      double mass, radius;
      dealii::Tensor<1, dim> position, velocity;
    };
    using Cell = std::array<long, 3>;
    using Grid = std::vector<std::pair<Cell, std::size_t>>;

    /** Finds the particles of this rank; keeps what is known of those of before. Collective. */
    void collect_particles(const Model<dim> &model);
    /** Makes spheres smaller until none overlaps at the initial positions. Collective. */
    void shrink_spheres(const Model<dim> &model);
    Sphere sphere(const Particle &particle, const Model<dim> &model,
                  const NodalVector &position) const;
    /** The spheres of all ranks in the box around another part, by the number of the node.
     * Collective. */
    std::vector<Sphere> spheres_nearby(const Model<dim> &model, const NodalVector &position) const;
    Grid sort_into_grid(const std::vector<Sphere> &spheres) const;
    Cell cell_of(const dealii::Tensor<1, dim> &position) const;
    /** Calls @p action with all spheres that can touch this one, by the number of the node. */
    template <typename Action>
    void for_partners(const Sphere &one, const std::vector<Sphere> &spheres, const Grid &grid,
                      const Action &action) const;
    /** The force on @p one; adds its half of what the springs store. */
    dealii::Tensor<1, dim> force_on(const Sphere &one, const std::vector<Sphere> &spheres,
                                    const Grid &grid, double &elastic) const;
    double frequency_of(std::uint64_t parts) const;
    double damping_of(std::uint64_t parts) const;

    std::vector<PartLaw> laws;
    double reach = 0; ///< the largest diameter of all spheres [L]
    std::vector<Particle> particles;
    std::vector<unsigned int> nodes; ///< of these, for the records
    bool is_current = false;         ///< whether particles and spheres are those of the model
    double stored = 0, dissipated = 0;
    Action &forces;
  };
} // namespace tombolo
