// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/clock.h>
#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/contact_heat.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/implicit_friction.h>
#include <tombolo/contact/outward_areas.h>
#include <tombolo/contact/part_surface.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace tombolo
{
  /** Of what a contact of nodes with a surface is made. */
  template <int dim>
  struct ContactScene
  {
    /** Declares the section "Contact: NAME" of a contact with a rigid surface. */
    static void declare(const Entries &e);

    /** Reads the section, and refuses what is wrong without regard to the mesh. */
    static void validate(const Section &section, bool has_heat);

    /** The surface that the section names. Throws InputError. */
    static std::unique_ptr<ContactSurface<dim>> create_surface(const Section &section);

    /** Throws an InputError where these owned nodes are deeper in something than round-off, each by
     * its entry of @p depths [L]: the text of @p message about the depth of the deepest node of all
     * ranks and of the node, "the node with the number 3 at (1, 2)". Collective. */
    static void
    refuse_depth(const Nodes<dim> &nodes, const NodalState &state,
                 const std::vector<unsigned int> &candidates, const std::vector<double> &depths,
                 const std::function<std::string(const std::string &depth, const std::string &node)>
                     &message);

    Section section;
    const Mesh<dim> &mesh;
    const Nodes<dim> &nodes;
    const NodalState &state;
    /** An entry per owned node: particles, and nodes of cells that erode or become particles. */
    std::vector<bool> can_be_exposed;
    bool has_heat = false; ///< contacts add it to nodes (NodalHeat)
    /** The initial one of each owned node, where areas are needed: for heat, for a limit of shear
     * and where the surface is that of a part. */
    std::vector<double> volume;
    MasterPart<dim> master; ///< whose own nodes are no candidates

    /** The boundaries of the section; none for the whole surface. Throws InputError. */
    std::set<dealii::types::boundary_id> boundaries() const;

    /** The owned nodes (local numbers, ascending) that a contact can touch: those on faces of
     * @p boundaries or, where the section names none, of the whole surface of the mesh and all that
     * can be exposed. Throws InputError where there is none on any rank. Collective. */
    std::vector<unsigned int>
    candidates(const std::set<dealii::types::boundary_id> &boundaries) const;

    /** Throws the InputError of a @p surface with a mass that would leave a plane of symmetry. */
    void refuse_motion_out_of_mirrors(ContactSurface<dim> &surface) const;
  };

  /** The force of a rigid surface on a node, and where that was at the end of the step before. */
  template <int dim>
  struct SurfaceHistory
  {
    dealii::Tensor<1, dim> force;    ///< f [M L/T^2]
    dealii::Tensor<1, dim> position; ///< x [L]
  };

  /**
   * Contact of nodes with a surface, rigid or that of a part, the section "Contact: NAME": the
   * nodes that can touch, the heat of friction and of the tool, impulses, energies. How the forces
   * on nodes behind the surface are found is up to the classes derived from this one, which the
   * entry `Method` selects. Works of friction, damping and of the motion of the surface are
   * computed from the motion of the nodes, not from the forces on them, so that the balance of
   * energy verifies the consistency of the two.
   *
   * Every rank treats its own nodes. Owned numbers of nodes never change in a run.
   */
  template <int dim>
  class SurfaceContact
  {
  public:
    virtual ~SurfaceContact() = default;

    /** Finds the candidate nodes: those of the surface of the mesh and, if no boundary is named,
     * all that can be exposed. Throws InputError where there is none, or where one is behind the
     * surface at the start. Collective. */
    explicit SurfaceContact(ContactScene<dim> &scene);

    /** Translates node numbers to those of @p partition. Collective. */
    virtual void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      if (areas)
        areas->set_partition(partition);
      if (part)
        part->set_partition(*partition);
    }

    /** The faces on which candidates touch; null where areas are not needed. */
    OutwardAreas<dim> *faces()
    {
      return areas.get();
    }

    /** Finds the faces of the cells that are left; set_partition() must follow. */
    virtual void renew_faces(const Nodes<dim> &nodes,
                             const typename OutwardAreas<dim>::IsVoid &is_gone)
    {
      if (areas)
        areas->select_faces(nodes, is_gone);
    }

    /** Adds the forces on nodes in contact in the positions at t_n to owned nodes of @p loads, and
     * these nodes to @p loaded_nodes; friction can need @p nodal_heat. Collective. */
    virtual void add_forces(const NodalState & /*state*/, const Clock & /*clock*/,
                            NodalVector & /*loads*/, std::vector<unsigned int> & /*loaded_nodes*/,
                            const NodalHeat & /*nodal_heat*/ = {})
    {}

    /** See ModelSignals::nodes_move. Positions have ghosts. Collective. */
    virtual void keep_outside(const Clock &clock, const NodalVector &slides,
                              const NodalVector &from, NodalVector &position, NodalVector &is_bound)
    {
      std::vector<double> was, is;
      find_gaps(from, candidates, clock.time, was);
      find_gaps(position, candidates, clock.time, is);
      surface->push_out(candidates, was, is, clock.time, slides, from, position, is_bound);
    }

    /** See ModelSignals::nodes_placed. Collective. */
    virtual void place_nodes(const NodalState &state, const NodalVector &before, const Clock &)
    {
      for (std::size_t k = 0; k < candidates.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          histories[k].position[d] +=
              state.position.node(candidates[k])[d] - before.node(candidates[k])[d];
    }

    /** The yield stress at owned nodes, where it limits the shear: it is referred to. */
    void set_yield_stress(const std::vector<double> &nodal_stress)
    {
      yield_stress = &nodal_stress;
    }

    /** See ModelSignals::trials. */
    void become_static(const double tolerance)
    {
      settings.law = settings.law.without_rates();
      touch_distance = tolerance;
    }

    /** Sets the motion over the last step to zero. Collective. */
    virtual void reset_motion(const NodalState &state)
    {
      for (std::size_t k = 0; k < candidates.size(); ++k)
        histories[k].position = vector_of<dim>(state.position.node(candidates[k]));
      if (part)
        part->reset_motion(state);
    }

    /** Adds how the last forces change with positions. Collective. */
    virtual void find_stiffness(const NodalState & /*state*/, const Clock & /*clock*/,
                                std::vector<ContactStiffness<dim>> & /*result*/)
    {}

    /** Adds h A Δt of the nodes in contact to owned nodes of @p exposure (scalar). */
    void add_exposure(NodalVector &exposure) const
    {
      if (heat)
        heat->add_exposure(exposure);
    }

    /** Exchanges heat of nodes and tool after the forces of all contacts at t_n. Collective. */
    void exchange_heat(const NodalHeat &nodal_heat)
    {
      if (heat)
        heat->exchange(nodal_heat, communicator);
    }

    /** Adds the impulse of the forces at t_n over Δt_n, which is determined only after them, and
     * accelerates a surface with a mass by it. Collective. */
    void complete_step(const Clock &clock);

    /** A surface with a mass from t_n to t_{n+1}. */
    void advance(const Clock &clock)
    {
      if (surface->translation().has_mass())
        surface->translation().advance(clock);
    }

    /** The fraction of the stable step of the bodies at which they are stable with the contact. */
    virtual double stable_fraction() const
    {
      return 1.;
    }

    const ContactSettings &contact_settings() const
    {
      return settings;
    }
    /** Which entries of the balance this contact has. */
    bool conducts() const
    {
      return heat && heat->conducts();
    }
    /** Whether the surface is that of a part: works and heat of both sides are those of bodies. */
    bool is_with_part() const
    {
      return part != nullptr;
    }
    const PartLayer<dim> &nodes_of_part() const
    {
      return part->nodes_of_part();
    }
    /** Whether nodes have areas, those in contact and debris. */
    bool has_areas() const
    {
      return areas != nullptr;
    }
    bool has_tool_temperature() const
    {
      return heat && heat->has_tool_temperature();
    }
    bool has_tool_mass() const
    {
      return surface->translation().has_mass();
    }

    /** The data kept from step to step. */
    Records records;

    /** Owned nodes on which it acted at t_n. */
    std::vector<unsigned int> nodes_in_contact() const
    {
      std::vector<unsigned int> result;
      for (std::size_t k = 0; k < candidates.size(); ++k)
        if (histories[k].force.norm_square() > 0.)
          result.push_back(candidates[k]);
      return result;
    }

    /** Adds the forces at t_n on nodes in contact to owned nodes of @p forces, for pictures. */
    void add_present_forces(NodalVector &forces) const
    {
      for (std::size_t k = 0; k < candidates.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          forces.node(candidates[k])[d] += histories[k].force[d];
    }

    /** Sums over ranks. Collective. */
    ContactBalance balance(MPI_Comm communicator) const;

    /** Mean and largest temperature of the part below, where it conducts. Collective. */
    std::array<double, 2> temperatures_of_part() const
    {
      return heat->temperatures_of_part(communicator);
    }

    /** The gaps of these nodes, of balls of the radius of the contact around them. */
    void find_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                   const double time, std::vector<double> &gaps) const
    {
      surface->evaluate_gaps(position, nodes, time, gaps);
      for (double &node_gap : gaps)
        node_gap -= settings.radius;
    }

    /** Gaps up to this distance [L] are needed, beside those of the contact. */
    void require_gaps(const double distance) const
    {
      surface->set_reach(std::max(distance, settings.radius));
    }
    const std::string &name() const
    {
      return contact_name;
    }

    /** From now on the heat of friction is distributed to nodes around those that touch: the result
     * is to be kept up to date (HeatedFriction). */
    SpreadFriction &spread_friction()
    {
      spread = std::make_unique<SpreadFriction>();
      return *spread;
    }

    const std::vector<unsigned int> &candidate_nodes() const
    {
      return candidates;
    }
    /** The stiffness of a spring in E V^((dim-2)/dim), the PFAC of Fraser et al. (eq. 10) against a
     * rigid surface: of a node with the volume V = @p spacing^dim of a material with @p
     * squared_bar_speed E/ρ, at the stable step @p stable_step. */
    double stiffness_over_modulus(double spacing, double squared_bar_speed,
                                  double stable_step) const
    {
      return settings.law.stiffness(spacing * spacing, stable_step) / squared_bar_speed;
    }
    const ContactSurface<dim> &contact_surface() const
    {
      return *surface;
    }

  protected:
    using NodeHistory = SurfaceHistory<dim>;

    /** Adds what the nodes of this rank store, how many are in contact, and the deepest. */
    virtual void add_node_sums(ContactBalance &shares) const = 0;

    /** Clears the sums over the forces of the step before. Returns whether there is one: at the
     * start there is no contact. Collective. */
    bool begin_forces(const NodalState &state, const Clock &clock, const NodalHeat &nodal_heat);
    /** The present @p force on a candidate at @p x, where the surface has moved by @p
     * surface_motion: records works and, where it @p touches, puts the force on the node. */
    void set_force(std::size_t candidate, const dealii::Tensor<1, dim> &x,
                   const dealii::Tensor<1, dim> &force,
                   const dealii::Tensor<1, dim> &surface_motion, bool touches, NodalVector &loads,
                   std::vector<unsigned int> &loaded_nodes);
    /** The area on which a candidate touches across @p normal out of the tool: its outward area
     * along the normal, and inside of the body, or once it is separated, V^((dim-1)/dim) of its
     * initial volume; zero where areas are not needed [L^(dim-1)]. */
    double area(const std::size_t candidate, const dealii::Tensor<1, dim> &normal) const
    {
      const unsigned int node = candidates[candidate];
      return !areas                  ? 0.
             : areas->has_face(node) ? -(areas->area(node) * normal)
                                     : inner_areas[candidate];
    }
    /** A candidate in contact on @p area with the @p normal_force on it. */
    void add_contact(const std::size_t candidate, const double normal_force, const double area,
                     const Clock &clock)
    {
      totals.area += std::max(area, 0.);
      if (heat)
        heat->add_contact(candidate, normal_force, area, clock.previous_step);
    }
    /** The largest force along the surface at a candidate with this @p area. */
    double shear_limit(const std::size_t candidate, const double area) const
    {
      if (settings.shears_at_yield)
        return (*yield_stress)[candidates[candidate]] * std::max(area, 0.) / std::sqrt(3.);
      return settings.limits_shear() ? settings.shear_limit * std::max(area, 0.)
                                     : settings.shear_limit;
    }
    /** Finds areas in these positions before begin_forces(), where they limit forces or determine
     * sides, and where a part is. Collective. */
    void find_surroundings(const NodalState &state)
    {
      if (settings.limits_shear() || part)
        areas->update(state.position);
      if (part)
      {
        part->follow(state);
        part->find_sides(state.position, candidates);
      }
    }
    /** Finds areas after begin_forces(), or only those of owned @p nodes. Collective. */
    void find_areas(const NodalState &state, const std::vector<unsigned int> *const nodes = nullptr)
    {
      if (areas && !part)
        areas->update(state.position, nodes);
    }
    /** Coulomb's coefficient at a candidate, with the heat received. */
    double friction_coefficient(const std::size_t candidate, const NodalHeat &nodal_heat) const
    {
      if (settings.friction.is_constant() || !(settings.friction.largest() > 0.))
        return settings.friction.largest();
      const unsigned int node = candidates[candidate];
      const auto present = [&] { return nodal_heat.temperature_of(node); };
      return spread ? spread->at(node, settings.friction, present)
                    : settings.friction.value(present());
    }

    /** Over which curvature_stiffness() compares normals: not so short that an edge between facets
     * becomes a spring of its own [L]. */
    double way_along_surface() const
    {
      return 1e5 * touch_distance;
    }
    void add_friction_heat(const std::size_t candidate, const double sliding_heat,
                           const NodalHeat &nodal_heat)
    {
      totals.friction += sliding_heat;
      const double body_heat = heat ? heat->add_friction(candidate, sliding_heat, nodal_heat) : 0.;
      if (spread)
        *spread->heat.node(candidates[candidate]) += body_heat;
    }

    /** Adds to the surface its share of the heat of friction since begin_forces(). */
    void end_forces()
    {
      if (heat)
        heat->end_forces(totals.friction - friction_before);
    }

    MPI_Comm communicator;
    ContactSettings settings;
    std::unique_ptr<ContactSurface<dim>> surface;
    std::vector<unsigned int> candidates;              ///< owned nodes
    std::vector<NodeHistory> histories;                ///< of each of them
    std::vector<double> gap;                           ///< buffer
    ContactSums<dim> totals;                           ///< of this rank
    PartSurface<dim> *part = nullptr;                  ///< the surface, where it is that of a part
    std::unique_ptr<ContactHeat<dim>> heat;            ///< null without heat
    const std::vector<double> *yield_stress = nullptr; ///< null where no limit needs it
    double touch_distance = 0;              ///< what is nearer touches; zero in explicit steps [L]
    std::unique_ptr<SpreadFriction> spread; ///< null where the heat of a node stays there

  private:
    std::string contact_name;
    dealii::Tensor<1, dim> translation;       ///< of the surface as a whole in the last step [L]
    double friction_before = 0;               ///< heat of friction before the forces of this step
    std::unique_ptr<OutwardAreas<dim>> areas; ///< of faces; null where nothing needs them
    std::vector<double> inner_areas;          ///< of candidates; likewise
  };

  /** Contact by springs at nodes, and by those of faces with a surface: `penalty`, `surface`. Throw
   * InputError. Collective. */
  template <int dim>
  std::unique_ptr<SurfaceContact<dim>> make_penalty_contact(ContactScene<dim> &scene);
  template <int dim>
  std::unique_ptr<SurfaceContact<dim>> make_face_contact(ContactScene<dim> &scene);

  /** Contact by penalty springs: each candidate node has a spring of ContactLaw, whether its depth
   * is that of the node or a mean over its faces. */
  template <int dim>
  class SpringContact : public SurfaceContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    explicit SpringContact(ContactScene<dim> &scene);

    /** That of ContactLaw, for nodes that one surface presses. */
    double stable_fraction() const override
    {
      return this->settings.law.stable_fraction();
    }

    /** Springs in contact are deeper by as much as their nodes are. */
    void place_nodes(const NodalState &state, const NodalVector &before,
                     const Clock &clock) override;

  protected:
    using typename SurfaceContact<dim>::NodeHistory;

    /** Moves the spring of a candidate of this @p mass, with friction and heat. Its @p area that is
     * pressed bears the @p share of its force. */
    void press(std::size_t candidate, const ContactMotion<dim> &move, double mass, double area,
               double share, const Clock &clock, const NodalHeat &nodal_heat);
    /** Coulomb's coefficient c with the heat of this step, heat_of(c). */
    template <typename HeatOf>
    double implicit_friction(const std::size_t candidate, const NodalHeat &nodal_heat,
                             const HeatOf &heat_of) const
    {
      if (this->settings.friction.is_constant() || this->spread)
        return this->friction_coefficient(candidate, nodal_heat);
      const unsigned int node = this->candidates[candidate];
      const double enthalpy = nodal_heat.enthalpy_of(node);
      const double share = this->heat->share_of_body(candidate, nodal_heat);
      return implicit_coefficient(
          this->settings.friction, nodal_heat.enthalpy->temperature(node, enthalpy),
          [&](const double coefficient) {
            return nodal_heat.enthalpy->temperature(node, enthalpy + share * heat_of(coefficient));
          });
    }
    /** Ends the contact of a candidate after the motion @p move. */
    void release(const std::size_t candidate, const ContactMotion<dim> &move,
                 const NodalHeat &nodal_heat)
    {
      this->add_friction_heat(
          candidate, this->settings.law.release(move, springs[candidate], this->totals.damping),
          nodal_heat);
    }

    /** The ratio of m̂ to the mass in springs and dampers, for the @p mass of all nodes in contact
     * on this rank. Collective where the surface has a mass. */
    double mass_ratio(const double mass) const
    {
      const double tool_mass = this->surface->translation().mass();
      return tool_mass == 0. ? 1. : 1. + ordered_sum(mass, this->communicator) / tool_mass;
    }

    /** How deep candidates are at these positions, negative where they are outside. Collective. */
    virtual std::vector<double> depths_at(const NodalVector &position, const Clock &clock) = 0;

    void add_node_sums(ContactBalance &shares) const override
    {
      for (const ContactSpring<dim> &spring : springs)
      {
        shares.elastic += spring.elastic_energy();
        shares.n_nodes += spring.is_closed() ? 1. : 0.;
        shares.penetration = std::max(shares.penetration, spring.depth);
      }
    }

    std::vector<ContactSpring<dim>> springs; ///< of each candidate

  private:
    /** Of all closed springs of all ranks; very large where there is none. Collective. */
    double mean_stiffness() const;

    /** Of a mesh that was divided: springs of new nodes are as stiff as those around them, those of
     * all nodes are shared out by their masses, and they are as deep as nodes were. Collective. */
    void close_springs(const NodalState &state, StateArchive &archive);
  };

  extern template class SurfaceContact<2>;
  extern template class SurfaceContact<3>;
} // namespace tombolo
