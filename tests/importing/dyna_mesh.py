#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes of keyword files of LS-DYNA.

    dyna_mesh.py PROJECT_DIRECTORY
"""

from deck_testing import DeckTest, card, main, replaced, text_of

NODES = """$# LS-DYNA keyword file
*KEYWORD
*TITLE
$# title
two cubes, 1
*NODE
$#   nid               x               y               z      tc      rc
       1             0.0             0.0             0.0       0       0
       2             1.0             0.0             0.0
       3             1.0             1.0             0.0
       4             0.0             1.0             0.0
       5             0.0             0.0             1.0
       6             1.0             0.0             1.0
       7             1.0             1.0             1.0
       8             0.0             1.0             1.0
       9             2.0             0.0             0.0
      10             2.0             1.0             0.0
      11             2.0             0.0             1.0
      12             2.0             1.0             1.0
"""
PARTS = """*PART
$# title
bullet
$#     pid     secid       mid     eosid      hgid
        11         1         1
wall
        22         1         2
"""
ONE_CARD = """*ELEMENT_SOLID
$#   eid     pid      n1      n2      n3      n4      n5      n6      n7      n8
       1      11       1       2       3       4       5       6       7       8
       2      22       2       9      10       3       6      11      12       7
"""
TWO_CARDS = """*ELEMENT_SOLID (ten nodes format)
       1      11
       1       2       3       4       5       6       7       8       0       0
       2      22
       2       9      10       3       6      11      12       7
"""
COMMAS = "*ELEMENT_SOLID\n1,11,1,2,3,4,5,6,7,8\n2,22\n2,9,10,3,6,11,12,7\n"
SETS = """*SET_NODE_LIST_TITLE
struck end
         1       0.0       0.0       0.0       0.0
         1         4         5         8
*SET_SEGMENT
         7
         9        10        12        11       0.0       0.0       0.0       0.0
*SET_SOLID_TITLE
half
         3
         1
*SET_PART_LIST
         4
        11        22
*CONTROL_TERMINATION
       1.0
*MAT_ELASTIC
         1     7.85       1.0
