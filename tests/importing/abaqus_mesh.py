#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes of files of Abaqus and CalculiX.

    abaqus_mesh.py PROJECT_DIRECTORY
"""

from deck_testing import DeckTest, main, replaced, text_of

# Two instances of a bar of two cells and one of a plate, as Abaqus/CAE writes them: the second bar is moved and
# turned, the plate stands on it.
CAE = """*Heading
** Job name: Job-1 Model name: Model-1
*Preprint, echo=NO, model=NO, history=NO, contact=NO
** PARTS
*Part, name=Bar
*Node
      1,           0.,           0.,           0.
      2,           1.,           0.,           0.
      3,           1.,           1.,           0.
      4,           0.,           1.,           0.
      5,           0.,           0.,           1.
      6,           1.,           0.,           1.
      7,           1.,           1.,           1.
      8,           0.,           1.,           1.
      9,           2.,           0.,           0.
     10,           2.,           1.,           0.
     11,           2.,           0.,           1.
     12,           2.,           1.,           1.
*Element, type=C3D8R
1,  1,  2,  3,  4,  5,  6,  7,  8
2,  2,  9, 10,  3,  6, 11, 12,  7
*Nset, nset=Set-1, generate
  1,  12,   1
*Elset, elset=Set-1, generate
 1,  2,  1
*Elset, elset=foot
 1,
*Nset, nset=start
 1, 4, 5, 8
** Section: Section-1
*Solid Section, elset=Set-1, material=Steel
,
*End Part
*Part, name=Plate
*Node
 1, 0, 0, 0
 2, 1, 0, 0
 3, 1, 1, 0
 4, 0, 1, 0
 5, 0, 0, 0.5
 6, 1, 0, 0.5
 7, 1, 1, 0.5
 8, 0, 1, 0.5
*Element, type=C3D8
 1, 1, 2, 3, 4, 5, 6, 7, 8
*Elset, elset=Set-1
 1,
*End Part
*Part, name=Unused
*End Part
** ASSEMBLY
*Assembly, name=Assembly
*Instance, name=Bar-1, part=Bar
*End Instance
*Instance, name=Bar-2, part=Bar
         10.,           0.,           0.
         10.,           0.,           0.,          10.,           0.,           1.,         90.
*End Instance
*Instance, name=Plate-1, part=Plate
 0., 0., 5.
*End Instance
*Node
 1, 100., 0., 0.
*Nset, nset=_PickedSet4, internal
 1,
*Elset, elset=_Ends_S4, internal, instance=Bar-1
 2,
*Elset, elset=_Ends_S6, internal, instance=Bar-2,
 generate
 1,  1,  1
*Surface, type=ELEMENT, name=Ends
_Ends_S4, S4
_Ends_S6, S6
*Surface, type=ELEMENT, name=Top
Plate-1.1, S2
*Elset, elset=all plates
 Plate-1.Set-1
*End Assembly
*Material, name=Steel
*Density
 7.85e-09,
