use glam::{DVec3, Vec3};

use super::*;
use crate::geometry::{GeometryMask, Plane, Sphere, TriMesh};

fn shape(shape: Shape) -> Geometry {
    Geometry { shape, mask: GeometryMask::ALL }
}

fn sphere(centre: Vec3, radius: f32) -> Geometry {
    shape(Shape::Sphere(Sphere { centre, radius }))
}

fn plane(point: Vec3, normal: Vec3) -> Geometry {
    shape(Shape::Plane(Plane { point, normal: normal.normalize() }))
}

/// A box from `lo` to `hi`, outside out.
fn cuboid(lo: Vec3, hi: Vec3) -> TriMesh {
    let at = |i: usize| Vec3::new([lo.x, hi.x][i & 1], [lo.y, hi.y][i >> 1 & 1], [lo.z, hi.z][i >> 2]);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { positions: (0..8).map(at).collect(), triangles, ..TriMesh::default() }
}

fn mesh(mesh: TriMesh) -> Geometry {
    shape(Shape::Mesh(mesh))
}

/// A flat square of `n` by `n` cells at height `y`.
fn grid(n: u32, size: f32, y: f32) -> TriMesh {
    let step = size / n as f32;
    let at = |i: u32, j: u32| Vec3::new(i as f32 * step - size / 2.0, y, j as f32 * step - size / 2.0);
    let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
    let k = |i: u32, j: u32| i * (n + 1) + j;
    let cell = |i, j| [[k(i, j), k(i, j + 1), k(i + 1, j + 1)], [k(i, j), k(i + 1, j + 1), k(i + 1, j)]];
    let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
    TriMesh { positions, triangles, ..TriMesh::default() }
}

fn contacts(geometry: &[Geometry]) -> Contacts {
    Contacts::find(geometry, &|_, _| true)
}

fn objects_at(contacts: &Contacts, object: u32, primitive: u32, point: DVec3) -> Vec<u32> {
    let mut faces = Vec::new();
    contacts.faces_at(object, primitive, point, 0.0, &mut faces);
    faces.iter().map(|face| face.object).collect()
}

#[test]
fn a_box_on_a_plane_touches_it_with_its_bottom_alone() {
    let scene = [mesh(cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, 1.0))), plane(Vec3::ZERO, Vec3::Y)];
    let found = contacts(&scene);
    assert_eq!(found.pairs(), [Pair { objects: [0, 1], faces: 2, aligned: 0, points: 0 }]);
    let bottom: Vec<u32> = (0..12).filter(|&i| found.touches(0, i)).collect();
    assert_eq!(bottom, [4, 5]);
    assert_eq!(objects_at(&found, 1, 0, DVec3::new(0.5, 0.0, 0.2)), [1, 0]);
    assert_eq!(objects_at(&found, 1, 0, DVec3::new(1.5, 0.0, 0.2)), [1]);
    assert_eq!(objects_at(&found, 0, 4, DVec3::new(0.5, 0.0, 0.2)), [0, 1]);
}

#[test]
fn boxes_side_by_side_coincide_in_the_part_they_share() {
    let scene = [
        mesh(cuboid(Vec3::ZERO, Vec3::ONE)),
        mesh(cuboid(Vec3::new(1.0, 0.5, 0.0), Vec3::new(2.0, 1.5, 1.0))),
        mesh(cuboid(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 3.0, 1.0))),
    ];
    let found = contacts(&scene);
    assert_eq!(found.pairs().iter().map(|p| p.objects).collect::<Vec<_>>(), [[0, 1]]);
    let right = (0..12).filter(|&i| found.touches(0, i)).collect::<Vec<_>>();
    assert_eq!(right, [2, 3]);
    let shared: Vec<u32> = right.iter().flat_map(|&i| objects_at(&found, 0, i, DVec3::new(1.0, 0.75, 0.3))).collect();
    assert_eq!(shared.iter().filter(|&&o| o == 1).count(), 2);
    assert!(right.iter().all(|&i| objects_at(&found, 0, i, DVec3::new(1.0, 0.25, 0.3)) == [0]));
}

#[test]
fn neighbours_that_share_an_edge_alone_do_not_touch() {
    let scene = [mesh(cuboid(Vec3::ZERO, Vec3::ONE)), mesh(cuboid(Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 1.0)))];
    assert!(contacts(&scene).is_empty());
    assert!(contacts(&[mesh(grid(4, 2.0, 0.0))]).is_empty());
}

#[test]
fn a_gap_above_the_rounding_of_positions_is_a_gap() {
    let over = |gap: f32| {
        let lo = Vec3::new(-1.0, gap, -1.0);
        contacts(&[mesh(cuboid(lo, Vec3::ONE)), plane(Vec3::ZERO, Vec3::Y)]).is_empty()
    };
    assert!(!over(1e-7) && !over(-1e-7));
    assert!(over(1e-5) && over(-1e-5));
}

