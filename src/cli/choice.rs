//! Values of options that name a level of a [`Choice`].

use std::ffi::OsStr;
use std::marker::PhantomData;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command};

use crate::choice::{Choice, Unreadable};

/// Parser for the levels of `C`, which also lists them in the help.
#[derive(Debug)]
pub(super) struct Levels<C>(PhantomData<C>);

impl<C> Clone for Levels<C> {
    fn clone(&self) -> Self {
        Self(PhantomData)
    }
}

/// Parser for all levels of a choice.
pub(super) fn levels<C: Choice>() -> Levels<C> {
    Levels(PhantomData)
}

/// Help of the option for a choice, with its default.
pub(super) fn about<C: Choice>() -> String {
    match C::DEFAULT {
        Some(default) => about_with::<C>(default.name()),
        None => C::about(),
    }
}

/// Help of the option for a choice whose default depends on the command.
pub(super) fn about_with<C: Choice>(default: &str) -> String {
    format!("{} [default: {default}]", C::about())
}

impl<C: Choice> TypedValueParser for Levels<C> {
    type Value = C;

    fn parse_ref(&self, command: &Command, option: Option<&Arg>, value: &OsStr) -> Result<C, clap::Error> {
        match value.to_str().map_or(Err(Unreadable::Name), C::parse) {
            Ok(level) => Ok(level),
            Err(Unreadable::Number(range)) => {
                let refuse = move |_: &str| Err::<C, String>(format!("not {range}"));
                TypedValueParser::parse_ref(&refuse, command, option, value)
            }
            Err(Unreadable::Name) => {
                // It does not find the name either, and words the error.
                let names = PossibleValuesParser::new(C::LEVELS.iter().map(|level| possible(*level)));
                names.parse_ref(command, option, value).map(|_| C::LEVELS[0])
            }
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(C::LEVELS.iter().map(|level| possible(*level))))
    }
}

fn possible<C: Choice>(level: C) -> PossibleValue {
    PossibleValue::new(level.name()).aliases(level.aliases()).help(level.help())
}

crate::choice! {
    /// Paths of the verification.
    pub enum PathArg("backend", derive(Eq)) {
        /// Eight-wide hierarchy of this program.
        "native" => Native,
        /// Embree, robust and fast, where built in.
        "embree" => Embree,
    }
}
