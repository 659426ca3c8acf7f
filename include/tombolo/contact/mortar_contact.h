// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/clock.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/contact_heat.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/mortar_segments.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/records.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The stiffness per area κ = α / Δt² / (1/μ_s + 1/μ_m) of the springs between two surfaces, with
   * μ = min m_k / A_k over the nodes of a side. It becomes softer where Δt or the masses per area
   * demand it, and stiffer only while nothing touches. Masses per area are found every 16 steps.
   */
  template <int dim>
  struct MortarStiffness
  {
    double value = 0;                              ///< κ [M/(L^(dim-1) T^2)]; zero without contact
    std::vector<double> slave_areas, master_areas; ///< of owned nodes of each side, for masses
    double mass_per_area = 0; ///< 1/(1/μ_s + 1/μ_m); zero: the next find() computes it

    /** The present κ, for this @p share of the masses. Collective in every 16th step. */
    void find(const NodalState &state, const Clock &clock, const ContactLaw &law,
              const double share, const bool touches, ContactFaces<dim> &slaves,
              ContactFaces<dim> &masters)
    {
      if (clock.step % steps_between_masses == 0 || mass_per_area == 0.)
      {
        slaves.find_areas(state.position, slave_areas);
        masters.find_areas(state.position, master_areas);
        std::vector<double> least{
            least_mass_per_area(slaves.owned_nodes(), slave_areas, state.mass),
            least_mass_per_area(masters.owned_nodes(), master_areas, state.mass),
            touches ? -1. : 0.};
        Utilities::MPI::min(least, state.partition()->communicator(), least);
        mass_per_area = 1. / (1. / least[0] + 1. / least[1]);
        if (least[2] == 0.)
          value = 0.;
      }
      const double allowed = law.stiffness(share * mass_per_area, clock.stable_step);
      value = value > 0. ? std::min(value, allowed) : allowed;
    }

    /** Lists what is kept from step to step, of nodes of these faces, which are referred to; @p
     * continues: a run that starts from the end of another has its stiffness. */
    void list(Records &records, const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
              const bool continues)
    {
      const auto number = [](double &area) -> double & { return area; };
      records.value("mass per area", mass_per_area);
      auto &stiffness_record = records.value("stiffness", value);
      if (continues)
        stiffness_record.continues();
      records.at_nodes(slaves.owned_nodes(), slave_areas).numbers("areas of the slave", number);
      records.at_nodes(masters.owned_nodes(), master_areas).numbers("areas of the master", number);
    }

  private:
    /** Masses per area are found again every so many steps. */
    static constexpr unsigned long steps_between_masses = 16;

    /** The least mass over area of these nodes. */
    static double least_mass_per_area(const std::vector<unsigned int> &nodes,
                                      const std::vector<double> &areas, const NodalVector &mass)
    {
      double least = std::numeric_limits<double>::max();
      for (std::size_t k = 0; k < nodes.size(); ++k)
        if (*mass.node(nodes[k]) > 0. && areas[k] > 0.)
          least = std::min(least, *mass.node(nodes[k]) / areas[k]);
      return least;
    }
  };

  /** The data of a slave node from step to step. The normal is out of the master. */
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
     * another starts with those from there. */
    static void list(Records &records, const std::vector<unsigned int> &nodes,
                     std::vector<MortarHistory> &histories, const bool continue_them)
    {
      using History = MortarHistory;
      auto columns = records.at_nodes(nodes, histories);
      columns
          .numbers(
              "stiffness, depth, damping force",
              [](History &h) -> double & { return h.spring.stiffness; },
              [](History &h) -> double & { return h.spring.depth; },
              [](History &h) -> double & { return h.spring.damping_force; })
          .numbers("gap, area, offset", &History::gap, &History::area, &History::offset)
          .vector(
              "elastic slip", [](History & h) -> auto & { return h.spring.elastic_slip; })
          .vector("traction", &History::traction)
          .vector("normal", &History::normal)
          .numbers("is bonded", &History::is_bonded);
      if (continue_them)
        columns.continues();
    }

    /** Those of @p former owned nodes become those of owned @p nodes. Returns the energy of the
     * springs of nodes that are gone [M L^2/T^2]. */
    static double move(const std::vector<unsigned int> &former,
                       const std::vector<unsigned int> &nodes,
                       std::vector<MortarHistory> &histories)
    {
      double cut = 0;
      const std::vector<MortarHistory> before = std::move(histories);
      histories.assign(nodes.size(), {});
      for (std::size_t k = 0; k < former.size(); ++k)
      {
        const auto found = std::lower_bound(nodes.begin(), nodes.end(), former[k]);
        if (found != nodes.end() && *found == former[k])
          histories[static_cast<std::size_t>(found - nodes.begin())] = before[k];
        else
          cut += before[k].area * before[k].spring.elastic_energy();
      }
      return cut;
    }

    /** After a change from positions @p before without a motion (ghosts current): springs are
     * deeper by as much as the gap is smaller, and new overlaps have no force. Collective. */
    static void place(const NodalVector &before, const NodalVector &position,
                      const std::vector<unsigned int> &nodes, MortarSegments<dim> &segments,
                      std::vector<MortarHistory<dim>> &histories)
    {
      const auto gap_at = [&](const unsigned int node, Tensor<1, dim> &normal)
      {
        return segments.find_normal(node, normal)
                   ? std::optional<double>(
                         -(vector_of<dim>(segments.sums().gap.node(node)) * normal) /
                         segments.area_of(node))
                   : std::nullopt;
      };
      Tensor<1, dim> normal;
      std::vector<std::optional<double>> gaps;
      segments.gather(before, before, nullptr);
      for (const unsigned int node : nodes)
        gaps.push_back(gap_at(node, normal));
      segments.gather(position, position, nullptr);
      for (std::size_t k = 0; k < nodes.size(); ++k)
      {
        MortarHistory<dim> &history = histories[k];
        const auto gap = gap_at(nodes[k], normal);
        if (!gap || !gaps[k])
          continue; // the next forces release it
        ContactSpring<dim> &spring = history.spring;
        if (spring.is_closed())
        {
          spring.elastic_slip = rotated_tangent(spring.elastic_slip, history.normal, normal);
          spring.depth = std::max(0., spring.depth + *gaps[k] - *gap);
          history.area = segments.area_of(nodes[k]);
        }
        else
          history.offset = std::max(history.offset, -*gap);
        history.normal = normal;
        history.gap += *gap - *gaps[k];
      }
    }
  };

  /** The law of a section "Body contact: NAME". */
  struct MortarSettings : FrictionSettings
  {
    /** Of a pairing that @p is_tied or not. Throws InputError. */
    MortarSettings(const Entries &e, bool is_tied = false, bool has_heat = true);

    /** Whether heat passes from one body to the other. */
    bool conducts() const
    {
      return conductance.largest() > 0.;
    }

    /** Whether the temperatures of the surfaces are needed. */
    bool needs_temperature() const
    {
      return has_heat &&
             (conducts() || bonding_temperature || !friction.is_constant() || splits_by_effusivity);
    }

    /** The largest traction along the surface at a pressure and a mean temperature of both sides:
     * Coulomb's, and the limit of shear [M/(L T^2)]. */
    double largest_traction(const double pressure, const double temperature) const
    {
      return std::min(friction.value(temperature) * pressure, shear_limit);
    }

    bool resolves_overlap = false; ///< the overlap at the start is without force
    double stiffness;              ///< α: of the mass over the square of the stable step
    ContactLaw law;                ///< with dampers
    ContactLaw bond;               ///< the same springs without
    TemperatureTable conductance;  ///< h over the pressure [M/(T^3 K)]
    std::optional<double> bonding_temperature;
  };

  /**
   * Contact between the surfaces of two bodies by penalty springs. Each slave node I has the
   * normalized gap, with the weights of a Pairing and the averaged normal n_I,
   *
   * @verbatim
   *   g_I = n_I · (Σ_L w^m_IL x_L - Σ_J w^s_IJ x_J) / A_I,   p_I = κ <-g_I> + damping
   * @endverbatim
   *
   * p is a pressure, and κ the same everywhere, so that a uniform pressure passes through any two
   * meshes. Forces are the transpose: Σ_I w^s_IJ t_I on the slave, -Σ_I w^m_IL t_I on the master.
   * By Jensen's inequality these springs add at most α/Δt² to the square of any frequency of the
   * bodies (κ: MortarStiffness).
   * Friction follows ContactLaw in the motion along the surface, Δs = (1 - n⊗n)(Σ_J w^s Δx -
   * Σ_L w^m Δx)/A + g Δn, which is zero in a rigid rotation. In scenes with heat the two sides
   * exchange h(p) A (θ_m - θ_s); in a step Δt this is γA (1 - exp(-hΔt/γ)) (θ_m - θ_s) with the
   * heat capacity per area of both sides in series, 1/γ = 1/γ_s + 1/γ_m: no step is limited.
   */
  template <int dim>
  class MortarContact
  {
  public:
    using Selector = typename ContactFaces<dim>::Selector;
    using IsGone = typename ContactFaces<dim>::IsGone;

    /** Has the faces that the selectors choose. Throws InputError where a side has none, or where
     * the bodies overlap at the start, or tied ones are apart. Collective. */
    MortarContact(const Section &section, std::unique_ptr<const Pairing<dim>> pairing,
                  bool has_heat, const Nodes<dim> &nodes, const NodalState &state,
                  const Selector &is_slave, const Selector &is_master);

    /** Translates node numbers to those of @p partition. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Finds the faces of the cells that are left, and removes the springs of nodes without faces.
     * Not of tied surfaces. */
    void renew_faces(const Nodes<dim> &nodes, const Selector &is_slave, const Selector &is_master,
                     const IsGone &is_gone)
    {
      const std::vector<unsigned int> former_nodes = slaves.owned_nodes();
      slaves = ContactFaces<dim>(nodes, is_slave, is_gone);
      masters = ContactFaces<dim>(nodes, is_master, is_gone);
      stiffness.mass_per_area = 0.;
      set_partition(std::shared_ptr<const NodePartition>(traction.partition()));
      totals.damping += NodeHistory::move(former_nodes, slaves.owned_nodes(), histories);
    }

    /** See ModelSignals::nodes_placed. Positions have ghosts. Not of tied surfaces. Collective. */
    void place_nodes(const NodalVector &before, const NodalVector &position)
    {
      NodeHistory::place(before, position, slaves.owned_nodes(), segments, histories);
    }

    /** Adds the forces at t_n to @p loads, and heat since the step before to @p heat (scalar; null
     * without heat); ghosts of both are not collected. @p last_position are the positions at
     * t_{n-1}. Collective. */
    void add_forces(const NodalState &state, const NodalVector &last_position, const Clock &clock,
                    const NodalHeat &nodal_heat, NodalVector &loads, NodalVector *heat);

    /** Adds the impulse of the forces at t_n over Δt_n, which is determined only after them. */
    void complete_step(const Clock &clock)
    {
      totals.add_impulse(clock.velocity_step());
    }

    /** Of owned slave nodes. */
    const std::vector<MortarHistory<dim>> &node_histories() const
    {
      return histories;
    }

    /** See ModelSignals::trials. */
    void become_static(const double tolerance)
    {
      touch_distance = tolerance;
      settings.law = settings.bond = settings.bond.without_rates();
    }

    /** The stiffness of the springs; add_forces() calls it in explicit steps only. Collective. */
    void find_stiffness(const NodalState &state, const Clock &clock)
    {
      const bool touches =
          std::any_of(histories.begin(), histories.end(),
                      [](const NodeHistory &history) { return history.spring.is_closed(); });
      // A surface that touches itself presses from both of its sides.
      stiffness.find(state, clock, settings.law, is_one_surface ? 0.5 : 1., touches, slaves,
                     masters);
    }

    /** The fraction of the stable step of the bodies at which they are stable with the contact. */
    double stable_fraction() const
    {
      return (pairing->is_tied() ? settings.bond : settings.law).stable_fraction();
    }

    /** Sums over ranks; forces are those on the slave. There are no torques. Collective. */
    ContactBalance balance() const;

    /** Mean and largest temperature of slave nodes in contact, in slot 0 of @p slave_temperature,
     * or where that is null of the master below them in the last step; zero without. Collective. */
    std::array<double, 2> temperatures_in_contact(const NodalVector *slave_temperature) const
    {
      using Segments = MortarSegments<dim>;
      std::vector<double> values;
      for (std::size_t k = 0; k < histories.size(); ++k)
      {
        if (!histories[k].spring.is_closed())
          continue;
        const unsigned int node = slaves.owned_nodes()[k];
        const double *const sums = segments.sums().scalars.node(node);
        if (slave_temperature != nullptr)
          values.push_back(*slave_temperature->node(node));
        else if (sums[Segments::area] > 0.)
          values.push_back(
              (sums[Segments::mean_temperature] + 0.5 * sums[Segments::temperature_difference]) /
              sums[Segments::area]);
      }
      return mean_and_largest(values, communicator);
    }

    const std::string &name() const
    {
      return contact_name;
    }
    const MortarSettings &contact_settings() const
    {
      return settings;
    }
    bool is_tied() const
    {
      return pairing->is_tied();
    }
    const MortarSegments<dim> &mortar_segments() const
    {
      return segments;
    }
    const ContactFaces<dim> &slave_faces() const
    {
      return slaves;
    }
    const ContactFaces<dim> &master_faces() const
    {
      return masters;
    }

    /** The data kept from step to step. A run that starts from the end of another begins with the
     * springs that the contact of this name had there. */
    Records records;

  private:
    using NodeHistory = MortarHistory<dim>;

    /** Data of a step for all nodes. */
    struct Step
    {
      double time_step;
      double stable_step;
      double mass; ///< per area, that of a spring κ at the stable step [M/L^(dim-1)]
    };

    /** Finds the gaps at the start, and refuses or accepts them. Collective. */
    void start(const Section &section, const Nodes<dim> &nodes, const NodalState &state);
    /** Null where no temperature is needed. Collective. */
    const NodalVector *find_thermal(const NodalHeat &nodal_heat);
    /** The traction of a slave node. */
    void advance_node(std::size_t k, const Step &step, NodalVector *heat);
    void press(NodeHistory &history, unsigned int node, const dealii::Tensor<1, dim> &motion,
               const Step &step);
    /** The same of a tied node, with its mean @p gap vector. */
    void hold(NodeHistory &history, const dealii::Tensor<1, dim> &gap, const Step &step);
    /** Heat of friction of the spring along the surface stays at the slave node. */
    void release(NodeHistory &history, const unsigned int node,
                 const dealii::Tensor<1, dim> &motion, NodalVector *const heat)
    {
      double dissipated = 0;
      const double friction =
          history.area * settings.law.release(ContactMotion<dim>(0., motion, history.normal),
                                              history.spring, dissipated);
      totals.damping += history.area * dissipated;
      totals.friction += friction;
      if (heat != nullptr)
        *heat->node(node) += friction;
    }
    void conduct(const NodeHistory &history, unsigned int node, double time_step);
    /** The share of the slave in the heat of friction at a slave node. */
    double heat_fraction(const unsigned int node) const
    {
      if (!settings.splits_by_effusivity)
        return settings.heat_fraction;
      const double *const effusivities = segments.sums().effusivity.node(node);
      return effusivities[0] / (effusivities[0] + effusivities[1]);
    }
    /** A sum of MortarSegments over the area of the node. */
    double mean(const unsigned int node, const unsigned int which) const
    {
      const double *const sums = segments.sums().scalars.node(node);
      return sums[which] / sums[MortarSegments<dim>::area];
    }

    MPI_Comm communicator;
    std::unique_ptr<const Pairing<dim>> pairing;
    MortarSettings settings;
    std::string contact_name;
    ContactFaces<dim> slaves, masters;
    bool is_one_surface = false; ///< whether both sides have the same faces
    MortarSegments<dim> segments;
    std::vector<NodeHistory> histories; ///< of owned slave nodes
    MortarStiffness<dim> stiffness;
    NodalVector traction, heat_flow, thermal;
    ContactSums<dim> totals;   ///< of this rank
    double touch_distance = 0; ///< what is nearer touches; zero in explicit steps [L]
  };

  extern template class MortarContact<2>;
  extern template class MortarContact<3>;
} // namespace tombolo
