//! Validated options of `vitrum render`.

use std::path::{Path, PathBuf};

use super::args::RenderArgs;
use crate::accel::walk::TriangleModel;
use crate::accel::{Backend, BuildQuality};
use crate::cli::backend::Renderer;
use crate::cli::options::choices::{no_hierarchy, refraction};
use crate::cli::options::{Exposure, Overrides, Reading, effects, format_of, refuse_input};
use crate::effects::Effect;
use crate::image::{Bits, Destination, Format};
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::Reflection;
use crate::scene::{LightsFrom, ShadowRule};
use crate::study::budget::Wish;
use crate::study::{Axis, Spheres};
use crate::systems::maps::Proxy;
use crate::{Error, Result, render};

/// Picture to render.
#[derive(Debug)]
pub(in crate::cli) struct Render {
    pub scene: PathBuf,
    pub reading: Reading,
    pub output: Destination,
    pub format: Format,
    pub bits: Bits,
    /// Factor on all colours.
    pub exposure: Exposure,
    pub overrides: Overrides,
    /// Representation of the scene's exact spheres.
    pub spheres: Spheres,
    pub backend: Renderer,
    pub bvh: BuildQuality,
    pub options: render::Options,
    /// Budget that the free choices are made for, if any.
    pub wish: Option<Wish>,
    /// Axes whose level the command line chose.
    pub fixed: Vec<Axis>,
    /// Name of the model's camera to use.
    pub camera: Option<String>,
    /// True if warnings and losses are errors.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<RenderArgs> for Render {
    type Error = Error;

    fn try_from(args: RenderArgs) -> Result<Self> {
        let effects = effects::effects(&args.effects)?;
        let bent = args.optics.refraction.is_some_and(|r| r != RefractionModel::Stable).then_some("--refraction");
        effects::refuse_contradiction(&effects, Effect::Refraction, bent)?;
        let straight = matches!(args.optics.shadows, Some(ShadowRule::Straight)).then_some("--shadows straight");
        effects::refuse_contradiction(&effects, Effect::ShadowsThroughGlass, straight)?;
        for (effect, levels) in [
            (Effect::EmissiveLight, [LightsFrom::Emissive, LightsFrom::All]),
            (Effect::SkyLight, [LightsFrom::Sky, LightsFrom::All]),
        ] {
            let asked = args.optics.lights_from.filter(|from| levels.contains(from)).map(|_| "--lights-from");
            effects::refuse_contradiction(&effects, effect, asked)?;
        }
        let spread = args.settings.wavelengths.map(|_| "--wavelengths");
        effects::refuse_contradiction(&effects, Effect::Dispersion, spread)?;
        let backend = backend(&args)?;
        let mirror_levels = mirror_levels(&args)?;
        refuse_carried(&args)?;
        let proxy = proxy(&args)?;
        let name = match args.output {
            Some(name) => name,
            None => default_output(&args.scene)?,
        };
        refuse_input("-o", &name, [args.scene.as_path()])?;
        let output = Destination::new(&name)?;
        let format = format_of(&output)?;
        if args.bits.is_some() && format != Format::Png {
            return Err(Error::Usage(format!(
                "--bits is for PNG; {} has samples of its own kind: leave it out, or end {} in .png",
                format.name(),
                name.display()
            )));
        }
        let fixed = [
            (Axis::Fresnel, args.optics.fresnel.is_some()),
            (Axis::Refraction, args.optics.refraction.is_some()),
            (Axis::Reflection, args.reflection.is_some()),
            (Axis::Shadows, args.optics.shadows.is_some()),
            (Axis::LightsFrom, args.optics.lights_from.is_some()),
            (Axis::Spheres, args.spheres.is_some()),
            (Axis::Cutoff, args.settings.cutoff.is_some() || args.cutoff_error.is_some()),
            (Axis::Depth, args.settings.depth.is_some()),
            (Axis::Backend, args.backend.is_some() || matches!(backend, Renderer::Walk(..))),
            (Axis::Triangles, args.triangles.is_some()),
            (Axis::Reciprocal, args.reciprocal.is_some()),
        ];
        if args.bvh.is_some() && backend == Renderer::Reference {
            return Err(no_hierarchy("the f64 renderer has"));
        }
        let wish = args.max_error.map(Wish::MaxError).or(args.time_budget.map(Wish::Time));
        if wish.is_some() && backend == Renderer::Reference {
            return Err(Error::Usage(String::from(
                "--backend reference: f64 is exact already; leave --max-error or --time-budget out",
            )));
        }
        if let (Some(_), Some(left_out)) = (wish, effects.without.iter().next()) {
            return Err(Error::Usage(format!(
                "--no-{left_out}: a budget is for the whole of a scene's effects; leave it out, or --max-error and --time-budget"
            )));
        }
        Ok(Self {
            scene: args.scene,
            reading: args.model.into(),
            output,
            format,
            bits: args.bits.unwrap_or_default(),
            exposure: Exposure { ev: args.exposure.unwrap_or(0.0) },
            overrides: Overrides::new(args.settings, args.optics),
            spheres: args.spheres.unwrap_or(Spheres::Exact),
            wish,
            fixed: fixed.into_iter().filter(|(_, given)| *given).map(|(axis, _)| axis).collect(),
            backend,
            bvh: args.bvh.unwrap_or_default(),
            options: render::Options {
                fresnel: args.optics.fresnel.unwrap_or_default(),
                refraction: refraction(args.optics.refraction, args.optics.oliveira)?,
                reflection: args.reflection.unwrap_or_default(),
                proxy,
                maps: None,
                past: None,
                mirror_levels,
                effects,
                cutoff_error: args.cutoff_error,
                threads: args.threads.unwrap_or(0) as usize,
                tile: args.tile,
            },
            camera: args.camera,
            strict: args.strict.strict,
            json: args.json,
            quiet: args.quiet,
        })
    }
}