*Step, name=Step-1, nlgeom=YES
*Dynamic, Explicit
, 1.
*End Step
"""
AXIS = """         10.,           0.,           0.,          10.,           0.,           1.,         90."""
CUBES = text_of("two_cubes.inp")


def cube(kind, elements):
    return ("*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
            f"*ELEMENT, TYPE={kind}, ELSET=body\n" + elements)


class AbaqusMesh(DeckTest):
    def inp(self, text, dimension=3):
        return self.mesh(text, "deck.inp", dimension)

    def test_parts_and_instances_as_cae_writes_them(self):
        result = self.converted(CAE, "deck.inp", dimension=3, is_mesh_alone=True)
        mesh = result.mesh
        self.assertEqual(len(mesh.cells), 5)
        for group, value in (("Bar", 4), ("Bar-1", 2), ("foot", 2), ("Bar-2.foot", 1), ("Plate-1.Set-1", 0.5),
                             ("all plates", 0.5)):
            self.assert_volume(mesh, group, value)
        for name, value in (("Ends", 2), ("Top", 1), ("start", 2), ("Bar-1.start", 1)):
            self.assert_area(mesh, name, value)
        self.assertNotIn("Set-1", mesh.groups)
        for part in ('sets called "Set-1"', 'as in "Bar-1.NAME"', 'The part "Unused"',
                     'The instance "Bar-2" is moved by (10, 0, 0) and then turned by 90 degrees about the axis from '
                     "(10, 0, 0) to (10, 0, 1)"):
            self.assert_remark(mesh, part)
        said = "\n".join(result.report.summary())
        for part in ("*DENSITY (1 time, line 80)", "*SOLID SECTION (1 time"):
            self.assertIn(part, said)

    def test_instances_are_moved_and_turned(self):
        mesh = self.inp(CAE)
        # The bar from x = 10 to 12 points along y after its turn, and lies at x = 9 to 10.
        points = [mesh.points[node] for node in mesh.nodes_of_groups(["Bar-2"])]
        self.assertEqual(min(x for x, _, _ in points), 9)
        self.assertEqual(max(y for _, y, _ in points), 2)

    def test_the_sets_that_gmsh_writes(self):
        text = (cube("C3D8", "2, 1,2,3,4,5,6,7,8\n") +
                "*ELEMENT, type=CPS4, ELSET=Surface1\n1, 1, 4, 8, 5\n"
                "*ELEMENT, type=T3D2, ELSET=Line1\n9, 1, 4\n*ELSET,ELSET=left\n1, \n*ELSET,ELSET=edge\n9,\n"
                "*NSET,NSET=ends\n1, 4, 5, 8,\n2, 3, 6, 7\n*NSET,NSET=corner\n1\n")
        result = self.converted(text, "deck.inp", dimension=3, is_mesh_alone=True)
        self.assert_area(result.mesh, "left", 1)
        # All nodes are in the set, and with them all six faces.
        self.assert_area(result.mesh, "ends", 6)
        self.assert_volume(result.mesh, "body", 1)
        self.assertEqual(result.mesh.node_sets["corner"], [0])
        self.assertIn("*ELEMENT, TYPE=T3D2 is left out", "\n".join(result.report.summary()))

    def test_the_plane_is_told_by_the_types_of_elements(self):
        nodes = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n"
        for kind, options in (("CPE4R", {}), ("CPS4", {}), ("S4R", {"dimension": 2})):
            text = f"{nodes}*ELEMENT, TYPE={kind}, ELSET=body\n1,1,2,3,4\n*SURFACE, NAME=rear\n1, E2\n"
            mesh = self.converted(text, "deck.inp", **options).mesh
            self.assert_volume(mesh, "body", 1)
            self.assert_area(mesh, "rear", 1)

    def test_elements_of_second_order_keep_their_corners(self):
        nodes = ("*NODE\n11,0.5,-0.1,0\n12,1,0.5,0\n13,0.5,1,0\n14,0,0.5,0\n15,0.5,0,1\n16,1,0.5,1\n"
                 "17,0.5,1,1\n18,0,0.5,1\n19,0,0,0.5\n20,1,0,0.5\n21,1,1,0.5\n22,0,1,0.5\n")
        mesh = self.inp(cube("C3D20R", "1, 1,2,3,4,5,6,7,8, 11,12,13,14,15,16,17,\n18,19,20,21,22\n") + nodes +
                        "*SURFACE, NAME=top\nbody, S2\n")
        self.assert_volume(mesh, "body", 1)
        self.assert_area(mesh, "top", 1)
        self.assert_remark(mesh, "by up to 0.1 of the length of the edge (line 11)")

    def test_rigid_surfaces_beside_the_body_are_left_out(self):
        text = (cube("C3D8", "1, 1,2,3,4,5,6,7,8\n") + "*NODE\n31,0,0,9\n32,1,0,9\n33,1,1,9\n34,0,1,9\n"
                "*ELEMENT, TYPE=R3D4, ELSET=tool\n7, 31,32,33,34\n*ELEMENT, TYPE=R3D3, ELSET=tool\n8, 31,32,33\n"
                "*ELEMENT, TYPE=MASS, ELSET=mass\n9, 31\n")
        result = self.converted(text, "deck.inp", dimension=3, is_mesh_alone=True)
        self.assertEqual(result.mesh.surfaces, {})
        self.assert_remark(result.mesh, '"tool" has 1 faces that are no faces of cells')
        self.assertIn("*ELEMENT, TYPE=R3D3 is left out", "\n".join(result.report.summary()))

    def test_surfaces_sets_and_names(self):
        mesh = self.inp(CUBES)
        self.assertEqual(list(mesh.groups), ["Soft side", "EB2"])
        self.assert_area(mesh, "struck end", 1)
        self.assert_area(mesh, "SS1", 2)
        for face in mesh.surfaces["SS1"]:
            centre = [sum(mesh.points[node][d] for node in face) / 4 for d in range(3)]
            self.assertTrue(centre[0] == 2 or (centre[0] < 1 and centre[1] == 1), centre)

    def test_generated_nodes_and_elements(self):
        mesh = self.inp("*NODE\n1,0,0,0\n5,4,0,0\n11,0,1,0\n15,4,1,0\n*NGEN, NSET=low\n1, 5\n*NGEN, NSET=high\n11, 15\n"
                        "*NSET, NSET=floor\nlow, high\n*NODE, NSET=ceiling\n201,0,0,2\n202,1,0,2\n203,2,0,2\n204,3,0,2\n"
                        "205,4,0,2\n211,0,1,2\n212,1,1,2\n213,2,1,2\n214,3,1,2\n215,4,1,2\n"
                        "*NFILL\nfloor, ceiling, 2, 100\n*ELEMENT, TYPE=C3D8\n1, 1,2,12,11,101,102,112,111\n"
                        "*ELGEN, ELSET=all\n1, 4, 1, 1, 1, 0, 0, 2, 100, 100\n")
        self.assertEqual(len(mesh.cells), 8)
        self.assert_volume(mesh, "all", 8)
        arc = self.inp("*NODE, SYSTEM=C\n1,1,0,0\n3,1,90,0\n11,2,0,0\n13,2,90,0\n101,1,0,1\n102,1,45,1\n103,1,90,1\n"
                       "111,2,0,1\n112,2,45,1\n113,2,90,1\n*NODE\n99,0,0,0\n*NGEN, LINE=C\n1,3,1,99\n11,13,1,99\n"
                       "*ELEMENT, TYPE=C3D8, ELSET=all\n1, 1,11,12,2,101,111,112,102\n2, 2,12,13,3,102,112,113,103\n")
        self.assertEqual(len(arc.cells), 2)
        for number, radius in ((2, 1), (12, 2)):
            x, y, _ = arc.points[arc.numbers.index(number)]
            self.assertAlmostEqual(x, radius * 0.5 ** 0.5, 12)
            self.assertAlmostEqual(y, x, 12)

    def test_what_is_not_read_is_refused_with_line_and_remedy(self):
        cases = (
            (("name=Bar-1, part=Bar\n", "name=Bar-1, part=Rod\n"),
             'line 53: The instance "Bar-1" is of the part "Rod", and there is no such part'),
            (("name=Bar-2, part=Bar", "name=BAR-1, part=Bar"), 'line 55: There are two of *INSTANCE called "BAR-1"'),
            ((AXIS, "0, 0, 0, 0, 0, 0, 90"), "are one point"),
            ((AXIS, "1, 2"), "Below *INSTANCE stand a line of three numbers"),
            (("*End Part\n*Part", "*Part"), 'line 33: *PART stands inside of "Bar"'),
            (("Plate-1.1, S2", "Plate-1.3, S2"), 'There is no element of number 3, which the surface "Top" names'),
            (("Plate-1.1, S2", "Plate-2.1, S2"),
             'There is no instance "Plate-2". Instances are "Bar-1", "Bar-2", "Plate-1"'),
            (("Plate-1.1, S2", "Plate-1.1, S9"), 'is called "S9". Allowed are S1 to S6'),
            ((" 1, 4, 5, 8\n", " 1, 4, 5, 88\n"),
             'line 29: There is no node of number 88, which the set "start" names'),
            (("*Preprint, echo=NO", "*Include, input=mesh.inp\n*Preprint, echo=NO"),
             'line 3: "mesh.inp", relative to the file that names it: There is no such file'),
            (("*Preprint, echo=NO", "*Ncopy, nset=a\n1, 5, 1\n*Preprint, echo=NO"),
             "line 3: *NCOPY is not allowed: it makes or moves nodes"),
            (("*Part, name=Bar\n*Node", "*Part, name=Bar\n*Node, system=Q"),
             "line 6: *NODE with SYSTEM=Q is not allowed"),
            (("type=C3D8\n", "type=C3D6\n"), "they are wedges"),
            (("type=C3D8\n", "type=C3D10M\n"), "they are tetrahedra"),
            (("type=C3D8\n", "type=C3D4\n"), "Mesh.SubdivisionAlgorithm = 2"),
            (("type=C3D8\n", "type=CAX4\n"), "Elements of type CAX4 are not allowed"),
            (("type=C3D8\n", "type=S3\n"), "they are triangles"),
            (("*Elset, elset=all plates\n Plate-1.Set-1", "*Elset, elset=a\nb\n*Elset, elset=b\na"),
             'The set "a" contains itself'),
        )
        for change, message in cases:
            with self.subTest(message):
                self.assertIn(message, self.error(replaced(CAE, change), "deck.inp"))

    def test_flat_files_are_refused_with_line_and_remedy(self):
        cases = (
            (CUBES + "*Elset, elset=left\n1, 77\n", "line 32: There is no element of number 77"),
            (CUBES + "*Nset, nset=left\n1, 77\n", 'line 32: There is no node of number 77, which the set "left" names'),
            (CUBES + "*Elset, elset=left\nright\n", 'line 32: There is no set of elements "right"'),
            (CUBES + "*Nset, nset=left, generate\n9, 1, 1\n", "line 32: A range of GENERATE goes up"),
            (replaced(CUBES, ("TYPE=C3D8R", "TYPE=C3D4")),
             "line 19: Elements of type C3D4 are not allowed: they are tetrahedra"),
            (replaced(CUBES, ("TYPE=C3D8R, ", "")), "line 19: *ELEMENT has no TYPE"),
            (replaced(CUBES, (" 12, 7\n", " 12\n")), "line 22: An element of this type has 8 nodes, and this one has 7"),
            (replaced(CUBES, (" 12, 7\n", " 12, 77\n")), "There is no node of number 77"),
            (replaced(CUBES, (" 2, S4", " left, S4")), 'There is no set of elements "left"'),
            (replaced(CUBES, (" 2, S4", " 2, S7")), "S1 to S6"),
            (replaced(CUBES, (" 2, S4", " 9, S4")), 'There is no element of number 9, which the surface "SS1" names'),
            (replaced(CUBES, (" 12, 7\n", " 12, 2\n")), "line 22: A cell has the same node twice"),
            (replaced(CUBES, ("0.0, 1.0, 1.0\n", "0.0, 1.0, -1.0\n")), "line 20: A cell is"),
            (replaced(CUBES, (" 2, 2, 9, 10, 3, 6, 11,\n 12, 7", " 2, 1, 2, 3, 4, 5, 6, 7, 8")),
             "line 22: The cell stands on line 20 already"),
            ("1, 2, 3\n", 'line 1: "1, 2, 3" belongs to no keyword'),
            ("*HEADING\n", "There is no section *NODE"),
            (CUBES[:CUBES.index("*ELEMENT")], "there are no hexahedra"),
            ("*NODE\n1,0,0,0\n3,1,0,0\n*NGEN\n1,4\n", "line 5: There is no node of number 4"),
        )
        for text, message in cases:
            with self.subTest(message):
                self.assertIn(message, self.error(text, "deck.inp"))
        self.assertIn("There are hexahedra (C3D8R), and the scene", self.error(CUBES, "deck.inp", 2))

    def test_cells_that_are_turned_round_are_repaired(self):
        mesh = self.inp(replaced(CUBES, (" 1, 1, 2, 3, 4, 5, 6, 7, 8", " 1, 5, 6, 7, 8, 1, 2, 3, 4")))
        self.assert_remark(mesh, "1 of 2 cells are numbered the wrong way round (the first on line 20)")
        self.assert_volume(mesh, "Soft side", 1)


main()
