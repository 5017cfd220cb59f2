// Coloured glass by POV-Ray's fade law: `fade_power` of 1000 and more is exp(-(1 - fade_color) distance /
// fade_distance), so that our absorption is (1 - fade_color) / fade_distance.
// Two levels after the camera's hit: POV-Ray fades only the light that goes on through the surface at the end of a
// stretch, not what is reflected there, so that only light that goes straight through can be compared. `tinted` has
// the longer ways.
#version 3.7;
#include "common.inc"
#include "floor.inc"
Global(3)
View(<0.3, 1.7, 4.2>, <0, 0.8, 0>, 38)
background { Sky }
TileFloor()
#macro Fading(Ior, Distance, Colour)
    Surface() interior { ior Ior fade_power 1001 fade_distance Distance fade_color Colour }
#end
sphere { <-0.7, 0.8, 0>, 0.7 Fading(1.5, 0.5, <0.2, 0.7, 0.9>) }
box { <0.3, 0.1, -0.8>, <1.3, 1.3, 0.4> Fading(1.6, 1, <0.9, 0.5, 0.1>) }
