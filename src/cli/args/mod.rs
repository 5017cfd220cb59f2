//! Flags that several commands share. Each value is validated here; combinations of values are in [`super::options`].

pub(super) mod effects;
pub(super) mod model;
pub(super) mod numbers;
pub(super) mod optics;
pub(super) mod reflections;
pub(super) mod settings;
pub(super) mod strict;

pub(super) use effects::EffectArgs;
pub(super) use model::ModelArgs;
pub(super) use optics::OpticsArgs;
pub(super) use settings::SettingsArgs;
pub(super) use strict::StrictArg;