*END
what follows is not read
"""
ALL = NODES + ONE_CARD + PARTS + SETS
SECOND = "       2      22       2       9      10       3       6      11      12       7"


class DynaMesh(DeckTest):
    def k(self, text, dimension=3):
        return self.mesh(text, "deck.k", dimension)

    def test_elements_on_one_card_and_on_two(self):
        for elements in (ONE_CARD, TWO_CARDS, COMMAS):
            result = self.converted(NODES + elements + PARTS + SETS, "deck.k", is_mesh_alone=True)
            mesh = result.mesh
            self.assertEqual(len(mesh.cells), 2)
            for group, value in (("bullet", 1), ("part 11", 1), ("wall", 1), ("part 22", 1), ("half", 1),
                                 ("part set 4", 2)):
                self.assert_volume(mesh, group, value)
            self.assert_area(mesh, "struck end", 1)
            self.assert_area(mesh, "segment set 7", 1)
            said = "\n".join(result.report.summary())
            self.assertIn("*CONTROL_TERMINATION (1 time", said)
            self.assertIn("*MAT_ELASTIC (1 time", said)

    def test_wide_fields(self):
        points = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
        text = "*KEYWORD LONG=Y\n*NODE\n" + "".join(
            card(n, *map(float, point), width=20) + "\n" for n, point in enumerate(points, 1))
        text += "*ELEMENT_SOLID\n" + card(1, 5, width=20) + "\n" + card(*range(1, 9), width=20) + "\n*END\n"
        self.assert_volume(self.mesh(text, "deck.key"), "part 5", 1)

    def test_a_set_that_cuts_a_part_is_a_group_beside_it(self):
        mesh = self.k(NODES + replaced(ONE_CARD, ("2      22", "2      11")) + SETS)
        self.assert_volume(mesh, "part 11", 2)
        self.assert_volume(mesh, "half", 1)

    def test_names_are_told_apart(self):
        text = NODES + ONE_CARD + replaced(PARTS, ("\nwall\n", "\nbullet\n")) + replaced(
            SETS, ("*SET_SEGMENT\n", "*SET_SEGMENT_TITLE\nrear, #end\n"))
        mesh = self.k(text)
        self.assert_volume(mesh, "bullet", 1)
        self.assert_volume(mesh, "bullet (part 22)", 1)
        self.assert_area(mesh, "rear end", 1)
        self.assert_remark(mesh, 'cannot stand in a parameter file: it is called "rear end"')

    def test_a_plane_of_shells(self):
        mesh = self.k(NODES + "*ELEMENT_SHELL\n       1       3       1       2       3       4\n"
                      "       2       3       2       9      10       3\n*SET_SEGMENT\n         5\n         1         4\n", 2)
        self.assert_volume(mesh, "part 3", 2)
        self.assert_area(mesh, "segment set 5", 1)

    def test_shells_on_solids_are_boundaries_and_others_are_left_out(self):
        mesh = self.k(NODES + "      21             0.0             0.0             9.0\n" + ONE_CARD +
                      replaced(PARTS, ("*PART\n", "*PART\ncoat\n        33\n")) +
                      "*ELEMENT_SHELL\n7,33,1,4,8,5\n8,33,1,4,8,8\n9,44,21,1,4,5\n")
        self.assert_area(mesh, "coat", 1)
        self.assertEqual(list(mesh.surfaces), ["coat"])
        self.assert_remark(mesh, '"part 44" has 1 faces that are no faces')
        self.assert_remark(mesh, "*ELEMENT_SHELL of three nodes (1 time")

    def test_sets_of_sets_of_parts_and_of_elements(self):
        mesh = self.k(ALL.replace("*CONTROL_TERMINATION", "*SET_PART_ADD\n" + card(9) + "\n" + card(4) + "\n"
                                  "*SET_NODE_GENERAL\n" + card(8) + "\n" + card("PART", 11) + "\n" + card("DNODE", 1, 2) +
                                  "\n*SET_NODE_ADD\n" + card(7) + "\n" + card(8, 7) + "\n*CONTROL_TERMINATION"))
        self.assert_volume(mesh, "part set 9", 2)
        self.assertEqual(len(mesh.node_sets["node set 8"]), 6)
        self.assertEqual(mesh.node_sets["node set 7"], mesh.node_sets["node set 8"])

    def test_segments_of_parts_and_single_ones(self):
        def area_of(*options):
            text = "*SET_SEGMENT_GENERAL\n" + card(8) + "\n" + "".join(card(*option) + "\n" for option in options)
            return self.k(ALL.replace("*CONTROL_TERMINATION", text + "*CONTROL_TERMINATION"))
        self.assert_area(area_of(("PART", 11)), "segment set 8", 5)
        self.assert_area(area_of(("PART", 11, 22)), "segment set 8", 10)
        self.assert_area(area_of(("PART", 11), ("DSEG", 1, 4, 8, 5)), "segment set 8", 4)
        self.assert_area(area_of(("PART", 11, 22), ("DPART", 22), ("SEG", 1, 4, 8, 5)), "segment set 8", 5)
        self.assertNotIn("segment set 8", area_of(("BOX", 1)).surfaces)

    def test_files_that_are_transformed(self):
        self.write("block.k", "*KEYWORD\n" + NODES[NODES.index("*NODE"):] + ONE_CARD + PARTS + SETS[:SETS.index("*CONTROL")])
        include = "\n".join(("*INCLUDE_TRANSFORM", "block.k", card(100, 200, 300, 0, 400, 0, 0), card(0),
                             card(1, 1, 0.5), card(7)))
        move = "*DEFINE_TRANSFORMATION\n" + card(7) + "\n" + card("SCALE", 2, 1, 1) + "\n" + card("TRANSL", 0, 0, 5) + "\n"
        mesh = self.k("*KEYWORD\n" + NODES[NODES.index("*NODE"):] + ONE_CARD + PARTS + move + include + "\n*END\n")
        self.assert_volume(mesh, "part 11", 1)
        self.assert_volume(mesh, "part 311", 0.25)
        self.assert_area(mesh, "segment set 407", 0.25)
        self.assertEqual(mesh.points[mesh.numbers.index(107)], (1.0, 0.5, 5.5))
        turn = replaced(move, (card("SCALE", 2, 1, 1), card("ROTATE", 0, 0, 1, 0, 0, 0, 90)))
        mesh = self.k("*KEYWORD\n" + turn + include + "\n*END\n")
        self.assertEqual(mesh.points[mesh.numbers.index(109)], (0.0, 1.0, 5.0))
        self.assertIn("FCTMAS of *INCLUDE_TRANSFORM is not allowed", self.error(
            "*KEYWORD\n" + move + replaced(include, (card(1, 1, 0.5), card(1000, 1, 0.5))) + "\n*END\n", "deck.k"))

    def test_what_is_not_read_is_refused_with_line_and_remedy(self):
        cases = [(replaced(ALL, (SECOND, element)), message) for element, message in (
            ("2,22,2,9,10,3,3,3,3,3", "line 23: An element is a tetrahedron"),
            ("2,22\n2,9,10,3", "line 23: An element is a tetrahedron of 4 nodes"),
            ("2,22\n2,9,10,3,6,11,12,7,1,4", "An element is a tetrahedron of 10 nodes"),
            ("2,22,2,9,10,3,6,6,11,11", "line 23: An element is a wedge"),
            ("2,22,2,9,10,3,6,6,6,6", "line 23: An element is a pyramid"),
            ("2,22,2,9,10,3,6,11,12", "has 8 nodes, and this one has 7"),
            ("2,22,2,9,10,3,6,11,12,77", "line 23: There is no node of number 77"),
            ("1,22,2,9,10,3,6,11,12,7", "There are two elements of number 1"),
            ("2,0,2,9,10,3,6,11,12,7", "The number 0 of a part"),
            ("2,22,x,9,10,3,6,11,12,7", '"x" stands where a number of an element'))]
        cases += [(replaced(ALL, (old, new)), message) for old, new, message in (
            ("*ELEMENT_SOLID\n", "*ELEMENT_SOLID_TET4TOTET10\n", "no hexahedra"),
            ("*ELEMENT_SOLID\n", "*ELEMENT_SOLID_ORTHO\n", "*ELEMENT_SOLID_ORTHO is not allowed"),
            ("         1         4         5         8\n", "         1        44\n", "There is no node of number 44"),
            ("*SET_SOLID_TITLE\nhalf\n         3\n         1\n", "*SET_SOLID_TITLE\nhalf\n         3\n         9\n",
             'There is no element of number 9, which the set "half" names'),
            ("         9        10        12        11", "         9        10        12        12",
             "A segment is a triangle"),
            ("       2             1.0", "       1             1.0", "line 9: There are two nodes of number 1"),
            ("       2             1.0", "       2             1.x",
             'line 9: "1.x" stands where a coordinate of a node should'),
            ("*PART\n", "*NODE_TRANSFORM\n1,1\n*PART\n", "it makes or moves nodes"))]
        cases += [("1, 2\n", "stands before the first keyword"), ("*KEYWORD\n*END\n", "There is no section *NODE")]
        for text, message in cases:
            with self.subTest(message):
                self.assertIn(message, self.error(text, "deck.k"))
        self.assertIn("There are solid elements, and the scene has two dimensions", self.error(ALL, "deck.k", 2))

    def test_a_deck_without_hexahedra_is_refused(self):
        text = text_of("bar.k").replace("*ELEMENT_SOLID", "*ELEMENT_BEAM")
        self.assertIn("there are no hexahedra (*ELEMENT_SOLID)", self.error(text, "deck.k"))
        self.assertIn("does not end in .k, .key or .dyn (LS-DYNA), or .inp", self.error(text, "deck.txt"))


main()
