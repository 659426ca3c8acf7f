// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/probes.h>

#include <tombolo/base/symmetric_tensors.h>

#include <algorithm>
#include <array>
#include <limits>

namespace tombolo
{
  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, Probes, "probes",
      "Histories of position, displacement, velocity and temperature at "
      "named nodes (probes.csv).")

  namespace
  {
    const OutputOfScene probes_registration(
        1, "probes", "its own Locations, Nodes, Mesh nodes, Where and Boundary",
        [](const Section &output)
        {
          const Section probes = output.subsection("probes");
          for (const char *const entry : {"Locations", "Nodes", "Mesh nodes", "Where", "Boundary"})
            if (probes.is_set(entry))
              return true;
          return false;
        });

    const char *const points_file = "points.csv";

    const OutputOfScene
        points_registration(2, "point history", "its own Locations",
                            [](const Section &output)
                            { return output.subsection("point history").is_set("Locations"); });
  } // namespace

  /**
   * Histories at material points: `points.csv`, whose rows have time, step, and of the point next
   * to each position of `Locations`, by initial positions, the stress (xx, yy, zz, yz, xz, xy), its
   * von Mises stress and the internal variables of material and formulation there. Of points at the
   * same distance the one that comes first by its coordinates is taken. It is searched for in each
   * row, so that it is the one that is there: where cells are divided a point of a child, where
   * they become particles one of these. Where cells can leave there are the columns of all parts;
   * those of others than the present one are empty.
   */
  template <int dim>
  class PointHistory : public History<dim>
  {
  public:
    explicit PointHistory(const Entries &e) : History<dim>(e, points_file)
    {
      e.text("Locations", "", "L",
             "Places of which the stress and what the material remembers are written to "
             "points.csv, by initial coordinates, to which the nearest material point is taken, an "
             "integration point of an element or a particle: a list, separated by semicolons, of "
             "`name: x, y, z`, or without a name.");
      if (!e.declares())
        locations = NamedLocation<dim>::read(e.section(), "Locations", "point");
      e.refuse(locations.empty(), "Locations",
               "give at least one location, for example `root: 0, 0, 0`");
    }

    void check(const OutputView<dim> &view) override
    {
      if (!view.has_mechanics)
        this->section.fail("Locations", "the scene has no mechanics, and no material points");
      const double largest_cell = largest_cell_diameter(*view.nodes);
      alike = 1e-9 * largest_cell;
      for (const NamedLocation<dim> &named : locations)
        if (const double distance = nearest(view, named.location).distance; distance > largest_cell)
          this->section.fail(
              "Locations",
              "the nearest material point is " + format_number(distance) + " away from \"" +
                  named.name + "\", more than the largest cell measures (" +
                  format_number(largest_cell) + "): this place is outside of the body");
      History<dim>::check(view);
    }

  private:
    struct Candidate
    {
      double distance = std::numeric_limits<double>::max();
      Point<dim> initial;
      unsigned int part = 0, point = 0, rank = 0;

      bool is_before(const Candidate &other, const double alike) const
      {
        if (std::abs(distance - other.distance) > alike)
          return distance < other.distance;
        for (unsigned int d = 0; d < dim; ++d)
          if (std::abs(initial[d] - other.initial[d]) > alike)
            return initial[d] < other.initial[d];
        return part != other.part ? part < other.part : rank < other.rank;
      }
    };

    /** The material point next to a position, the same on all ranks. Collective. */
    Candidate nearest(const OutputView<dim> &view, const Point<dim> &location) const
    {
      const MPI_Comm communicator = view.nodes->communicator();
      Candidate best;
      best.rank = Utilities::MPI::this_mpi_process(communicator);
      for (unsigned int p = 0; p < view.parts.size(); ++p)
      {
        const Formulation<dim> &formulation = *view.parts[p].formulation;
        const std::vector<Point<dim>> &initial = formulation.initial_point_positions();
        const MaterialPoints &points = formulation.points();
        for (unsigned int i = 0; i < points.size(); ++i)
        {
          const Candidate other{location.distance(initial[i]), initial[i], p, i, best.rank};
          if (points.component(MaterialPoints::volume, 0)[i] > 0. && other.is_before(best, alike))
            best = other;
        }
      }
      for (const Candidate &other : from_all_ranks(std::vector<Candidate>{best}, communicator))
        if (other.is_before(best, alike))
          best = other;
      return best;
    }

    /** The fields that the next point can have, which is in the part @p present: those of all parts
     * where cells can leave, in their order, else those of this one. */
    static std::vector<FieldDescription> fields_next_to(const OutputView<dim> &view,
                                                        const unsigned int present)
    {
      const bool can_change = std::any_of(view.parts.begin(), view.parts.end(),
                                          [](const OutputPart<dim> &part)
                                          { return part.formulation->can_lose_cells(); });
      std::vector<FieldDescription> fields;
      for (unsigned int p = 0; p < view.parts.size(); ++p)
        for (const FieldDescription &field : view.parts[p].formulation->points().fields())
          if ((can_change || p == present) && !field.is_internal &&
              std::none_of(fields.begin(), fields.end(),
                           [&](const FieldDescription &other) { return other.name == field.name; }))
            fields.push_back(field);
      return fields;
    }

    void add_columns(const OutputView<dim> &view) override
    {
      const MPI_Comm communicator = view.nodes->communicator();
      for (const NamedLocation<dim> &named : locations)
      {
        const Candidate found = nearest(view, named.location);
        const MaterialPoints &points = view.parts[found.part].formulation->points();
        const bool is_here = found.rank == Utilities::MPI::this_mpi_process(communicator) &&
                             found.point < points.size();
        for (const FieldDescription &field : fields_next_to(view, found.part))
        {
          const unsigned int f = points.find_field(field.name);
          const bool has_field = f < points.fields().size();
          if (!has_field && this->table.is_open())
            continue; // its columns are there
          std::vector<double> values(field.n_components, 0.);
          for (unsigned int c = 0; c < field.n_components && is_here && has_field; ++c)
            values[c] = points.component(f, c)[found.point];
          // One rank has the point: the sum only adds zeros to its values.
          Utilities::MPI::sum(std::vector<double>(values), communicator, values);
          const std::string name = named.name + " " + field.name;
          static const std::array<const char *, 6> tensor_suffix = {
              {" xx", " yy", " zz", " yz", " xz", " xy"}};
          for (unsigned int c = 0; c < field.n_components; ++c)
            this->table.add(name + (field.n_components == 1   ? ""
                                    : field.n_components == 6 ? tensor_suffix[c]
                                                              : " " + std::to_string(c + 1)),
                            field.unit, values[c]);
          if (f == MaterialPoints::stress)
            this->table.add(named.name + " von Mises stress", field.unit,
                            von_mises_stress(values.data()));
        }
      }
    }

    std::vector<NamedLocation<dim>> locations;
    double alike = 0; ///< distances that differ by less are equal [L]
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, PointHistory, "point history",
                                  "Histories of stress and of what the material remembers at named "
                                  "material points (points.csv).")
} // namespace tombolo
