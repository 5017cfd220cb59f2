// A glass ball over emissive tiles under a constant sky.
#version 3.7;
#include "common.inc"
#include "floor.inc"
Global(25)
View(<0.3, 1.7, 4.2>, <0, 0.9, 0>, 38)
background { Sky }
TileFloor()
sphere { <0, 1.05, 0>, 1 Glass(1.5) }
