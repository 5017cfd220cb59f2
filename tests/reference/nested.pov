// Four balls, each strictly inside the one before: glass, water, dense glass, air. The reflected share is that of
// normal incidence at every angle (see FixedGlass).
#version 3.7;
#include "common.inc"
#include "floor.inc"
Global(11)
View(<0.3, 1.7, 4.2>, <0, 0.9, 0>, 38)
background { Sky }
TileFloor()
sphere { <0, 1.05, 0>, 1 FixedGlass(1.5, 1) }
sphere { <0.05, 1.1, 0>, 0.8 FixedGlass(1.33, 1.5) }
sphere { <-0.1, 1.05, 0.1>, 0.5 FixedGlass(1.7, 1.33) }
sphere { <-0.05, 1.1, 0.1>, 0.25 FixedGlass(1, 1.7) }
