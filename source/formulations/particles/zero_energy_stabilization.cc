// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/zero_energy_stabilization.h>

#include <tombolo/approximation/smoothing_strength.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const std::string energy_name = "pair residual energy";
    const std::string dissipation_name = "pair residual dissipation";
    const std::string seen_strain_name = "pair residual plastic strain";

    const double *node(const double *field, const unsigned int local)
    {
      return field + static_cast<std::size_t>(local) * node_stride;
    }

    /** What a row needs besides its pairs, F⁻¹ and the columns of L = ∂v/∂x. */
    struct RowMotion
    {
      Matrix3<double> inverse_deformation;
      Matrix3<double> gradient;
      NodeLanes columns[3];
    };

    template <bool with_deformation>
    void find_motion(const Stencils &shape, const unsigned int row, const double *position,
                     const double *velocity, RowMotion &motion)
    {
      const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
      const NodeLanes own_velocity = load_node(node(velocity, shape.particle_node[row]));
      NodeLanes h[3] = {0., 0., 0.}, f[3] = {0., 0., 0.};
      const Stencils::Row of_row = shape.row(row);
      for (unsigned int n = 0; n < of_row.size; ++n)
      {
        const double *const gradient = of_row.gradient + n * Stencils::n_gradient;
        const NodeLanes v = load_node(node(velocity, of_row.neighbour[n])) - own_velocity;
        for (unsigned int d = 0; d < 3; ++d)
          h[d] += v * gradient[d];
        if constexpr (with_deformation)
        {
          const NodeLanes x = load_node(node(position, of_row.neighbour[n])) - own_position;
          for (unsigned int d = 0; d < 3; ++d)
            f[d] += x * gradient[d];
        }
      }
      Matrix3<double> &inverse_f = motion.inverse_deformation;
      if constexpr (with_deformation)
      {
        Matrix3<double> deformation;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            deformation(i, j) = f[j][i];
        if (deformation(2, 2) == 0.)
          deformation(2, 2) = 1.; // two dimensions
        double det;
        inverse_f = inverse(deformation, det);
      }
      else
      {
        const double *const rows =
            shape.inverse_deformation.data() + 3 * node_stride * std::size_t(row);
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            inverse_f(i, j) = rows[i * node_stride + j];
      }
      for (unsigned int j = 0; j < 3; ++j)
      {
        motion.columns[j] =
            h[0] * inverse_f(0, j) + h[1] * inverse_f(1, j) + h[2] * inverse_f(2, j);
        for (unsigned int i = 0; i < 3; ++i)
          motion.gradient(i, j) = motion.columns[j][i];
      }
    }

    void find_motion(const Stencils &shape, const unsigned int row, const double *position,
                     const double *velocity, RowMotion &motion)
    {
      if (shape.inverse_deformation_is_current)
        find_motion<false>(shape, row, position, velocity, motion);
      else
        find_motion<true>(shape, row, position, velocity, motion);
    }

    /** v_J - v_I - L (x_J - x_I), with the offset x_J - x_I. */
    NodeLanes residual(const RowMotion &motion, const NodeLanes &velocity_difference,
                       const NodeLanes &offset)
    {
      return velocity_difference - (motion.columns[0] * offset[0] + motion.columns[1] * offset[1] +
                                    motion.columns[2] * offset[2]);
    }

    /** Adds what the forces of the pairs, of which @p moment is Σ force ⊗ (x_J - x_I) by columns,
     * do through L: the moment times F⁻ᵀ∇φ_J, less the force of the pair. */
    template <typename PairForce>
    void scatter(const Stencils &shape, const unsigned int row, const RowMotion &motion,
                 const NodeLanes (&moment)[3], const NodeLanes &sum, const PairForce &pair_force,
                 double *target)
    {
      const Matrix3<double> &inverse_f = motion.inverse_deformation;
      NodeLanes of_reference[3];
      for (unsigned int i = 0; i < 3; ++i)
        of_reference[i] =
            moment[0] * inverse_f(i, 0) + moment[1] * inverse_f(i, 1) + moment[2] * inverse_f(i, 2);
      const Stencils::Row of_row = shape.row(row);
      for (unsigned int n = 0; n < of_row.size; ++n)
      {
        const double *const gradient = of_row.gradient + n * Stencils::n_gradient;
        double *const place = target + std::size_t(of_row.neighbour[n]) * node_stride;
        store_node(load_node(place) - pair_force(n) +
                       (of_reference[0] * gradient[0] + of_reference[1] * gradient[1] +
                        of_reference[2] * gradient[2]),
                   place);
      }
      double *const own = target + std::size_t(shape.particle_node[row]) * node_stride;
      store_node(load_node(own) + sum, own);
    }

    double sum_of(const NodeLanes &a)
    {
      return a[0] + a[1] + a[2];
    }

    /** Over the pairs of a row: forces, twice the energy, forces times changes of elongation, and
     * forces times offsets. */
    struct RowSums
    {
      NodeLanes force = 0., energy = 0., work = 0.;
      NodeLanes moment[3] = {0., 0., 0.};
    };

    /** Advances the elongations of the pairs of a row, and adds up. */
    void advance_pairs(const Stencils &shape, const unsigned int row, const RowMotion &motion,
                       const NodeLanes (&turn_column)[3], const double *position,
                       const double *velocity, const double time_increment, double *row_pairs,
                       RowSums &sums)
    {
      const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
      const NodeLanes own_velocity = load_node(node(velocity, shape.particle_node[row]));
      const Stencils::Row of_row = shape.row(row);
      for (unsigned int n = 0; n < of_row.size; ++n)
      {
        double *const pair = row_pairs + n * node_stride;
        const double k = pair[3];
        const unsigned int neighbour = of_row.neighbour[n];
        const NodeLanes offset = load_node(node(position, neighbour)) - own_position;
        const NodeLanes change =
            residual(motion, load_node(node(velocity, neighbour)) - own_velocity, offset) *
            time_increment;
        // Half of the change turns with what was there: then the energy gains just what the forces
        // before and after the step give, ½ (f₀ + f₁) Δe.
        const NodeLanes half = 0.5 * change;
        const NodeLanes before = load_node(pair) + half;
        const NodeLanes elongation = turn_column[0] * before[0] + turn_column[1] * before[1] +
                                     turn_column[2] * before[2] + half;
        const NodeLanes of_pair = elongation * k;
        sums.energy += of_pair * elongation;
        sums.work += of_pair * change;
        sums.force += of_pair;
        for (unsigned int d = 0; d < 3; ++d)
          sums.moment[d] += of_pair * offset[d];
        store_node(elongation, pair);
        pair[3] = k;
      }
    }

    /** The square of the equivalent stress of a row. */
    double squared_flow_stress(const double *const stress[6], const unsigned int row)
    {
      double normal = 0, shear = 0;
      const double mean = (stress[0][row] + stress[1][row] + stress[2][row]) / 3.;
      for (unsigned int c = 0; c < 3; ++c)
      {
        normal += (stress[c][row] - mean) * (stress[c][row] - mean);
        shear += stress[c + 3][row] * stress[c + 3][row];
      }
      return 1.5 * normal + 3. * shear;
    }
  } // namespace

  void ZeroEnergyStabilization::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Pair residual", "0", Patterns::Double(),
        "Coefficient kappa of a stiffness, which conserves energy, against motion that gradients "
        "at the nodes do not see, such as the mode that alternates from node to node; 0 is none. "
        "Not for kernels in the current configuration. Units: 1.");
    handler.declare_entry(
        "Pair residual limit", "0.001", Patterns::Double(),
        "Where the material flows plastically, the pair residual stores at most this share of the "
        "elastic energy of shear at the flow stress, and loses the excess; 0 is no limit. Units: "
        "1.");
  }

  ZeroEnergyStabilization::ZeroEnergyStabilization(const Section &section, const Kernel &kernel,
                                                   const double dilation)
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

  std::vector<FieldDescription> ZeroEnergyStabilization::variables() const
  {
    if (!is_on())
      return {};
    return {{energy_name, "M L^2/T^2", FieldLocation::material_point, 1, true},
            {dissipation_name, "M L^2/T^2", FieldLocation::material_point, 1, true},
            {seen_strain_name, "1", FieldLocation::material_point, 1, true, 0., true}};
  }

  void ZeroEnergyStabilization::initialize(const Material &material, const MaterialPoints &points)
  {
    if (!is_on())
      return;
    shear_modulus = material.shear_modulus();
    modulus = material.bulk_modulus() + 4. / 3. * shear_modulus;
    energy_field = points.find_field(energy_name);
    dissipation_field = points.find_field(dissipation_name);
    seen_strain_field = points.find_field(seen_strain_name);
    plastic_strain_field = points.find_field("effective plastic strain");
    is_limited = limit > 0. && plastic_strain_field < points.fields().size();
  }

  void ZeroEnergyStabilization::set_reference(const unsigned int dim, const Stencils &shape,
                                              const std::vector<double> &volume,
                                              const double *position, const double *support)
  {
    pairs.resize(shape.neighbour.size() * node_stride);
    std::fill(pairs.begin(), pairs.end(), 0.);
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      if (shape.is_rigid(row))
        continue;
      const double *const own = node(position, shape.particle_node[row]);
      double inverse_moment[3] = {0., 0., 0.};
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double spacing = node(support, shape.particle_node[row])[d] / dilation;
        inverse_moment[d] = 1. / (second_moment * spacing * spacing);
      }
      const double stiffness = kappa * modulus * volume[row];
      const Stencils::Row of_row = shape.row(row);
      for (unsigned int n = 0; n < of_row.size; ++n)
      {
        const double *const other = node(position, of_row.neighbour[n]);
        double scaled = 0, squared = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double offset = other[d] - own[d];
          scaled += offset * offset * inverse_moment[d];
          squared += offset * offset;
        }
        if (squared > 0.)
          pairs[(shape.row_start[row] + n) * node_stride + 3] =
              stiffness * std::max(of_row.value[n], 0.) * scaled / squared;
      }
    }
  }

  void ZeroEnergyStabilization::restart(MaterialPoints &points) const
  {
    double *const energy = points.component(energy_field, 0);
    double *const dissipated = points.component(dissipation_field, 0);
    for (unsigned int row = 0; row < points.size(); ++row)
    {
      dissipated[row] += energy[row];
      energy[row] = 0.;
    }
  }

  void ZeroEnergyStabilization::add_force(const Stencils &shape, const double *position,
                                          const double *velocity, const double time_increment,
                                          MaterialPoints &points, double *force)
  {
    double *const stored = points.component(energy_field, 0);
    double *const dissipated = points.component(dissipation_field, 0);
    double *const seen_strain = points.component(seen_strain_field, 0);
    const double *const plastic_strain =
        is_limited ? points.component(plastic_strain_field, 0) : nullptr;
    const double *const volume = points.component(MaterialPoints::volume, 0);
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = points.component(MaterialPoints::stress, c);

    RowMotion motion;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      if (shape.is_rigid(row))
        continue;
      find_motion(shape, row, position, velocity, motion);
      Matrix3<double> increment = motion.gradient;
      for (double &entry : increment.entry)
        entry *= time_increment;
      const Matrix3<double> turn = rotation_of(motion_increment(increment).spin);
      NodeLanes turn_column[3];
      for (unsigned int j = 0; j < 3; ++j)
        turn_column[j] = node_of(turn(0, j), turn(1, j), turn(2, j));

      double *const row_pairs = pairs.data() + shape.row_start[row] * node_stride;
      RowSums sums;
      advance_pairs(shape, row, motion, turn_column, position, velocity, time_increment, row_pairs,
                    sums);

      double energy = 0.5 * sum_of(sums.energy);
      if (is_limited && plastic_strain[row] > seen_strain[row])
      {
        seen_strain[row] = plastic_strain[row];
        const double largest =
            limit * volume[row] * squared_flow_stress(stress, row) / (6. * shear_modulus);
        if (energy > largest)
        {
          // Of the work of the forces before and after, ½ (f₀ + f₁) Δe, what the energy did not
          // gain.
          const double factor = std::sqrt(largest / energy);
          dissipated[row] += energy - largest - 0.5 * (1. - factor) * sum_of(sums.work);
          energy = largest;
          sums.force *= factor;
          for (NodeLanes &column : sums.moment)
            column *= factor;
          for (unsigned int n = 0; n < shape.row(row).size; ++n)
            for (unsigned int d = 0; d < 3; ++d)
              row_pairs[n * node_stride + d] *= factor;
        }
      }
      stored[row] = energy;
      const auto pair_force = [&](const unsigned int n)
      {
        const double *const pair = row_pairs + n * node_stride;
        NodeLanes of_pair = load_node(pair) * pair[3];
        of_pair[3] = 0.;
        return of_pair;
      };
      scatter(shape, row, motion, sums.moment, sums.force, pair_force, force);
    }
  }

  void ZeroEnergyStabilization::apply_elastic_stiffness(const Stencils &shape,
                                                        const double *position,
                                                        const double *velocity, double *force) const
  {
    RowMotion motion;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      if (shape.is_rigid(row))
        continue;
      find_motion(shape, row, position, velocity, motion);
      const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
      const NodeLanes own_velocity = load_node(node(velocity, shape.particle_node[row]));
      const Stencils::Row of_row = shape.row(row);
      const double *const row_pairs = pairs.data() + shape.row_start[row] * node_stride;
      const auto offset_to = [&](const unsigned int n)
      { return load_node(node(position, of_row.neighbour[n])) - own_position; };
      const auto pair_force = [&](const unsigned int n)
      {
        return residual(motion, load_node(node(velocity, of_row.neighbour[n])) - own_velocity,
                        offset_to(n)) *
               -row_pairs[n * node_stride + 3];
      };
      NodeLanes sum = 0., moment[3] = {0., 0., 0.};
      for (unsigned int n = 0; n < of_row.size; ++n)
      {
        const NodeLanes of_pair = pair_force(n), offset = offset_to(n);
        sum += of_pair;
        for (unsigned int d = 0; d < 3; ++d)
          moment[d] += of_pair * offset[d];
      }
      scatter(shape, row, motion, moment, sum, pair_force, force);
    }
  }

  double ZeroEnergyStabilization::stored_energy(const MaterialPoints &points) const
  {
    double result = 0;
    if (is_on())
      for (unsigned int row = 0; row < points.size(); ++row)
        result += points.component(energy_field, 0)[row];
    return result;
  }

  double ZeroEnergyStabilization::dissipation(const MaterialPoints &points) const
  {
    double result = 0;
    if (is_on())
      for (unsigned int row = 0; row < points.size(); ++row)
        result += points.component(dissipation_field, 0)[row];
    return result;
  }

  void ZeroEnergyStabilization::serialize(const Stencils &shape,
                                          const std::vector<double> &positions,
                                          const std::vector<unsigned int> &place,
                                          StateArchive &archive)
  {
    std::size_t longest = 0;
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
      longest = std::max(longest, shape.row_start[row + 1] - shape.row_start[row]);
    auto n_pairs = static_cast<unsigned int>(
        Utilities::MPI::max(static_cast<unsigned int>(longest), archive.communicator()));
    archive("pairs in a row", n_pairs);
    constexpr unsigned int n_of_pair = 6; // position and elongation
    const unsigned int n_of_row = n_of_pair * n_pairs;
    std::vector<double> values;
    if (!archive.is_reading())
    {
      values.assign(std::size_t(shape.n_particles()) * n_of_row, 0.);
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        double *of_pair = values.data() + std::size_t(row) * n_of_row;
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1];
             ++entry, of_pair += n_of_pair)
        {
          std::copy_n(node(positions.data(), place[entry]), 3, of_pair);
          std::copy_n(pairs.data() + entry * node_stride, 3, of_pair + 3);
        }
      }
    }
    archive.rows("elongations of pairs", n_of_row, values);
    if (!archive.is_reading())
      return;
    read_elongations.assign(3 * shape.neighbour.size(), 0.);
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
      for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
      {
        const double *const sought = node(positions.data(), place[entry]);
        const double *nearest = nullptr;
        double least = std::numeric_limits<double>::max();
        for (unsigned int k = 0; k < shape.row_start[row + 1] - shape.row_start[row]; ++k)
        {
          const double *const of_pair =
              values.data() + std::size_t(row) * n_of_row + std::size_t(k) * n_of_pair;
          double squared = 0;
          for (unsigned int d = 0; d < 3; ++d)
            squared += (of_pair[d] - sought[d]) * (of_pair[d] - sought[d]);
          if (squared < least)
          {
            least = squared;
            nearest = of_pair;
          }
        }
        std::copy_n(nearest + 3, 3, read_elongations.data() + 3 * entry);
      }
  }

  void ZeroEnergyStabilization::complete_reading()
  {
    for (std::size_t entry = 0; entry < read_elongations.size() / 3; ++entry)
      std::copy_n(read_elongations.data() + 3 * entry, 3, pairs.data() + entry * node_stride);
    read_elongations = {};
  }

  std::size_t ZeroEnergyStabilization::memory_consumption() const
  {
    return pairs.memory_consumption();
  }
} // namespace tombolo
