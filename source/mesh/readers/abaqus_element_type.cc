// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/abaqus_deck.h>

#include <regex>

namespace tombolo
{
  AbaqusElementType abaqus_element_type(const std::string &name)
  {
    AbaqusElementType type;
    type.name = name;
    static const std::regex solid("(?:D?C3D|CSS|SC)(\\d+).*");
    static const std::regex plane("(?:CPS|CPE|CPEG|DC2D|SFM3D|M3D|R3D|DS|S)(\\d+).*");
    static const std::regex triangle("(?:STRI)(\\d+).*");
    static const std::regex line("(?:T2D|T3D|B2|B3|R2D|RB2D|RB3D|DC1D|SAX)(\\d).*");
    static const std::regex connector(
        "(?:MASS|ROTARYI|SPRING|DASHPOT|CONN|GAP|JOINT|DCOUP|ITS|PIPE|FRAME).*");
    std::smatch match;
    if (std::regex_match(name, match, solid))
      type.dimension = 3;
    else if (std::regex_match(name, match, plane) || std::regex_match(name, match, triangle))
      type.dimension = 2;
    else if (std::regex_match(name, match, line))
      type.dimension = 1;
    else
    {
      type.n_nodes = std::regex_match(name, match, connector) ? 1 : 0;
      return type;
    }
    if (match[1].length() > 2)
      return type;
    type.n_nodes = static_cast<unsigned int>(std::stoul(match[1]));
    if (name.compare(0, 2, "B2") == 0 || name.compare(0, 2, "B3") == 0)
      ++type.n_nodes;
    type.is_rigid = name.compare(0, 2, "R3") == 0 || name.compare(0, 2, "R2") == 0;
    switch (type.dimension)
    {
    case 3:
      type.is_cube = type.n_nodes == 8 || type.n_nodes == 20 || type.n_nodes == 27;
      break;
    case 2:
      type.is_cube = type.n_nodes == 4 || type.n_nodes == 8 || type.n_nodes == 9;
      break;
    default:
      type.is_cube = type.n_nodes == 2 || type.n_nodes == 3;
    }
    return type;
  }

  std::string abaqus_shape_of(const AbaqusElementType &type)
  {
    if (type.dimension == 2)
      return "triangles";
    switch (type.n_nodes)
    {
    case 4:
    case 10:
      return "tetrahedra";
    case 6:
    case 15:
      return "wedges";
    case 5:
    case 13:
      return "pyramids";
    default:
      return "of an unknown shape";
    }
  }
} // namespace tombolo
