//! Layers of surfaces that touch at one point, in the order in which a ray crosses them.
//!
//! Both renderers use this, so that contact means the same in both. `src/README.md`, "Touching surfaces", states the
//! rules.

use glam::DVec3;

use crate::geometry::contact::{Contacts, Face};
use crate::scene::{Interface, Scene};

/// Surface at a contact, or several that are crossed as one.
#[derive(Clone, Debug)]
pub enum Layer {
    /// Cover with holes, thin pane or opaque surface.
    Alone(Face),
    /// Boundaries of media, crossed together.
    Media(Vec<Face>),
}

/// Position of a ray between two layers.
#[derive(Clone, Copy, Debug)]
pub struct Through {
    /// Face by which the contact was found: object and triangle.
    pub face: (u32, u32),
    /// Point of the contact, in scene units.
    pub point: DVec3,
    /// True if the contact was reached on the outside of that face.
    pub from_front: bool,
    /// Number of layers passed, counted from the side of arrival.
    pub passed: u8,
    /// True if the ray returns to the side of arrival.
    pub back: bool,
}

/// Point where surfaces touch, as one ray arrives there.
#[derive(Clone, Debug)]
pub struct ContactPoint {
    layers: Vec<Layer>,
    /// Number of layers of the nearer of two surfaces that touch at a point; all of them where faces coincide.
    nearer: usize,
    /// All faces of the nearer and of the farther surface, including those that no layer needs.
    faces: [Vec<Face>; 2],
    way: Through,
}

impl ContactPoint {
    /// Returns the contact at which a traced ray hit a face, or `None` if nothing else lies there. `point` is on the
    /// face.
    #[must_use]
    pub fn met(
        scene: &Scene,
        contacts: &Contacts,
        (object, primitive): (u32, u32),
        [origin, dir]: [DVec3; 2],
        point: DVec3,
    ) -> Option<Self> {
        if !contacts.touches(object, primitive) {
            return None;
        }
        let own = Face::of(&scene.geometry, object, primitive);
        if !contacts.may_meet(object, primitive, point, own.reach(point)) {
            return None;
        }
        let outward = own.outward(point);
        let from_front = dir.dot(outward) < 0.0;
        let way = Through { face: (object, primitive), point, from_front, passed: 0, back: false };
        let mut place = Self::at(scene, contacts, way)?;
        place.way.passed = place.already_passed(contacts, origin) as u8;
        Some(place)
    }

    /// Returns the contact that a ray is passing through.
    #[must_use]
    pub fn resumed(scene: &Scene, contacts: &Contacts, way: Through) -> Option<Self> {
        Self::at(scene, contacts, way).filter(|place| place.index().is_some())
    }

    fn at(scene: &Scene, contacts: &Contacts, way: Through) -> Option<Self> {
        let Through { face: (object, primitive), point, from_front, .. } = way;
        let own = Face::of(&scene.geometry, object, primitive);
        let outward = own.outward(point);
        // Points to the side of arrival.
        let towards_ray = if from_front { outward } else { -outward };
        let gather = |face: &Face| {
            let mut faces = Vec::new();
            contacts.faces_at(face.object, face.primitive, point, face.reach(point), &mut faces);
            faces
        };
        let order = |faces: &[Face]| order(scene, faces, towards_ray, point);
        if let Some((tangent, sphere, other)) = contacts.tangent_at(object, primitive, point) {
            let into_other = towards_ray.dot(tangent.towards) < 0.0;
            let (first, second) = if into_other { (sphere, other) } else { (other, sphere) };
            let faces = [gather(&first), gather(&second)];
            let mut layers = order(&faces[0]);
            let nearer = layers.len();
            layers.extend(order(&faces[1]));
            return Some(Self { layers, nearer, faces, way });
        }
        let faces = gather(&own);
        if faces.len() == 1 && faces[0].id() == own.id() {
            return None;
        }
        let layers = order(&faces);
        Some(Self { nearer: layers.len(), layers, faces: [faces, Vec::new()], way })
    }

    /// Returns the number of layers in front of a ray that came from `origin`: 0, unless it started between two
    /// surfaces that touch at a point.
    fn already_passed(&self, contacts: &Contacts, origin: DVec3) -> usize {
        let (object, primitive) = self.way.face;
        let Some((tangent, sphere, other)) = contacts.tangent_at(object, primitive, self.way.point) else { return 0 };
        let met_nearer = self.layers[..self.nearer].iter().flat_map(Layer::faces).any(|f| f.object == object);
        if met_nearer {
            return 0;
        }
        // The farther surface was hit first: either rounding exchanged the two, or the ray started in the gap.
        let nearer_is_sphere = self.layers[0].faces().iter().any(|f| f.object == sphere.object);
        let beyond_nearer = if nearer_is_sphere {
            sphere.height(origin) < -sphere.reach(origin)
        } else {
            let gap_side = -other.outward(tangent.contact).dot(tangent.towards).signum();
            other.height(origin) * gap_side < -other.reach(origin)
        };
        if beyond_nearer { 0 } else { self.nearer }
    }

    /// Returns the index of the current layer.
    fn index(&self) -> Option<usize> {
        let passed = usize::from(self.way.passed);
        let index = if self.way.back { passed.checked_sub(1)? } else { passed };
        (index < self.layers.len()).then_some(index)
    }

    /// Returns the current layer.
    #[must_use]
    pub fn layer(&self) -> &Layer {
        &self.layers[self.index().unwrap_or(0)]
    }

