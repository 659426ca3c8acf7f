// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_faces.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <memory>
#include <vector>

namespace tombolo
{
  /** A face of one side of a contact between bodies, in present positions. */
  template <int dim>
  struct PairedFace
  {
    unsigned int number; ///< of the face on its side
    double thickness;    ///< of the cell behind it [L]
    FaceCorners<dim> corners;
    dealii::Tensor<1, dim> area; ///< ∫ n dA, out of the body [L^(dim-1)]
  };

  /** The common part of a slave face and a master face: for each corner I of the slave face the
   * weights w^s_IJ of its corners J and w^m_IL of those of the master face, with
   * Σ_J w^s_IJ = Σ_L w^m_IL, the area on which I touches. */
  template <int dim>
  struct FacePair
  {
    static constexpr unsigned int n_corners = ContactFaces<dim>::n_corners;
    using Weights = std::array<std::array<double, n_corners>, n_corners>;

    FacePair(const PairedFace<dim> &slave, const PairedFace<dim> &master)
        : slave(slave.number), master(master.number)
    {}

    /** At all corners. */
    void set_normal(const dealii::Tensor<1, dim> &normal)
    {
      normals.fill(normal);
    }

    unsigned int slave, master;                            ///< numbers of the faces
    std::array<dealii::Tensor<1, dim>, n_corners> normals; ///< of length one, out of the slave
    Weights of_slave{}, of_master{};
  };

  /**
   * Where the bodies of a contact meet, the entry `Type` of a section `Body contact: NAME`: which
   * faces, with which weights and normals. All else is the same for all pairings: the search for
   * faces that are near, also of other ranks, gaps and motions of slave nodes by the weights,
   * pressure, friction and heat, forces and heat by the transposed weights, stiffness at rest.
   *
   * A pairing is a plug-in (doc/add_a_process.md).
   */
  template <int dim>
  class Pairing
  {
  public:
    virtual ~Pairing() = default;

    /** Finds the pairs of a slave face with @p masters, those whose boxes are nearer to its own
     * than reach() and radius(), and adds them to @p pairs, one for each master at most.
     * Coordinates are relative to any origin. Not collective. */
    virtual void find(const PairedFace<dim> &slave, const std::vector<PairedFace<dim>> &masters,
                      std::vector<FacePair<dim>> &pairs) const = 0;

    /** Whether pairs of the start are kept, also in tension; the normal turns with the slave. */
    virtual bool is_tied() const
    {
      return false;
    }

    /** The largest distance of paired faces, over the thickness of the slave. */
    virtual double reach() const
    {
      return 0.75;
    }

    /** The slave is this far around its nodes [L]. */
    virtual double radius() const
    {
      return 0.;
    }

    /** Declares the entry and those of all pairings, or reads it; null while they are declared. */
    static std::unique_ptr<Pairing> create(const Entries &e)
    {
      e.plugins<Pairing>();
      return e.plugin<Pairing>("Type", "touching",
                               "`touching`: the bodies push each other, with friction. `tied`: "
                               "they are one where they meet at the start, also in tension.");
    }
  };

  template <int dim>
  struct PluginKind<Pairing<dim>>
  {
    static constexpr const char *name = "pairing";
  };
} // namespace tombolo
