// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "material_testing.h"
#include "temporary_file.h"
#include "tool_surfaces.h"

#include <tombolo/contact/surfaces/facet_tree.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      using dealii::Tensor;

      bool says(const std::string &message, const std::string &text)
      {
        return message.find(text) != std::string::npos;
      }

      template <typename Error, typename Action>
      std::string message_of(const Action &action)
      {
        try
        {
          action();
        }
        catch (const Error &error)
        {
          return error.what();
        }
        return "nothing was thrown";
      }

      std::string problem_of(const FacetList<3> &list)
      {
        return message_of<std::invalid_argument>([&]() { ClosedSurface<3> surface(list); });
      }

      TEST(ClosedSurface, measures_a_box)
      {
        const ClosedSurface<3> surface(box(Tensor<1, 3>({1., 0., 0.}), Tensor<1, 3>({3., 1., 4.})));
        EXPECT_EQ(surface.vertices.size(), 8u);
        EXPECT_EQ(surface.edge_normals.size(), 18u);
        EXPECT_NEAR(surface.area, 2. * (2. + 8. + 4.), 1e-13);
        EXPECT_NEAR(surface.volume, 8., 1e-13);
        EXPECT_EQ(surface.n_pieces, 1u);
        EXPECT_TRUE(surface.remarks.empty());
        EXPECT_NEAR(surface.vertex_normals[0].norm(), 1., 1e-14);
        for (unsigned int v = 0; v < 8; ++v)
          for (unsigned int d = 0; d < 3; ++d)
            EXPECT_NEAR(std::abs(surface.vertex_normals[v][d]), std::sqrt(1. / 3.), 1e-14);
      }

      TEST(ClosedSurface, is_the_same_from_files_of_every_kind)
      {
        const FacetList<3> list = revolved(stepped, 7);
        const ClosedSurface<3> direct(list);
        EXPECT_EQ(direct.facets.size(), 7u * 8u);
        EXPECT_EQ(direct.vertices.size() + direct.facets.size(), direct.edge_normals.size() + 2);
        std::string polygons = obj_text(list);
        for (const FacetList<3> &read :
             {read_stl(stl_text(list)), read_stl(stl_bytes(list)), read_obj(polygons)})
        {
          const ClosedSurface<3> surface(read);
          EXPECT_EQ(surface.facets.size(), direct.facets.size());
          EXPECT_EQ(surface.vertices.size(), direct.vertices.size());
          EXPECT_NEAR(surface.area, direct.area, 1e-5);
          EXPECT_NEAR(surface.volume, direct.volume, 1e-5);
          EXPECT_TRUE(surface.remarks.empty());
        }
      }

      TEST(ClosedSurface, mends_what_can_be_mended_and_says_so)
      {
        FacetList<3> inside_out = unit_box();
        for (auto &facet : inside_out.facets)
          std::swap(facet.vertex[0], facet.vertex[1]);
        const ClosedSurface<3> turned(inside_out);
        ASSERT_EQ(turned.remarks.size(), 1u);
        EXPECT_PRED2(says, turned.remarks[0], "inside out");
        EXPECT_NEAR(turned.volume, 1., 1e-14);

        for (const unsigned int n : {1u, 3u, 11u})
        {
          FacetList<3> mixed = unit_box();
          for (unsigned int f = 0; f < n; ++f)
            std::swap(mixed.facets[f].vertex[0], mixed.facets[f].vertex[1]);
          const ClosedSurface<3> surface(mixed);
          ASSERT_GE(surface.remarks.size(), 1u);
          EXPECT_PRED2(says, surface.remarks[0],
                       std::to_string(std::min(n, 12u - n)) + " triangles were turned round");
          EXPECT_NEAR(surface.volume, 1., 1e-14);
          for (std::size_t f = 0; f < 12; ++f)
          {
            Tensor<1, 3> center;
            for (const unsigned int v : surface.facets[f].vertex)
              center += surface.vertices[v] / 3.;
            EXPECT_GT((center - Tensor<1, 3>({0.5, 0.5, 0.5})) * surface.facet_normals[f], 0.4);
          }
        }

        FacetList<3> doubled = unit_box();
        doubled.vertices.push_back(doubled.vertices[0]);
        doubled.vertices.push_back(doubled.vertices[3] + Tensor<1, 3>({1e-7, 0., 0.}));
        doubled.vertices.push_back(Tensor<1, 3>({9., 9., 9.})); // of no facet
        doubled.facets.push_back({{0, 8, 1}});
        for (auto &facet : doubled.facets)
          if (facet.vertex[0] == 0 && facet.vertex[1] == 4)
            facet.vertex[0] = 8;
        doubled.facets[3].vertex[0] = doubled.facets[3].vertex[0] == 3 ? 9 : 1;
        const ClosedSurface<3> merged(doubled);
        EXPECT_EQ(merged.facets.size(), 12u);
        EXPECT_EQ(merged.vertices.size(), 8u);
        ASSERT_EQ(merged.remarks.size(), 1u);
        EXPECT_PRED2(says, merged.remarks[0], "1 triangles were left out");
      }

      TEST(ClosedSurface, with_cavities_has_them_counted)
      {
        FacetList<3> hole = box(Tensor<1, 3>({0.2, 0.2, 0.2}), Tensor<1, 3>({0.6, 0.6, 0.6}));
        for (auto &facet : hole.facets)
          std::swap(facet.vertex[0], facet.vertex[1]);
        const ClosedSurface<3> hollow(together(unit_box(), hole));
        EXPECT_EQ(hollow.n_pieces, 2u);
        EXPECT_EQ(hollow.n_cavities, 1u);
        EXPECT_NEAR(hollow.volume, 1. - 0.064, 1e-14);
        for (Tensor<1, 3> &vertex : hole.vertices)
          vertex += Tensor<1, 3>({2., 0., 0.});
        EXPECT_PRED2(says, problem_of(together(unit_box(), hole)), "is inside out, while others");
      }

      TEST(ClosedSurface, that_bounds_no_body_is_refused)
      {
        FacetList<3> list = unit_box();
        list.facets.pop_back();
        EXPECT_PRED2(says, problem_of(list), "it is open: 3 edges");
        list = unit_box();
        list.facets.push_back(list.facets[0]);
        EXPECT_PRED2(says, problem_of(list), "it branches: 3 edges");
        EXPECT_PRED2(says, problem_of(FacetList<3>()), "there are no triangles");
        list = unit_box();
        for (Tensor<1, 3> &vertex : list.vertices)
          vertex[2] *= 1e-5;
        EXPECT_EQ(problem_of(list), "nothing was thrown");
        for (Tensor<1, 3> &vertex : list.vertices)
          vertex[2] *= 1e-3;
        EXPECT_NE(problem_of(list), "nothing was thrown");

        // A corner on the edge of a facet, closed by a triangle without area.
        list = unit_box();
        list.vertices.push_back(0.5 * (list.vertices[4] + list.vertices[0]));
        list.facets[0] = {{8, 4, 6}};
        list.facets.push_back({{0, 8, 6}});
        list.facets.push_back({{0, 4, 8}});
        EXPECT_PRED2(says, problem_of(list), "1 triangles have no area");

        EXPECT_PRED2(says,
                     problem_of(together(
                         unit_box(), box(Tensor<1, 3>({1., 1., 1.}), Tensor<1, 3>({2., 2., 2.})))),
                     "touches itself in the point (1, 1, 1)");
        EXPECT_PRED2(says,
                     problem_of(together(
                         unit_box(), box(Tensor<1, 3>({1., 1., 0.}), Tensor<1, 3>({2., 2., 1.})))),
                     "it branches: 1 edges");
        EXPECT_PRED2(says,
                     problem_of(box(Tensor<1, 3>({1e8, 0., 0.}), Tensor<1, 3>({1e8 + 1., 1., 1.}))),
                     "so far from its own origin");
        EXPECT_PRED2(says, problem_of(box(Tensor<1, 3>(), Tensor<1, 3>({1e200, 1., 1.}))),
                     "is not that of a body");

        // The projective plane in six vertices: closed, every edge in two triangles, one-sided.
        FacetList<3> plane;
        for (const auto &v : {Tensor<1, 3>({0., 0., 1.}), Tensor<1, 3>({1., 0., 0.}),
                              Tensor<1, 3>({0.3, 1., 0.}), Tensor<1, 3>({-0.8, 0.6, 0.2}),
                              Tensor<1, 3>({-0.8, -0.6, 0.1}), Tensor<1, 3>({0.3, -1., 0.5})})
          plane.vertices.push_back(v);
        for (const auto &f : {FacetList<3>::Facet{{0, 1, 2}},
                              {{0, 2, 3}},
                              {{0, 3, 4}},
                              {{0, 4, 5}},
                              {{0, 5, 1}},
                              {{1, 2, 4}},
                              {{2, 3, 5}},
                              {{3, 4, 1}},
                              {{4, 5, 2}},
                              {{5, 1, 3}}})
          plane.facets.push_back(f);
        EXPECT_PRED2(says, problem_of(plane), "it has no inside");
      }

      TEST(ClosedSurface, of_a_polygon_is_mended_and_refused_alike)
      {
        const ClosedSurface<2> square(read_polyline("0,0\n1,0 # a corner\n\n1, 1\n0,1\n0,0\n"));
        EXPECT_EQ(square.facets.size(), 4u);
        EXPECT_NEAR(square.volume, 1., 1e-15);
        EXPECT_NEAR(square.area, 4., 1e-15);
        ASSERT_EQ(square.remarks.size(), 1u);
        const ClosedSurface<2> turned(read_polyline("# clockwise\n0,0\n0,1\n1,1\n1,0\n"));
        EXPECT_NEAR(turned.volume, 1., 1e-15);
        ASSERT_EQ(turned.remarks.size(), 1u);
        EXPECT_NEAR(turned.vertex_normals[0][0], -std::sqrt(0.5), 1e-14);
        const auto problem = [](const std::string &text) {
          return message_of<std::invalid_argument>([&]()
                                                   { ClosedSurface<2> s(read_polyline(text)); });
        };
        EXPECT_PRED2(says, problem("0,0\n1,1\n"), "a body needs 3 sides");
        EXPECT_PRED2(says, problem("0,0\n1,1\n2,2\n"), "it encloses nothing");
        EXPECT_PRED2(says, problem("0,0\n1,0\n1,1\n0,0\n-1,0\n-1,-1\n"), "it branches: 1 corners");
        EXPECT_PRED2(says, problem("# nothing\n"), "there are no sides");
      }

      TEST(ToolFiles, that_are_damaged_are_refused_with_their_line)
      {
        const auto stl = [](const std::string &text)
        { return message_of<MeshFileError>([&]() { read_stl(text); }); };
        const auto obj = [](const std::string &text)
        { return message_of<MeshFileError>([&]() { read_obj(text); }); };
        const auto csv = [](const std::string &text)
        { return message_of<MeshFileError>([&]() { read_polyline(text); }); };
        const std::string text = stl_text(unit_box()), bytes = stl_bytes(unit_box());
        EXPECT_PRED2(says, stl(text.substr(0, text.size() - 40)), "The file ends where");
        EXPECT_PRED2(says, stl(bytes.substr(0, bytes.size() - 7)), "would have 684 bytes, not 677");
        std::string nameless = bytes;
        nameless.replace(0, 5, "model");
        EXPECT_PRED2(says, stl(nameless.substr(0, bytes.size() - 7)),
                     "would have 684 bytes, not 677");
        EXPECT_PRED2(says, stl(nameless + "x"), "would have 684 bytes, not 685");
        nameless[83] = '\xff'; // four thousand million triangles
        EXPECT_PRED2(says, stl(nameless), "it is not whole");
        EXPECT_PRED2(says,
                     stl("\x7f"
                         "ELF\x02\x01"),
                     "This is no STL file");
        std::string infinite = bytes;
        infinite.replace(84 + 50 + 12, 4, std::string("\x00\x00\x80\x7f", 4));
        EXPECT_PRED2(says, stl(infinite), "the triangle 2 has a coordinate that is not finite");
        EXPECT_PRED2(says, stl("solid a\nfacet normal 0 0 0 outer loop\nvertex 0 0 nan\n"),
                     "line 3: \"nan\" is not finite");
        EXPECT_PRED2(says, stl("solid a\nfacet normal 0 0 0 inner\n"),
                     "line 2: \"inner\" stands where \"outer\" should");

        const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
        EXPECT_PRED2(says, obj(corners + "f 1 2 9\n"), "line 5: There is no vertex 9 above");
        EXPECT_PRED2(says, obj(corners + "f 1 2 0\n"), "There is no vertex 0 above");
        EXPECT_PRED2(says, obj(corners + "f -1 -2 -5\n"), "There is no vertex -5 above");
        EXPECT_PRED2(says, obj(corners + "f 1 2\n"), "three vertices or more");
        EXPECT_PRED2(says, obj(corners + "f 1 2 x\n"), "\"x\" stands where the number of a vertex");
        EXPECT_PRED2(says, obj(corners + "v 1 2\n"), "three coordinates");
        EXPECT_PRED2(says, obj(corners + "v 0.2 0.2 0\nf 2 5 4 1\n"), "not convex");
        EXPECT_PRED2(says, obj("PK\x03\x04 zip"), "is no keyword");
        const FacetList<3> fan =
            read_obj("# a comment\nvn 0 0 1\n" + corners + "usemtl steel\nf -4/1/1 -3//1 3/7 4\n");
        ASSERT_EQ(fan.facets.size(), 2u);
        EXPECT_EQ(fan.facets[1].vertex[1], 2u);

        EXPECT_PRED2(says, csv("0,0\n1;0\n"), "line 2: \"1;0\" is not a corner");
        EXPECT_PRED2(says, csv("0,0\n1,inf\n"), "line 2");
        EXPECT_PRED2(says, csv("0,0,0\n"), "is not a corner");
      }

      TEST(ToolFiles, with_bytes_changed_are_read_or_refused)
      {
        const FacetList<3> list = revolved(stepped, 5);
        std::mt19937 generator(3);
        unsigned int n_read = 0, n_refused = 0;
        const auto try_one = [&](std::string text, const auto &read)
        {
          for (unsigned int n = generator() % 4; n-- > 0;)
            text[generator() % text.size()] = static_cast<char>(generator());
          if (generator() % 4 == 0)
            text.resize(generator() % text.size());
          if (generator() % 4 == 0)
            text.insert(generator() % (text.size() + 1), text, 0, generator() % 60);
          try
          {
            ClosedSurface<3> surface(read(text));
            ++n_read;
          }
          catch (const MeshFileError &)
          {
            ++n_refused;
          }
          catch (const std::invalid_argument &)
          {
            ++n_refused;
          }
        };
        for (unsigned int i = 0; i < 1000; ++i)
        {
          try_one(stl_text(list), read_stl);
          try_one(stl_bytes(list), read_stl);
          try_one(obj_text(list), read_obj);
        }
        EXPECT_GT(n_read, 300u);
        EXPECT_GT(n_refused, 1000u);
      }

      template <int dim>
      std::unique_ptr<ContactSurface<dim>> load(const std::string &kind, const std::string &path,
                                                const std::string &entries)
      {
        auto surface =
            make_plugin<ContactSurface<dim>>(kind, "set File = " + path + "\n" + entries);
        surface->load(MPI_COMM_WORLD);
        return surface;
      }

      TEST(FacetedTool, moves_turns_and_is_scaled)
      {
        const TemporaryFile file(stl_bytes(unit_box()), ".STL");
        const auto tool = load<3>("triangles", file.path,
                                  "set Scale = 2\nset Origin = 1, 2, 3\nset Axis = 0, 0, 2\n"
                                  "set Displacement = 0; 0; -t\nset Angle = pi/2*t\n");
        EXPECT_PRED2(says, tool->description(), "12 triangles, 8 vertices, area 24, volume 8");
        EXPECT_TRUE(tool->remarks().empty());
        // At t = 1 it is turned by a quarter: x in [-1, 1], y in [2, 4], z in [2, 4].
        const auto gap = gaps<3>(*tool,
                                 {Tensor<1, 3>({-1., 3., 3.}), Tensor<1, 3>({0.9, 3., 3.}),
                                  Tensor<1, 3>({0., 3., 1.}), Tensor<1, 3>({1.1, 4., 3.}),
                                  Tensor<1, 3>({4., 8., 3.})},
                                 1.);
        EXPECT_NEAR(gap[0], 0., 1e-14);
        EXPECT_NEAR(gap[1], -0.1, 1e-14);
        EXPECT_NEAR(gap[2], 1., 1e-14);
        EXPECT_NEAR(gap[3], 0.1, 1e-14);
        EXPECT_NEAR(gap[4], 5., 1e-14);
        EXPECT_NEAR(
            (tool->normal(Tensor<1, 3>({0.9, 3., 3.}), 1.) - Tensor<1, 3>({1., 0., 0.})).norm(), 0.,
            1e-14);
        EXPECT_NEAR((tool->reference_point(1.) - Tensor<1, 3>({1., 2., 2.})).norm(), 0., 1e-14);
        const auto motion = tool->motion(Tensor<1, 3>({2., 2., 3.}), 1. - 1e-6, 1. + 1e-6);
        EXPECT_NEAR(motion[1] / 2e-6, dealii::numbers::PI / 2., 1e-6);
        EXPECT_NEAR(motion[2] / 2e-6, -1., 1e-9);
      }

      TEST(FacetedTool, in_two_dimensions_is_the_profile_with_the_same_corners)
      {
        const TemporaryFile file("-3,4\n-3,2\n-1,2\n-1,0\n1,0\n1,2\n3,2\n3,4\n", ".csv");
        const std::string rest =
            "set Edge radius = 0.3\nset Origin = 0.2, 0.1\nset Angle = 0.3 + t\n";
        const auto tool = load<2>("polyline", file.path, rest);
        const auto profile = make_plugin<ContactSurface<2>>(
            "profile", "set Corners = 0, 0; 1, 0; 1, 2; 3, 2; 3, 4; 0, 4\n" + rest);
        EXPECT_PRED2(says, tool->description(), "8 sides, 8 corners, length 20, area 16");
        std::mt19937 generator(11);
        std::uniform_real_distribution<double> uniform(-5., 5.);
        std::vector<Tensor<1, 2>> points;
        for (unsigned int i = 0; i < 3000; ++i)
          points.push_back(Tensor<1, 2>({uniform(generator), uniform(generator)}));
        const auto gap = gaps<2>(*tool, points, 0.7), expected = gaps<2>(*profile, points, 0.7);
        unsigned int n_touching = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
        {
          EXPECT_EQ(gap[i] < 0., expected[i] < 0.);
          if (!(expected[i] < 0. && expected[i] > -0.299))
            continue;
          ++n_touching;
          ASSERT_NEAR(gap[i], expected[i], 1e-9);
          ASSERT_NEAR((tool->normal(points[i], 0.7) - profile->normal(points[i], 0.7)).norm(), 0.,
                      1e-7);
        }
        EXPECT_GT(n_touching, 100u);
      }

      TEST(FacetedTool, that_cannot_be_made_is_refused_on_every_rank)
      {
        const auto problem =
            [](const std::string &text, const std::string &extension, const std::string &entries)
        {
          const TemporaryFile file(text, extension);
          return message_of<InputError>(
              [&]() { load<3>("triangles", file.path, "set Origin = 0, 0, 0\n" + entries); });
        };
        const std::string cube = obj_text(unit_box());
        EXPECT_EQ(problem(cube, ".obj", ""), "nothing was thrown");
        EXPECT_PRED2(says, problem(cube, ".ply", ""), "Allowed are .stl and .obj");
        EXPECT_PRED2(says, problem("", ".obj", ""), "The file is empty");
        EXPECT_PRED2(says, problem("v 0 0\n", ".obj", ""), "line 1: A vertex needs");
        EXPECT_PRED2(says, problem(cube.substr(0, cube.size() - 8), ".obj", ""), "it is open");
        EXPECT_PRED2(says, problem(cube, ".obj", "set Edge radius = 0.51\n"),
                     "an edge radius of 0.51 does not fit below the surface");
        EXPECT_EQ(problem(cube, ".obj", "set Edge radius = 0.49\n"), "nothing was thrown");
        EXPECT_PRED2(says, problem(cube, ".obj", "set Scale = 0\n"), "Scale");
        EXPECT_PRED2(says, problem(cube, ".obj", "set Axis = 0, 0, 0\n"), "Axis");
        EXPECT_PRED2(says,
                     message_of<InputError>(
                         []() { load<3>("triangles", "none.stl", "set Origin = 0, 0, 0\n"); }),
                     "There is no such file");
        EXPECT_PRED2(says,
                     message_of<InputError>(
                         []() { load<3>("triangles", "/dev/zero.stl", "set Origin = 0, 0, 0\n"); }),
                     "There is no such file");
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
