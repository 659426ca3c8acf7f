// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/particles/part_boundary.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/formulations/particles/zero_energy_stabilization.h>
#include <tombolo/formulations/plastic_heating.h>

#include <deal.II/base/tensor.h>

#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The particle method of Pan et al. 2019 (doc/method.md, sections 2 and 6): moving least squares
   * shape functions on cuboidal supports, direct nodal integration with one point at every node,
   * momentum-consistent smoothing (done by the bridge). Stress, strain and force are those of eqs
   * (13), (5), (16), with gradients carried from the kernel's reference to the present by F_I = Σ_J
   * x_J ⊗ ∇φ_J.
   */
  template <int dim>
  class MomentumConsistentParticle : public ParticleFormulation<dim>
  {
  public:
    explicit MomentumConsistentParticle(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);

    unsigned int degree() const override;
    double cost_per_cell(const Material &material, double box_ratio) const override;
    void initialize(const PartSetup<dim> &setup) override;
    dealii::IndexSet required_nodes() const override;
    std::vector<MirrorNode> required_images() const override;
    void set_partition(const NodePartition &partition) override;
    void add_mass(NodalVector &mass) const override;
    void add_internal_force(const MechanicalInput &input, NodalVector &force) override;
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 double time_step, NodalVector &force) const override;
    StepLimit courant_limit(const NodalVector &position) const override;
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void scale_inertia(const std::vector<double> &factors) override;
    EnergyAccounts energies() const override;
    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override;
    StepLimit diffusion_limit(const NodalVector &position) const override;
    void add_plastic_heat(NodalVector &heat) override;
    double pending_plastic_heat() const override;
    NeighbourhoodChange update_neighbourhoods(const NodalVector &position) override;
    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &points) const override;
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override;
    const MaterialPoints &points() const override;
    MaterialPoints &points() override;
    const Material &material() const override;
    unsigned int n_cells() const override;
    unsigned int n_points_per_cell() const override;
    void serialize(StateArchive &archive) override;
    void complete_reading(NodalVector &buffer) override;
    std::size_t memory_consumption() const override;

    Stencils &stencils() override;
    SmoothingSettings smoothing() const override;
    double smallest_spacing() const override;
    NeighbourCounts neighbour_counts() const override;
    const GradientConsistency *gradient_consistency() const override;
    BondCounts bond_counts() const override;
    FragmentCounts fragment_counts() const override;
    void forget_fragments() override;
    void add_self_contact(const MechanicalInput &input, const NodalVector &element_mass,
                          NodalVector &loads, std::vector<unsigned int> &loaded_nodes) override;
    double stable_fraction(double stable_step) const override;
    void add_particles(const CellSelection<dim> &is_taken, const NodalVector &position,
                       const StateTransfer *state) override;
    bool can_add_particles() const override
    {
      return true;
    }
    bool has_broken_bonds() const override
    {
      return bonds != nullptr && bonds->any();
    }
    std::vector<unsigned int> debris() const override;
    LeavingParticles take_leaving_particles() override;
    void set_before_change(const std::function<void()> &before_change) override;
    dealii::Point<dim> support(unsigned int i) const override;

  private:
    /** Finds the particles of these cells on this rank, and what they are given by cells. */
    void collect_particles(const CellSelection<dim> &is_taken);
    /** Makes room for the state of the particles, as it is at the start. */
    void create_points();
    /** Of this rank's particles, node_stride each. */
    std::vector<double> spread_initial_positions() const;
    std::vector<std::uint64_t> persistent_ids() const;
    /** State of particles after there are more of them: @p old_place tells which old one each is.
     */
    void merge_points(const MaterialPoints &old_points, const std::vector<double> &old_volume,
                      const std::vector<unsigned int> &old_place, const StateTransfer &state);
    /** Makes @p position the reference of more particles: new ones get their deformation from rows
     * in the initial configuration. Collective. */
    void renew_reference(const NodalVector &position, const std::vector<unsigned int> &old_place);
    /** Refuses planes of symmetry too close to each other for the supports. Collective. */
    void check_symmetry(const Symmetry &symmetry) const;
    /** Tells self-contact, where there is some, what particles there are. Returns the number of
     * fragments that it has. Collective. */
    unsigned long tell_self_contact();
    /** Finds neighbours anew, here and on other ranks, at these positions (node_stride a particle)
     * and the present supports, and computes the shape functions. Collective. */
    void find_neighbours(const std::vector<double> &positions);
    /** Shape functions for the neighbours in place. A particle without a basis is refused at the
     * start and becomes a rigid row later. Collective. */
    void compute_shape_functions(const double *position, const double *support);
    /** Makes gradients pass the patch test, where that is chosen. @p position is where the shape
     * functions were taken, in the partition of their rows, with current ghosts. Collective. */
    void make_gradients_consistent(const NodalVector &position);
    /** The same after a search: @p positions are those of particles, node_stride each. Rows have
     * the numbers of a partition of the part's own then. Collective. */
    void make_gradients_consistent(const std::vector<double> &positions);
    /** Shape functions for the neighbours in place, in the reference that the kernel has. @p buffer
     * is a vector of positions in the partition of the rows. Collective. */
    void compute_in_reference(NodalVector &buffer);
    /** update_neighbourhoods() of the shape functions alone. Collective. */
    NeighbourhoodChange update_rows(const NodalVector &position);
    /** Checks the bonds if that is due; where any breaks, rows and shape functions change. The same
     * answer on all ranks. Collective. */
    bool break_bonds(const NodalVector &position);
    /** Takes all bonds from particles with broken ones that are not sound at @p position, until
     * none is left. Returns whether there was any, as break_bonds(). Collective. */
    bool isolate_distorted(const NodalVector &position);
    /** To be called before shape functions change, in a run and where bonds can break. */
    void prepare_change();
    /** Takes what broke out of the rows, and computes these. Collective. */
    void renew_broken_rows(const std::shared_ptr<const NodePartition> &partition);
    /** Books what became of debris. */
    void release_debris();
    /** A partition of the part's own with all that its rows need. Collective. */
    std::shared_ptr<const NodePartition> partition_of_rows() const;
    /** Makes the present configuration the reference and stretches the supports with it. */
    void follow_deformation(const NodalVector &position);
    void stretch_support(unsigned int i);
    /** Of serialize(): the rows that lost their negative values. */
    void serialize_extrapolation(StateArchive &archive);
    /** The pair residual of serialize(), with rows that are those of the search. */
    void serialize_pairs(StateArchive &archive);
    dealii::Tensor<2, dim> deformation_since_reference(unsigned int i) const;
    bool rebuild_is_due(const NodalVector &position);
    /** Calls @p use with the number of each particle and the half width of its support as the
     * present deformation would stretch it, rebuilt or not. */
    template <typename Use>
    void for_present_supports(const NodalVector &position, const Use &use) const;

    /** Of a new particle, in a list of places of old ones. */
    static constexpr unsigned int is_new_particle = static_cast<unsigned int>(-1);

    Section section;
    PartSetup<dim> setup;
    double dilation;
    SmoothingSettings smoothing_settings;
    bool has_consistent_gradients;
    bool shares_rows;
    double gradient_tolerance = 0;
    BulkViscosity bulk_viscosity;
    PlasticHeating plastic_heating;
    ZeroEnergyStabilization zero_energy_stabilization;
    std::unique_ptr<Bonds<dim>> bonds;              ///< null: they do not break
    std::unique_ptr<SelfContact<dim>> self_contact; ///< null: fragments do not feel each other
    FormerRows former_rows;                         // only during an update
    std::vector<unsigned int> rows_to_change;       // between serialize() and complete_reading()
    std::function<void()> before_change;
    enum class Configuration
    {
      total_lagrangian,
      updated_lagrangian,
      current
    } configuration;
    unsigned int rebuild_interval = 0;
    double rebuild_deformation = 0;
    unsigned int steps_since_rebuild = 0;
    bool has_started = false;

    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    bool has_points = true;
    MPI_Comm communicator = MPI_COMM_NULL;
    dealii::types::global_dof_index n_global_nodes = 0;

    Stencils shape;
    Neighbourhoods<dim> neighbourhoods;
    MovingLeastSquares<dim> moving_least_squares;
    GradientConsistency consistency;
    PartBoundary<dim> boundary;     // for consistent gradients only, as the next two
    std::vector<bool> has_unit_row; // of Φ, by particle: its motion is prescribed
    bool trace_bridge = false;
    dealii::IndexSet owned_nodes;
    std::shared_ptr<const Symmetry> symmetry;
    MaterialPoints material_points;
    double smallest_spacing_at_start = 0; ///< of all that can be particles of the part [L]
    double spacing = 0; ///< smallest initial distance to a neighbouring node along an axis [L]

    // Per particle of this rank, in the order of rows.
    std::vector<dealii::types::global_dof_index> particle_global;
    std::vector<dealii::Point<dim>> initial_positions;
    std::vector<double> initial_volume;                   ///< m̂ / ρ₀ [L^dim]
    std::vector<double> inertia_factors;                  ///< empty: one
    std::vector<double> initial_support, present_support; ///< node_stride each [L]
    std::vector<double> present_position; ///< at the last rebuild, node_stride each [L]
    std::vector<dealii::Tensor<2, dim>> reference_deformation; ///< F of the kernel's reference

    NodalVector support_of_node; ///< half widths, with those of ghosts [L]
  };
} // namespace tombolo
