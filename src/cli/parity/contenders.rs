//! Who is compared: the native path, and Embree in both its modes where it is there.

use crate::Result;
use crate::accel::{Unbounded, native::Native};
use crate::image::Film;
use crate::render::{Observer, Options, render};
use crate::scene::Scene;
use crate::trial::parity::{Answers, Set, ask};

/// Every path over the same shapes, the native one first.
pub(super) struct Contenders {
    native: Unbounded<Native>,
    #[cfg(feature = "embree")]
    embree: Vec<(&'static str, Unbounded<crate::accel::embree::Embree>)>,
    /// Why Embree is not among them, where it is not.
    pub left_out: Option<String>,
}

impl Contenders {
    /// Builds all of them over the shapes of `scene`.
    pub fn build(scene: &Scene, threads: usize) -> Self {
        let geometry = &scene.geometry;
        let native = Unbounded::new(Native::build(geometry), geometry);
        #[cfg(feature = "embree")]
        {
            let (embree, left_out) = match embree(scene, threads) {
                Ok(embree) => (embree, None),
                Err(e) => (Vec::new(), Some(e.to_string())),
            };
            Self { native, embree, left_out }
        }
        #[cfg(not(feature = "embree"))]
        {
            let _ = threads;
            let why = "this program was built without it; `cargo build --release --features embree` builds one with it";
            Self { native, left_out: Some(why.into()) }
        }
    }

    /// Their names, in order.
    pub fn names(&self) -> Vec<&'static str> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's names follow"))]
        let mut names = vec!["native"];
        #[cfg(feature = "embree")]
        names.extend(self.embree.iter().map(|(name, _)| *name));
        names
    }

    /// What each answers to a set of rays.
    pub fn ask(&self, set: &Set) -> Vec<Answers> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's answers follow"))]
        let mut answers = vec![ask(&self.native, &set.rays, set.coherence)];
        #[cfg(feature = "embree")]
        answers.extend(self.embree.iter().map(|(_, accel)| ask(accel, &set.rays, set.coherence)));
        answers
    }

    /// The picture that each makes.
    ///
    /// # Errors
    /// As [`render`].
    pub fn films(&self, scene: &Scene, options: &Options, observer: &Observer) -> Result<Vec<Film>> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's pictures follow"))]
        let mut films = vec![render(scene, &self.native, options, observer)?.film];
        #[cfg(feature = "embree")]
        for (_, accel) in &self.embree {
            films.push(render(scene, accel, options, observer)?.film);
        }
        Ok(films)
    }
}

#[cfg(feature = "embree")]
fn embree(scene: &Scene, threads: usize) -> Result<Vec<(&'static str, Unbounded<crate::accel::embree::Embree>)>> {
    use crate::accel::embree::{Embree, Mode, Options};

    [("embree-robust", Mode::Robust), ("embree-fast", Mode::Fast)]
        .into_iter()
        .map(|(name, mode)| {
            let options = Options { mode, threads, ..Options::default() };
            Ok((name, Unbounded::new(Embree::build(&scene.geometry, &options)?, &scene.geometry)))
        })
        .collect()
}
