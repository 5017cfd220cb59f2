//! Reasons for each effect: the parts of the scene that need it.

use super::reach::bounds_of;
use super::shell::is_closed;
use super::{Effect, Reach};
use crate::geometry::contact::Pair;
use crate::geometry::{Aabb, Shape};
use crate::scene::{Colour, Environment, FresnelRule, Interface, LightsFrom, Material, Rgb, Scene, ShadowRule};

/// Number of triangles above which a mesh is not tested for open edges.
const MOST_TRIANGLES: usize = 200_000;

/// Scene, with the parts of it that rays can reach.
pub(super) struct Facts<'a> {
    scene: &'a Scene,
    reach: &'a Reach,
    touching: &'a [Pair],
    /// Media that a ray can be in.
    media: Vec<u32>,
}

/// Decision and its reason.
type Answer = (bool, String);

impl<'a> Facts<'a> {
    pub fn new(scene: &'a Scene, reach: &'a Reach, touching: &'a [Pair]) -> Self {
        let mut media = vec![0];
        media.extend(scene.camera.medium);
        media.extend((0..scene.objects.len()).filter(|&o| reach.meets(o)).filter_map(|o| scene.medium_of(o)));
        media.sort_unstable();
        media.dedup();
        Self { scene, reach, touching, media }
    }

    /// Decides on an effect.
    pub fn of(&self, effect: Effect) -> Answer {
        let scene = self.scene;
        match effect {
            Effect::Ambient if scene.ambient == Rgb::ZERO => off("the scene has no ambient colour"),
            Effect::Ambient => self.surfaces(
                |m| m.ambient * scene.ambient != Rgb::ZERO,
                "answers the scene's ambient colour",
                "no surface answers the ambient colour",
            ),
            Effect::Emission => {
                self.surfaces(|m| m.emission != Rgb::ZERO, "shines by itself", "no surface shines by itself")
            }
            Effect::Diffuse => self.lit(|m| m.diffuse != Colour::Constant(Rgb::ZERO), "has a diffuse colour"),
            Effect::Highlight => self.highlight(),
            Effect::HardShadows => self.shadows(),
            Effect::SoftShadows => self.soft_shadows(),
            Effect::EmissiveLight => self.emissive_light(),
            Effect::SkyLight => self.sky_light(),
            Effect::ShadowsThroughGlass => self.shadows_through_glass(),
            Effect::Mirror => self.interfaces(|i| matches!(i, Interface::Mirror { .. }), "is a mirror", "a mirror"),
            Effect::Conductor => self.interfaces(|i| matches!(i, Interface::Conductor { .. }), "is a metal", "a metal"),
            Effect::Coats => self.interfaces(|i| matches!(i, Interface::Coated { .. }), "has a clear coat", "coated"),
            Effect::ThinPanes => {
                self.interfaces(|i| matches!(i, Interface::ThinDielectric { .. }), "is a thin pane", "a thin pane")
            }
            Effect::Alpha => self.surfaces(
                |m| matches!(m.interface, Interface::Alpha { opacity, mask } if opacity < 1.0 || mask.is_some()),
                "covers only a share",
                "no surface has holes",
            ),
            Effect::Refraction => self.refraction(),
            Effect::FresnelSplit => self.surfaces(
                |m| {
                    matches!(
                        m.interface,
                        Interface::Dielectric { rule: FresnelRule::Fresnel, .. }
                            | Interface::ThinDielectric { rule: FresnelRule::Fresnel, .. }
                    )
                },
                "splits light by the Fresnel equations",
                "no clear surface splits light by angle",
            ),
            Effect::TotalInternalReflection => self.total(),
            Effect::Dispersion => self.dispersion(),
            Effect::Absorption => self.absorption(),
            Effect::NestedMedia => self.stack(),
            Effect::Touching => self.touching(),
            Effect::Environment => match scene.environment {
                Environment::Constant(c) if c == Rgb::ZERO => off("it is black"),
                Environment::Constant(_) => on("rays that meet nothing see one colour"),
                Environment::Gradient { .. } => on("rays that meet nothing see a gradient"),
                Environment::LatLong { texture, .. } | Environment::Map { texture, .. } => {
                    (true, format!("rays that meet nothing see {}", scene.textures[texture as usize].name))
                }
            },
            Effect::Textures => {
                let lit = self.lit(|m| !matches!(m.diffuse, Colour::Constant(_)), "has a textured colour");
                let glow = self.surfaces(|m| m.glow.is_some(), "has a textured emission", "no surface has one");
                if lit.0 || !glow.0 { lit } else { glow }
            }
            Effect::InterpolatedNormals => self.objects(
                |o| {
                    let relief = material(scene, o).relief.is_some();
                    matches!(&scene.geometry[o].shape, Shape::Mesh(mesh) if relief || !mesh.normal_indices.is_empty())
                },
                "has normals of its own",
                "every surface has the normal of its shape",
            ),
        }
    }

