// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/materials/nodal_enthalpy.h>
#include <tombolo/state/nodal_source.h>

#include <cstddef>
#include <cstdint>
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
} // namespace tombolo
