// A cut stone of diamond's index: flat facets, closed, chains of total reflection.
#version 3.7;
#declare Scale = 1000;
#include "common.inc"
#include "floor.inc"
#include "gem_obj.inc"
Global(33)
View(<0.4, 2.6, 3.6>, <0.05, 0.9, 0>, 36)
background { Sky }
union {
    TileFloor()
    object { Mesh_default Glass(2.417) }
    scale Scale
}