    /// Decides whether a ray can be in more than one medium at once.
    pub fn stack(&self) -> Answer {
        let scene = self.scene;
        let solids: Vec<(usize, Option<Aabb>)> = (0..scene.objects.len())
            .filter(|&o| self.reach.meets(o) && scene.medium_of(o).is_some())
            .map(|o| (o, bounds_of(&scene.geometry[o].shape)))
            .collect();
        if solids.is_empty() {
            return off("depth 0 is enough, no solid is transparent");
        }
        if let (Some(medium), (object, _)) = (scene.camera.medium.filter(|&m| m != 0), solids[0]) {
            let (medium, object) = (&scene.media[medium as usize].name, &scene.objects[object].name);
            return (true, format!("the eye is in `{medium}`, and `{object}` is transparent"));
        }
        let surrounding = scene.media[0].priority;
        let yields = |&&(o, _): &&(usize, Option<Aabb>)| {
            scene.medium_of(o).is_some_and(|m| scene.media[m as usize].priority < surrounding)
        };
        if let Some(&(o, _)) = solids.iter().find(yields) {
            return (
                true,
                format!("`{}` yields to `{}`, which surrounds it", scene.objects[o].name, scene.media[0].name),
            );
        }
        for (i, (a, box_a)) in solids.iter().enumerate() {
            for (b, box_b) in &solids[..i] {
                let apart = match (box_a, box_b) {
                    (Some(p), Some(q)) => p.lo.cmpgt(q.hi).any() || q.lo.cmpgt(p.hi).any(),
                    // A half space contains anything that is not proven to be outside.
                    _ => false,
                };
                if !apart {
                    let names = [*b, *a].map(|o| &scene.objects[o].name);
                    return (true, format!("`{}` and `{}` may overlap", names[0], names[1]));
                }
            }
        }
        // Light that enters an open surface is still in its medium when it hits the next one.
        let open = solids.iter().find(|&&(o, _)| !encloses(&scene.geometry[o].shape));
        if let (Some(&(o, _)), true) = (open, solids.len() > 1) {
            return (true, format!("`{}` may be open, so that light takes its medium along", scene.objects[o].name));
        }
        off("depth 1 is enough, no two dielectrics overlap")
    }

    fn interfaces(&self, of: impl Fn(&Interface) -> bool, what: &str, noun: &str) -> Answer {
        self.surfaces(|m| of(&m.interface), what, &format!("no surface is {noun}"))
    }

    fn surfaces(&self, of: impl Fn(&Material) -> bool, what: &str, none: &str) -> Answer {
        self.objects(|o| of(material(self.scene, o)), what, none)
    }

    /// Decides on if rays can hit an object with the property; off if there is none, or all are hidden.
    fn objects(&self, of: impl Fn(usize) -> bool, what: &str, none: &str) -> Answer {
        let such: Vec<usize> = (0..self.scene.objects.len()).filter(|&o| of(o)).collect();
        let name = |o: usize| &self.scene.objects[o].name;
        if let Some(&first) = such.iter().find(|&&o| self.reach.meets(o)) {
            let others = such.iter().filter(|&&o| self.reach.meets(o)).count() - 1;
            let more = if others == 0 { String::new() } else { format!(" (and {others} more)") };
            return (true, format!("`{}` {what}{more}", name(first)));
        }
        match such.first().and_then(|&o| self.reach.hidden[o].map(|wall| (o, wall))) {
            Some((o, wall)) => (false, format!("`{}` {what}, but no ray gets past `{}` to it", name(o), name(wall))),
            None => off(none),
        }
    }

    /// Decides on if such surfaces exist and lights reach them.
    fn lit(&self, of: impl Fn(&Material) -> bool, what: &str) -> Answer {
        match self.useful_lights() {
            Err(why) if !self.scene.shining().any() => (false, why),
            _ => self.surfaces(of, what, &format!("no surface {what}")),
        }
    }

    /// Decides on highlights, which the environment does not make.
    fn highlight(&self) -> Answer {
        match self.useful_lights() {
            Err(why) if !self.scene.shining().emissive => (false, why),
            _ => self.surfaces(|m| m.highlight.is_some(), "has a highlight", "no surface has a highlight"),
        }
    }

