// A ball of dense glass inside a ball of water, with exact Fresnel shares. The dense glass holds an opaque core so
// large that light bent into it never leaves it again, which POV-Ray would get wrong (see FixedGlass).
#version 3.7;
#include "common.inc"
#include "floor.inc"
Global(25)
View(<0.3, 1.7, 4.2>, <0, 0.9, 0>, 38)
background { Sky }
TileFloor()
sphere { <0, 1.05, 0>, 1 Glass(1.33) }
sphere { <0.15, 1, 0.1>, 0.6 Glass(2) }
sphere { <0.15, 1, 0.1>, 0.45 Emissive(<0.8, 0.3, 0.1>) }
