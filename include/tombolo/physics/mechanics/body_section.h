// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/boundary/load_sum.h>
#include <tombolo/model/part.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /**
   * A section that forces pass through, of one of two kinds.
   *
   * A cut divides the nodes by their initial positions: its side are those on the plane or beyond
   * it along the normal, and among them those where the predicate holds. Its force is that of the
   * material on the nodes of the side, F = Σ_side f_int. What lies between nodes of the side gives
   * nothing, since its forces are in balance, so that F is the force of what reaches across. By Σ
   * m a = F + the forces from outside on the side, F is exactly what the rest of the bodies does to
   * it, whatever elements or particles are there.
   *
   * An interface lies between two parts. Its force is that of the material of the first part on the
   * nodes that both have: what the first does to the second, since the forces within the second are
   * in balance. What it does to dependent nodes acts on those on which they depend.
   */
  template <int dim>
  class BodySection
  {
  public:
    /** Of a section "Section: NAME". */
    BodySection(const Entries &e, const std::vector<Part<dim>> &parts);

    /** Finds the side of a cut, and refuses one that divides nothing. Throws InputError.
     * Collective. */
    void find_side(const Section &section, const Model<dim> &model);

    /** For other ghosts, images or cells. Throws nothing. Collective. */
    void model_changed(const Model<dim> &model);

    /** Of an interface: what a part, whose number may be any, has added is the force after it less
     * that before. Collective. */
    void before_part_force(std::size_t part, const NodalVector &force);
    void after_part_force(std::size_t part, const NodalVector &force, const NodalVector &position);

    /** Of a cut: the sum over the internal forces of all parts, at owned nodes. */
    void take_internal_force(const NodalVector &force, const NodalVector &position);

    /** The force at t_n and its moment about the point, of this rank. */
    const LoadSum &sum() const;

    const std::string &name() const;

    /** A sentence for the audit. */
    std::string description() const;

    /** A warning; empty for none. */
    std::string remark() const;

  private:
    bool is_interface() const;
    bool is_beyond(const dealii::Point<dim> &initial, double tolerance) const;
    /** Sets n_cut and n_attached_elsewhere for this rank's cells. */
    void count_cells(const Model<dim> &model, double tolerance);
    LoadSum sum_over_side(const NodalVector &force, const NodalVector &position) const;

    std::string section_name;
    std::array<double, 3> point{}; ///< of moments and of the plane
    std::optional<dealii::Tensor<1, dim>> normal;
    std::optional<Predicate<dim>> where;
    std::optional<std::pair<std::size_t, std::size_t>> between; ///< parts of an interface
    std::vector<unsigned int> side; ///< owned nodes of a cut, or shared ones of an interface
    NodalVector of_first;           ///< the force of the first part of an interface
    LoadSum present;
    unsigned long n_side = 0; ///< over all ranks, as those below
    unsigned long n_cut = 0, n_attached_elsewhere = 0, n_shared = 0;
  };
} // namespace tombolo
