// Everything is under water: a glass ball, a bubble of air and a bar of dense glass, seen by an eye in the water.
// POV-Ray's surroundings always have index 1; bending and shares depend on ratios only, so each index is divided by
// the water's.
#version 3.7;
#declare Scale = 1000;
#include "common.inc"
#include "floor.inc"
Global(25)
View(<0.3, 1.7, 4.2>, <0, 0.8, 0>, 42)
background { Sky }
#declare Water = 1.33;
union {
    TileFloor()
    sphere { <-0.75, 0.85, 0>, 0.7 Glass(1.5 / Water) }
    sphere { <0.85, 1, -0.3>, 0.7 Glass(1 / Water) }
    box { <-1.2, 0.1, 0.9>, <1.1, 0.4, 1.2> Glass(1.7 / Water) }
    scale Scale
}
