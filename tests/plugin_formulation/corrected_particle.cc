// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/formulations/particles/nodal_particles.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

using namespace tombolo;

/**
 * A particle method of its own in a shared object: total Lagrangian corrected particles (of the
 * family of smoothed particle hydrodynamics) without smoothing. With d_J = x_J - x_I in the initial
 * configuration and a weight w_J that falls to zero at the support,
 *
 *   φ_J = w_J / Σ w,   ∇φ_J = B w_J d_J for J ≠ I,   ∇φ_I = -Σ_J≠I ∇φ_J,   B = (Σ w_J d_J d_Jᵀ)⁻¹,
 *
 * so that Σ ∇φ_J = 0 (linear momentum) and Σ x_J ⊗ ∇φ_J = 1 (linear fields, angular momentum).
 * doc/add_a_formulation.md walks through it.
 */
template <int dim>
class CorrectedParticle : public NodalParticles<dim>
{
public:
  static void declare_parameters(dealii::ParameterHandler &handler)
  {
    handler.declare_entry("Dilation", "1.8", dealii::Patterns::Double(1.01, 10.),
                          "Half width of a support over the largest distance to a neighbouring "
                          "node, axis by axis. Units: 1.");
  }

  explicit CorrectedParticle(const Section &section) : dilation(section.get_double("Dilation")) {}

  void initialize(const PartSetup<dim> &setup) override
  {
    rows.mass = this->collect_particles(setup, dilation,
                                        [&setup](const typename Nodes<dim>::Cell &cell)
                                        { return setup.part_cells->part_of(cell) == setup.index; });
    this->part_points.initialize(setup.material, setup.heat, setup.has_mechanics);
    this->create_points();
    neighbours.set_images(setup.nodes->images());
    neighbours.search(this->set.nodes(), this->set.padded_initial_positions(),
                      this->set.initial_supports(), setup.communicator, rows);
    fill_rows();
  }

  dealii::IndexSet required_nodes() const override
  {
    dealii::IndexSet nodes(this->set.owned_nodes().size());
    nodes.add_indices(neighbours.global_nodes().begin(), neighbours.global_nodes().end());
    return nodes;
  }

  std::vector<ImageNode> required_image_nodes() const override
  {
    return neighbours.images();
  }

  void set_partition(const NodePartition &partition) override
  {
    neighbours.set_partition(partition, rows);
  }

  const Stencils &stencils() const override
  {
    return rows;
  }

  Stencils &stencils() override
  {
    return rows;
  }

private:
  /** φ and ∇φ of all rows, whose neighbours have the numbers of the search. */
  void fill_rows()
  {
    rows.coefficient_start.assign(rows.row_start.begin(), rows.row_start.end() - 1);
    rows.value.resize(rows.neighbour.size());
    rows.gradient.resize(Stencils::n_gradient * rows.neighbour.size() + 1);
    std::fill(rows.gradient.begin(), rows.gradient.end(), 0.);
    for (unsigned int i = 0; i < rows.n_particles(); ++i)
    {
      const std::size_t begin = rows.row_start[i], end = rows.row_start[i + 1];
      double sum = 0;
      dealii::SymmetricTensor<2, dim> moment;
      for (std::size_t k = begin; k < end; ++k)
      {
        const dealii::Tensor<1, dim> d = offset(i, k);
        const double w = weight(i, d);
        rows.value[k] = w;
        sum += w;
        moment += w * dealii::symmetrize(dealii::outer_product(d, d));
      }
      for (std::size_t k = begin; k < end; ++k)
        rows.value[k] /= sum;
      double scale = 1.;
      for (unsigned int a = 0; a < dim; ++a)
        scale *= moment[a][a];
      if (!(dealii::determinant(moment) > 1e-8 * scale))
      {
        rows.rank_deficient_rows.push_back(i); // too few neighbours: φ without ∇φ
        continue;
      }
      const dealii::SymmetricTensor<2, dim> correction = sum * dealii::invert(moment);
      double *own = nullptr;
      dealii::Tensor<1, dim> other_sum;
      for (std::size_t k = begin; k < end; ++k)
      {
        double *const gradient = rows.gradient.data() + Stencils::n_gradient * k;
        if (rows.neighbour[k] == rows.particle_node[i])
          own = gradient;
        const dealii::Tensor<1, dim> neighbour_gradient = correction * offset(i, k) * rows.value[k];
        other_sum += neighbour_gradient;
        for (unsigned int a = 0; a < dim; ++a)
          gradient[a] = neighbour_gradient[a];
      }
      for (unsigned int a = 0; a < dim; ++a)
        own[a] = -other_sum[a];
    }
  }

  /** x_J - x_I for entry @p k of row @p i. */
  dealii::Tensor<1, dim> offset(const unsigned int i, const std::size_t k) const
  {
    const std::vector<double> &x = neighbours.position_at_search();
    dealii::Tensor<1, dim> result;
    for (unsigned int a = 0; a < dim; ++a)
      result[a] = x[std::size_t(rows.neighbour[k]) * node_stride + a] -
                  x[std::size_t(rows.particle_node[i]) * node_stride + a];
    return result;
  }

  /** (1 - q)⁴ (1 + 4 q) of the distance q over the support of particle @p i, an ellipsoid. */
  double weight(const unsigned int i, const dealii::Tensor<1, dim> &d) const
  {
    double squared = 0;
    for (unsigned int a = 0; a < dim; ++a)
    {
      const double ratio = d[a] / this->set.initial_supports()[i * node_stride + a];
      squared += ratio * ratio;
    }
    const double q = std::min(std::sqrt(squared), 1.);
    return (1. - q) * (1. - q) * (1. - q) * (1. - q) * (1. + 4. * q);
  }

  double dilation;
  Neighbourhoods<dim> neighbours;
  Stencils rows;
};

TOMBOLO_REGISTER_FOR_DIMENSIONS(Formulation, CorrectedParticle, "corrected particle",
                                "total Lagrangian particles with corrected gradients, not smoothed")