    /// Returns the lights that reach anything, or the reason why none does.
    fn useful_lights(&self) -> Result<Vec<usize>, String> {
        let useful: Vec<usize> = (0..self.scene.lights.len()).filter(|&l| self.reach.useless[l].is_none()).collect();
        match (useful.is_empty(), self.reach.useless.iter().flatten().next()) {
            (false, _) => Ok(useful),
            (true, Some(why)) => Err(why.clone()),
            (true, None) if matches!(self.scene.environment, Environment::Constant(c) if c == Rgb::ZERO) => {
                Err(String::from("the scene has no light"))
            }
            (true, None) => Err(String::from("the only light is the environment")),
        }
    }

    fn answering(&self) -> Answer {
        let answers = |m: &Material| m.diffuse != Colour::Constant(Rgb::ZERO) || m.highlight.is_some();
        self.surfaces(answers, "answers light", "no surface answers light")
    }

    fn shadows(&self) -> Answer {
        let useful = self.useful_lights();
        let casts = |l: &&usize| self.scene.lights[**l].shadows;
        let lamp = useful.as_ref().ok().and_then(|useful| useful.iter().find(casts).copied());
        let shining = self.scene.shining();
        let what = match (lamp, useful) {
            (Some(lamp), _) => format!("`{}` casts shadows", self.scene.lights[lamp].name),
            (None, _) if self.scene.settings.shine_shadows && shining.emissive => {
                String::from("surfaces cast shadows in the light of emissive shapes")
            }
            (None, _) if self.scene.settings.shine_shadows && shining.sky => {
                String::from("surfaces cast shadows in the light of the environment")
            }
            (None, Err(why)) => return (false, why),
            (None, Ok(_)) => return off("no light casts shadows"),
        };
        match self.answering() {
            (true, why) => (true, format!("{what}; {why}")),
            no => no,
        }
    }

    fn emissive_light(&self) -> Answer {
        let scene = self.scene;
        let Some(first) = (0..scene.objects.len()).find(|&o| scene.can_light(o)) else {
            let plane = (0..scene.objects.len()).find(|&o| material(scene, o).emission != Rgb::ZERO);
            return match plane {
                Some(o) => (
                    false,
                    format!("`{}` has no bounds or no cover, so its light cannot be sampled", scene.objects[o].name),
                ),
                None => off("no surface shines by itself"),
            };
        };
        let name = &scene.objects[first].name;
        if !scene.admitted().emissive {
            return (false, format!("`{name}` shines, but {}", self.not_admitted()));
        }
        match self.answering() {
            (true, why) => (true, format!("`{name}` shines; {why}")),
            no => no,
        }
    }

    fn sky_light(&self) -> Answer {
        if self.scene.environment == Environment::Constant(Rgb::ZERO) {
            return off("the environment is black");
        }
        if !self.scene.admitted().sky {
            return (false, self.not_admitted());
        }
        let matt = |m: &Material| m.diffuse != Colour::Constant(Rgb::ZERO);
        self.surfaces(matt, "has a diffuse colour under the environment", "no surface has a diffuse colour")
    }

    /// Says why a source does not light surfaces.
    fn not_admitted(&self) -> String {
        match self.scene.settings.lights_from {
            LightsFrom::Auto if self.scene.lights.is_empty() => {
                String::from("the scene has ambient light instead (`lights_from = \"auto\"`)")
            }
            LightsFrom::Auto => {
                String::from("the scene has lamps, which alone light surfaces then (`lights_from = \"auto\"`)")
            }
            level => format!("`lights_from = \"{level}\"`"),
        }
    }

    fn soft_shadows(&self) -> Answer {
        let useful = match self.useful_lights() {
            Ok(useful) => useful,
            Err(why) => return (false, why),
        };
        let Some(&wide) = useful.iter().find(|&&l| self.scene.lights[l].kind.is_extended()) else {
            return off("no lamp has an extent");
        };
        match self.answering() {
            (true, why) => (true, format!("`{}` has an extent; {why}", self.scene.lights[wide].name)),
            no => no,
        }
    }

    fn dispersion(&self) -> Answer {
        let disperses = |m: &&crate::scene::Medium| m.disperses();
        let reached = self.media.iter().map(|&m| &self.scene.media[m as usize]);
        match (reached.clone().find(disperses), self.scene.media.iter().find(disperses)) {
            (Some(medium), _) => (true, format!("`{}` bends each wavelength by its own index", medium.name)),
            (None, Some(medium)) => (false, format!("`{}` disperses, but no ray gets into it", medium.name)),
            (None, None) => off("no medium disperses"),
        }
    }

