// Half section of an oedometer specimen: x is the radius, y the height [m].
// gmsh -2 -format msh22 oedometer.geo -o oedometer_22.msh ; gmsh -2 -format msh41 oedometer.geo -o oedometer_41.msh
radius = 0.035;
height = 0.02;
size = 0.007;

Point(1) = {0, 0, 0, size};
Point(2) = {radius, 0, 0, size};
Point(3) = {radius, height, 0, size};
Point(4) = {0, height, 0, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Recombine Surface {1};
Mesh.Algorithm = 6;
Mesh.RecombinationAlgorithm = 2;

Physical Curve("bottom") = {1};
Physical Curve("outer") = {2};
Physical Curve("top") = {3};
Physical Curve("axis") = {4};
Physical Surface("sand") = {1};
