#include <tombolo/formulations/pair_residual.h>

#include <tombolo/base/vectorization.h>
#include <tombolo/formulations/bulk_viscosity.h>
#include <tombolo/particles/smoothing_strength.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const std::string energy_name = "pair residual energy";
    const std::string dissipation_name = "pair residual dissipation";
    const std::string loss_name = "pair residual loss of stiffness";
    const std::string seen_strain_name = "pair residual plastic strain";

    /** Forces of all pairs of a row for g = 1, k r, into @p forces, with their sum and Σ k r ⊗ ΔX,
     * by columns. Returns ½ Σ k |r|². */
    double row_forces(const ShapeFunctions &shape, const unsigned int row, const double *pairs,
                      const double *field, double *forces, NodeLanes &sum, NodeLanes (&columns)[3])
    {
      const std::size_t begin = shape.row_start[row];
      const std::size_t end = shape.row_start[row + 1];
      const NodeLanes own = load_node(field + std::size_t(shape.particle_node[row]) * n_slots);
      NodeLanes gradient[3] = {0., 0., 0.};
      for (std::size_t entry = begin; entry < end; ++entry)
      {
        const NodeLanes difference =
            load_node(field + std::size_t(shape.neighbour[entry]) * n_slots) - own;
        const double *const of_entry = shape.gradient.data() + entry * n_slots;
        for (unsigned int d = 0; d < 3; ++d)
          gradient[d] += difference * of_entry[d];
        store_node(difference, forces + (entry - begin) * n_slots);
      }
      NodeLanes energy = 0.;
      sum = 0.;
      columns[0] = columns[1] = columns[2] = 0.;
      for (std::size_t entry = begin; entry < end; ++entry)
      {
        const double *const pair = pairs + entry * n_slots;
        double *const place = forces + (entry - begin) * n_slots;
        const NodeLanes residual =
            load_node(place) -
            (gradient[0] * pair[0] + gradient[1] * pair[1] + gradient[2] * pair[2]);
        const NodeLanes force = residual * pair[3];
        energy += force * residual;
        sum += force;
        for (unsigned int d = 0; d < 3; ++d)
          columns[d] += force * pair[d];
        store_node(force, place);
      }
      return 0.5 * (energy[0] + energy[1] + energy[2]);
    }

    /** Adds @p factor times the force of a row: that on J is -k r + (Σ k r ⊗ ΔX) ∇φ_J. */
    void scatter_row(const ShapeFunctions &shape, const unsigned int row, const double *forces,
                     const NodeLanes &sum, const NodeLanes (&columns)[3], const double factor,
                     double *target)
    {
      const std::size_t begin = shape.row_start[row];
      const std::size_t end = shape.row_start[row + 1];
      const NodeLanes scaled[3] = {factor * columns[0], factor * columns[1], factor * columns[2]};
      for (std::size_t entry = begin; entry < end; ++entry)
      {
        const double *const of_entry = shape.gradient.data() + entry * n_slots;
        double *const place = target + std::size_t(shape.neighbour[entry]) * n_slots;
        store_node(
            load_node(place) - factor * load_node(forces + (entry - begin) * n_slots) +
                (scaled[0] * of_entry[0] + scaled[1] * of_entry[1] + scaled[2] * of_entry[2]),
            place);
      }
      double *const own = target + std::size_t(shape.particle_node[row]) * n_slots;
      store_node(load_node(own) + factor * sum, own);
    }
  } // namespace

  void PairResidual::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Pair residual", "0", Patterns::Double(),
        "Coefficient kappa of a stiffness, which conserves energy, against motion that gradients "
        "at the nodes do not see, such as the mode that alternates from node to node; 0 is none. "
        "Not for kernels in the current configuration. Units: 1.");
    handler.declare_entry(
        "Pair residual limit", "0.1", Patterns::Double(),
        "Where the material flows plastically, the pair residual stores at most this share of the "
        "elastic energy of shear at the flow stress, and loses the excess; 0 is no limit. Units: "
        "1.");
  }

  PairResidual::PairResidual(const Section &section, const Kernel &kernel, const double dilation)
      : kappa(section.get_double("Pair residual")),
        limit(section.get_double("Pair residual limit")), dilation(dilation)
  {
    if (!(kappa >= 0. && kappa <= 10.))
      section.fail("Pair residual", "allowed is a number from 0 to 10.");
    if (!(limit >= 0. && limit <= 1e6))
      section.fail("Pair residual limit", "allowed is a number from 0 to 1e6.");
    if (!is_on())
      return;
    if (section.get("Configuration") == "current")
      section.fail("Pair residual",
                   "a kernel in the current configuration begins anew in every step, and nothing "
                   "would be stored; use a total or an updated Lagrangian one");
    second_moment = SmoothingStrength::lattice_row(kernel, dilation).second_moment();
  }

  std::vector<FieldDescription> PairResidual::variables() const
  {
    if (!is_on())
      return {};
    return {{energy_name, "M/(L T^2)", FieldLocation::material_point, 1, true},
            {dissipation_name, "M/(L T^2)", FieldLocation::material_point, 1, true},
            {loss_name, "1", FieldLocation::material_point, 1, true},
            {seen_strain_name, "1", FieldLocation::material_point, 1, true}};
  }

  void PairResidual::initialize(const Material &material, const MaterialPoints &points)
  {
    if (!is_on())
      return;
    shear_modulus = material.shear_modulus();
    modulus = material.bulk_modulus() + 4. / 3. * shear_modulus;
    energy_field = points.find_field(energy_name);
    dissipation_field = points.find_field(dissipation_name);
    loss_field = points.find_field(loss_name);
    seen_strain_field = points.find_field(seen_strain_name);
    plastic_strain_field = points.find_field("effective plastic strain");
    is_limited = limit > 0. && plastic_strain_field < points.fields().size();
  }

  void PairResidual::set_reference(const unsigned int dim, const ShapeFunctions &shape,
                                   const std::vector<double> &volume, const double *position,
                                   const double *support)
  {
    pairs.resize_fast(shape.neighbour.size() * n_slots);
    std::size_t longest_row = 0;
    auto next_rigid = shape.rigid_rows.begin();
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const bool is_rigid = next_rigid != shape.rigid_rows.end() && *next_rigid == row;
      if (is_rigid)
        ++next_rigid;
      const std::size_t own = std::size_t(shape.particle_node[row]) * n_slots;
      double inverse_moment[3] = {0., 0., 0.};
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double spacing = support[own + d] / dilation;
        inverse_moment[d] = 1. / (second_moment * spacing * spacing);
      }
      const double stiffness = is_rigid ? 0. : kappa * modulus * volume[row];
      longest_row = std::max(longest_row, shape.row_start[row + 1] - shape.row_start[row]);
      for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
      {
        double *const pair = pairs.data() + entry * n_slots;
        double scaled = 0, squared = 0;
        for (unsigned int d = 0; d < 3; ++d)
        {
          pair[d] = d < dim ? position[std::size_t(shape.neighbour[entry]) * n_slots + d] -
                                  position[own + d]
                            : 0.;
          scaled += pair[d] * pair[d] * inverse_moment[d];
          squared += pair[d] * pair[d];
        }
        pair[3] =
            squared > 0. ? stiffness * std::max(shape.value[entry], 0.) * scaled / squared : 0.;
      }
    }
    pair_forces.resize_fast(longest_row * n_slots);
  }

  void PairResidual::restart(MaterialPoints &points)
  {
    double *const energy = points.component(energy_field, 0);
    double *const dissipated = points.component(dissipation_field, 0);
    double *const loss = points.component(loss_field, 0);
    for (unsigned int i = 0; i < points.size(); ++i)
    {
      dissipated[i] += energy[i];
      energy[i] = 0.;
      loss[i] = 0.;
    }
    displacement.set_zero();
  }

  void PairResidual::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    if (displacement.partition() == nullptr)
      displacement.reinit(partition);
    else
      displacement.move_to(partition);
  }

  void PairResidual::add_force(const ShapeFunctions &shape, const NodalVector &velocity,
                               const double time_increment, MaterialPoints &points,
                               NodalVector &force)
  {
    const unsigned int n_local = displacement.partition()->n_local();
    for (unsigned int i = 0; i < n_local; ++i)
      store_node(load_node(displacement.node(i)) + time_increment * load_node(velocity.node(i)),
                 displacement.node(i));

    double *const energy = points.component(energy_field, 0);
    double *const dissipated = points.component(dissipation_field, 0);
    double *const loss = points.component(loss_field, 0);
    double *const seen_strain = points.component(seen_strain_field, 0);
    const double *const plastic_strain =
        is_limited ? points.component(plastic_strain_field, 0) : nullptr;
    const double *const volume = points.component(MaterialPoints::volume, 0);
    const double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0);
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);

    NodeLanes sum, columns[3];
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      const double whole_energy = row_forces(shape, row, pairs.data(), displacement.data(),
                                             pair_forces.data(), sum, columns) *
                                  volume_ratio[row] / volume[row];
      double factor = 1. - loss[row];
      if (is_limited && plastic_strain[row] > seen_strain[row])
      {
        seen_strain[row] = plastic_strain[row];
        double normal = 0, shear = 0;
        const double mean = (stress[0][row] + stress[1][row] + stress[2][row]) / 3.;
        for (unsigned int c = 0; c < 3; ++c)
        {
          normal += (stress[c][row] - mean) * (stress[c][row] - mean);
          shear += stress[c + 3][row] * stress[c + 3][row];
        }
        const double largest =
            limit * (1.5 * normal + 3. * shear) / (6. * shear_modulus) * volume_ratio[row];
        if (factor * whole_energy > largest)
        {
          // The forces at both ends of the step do work: ½ (g₀ - g₁) r₀ · r₁ is lost, not that of
          // r₁ · r₁, and r grows by a factor where it grows much.
          const double reduced = largest / whole_energy;
          const double previous = energy[row] / factor;
          dissipated[row] += (factor - reduced) * std::sqrt(previous * whole_energy);
          factor = reduced;
          loss[row] = 1. - reduced;
        }
      }
      energy[row] = factor * whole_energy;
      scatter_row(shape, row, pair_forces.data(), sum, columns, factor, force.data());
    }
  }

  void PairResidual::add_stiffness_action(const ShapeFunctions &shape, const MaterialPoints &points,
                                          const NodalVector &velocity, NodalVector &force) const
  {
    const double *const loss = points.component(loss_field, 0);
    NodeLanes sum, columns[3];
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      row_forces(shape, row, pairs.data(), velocity.data(), pair_forces.data(), sum, columns);
      scatter_row(shape, row, pair_forces.data(), sum, columns, loss[row] - 1., force.data());
    }
  }

  double PairResidual::stored_energy(const MaterialPoints &points) const
  {
    return is_on() ? integral_over_initial_volume(points, energy_name) : 0.;
  }

  double PairResidual::dissipation(const MaterialPoints &points) const
  {
    return is_on() ? integral_over_initial_volume(points, dissipation_name) : 0.;
  }

  void PairResidual::serialize(const ShapeFunctions &shape, StateArchive &archive)
  {
    std::vector<double> values;
    if (!archive.is_reading())
      for (const unsigned int node : shape.particle_node)
        values.insert(values.end(), displacement.node(node), displacement.node(node) + 3);
    archive.rows("pair residual displacement", 3, values);
    if (archive.is_reading())
      read_displacement = values;
  }

  void PairResidual::complete_reading(const ShapeFunctions &shape)
  {
    displacement.set_zero();
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
      std::copy_n(read_displacement.begin() + std::ptrdiff_t(row) * 3, 3,
                  displacement.node(shape.particle_node[row]));
    displacement.update_ghosts();
    read_displacement = {};
  }

  std::size_t PairResidual::memory_consumption() const
  {
    return is_on() ? pairs.memory_consumption() + pair_forces.memory_consumption() +
                         displacement.memory_consumption()
                   : 0;
  }
} // namespace tombolo
