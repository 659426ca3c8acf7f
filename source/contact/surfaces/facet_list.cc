// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/facet_list.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr std::size_t stl_header_bytes = 84, stl_facet_bytes = 50;

    template <int dim>
    void refuse_too_many(const FacetList<dim> &list)
    {
      if (list.facets.size() >= largest_number_of_facets)
        throw MeshFileError("There are more than " + std::to_string(largest_number_of_facets) +
                            " facets. Make the surface coarser.");
    }

    std::uint32_t unsigned_at(const std::string_view bytes, const std::size_t offset)
    {
      std::uint32_t value = 0;
      for (unsigned int k = 4; k-- > 0;)
        value = (value << 8) | static_cast<unsigned char>(bytes[offset + k]);
      return value;
    }

    double float_at(const std::string_view bytes, const std::size_t offset)
    {
      const std::uint32_t bits = unsigned_at(bytes, offset);
      float value;
      std::memcpy(&value, &bits, sizeof(value));
      return value;
    }

    FacetList<3> read_binary_stl(const std::string_view bytes)
    {
      FacetList<3> list;
      const std::size_t n_facets = unsigned_at(bytes, stl_header_bytes - 4);
      if (n_facets > largest_number_of_facets)
        throw MeshFileError("There are " + std::to_string(n_facets) + " triangles; at most " +
                            std::to_string(largest_number_of_facets) +
                            " are allowed. Make the surface coarser.");
      for (std::size_t f = 0; f < n_facets; ++f)
      {
        FacetList<3>::Facet facet;
        for (unsigned int k = 0; k < 3; ++k)
        {
          Tensor<1, 3> point;
          for (unsigned int d = 0; d < 3; ++d)
          {
            // Behind three numbers of the normal.
            point[d] =
                float_at(bytes, stl_header_bytes + stl_facet_bytes * f + 12 + 12 * k + 4 * d);
            if (!std::isfinite(point[d]))
              throw MeshFileError("the triangle " + std::to_string(f + 1) +
                                  " has a coordinate that is not finite.");
          }
          facet.vertex[k] = static_cast<unsigned int>(list.vertices.size());
          list.vertices.push_back(point);
        }
        list.facets.push_back(facet);
      }
      return list;
    }

    std::string in_lower_case(const std::string_view word)
    {
      return boost::to_lower_copy(std::string(word));
    }

    /** Reads a word that must be this one. */
    void expect(TextScanner &scanner, const char *keyword)
    {
      const std::string_view word = scanner.word(keyword);
      if (in_lower_case(word.substr(0, 40)) != keyword)
        scanner.fail("\"" + std::string(word.substr(0, 40)) + "\" stands where \"" + keyword +
                     "\" should.");
    }

    FacetList<3> read_text_stl(const std::string_view text)
    {
      FacetList<3> list;
      TextScanner scanner(text);
      while (!scanner.is_at_end())
      {
        expect(scanner, "solid");
        scanner.rest_of_line(); // a name
        while (true)
        {
          const std::string word =
              in_lower_case(scanner.word("\"facet\" or \"endsolid\"").substr(0, 40));
          if (word == "endsolid")
            break;
          if (word != "facet")
            scanner.fail("\"" + word + "\" stands where \"facet\" or \"endsolid\" should.");
          refuse_too_many(list);
          // The normal of a thin triangle may be no number at all.
          expect(scanner, "normal");
          for (unsigned int d = 0; d < 3; ++d)
            scanner.word("a component of a normal");
          expect(scanner, "outer");
          expect(scanner, "loop");
          FacetList<3>::Facet facet;
          for (unsigned int k = 0; k < 3; ++k)
          {
            expect(scanner, "vertex");
            Tensor<1, 3> point;
            for (unsigned int d = 0; d < 3; ++d)
              point[d] = scanner.real("a coordinate");
            facet.vertex[k] = static_cast<unsigned int>(list.vertices.size());
            list.vertices.push_back(point);
          }
          expect(scanner, "endloop");
          expect(scanner, "endfacet");
          list.facets.push_back(facet);
        }
        scanner.rest_of_line(); // the name again
      }
      return list;
    }

    /** Splits a line at blanks, and before it at a comment. */
    void split(std::string_view line, const char *separators, std::vector<std::string_view> &words)
    {
      words.clear();
      line = line.substr(0, line.find('#'));
      for (std::size_t begin = line.find_first_not_of(separators); begin < line.size();)
      {
        const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(separators, end);
      }
    }

    class ObjReader
    {
    public:
      explicit ObjReader(const std::string_view text) : scanner(text) {}

      FacetList<3> read()
      {
        static const std::set<std::string_view> skipped = {
            "vn", "vt",     "vp",     "g",   "o",     "s",        "l",        "p",
            "mg", "usemtl", "mtllib", "lod", "bevel", "c_interp", "d_interp", "shadow_obj"};
        std::string_view line;
        while (scanner.next_line(line))
        {
          split(line, " \t\r\v\f", words);
          if (words.empty())
            continue;
          if (words[0] == "v")
            add_vertex();
          else if (words[0] == "f")
            add_polygon();
          else if (skipped.count(words[0]) == 0)
            scanner.fail("\"" + std::string(words[0].substr(0, 40)) +
                         "\" is no keyword of a surface of polygons. Needed are lines \"v x y z\" "
                         "and \"f 1 2 3\".");
        }
        return std::move(list);
      }

    private:
      void add_vertex()
      {
        // A weight or a colour may follow.
        if (words.size() < 4)
          scanner.fail("A vertex needs three coordinates.");
        Tensor<1, 3> point;
        for (unsigned int d = 0; d < 3; ++d)
          point[d] = scanner.to_real(words[1 + d], "a coordinate");
        if (list.vertices.size() >= 3 * std::size_t(largest_number_of_facets))
          scanner.fail("There are too many vertices. Make the surface coarser.");
        list.vertices.push_back(point);
      }

      unsigned int vertex(const std::string_view word) const
      {
        // "7", "7/1", "7/1/3", "7//3": the first counts.
        const long long number =
            scanner.to_integer(word.substr(0, word.find('/')), "the number of a vertex");
        const auto n = static_cast<long long>(list.vertices.size());
        const long long index = number < 0 ? n + number : number - 1;
        if (number == 0 || index < 0 || index >= n)
          scanner.fail("There is no vertex " + std::to_string(number) + " above; there are " +
                       std::to_string(n) + ".");
        return static_cast<unsigned int>(index);
      }

      void add_polygon()
      {
        if (words.size() < 4)
          scanner.fail("A face needs three vertices or more.");
        polygon.clear();
        for (std::size_t k = 1; k < words.size(); ++k)
          polygon.push_back(vertex(words[k]));
        const Tensor<1, 3> &first = list.vertices[polygon[0]];
        const auto spanned = [&](const std::size_t k)
        {
          return cross_product_3d(list.vertices[polygon[k]] - first,
                                  list.vertices[polygon[k + 1]] - first);
        };
        Tensor<1, 3> area;
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
          area += spanned(k);
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
        {
          refuse_too_many(list);
          if (polygon.size() > 3 && !(spanned(k) * area > 0.))
            scanner.fail("This polygon is not convex, or three of its corners are on a line. Save "
                         "the surface in triangles.");
          list.facets.push_back({{polygon[0], polygon[k], polygon[k + 1]}});
        }
      }

      TextScanner scanner;
      FacetList<3> list;
      std::vector<std::string_view> words;
      std::vector<unsigned int> polygon;
    };
  } // namespace

  FacetList<3> read_stl(const std::string_view text)
  {
    // Binary files may begin with "solid", too; only their length is certain.
    const bool has_header = text.size() >= stl_header_bytes;
    const std::size_t announced =
        has_header ? stl_header_bytes +
                         stl_facet_bytes * std::size_t(unsigned_at(text, stl_header_bytes - 4))
                   : 0;
    if (text.size() == announced)
      return read_binary_stl(text);
    TextScanner scanner(text);
    if (text.find('\0') == text.npos &&
        in_lower_case(scanner.word("\"solid\"").substr(0, 40)) == "solid")
      return read_text_stl(text);
    std::string message = "This is no STL file: a text begins with \"solid\"";
    if (has_header)
      message += ", and a binary file with this header would have " + std::to_string(announced) +
                 " bytes, not " + std::to_string(text.size()) + ": it is not whole";
    throw MeshFileError(message + ".");
  }

  FacetList<3> read_obj(const std::string_view text)
  {
    return ObjReader(text).read();
  }

  FacetList<2> read_polyline(const std::string_view text)
  {
    FacetList<2> list;
    TextScanner scanner(text);
    std::vector<std::string_view> words;
    std::string_view line;
    while (scanner.next_line(line))
    {
      line = line.substr(0, line.find('#'));
      if (line.find_first_not_of(" \t\r") == line.npos)
        continue;
      const std::size_t comma = line.find(',');
      split(line, ", \t\r", words);
      if (comma == line.npos || words.size() != 2)
        scanner.fail("\"" + std::string(line.substr(0, 40)) +
                     "\" is not a corner: two numbers \"x, y\".");
      refuse_too_many(list);
      Tensor<1, 2> point;
      for (unsigned int d = 0; d < 2; ++d)
        point[d] = scanner.to_real(words[d], "a coordinate");
      const auto number = static_cast<unsigned int>(list.vertices.size());
      list.vertices.push_back(point);
      list.facets.push_back({{number, number + 1}});
    }
    if (!list.facets.empty())
      list.facets.back().vertex[1] = 0;
    return list;
  }
} // namespace tombolo
