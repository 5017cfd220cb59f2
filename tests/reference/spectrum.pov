// A cut stone and a ball of dispersing glass: eight pictures, one for each wavelength, each with the glass's index at that
// wavelength. POV-Ray's own `dispersion` has other bands, other colours and no curve of a glass; a picture with one index
// it makes exactly, and what white light shows is these eight, each times its wavelength's colour.
#version 3.7;
#declare Scale = 1000;
#include "common.inc"
#include "floor.inc"
#include "gem_obj.inc"
Global(33)
View(<0.4, 2.6, 3.6>, <0.1, 0.75, 0>, 40)
background { Sky }
// The middle of the frame's band, in micrometres: 385 to 705 nm in eight.
#declare Wave = 0.385 + (frame_number - 0.5) * 0.04;
// Sellmeier, the data sheet of N-SF11.
#declare L = Wave * Wave;
#declare Ior = sqrt(1 + 1.73759695 * L / (L - 0.013188707) + 0.313747346 * L / (L - 0.0623068142) + 1.89878101 * L / (L - 155.23629));
union {
    TileFloor()
    object { Mesh_default Glass(Ior) translate <-0.75, -0.3, 0> }
    sphere { <1.05, 0.65, 0.5>, 0.6 Glass(Ior) }
    scale Scale
}
