use glam::Vec3;

use super::*;

const CENTRE: DVec3 = DVec3::new(0.5, -1.0, 0.25);

/// A ball of triangles with the normals of a sphere, stretched, without those that `keep` does not want.
fn ball(stretch: DVec3, keep: impl Fn(DVec3) -> bool, inwards: bool) -> TriMesh {
    const ROWS: u32 = 24;
    let at = |row: u32, column: u32| {
        let (theta, phi) = (
            std::f64::consts::PI * f64::from(row) / f64::from(ROWS),
            std::f64::consts::TAU * f64::from(column % (2 * ROWS)) / f64::from(2 * ROWS),
        );
        match row {
            0 => DVec3::Y,
            ROWS => -DVec3::Y,
            _ => DVec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()),
        }
    };
    let mut mesh = TriMesh::default();
    let mut add = |corners: [DVec3; 3]| {
        if !keep(corners.iter().sum::<DVec3>() / 3.0) {
            return;
        }
        let corners = if inwards { [corners[0], corners[2], corners[1]] } else { corners };
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|p| (CENTRE + p * stretch).as_vec3()));
        let sign = if inwards { -1.0 } else { 1.0 };
        mesh.normals.extend(corners.map(|p| ((p / stretch).normalize() * sign).as_vec3()));
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.normal_indices.push([first, first + 1, first + 2]);
    };
    for row in 0..ROWS {
        for column in 0..2 * ROWS {
            let [a, b, c, d] = [at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1)];
            if row + 1 < ROWS {
                add([a, b, c]);
            }
            if row > 0 {
                add([a, c, d]);
            }
        }
    }
    mesh
}

fn around(far: f64) -> impl Iterator<Item = DVec3> {
    (0..60).map(move |i| {
        let y = 1.0 - (f64::from(i) + 0.5) / 30.0;
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        CENTRE + DVec3::new(cos * (1.0 - y * y).sqrt(), y, sin * (1.0 - y * y).sqrt()) * far
    })
}

#[test]
fn the_point_with_a_normal_is_that_of_the_surface() {
    let map = Explosion::of(&ball(DVec3::new(1.0, 0.6, 1.5), |_| true, false)).unwrap();
    assert!(map.closed && map.outwards);
    for far in around(1.0) {
        let normal = (far - CENTRE).normalize();
        let at = map.walk(normal, map.cells[cell(normal)]).unwrap();
        let stretch = DVec3::new(1.0, 0.6, 1.5);
        // The point of an ellipsoid whose normal it is.
        let exact = CENTRE + stretch * (normal * stretch).normalize();
        assert!(at.inside && at.point.distance(exact) < 0.03, "{normal}: {} and {exact}", at.point);
        assert!(direction(cell(normal)).dot(normal) > 0.98, "a texel is near what is in it");
    }
}

#[test]
fn a_ball_of_triangles_reflects_where_alhazens_problem_says() {
    let map = Explosion::of(&ball(DVec3::ONE, |_| true, false)).unwrap();
    let exact = MirrorBall { centre: CENTRE, radius: 1.0 };
    let eye = CENTRE + DVec3::new(0.3, 0.8, 4.0);
    let mut seen = 0;
    for other in around(1.4).chain(around(6.0)) {
        let truly = exact.mirror_point(eye, other).unwrap();
        if !truly.seen {
            continue;
        }
        let Points::One(found) = map.points(Side::Convex, eye, other) else { panic!("{other} has no point") };
        assert!(found.point.distance(truly.point) < 0.02, "{other}: {} and {}", found.point, truly.point);
        let [e, q] = [eye, other].map(|p| (p - found.point).normalize());
        assert!((found.normal * (2.0 * found.normal.dot(e)) - e).distance(q) < 1e-6, "the law of reflection");
        seen += 1;
    }
    assert!(seen > 40, "{seen}");
}

#[test]
fn a_bowl_shows_a_point_near_it_once_and_one_near_its_middle_several_times() {
    for inwards in [false, true] {
        let bowl = ball(DVec3::ONE, |p| p.z < -0.75, inwards);
        let map = Explosion::of(&bowl).unwrap();
        assert_eq!((map.closed, map.outwards), (false, !inwards));
        let eye = CENTRE + DVec3::new(0.05, 0.1, 0.9);
        assert_eq!(map.faces(eye), [false, true]);
        // A quarter of the radius from the surface: nearer than the focus, so it is seen upright behind the mirror.
        let near = CENTRE + DVec3::new(0.05, 0.0, -0.75);
        let Points::One(found) = map.points(Side::Concave, eye, near) else { panic!("{inwards}") };
        assert!(found.normal.dot(eye - found.point) > 0.0);
        // The eye in the middle sees itself everywhere.
        let several = map.points(Side::Concave, CENTRE + DVec3::Z * 1e-4, CENTRE - DVec3::Z * 1e-4);
        assert_ne!(several, Points::None);
        // Behind the bowl nothing is reflected in its hollow side.
        assert_eq!(map.points(Side::Concave, eye, CENTRE - DVec3::Z * 3.0), Points::None);
    }
}

#[test]
fn surfaces_without_a_map_are_told_by_their_fault() {
    let whole = ball(DVec3::ONE, |_| true, false);
    let fault = |change: &dyn Fn(&mut TriMesh)| {
        let mut mesh = whole.clone();
        change(&mut mesh);
        Explosion::of(&mesh).err()
    };
    assert_eq!(fault(&|_| ()), None);
    assert_eq!(fault(&|m| m.normal_indices.clear()), Some("has no normals to interpolate"));
    assert_eq!(fault(&|m| m.normals[7] = Vec3::ZERO), Some("has a normal of length zero"));
    assert_eq!(fault(&|m| m.normals[700] = Vec3::X), Some("has a crease"));
    assert_eq!(fault(&|m| m.triangles.clear()), Some("has no triangle"));
    let dented = fault(&|m| {
        for p in &mut m.positions {
            p.y -= 1.5 * (p.y - 0.2 + 1.0).max(0.0);
        }
    });
    assert_eq!(dented, Some("is neither convex nor concave"));
    let twice = fault(&|m| {
        let other = m.clone();
        let first = m.positions.len() as u32;
        m.positions.extend(other.positions.iter().map(|&p| p + Vec3::X * 5.0));
        m.normals.extend(&other.normals);
        m.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
        m.normal_indices.extend(other.normal_indices.iter().map(|t| t.map(|i| i + first)));
    });
    assert_eq!(twice, Some("has several parts"));
}
