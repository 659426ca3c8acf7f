// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/particles/cell_averages.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/patch_test_gradients.h>

#include <deal.II/base/index_set.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /**
   * The stencils of the particles of one part, by moving least squares in the reference of their
   * kernels or by averages over cells: the search of neighbours, φ and ∇φ, gradients that pass the
   * patch test where these are chosen, equal rows kept once where that pays. After search() the
   * rows have the numbers of the search until set_partition() gives them those of a partition.
   */
  template <int dim>
  class ParticleRows
  {
  public:
    /** `Kernel` and `Dilation`. */
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError. */
    explicit ParticleRows(const Section &section);

    /** Throws the InputError of a dilation that is out of its range. */
    void check_dilation() const;
    /** Throws the InputError of consistent gradients with a kernel that is renewed at each step. */
    void check_gradients() const;

    void set_symmetry(const std::shared_ptr<const Symmetry> &symmetry);

    /** Decides which functions the particles of the part have, from now on. Returns whether they
     * are averages over cells. Throws InputError. */
    bool choose_functions(const PartSetup<dim> &setup, ParticleSet<dim> &particles);
    /** What they are, for the audit. */
    std::string functions() const;

    /** From the next search on, particles have neighbours of their own body alone, unless the
     * entry `Kernels across gaps` asks for others. @p bodies must outlive this. */
    void set_bodies(const Bodies<dim> &bodies);
    /** Takes neighbours of other bodies out of the rows of @p found, whose nodes @p partition has.
     * Collective. */
    void separate_bodies(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &found, Stencils &stencils) const;

    /** Begins with particles of these masses, which have no rows yet. */
    void reset(const std::vector<double> &masses);

    /** Finds the neighbours of @p particles at @p position with half widths @p support, node_stride
     * each, here and on other ranks. Values and gradients follow with compute_at_search().
     * Collective. */
    void search(const ParticleSet<dim> &particles, const std::vector<double> &position,
                const std::vector<double> &support);

    /** φ and ∇φ at the positions and with the supports of the last search. A particle without a
     * basis is refused before finish_start(), and becomes a rank-deficient row later.
     * Collective. */
    void compute_at_search();

    /** The same at @p position (current ghosts, the numbers of the rows), with these supports of
     * the particles, node_stride each. Collective. */
    void compute_at(const NodalVector &position, const std::vector<double> &support);

    /** The same in the reference of @p kernel. @p buffer is a vector of positions with the numbers
     * of the rows, overwritten by those of the reference. Collective. */
    void compute_in_reference(const ParticleSet<dim> &particles,
                              const KernelConfiguration<dim> &kernel, NodalVector &buffer);

    /** Makes gradients pass the patch test, where that is chosen. @p position is where the stencils
     * were computed, on the partition of their numbers, with current ghosts. Collective. */
    void make_gradients_consistent(const ParticleSet<dim> &particles,
                                   const KernelConfiguration<dim> &kernel,
                                   const NodalVector &position);
    /** The same after compute_at_search(), with the positions of the search. Collective. */
    void make_gradients_consistent(const ParticleSet<dim> &particles,
                                   const KernelConfiguration<dim> &kernel,
                                   const std::vector<double> &position);

    /** How far the rows at the start fail the patch test. @p smooths tells whether velocities are
     * smoothed by them, @p position are initial ones with current ghosts. Collective. */
    PatchTest patch_test(const PartSetup<dim> &setup, const ParticleSet<dim> &particles,
                         const KernelConfiguration<dim> &kernel, bool smooths,
                         const NodalVector &position) const;

    /** From now on a particle without a basis is not refused. */
    void finish_start();

    /** Ghosts and images that the rows need, as in Formulation. */
    dealii::IndexSet required_nodes(const ParticleSet<dim> &particles) const;
    const std::vector<MirrorNode> &required_images() const;
    void set_partition(const NodePartition &partition);
    /** Tells affine smoothing where @p particles are in the reference of @p kernel. Collective. */
    void store_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                         const std::shared_ptr<const NodePartition> &partition);
    /** A partition with what the rows alone need. Collective. */
    std::shared_ptr<const NodePartition> partition(const ParticleSet<dim> &particles) const;

    /** Writes or reads whether finish_start() was called. */
    void serialize_start(StateArchive &archive);
    /** Writes or reads which rows lost their negative values; after complete_reading() they have
     * lost them. */
    void serialize_extrapolation(StateArchive &archive);
    /** Writes or reads the positions and supports of the last search, as rows of @p archive. On
     * reading they go to @p position and @p support, for a search. */
    void serialize_search(StateArchive &archive, std::vector<double> &position,
                          std::vector<double> &support) const;
    void complete_reading();

    const Stencils &stencils() const;
    Stencils &stencils();
    const Neighbourhoods<dim> &neighbourhoods() const;
    Neighbourhoods<dim> &neighbourhoods();
    /** Half widths of supports that compute_at() used last, by node, with those of ghosts [L]. */
    const NodalVector &nodal_supports() const;
    MovingLeastSquares<dim> &moving_least_squares();
    PatchTestGradients<dim> &gradients();
    const PatchTestGradients<dim> &gradients() const;
    double dilation() const;

    std::size_t memory_consumption() const;

  private:
    void compute(const double *position, const double *support);
    /** Where @p particles are in the reference of @p kernel, with the numbers of the rows, into @p
     * reference, and its ghosts. Collective. */
    void find_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                        NodalVector &reference) const;
    /** The message of a particle without a basis; empty without one. */
    std::string describe(const std::vector<BasisDefect> &defects, const double *position,
                         const double *support) const;

    Section section;
    double support_dilation;
    bool crosses_gaps;
    const Bodies<dim> *bodies = nullptr; // null: there is one
    MPI_Comm communicator = MPI_COMM_NULL;
    bool shares_rows;
    bool has_started = false;
    CellAverages<dim> averages;
    PatchTestGradients<dim> consistent_gradients;
    Stencils shape;
    Neighbourhoods<dim> neighbours;
    MovingLeastSquares<dim> least_squares;
    NodalVector support_of_node;              // half widths, with those of ghosts [L]
    std::vector<unsigned int> rows_to_change; // between serialize_extrapolation() and
                                              // complete_reading()
  };
} // namespace tombolo
