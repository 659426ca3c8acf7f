// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/text_scanner.h>

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tombolo
{
  /** What an element type of Abaqus is: the dimension of its shape and its nodes. */
  struct AbaqusElementType
  {
    std::string name;
    unsigned int dimension = 0; ///< zero: a spring, a mass, ...
    unsigned int n_nodes = 0;
    bool is_cube = false;  ///< a line, quadrilateral or hexahedron of degree one or two
    bool is_rigid = false; ///< a rigid surface
  };

  /** The shape that the name of a type tells; n_nodes is zero for those that are not known. */
  AbaqusElementType abaqus_element_type(const std::string &name);

  /** "wedges", ...: of a type that is no line, quadrilateral or hexahedron. */
  std::string abaqus_shape_of(const AbaqusElementType &type);

  /** Elements of one `*ELEMENT`. */
  struct AbaqusElements
  {
    AbaqusElementType type;
    std::vector<long long> numbers;
    std::vector<unsigned int> lines;
    /** type.n_nodes for each element; none where the elements make neither cells nor faces. */
    std::vector<long long> nodes;
  };

  /** One line or half line of a set: numbers from @p first to @p last, or another set. */
  struct AbaqusSetEntry
  {
    unsigned int line = 0;
    long long first = 0;
    long long last = 0;
    long long step = 1;
    bool is_range = false;
    std::string name;     ///< of the other set, empty for numbers
    std::string instance; ///< that the numbers or the set belong to, in front of a dot
  };

  /** `*NSET`, `*ELSET`, or the set that `*NODE` and `*ELEMENT` name. */
  struct AbaqusSet
  {
    std::string name;
    bool is_internal = false;
    std::string instance; ///< of all entries, where it is named
    std::vector<AbaqusSetEntry> entries;
    /** Of a set of nodes: sets of elements whose nodes it takes. */
    std::vector<AbaqusSetEntry> nodes_of_elements;
  };

  /** `*SURFACE`: pairs of elements and a face of them, or nodes. */
  struct AbaqusSurface
  {
    std::string name;
    bool is_of_nodes = false;
    std::vector<AbaqusSetEntry> entries;
    std::vector<std::string> faces; ///< "S1", ...; of each entry; empty: all faces
  };

  /** A part, an instance, or what stands outside of both. */
  struct AbaqusScope
  {
    std::string name;
    unsigned int line = 0;
    std::unordered_map<long long, unsigned int> index_of_node;
    std::vector<std::array<double, 3>> nodes;
    std::vector<AbaqusElements> elements;
    std::vector<AbaqusSet> node_sets;
    std::vector<AbaqusSet> element_sets;
    std::vector<AbaqusSurface> surfaces;

    /** Of an instance: its part, and how it is moved and then turned about the axis from one point
     * to another, by degrees. */
    std::string part;
    std::array<double, 3> translation = {};
    std::array<double, 3> axis_begin = {};
    std::array<double, 3> axis_end = {};
    double angle = 0;
  };

  /** An input file of Abaqus as it stands, sets not yet resolved. */
  struct AbaqusDeck
  {
    AbaqusScope outside; ///< of the assembly, or of a file without parts
    std::vector<AbaqusScope> parts;
    std::vector<AbaqusScope> instances;
    /** Keywords that were left out, each with its number and its first line. */
    std::map<std::string, std::pair<unsigned int, unsigned int>> left_out;
    LinePlaces places;
  };

  /** Names of Abaqus do not differ by case. */
  std::string abaqus_key(std::string_view name);

  /** Reads a file. Throws MeshFileError. @p dim is that of the scene. */
  AbaqusDeck parse_abaqus(const SourceFile &file, unsigned int dim);
} // namespace tombolo
