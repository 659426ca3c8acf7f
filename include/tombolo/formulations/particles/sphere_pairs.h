// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/formulations/particles/fragment_friction.h>
#include <tombolo/formulations/particles/fragments.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The pairs of particles that can touch: of different fragments of one part, which no chain of
   * bonds connects, debris without bonds among them, or of bodies of different parts that no common
   * node joins; two nodes of elements are none. At planes of symmetry particles also meet the
   * images of others and their own ones, unless a chain of bonds, or between parts a node on the
   * plane, connects both in the whole body. Each node is one particle, with all the volume and mass
   * that it has of these parts.
   *
   * Candidates are found with a skin among all particles of the parts concerned, and kept until
   * something has moved by half a diameter (the mean of the largest ones of its part and of all)
   * relative to anything else: meant for particles that are not too different in size. They are
   * local nodes of a partition of their own, which has no other ghosts.
   */
  template <int dim>
  class SpherePairs
  {
  public:
    using Columns = typename SelfContact<dim>::Columns;

    /** A part whose particles touch others. */
    struct Part
    {
      SelfContact<dim> *contact;
      ParticleFormulation<dim> *particles;
      bool acts = false; ///< whether its particles can be in pairs
      // At the last check.
      unsigned long particles_revision = 0, rows_revision = 0;
    };

    /** The particles of this rank, by row. */
    struct Spheres
    {
      std::vector<dealii::types::global_dof_index> nodes;
      std::vector<double> volumes, masses; ///< in the whole body
      std::vector<unsigned int> laws;      ///< of its parts the number of that with the smallest ω
      std::vector<std::uint64_t> parts;    ///< a bit each
    };

    /** The arguments are of one mesh, and must outlive this. Collective. */
    SpherePairs(std::vector<Part> mesh_parts, const Nodes<dim> &mesh_nodes,
                const Bodies<dim> &mesh_bodies)
        : all_parts(std::move(mesh_parts)), nodes(&mesh_nodes), bodies(&mesh_bodies),
          neighbourhoods(skin), tags(all_parts.size()), former_tags(all_parts.size())
    {
      const Images &images = *nodes->images();
      neighbourhoods.set_images(nodes->images());
      is_between_parts = all_parts.size() > 1 && (bodies->n_bodies() > 1 || !images.empty());
      if (is_between_parts)
        planes = PlanesOfBodies(*bodies, images, nodes->communicator());
    }

    const std::vector<Part> &parts() const
    {
      return all_parts;
    }

    /** Whether bodies of different parts can meet. */
    bool are_between_parts() const
    {
      return is_between_parts;
    }

    /** Fragments and pairs must be found again. */
    void forget()
    {
      are_current = false;
    }

    /** Searches for candidates where that is due. Returns whether there can be any. Collective. */
    bool find_candidates(const NodalVector &position)
    {
      bool has_changed = false, any_acts = false;
      for (Part &part : all_parts)
      {
        const bool acts = is_between_parts || part.contact->is_apart();
        const unsigned long revision = part.contact->particles_revision();
        has_changed =
            has_changed || acts != part.acts || (acts && revision != part.particles_revision);
        if (part.contact->rows_revision() != part.rows_revision)
          are_current = false;
        part.acts = acts;
        part.particles_revision = revision;
        part.rows_revision = part.contact->rows_revision();
        any_acts = any_acts || acts;
      }
      if (has_changed)
        collect_rows();
      if (!any_acts)
        return false;
      present_position.resize(std::size_t(all_rows.size()) * node_stride);
      for (std::size_t i = 0; i < all_rows.size(); ++i)
        std::copy_n(position.node(all_rows.nodes[i]), node_stride,
                    present_position.begin() + static_cast<std::ptrdiff_t>(i * node_stride));
      const MPI_Comm communicator = nodes->communicator();
      if (!has_changed && neighbourhoods.candidates_hold(present_position, supports, communicator))
        return true;
      neighbourhoods.search(all_spheres.nodes, present_position, supports, communicator,
                            candidates);
      const auto &near = neighbourhoods.global_nodes();
      dealii::IndexSet required(nodes->owned().size());
      required.add_indices(near.begin(), near.end());
      own_partition = partition_of(*nodes, required, neighbourhoods.images());
      neighbourhoods.set_partition(*own_partition, candidates);
      has_any_ghosts = dealii::Utilities::MPI::max(
                           own_partition->n_ghosts() + own_partition->n_images(), communicator) > 0;
      are_current = false;
      return true;
    }

    /** Whether pairs are those of the candidates, the rows and the elements. */
    bool is_current() const
    {
      return are_current;
    }

    /** Finds fragments, and pairs of different bodies among the candidates; @p position has ghosts
     * of stencils, @p element_mass is of owned nodes. Columns keep the fragments. Collective. */
    void find_pairs(const NodalVector &position, const NodalVector &element_mass,
                    const std::vector<Columns> &columns)
    {
      for (unsigned int i = 0; i < all_rows.size(); ++i)
        for (std::size_t k = all_rows.start[i]; k < all_rows.start[i + 1]; ++k)
        {
          const auto [part, row] = all_rows.sites[k];
          if (columns[part].labels[upper_label][row] == is_unknown)
            for (unsigned int d = 0; d < dim; ++d)
              columns[part].position[d][row] = position.node(all_rows.nodes[i])[d];
        }
      if (all_parts.size() > 1)
        set_owners(unite_rows(columns), element_mass);
      for (unsigned int p = 0; p < all_parts.size(); ++p)
        if (all_parts[p].acts)
          find_tags(p, position, element_mass, columns[p]);

      all_pairs.start.assign(1, 0);
      all_pairs.partner.clear();
      all_pairs.mirrors.clear();
      const unsigned int n_nodes = own_partition->n_owned() + own_partition->n_ghosts();
      const Images &images = *nodes->images();
      for (unsigned int i = 0; i < all_rows.size(); ++i)
      {
        for (std::size_t entry = candidates.row_start[i]; entry < candidates.row_start[i + 1];
             ++entry)
        {
          const unsigned int other = candidates.neighbour[entry];
          const unsigned int mirrors =
              other < n_nodes
                  ? 0
                  : mirrors_of(own_partition->images()[other - n_nodes].reflection, images);
          if (!are_apart(tags, all_rows.nodes[i], other, mirrors))
            continue;
          all_pairs.partner.push_back(other);
          all_pairs.mirrors.push_back(mirrors);
        }
        all_pairs.start.push_back(all_pairs.partner.size());
      }
      are_current = true;
    }

    /** Whether both ends of a pair were one before as well, with the volumes that they have now. */
    bool were_pair(const unsigned int own, const unsigned int other,
                   const unsigned int mirrors) const
    {
      std::uint64_t common = 1;
      if (all_parts.size() > 1)
      {
        const double *const one = owners.node(own), *const two = owners.node(other);
        if (one[was_known] == 0. || two[was_known] == 0.)
          return false;
        common = static_cast<std::uint64_t>(one[parts_of_node]) &
                 static_cast<std::uint64_t>(two[parts_of_node]);
      }
      for (unsigned int p = 0; p < all_parts.size(); ++p)
        if (((common >> p) & 1u) != 0 && (former_tags[p].node(own)[upper_label] == is_unknown ||
                                          former_tags[p].node(other)[upper_label] == is_unknown))
          return false;
      return are_apart(former_tags, own, other, mirrors);
    }

    const TouchingRows &rows() const
    {
      return all_rows;
    }
    const Spheres &spheres() const
    {
      return all_spheres;
    }
    const FragmentPairs &pairs() const
    {
      return all_pairs;
    }
    /** Has the local nodes of pairs. */
    const std::shared_ptr<const NodePartition> &partition() const
    {
      return own_partition;
    }
    /** Whether it has ghosts or images on any rank. */
    bool has_ghosts() const
    {
      return has_any_ghosts;
    }

  private:
    /** How far the search reaches beyond the largest distance of contact, over that distance. */
    static constexpr double skin = 0.5;

    // What ranks exchange about a particle where there are several parts.
    enum OwnerTag : unsigned int
    {
      parts_of_node, ///< bits, exact up to 50 of them
      body_of_node,
      is_element_node,
      was_known ///< as when pairs were found last
    };

    void collect_rows()
    {
      using Entry = std::pair<dealii::types::global_dof_index, TouchingRows::Site>;
      std::vector<Entry> entries;
      unsigned int n_acting = 0;
      for (unsigned int p = 0; p < all_parts.size(); ++p)
        if (all_parts[p].acts)
        {
          const auto &part_nodes = all_parts[p].contact->particles().nodes;
          for (unsigned int i = 0; i < part_nodes.size(); ++i)
            entries.push_back({part_nodes[i], {p, i}});
          ++n_acting;
        }
      if (n_acting > 1)
        std::stable_sort(entries.begin(), entries.end(),
                         [](const Entry &a, const Entry &b) { return a.first < b.first; });
      all_rows = {};
      all_spheres = {};
      for (const auto &[node, site] : entries)
      {
        const SelfContact<dim> &contact = *all_parts[site.part].contact;
        const ContactParticles &part_particles = contact.particles();
        if (all_spheres.nodes.empty() || all_spheres.nodes.back() != node)
        {
          add_row(node);
          all_rows.ids.push_back(part_particles.ids[site.row]);
          all_rows.shares.push_back(1. / part_particles.copies[site.row]);
          all_spheres.laws.push_back(site.part);
        }
        all_rows.sites.push_back(site);
        all_spheres.volumes.back() += part_particles.volumes[site.row];
        all_spheres.masses.back() += part_particles.masses[site.row];
        all_spheres.parts.back() |= std::uint64_t(1) << site.part;
        if (contact.frequency() < all_parts[all_spheres.laws.back()].contact->frequency())
          all_spheres.laws.back() = site.part;
      }
      all_rows.start.push_back(all_rows.sites.size());

      find_supports();
    }
    void add_row(const dealii::types::global_dof_index node)
    {
      all_rows.start.push_back(all_rows.sites.size());
      all_rows.nodes.push_back(static_cast<unsigned int>(nodes->owned().index_within_set(node)));
      all_spheres.nodes.push_back(node);
      all_spheres.volumes.push_back(0.);
      all_spheres.masses.push_back(0.);
      all_spheres.parts.push_back(0);
    }
    /** By particle: half the largest diameters of its part and of all. Collective. */
    void find_supports()
    {
      // Diameters by part, so that small particles are not candidates of each other as far as large
      // ones of another part reach.
      std::vector<double> largest(all_parts.size(), 0.);
      const auto for_parts = [&](const unsigned int row, const auto &use)
      {
        for (std::size_t k = all_rows.start[row]; k < all_rows.start[row + 1]; ++k)
          use(largest[all_rows.sites[k].part]);
      };
      for (unsigned int i = 0; i < all_rows.size(); ++i)
        for_parts(i, [diameter = std::pow(all_spheres.volumes[i], 1. / dim)](double &part_diameter)
                  { part_diameter = std::max(part_diameter, diameter); });
      dealii::Utilities::MPI::max(largest, nodes->communicator(), largest);
      const double largest_of_all = *std::max_element(largest.begin(), largest.end());
      supports.assign(std::size_t(all_rows.size()) * node_stride, 0.);
      for (unsigned int i = 0; i < all_rows.size(); ++i)
      {
        double own = 0;
        for_parts(i, [&](const double part_diameter) { own = std::max(own, part_diameter); });
        std::fill_n(supports.begin() + static_cast<std::ptrdiff_t>(std::size_t(i) * node_stride),
                    dim, 0.5 * (own + largest_of_all));
      }
    }
    /** Sets the same state in all rows of one particle. Returns which particles existed when pairs
     * were found last, and have not grown since. */
    std::vector<bool> unite_rows(const std::vector<Columns> &columns)
    {
      std::vector<bool> were_known;
      for (unsigned int i = 0; i < all_rows.size(); ++i)
      {
        const auto first = all_rows.sites.begin() + static_cast<std::ptrdiff_t>(all_rows.start[i]),
                   last =
                       all_rows.sites.begin() + static_cast<std::ptrdiff_t>(all_rows.start[i + 1]);
        const auto is_known = [&](const TouchingRows::Site &site)
        { return columns[site.part].labels[upper_label][site.row] != is_unknown; };
        const auto known = std::find_if(first, last, is_known);
        bool has_grown = false;
        for (auto site = first; site != last; ++site)
        {
          has_grown = has_grown || all_parts[site->part].contact->kept.has_grown[site->row];
          if (known == last || is_known(*site))
            continue;
          const Columns &to = columns[site->part], &from = columns[known->part];
          for (unsigned int d = 0; d < dim; ++d)
          {
            to.force[d][site->row] = from.force[d][known->row];
            to.position[d][site->row] = from.position[d][known->row];
          }
          to.shrinkage[site->row] = from.shrinkage[known->row];
        }
        were_known.push_back(known != last && !has_grown);
      }
      return were_known;
    }
    void find_tags(const unsigned int p, const NodalVector &position,
                   const NodalVector &element_mass, const Columns &part_columns)
    {
      NodalVector &now = tags[p], &former = former_tags[p];
      for (NodalVector *const vector : {&now, &former})
        vector->reinit(own_partition, Quantity::scalars);
      SelfContact<dim> &contact = *all_parts[p].contact;
      const Stencils &shape = all_parts[p].particles->stencils();
      const std::vector<FragmentOfParticle> fragments =
          find_fragments(shape, contact.particles().ids, *position.partition(), *nodes->images());
      contact.kept.counts.n_fragments = n_labels_here(fragments, contact.particles().ids);
      std::vector<bool> &has_grown = contact.kept.has_grown;
      const auto &kept = part_columns.labels;
      change_owned({&now, &former},
                   [&]
                   {
                     for (unsigned int i = 0; i < fragments.size(); ++i)
                     {
                       const unsigned int node = shape.particle_node[i];
                       double *const tag = now.node(node), *const former_tag = former.node(node);
                       set_tags(fragments[i], *element_mass.node(node) > 0., tag);
                       former_tag[lower_copies] = tag[lower_copies];
                       for (unsigned int t = 0; t < contact.n_tags(); ++t)
                       {
                         former_tag[t] = has_grown[i] ? is_unknown : kept[t][i];
                         kept[t][i] = tag[t];
                       }
                     }
                   });
      has_grown.assign(has_grown.size(), false);
    }
    void set_owners(const std::vector<bool> &were_known, const NodalVector &element_mass)
    {
      owners = nodal_field(own_partition, Quantity::scalars, all_rows.nodes,
                           [&](const std::size_t i, double *const owner)
                           {
                             owner[parts_of_node] = static_cast<double>(all_spheres.parts[i]);
                             owner[body_of_node] =
                                 static_cast<double>(bodies->body_of(all_spheres.nodes[i]));
                             owner[is_element_node] =
                                 *element_mass.node(all_rows.nodes[i]) > 0. ? 1. : 0.;
                             owner[was_known] = were_known[i] ? 1. : 0.;
                           });
    }
    bool are_apart(const std::vector<NodalVector> &part_tags, const unsigned int own,
                   const unsigned int other, const unsigned int mirrors) const
    {
      if (all_parts.size() == 1)
        return is_pair(part_tags[0].node(own), part_tags[0].node(other), mirrors);
      const double *const one = owners.node(own), *const two = owners.node(other);
      const std::uint64_t common = static_cast<std::uint64_t>(one[parts_of_node]) &
                                   static_cast<std::uint64_t>(two[parts_of_node]);
      if (common == 0)
        return is_between_parts && !(one[is_element_node] != 0. && two[is_element_node] != 0.) &&
               !(one[body_of_node] == two[body_of_node] &&
                 planes.joins(static_cast<dealii::types::global_dof_index>(one[body_of_node]),
                              mirrors));
      for (unsigned int p = 0; p < all_parts.size(); ++p)
        if (((common >> p) & 1u) != 0 &&
            !is_pair(part_tags[p].node(own), part_tags[p].node(other), mirrors))
          return false;
      return true;
    }

    std::vector<Part> all_parts;
    const Nodes<dim> *nodes;
    const Bodies<dim> *bodies;
    PlanesOfBodies planes;
    bool is_between_parts = false;
    TouchingRows all_rows;
    Spheres all_spheres;

    // Rows of candidates have no shape functions.
    std::vector<double> supports, present_position; // node_stride a particle
    Neighbourhoods<dim> neighbourhoods;
    Stencils candidates;
    std::shared_ptr<const NodePartition> own_partition;
    bool has_any_ghosts = false;

    bool are_current = false;
    FragmentPairs all_pairs;
    // By part: the fragment, and whether it is a node of elements; now, and when last found.
    std::vector<NodalVector> tags, former_tags;
    NodalVector owners; // of several parts: see OwnerTag
  };
} // namespace tombolo
