// Half section of a pile in the ground, for axisymmetry: x is the radius, y the height z [m]; the surface lies at z = 0.
// A block-structured mesh of quadrilaterals, graded towards shaft and tip. `refine` divides every cell along both directions.
//
//   gmsh -2 -format msh22 -setnumber refine 1 pile.geo -o pile_coarse.msh
//   gmsh -2 -format msh22 -setnumber refine 2 pile.geo -o pile_fine.msh
//   gmsh -2 -format msh22 -setnumber outer 30 -setnumber depth 30 -setnumber n_outwards 7 -setnumber growth_outwards 2
//     -setnumber n_along 6 -setnumber growth_upwards 1.4 -setnumber n_below 6 -setnumber growth_down 2
//     pile.geo -o pile_wide.msh
//   gmsh -2 -format msh22 -setnumber radius 0.2 -setnumber layer 0.0345 pile.geo -o pile_wished.msh
//   gmsh -2 -format msh22 -setnumber radius 0.15 -setnumber layer 0.0436 pile.geo -o pile_first_radius.msh
//   gmsh -2 -format msh22 -setnumber radius 0.2 -setnumber layer 0.01 -setnumber n_outwards 4 pile.geo -o pile_slip.msh
//   gmsh -2 -format msh22 -setnumber refine 2 -setnumber n_outwards 4 -setnumber growth_outwards 2.2 -setnumber n_along 5
//     -setnumber n_below 3 pile.geo -o pile_large.msh
//
// Other numbers can be set in the same way: radius is that of the pile's hole as the mesh begins, which a run may
// widen (0.125 here, to a pile of 0.25); gmsh -setnumber radius 0.25 makes the mesh of a pile wished in place.
DefineConstant[
  refine = 1,       // cells along an edge of a cell of the coarsest mesh
  radius = 0.125,   // of the pile or its first hole [m]
  length = 5,       // of the pile in the ground [m]
  layer = 0.05,     // thickness of the elements beside the shaft [m]
  outer = 7.5,      // radius of the mesh [m]
  depth = 10,       // of the mesh [m]
  n_outwards = 3,   // cells from the layer to the far boundary
  n_along = 4,      // cells along the shaft
  n_below = 2,      // cells from the tip to the bottom
  growth_outwards = 3., // each cell over its neighbour nearer to the shaft
  growth_upwards = 1.8, // each cell over its neighbour nearer to the tip
  growth_down = 3.       // each cell over its neighbour nearer to the tip
];

x[] = {0, radius, radius + layer, outer};
z[] = {-depth, -length, 0};
For j In {0 : 2}
  For i In {0 : 3}
    Point(1 + i + 4 * j) = {x[i], z[j], 0};
  EndFor
EndFor

// Lines along x: 1 + i + 3 j from point (i, j) to (i + 1, j); along z: 21 + i + 4 j from (i, j) to (i, j + 1).
For j In {0 : 2}
  For i In {0 : 2}
    Line(1 + i + 3 * j) = {1 + i + 4 * j, 2 + i + 4 * j};
  EndFor
EndFor
For j In {0 : 1}
  For i In {0 : 3}
    Line(21 + i + 4 * j) = {1 + i + 4 * j, 5 + i + 4 * j};
  EndFor
EndFor
For j In {0 : 1}
  For i In {0 : 2}
    Curve Loop(1 + i + 3 * j) = {1 + i + 3 * j, 22 + i + 4 * j, -(4 + i + 3 * j), -(21 + i + 4 * j)};
    Plane Surface(1 + i + 3 * j) = {1 + i + 3 * j};
    Transfinite Surface{1 + i + 3 * j};
    Recombine Surface{1 + i + 3 * j};
  EndFor
EndFor

// A cell's growth over `refine` of its parts is shared by them.
For j In {0 : 2}
  Transfinite Curve{1 + 3 * j} = refine + 1;
  Transfinite Curve{2 + 3 * j} = refine + 1;
  Transfinite Curve{3 + 3 * j} = refine * n_outwards + 1 Using Progression growth_outwards ^ (1 / refine);
EndFor
For i In {0 : 3}
  Transfinite Curve{21 + i} = refine * n_below + 1 Using Progression growth_down ^ (-1 / refine);
  Transfinite Curve{25 + i} = refine * n_along + 1 Using Progression growth_upwards ^ (1 / refine);
EndFor

Physical Surface("pile", 1) = {4};
Physical Surface("interface", 2) = {5};
Physical Surface("ground", 3) = {1, 2, 3, 6};
Physical Curve("axis", 11) = {21, 25};
Physical Curve("bottom", 12) = {1, 2, 3};
Physical Curve("far", 13) = {24, 28};
Physical Curve("surface", 14) = {8, 9};
Physical Curve("head", 15) = {7};
Physical Curve("shaft", 16) = {26}; // inside the mesh, as is the base
Physical Curve("base", 17) = {4};
