// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/hanging_nodes.h>

#include <tombolo/formulations/graded_cells.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** A face of a cell of one part beside cells of half its size of another or the same part. */
    template <int dim>
    struct UnequalFace
    {
      CellId::binary_type cell = {};
      unsigned int face = 0;
      Point<dim> place;
      unsigned int part = 0, fine_part = 0;

      bool operator<(const UnequalFace &other) const
      {
        return cell != other.cell ? cell < other.cell : face < other.face;
      }

      template <typename Archive>
      void serialize(Archive &archive, const unsigned int)
      {
        for (auto &number : cell)
          archive &number;
        archive &face &place &part &fine_part;
      }
    };

    /** The first face of this rank that is refused; none, or one. */
    template <int dim>
    std::vector<UnequalFace<dim>> first_refused_face(const Mesh<dim> &mesh,
                                                     const PartCells<dim> &part_cells,
                                                     const std::vector<Part<dim>> &parts)
    {
      std::vector<UnequalFace<dim>> result;
      for (const auto &cell : mesh.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const unsigned int part = part_cells.part_of(cell);
        for (const unsigned int f : cell->face_indices())
        {
          const auto face = cell->face(f);
          if (cell->at_boundary(f) || !face->has_children())
            continue;
          for (unsigned int child = 0; child < face->n_children(); ++child)
          {
            const unsigned int fine = part_cells.part_of(cell->neighbor_child_on_subface(f, child));
            if (fine == part &&
                dynamic_cast<const GradedCells *>(parts[part].formulation.get()) != nullptr)
              continue;
            const UnequalFace<dim> found{cell->id().template to_binary<dim>(), f, face->center(),
                                         part, fine};
            if (result.empty())
              result.push_back(found);
            result[0] = std::min(result[0], found);
          }
        }
      }
      return result;
    }
  } // namespace

  template <int dim>
  void refuse_hanging_nodes(const Mesh<dim> &mesh, const PartCells<dim> &part_cells,
                            const std::vector<Part<dim>> &parts,
                            const std::vector<Section> &part_sections)
  {
    const auto own = first_refused_face(mesh, part_cells, parts);
    std::vector<UnequalFace<dim>> all;
    for (const auto &of_rank :
         Utilities::MPI::all_gather(mesh.triangulation.get_communicator(), own))
      all.insert(all.end(), of_rank.begin(), of_rank.end());
    if (all.empty())
      return;
    const UnequalFace<dim> &first = *std::min_element(all.begin(), all.end());
    const Section &section = part_sections[first.part];
    std::ostringstream message;
    message << "At (";
    for (unsigned int d = 0; d < dim; ++d)
      message << (d > 0 ? ", " : "") << first.place[d];
    message << ") a cell of the part lies beside cells of half its size";
    if (first.fine_part != first.part)
    {
      message
          << " of the part \"" << part_sections[first.fine_part].name()
          << "\". The size of cells can change inside of a part of \"smoothed cells\" only: let "
             "the part end elsewhere, or change `Refine where` in section Mesh.";
      section.fail("Cells", message.str());
    }
    message << ", and a \"" << section.get("Formulation")
            << "\" takes no nodes in the middle of its faces. Refine all of the part or nothing of "
               "it (`Refine where` in section Mesh), or choose \"smoothed cells\".";
    section.fail("Formulation", message.str());
  }

  template void refuse_hanging_nodes<2>(const Mesh<2> &, const PartCells<2> &,
                                        const std::vector<Part<2>> &, const std::vector<Section> &);
  template void refuse_hanging_nodes<3>(const Mesh<3> &, const PartCells<3> &,
                                        const std::vector<Part<3>> &, const std::vector<Section> &);
} // namespace tombolo
