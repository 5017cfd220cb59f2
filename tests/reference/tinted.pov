// Absorbing glass along ways of any length, as POV-Ray's medium of pure absorption has it: exp(-absorption distance).
#version 3.7;
#include "common.inc"
#include "floor.inc"
#include "gem_obj.inc"
Global(25)
View(<0.3, 1.9, 4.4>, <0, 0.9, 0>, 38)
background { Sky }
TileFloor()
#macro Absorbing(Ior, Absorption)
    Surface() interior { ior Ior media { absorption Absorption method 3 samples 1, 1 intervals 1 } } hollow
#end
sphere { <-0.9, 0.8, 0>, 0.7 Absorbing(1.5, <1.2, 0.5, 0.1>) }
object { Mesh_default scale 0.8 translate <0.9, -0.1, -0.2> Absorbing(2, <0.1, 0.4, 0.9>) }
