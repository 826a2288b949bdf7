// Disk of radius 1 mm as published: centre point, four arcs, the centre is a node. Made with gmsh 4.8.4:
//   gmsh -2 -algo del2d -format msh22 -setnumber lc 0.125e-3 disk.geo -o disk_1mm_h0125.msh
DefineConstant[ lc = 0.125e-3 ];
R = 1e-3;
Point(1) = {0, 0, 0, lc};
Point(2) = {R, 0, 0, lc};
Point(3) = {-R, 0, 0, lc};
Point(4) = {0, R, 0, lc};
Point(5) = {0, -R, 0, lc};
Circle(1) = {2, 1, 4};
Circle(2) = {4, 1, 3};
Circle(3) = {3, 1, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Point{1} In Surface{1};
