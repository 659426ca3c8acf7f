// A quarter of a plate with a hole, in millimetres, as hexahedra (doc/tutorial_mesh.md):
//   gmsh -3 -bin plate.geo -o plate.msh

// Geometry
radius     = 10;   // of the hole
zone       = 25;   // radius within which there are particles
half_width = 100;  // of the plate, from the middle of the hole
thickness  = 2;    // half of that of the plate
size       = 1.2;  // of cells at the hole, before each is divided
far_size   = 16;   // of cells at the edges of the plate

Point(1) = {0, 0, 0};
Point(2) = {radius, 0, 0, size};
Point(3) = {0, radius, 0, size};
Point(4) = {zone, 0, 0, 1.6 * size};
Point(5) = {0, zone, 0, 1.6 * size};
Point(6) = {half_width, 0, 0, far_size};
Point(7) = {half_width, half_width, 0, far_size};
Point(8) = {0, half_width, 0, far_size};
Circle(1) = {2, 1, 3};
Circle(2) = {4, 1, 5};
Line(3) = {2, 4};
Line(4) = {4, 6};
Line(5) = {6, 7};
Line(6) = {7, 8};
Line(7) = {8, 5};
Line(8) = {5, 3};
Curve Loop(1) = {3, 2, 8, -1};
Curve Loop(2) = {4, 5, 6, 7, -2};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
near[] = Extrude {0, 0, thickness} { Surface{1}; Layers{1}; Recombine; };
far[]  = Extrude {0, 0, thickness} { Surface{2}; Layers{1}; Recombine; };

// Groups: volumes are parts, surfaces are boundaries.
Physical Volume("near the hole") = {near[1]};
Physical Volume("far from it")   = {far[1]};
Physical Surface("plane y")      = {near[2], far[2]};
Physical Surface("loaded end")   = {far[3]};
Physical Surface("plane x")      = {near[4], far[5]};
Physical Surface("hole")         = {near[5]};
Physical Surface("plane z")      = {1, 2};

// Mesh: quadrilaterals and some triangles, drawn out to hexahedra and prisms, and each of these
// divided into hexahedra.
Mesh.RecombineAll         = 1;
Mesh.SubdivisionAlgorithm = 2;
Mesh.MeshSizeExtendFromBoundary = 1;
