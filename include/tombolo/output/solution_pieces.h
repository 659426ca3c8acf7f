// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/output/output.h>
#include <tombolo/output/vtu_piece.h>

#include <deal.II/base/tensor.h>

#include <cstdint>
#include <functional>
#include <vector>

namespace tombolo
{
  /** How pictures are written, and which fields they have only because they are asked for: entries
   * `Format`, `Precision` and `Further fields`. */
  struct PictureFields
  {
    bool xdmf = false; ///< in one file for all ranks and times of a kind
    bool double_precision = false;
    bool logarithmic_strain = false;
    bool principal_stresses = false;
    bool internal_fields = false; ///< FieldDescription::is_internal

    PictureFields() = default;

    /** Throws InputError for a field that cannot be asked for. */
    explicit PictureFields(const Entries &e);
  };

  /**
   * Values of the fields of material points, and what follows from their stress, for each entity of
   * a picture (cell or particle): the weighted mean of one or several points. Fields are those of
   * all parts of elements, or of particles, the same on all ranks; a part that does not have one
   * has NaN there.
   */
  template <int dim>
  class PointData
  {
  public:
    PointData(const OutputView<dim> &view, const PictureFields &wanted, bool of_particles);

    /** Sets the part of the points of the following add(). */
    void set_part(unsigned int index);

    /** Adds an entity with the weighted mean over points of the part. @p deformation_gradient is
     * called where a strain is written. */
    void add(const std::vector<unsigned int> &indices, const std::vector<double> &weights,
             const std::function<dealii::Tensor<2, dim>()> &deformation_gradient);

    /** Moves the fields to @p data, in the order of the files. Cells leave the volume out, since a
     * mean of the volumes of points has no meaning. */
    void move_to(bool with_volume, VtuPiece::Arrays &data);

    std::vector<std::int64_t> parts; ///< of each entity

  private:
    void add_derived(const std::vector<unsigned int> &indices, const std::vector<double> &weights);

    const OutputView<dim> &view;
    PictureFields wanted;
    std::vector<FieldDescription> fields;
    std::vector<std::vector<double>> values;
    std::vector<double> pressures, von_mises_stresses, exact_stresses, strains;
    std::vector<double> principal[3];

    unsigned int part_index = 0;
    const MaterialPoints *points = nullptr;
    const std::vector<dealii::Point<dim>> *initial_positions = nullptr;
    std::vector<int> own_field; ///< the number of each field in this part, or -1
  };

  /**
   * The surfaces of all contacts of a scene at the present time, for pictures: triangles, lines in
   * two dimensions, and of planes the part next to the bodies. Cells have `contact`, the number of
   * the contact in the field data `contact names`, and of the whole contact `force on the bodies`
   * and `penetration`, the largest. The same on all ranks; without points and cells on those where
   * @p with_facets is false. Collective.
   */
  template <int dim>
  VtuPiece make_tool_piece(const OutputView<dim> &view, bool double_precision,
                           bool with_facets = true);

  /** The cells of this rank's finite elements, with the data that Visualization describes.
   * Collective. */
  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const PictureFields &wanted);

  /** The particles of this rank, with the data that Visualization describes. Collective. */
  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const PictureFields &wanted);
} // namespace tombolo
