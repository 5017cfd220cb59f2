// Parallel projection; a half mirror over a matt base, a varnished ball, a mirror, and a point light.
#version 3.7;
#include "common.inc"
Global(17)
ParallelView(<2.2, 2.8, 5>, <0, 0.6, 0>, 3.6)
background { rgb <0.2, 0.3, 0.45> }
light_source { <-2.3, 4.2, 3.1>, rgb 0.6 }
plane { y, 0 pigment { checker rgb <0.8, 0.75, 0.7> rgb <0.2, 0.25, 0.3> scale 0.5 translate <0.1, -0.25, 0.2> } finish { diffuse 0.9 reflection { 0.15 } } }
// What the upper layer of varnish does not reflect reaches the base.
sphere {
    <-0.8, 0.7, 0.2>, 0.7
    texture { pigment { rgb <0.8, 0.25, 0.1> } finish { diffuse 1 } }
    texture { pigment { rgbf 1 } finish { reflection { 0, 1 fresnel on } conserve_energy } }
    interior { ior 1.6 }
}
sphere { <0.8, 0.7, -0.4>, 0.7 pigment { rgb 0 } finish { reflection { rgb <0.9, 0.75, 0.5> } } }
box { <0.1, 0, 0.9>, <0.7, 0.5, 1.4> pigment { rgb <0.2, 0.4, 0.3> } finish { diffuse 1 reflection { rgb <0.3, 0.3, 0.4> } } }
