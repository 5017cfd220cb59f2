// A panel of light over matt bodies on a chequered floor: soft shadows. The panel is 64 point lights: POV-Ray's own area
// lights multiply the mean of the shadows by the mean of the cosines (`area_illumination`) or by that of the middle, which
// is not the mean of the products.
#version 3.7;
#include "common.inc"
Global(5)
View(<1, 2.4, 5>, <0, 0.6, 0>, 40)
background { rgb <0.1, 0.15, 0.3> }
#macro Matt(Colour) pigment { rgb Colour } finish { diffuse 1 } #end
#for (I, 0, 7)
    #for (J, 0, 7)
        light_source {
            <2.1, 4, 2.3> + ((I + 0.5) / 8 - 0.5) * <0.8, 0, -0.4> + ((J + 0.5) / 8 - 0.5) * <0.2, 0.6, 0.4>
            rgb <1, 0.95, 0.85> / 64
        }
    #end
#end
plane { y, 0 pigment { checker rgb <0.9, 0.85, 0.8> rgb <0.2, 0.3, 0.35> scale 0.6 translate <0.1, -0.3, 0.2> } finish { diffuse 1 } }
sphere { <-0.8, 0.8, 0.2>, 0.8 Matt(<0.9, 0.3, 0.2>) }
box { <0.5, 0, -0.6>, <1.3, 1.4, 0.2> Matt(<0.3, 0.7, 0.4>) }
sphere { <0.3, 0.3, 1.2>, 0.3 Matt(<0.4, 0.5, 0.95>) }
