# OBJ (v, usemtl, f) to POV-Ray: one `mesh` a material, declared as Mesh_MATERIAL. The OBJ stays the only place of its numbers.
function vec(i) { return "<" x[i] "," y[i] "," z[i] ">" }
function close_mesh() { if (open) print "  inside_vector y\n}"; open = 0 }
BEGIN { name = "default" }
$1 == "v" { n++; x[n] = $2; y[n] = $3; z[n] = $4 }
$1 == "usemtl" { close_mesh(); name = $2 }
$1 == "f" {
    if (!open) { print "#declare Mesh_" name " = mesh {"; open = 1 }
    for (k = 3; k < NF; k++) print "  triangle { " vec($2) ", " vec($k) ", " vec($(k + 1)) " }"
}
END { close_mesh() }
