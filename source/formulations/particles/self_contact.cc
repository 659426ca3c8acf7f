// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/self_contact.h>

#include <tombolo/formulations/particles/fragment_tags.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr char force_name[] = "self-contact force";
    constexpr char position_name[] = "self-contact position";
    constexpr char label_name[] = "fragment";
    constexpr char shrinkage_name[] = "contact shrinkage";

    /** How far the search looks beyond the largest distance of contact, over that distance. */
    constexpr double skin = 0.5;

    enum Sphere : unsigned int
    {
      radius,
      mass,
      contact_area
    };

    /** How many fragments have their label from a particle of this rank. */
    unsigned long n_labels_here(const std::vector<FragmentOfParticle> &fragments,
                                const std::vector<std::uint64_t> &ids)
    {
      return std::inner_product(fragments.begin(), fragments.end(), ids.begin(), 0ul, std::plus<>(),
                                [](const FragmentOfParticle &fragment, const std::uint64_t id)
                                { return fragment.label == id; });
    }

    template <int dim>
    double distance(const double *const a, const double *const b)
    {
      double squared = 0;
      for (unsigned int d = 0; d < dim; ++d)
        squared += (b[d] - a[d]) * (b[d] - a[d]);
      return std::sqrt(squared);
    }
  } // namespace

  template <int dim>
  std::unique_ptr<SelfContact<dim>> SelfContact<dim>::create(const Entries &e)
  {
    if (!e.when(e.flag("Self-contact", "false",
                       "Whether particles of fragments that have come apart push each other away, "
                       "debris among them. Wants `Bond failure`, or a total Lagrangian kernel.")))
      return nullptr;
    e.refuse(e.given("Bond failure") == "none" && e.given("Configuration") != "total Lagrangian",
             "Self-contact",
             "where the kernel is renewed and no bond breaks, bodies that come near each other "
             "grow together; choose a `Bond failure`, or `total Lagrangian` as `Configuration`");
    std::unique_ptr<SelfContact<dim>> result(new SelfContact<dim>(e));
    result->friction = FragmentFriction<dim>::create(e);
    return result;
  }

  template <int dim>
  SelfContact<dim>::SelfContact(const Entries &e) : neighbourhoods(skin)
  {
    stiffness = e.number("Self-contact stiffness", "0.05",
                         positive_up_to(10., "; 2 is as stiff as the material."), "",
                         "Of the springs between two particles: times their reduced mass and the "
                         "square of the wave speed over the smallest spacing of the part. Above 0 "
                         "and up to 10; 2 is as stiff as the material, and takes the step down.");
    damping = e.number("Self-contact damping", "0.1", from_to(0., 1.), "",
                       "Of their approach, over the critical one. From 0 to 1.");
  }

  template <int dim>
  std::vector<FieldDescription> SelfContact<dim>::variables() const
  {
    return {{force_name, "M L/T^2", FieldLocation::material_point, 3, true},
            {position_name, "L", FieldLocation::material_point, 3, true, 0., true},
            {label_name, "1", FieldLocation::material_point, n_tags(), true, is_unknown},
            {shrinkage_name, "1", FieldLocation::material_point, 1, true, 0., true}};
  }

  template <int dim>
  unsigned int SelfContact<dim>::n_tags() const
  {
    return images_of_part->empty() ? lower_copies : lower_copies + 1;
  }

  template <int dim>
  void SelfContact<dim>::set_particles(ContactParticles of_part, const double wave_rate,
                                       const MPI_Comm mpi_communicator)
  {
    // Spheres are those of the whole body.
    for (std::size_t i = 0; i < of_part.nodes.size(); ++i)
    {
      of_part.volumes[i] *= of_part.copies[i];
      of_part.masses[i] *= of_part.copies[i];
    }
    shares.clear();
    for (const double copies : of_part.copies)
      shares.push_back(1. / copies);
    has_grown.assign(of_part.nodes.size(), false);
    for (std::size_t i = 0; i < of_part.nodes.size(); ++i)
    {
      const auto found =
          std::lower_bound(particles.nodes.begin(), particles.nodes.end(), of_part.nodes[i]);
      has_grown[i] = found == particles.nodes.end() || *found != of_part.nodes[i] ||
                     particles.volumes[static_cast<std::size_t>(found - particles.nodes.begin())] !=
                         of_part.volumes[i];
    }
    particles = std::move(of_part);
    communicator = mpi_communicator;
    frequency = std::sqrt(stiffness) * Utilities::MPI::max(wave_rate, communicator);
    double largest = 0;
    for (const double volume : particles.volumes)
      largest = std::max(largest, std::pow(volume, 1. / dim));
    largest = Utilities::MPI::max(largest, communicator);
    supports.assign(particles.nodes.size() * node_stride, 0.);
    for (std::size_t i = 0; i < particles.nodes.size(); ++i)
      std::fill_n(supports.begin() + static_cast<std::ptrdiff_t>(i * node_stride), dim, largest);
    is_searched = false;
    pairs_are_current = false;
  }

  template <int dim>
  unsigned long SelfContact<dim>::set_start(const bool grows, const Stencils &shape,
                                            const NodePartition &partition)
  {
    const std::vector<FragmentOfParticle> fragments =
        find_fragments(shape, particles.ids, partition, *images_of_part);
    n_fragments = n_labels_here(fragments, particles.ids);
    unsigned long in_whole_body = 0;
    for (std::size_t i = 0; i < fragments.size(); ++i)
      if (fragments[i].label == particles.ids[i])
        in_whole_body += (1u << images_of_part->all.size()) / fragments[i].n_copies();
    const unsigned long of_all = Utilities::MPI::sum(in_whole_body, communicator);
    is_apart_at_start = grows || of_all > 1;
    return of_all;
  }

  template <int dim>
  bool SelfContact<dim>::update(const NodalVector &position, const bool has_broken_bonds)
  {
    if (!is_searched && !is_apart_at_start && !has_broken_bonds)
      return false;
    const NodePartition &partition = *position.partition();
    present_position.resize(particles.nodes.size() * node_stride);
    for (std::size_t i = 0; i < particles.nodes.size(); ++i)
      std::copy_n(position.node(partition.local_index(particles.nodes[i])), node_stride,
                  present_position.begin() + static_cast<std::ptrdiff_t>(i * node_stride));
    if (is_searched && neighbourhoods.candidates_hold(present_position, supports, communicator))
      return false;
    neighbourhoods.search(particles.nodes, present_position, supports, communicator, candidates);
    is_searched = true;
    pairs_are_current = false;
    const auto &nodes = neighbourhoods.global_nodes();
    const bool is_complete =
        neighbourhoods.images().empty() &&
        std::all_of(nodes.begin(), nodes.end(),
                    [&](const types::global_dof_index node) { return partition.has(node); });
    if (Utilities::MPI::min(is_complete ? 1 : 0, communicator) == 0)
      return true;
    set_partition(partition);
    return false;
  }

  template <int dim>
  void SelfContact<dim>::find_pairs(const NodalVector &position, const NodalVector &element_mass,
                                    const Stencils &shape, MaterialPoints &points)
  {
    const auto &partition = position.partition();
    for (NodalVector *const vector : {&tags, &former_tags, &spheres})
      vector->reinit(partition, Quantity::scalars);
    const std::vector<FragmentOfParticle> fragments =
        find_fragments(shape, particles.ids, *partition, *images_of_part);
    double *kept[node_stride], *former_position[dim];
    for (unsigned int t = 0; t < n_tags(); ++t)
      kept[t] = points.component(points.find_field(label_name), t);
    for (unsigned int d = 0; d < dim; ++d)
      former_position[d] = points.component(points.find_field(position_name), d);
    const double *const shrinkage = points.component(points.find_field(shrinkage_name), 0);
    n_fragments = n_labels_here(fragments, particles.ids);
    for (unsigned int i = 0; i < fragments.size(); ++i)
    {
      const unsigned int node = shape.particle_node[i];
      if (kept[upper_label][i] == is_unknown)
        for (unsigned int d = 0; d < dim; ++d)
          former_position[d][i] = position.node(node)[d];
      double *const tag = tags.node(node), *const former_tag = former_tags.node(node);
      set_tags(fragments[i], *element_mass.node(node) > 0., tag);
      former_tag[lower_copies] = tag[lower_copies];
      for (unsigned int t = 0; t < n_tags(); ++t)
      {
        former_tag[t] = has_grown[i] ? is_unknown : kept[t][i];
        kept[t][i] = tag[t];
      }
      double *const sphere = spheres.node(node);
      sphere[radius] = present_radius(i, shrinkage[i]);
      sphere[mass] = particles.masses[i];
      sphere[contact_area] = std::pow(particles.volumes[i], (dim - 1.) / dim);
    }
    has_grown.assign(has_grown.size(), false);
    for (NodalVector *const vector : {&tags, &former_tags, &spheres})
      vector->update_ghosts();

    pairs.start.assign(1, 0);
    pairs.partner.clear();
    pairs.mirrors.clear();
    const unsigned int n_nodes = partition->n_owned() + partition->n_ghosts();
    for (unsigned int i = 0; i < fragments.size(); ++i)
    {
      for (std::size_t entry = candidates.row_start[i]; entry < candidates.row_start[i + 1];
           ++entry)
      {
        const unsigned int other = candidates.neighbour[entry];
        const unsigned int mirrors =
            other < n_nodes
                ? 0
                : mirrors_of(partition->images()[other - n_nodes].reflection, *images_of_part);
        if (!is_pair(tags.node(shape.particle_node[i]), tags.node(other), mirrors))
          continue;
        pairs.partner.push_back(other);
        pairs.mirrors.push_back(mirrors);
      }
      pairs.start.push_back(pairs.partner.size());
    }
    shrink_spheres(position, points);
    if (friction)
      friction->set_pairs(partition, shape, particles.ids, shares, pairs);
    pairs_are_current = true;
  }

  template <int dim>
  void SelfContact<dim>::shrink_spheres(const NodalVector &position, MaterialPoints &points)
  {
    std::vector<double> factor(particles.nodes.size(), 1.);
    for (unsigned int i = 0; i < factor.size(); ++i)
    {
      const unsigned int own = candidates.particle_node[i];
      const double *const former = former_tags.node(own);
      for (std::size_t entry = pairs.start[i]; entry < pairs.start[i + 1]; ++entry)
      {
        const unsigned int other = pairs.partner[entry];
        const double *const former_of_other = former_tags.node(other);
        const bool was_pair = former[upper_label] != is_unknown &&
                              former_of_other[upper_label] != is_unknown &&
                              is_pair(former, former_of_other, pairs.mirrors[entry]);
        if (!was_pair)
          factor[i] =
              std::min(factor[i], distance<dim>(position.node(own), position.node(other)) /
                                      (spheres.node(own)[radius] + spheres.node(other)[radius]));
      }
    }
    double *const shrinkage = points.component(points.find_field(shrinkage_name), 0);
    spheres.fill(candidates.particle_node,
                 [&](const std::size_t i, double *const sphere)
                 {
                   shrinkage[i] = 1. - (1. - shrinkage[i]) * factor[i];
                   sphere[radius] = present_radius(static_cast<unsigned int>(i), shrinkage[i]);
                 });
  }

  template <int dim>
  void SelfContact<dim>::find_touching(const NodalVector &position)
  {
    is_touching.assign(particles.nodes.size(), false);
    for (unsigned int i = 0; i < is_touching.size(); ++i)
    {
      const unsigned int own = candidates.particle_node[i];
      for (std::size_t entry = pairs.start[i]; entry < pairs.start[i + 1] && !is_touching[i];
           ++entry)
        is_touching[i] = distance<dim>(position.node(own), position.node(pairs.partner[entry])) <
                         spheres.node(own)[radius] + spheres.node(pairs.partner[entry])[radius];
    }
  }

  template <int dim>
  void SelfContact<dim>::add_forces(const MechanicalInput &input, const NodalVector &element_mass,
                                    const Stencils &shape, MaterialPoints &points,
                                    NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                                    const FragmentHeat &heat)
  {
    if (!is_searched)
      return;
    const NodalVector &position = *input.position, &velocity = *input.velocity;
    if (!pairs_are_current)
      find_pairs(position, element_mass, shape, points);
    std::array<double *, dim> former_force, former_position;
    for (unsigned int d = 0; d < dim; ++d)
    {
      former_force[d] = points.component(points.find_field(force_name), d);
      former_position[d] = points.component(points.find_field(position_name), d);
    }
    if (friction)
    {
      std::array<const double *, dim> begin;
      std::copy(former_position.begin(), former_position.end(), begin.begin());
      find_touching(position);
      friction->begin_step(position, begin, is_touching, shape, heat);
    }
    double elastic = 0, work = 0;
    n_touching = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const unsigned int own = shape.particle_node[i];
      const double *const x = position.node(own), *const v = velocity.node(own);
      const double *const sphere = spheres.node(own);
      double force[dim] = {};
      Tensor<1, dim> along;
      for (std::size_t entry = pairs.start[i]; entry < pairs.start[i + 1]; ++entry)
      {
        const unsigned int other = pairs.partner[entry];
        const double *const of_other = spheres.node(other);
        const double reach = sphere[radius] + of_other[radius];
        const double r = distance<dim>(x, position.node(other));
        if (!(r < reach) || r == 0.)
          continue;
        Tensor<1, dim> normal;
        double approach = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          normal[d] = (position.node(other)[d] - x[d]) / r;
          approach -= (velocity.node(other)[d] - v[d]) * normal[d];
        }
        const double reduced = sphere[mass] * of_other[mass] / (sphere[mass] + of_other[mass]);
        const double spring = reduced * frequency * frequency;
        const double push =
            spring * (reach - r) + 2. * damping * reduced * frequency * std::max(approach, 0.);
        for (unsigned int d = 0; d < dim; ++d)
          force[d] -= push * normal[d];
        elastic += shares[i] * 0.25 * spring * (reach - r) * (reach - r); // of this end
        if (friction)
          along += friction->rub({i, entry, own, other, normal, r * sphere[radius] / reach,
                                  r * of_other[radius] / reach, push, spring,
                                  std::min(sphere[contact_area], of_other[contact_area])},
                                 input.time_increment, heat);
      }
      bool touches = false;
      for (unsigned int d = 0; d < dim; ++d)
      {
        force[d] *= shares[i];
        work += 0.5 * (former_force[d][i] + force[d]) * (x[d] - former_position[d][i]);
        former_force[d][i] = force[d];
        former_position[d][i] = x[d];
        loads.node(own)[d] += force[d] + shares[i] * along[d];
        touches = touches || force[d] != 0.;
      }
      if (touches)
        loaded_nodes.push_back(own);
      n_touching += touches ? 1 : 0;
    }
    dissipated -= work + elastic - stored;
    stored = elastic;
    if (friction)
      friction->end_step(shape, heat, loads);
  }

  template <int dim>
  double SelfContact<dim>::stable_fraction(const double stable_step) const
  {
    // Sums over the pairs of a particle by Gershgorin's theorem. Dampers act on the approach alone.
    constexpr double of_pair = 2.42, on_free_side = 5., around = 12.;
    const double angle = frequency * stable_step;
    const auto fraction = [&](const double of_body, const double n_pairs)
    {
      const double springs = of_body + of_pair * n_pairs * angle * angle;
      const double dampers = 0.5 * of_pair * n_pairs * damping * angle;
      return (std::sqrt(dampers * dampers + 4. * springs) - dampers) / springs;
    };
    const double of_debris = angle > 0. ? fraction(0., around) : 1.;
    return std::min({1., fraction(4., on_free_side), of_debris});
  }

  template <int dim>
  void SelfContact<dim>::account(EnergyAccounts &accounts) const
  {
    accounts.add("self-contact energy", EnergyKind::stored,
                 friction ? stored + friction->stored() : stored);
    accounts.add("self-contact damping", EnergyKind::dissipated, dissipated);
    if (friction)
      accounts.add("self-contact friction", EnergyKind::dissipated, friction->dissipated());
  }

  template <int dim>
  void SelfContact<dim>::list(Records &records)
  {
    records.sums("energies", stored, dissipated);
    if (friction)
      records.archived([this](StateArchive &archive)
                       { friction->serialize(archive, particles.ids); });
    records.on_reading(
        [this]
        {
          is_searched = pairs_are_current = false;
          has_grown.assign(has_grown.size(), false);
        });
  }

  template class SelfContact<2>;
  template class SelfContact<3>;
} // namespace tombolo
