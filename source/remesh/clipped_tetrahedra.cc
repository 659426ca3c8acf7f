// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/simplex_overlaps.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    constexpr unsigned int most_faces = 8;

    /** A polyhedron with three edges at each vertex, as a graph: the neighbours of every vertex,
     * counterclockwise as seen from outside. */
    struct EdgeGraph
    {
      using Vertex = std::uint8_t;

      unsigned int n = 0;
      std::array<std::array<Vertex, 3>, ClippedTetrahedra::most_vertices> neighbours{};

      unsigned int n_faces() const
      {
        return n / 2 + 2; // Euler, with 3n/2 edges
      }

      unsigned int all() const
      {
        return (1u << n) - 1;
      }

      /** The number of the edge to @p neighbour among those of @p vertex. */
      unsigned int edge_to(const Vertex neighbour, const Vertex vertex) const
      {
        const auto &around = neighbours[vertex];
        return static_cast<unsigned int>(std::find(around.begin(), around.end(), neighbour) -
                                         around.begin());
      }

      /** The edge that follows the one from @p from to @p to on a face: its end. */
      Vertex following(const Vertex from, const Vertex to) const
      {
        return neighbours[to][(edge_to(from, to) + 1) % 3];
      }

      bool is_connected(const unsigned int set) const
      {
        unsigned int seen = set & (~set + 1), front = seen; // the lowest bit
        while (front != 0)
        {
          unsigned int next = 0;
          for (unsigned int v = 0; v < n; ++v)
            if (((front >> v) & 1u) != 0)
              for (const Vertex neighbour : neighbours[v])
                next |= 1u << neighbour;
          front = next & set & ~seen;
          seen |= front;
        }
        return seen == set;
      }

      /** The vertices of each face, counterclockwise or all clockwise. */
      std::vector<std::vector<Vertex>> faces() const
      {
        std::vector<std::vector<Vertex>> result;
        std::array<std::array<bool, 3>, ClippedTetrahedra::most_vertices> is_done{};
        for (Vertex first = 0; first < n; ++first)
          for (unsigned int edge = 0; edge < 3; ++edge)
          {
            Vertex from = first, to = neighbours[first][edge];
            if (is_done[first][edge])
              continue;
            result.emplace_back();
            do
            {
              is_done[from][edge_to(to, from)] = true;
              result.back().push_back(from);
              const Vertex next = following(from, to);
              from = to;
              to = next;
            } while (!is_done[from][edge_to(to, from)]);
          }
        return result;
      }
    };

    using VertexMap = std::array<std::uint8_t, ClippedTetrahedra::most_vertices>;

    /** Whether @p a is @p b with other numbers, where vertex 0 of @p b is @p image and its first
     * neighbour the one across edge @p turn. Finds the numbers. */
    bool are_same(const EdgeGraph &a, const EdgeGraph &b, const std::uint8_t image,
                  const unsigned int turn, VertexMap &numbers)
    {
      constexpr std::uint8_t unknown = 0xFF;
      std::array<unsigned int, ClippedTetrahedra::most_vertices> turns{}, waiting{};
      numbers.fill(unknown);
      numbers[0] = image;
      turns[0] = turn;
      unsigned int n_waiting = 1;
      while (n_waiting > 0)
      {
        const auto v = static_cast<std::uint8_t>(waiting[--n_waiting]);
        for (unsigned int edge = 0; edge < 3; ++edge)
        {
          const std::uint8_t neighbour_b = b.neighbours[v][edge];
          const std::uint8_t neighbour_a = a.neighbours[numbers[v]][(edge + turns[v]) % 3];
          const unsigned int turn_there =
              (a.edge_to(numbers[v], neighbour_a) + 3 - b.edge_to(v, neighbour_b)) % 3;
          if (numbers[neighbour_b] == unknown)
          {
            numbers[neighbour_b] = neighbour_a;
            turns[neighbour_b] = turn_there;
            waiting[n_waiting++] = neighbour_b;
          }
          else if (numbers[neighbour_b] != neighbour_a || turns[neighbour_b] != turn_there)
            return false;
        }
      }
      return true;
    }

    bool find_numbers(const EdgeGraph &a, const EdgeGraph &b, VertexMap &numbers)
    {
      for (std::uint8_t image = 0; image < a.n && a.n == b.n; ++image)
        for (unsigned int turn = 0; turn < 3; ++turn)
          if (are_same(a, b, image, turn, numbers))
            return true;
      return false;
    }

    /** What a plane leaves, if vertices inside and those outside are each connected. The vertices
     * that stay come first. */
    EdgeGraph clip_graph(const EdgeGraph &graph, const unsigned int inside,
                         ClippedTetrahedra::Rest &rest)
    {
      const auto is_inside = [&](const std::uint8_t v) { return ((inside >> v) & 1u) != 0; };
      EdgeGraph result;
      std::array<std::uint8_t, ClippedTetrahedra::most_vertices> number{};
      std::array<std::array<std::uint8_t, 3>, ClippedTetrahedra::most_vertices> on_edge{};
      const auto add = [&](const std::uint8_t from, const std::uint8_t to)
      {
        rest.inside[result.n] = from;
        rest.outside[result.n] = to;
        return static_cast<std::uint8_t>(result.n++);
      };
      for (std::uint8_t v = 0; v < graph.n; ++v)
        if (is_inside(v))
          number[v] = add(v, v);
      for (std::uint8_t v = 0; v < graph.n; ++v)
        for (unsigned int edge = 0; edge < 3 && is_inside(v); ++edge)
          if (!is_inside(graph.neighbours[v][edge]))
            on_edge[v][edge] = add(v, graph.neighbours[v][edge]);
      for (std::uint8_t v = 0; v < graph.n; ++v)
        for (unsigned int edge = 0; edge < 3 && is_inside(v); ++edge)
        {
          std::uint8_t from = v, to = graph.neighbours[v][edge];
          if (is_inside(to))
          {
            result.neighbours[number[v]][edge] = number[to];
            continue;
          }
          // Along the face to the edge at which it comes back.
          const std::uint8_t first = on_edge[v][edge];
          while (!is_inside(to))
          {
            const std::uint8_t next = graph.following(from, to);
            from = to;
            to = next;
          }
          const std::uint8_t second = on_edge[to][graph.edge_to(from, to)];
          result.neighbours[number[v]][edge] = first;
          result.neighbours[first][0] = number[v];
          result.neighbours[first][1] = second;
          result.neighbours[second][2] = first;
        }
      return result;
    }

    /** With the apex that needs the fewest triangles. */
    ClippedTetrahedra::Fan fan_of(const EdgeGraph &graph)
    {
      const auto faces = graph.faces();
      const auto has = [](const std::vector<std::uint8_t> &face, const std::uint8_t v)
      { return std::find(face.begin(), face.end(), v) != face.end(); };
      ClippedTetrahedra::Fan result;
      result.n_triangles = 1000;
      for (std::uint8_t apex = 0; apex < graph.n; ++apex)
      {
        ClippedTetrahedra::Fan fan;
        fan.apex = apex;
        for (auto &corners : fan.triangles)
          corners.fill(apex);
        for (const auto &face : faces)
          for (std::size_t k = 1; k + 1 < face.size() && !has(face, apex); ++k)
          {
            fan.triangles[0][fan.n_triangles] = face[0];
            fan.triangles[1][fan.n_triangles] = face[k];
            fan.triangles[2][fan.n_triangles] = face[k + 1];
            ++fan.n_triangles;
          }
        if (fan.n_triangles < result.n_triangles)
          result = fan;
      }
      return result;
    }
  } // namespace

  const ClippedTetrahedra &ClippedTetrahedra::instance()
  {
    static const ClippedTetrahedra result;
    return result;
  }

  ClippedTetrahedra::ClippedTetrahedra()
  {
    std::vector<EdgeGraph> graphs(1);
    graphs[0].n = 4;
    graphs[0].neighbours = {{{{1, 2, 3}}, {{0, 3, 2}}, {{0, 1, 3}}, {{0, 2, 1}}}};
    for (unsigned int shape = 0; shape < graphs.size(); ++shape)
    {
      const EdgeGraph graph = graphs[shape]; // the list grows
      fans.push_back(fan_of(graph));
      first_rest.push_back(rests.size());
      if (graph.n_faces() == most_faces)
        continue;
      for (unsigned int inside = 0; inside <= graph.all(); ++inside)
      {
        Rest rest;
        const unsigned int outside = graph.all() & ~inside;
        if (inside != 0 && outside != 0 && graph.is_connected(inside) &&
            graph.is_connected(outside))
        {
          Rest in_order;
          const EdgeGraph clipped = clip_graph(graph, inside, in_order);
          VertexMap numbers;
          unsigned int number = 0;
          while (number < graphs.size() && !find_numbers(graphs[number], clipped, numbers))
            ++number;
          if (number == graphs.size())
          {
            graphs.push_back(clipped);
            for (std::uint8_t v = 0; v < numbers.size(); ++v)
              numbers[v] = v;
          }
          rest.is_possible = true;
          rest.shape = static_cast<std::uint8_t>(number);
          rest.n_vertices = static_cast<std::uint8_t>(clipped.n);
          // Entries beyond stay within the shape.
          rest.inside.fill(in_order.inside[0]);
          rest.outside.fill(in_order.inside[0]);
          for (unsigned int v = 0; v < clipped.n; ++v)
          {
            rest.inside[numbers[v]] = in_order.inside[v];
            rest.outside[numbers[v]] = in_order.outside[v];
          }
        }
        rests.push_back(rest);
      }
    }
  }
} // namespace tombolo
