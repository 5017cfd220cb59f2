//! A scene file or a model, and the options of reading it.

use std::path::{Path, PathBuf};

use crate::cli::args::ModelArgs;
use crate::load::{self, LoadOptions, Loaded, ModelOptions};
use crate::{Error, Result};

/// Options of reading scenes and models.
#[derive(Clone, Debug, Default)]
pub(in crate::cli) struct Reading {
    pub model: ModelOptions,
    pub allow_outside: Vec<PathBuf>,
}

impl From<ModelArgs> for Reading {
    fn from(args: ModelArgs) -> Self {
        let model = ModelOptions {
            up: args.up.map_or_else(Default::default, Into::into),
            smooth: args.smooth,
            eye: args.eye,
            target: args.target,
            fov: args.fov,
            materials: args.material,
            background: args.background,
            environment: args.environment,
            lights: args.light,
        };
        Self { model, allow_outside: args.allow_outside }
    }
}

impl Reading {
    /// Returns the options of the loader for a file.
    ///
    /// # Errors
    /// [`Error::Usage`] if options for a model by itself are given for a scene file.
    pub fn options(&self, file: &Path, strict: bool) -> Result<LoadOptions> {
        let is_scene = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        if let (Some(flag), true) = (self.model.given(), is_scene) {
            return Err(Error::Usage(format!(
                "{flag}: is for a model by itself, and {} is a scene file, which says this itself; edit it",
                file.display()
            )));
        }
        let names = self.model.materials.iter().map(|(name, _)| name);
        if let Some(name) = names.clone().enumerate().find_map(|(i, name)| names.clone().take(i).find(|n| *n == name)) {
            return Err(Error::Usage(format!("--material: `{name}` is given twice; give each material once")));
        }
        let (model, allow_outside) = (self.model.clone(), self.allow_outside.clone());
        Ok(LoadOptions { strict, model, allow_outside, ..LoadOptions::default() })
    }

    /// Loads a scene file or a model.
    ///
    /// # Errors
    /// As [`Self::options`] and [`load::scene`].
    pub fn load(&self, file: &Path, strict: bool) -> Result<Loaded> {
        load::scene(file, &self.options(file, strict)?)
    }
}
