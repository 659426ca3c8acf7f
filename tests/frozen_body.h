// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "model_scene.h"

#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    inline double sum_over_ranks(const double value)
    {
      return dealii::Utilities::MPI::sum(value, MPI_COMM_WORLD);
    }

    /** Entries of a parameter file: a block of one kind, or of two that share the nodes at its
     * middle, with spacing 1 and longitudinal wave speed 1. */
    struct Block
    {
      std::string formulation = "particles"; ///< "particles", an element's name, or "coupled"
      std::string options;                   ///< lines for the section of the formulation
      double poisson = 0.3;
      std::string element = "fully integrated hexahedron"; ///< of a coupled block
      std::string bridge = "paper";
      std::string conditions;
      std::string mesh_options;
      std::vector<unsigned int> cells = {6, 5, 5};
    };

    inline std::ostream &operator<<(std::ostream &out, const Block &block)
    {
      for (const unsigned int n : block.cells)
        out << n << " ";
      std::string options = block.options + block.mesh_options;
      for (char &character : options)
        character = character == '\n' ? ',' : character;
      return out << block.formulation << " (" << options << ") nu = " << block.poisson << ", "
                 << block.bridge << " bridge" << (block.conditions.empty() ? "" : ", clamped");
    }

    inline std::string parameters_of(const Block &block)
    {
      const std::string particles = "momentum consistent particle";
      const bool is_coupled = block.formulation == "coupled";
      std::string corner, cells;
      for (const unsigned int n : block.cells)
      {
        corner += (corner.empty() ? "" : ", ") + std::to_string(n);
        cells += (cells.empty() ? "" : ", ") + std::to_string(n);
      }
      const auto part = [&](const std::string &name, const std::string &where,
                            const std::string &formulation, const std::string &options)
      {
        return "subsection Part: " + name + "\nset Cells = " + where + "\nset Material = m\n" +
               "set Formulation = " + formulation + "\nsubsection " + formulation + "\n" + options +
               "\nend\nend\n";
      };
      const double nu = block.poisson;
      std::ostringstream text;
      text.precision(17);
      text << "set Dimension = " << block.cells.size() << "\nset Materials = m\n"
           << "set Parts = " << (is_coupled ? "a, b" : "a") << "\n"
           << block.conditions << "subsection Mesh\nset Type = box\nsubsection box\n"
           << "set Upper corner = " << corner << "\nset Cells = " << cells << "\n"
           << block.mesh_options << "\nend\nend\n"
           << "subsection Material: m\nset Model = elastic\nsubsection elastic\nset Density = 1\n"
           << "set Young's modulus = " << (1. + nu) * (1. - 2. * nu) / (1. - nu)
           << "\nset Poisson's ratio = " << nu << "\nend\nend\n"
           << "subsection Coupling\nset Bridge = " << block.bridge << "\nend\n";
      if (is_coupled)
        text << part("a", "x < " + std::to_string(block.cells[0] / 2), block.element, "")
             << part("b", "otherwise", particles, block.options);
      else
        text << part("a", "all", block.formulation == "particles" ? particles : block.formulation,
                     block.options);
      return text.str();
    }

    /**
     * A body whose geometry stays as it is, because it moves by too little: MechanicalStep is then
     * linear in v̂ and in what the material points have stored. The true limit of the time step is
     * found from it in two ways that share nothing with the estimators.
     */
    template <int dim>
    class FrozenBody : public ModelScene<dim>
    {
    public:
      using ModelScene<dim>::model, ModelScene<dim>::parameters;

      explicit FrozenBody(const std::string &text, MPI_Comm communicator = MPI_COMM_WORLD)
          : ModelScene<dim>(text, communicator)
      {
        step = std::make_unique<MechanicalStep<dim>>(*model);
        estimator = std::make_unique<SpectralEstimator<dim>>(
            parameters.section("Time step").subsection("spectral"));
        keep_configuration();
      }

      explicit FrozenBody(const Block &block, MPI_Comm communicator = MPI_COMM_WORLD)
          : FrozenBody(parameters_of(block), communicator)
      {}

      /** Makes the present positions those of the material without stress. */
      void reset_reference()
      {
        Clock clock;
        clock.previous_step = clock.next_step = 1e-3;
        step->evaluate(clock);
        for (Part<dim> &part : model->parts)
        {
          MaterialPoints &points = part.formulation->points();
          for (unsigned int c = 0; c < 6; ++c)
            std::fill_n(points.component(MaterialPoints::stress, c), points.padded_size(), 0.);
        }
      }

      /** The present configuration becomes the one that the limits are computed for. */
      void keep_configuration()
      {
        for (Part<dim> &part : model->parts)
          if (part.particles != nullptr)
            part.particles->stencils().inverse_deformation_is_current = false;
        kept_position = model->state.position.copy();
        kept_points.clear();
        for (Part<dim> &part : model->parts)
        {
          MaterialPoints &points = part.formulation->points();
          for (unsigned int f = 0; f < points.fields().size(); ++f)
            for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
              kept_points.emplace_back(points.component(f, c),
                                       points.component(f, c) + points.padded_size());
        }
      }

      /**
       * The step at which the update matrix of v̂ gets the eigenvalue -1. Its columns are probed
       * through MechanicalStep, at two sizes of the step behind, which separates the elastic part K
       * from the viscous part C; limit: largest eigenvalue of Δt² K + 2 Δt C equal to 4.
       */
      double limit_by_eigenvalues()
      {
        Matrix elastic, viscous;
        probe_both(elastic, viscous);
        Matrix asymmetry(elastic);
        asymmetry.Tadd(-1., elastic);
        AssertThrow(asymmetry.frobenius_norm() < 1e-6 * elastic.frobenius_norm(),
                    dealii::ExcMessage("The update is not self-adjoint."));
        double limit = 2. / std::sqrt(largest_eigenvalue(elastic));
        if (viscous.frobenius_norm() > 1e-6 * elastic.frobenius_norm() * limit)
          for (unsigned int pass = 0; pass < 25; ++pass)
          {
            Matrix sum(elastic);
            sum.add(2. / limit, viscous);
            const double next = 2. / std::sqrt(largest_eigenvalue(sum));
            const bool has_converged = std::abs(next - limit) < 1e-6 * limit;
            limit = next;
            if (has_converged)
              break;
          }
        return limit;
      }

      /** The eigenvalues of the elastic stiffness of the parts with nodal masses, ascending, over
       * the largest. On one rank, without constraints. */
      std::vector<double> eigenvalues_of_stiffness()
      {
        const auto &partition = model->state.partition();
        const auto n = static_cast<unsigned int>(partition->n_global());
        NodalVector motion(partition, Quantity::vector), force(partition, Quantity::vector);
        dealii::LAPACKFullMatrix<double> matrix(n * dim, n * dim);
        Matrix columns(n * dim, n * dim);
        const auto root = [&](const unsigned int node)
        { return std::sqrt(*model->bridge->nodal_mass().node(partition->local_index(node))); };
        for (unsigned int node = 0; node < n; ++node)
          for (unsigned int d = 0; d < dim; ++d)
          {
            motion.set_zero();
            force.set_zero();
            motion.node(partition->local_index(node))[d] = 1. / root(node);
            motion.update_ghosts();
            apply_elastic_stiffness(*model, motion, 1e300, force);
            for (unsigned int other = 0; other < n; ++other)
              for (unsigned int c = 0; c < dim; ++c)
                columns(other * dim + c, node * dim + d) =
                    force.node(partition->local_index(other))[c] / root(other);
          }
        Matrix asymmetry(columns);
        asymmetry.Tadd(-1., columns);
        AssertThrow(asymmetry.frobenius_norm() < 1e-10 * columns.frobenius_norm(),
                    dealii::ExcMessage("The stiffness is not symmetric."));
        for (unsigned int i = 0; i < n * dim; ++i)
          for (unsigned int j = 0; j < n * dim; ++j)
            matrix(i, j) = 0.5 * (columns(i, j) + columns(j, i));
        dealii::Vector<double> values;
        Matrix vectors;
        const double bound = 2. * columns.linfty_norm();
        matrix.compute_eigenvalues_symmetric(-bound, bound, 0., values, vectors);
        std::vector<double> result(values.begin(), values.end());
        std::sort(result.begin(), result.end());
        for (double &value : result)
          value /= values.linfty_norm();
        return result;
      }

      /** The eigenvalues of the elastic part of the update matrix of v̂, ascending, over the
       * largest: modes that no stress resists have zero. */
      std::vector<double> eigenvalues()
      {
        Matrix elastic, viscous;
        probe_both(elastic, viscous);
        const auto n = static_cast<unsigned int>(elastic.m());
        dealii::LAPACKFullMatrix<double> copy(n, n);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            copy(i, j) = 0.5 * (elastic(i, j) + elastic(j, i));
        dealii::Vector<double> values;
        Matrix vectors;
        copy.compute_eigenvalues_symmetric(-2. * elastic.linfty_norm(), 2. * elastic.linfty_norm(),
                                           0., values, vectors);
        std::vector<double> result(values.begin(), values.end());
        std::sort(result.begin(), result.end());
        for (double &value : result)
          value /= values.linfty_norm();
        return result;
      }

      /** Bisection of the real stepping between two factors of @p guess, to @p accuracy of it:
       * above the limit a random small motion grows without bound. */
      double limit_by_stepping(const double guess, const double accuracy,
                               const unsigned int n_steps)
      {
        double stable = 0.9 * guess, unstable = 1.1 * guess;
        AssertThrow(!grows(stable, n_steps) && grows(unstable, n_steps),
                    dealii::ExcMessage("The limit is not where it was looked for."));
        while (unstable - stable > accuracy * guess)
        {
          const double middle = 0.5 * (stable + unstable);
          (grows(middle, n_steps) ? unstable : stable) = middle;
        }
        return 0.5 * (stable + unstable);
      }

      /** Whether a random small motion grows without bound in so many steps of this size. */
      bool grows(const double time_step, const unsigned int n_steps)
      {
        bool result = false;
        vibrate(time_step, n_steps,
                [&](const unsigned int n, const double energy_over_start)
                { return result = result || (n % 20 == 19 && !(energy_over_start < 1e8)); });
        return result;
      }

      /** Steps from a random small motion. @p ends(step, kinetic energy over that at the start) is
       * evaluated after each step. */
      template <typename Ends>
      void vibrate(const double time_step, const unsigned int n_steps, const Ends &ends)
      {
        reset();
        model->step_groups.first_step = time_step;
        NodalVector &v_hat = model->state.unsmoothed_velocity;
        const auto &constrained = model->conditions->constrained_components();
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double *const x = model->state.initial_position.node(i);
            if (constrained.empty() || !((constrained[i] >> d) & 1u))
              v_hat.node(i)[d] = amplitude *
                                 std::sin(91.7 * x[0] + 57.3 * x[1] + 31.1 * x[2] + 17. * d) *
                                 std::cos(23.9 * x[0] * x[1] + 5. * d);
          }
        v_hat.update_ghosts();
        const double start = model->bridge->kinetic_energy(v_hat);
        Clock clock;
        clock.next_step = time_step;
        for (unsigned int n = 0; n < n_steps; ++n)
        {
          step->evaluate(clock);
          step->complete(clock);
          step->advance(clock);
          clock.advance();
          if (ends(n, model->bridge->kinetic_energy(v_hat) / start))
            return;
        }
      }

      std::unique_ptr<SpectralEstimator<dim>> estimator;

    private:
      using Matrix = dealii::FullMatrix<double>;

      static constexpr double amplitude = 1e-10, amplitude_of_probes = 1e-5;

      void reset()
      {
        model->state.position.copy_from(kept_position);
        model->state.unsmoothed_velocity.set_zero();
        std::size_t k = 0;
        for (Part<dim> &part : model->parts)
        {
          MaterialPoints &points = part.formulation->points();
          for (unsigned int f = 0; f < points.fields().size(); ++f)
            for (unsigned int c = 0; c < points.fields()[f].n_components; ++c, ++k)
              std::copy(kept_points[k].begin(), kept_points[k].end(), points.component(f, c));
        }
        model->step_groups.make(*model);
        // What the bridge has prepared for the coming step is of the old velocity.
        model->bridge->apply_smoothing(model->state.unsmoothed_velocity, model->state.velocity);
      }

      /** K and C from two steps behind. */
      void probe_both(Matrix &elastic, Matrix &viscous)
      {
        const unsigned int n =
            static_cast<unsigned int>(model->state.partition()->n_global()) * dim;
        elastic.reinit(n, n);
        viscous.reinit(n, n);
        probe(1e-3, viscous);
        probe(2e-3, elastic);
        elastic.add(-1., viscous);
        elastic *= 1e3;
        viscous.add(-1e-3, elastic);
      }

      /** √M̂ (s K + C) √M̂⁻¹ for the step s behind, from motions of both signs. */
      void probe(const double step_behind, Matrix &matrix)
      {
        matrix = 0.;
        const auto &partition = *model->state.partition();
        Clock clock;
        clock.previous_step = clock.next_step = step_behind;
        for (unsigned int node = 0; node < partition.n_global(); ++node)
          for (unsigned int d = 0; d < dim; ++d)
            for (const double sign : {1., -1.})
            {
              const NodalVector &change = response_to(node, d, sign, clock);
              for (unsigned int i = 0; i < partition.n_owned(); ++i)
                for (unsigned int c = 0; c < dim; ++c)
                  matrix(static_cast<unsigned int>(partition.global_index(i)) * dim + c,
                         node * dim + d) -= sign * change.node(i)[c] *
                                            std::sqrt(*model->bridge->mass().node(i)) /
                                            (2. * amplitude_of_probes * step_behind);
            }
        MPI_Allreduce(MPI_IN_PLACE, &matrix(0, 0), static_cast<int>(matrix.m() * matrix.n()),
                      MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
      }

      /** By how much a step changes v̂, which is zero but for the component @p d of @p node; x has
       * moved with it where it moves with v. */
      const NodalVector &response_to(const unsigned int node, const unsigned int d,
                                     const double sign, const Clock &clock)
      {
        const auto &partition = *model->state.partition();
        NodalVector &v_hat = model->state.unsmoothed_velocity;
        reset();
        // Prescribed components do not move: their columns stay empty.
        const auto &constrained = model->conditions->constrained_components();
        const bool is_mine =
            partition.owned().is_element(node) &&
            (constrained.empty() || !((constrained[partition.local_index(node)] >> d) & 1u));
        double value = 0;
        if (is_mine)
        {
          const unsigned int i = partition.local_index(node);
          value = sign * amplitude_of_probes / std::sqrt(*model->bridge->mass().node(i));
          v_hat.node(i)[d] = value;
        }
        v_hat.update_ghosts();
        const auto operators = model->bridge->operators();
        if (operators == Bridge::Operators::affine || operators == Bridge::Operators::identity)
        {
          model->bridge->apply_smoothing(v_hat, model->state.velocity);
          for (unsigned int i = 0; i < partition.n_owned(); ++i)
            for (unsigned int c = 0; c < dim; ++c)
              if (constrained.empty() || !((constrained[i] >> c) & 1u))
                model->state.position.node(i)[c] +=
                    clock.previous_step * model->state.velocity.node(i)[c];
          model->state.position.distribute();
          model->bridge->positions_have_changed();
        }
        step->evaluate(clock);
        step->complete(clock);
        step->advance(clock);
        if (is_mine)
          v_hat.node(partition.local_index(node))[d] -= value;
        return v_hat;
      }

      static double largest_eigenvalue(const Matrix &matrix)
      {
        // Lanczos' method, with all vectors kept orthogonal.
        Matrix symmetric(matrix);
        symmetric.symmetrize();
        const auto n = static_cast<unsigned int>(matrix.m());
        std::vector<dealii::Vector<double>> basis;
        std::vector<double> diagonal, beside;
        dealii::Vector<double> x(n), image(n);
        for (unsigned int i = 0; i < n; ++i)
          x[i] = std::sin(1.7 * i * i + 0.3);
        x /= x.l2_norm();
        while (basis.size() < std::min(n, 100u))
        {
          basis.push_back(x);
          symmetric.vmult(image, x);
          diagonal.push_back(x * image);
          for (unsigned int pass = 0; pass < 2; ++pass)
            for (const dealii::Vector<double> &vector : basis)
              image.add(-(image * vector), vector);
          beside.push_back(image.l2_norm());
          if (beside.back() < 1e-12 * matrix.linfty_norm())
            break; // the others have no part in the start
          x.equ(1. / beside.back(), image);
        }
        const auto n_vectors = static_cast<unsigned int>(basis.size());
        dealii::LAPACKFullMatrix<double> small(n_vectors, n_vectors);
        for (unsigned int i = 0; i < n_vectors; ++i)
        {
          small(i, i) = diagonal[i];
          if (i + 1 < n_vectors)
            small(i, i + 1) = small(i + 1, i) = beside[i];
        }
        dealii::Vector<double> values;
        Matrix vectors;
        const double bound = 2. * matrix.linfty_norm() + 1e-300;
        small.compute_eigenvalues_symmetric(-bound, bound, 0., values, vectors);
        return *std::max_element(values.begin(), values.end());
      }

      EnergyLedger ledger;
      std::unique_ptr<MechanicalStep<dim>> step;
      NodalVector kept_position;
      std::vector<std::vector<double>> kept_points;
    };

    extern template class FrozenBody<2>;
    extern template class FrozenBody<3>;

    /** A body whose energies and momenta are booked in each step. */
    struct BookedBody : FrozenBody<3>
    {
      using FrozenBody<3>::FrozenBody;

      EnergyBalance next(const double time_step, const double stable_step)
      {
        clock.next_step = time_step;
        clock.stable_step = stable_step;
        motion.evaluate(clock);
        motion.complete(clock);
        motion.check_now();
        const EnergyBalance balance = ledger.balance(*model, clock);
        motion.advance(clock);
        clock.advance();
        return balance;
      }

      EnergyLedger ledger;
      MechanicalStep<3> motion{*model};
      Clock clock;
    };
  } // namespace testing
} // namespace tombolo