#[test]
fn a_disc_of_many_faces_on_a_grid_of_many_is_found_everywhere() {
    let scene = [mesh(grid(40, 4.0, 0.3)), mesh(grid(7, 1.0, 0.3))];
    let found = contacts(&scene);
    for i in 0..20 {
        for j in 0..20 {
            let p = DVec3::new(f64::from(i) * 0.09 - 0.85, f64::from(0.3_f32), f64::from(j) * 0.09 - 0.87);
            let inside = p.x.abs() < 0.5 && p.z.abs() < 0.5;
            for primitive in 0..3200 {
                if found.touches(0, primitive) && Face::of(&scene, 0, primitive).covers(p, 0.0) {
                    assert_eq!(objects_at(&found, 0, primitive, p).contains(&1), inside, "{p}");
                }
            }
        }
    }
}

#[test]
fn equal_spheres_coincide_and_a_ball_touches_its_plane_at_a_point() {
    let twins = contacts(&[sphere(Vec3::X, 0.9), sphere(Vec3::X, 0.9), sphere(Vec3::X, 1.0)]);
    assert_eq!(twins.pairs(), [Pair { objects: [0, 1], faces: 1, aligned: 1, points: 0 }]);
    assert_eq!(objects_at(&twins, 0, 0, DVec3::new(1.9, 0.0, 0.0)), [0, 1]);
    let resting = contacts(&[sphere(Vec3::new(0.3, 1.0, 0.2), 1.0), plane(Vec3::ZERO, Vec3::Y)]);
    assert_eq!(resting.pairs(), [Pair { objects: [0, 1], faces: 0, aligned: 0, points: 1 }]);
    let at = DVec3::new(f64::from(0.3_f32), 0.0, f64::from(0.2_f32));
    let (tangent, ball, floor) = resting.tangent_at(1, 0, at).expect("it touches there");
    assert_eq!((ball.object, floor.object), (0, 1));
    assert!(tangent.contact.distance(at) < 1e-9 && tangent.towards.distance(DVec3::NEG_Y) < 1e-12);
    assert!(tangent.zone > 1e-4 && tangent.zone < 1e-2, "{}", tangent.zone);
    assert!(resting.tangent_at(1, 0, at + DVec3::X * 0.1).is_none());
}

#[test]
fn beads_touch_from_outside_and_a_ball_touches_its_shell_from_inside() {
    let beads = contacts(&[sphere(Vec3::ZERO, 1.0), sphere(Vec3::new(1.5, 0.0, 0.0), 0.5)]);
    let (tangent, small, _) = beads.tangent_at(0, 0, DVec3::X).expect("they touch");
    assert_eq!(small.object, 1);
    assert!(tangent.towards.distance(DVec3::NEG_X) < 1e-12 && tangent.contact.distance(DVec3::X) < 1e-9);
    let inside = contacts(&[sphere(Vec3::ZERO, 1.0), sphere(Vec3::new(0.5, 0.0, 0.0), 0.5)]);
    let (tangent, small, _) = inside.tangent_at(1, 0, DVec3::X).expect("they touch");
    assert_eq!(small.object, 1);
    assert!(tangent.towards.distance(DVec3::X) < 1e-12);
}

#[test]
fn duplicate_triangles_of_one_mesh_are_found_in_any_order_of_corners() {
    let mut twice = cuboid(Vec3::ZERO, Vec3::ONE);
    let [a, b, c] = twice.triangles[3];
    twice.triangles.push([b, c, a]);
    twice.triangles.push([c, b, a]);
    let found = contacts(&[mesh(twice.clone())]);
    assert_eq!(found.pairs(), [Pair { objects: [0, 0], faces: 2, aligned: 1, points: 0 }]);
    // One face of the object on each side.
    let middle = Face::of(&[mesh(twice)], 0, 3);
    let Form::Triangle { corners: [a, b, c], .. } = middle.form else { panic!("a triangle") };
    let mut faces = Vec::new();
    found.faces_at(0, 12, (a + b + c) / 3.0, 0.0, &mut faces);
    assert_eq!(faces.iter().map(Face::id).collect::<Vec<_>>(), [(0, 3), (0, 13)]);
}

