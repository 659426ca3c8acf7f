// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/nodal_source.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /** What contact between particles sees of the heat of a scene: null pointers without heat. */
  struct FragmentHeat
  {
    const NodalVector *temperature = nullptr; ///< θ^h at the present time, slot 0 of owned nodes
    const NodalEnthalpy *enthalpy = nullptr;
    /** Scalar, of owned nodes: heat that they have got and that no thermal step has given them yet
     * [M L^2/T^2]. */
    const NodalVector *pending = nullptr;
    NodalSource *given = nullptr; ///< gets that of the step
  };

  /** The particles of this rank that can touch others, of one part or of several: each node once,
   * with all that it has of these parts. */
  struct TouchingRows
  {
    /** A row of the stencils of a part. */
    struct Site
    {
      unsigned int part; ///< its number among the parts in contact
      unsigned int row;
    };

    std::vector<unsigned int> nodes; ///< local numbers, ascending
    std::vector<std::uint64_t> ids;  ///< persistent identifiers
    std::vector<double> shares;      ///< in the piece of the body, of the particle in the whole one
    /** Those of row i are sites[start[i]] to sites[start[i+1]], by ascending part. The first one
     * stands for the particle. */
    std::vector<Site> sites;
    std::vector<std::size_t> start;

    unsigned int size() const
    {
      return static_cast<unsigned int>(nodes.size());
    }
    const Site &site(const std::size_t i) const
    {
      return sites[start[i]];
    }
  };

  /** Pairs of particles that can touch. */
  struct FragmentPairs
  {
    std::vector<std::size_t> start;    ///< those of row i are start[i] to start[i+1]
    std::vector<unsigned int> partner; ///< local nodes, images of nodes among them
    std::vector<unsigned int> mirrors; ///< of the partner as an image, as bits; 0: it is none
  };

  /** Two particles of different bodies that touch, seen by one of them. */
  template <int dim>
  struct FragmentTouch
  {
    unsigned int row;                ///< of this end
    std::size_t pair;                ///< its number
    unsigned int own, other;         ///< local nodes
    unsigned int own_law, other_law; ///< parts, among those in contact, whose laws hold
    dealii::Tensor<1, dim> normal;   ///< from this end to the other
    double own_lever, other_lever;   ///< distances of the centres from the point of contact [L]
    double normal_force;             ///< f_n of spring and damper [M L/T^2]
    double stiffness;                ///< of the spring along the normal [M/T^2]
    double area;                     ///< in contact [L^(dim-1)]
  };

  class StateArchive;

  /** How the particles of a part rub and conduct where they touch. */
  struct RubbingLaw
  {
    TemperatureTable friction;    ///< μ over the temperature
    TemperatureTable conductance; ///< h over the pressure [M/(T^3 temperature)]

    /** Throws InputError. */
    static RubbingLaw create(const Entries &e);

    /** Throws the InputError of @p section of what has no meaning without heat. */
    static void refuse_without_heat(const Section &section);

    bool rubs() const
    {
      return friction.largest() > 0.;
    }
    bool conducts() const
    {
      return conductance.largest() > 0.;
    }
  };

  /** The spring along the surface between two particles. */
  template <int dim>
  struct RubbingSpring
  {
    double stiffness = 0; ///< zero: open [M/T^2]
    dealii::Tensor<1, dim> slip;
  };

  /** What friction keeps of the particles of one part. */
  template <int dim>
  struct FrictionOfPart
  {
    struct KnownSpring
    {
      std::uint64_t own, partner; ///< persistent identifiers
      unsigned int mirrors;       ///< of the partner
      RubbingSpring<dim> spring;
    };

    double stored = 0;     ///< in the springs, of this rank [M L^2/T^2]
    double dissipated = 0; ///< heat of friction since the start, of this rank
    /** The closed ones that no pair has, in the order of their identifiers. */
    std::vector<KnownSpring> springs;
    /** Brings all that pairs have to the parts of their particles. */
    std::function<void()> fetch_springs;

    /** Writes to a checkpoint or reads it: rows of the particles @p own_ids. Collective. */
    void serialize(StateArchive &archive, const std::vector<std::uint64_t> &own_ids);
  };

  /**
   * Friction and conduction between particles of different bodies, beside the normal forces of
   * SphereContact.
   *
   * Along the surface two particles hang on a spring of half the stiffness k of that along the
   * normal. Its elongation s follows the motion of the two materials at the point of contact,
   *
   *   Δ = Δu_J + W_J r_J - Δu_I - W_I r_I,  without its normal component,
   *
   * with the displacements Δu of the step, the offsets r of the point of contact from the centres,
   * and the skew part W of Σ_K Δu_K ⊗ g_K by the present gradients g. Particles without a linear
   * basis (debris) are points without spin, W = 0. s turns with both materials and keeps its
   * length, and slips at |½ k s| = μ f_n. The forces act at the point of contact: their moments
   * about the centres are carried by the neighbours K as ½ (f ⊗ r - r ⊗ f) g_K, the adjoint of W.
   * So friction sees no rotation of a body, linear momentum is kept to round-off, and angular
   * momentum as well where neither end is debris. To debris it gives the moment r × f that would
   * spin it, and that is lost.
   *
   * μ is that at the temperature of the hotter of the two, and of two parts the smaller one. Half
   * of the heat of friction is each end's, whatever the materials are. Conduction exchanges
   *
   *   q = e (1 - exp(-x))/x (T_J - T_I),  e = h A Δt,  x = Σ_I e/C_I + Σ_J e/C_J,
   *
   * with sums over all contacts of each end, the smaller h of two parts, and A = V^((dim-1)/dim) of
   * the smaller particle: the exact exchange of one pair, and never past the temperatures of all
   * that touch, whatever h. What one end gets the other loses, to round-off.
   */
  template <int dim>
  class FragmentFriction
  {
  public:
    struct Part
    {
      const RubbingLaw *law;
      FrictionOfPart<dim> *kept;
      const Stencils *shape;
    };

    /** Between particles of these @p parts. */
    explicit FragmentFriction(std::vector<Part> parts);

    /** The pairs from now on, of @p rows; local nodes are those of @p partition. What is known of
     * pairs that were there before is kept. Collective. */
    void set_pairs(const std::shared_ptr<const NodePartition> &partition, const TouchingRows &rows,
                   const FragmentPairs &pairs);

    /** Whether pairs are set: they are not after a state was written or read. */
    bool has_pairs() const
    {
      return !row_of_pairs.empty();
    }

    /** Begins a step in which the particles have moved by @p moves. Rows with @p touches are in
     * contact; @p position, with the ghosts of the stencils, is that at its end. Collective. */
    void begin_step(const NodalVector &position, const std::vector<dealii::Tensor<1, dim>> &moves,
                    const std::vector<bool> &touches, const FragmentHeat &heat);

    /** The force of friction on this end in the whole body. Adds its half of the heat. */
    dealii::Tensor<1, dim> rub(const FragmentTouch<dim> &touch, double time_step,
                               const FragmentHeat &heat);

    /** Ends the step: adds the moments of the forces to @p loads, at ghosts as well, and conducts.
     * Collective. */
    void end_step(const FragmentHeat &heat, NodalVector &loads);

  private:
    using KnownSpring = typename FrictionOfPart<dim>::KnownSpring;
    struct Exchange
    {
      unsigned int own, other; ///< local nodes
      double exposure;         ///< e = h A Δt [M L^2/(T^2 K)]
    };

    /** Moves the springs that are closed to those that the parts know; there are no pairs then. */
    void give_back_springs();
    FrictionOfPart<dim> &kept_of(const unsigned int row)
    {
      return *parts[rows.site(row).part].kept;
    }
    /** Ends a contact of a row: what the spring stores becomes heat. Half of it is this end's. */
    void release(const unsigned int row, RubbingSpring<dim> &spring)
    {
      const double taken = rows.shares[row] * 0.25 * spring.stiffness * spring.slip.norm_square();
      kept_of(row).dissipated += taken;
      released_heat[row] += taken;
      spring = {};
    }
    /** Values of a particle in contact: axial vector of W, temperature. */
    void set_end(unsigned int row, const NodalVector &position, const FragmentHeat &heat,
                 double *of_end);
    /** Images have the axial vectors of their nodes: gives them those of images. */
    void reflect_spins();
    void spread_couples(NodalVector &loads);
    void conduct(const FragmentHeat &heat);

    std::vector<Part> parts;
    bool any_rubs = false, any_conducts = false;
    TouchingRows rows;
    std::vector<std::size_t> row_of_pairs;
    std::vector<std::uint64_t> partner_ids;
    std::vector<unsigned int> partner_mirrors;
    std::vector<RubbingSpring<dim>> springs; ///< of each pair
    std::vector<bool> is_touching;           ///< pairs, in this step
    // Of the step, by row: inverse of the deformation since the kernel's reference, zero where
    // there is none; sum of f ⊗ r - r ⊗ f; heat of contacts that ended.
    std::vector<dealii::Tensor<2, dim>> inverse_deformation, couple;
    std::vector<double> released_heat;
    NodalVector displacement; ///< Δu of the step, with the ghosts of the stencils
    NodalVector motion;       ///< the same with those of pairs
    NodalVector ends;         ///< axial vector of W, temperature
    NodalVector exposures;    ///< Σ e/C
    std::vector<Exchange> exchanges;
  };
} // namespace tombolo