/// Checks that the rays of a mirrored camera carry neither polarisation nor a budget.
///
/// # Errors
/// Usage if they would.
fn refuse_carried(args: &RenderArgs) -> Result<()> {
    let flag = match (args.optics.fresnel, args.cutoff_error) {
        (Some(FresnelModel::Polarised), _) => "--fresnel polarised",
        (_, Some(_)) => "--cutoff-error",
        _ => return Ok(()),
    };
    if matches!(args.reflection, Some(Reflection::Planar | Reflection::Virtual)) {
        return Err(Error::Usage(format!(
            "{flag}: the rays of mirrored cameras and virtual scenes do not carry what it needs; leave it out, or take \
             --reflection traced"
        )));
    }
    Ok(())
}

/// Proxy of the surroundings for reflectors that show maps.
///
/// # Errors
/// Usage if a proxy is given but no reflector shows a map.
fn proxy(args: &RenderArgs) -> Result<Proxy> {
    let maps = matches!(args.reflection, Some(Reflection::CubeMap | Reflection::SphereMap));
    match args.proxy {
        Some(_) if !maps => Err(Error::Usage(String::from(
            "--proxy: is for --reflection cube-map and sphere-map, which look surroundings up; give one of them, too",
        ))),
        proxy => Ok(proxy.unwrap_or_default()),
    }
}

/// Returns the largest number of mirrors in a row in which the camera is mirrored.
///
/// # Errors
/// [`Error::Usage`] if a number is given without `--reflection planar`.
fn mirror_levels(args: &RenderArgs) -> Result<u32> {
    match (args.mirror_levels, args.reflection) {
        (Some(_), Some(Reflection::Planar)) | (None, _) => Ok(args.mirror_levels.unwrap_or(u32::MAX)),
        (Some(_), _) => Err(Error::Usage(String::from(
            "--mirror-levels: is for --reflection planar, which mirrors the camera; give both, or --depth alone",
        ))),
    }
}

/// Returns the renderer.
///
/// # Errors
/// - [`Error::Usage`] if a triangle test or a reciprocal is chosen for a back end that has its own.
/// - [`Error::Limit`] if this build has no Embree.
fn backend(args: &RenderArgs) -> Result<Renderer> {
    let flag = match (args.triangles, args.reciprocal) {
        (Some(_), _) => "--triangles",
        (None, Some(_)) => "--reciprocal",
        (None, None) => return Renderer::choose(args.backend),
    };
    if let Some(given) = args.backend.filter(|given| *given != Renderer::Packets(Backend::Native)) {
        return Err(Error::Usage(format!(
            "{flag}: is a choice of the native hierarchy, --backend {} has its own; leave one of them out",
            given.name()
        )));
    }
    let triangles = args.triangles.unwrap_or(TriangleModel::Watertight);
    Ok(Renderer::Walk(triangles, args.reciprocal.unwrap_or_default()))
}

/// Returns the scene's name with `.png`, in the current folder.
fn default_output(scene: &Path) -> Result<PathBuf> {
    match scene.file_stem() {
        Some(stem) => {
            let mut name = stem.to_os_string();
            name.push(".png");
            Ok(name.into())
        }
        None => Err(Error::Usage(format!("{}: no scene file; name one that ends in .toml or .obj", scene.display()))),
    }
}