    fn shadows_through_glass(&self) -> Answer {
        if self.scene.settings.shadows == ShadowRule::Opaque {
            return off("the scene's shadows are opaque");
        }
        if let (false, why) = self.shadows() {
            return (false, why);
        }
        let through = self.surfaces(Material::is_transmissive, "lets light through", "no surface lets light through");
        if through.0 { through } else { self.absorption_or(through) }
    }

    fn absorption_or(&self, otherwise: Answer) -> Answer {
        match self.absorption() {
            (true, why) => (true, why),
            _ => otherwise,
        }
    }

    fn refraction(&self) -> Answer {
        let scene = self.scene;
        let differs = |o: usize| {
            scene.medium_of(o).and_then(|m| {
                let ior = scene.media[m as usize].ior;
                self.media.iter().copied().find(|&other| scene.media[other as usize].ior != ior).map(|other| (m, other))
            })
        };
        let (any, why) = self.objects(|o| scene.medium_of(o).is_some(), "is transparent", "no solid is transparent");
        let bending = (0..scene.objects.len()).filter(|&o| self.reach.meets(o)).find_map(|o| Some((o, differs(o)?)));
        match bending {
            Some((o, (m, other))) => {
                let [m, other] = [m, other].map(|m| &scene.media[m as usize]);
                let name = &scene.objects[o].name;
                (true, format!("`{name}` has index {} against `{}` {}", m.ior as f32, other.name, other.ior as f32))
            }
            None if any => off("every transparent solid has the index of what surrounds it"),
            None => (false, why),
        }
    }

    fn total(&self) -> Answer {
        let scene = self.scene;
        let medium = |m: &u32| &scene.media[*m as usize];
        let by_ior = |a: &&u32, b: &&u32| medium(a).ior.total_cmp(&medium(b).ior);
        let Some(densest) = self.media.iter().max_by(by_ior).map(medium) else {
            return off("no ray can start in a denser medium");
        };
        let films = (0..scene.objects.len()).filter(|&o| self.reach.meets(o)).find(|&o| match *interface(scene, o) {
            Interface::Coated { ior } | Interface::ThinDielectric { ior, .. } => f64::from(ior) < densest.ior,
            _ => false,
        });
        match (self.media.iter().map(medium).find(|m| m.ior < densest.ior), films) {
            (Some(thinner), _) => {
                (true, format!("rays in `{}` can meet `{}`, which is thinner", densest.name, thinner.name))
            }
            (None, Some(o)) => {
                (true, format!("rays in `{}` can meet `{}`, which is thinner", densest.name, scene.objects[o].name))
            }
            _ => off("no ray can start in a denser medium"),
        }
    }

    /// Decides on if surfaces touch; names the first pair and the number of others.
    fn touching(&self) -> Answer {
        let name = |o: u32| &self.scene.objects[o as usize].name;
        let Some((first, others)) = self.touching.split_first() else {
            return off("no surfaces touch");
        };
        let [a, b] = first.objects;
        let what = match (a == b, first.faces) {
            (true, _) => format!("`{}` has duplicate faces", name(a)),
            (false, 0) => format!("`{}` touches `{}` at a point", name(a), name(b)),
            (false, _) => format!("`{}` and `{}` share a surface", name(a), name(b)),
        };
        let more = match others.len() {
            0 => String::new(),
            1 => String::from(" (and 1 pair more)"),
            n => format!(" (and {n} pairs more)"),
        };
        (true, what + &more)
    }

    fn absorption(&self) -> Answer {
        let colours = |m: &&crate::scene::Medium| m.absorption != Rgb::ZERO;
        let reached = self.media.iter().map(|&m| &self.scene.media[m as usize]);
        match (reached.clone().find(colours), self.scene.media.iter().find(colours)) {
            (Some(medium), _) => (true, format!("`{}` has a colour", medium.name)),
            (None, Some(medium)) => (false, format!("`{}` has a colour, but no ray gets into it", medium.name)),
            (None, None) => off("no medium has a colour"),
        }
    }
}

fn on(why: &str) -> Answer {
    (true, why.to_owned())
}

fn off(why: &str) -> Answer {
    (false, why.to_owned())
}

fn material(scene: &Scene, object: usize) -> &Material {
    &scene.materials[scene.objects[object].material as usize]
}

fn interface(scene: &Scene, object: usize) -> &Interface {
    &material(scene, object).interface
}

/// Returns true if a shape is known to be closed.
fn encloses(shape: &Shape) -> bool {
    match shape {
        Shape::Mesh(mesh) => mesh.triangles.len() <= MOST_TRIANGLES && is_closed(mesh),
        Shape::Sphere(_) | Shape::Plane(_) => true,
    }
}
