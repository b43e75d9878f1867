// Quarter of a square pile in the ground, for three dimensions: the pile's axis is x = y = 0, the surface z = 0 [m].
// Blocks of hexahedra, graded towards shaft and tip. `refine` divides every cell along all directions.
//
//   gmsh -3 -format msh22 pile_3d.geo -o pile_3d.msh
//
// Other numbers can be set with gmsh -setnumber, as in pile.geo.
DefineConstant[
  refine = 1,       // cells along an edge of a cell of the coarsest mesh
  half_width = 0.1, // of the pile's hole [m]
  length = 5,       // of the pile in the ground [m]
  layer = 0.05,     // thickness of the elements beside the shaft [m]
  outer = 7.5,      // half width of the mesh [m]
  depth = 10,       // of the mesh [m]
  n_outwards = 2,   // cells from the layer to the far boundary
  n_along = 3,      // cells along the shaft
  n_below = 2,      // cells from the tip to the bottom
  growth_outwards = 5., // each cell over its neighbour nearer to the shaft
  growth_upwards = 2,   // each cell over its neighbour nearer to the tip
  growth_down = 3.      // each cell over its neighbour nearer to the tip
];

// The bottom: four by four points, lines along x (1 + i + 3 j) and along y (21 + i + 4 j), nine faces (41 + i + 3 j).
x[] = {0, half_width, half_width + layer, outer};
For j In {0 : 3}
  For i In {0 : 3}
    Point(1 + i + 4 * j) = {x[i], x[j], -depth};
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 2}
    Line(1 + i + 3 * j) = {1 + i + 4 * j, 2 + i + 4 * j};
    Line(21 + j + 4 * i) = {1 + j + 4 * i, 5 + j + 4 * i};
  EndFor
EndFor
For j In {0 : 2}
  For i In {0 : 2}
    Curve Loop(41 + i + 3 * j) = {1 + i + 3 * j, 22 + i + 4 * j, -(4 + i + 3 * j), -(21 + i + 4 * j)};
    Plane Surface(41 + i + 3 * j) = {41 + i + 3 * j};
    Transfinite Surface{41 + i + 3 * j};
    Recombine Surface{41 + i + 3 * j};
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 2}
    Transfinite Curve{1 + i + 3 * j, 21 + j + 4 * i} =
      refine * (i == 2 ? n_outwards : 1) + 1 Using Progression (i == 2 ? growth_outwards ^ (1 / refine) : 1);
  EndFor
EndFor

// Heights of the layers of cells over the height of the block, from below.
n = refine * n_below;
g = growth_down ^ (-1 / refine);
For k In {1 : n}
  one[] += 1;
  below[] += (1 - g ^ k) / (1 - g ^ n);
EndFor
n = refine * n_along;
g = growth_upwards ^ (1 / refine);
For k In {1 : n}
  two[] += 1;
  along[] += (1 - g ^ k) / (1 - g ^ n);
EndFor
bottom[] = Surface "*";
Extrude {0, 0, depth - length} { Surface{bottom[]}; Layers{one[], below[]}; Recombine; }
e = 1e-6;
tip[] = Surface In BoundingBox{-e, -e, -length - e, outer + e, outer + e, -length + e};
Extrude {0, 0, length} { Surface{tip[]}; Layers{two[], along[]}; Recombine; }

w = half_width;
t = half_width + layer;
Physical Volume("pile", 1) = Volume In BoundingBox{-e, -e, -length - e, w + e, w + e, e};
beside[] = Volume In BoundingBox{-e, -e, -length - e, t + e, t + e, e};
beside[] -= Volume In BoundingBox{-e, -e, -length - e, w + e, w + e, e};
Physical Volume("interface", 2) = {beside[]};
ground[] = Volume "*";
ground[] -= Volume In BoundingBox{-e, -e, -length - e, t + e, t + e, e};
Physical Volume("ground", 3) = {ground[]};
Physical Surface("symmetry_x", 11) = Surface In BoundingBox{-e, -e, -depth - e, e, outer + e, e};
Physical Surface("symmetry_y", 12) = Surface In BoundingBox{-e, -e, -depth - e, outer + e, e, e};
Physical Surface("far_x", 13) = Surface In BoundingBox{outer - e, -e, -depth - e, outer + e, outer + e, e};
Physical Surface("far_y", 14) = Surface In BoundingBox{-e, outer - e, -depth - e, outer + e, outer + e, e};
Physical Surface("bottom", 15) = {bottom[]};
top[] = Surface In BoundingBox{-e, -e, -e, outer + e, outer + e, e};
head[] = Surface In BoundingBox{-e, -e, -e, w + e, w + e, e};
top[] -= head[];
Physical Surface("surface", 16) = {top[]};
Physical Surface("head", 17) = {head[]};
Physical Surface("shaft_x", 18) = Surface In BoundingBox{w - e, -e, -length - e, w + e, w + e, e}; // inside the mesh
Physical Surface("shaft_y", 19) = Surface In BoundingBox{-e, w - e, -length - e, w + e, w + e, e};
Physical Surface("base", 20) = Surface In BoundingBox{-e, -e, -length - e, w + e, w + e, -length + e};
