# SPDX-License-Identifier: LGPL-2.1-or-later
"""Element types of Abaqus and CalculiX by their names."""

import re

SOLID = re.compile(r"(?:D?C3D|CSS|SC|F3D)(\d+).*")
PLANE = re.compile(r"(?:CPS|CPE|CPEG|DC2D|SFM3D|M3D|R3D|DS|S)(\d+).*")
TRIANGLE = re.compile(r"(?:STRI)(\d+).*")
LINE = re.compile(r"(?:T2D|T3D|B2|B3|R2D|RB2D|RB3D|DC1D|SAX)(\d).*")
CONNECTOR = re.compile(r"(?:MASS|ROTARYI|SPRING|DASHPOT|CONN|GAP|JOINT|DCOUP|ITS|PIPE|FRAME|D$|U\d).*")
LINK = re.compile(r"SPRING[2A]|DASHPOT[2A]")
CUBES = {3: (8, 20, 27), 2: (4, 8, 9), 1: (2, 3)}


class ElementType:
    """Without nodes it is not known. Connectors have one node and dimension zero."""

    def __init__(self, name):
        self.name, self.dimension, self.n_nodes = name, 0, 0
        self.is_rigid = self.is_cube = False
        self.is_link = bool(LINK.fullmatch(name))
        for dimension, pattern in ((3, SOLID), (2, PLANE), (2, TRIANGLE), (1, LINE)):
            match = pattern.fullmatch(name)
            if match:
                break
        else:
            self.n_nodes = 1 if CONNECTOR.fullmatch(name) else 0
            return
        self.dimension = dimension
        if len(match[1]) > 2:
            return
        self.n_nodes = int(match[1]) + name.startswith(("B2", "B3"))
        self.is_rigid = name.startswith(("R3", "R2"))
        self.is_cube = self.n_nodes in CUBES[dimension]

    def shape(self):
        if self.dimension == 2:
            return "triangles"
        return {4: "tetrahedra", 10: "tetrahedra", 6: "wedges", 15: "wedges", 5: "pyramids",
                13: "pyramids"}.get(self.n_nodes, "of an unknown shape")
