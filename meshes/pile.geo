// Half section of a pile in the ground, for axisymmetry: x is the radius, y the height z [m]; the surface lies at z = 0.
// A block-structured mesh of quadrilaterals, graded towards shaft and tip. `refine` divides every cell along both directions.
// Where `cone` is not 0 the lowest part of the shaft has a name of its own, so that a run may leave it a cone when it widens the hole.
//
//   gmsh -2 -format msh22 -setnumber refine 1 pile.geo -o pile_coarse.msh
//   gmsh -2 -format msh22 -setnumber outer 30 -setnumber depth 30 -setnumber n_outwards 7 -setnumber growth_outwards 2
//     -setnumber n_along 6 -setnumber growth_upwards 1.4 -setnumber n_below 6 -setnumber growth_down 2
//     pile.geo -o pile_wide.msh
//   gmsh -2 -format msh22 -setnumber n_below 3 -setnumber cone 0.4 -setnumber n_along 3 pile.geo -o pile_small.msh
//   gmsh -2 -format msh22 -setnumber n_below 3 -setnumber cone 0.4 -setnumber n_along 3 -setnumber refine 2 pile.geo -o pile_fine.msh
//   gmsh -2 -format msh22 -setnumber n_below 3 -setnumber cone 0.4 -setnumber n_along 3 -setnumber radius 0.15
//     -setnumber layer 0.0436 pile.geo -o pile_first_radius.msh
//   gmsh -2 -format msh22 -setnumber n_below 3 -setnumber cone 0.4 -setnumber n_along 3 -setnumber layer 0.01
//     -setnumber n_outwards 4 pile.geo -o pile_hole_slip.msh
//   gmsh -2 -format msh22 -setnumber n_below 3 -setnumber radius 0.2 -setnumber layer 0.0345 pile.geo -o pile_wished.msh
//   gmsh -2 -format msh22 -setnumber radius 0.2 -setnumber layer 0.01 -setnumber n_outwards 4 pile.geo -o pile_slip.msh
//   gmsh -2 -format msh22 -setnumber refine 2 -setnumber n_outwards 4 -setnumber growth_outwards 2.2 -setnumber cone 0.4 -setnumber n_along 3
//     -setnumber n_below 3 pile.geo -o pile_large.msh
//
// Other numbers can be set in the same way: radius is that of the pile's hole as the mesh begins, which a run may
// widen (0.125 here, to a pile of 0.2); gmsh -setnumber radius 0.2 makes the mesh of a pile wished in place.
DefineConstant[
  refine = 1,       // cells along an edge of a cell of the coarsest mesh
  radius = 0.125,   // of the pile or its first hole [m]
  length = 5,       // of the pile in the ground [m]
  cone = 0,         // height of the shaft's part next to the tip, one cell of the coarsest mesh; 0: it belongs to the shaft [m]
  layer = 0.05,     // thickness of the elements beside the shaft [m]
  outer = 7.5,      // radius of the mesh [m]
  depth = 10,       // of the mesh [m]
  n_outwards = 3,   // cells from the layer to the far boundary
  n_along = 4,      // cells along the shaft, above the cone
  n_below = 2,      // cells from the tip to the bottom
  growth_outwards = 3., // each cell over its neighbour nearer to the shaft
  growth_upwards = 1.8, // each cell over its neighbour nearer to the tip
  growth_down = 3.       // each cell over its neighbour nearer to the tip
];

// Rows of blocks from the bottom up: below the tip, beside the cone, beside the shaft.
x[] = {0, radius, radius + layer, outer};
z[] = {-depth, -length};
n_cells[] = {n_below};
growth[] = {1. / growth_down};
If (cone > 0)
  z[] += {-length + cone};
  n_cells[] += {1};
  growth[] += {1};
EndIf
z[] += {0};
n_cells[] += {n_along};
growth[] += {growth_upwards};
n_rows = #n_cells[];

// Point i + 1 + 4 j at (x_i, z_j); lines along x: 1 + i + 3 j from it, along z: 101 + i + 4 j from it; blocks: 1 + i + 3 j.
For j In {0 : n_rows}
  For i In {0 : 3}
    Point(1 + i + 4 * j) = {x[i], z[j], 0};
  EndFor
EndFor
For j In {0 : n_rows}
  For i In {0 : 2}
    Line(1 + i + 3 * j) = {1 + i + 4 * j, 2 + i + 4 * j};
  EndFor
EndFor
For j In {0 : n_rows - 1}
  For i In {0 : 3}
    Line(101 + i + 4 * j) = {1 + i + 4 * j, 5 + i + 4 * j};
  EndFor
EndFor
For j In {0 : n_rows - 1}
  For i In {0 : 2}
    Curve Loop(1 + i + 3 * j) = {1 + i + 3 * j, 102 + i + 4 * j, -(4 + i + 3 * j), -(101 + i + 4 * j)};
    Plane Surface(1 + i + 3 * j) = {1 + i + 3 * j};
    Transfinite Surface{1 + i + 3 * j};
    Recombine Surface{1 + i + 3 * j};
  EndFor
EndFor

// A cell's growth over `refine` of its parts is shared by them.
For j In {0 : n_rows}
  Transfinite Curve{1 + 3 * j} = refine + 1;
  Transfinite Curve{2 + 3 * j} = refine + 1;
  Transfinite Curve{3 + 3 * j} = refine * n_outwards + 1 Using Progression growth_outwards ^ (1 / refine);
EndFor
For j In {0 : n_rows - 1}
  For i In {0 : 3}
    Transfinite Curve{101 + i + 4 * j} = refine * n_cells[j] + 1 Using Progression growth[j] ^ (1 / refine);
  EndFor
EndFor

pile[] = {};
beside[] = {};
ground[] = {1, 2, 3};
axis[] = {101};
far[] = {104};
For j In {1 : n_rows - 1}
  pile[] += {1 + 3 * j};
  beside[] += {2 + 3 * j};
  ground[] += {3 + 3 * j};
  axis[] += {101 + 4 * j};
  far[] += {104 + 4 * j};
EndFor
Physical Surface("pile", 1) = {pile[]};
Physical Surface("interface", 2) = {beside[]};
Physical Surface("ground", 3) = {ground[]};
Physical Curve("axis", 11) = {axis[]};
Physical Curve("bottom", 12) = {1, 2, 3};
Physical Curve("far", 13) = {far[]};
Physical Curve("surface", 14) = {2 + 3 * n_rows, 3 + 3 * n_rows};
Physical Curve("head", 15) = {1 + 3 * n_rows};
Physical Curve("shaft", 16) = {102 + 4 * (n_rows - 1)}; // inside the mesh, as are cone and base
Physical Curve("base", 17) = {4};
If (cone > 0)
  Physical Curve("cone", 18) = {106};
EndIf
