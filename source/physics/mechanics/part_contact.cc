// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/of_all_ranks.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/mesh/planes_of_bodies.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/process.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  /**
   * Contact between bodies of different particle parts that have self-contact: the law of
   * SelfContact between two particles of parts A and B of bodies that no common node joins, with
   *
   * @verbatim
   *   k = μ min(ω_A, ω_B)²,  ω = √s c/h,  b = 2 ζ √(k μ),  ζ = ½ (ζ_A + ζ_B)
   * @endverbatim
   *
   * and the reduced mass μ. Both ends compute the same force from the same numbers, so that
   * momentum is kept to round-off. A particle of several parts takes the least of their ω and ζ.
   * Spheres that overlap initially are made smaller. Every rank gets the particles of all that are
   * in the box around another part: meant for bodies that meet in some places. At planes of
   * symmetry particles also meet the images of others, and one on a plane has the sphere and the
   * mass of the whole body and gets its share of the force.
   */
  template <int dim>
  class PartContact : public Process<dim>
  {
  public:
    /** What a part contributes. */
    struct PartLaw
    {
      unsigned int part; ///< number in the model
      double stiffness;  ///< s
      double damping;    ///< ζ
      double frequency;  ///< ω [1/T], of all ranks
      double mass;       ///< the largest m̂ of its particles, of all ranks [M]
    };

    /** @p laws have the entries of the parts; the other numbers are found. Collective. */
    PartContact(std::vector<PartLaw> of_parts, Model<dim> &model)
        : laws(std::move(of_parts)),
          forces(this->actions.add("contact between parts", ActsAt::positions).stays_on_rank())
    {
      this->roles.rest = ProcessRole::is_refused;
      this->roles.divided_cells = ProcessRole::is_refused;
      for (PartLaw &law : laws)
      {
        const Part<dim> &part = model.parts[law.part];
        const double spacing =
            Utilities::MPI::min(part.particles->smallest_spacing(), model.communicator);
        law.frequency =
            std::sqrt(law.stiffness) * part.material->longitudinal_wave_speed() / spacing;
      }
      this->observed.step_limits.connect(
          [this](const double stable_step, double &fraction)
          { fraction = std::min(fraction, stable_fraction(stable_step)); });
      this->observed.energy("self-contact energy", EnergyKind::stored, stored);
      this->observed.energy("self-contact damping", EnergyKind::dissipated, dissipated);
      this->records.group("contact between parts")
          .list(
              [this, &model](Records &now)
              {
                if (!is_current)
                  collect_particles(model);
                nodes.clear();
                for (const Particle &particle : particles)
                  nodes.push_back(particle.node);
                now.sums("energies", stored, dissipated);
                now.at_nodes(nodes, particles)
                    .vector("force", &Particle::force)
                    .vector("position", &Particle::position);
              });
    }

    void model_changed(const Model<dim> &) override
    {
      is_current = false;
    }

    void add_forces(const Model<dim> &model, const Clock &, const NodalVector &) override
    {
      if (!is_current)
      {
        collect_particles(model);
        shrink_spheres(model);
        is_current = true;
      }
      const std::vector<Sphere> spheres = spheres_nearby(model, model.state.position);
      const std::vector<Point<dim>> places = places_of(spheres);
      const auto tree = pack_rtree_of_indices(places);
      double elastic = 0, work = 0;
      for (Particle &particle : particles)
      {
        const Sphere own = sphere(particle, model, model.state.position);
        const Tensor<1, dim> &x = own.position;
        const Tensor<1, dim> of_others =
            spheres.empty() ? Tensor<1, dim>()
                            : force_on(own, spheres, tree, elastic, 1. / particle.copies);
        work += 0.5 * (particle.force + of_others) * (x - particle.position);
        particle.force = of_others;
        particle.position = x;
        if (of_others.norm_square() != 0.)
          forces.add_force(particle.node, of_others);
      }
      dissipated -= work + elastic - stored;
      stored = elastic;
    }

    double stable_fraction(const double stable_step) const
    {
      // As within a part, with springs that are 2μ/m times those between two equal masses m.
      constexpr double of_pair = 2.42, on_free_side = 5.;
      double fraction = 1.;
      for (const PartLaw &one : laws)
        for (const PartLaw &other : laws)
        {
          if (&one == &other)
            continue;
          const double ratio = one.mass > 0. ? 2. * other.mass / (one.mass + other.mass) : 2.;
          const double angle = std::min(one.frequency, other.frequency) * stable_step;
          const double springs = 4. + of_pair * on_free_side * ratio * angle * angle;
          const double dampers =
              0.5 * of_pair * on_free_side * ratio * 0.5 * (one.damping + other.damping) * angle;
          fraction = std::min(fraction, ContactLaw::stable_fraction(springs, dampers));
        }
      return fraction;
    }

  private:
    /** A particle of this rank: an owned node, once however many parts have it. */
    struct Particle
    {
      unsigned int node;   ///< local
      std::uint64_t parts; ///< a bit for each law
      std::uint64_t body;
      double copies = 1; ///< of it in the whole body: more than one on planes of symmetry
      double volume = 0; ///< initial, in the whole body [L^dim]
      double radius = 0; ///< [L]
      bool has_elements = false;
      dealii::Tensor<1, dim> force, position; ///< of the step before
    };

    /** What other ranks know of a particle. */
    struct Sphere
    {
      std::uint64_t node, parts, body;
      bool has_elements;
      double mass, radius; ///< in the whole body
      Tensor<1, dim> position, velocity;
      unsigned int mirrors; ///< as bits, of an image; 0: it is none
    };

    static std::vector<Point<dim>> places_of(const std::vector<Sphere> &spheres)
    {
      std::vector<Point<dim>> result;
      for (const Sphere &sphere : spheres)
        result.emplace_back(sphere.position);
      return result;
    }

    /** Finds the particles of this rank; keeps what is known of those of before. Collective. */
    void collect_particles(const Model<dim> &model)
    {
      const NodePartition &partition = *model.state.partition();
      std::map<unsigned int, Particle> found;
      for (std::size_t law = 0; law < laws.size(); ++law)
      {
        const ParticleSet<dim> &set = model.parts[laws[law].part].particles->particle_set();
        for (std::size_t i = 0; i < set.nodes().size(); ++i)
        {
          const unsigned int node = partition.local_index(set.nodes()[i]);
          Particle &particle = found.try_emplace(node, Particle{}).first->second;
          particle.node = node;
          particle.parts |= std::uint64_t(1) << law;
          particle.body = model.bodies->body_of(set.nodes()[i]);
          particle.copies = model.nodes->images()->n_own_images(set.nodes()[i]);
          particle.volume += particle.copies * set.initial_volumes()[i];
          particle.has_elements = *model.element_mass.node(node) > 0.;
          particle.position = vector_of<dim>(model.state.position.node(node));
        }
      }
      // Owned nodes keep their local numbers.
      for (const Particle &before : particles)
        if (const auto now = found.find(before.node); now != found.end())
        {
          now->second.force = before.force;
          now->second.position = before.position;
        }
      particles.clear();
      reach = 0;
      for (const auto &entry : found)
      {
        particles.push_back(entry.second);
        Particle &particle = particles.back();
        particle.radius = 0.5 * std::pow(particle.volume, 1. / dim);
        reach = std::max(reach, 2. * particle.radius);
      }
      reach = Utilities::MPI::max(reach, model.communicator);
      planes = PlanesOfBodies(*model.bodies, *model.nodes->images(), model.communicator);
      for (std::size_t law = 0; law < laws.size(); ++law)
      {
        double mass = 0;
        for (const Particle &particle : particles)
          if (((particle.parts >> law) & 1u) != 0)
            mass = std::max(mass, particle.copies * *model.state.mass.node(particle.node));
        laws[law].mass = Utilities::MPI::max(mass, model.communicator);
      }
    }

    /** Adds the images of spheres that are as near to their mirrors as they can touch. */
    void add_images(const Images &images, std::vector<Sphere> &spheres) const
    {
      const std::vector<unsigned int> combinations = images.combinations();
      const std::vector<double> reaches(dim, reach);
      for (std::size_t i = 0, n = spheres.size(); i < n && !combinations.empty(); ++i)
      {
        constexpr double on_mirror = 1e-6;
        const Sphere source = spheres[i];
        const unsigned int near = images.near(source.position.begin_raw(), reaches.data(), 1.);
        const unsigned int on = images.near(source.position.begin_raw(), reaches.data(), on_mirror);
        for (const unsigned int through : combinations)
        {
          if ((near & through) != through || (on & through) != 0)
            continue;
          const Images::Map map = images.map(through);
          Sphere image = source;
          image.mirrors = through;
          for (unsigned int d = 0; d < dim; ++d)
          {
            image.position[d] = map.sign[d] * source.position[d] + map.offset[d];
            image.velocity[d] *= map.sign[d];
          }
          spheres.push_back(image);
        }
      }
    }

    /** Whether both are of one body of the whole. */
    bool are_joined(const Sphere &one, const Sphere &other) const
    {
      const auto body = static_cast<types::global_dof_index>(one.body);
      return one.body == other.body && planes.joins(body, other.mirrors);
    }

    /** Makes spheres smaller until none overlaps at the initial positions. Collective. */
    void shrink_spheres(const Model<dim> &model)
    {
      const std::vector<Sphere> spheres = spheres_nearby(model, model.state.initial_position);
      const std::vector<Point<dim>> places = places_of(spheres);
      const auto tree = pack_rtree_of_indices(places);
      for (Particle &particle : particles)
      {
        const Sphere own = sphere(particle, model, model.state.initial_position);
        double factor = 1.;
        for_partners(own, spheres, tree,
                     [&](const Sphere &other)
                     {
                       factor = std::min(factor, (other.position - own.position).norm() /
                                                     (own.radius + other.radius));
                     });
        particle.radius *= factor;
      }
    }

    Sphere sphere(const Particle &particle, const Model<dim> &model,
                  const NodalVector &position) const
    {
      const NodalState &state = model.state;
      return {state.partition()->global_index(particle.node),
              particle.parts,
              particle.body,
              particle.has_elements,
              particle.copies * *state.mass.node(particle.node),
              particle.radius,
              vector_of<dim>(position.node(particle.node)),
              vector_of<dim>(state.velocity.node(particle.node)),
              0};
    }

    /** The spheres of all ranks in the box around another part, by the number of the node, and
     * their images. Collective. */
    std::vector<Sphere> spheres_nearby(const Model<dim> &model, const NodalVector &position) const
    {
      // Boxes of parts, as the least of (x, -x).
      std::vector<double> box(laws.size() * 2 * dim, std::numeric_limits<double>::max());
      for (const Particle &particle : particles)
        for (std::size_t law = 0; law < laws.size(); ++law)
          for (unsigned int d = 0; d < dim && ((particle.parts >> law) & 1u) != 0; ++d)
          {
            const double x = position.node(particle.node)[d];
            box[(law * dim + d) * 2] = std::min(box[(law * dim + d) * 2], x);
            box[(law * dim + d) * 2 + 1] = std::min(box[(law * dim + d) * 2 + 1], -x);
          }
      Utilities::MPI::min(box, model.communicator, box);
      const auto is_near = [&](const Sphere &of, const std::size_t law)
      {
        bool is_inside = true;
        for (unsigned int d = 0; d < dim; ++d)
          is_inside = is_inside && of.position[d] > box[(law * dim + d) * 2] - reach &&
                      of.position[d] < reach - box[(law * dim + d) * 2 + 1];
        return is_inside;
      };
      std::vector<Sphere> sent;
      for (const Particle &particle : particles)
      {
        const Sphere own = sphere(particle, model, position);
        bool sees_other = false;
        for (std::size_t law = 0; law < laws.size() && !sees_other; ++law)
          sees_other = ((particle.parts >> law) & 1u) == 0 && is_near(own, law);
        if (sees_other)
          sent.push_back(own);
      }
      std::vector<Sphere> result = of_all_ranks(sent, model.communicator);
      add_images(*model.nodes->images(), result);
      return result;
    }

    /** Calls @p action with all spheres that can touch this one, by the number of the node. */
    template <typename Tree, typename Action>
    void for_partners(const Sphere &one, const std::vector<Sphere> &spheres, const Tree &tree,
                      const Action &action) const
    {
      constexpr double beyond_round_off = 1.001;
      const Point<dim> place(one.position);
      BoundingBox<dim> around(std::make_pair(place, place));
      around.extend(beyond_round_off * reach);
      std::vector<std::size_t> near;
      tree.query(boost::geometry::index::intersects(around), std::back_inserter(near));
      std::sort(near.begin(), near.end(),
                [&](const std::size_t a, const std::size_t b)
                {
                  return std::tie(spheres[a].node, spheres[a].mirrors) <
                         std::tie(spheres[b].node, spheres[b].mirrors);
                });
      for (const std::size_t i : near)
        if (const Sphere &other = spheres[i]; (other.parts & one.parts) == 0 &&
                                              !are_joined(one, other) &&
                                              !(other.has_elements && one.has_elements))
          action(other);
    }

    /** The force on @p one; adds its half of what the springs store. Both are this @p share of
     * those in the whole body. */
    template <typename Tree>
    Tensor<1, dim> force_on(const Sphere &one, const std::vector<Sphere> &spheres, const Tree &tree,
                            double &elastic, const double share) const
    {
      Tensor<1, dim> force;
      for_partners(one, spheres, tree,
                   [&](const Sphere &other)
                   {
                     const Tensor<1, dim> offset = other.position - one.position;
                     const double r = offset.norm();
                     const double overlap = one.radius + other.radius - r;
                     if (!(overlap > 0.) || r == 0.)
                       return;
                     const Tensor<1, dim> normal = offset / r;
                     const double approach = -((other.velocity - one.velocity) * normal);
                     const double reduced = one.mass * other.mass / (one.mass + other.mass);
                     const auto least = [&](const Sphere &sphere, double PartLaw::*const what)
                     { return least_of(sphere.parts, what); };
                     const double frequency = std::min(least(one, &PartLaw::frequency),
                                                       least(other, &PartLaw::frequency));
                     const double damping =
                         0.5 * (least(one, &PartLaw::damping) + least(other, &PartLaw::damping));
                     const double spring = reduced * frequency * frequency;
                     force -= (spring * overlap +
                               2. * damping * reduced * frequency * std::max(approach, 0.)) *
                              normal;
                     // Half of it is the other's.
                     elastic += share * 0.25 * spring * overlap * overlap;
                   });
      return share * force;
    }

    /** Of the laws of these parts. */
    double least_of(const std::uint64_t parts, double PartLaw::*const what) const
    {
      double least = std::numeric_limits<double>::max();
      for (std::size_t law = 0; law < laws.size(); ++law)
        if (((parts >> law) & 1u) != 0)
          least = std::min(least, laws[law].*what);
      return least;
    }

    std::vector<PartLaw> laws;
    PlanesOfBodies planes;
    double reach = 0; ///< the largest diameter of all spheres [L]
    std::vector<Particle> particles;
    std::vector<unsigned int> nodes; ///< of these, for the records
    bool is_current = false;         ///< whether particles and spheres are those of the model
    double stored = 0, dissipated = 0;
    Action &forces;
  };

  namespace
  {
    template <int dim>
    class PartContactKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        std::vector<typename PartContact<dim>::PartLaw> laws;
        for (unsigned int p = 0; p < model.parts.size(); ++p)
        {
          const Part<dim> &part = model.parts[p];
          if (part.particles == nullptr || part.particles->fragment_contact() == nullptr)
            continue;
          const Section section = parameters.section("Part: " + part.name);
          const Section law = section.subsection(section.get("Formulation"));
          laws.push_back({p, law.get_double("Self-contact stiffness"),
                          law.get_double("Self-contact damping"), 0., 0.});
        }
        constexpr std::size_t most_parts = 50; // bits of an exact double
        if (laws.size() < 2)
          return nullptr;
        if (laws.size() > most_parts)
          parameters.section("").fail("Parts", "allowed are 50 parts with self-contact.");
        return std::make_unique<PartContact<dim>>(std::move(laws), model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(PartContactKind, process_order::fragment_contact)
} // namespace tombolo
