// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/input_file.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/contact/surfaces/rigid_mesh.h>
#include <tombolo/contact/surfaces/rigid_tool.h>

#include <sstream>
#include <stdexcept>
#include <string>

namespace tombolo
{
  /** A rigid tool whose surface stands in a file: triangles, in two dimensions a closed polygon, in
   * its own coordinates, to which points are transformed: the search tree never moves. */
  template <int dim>
  class FacetedTool : public RigidTool<dim>
  {
  public:
    explicit FacetedTool(const Entries &e)
    {
      section = e.section();
      file = e.text("File", mandatory, "",
                    dim == 2 ? "The outline of the tool: a .csv with a line `x, y` per corner, in "
                               "order; the last is joined to the first. It is looked for in the "
                               "directory of the parameter file and then in the working directory."
                             : "The surface of the tool: an .stl (text or binary), or an .obj with "
                               "triangles or convex polygons. It is looked for in the directory of "
                               "the parameter file and then in the working directory.");
      e.refuse(file.empty(), "File", "The name of the file of the tool is empty.");
      scale =
          e.number("Scale", "1", positive(), "",
                   "Coordinates of the file are multiplied by this, for example 0.001 for a file "
                   "in millimetres in a scene in metres.");
      edge_radius =
          e.number("Edge radius", "0", at_least(0.), "L",
                   "Convex edges and corners are rounded with it, as by a ball that rolls "
                   "inside of the surface. The force on a node that slides over an edge is "
                   "continuous as long as the node is less deep than this.");
      Tensor<1, dim> axis;
      if (dim == 3)
        axis = e.read("Axis", "0, 0, 1", "",
                      "The direction through the tool's origin that `Angle` is about.",
                      &read_direction<dim>);
      this->read_motion(e, axis);
    }

    void load(const MPI_Comm communicator) override
    {
      try
      {
        FacetList<dim> list = read(communicator);
        for (Tensor<1, dim> &vertex : list.vertices)
          vertex *= scale;
        body = RigidMesh<dim>(ClosedSurface<dim>(list), edge_radius);
      }
      catch (const MeshFileError &error)
      {
        section.fail("File", "In \"" + file + "\", " + error.what());
      }
      catch (const std::invalid_argument &error)
      {
        section.fail("File", "The surface bounds no body that can be used: " +
                                 std::string(error.what()) + ".");
      }
    }

    std::string description() const override
    {
      const ClosedSurface<dim> &surface = body.surface();
      std::ostringstream text;
      text << "\"" << file << "\", " << surface.facets.size()
           << (dim == 2 ? " sides, " : " triangles, ") << surface.vertices.size()
           << (dim == 2 ? " corners, length " : " vertices, area ") << surface.area
           << (dim == 2 ? ", area " : ", volume ") << surface.volume << ", own extent ";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? " x " : "") << "[" << surface.low[d] << ", " << surface.high[d] << "]";
      if (dim == 3)
        text << ", thinnest triangle 1:" << static_cast<long>(surface.largest_slenderness);
      if (surface.n_pieces > 1)
        text << ", " << surface.n_pieces << " pieces, of these " << surface.n_cavities
             << " cavities";
      return text.str();
    }

    std::vector<std::string> remarks() const override
    {
      return body.surface().remarks;
    }

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       const double time, std::vector<double> &gap) const override
    {
      gap.resize(nodes.size());
      const Tensor<1, dim> origin = this->origin(time);
      // Axes of the tool as they stand now: components along them are those of the tool.
      const double angle = this->angle(time);
      Tensor<1, dim> axes[dim];
      for (unsigned int d = 0; d < dim; ++d)
      {
        axes[d][d] = 1.;
        axes[d] = this->turned(axes[d], angle);
      }
      for (std::size_t k = 0; k < nodes.size(); ++k)
      {
        const Tensor<1, dim> from_origin = vector_of<dim>(position.node(nodes[k])) - origin;
        Tensor<1, dim> local_point;
        for (unsigned int d = 0; d < dim; ++d)
          local_point[d] = axes[d] * from_origin;
        gap[k] = body.gap_or_less(local_point);
      }
    }

    void set_reach(const double distance) override
    {
      body.set_reach(distance);
    }

    dealii::Tensor<1, dim> normal(const Tensor<1, dim> &point, const double time) const override
    {
      const double angle = this->angle(time);
      const Tensor<1, dim> local_point = this->turned(point - this->origin(time), -angle);
      return this->turned(body.nearest(local_point).normal, angle);
    }

    FacetList<dim> picture(const double time, const Tensor<1, dim> &,
                           const Tensor<1, dim> &) const override
    {
      FacetList<dim> result;
      result.facets = body.surface().facets;
      const Tensor<1, dim> origin = this->origin(time);
      const double angle = this->angle(time);
      for (const Tensor<1, dim> &vertex : body.surface().vertices)
        result.vertices.push_back(origin + this->turned(vertex, angle));
      return result;
    }

  private:
    FacetList<dim> read(const MPI_Comm communicator) const
    {
      const std::string extension = extension_of(file);
      if constexpr (dim == 2)
      {
        if (extension != ".csv")
          section.fail("File", "The kind of the file is told from the end of its name. Allowed is "
                               ".csv.");
        return read_polyline(read_input_file(section, "File", communicator));
      }
      else
      {
        if (extension != ".stl" && extension != ".obj")
          section.fail("File", "The kind of the file is told from the end of its name. Allowed are "
                               ".stl and .obj.");
        const std::string text = read_input_file(section, "File", communicator);
        return extension == ".stl" ? read_stl(text) : read_obj(text);
      }
    }

    Section section;
    std::string file;
    double scale;
    double edge_radius;
    RigidMesh<dim> body;
  };

  TOMBOLO_REGISTER(ContactSurface<2>, FacetedTool<2>, "polyline",
                   "a rigid body by a closed polygon from a file (.csv), moved by functions of "
                   "time or by forces")
  TOMBOLO_REGISTER(ContactSurface<3>, FacetedTool<3>, "triangles",
                   "a rigid body by its closed surface of triangles from a file (.stl, .obj), "
                   "moved by functions of time or by forces")
} // namespace tombolo
