//! `--effects` and a `--no-EFFECT` for each effect there is.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use crate::choice::Choice as _;
use crate::effects::Effect;

/// Arguments on effects, as typed.
#[derive(Debug, Default)]
pub(in crate::cli) struct EffectArgs {
    /// `auto`, `all`, or names separated by commas.
    pub effects: Option<String>,
    /// Effects named by `--no-EFFECT`.
    pub no: Vec<Effect>,
}

const HEADING: &str = "Effects";

/// Returns the name of the flag that leaves an effect out.
fn flag(effect: Effect) -> String {
    format!("no-{effect}")
}

impl FromArgMatches for EffectArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let no = Effect::ALL.into_iter().filter(|e| matches.get_flag(&flag(*e))).collect();
        Ok(Self { effects: matches.get_one::<String>("effects").cloned(), no })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for EffectArgs {
    fn augment_args(command: Command) -> Command {
        let choice =
            Arg::new("effects").long("effects").value_name("auto|all|LIST").help_heading(HEADING).help(
                "auto: effects the scene needs. all: every effect compiled in (same picture). LIST: only these [default: auto]",
            );
        Effect::ALL.iter().fold(command.arg(choice), |command, effect| {
            // The parser keeps names for the program's lifetime.
            let name: &'static str = flag(*effect).leak();
            let flag = Arg::new(name).long(name).action(ArgAction::SetTrue);
            command.arg(flag.help(effect.help()).help_heading(HEADING))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}
