//! Validated options of `vitrum bench`.

use std::path::PathBuf;

use super::args::BenchArgs;
use crate::cli::options::{Reading, refuse_input};
use crate::image::Destination;
use crate::trial::{BenchPlan, Picture, RayKind};
use crate::{Error, Result};

/// Options of a trial of the back ends.
#[derive(Debug)]
pub(in crate::cli) struct Bench {
    pub scenes: Vec<PathBuf>,
    pub reading: Reading,
    pub plan: BenchPlan,
    /// True to time whole pictures instead of rays.
    pub frames: bool,
    /// Numbers of triangles of a landscape to use instead of scenes.
    pub sweep: Vec<u32>,
    /// Picture of the sweep to write.
    pub plot: Option<Destination>,
    pub json: bool,
    /// Page to write.
    pub html: Option<Destination>,
    pub quiet: bool,
}

impl TryFrom<BenchArgs> for Bench {
    type Error = Error;

    fn try_from(args: BenchArgs) -> Result<Self> {
        if !args.size.is_multiple_of(8) {
            return Err(Error::Usage(format!("--size {}: not a multiple of 8, the edge of a tile", args.size)));
        }
        let html = match args.html {
            None => None,
            Some(name) => {
                refuse_input("--html", &name, args.scenes.iter().map(PathBuf::as_path))?;
                Some(Destination::new(&name)?)
            }
        };
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = match args.threads {
            Some(n) => vec![n as usize],
            None if all == 1 => vec![1],
            None => vec![1, all],
        };
        let named = |kind: &RayKind| args.rays.contains(kind);
        let of_a_sweep = |kind: &RayKind| matches!(kind, RayKind::Primary | RayKind::Diffuse);
        let asked = |kind: &RayKind| match args.rays.is_empty() {
            true => args.sweep.is_none() || of_a_sweep(kind),
            false => named(kind),
        };
        if args.plot.is_some() && args.sweep.is_none() {
            return Err(Error::Usage(String::from("--plot: only --sweep is drawn; give it instead of scenes")));
        }
        let plot = args.plot.as_deref().map(Destination::new).transpose()?;
        Ok(Self {
            frames: args.frames,
            plot,
            plan: BenchPlan {
                bvh: args.bvh.unwrap_or_default(),
                picture: Picture { edge: args.size, one_in: args.one_in },
                kinds: RayKind::ALL.into_iter().filter(asked).collect(),
                threads,
                rounds: args.rounds as usize,
                builds: args.builds as usize,
            },
            sweep: args.sweep.unwrap_or_default(),
            scenes: args.scenes,
            reading: args.model.into(),
            json: args.json,
            html,
            quiet: args.quiet,
        })
    }
}
