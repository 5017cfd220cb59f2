// Two facing mirrors, with bright bodies between them.
#version 3.7;
#include "common.inc"
#include "floor.inc"
Global(41)
View(<0.9, 1.3, 2.6>, <-0.4, 0.9, -2>, 60)
background { Sky }
TileFloor()
#macro Mirror(Share) pigment { rgb 0 } finish { reflection { rgb Share } } #end
box { <-2.5, 0.05, -3>, <2.5, 2.2, -2.8> Mirror(<0.9, 0.95, 0.92>) }
box { <-2.6, 0.05, 2.8>, <2.6, 2.3, 3> Mirror(<0.97, 0.93, 0.9>) }
sphere { <-0.5, 0.6, -0.7>, 0.4 Emissive(<0.9, 0.3, 0.2>) }
box { <0.2, 0.05, -0.6>, <0.6, 0.8, -0.2> Emissive(<0.2, 0.4, 0.9>) }
sphere { <0.1, 1.5, -1.2>, 0.3 Mirror(<0.8, 0.8, 0.5>) }
