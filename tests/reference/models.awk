# Writes floor.obj and gem.obj into `folder`.
function floor_tiles(parity,   i, j, a) {
    for (j = 0; j < 12; j++) for (i = 0; i < 12; i++) if ((i + j) % 2 == parity) {
        a = j * 13 + i + 1
        print "f", a, a + 13, a + 14, a + 1 > out
    }
}
BEGIN {
    out = folder "/floor.obj"
    print "# 12 x 12 tiles of edge 0.5 in the plane y = 0, facing up." > out
    print "mtllib floor.mtl" > out
    for (j = 0; j < 13; j++) for (i = 0; i < 13; i++) print "v", i / 2 - 3, 0, j / 2 - 3 > out
    print "usemtl light" > out; floor_tiles(0)
    print "usemtl dark" > out; floor_tiles(1)

    out = folder "/gem.obj"
    print "# Closed cut stone of 30 triangles: table (vertices 1 to 8), girdle (9 to 16), culet (17)." > out
    step = atan2(1, 1)
    for (k = 0; k < 8; k++) printf "v %.4f 1.55 %.4f\n", 0.6 * cos((k + 0.5) * step), 0.6 * sin((k + 0.5) * step) > out
    for (k = 0; k < 8; k++) printf "v %.4f 1.2 %.4f\n", cos(k * step), sin(k * step) > out
    print "v 0 0.35 0" > out
    for (k = 2; k < 8; k++) print "f", 1, k + 1, k > out
    for (k = 0; k < 8; k++) {
        next_k = (k + 1) % 8
        print "f", k + 1, next_k + 9, k + 9 > out
        print "f", k + 1, next_k + 1, next_k + 9 > out
        print "f", 17, k + 9, next_k + 9 > out
    }
}
