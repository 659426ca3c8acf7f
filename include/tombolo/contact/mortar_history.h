// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/clock.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/contact/mortar_segments.h>
#include <tombolo/state/nodal_state.h>

#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  class Records;

  /**
   * The stiffness per area κ = α / Δt² / (1/μ_s + 1/μ_m) of the springs between two surfaces, with
   * μ = min m_k / A_k over the nodes of a side. It becomes softer where Δt or the masses per area
   * demand it, and stiffer only while nothing touches. Masses per area are found every 16 steps.
   */
  template <int dim>
  class MortarStiffness
  {
  public:
    /** The present κ, of springs of @p law, for this @p share of the masses. Collective in every
     * 16th step. */
    void find(const NodalState &state, const Clock &clock, const ContactLaw &law, double share,
              bool touches, ContactFaces<dim> &slaves, ContactFaces<dim> &masters);

    double value() const ///< κ [M/(L^(dim-1) T^2)]; zero without contact
    {
      return stiffness;
    }

    /** Areas of owned nodes of each side. */
    const std::vector<double> &of_slaves() const
    {
      return slave_areas;
    }
    const std::vector<double> &of_masters() const
    {
      return master_areas;
    }

    /** Lists what is kept from step to step, of nodes of these faces, which are referred to; @p
     * continues: a run that starts from the end of another takes the stiffness from there. */
    void list(Records &records, const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
              bool continues);

    /** Lets the next find() take the masses anew. */
    void forget_masses()
    {
      mass_per_area = 0.;
    }

  private:
    std::vector<double> slave_areas, master_areas; ///< of owned nodes, for masses per area
    double mass_per_area = 0;                      ///< 1/(1/μ_s + 1/μ_m); zero before it is known
    double stiffness = 0;
  };

  /** What a slave node of a contact between bodies keeps from step to step. The normal is out of
   * the master. */
  template <int dim>
  struct MortarHistory
  {
    ContactSpring<dim> spring; ///< per area
    dealii::Tensor<1, dim> traction, normal;
    double gap = 0;
    double area = 0; ///< A_I; zero where no master is near
    /** The overlap that has no force, or for tied surfaces the distance that they keep [L]. */
    double offset = 0;
    bool is_bonded = false;

    /** Lists those of these owned nodes; @p continue_them: a run that starts from the end of
     * another takes them from there. */
    static void list(Records &records, const std::vector<unsigned int> &nodes,
                     std::vector<MortarHistory> &histories, bool continue_them);

    /** Those of @p former owned nodes become those of owned @p nodes. Returns the energy of the
     * springs of nodes that are gone [M L^2/T^2]. */
    static double move(const std::vector<unsigned int> &former,
                       const std::vector<unsigned int> &nodes,
                       std::vector<MortarHistory> &histories);

    /** Where bodies have come from positions @p before to others without a motion: springs are as
     * much deeper as the gap is smaller, and what comes to overlap has no force. Positions have
     * current ghosts. Collective. */
    static void place(const NodalVector &before, const NodalVector &position,
                      const std::vector<unsigned int> &nodes, MortarSegments<dim> &segments,
                      std::vector<MortarHistory> &histories);

    /** Mean and largest of the temperatures of slave @p nodes in contact, which are in slot 0 of @p
     * of_slave, or where that is null of the master below them. Collective. */
    static std::array<double, 2> temperatures(const NodalVector *of_slave,
                                              const std::vector<unsigned int> &nodes,
                                              const std::vector<MortarHistory> &histories,
                                              const MortarSegments<dim> &segments,
                                              MPI_Comm communicator);

    /** How many of these owned slave nodes are tied, those with an area, how many are not, and
     * where the first of the others is, by x, y and z. The same on all ranks. Collective. */
    static std::string describe_tie(const NodalVector &position,
                                    const std::vector<unsigned int> &slave_nodes,
                                    const std::vector<MortarHistory> &histories,
                                    MPI_Comm communicator);
  };
} // namespace tombolo
