// Snell's window: the eye is inside a block of water, looking up through its flat top at an emissive ceiling; beyond
// the critical angle the top mirrors the tiles on the ground.
#version 3.7;
#declare Scale = 1000;
#include "common.inc"
#include "floor.inc"
Global(25)
View(<0.2, 0.6, 1.9>, <0, 1.6, 0>, 75)
background { Sky }
union {
    TileFloor()
    box { <-2.6, 0.05, -2.4>, <2.5, 1.5, 2.3> Glass(1.33) }
    box { <-1, 3, -1.5>, <-0.2, 3.2, 1> Emissive(<0.9, 0.4, 0.2>) }
    box { <0.4, 2.5, -2>, <0.8, 2.7, 1.5> Emissive(<0.2, 0.8, 0.4>) }
    scale Scale
}