#[test]
fn of_a_mesh_whose_faces_are_all_there_twice_the_lowest_face_counts() {
    let mut twice = cuboid(Vec3::ZERO, Vec3::ONE);
    let turned: Vec<[u32; 3]> = twice.triangles.iter().map(|&[a, b, c]| [c, b, a]).collect();
    twice.triangles.extend(turned);
    let found = contacts(&[mesh(twice)]);
    for met in [3, 15] {
        let mut faces = Vec::new();
        found.faces_at(0, met, DVec3::new(1.0, 0.3, 0.5), 0.5, &mut faces);
        assert_eq!(faces.iter().map(Face::id).collect::<Vec<_>>(), [(0, 3)]);
    }
}

#[test]
fn touching_survives_turns_scales_and_moves_of_the_whole_scene() {
    let turn = glam::DQuat::from_euler(glam::EulerRot::YXZ, 0.7, 0.4, -1.1);
    for scale in [1e-3, 1.0, 1e3] {
        for offset in [DVec3::ZERO, DVec3::new(3.0, -40.0, 17.0)] {
            let moved = |m: TriMesh| TriMesh {
                positions: m.positions.iter().map(|p| ((turn * p.as_dvec3() + offset) * scale).as_vec3()).collect(),
                ..m
            };
            let scene = [
                mesh(moved(cuboid(Vec3::ZERO, Vec3::ONE))),
                mesh(moved(cuboid(Vec3::new(1.0, -0.3, 0.2), Vec3::new(2.0, 0.9, 0.7)))),
                plane((offset * scale).as_vec3(), (turn * DVec3::Y).as_vec3()),
            ];
            let pairs: Vec<_> = contacts(&scene).pairs().iter().map(|p| p.objects).collect();
            assert_eq!(pairs, [[0, 1], [0, 2]], "scale {scale}, offset {offset}");
        }
    }
}

/// The components of a normal at 45 degrees are equal but for rounding, so that the sign of neither says which way it points.
#[test]
fn boxes_side_by_side_at_45_degrees_touch_wherever_they_stand() {
    for quarter in 0..4 {
        let turn = glam::DQuat::from_rotation_y(std::f64::consts::FRAC_PI_4 * f64::from(2 * quarter + 1));
        for step in 0..50 {
            let offset = DVec3::new(-1.572, 0.265, -0.78) + DVec3::new(0.061, -0.037, 0.083) * f64::from(step);
            let moved = |m: TriMesh| TriMesh {
                positions: m.positions.iter().map(|p| (turn * p.as_dvec3() + offset).as_vec3()).collect(),
                ..m
            };
            let scene = [
                mesh(moved(cuboid(Vec3::new(-1.0, -0.5, -0.5), Vec3::new(0.0, 0.5, 0.5)))),
                mesh(moved(cuboid(Vec3::new(0.0, -0.85, -0.4), Vec3::new(1.0, 0.85, 0.4)))),
            ];
            assert_eq!(contacts(&scene).pairs().len(), 1, "turn {quarter}, offset {offset}");
        }
    }
}

/// Many faces at one place, many planes close together at a slant, and many faces in one plane are no more work for each
/// face than few. The same is found by any number of threads.
#[test]
fn crowds_of_faces_are_found_by_any_number_of_threads() {
    let mut crowd = TriMesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z], ..TriMesh::default() };
    crowd.triangles = vec![[0, 1, 2]; 20_000];
    let turn = glam::Quat::from_euler(glam::EulerRot::YXZ, 0.7, 0.4, -1.1);
    let slanted = |shift: f32| {
        let mut all = TriMesh::default();
        for k in 0..50_u16 {
            let sheet = grid(14, 1.0, f32::from(k) * 0.01);
            let first = all.positions.len() as u32;
            all.positions.extend(sheet.positions.iter().map(|&p| turn * (p + Vec3::new(shift, 0.0, shift))));
            all.triangles.extend(sheet.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        all
    };
    let scene = [mesh(crowd.clone()), mesh(crowd), plane(Vec3::ZERO, Vec3::Y), mesh(slanted(0.0)), mesh(slanted(0.25))];
    let apart = |a: usize, b: usize| a != b && (a < 3) == (b < 3);
    let by = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Contacts::find(&scene, &apart))
    };
    let found = by(1);
    let first = |objects, faces, aligned| Pair { objects, faces, aligned, points: 0 };
    assert_eq!(found.pairs()[..3], [first([0, 1], 1, 1), first([0, 2], 1, 0), first([1, 2], 1, 0)]);
    assert!(found.pairs()[3].faces > 50 * 300, "{:?}", found.pairs());
    assert!(found.touches(0, 19_999) && found.touches(1, 7));
    let at = DVec3::new(0.3, 0.0, 0.3);
    assert_eq!(objects_at(&found, 0, 19_999, at), [0, 1, 2]);
    let again = by(3);
    assert_eq!(found.pairs(), again.pairs());
    assert_eq!(objects_at(&again, 0, 19_999, at), [0, 1, 2]);
}
