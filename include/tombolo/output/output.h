// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/json.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>
#include <tombolo/output/time_table.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/records.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class BalanceHistory;
  template <int dim>
  class ContactSurface;

  /** A part, as outputs use it. */
  template <int dim>
  struct OutputPart
  {
    std::string name;
    const Formulation<dim> *formulation = nullptr;
    /** The same formulation, where it is one of particles, and its shape functions. */
    const ParticleFormulation<dim> *particles = nullptr;
    const Stencils *stencils = nullptr;
    /** Its mass at owned nodes, scalar; hanging nodes give theirs to others [M]. Collective. */
    std::function<NodalVector()> nodal_mass;
  };

  /** A surface beside the bodies that acts on them, as outputs use it. */
  template <int dim>
  struct OutputSurface
  {
    std::string name;
    const ContactSurface<dim> *surface;
    /** On the bodies [M L/T^2], and how deep they are in it at most [L]. Collective. */
    std::function<std::pair<std::array<double, 3>, double>()> force_and_penetration;
  };

  /**
   * The state of a run at one time, to be read only. Nothing in it is owned; it is valid during
   * the call that passes it on. Positions, stresses and forces are those at `time`, velocities
   * those of half a step before. Ghosts of position and velocity are current.
   */
  template <int dim>
  struct OutputView
  {
    double time = 0;        ///< t_n [T]
    std::uint64_t step = 0; ///< n
    double time_step = 0;   ///< Δt [T]
    /** Whether bodies at rest are at the end of the run: their few steps leave a last row. */
    bool ends_at_rest = false;
    const Mesh<dim> *mesh = nullptr;
    const Nodes<dim> *nodes = nullptr;
    const PartCells<dim> *part_cells = nullptr;
    const NodalState *state = nullptr;
    /** m̂ of an owned node with mass over its lumped mass. Only with mechanics. */
    std::function<double(unsigned int node)> unsmoothed_share;
    bool has_mechanics = true; ///< without it nothing moves, and parts have no material points
    const ThermalState *heat = nullptr; ///< null: a scene without heat
    std::vector<OutputSurface<dim>> surfaces;
    /** Forces for pictures, by name: each function adds to owned nodes [M L/T^2]. */
    std::map<std::string, std::vector<std::function<void(NodalVector &)>>> nodal_forces;
    /** Force that holds the prescribed components of an owned node, zero in the others; empty where
     * no motion is prescribed [M L/T^2]. */
    std::function<std::array<double, 3>(unsigned int node)> reaction;
    /** What fills the rows of histories, by their names; lower numbers come first. Collective. */
    std::map<std::string, std::multimap<int, std::function<void(BalanceHistory<dim> &)>>> histories;
    std::vector<OutputPart<dim>> parts; ///< in the order of `Parts`: the index is that of PartCells
    /** Exact Cauchy stress at an initial position and a time, where the case has one. */
    std::function<dealii::SymmetricTensor<2, 3>(const dealii::Point<dim> &, double)> exact_stress;
    std::function<double(const dealii::Point<dim> &, double)> exact_temperature; ///< likewise

    /** Whether tables that have a row every so many steps have one now. */
    bool has_row(const unsigned int steps_between) const
    {
      return step % steps_between == 0 || ends_at_rest;
    }

    /** Until when impulses of forces at t_n go. */
    double middle_of_next_step() const
    {
      return time + 0.5 * time_step;
    }
  };

  /**
   * Something that is written in the course of a run: a plug-in, which section Output names in
   * `Further outputs`. All functions are collective, called on every rank in this order: check()
   * when the model is built, check_continuation() of some resumed runs and start() before the first
   * step, then after_step() after each step and write() at each time of the output schedule,
   * finish() once.
   */
  template <int dim>
  class Output
  {
  public:
    virtual ~Output() = default;

    /** With the initial model: refuse what cannot work with it. Throws InputError. */
    virtual void check(const OutputView<dim> & /*view*/) {}

    /** Of a run that goes on in the directory that it is resumed from, when the state was read and
     * before anything there changes: refuse what does not continue what is there. Throws
     * InputError. */
    virtual void check_continuation(const OutputView<dim> & /*view*/,
                                    const OutputDirectory & /*directory*/,
                                    const UnitLabels & /*unit_labels*/)
    {}

    /** Before the first step: begin to write. */
    virtual void start(const OutputView<dim> & /*view*/, const OutputDirectory & /*directory*/,
                       const UnitLabels & /*unit_labels*/)
    {}

    /** At an output. Adds values, the same on all ranks, to the row of @p statistics. */
    virtual void write(const OutputView<dim> &view, TimeTable &statistics) = 0;

    /** After every step, and at the start: for what is sampled more often than written. */
    virtual void after_step(const OutputView<dim> & /*view*/) {}

    /** What continues this output in a resumed run; listed in its constructor. It is read before
     * start(), which then must keep what is in the output directory. */
    Records records;

    /** At the end: adds to `results` of the summary, and writes what is left. */
    virtual void finish(Json & /*results*/) {}

    /** A text for the screen, called after write() and after finish(); empty
     * for nothing. Not collective; that of rank 0 is printed. */
    virtual std::string report() const
    {
      return "";
    }
  };

  template <int dim>
  struct PluginKind<Output<dim>>
  {
    static constexpr const char *name = "output";
  };

  /** Declares in section Output the entries of all outputs, in subsections of their names. */
  template <int dim>
  void declare_outputs(const Entries &e);

  /** Names of the plug-ins that create_outputs() makes, in their order. Throws InputError. */
  template <int dim>
  std::vector<std::string> output_names(const Section &section);

  /** Makes what section Output requests: the outputs of the scene, then `Further outputs`, each in
   * their order. Needs no mesh and writes nothing. Throws InputError. */
  template <int dim>
  std::vector<std::unique_ptr<Output<dim>>> create_outputs(const Section &section);

  /** An output that is not named in `Further outputs`: a scene has it where it has what the output
   * shows. A static object registers it. */
  struct OutputOfScene
  {
    OutputOfScene(const int order, const std::string &name, const std::string &switched_by,
                  const std::function<bool(const Section &)> &is_requested)
        : name(name), switched_by(switched_by), is_requested(is_requested)
    {
      all().emplace(order, *this);
    }

    std::string name;                                  ///< of the plug-in
    std::string switched_by;                           ///< for messages
    std::function<bool(const Section &)> is_requested; ///< from section Output

    /** All of them, by their order. */
    static std::multimap<int, OutputOfScene> &all();
  };
} // namespace tombolo
