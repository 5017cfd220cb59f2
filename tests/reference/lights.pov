// Highlights of both kinds under a spot and a directional light.
#version 3.7;
#include "common.inc"
Global(5)
View(<0.5, 2.2, 5>, <0, 0.7, 0>, 40)
background { rgb <0.05, 0.1, 0.2> }
#macro Glossy(Colour) pigment { rgb Colour } #end
light_source { <2.2, 3.6, 2.6>, rgb <0.6, 0.55, 0.5> spotlight point_at <0.1, 0.3, 0.2> radius 12 falloff 22 tightness 0 }
light_source { <-30, 40, 20>, rgb <0.25, 0.28, 0.35> parallel point_at <0, 0, 0> }
plane { y, 0 pigment { rgb <0.7, 0.7, 0.65> } finish { diffuse 1 } }
sphere { <-0.8, 0.8, 0.2>, 0.8 pigment { rgb <0.5, 0.2, 0.1> } finish { diffuse 1 phong 0.5 phong_size 40 } }
sphere { <0.8, 0.7, 0>, 0.7 pigment { rgb <0.1, 0.3, 0.5> } finish { diffuse 1 specular 0.5 roughness 1 / 60 } }