    /// Returns the position of a ray that continues behind the current layer, or `None` if it leaves the contact.
    #[must_use]
    pub fn onward(&self) -> Option<Through> {
        let index = self.index()?;
        let way = Through { passed: if self.way.back { index } else { index + 1 } as u8, ..self.way };
        self.continued(way)
    }

    /// Returns the position of a ray that leaves the current layer on its side of arrival, or `None` if it leaves the
    /// contact.
    #[must_use]
    pub fn returning(&self) -> Option<Through> {
        let index = self.index()?;
        let passed = if self.way.back { index + 1 } else { index } as u8;
        self.continued(Through { passed, back: !self.way.back, ..self.way })
    }

    fn continued(&self, way: Through) -> Option<Through> {
        let more = if way.back { way.passed > 0 } else { usize::from(way.passed) < self.layers.len() };
        more.then_some(way)
    }

    /// Returns two distances in scene units: between `governing` and the faces that lie together with the current
    /// layer, and the largest offset of an `f32` ray origin from any of them.
    #[must_use]
    pub fn spread(&self, governing: &Face) -> (f64, f64) {
        let index = self.index().unwrap_or(0);
        let point = self.way.point;
        let height = |face: &Face| face.height(point) * face.outward(point).dot(governing.outward(point)).signum();
        let together = &self.faces[usize::from(index >= self.nearer)];
        together.iter().fold((0.0, 0.0), |(apart, reach): (f64, f64), face| {
            (apart.max((height(face) - height(governing)).abs()), reach.max(face.reach(point)))
        })
    }

    /// Returns the objects at the contact, each with true if a ray in `dir` arrives on its outside. Also returns twice
    /// the largest distance between two of them, in scene units.
    #[must_use]
    pub fn sides(&self, dir: DVec3) -> (Vec<(u32, bool)>, f64) {
        let point = self.way.point;
        let faces = || self.faces.iter().flatten();
        let sides = faces().map(|face| (face.object, self.is_outside(face, dir))).collect();
        let apart = faces().map(|face| face.height(point).abs() + face.reach(point)).fold(0.0, f64::max);
        (sides, 2.0 * apart)
    }

    /// Returns true if a ray in `dir` arrives on the outside of a face.
    #[must_use]
    pub fn is_outside(&self, face: &Face, dir: DVec3) -> bool {
        face.outward(self.way.point).dot(dir) < 0.0
    }

    /// Returns the bodies that a ray in `dir` crosses together with the faces of a layer of media, in order, each with
    /// true if it is entered. `body_of` gives the body of an object.
    #[must_use]
    pub fn crossed(&self, faces: &[Face], dir: DVec3, body_of: impl Fn(u32) -> Option<u32>) -> Vec<(u32, bool)> {
        let mut crossed: Vec<(u32, bool)> =
            faces.iter().map(|face| (body_of(face.object).unwrap_or(0), self.is_outside(face, dir))).collect();
        crossed.sort_unstable();
        crossed
    }

    /// Returns the point of the contact, in scene units.
    #[must_use]
    pub fn point(&self) -> DVec3 {
        self.way.point
    }
}

impl Layer {
    /// Returns the faces of the layer.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        match self {
            Self::Alone(face) => std::slice::from_ref(face),
            Self::Media(faces) => faces,
        }
    }
}

/// Returns the face whose normal, tint and reflectance apply to a layer of media, for a ray from the medium `from` to
/// `to`. It is one that bounds the medium behind, else one that bounds the medium before. `arrives_outside` tells on
/// which side of a face the ray arrives.
#[must_use]
pub fn governing<'a>(
    scene: &Scene,
    faces: &'a [Face],
    [from, to]: [u32; 2],
    arrives_outside: impl Fn(&Face) -> bool,
) -> &'a Face {
    let medium = |face: &Face| scene.medium_of(face.object as usize);
    let behind = faces.iter().find(|face| medium(face) == Some(to) && arrives_outside(face));
    let before = || faces.iter().find(|face| medium(face) == Some(from) && !arrives_outside(face));
    behind.or_else(before).unwrap_or(&faces[0])
}

/// Sorts the faces of a contact into layers: covers, panes, then media or an opaque surface. An opaque surface ends the
/// ray in the medium of arrival, so no boundary of the contact is crossed before it.
fn order(scene: &Scene, faces: &[Face], towards_ray: DVec3, point: DVec3) -> Vec<Layer> {
    let interface = |face: &Face| &scene.materials[scene.objects[face.object as usize].material as usize].interface;
    // Faces towards the ray come first, then those listed later.
    let rank = |face: &Face| {
        let faces_ray = face.outward(point).dot(towards_ray) > 0.0;
        (!faces_ray, std::cmp::Reverse(face.object), face.primitive)
    };
    let (mut covers, mut panes, mut media, mut opaque) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for &face in faces {
        match interface(&face) {
            Interface::Alpha { .. } => covers.push(face),
            Interface::ThinDielectric { .. } => panes.push(face),
            Interface::Dielectric { .. } => media.push(face),
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                opaque.push(face);
            }
        }
    }
    covers.sort_by_key(rank);
    panes.sort_by_key(rank);
    let mut layers: Vec<Layer> = covers.into_iter().chain(panes).map(Layer::Alone).collect();
    if let Some(face) = opaque.into_iter().min_by_key(rank) {
        layers.push(Layer::Alone(face));
    } else if !media.is_empty() {
        layers.push(Layer::Media(media));
    }
    layers
}
