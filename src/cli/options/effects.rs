//! Validation of the arguments on effects.

use super::super::args::EffectArgs;
use crate::effects::{Effect, EffectSet, Options, Pipeline};
use crate::load::hint;
use crate::{Error, Result};

/// Converts the arguments to options.
///
/// # Errors
/// Usage if a name is unknown or two arguments contradict each other.
pub(in crate::cli) fn effects(args: &EffectArgs) -> Result<Options> {
    let mut without: EffectSet = args.no.iter().copied().collect();
    let pipeline = match args.effects.as_deref() {
        None | Some("auto") => Pipeline::Auto,
        Some("all") => Pipeline::All,
        Some(list) => {
            let listed: EffectSet = list.split(',').map(|name| named(name.trim())).collect::<Result<_>>()?;
            if let Some(both) = listed.intersection(without).iter().next() {
                return Err(Error::Usage(format!(
                    "--effects {both} and --no-{both} contradict each other; leave one out"
                )));
            }
            without = listed.complement();
            Pipeline::Auto
        }
    };
    Ok(Options { pipeline, without })
}

fn named(name: &str) -> Result<Effect> {
    if let "auto" | "all" = name {
        return Err(Error::Usage(format!("--effects: `{name}` stands alone, or is left out of a list of effects")));
    }
    Effect::named(name).ok_or_else(|| {
        let hint = hint(name, Effect::ALL.iter().map(|e| e.name()));
        Error::Usage(format!("--effects: no effect is called `{name}`{hint}"))
    })
}

/// Refuses an effect that is left out and requested by another flag.
///
/// # Errors
/// Usage if that is so.
pub(in crate::cli) fn refuse_contradiction(options: &Options, effect: Effect, asked: Option<&str>) -> Result<()> {
    match asked {
        Some(flag) if options.without.has(effect) => Err(Error::Usage(format!(
            "{flag} chooses how `{effect}` is done, which is left out; keep it in, or leave {flag} out"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(effects: Option<&str>, no: &[Effect]) -> std::result::Result<Options, String> {
        super::effects(&EffectArgs { effects: effects.map(Into::into), no: no.to_vec() }).map_err(|e| e.to_string())
    }

    #[test]
    fn lists_keep_what_they_name_and_nothing_else() {
        assert_eq!(of(None, &[]), Ok(Options::default()));
        assert_eq!(of(Some("all"), &[]).unwrap().pipeline, Pipeline::All);
        let listed = of(Some("diffuse, mirror"), &[Effect::Alpha]).unwrap();
        assert!(!listed.without.has(Effect::Mirror) && listed.without.has(Effect::Alpha));
        assert_eq!(listed.without.iter().count(), Effect::ALL.len() - 2);
        assert!(of(None, &[Effect::Mirror]).unwrap().without.has(Effect::Mirror));
    }

    #[test]
    fn slips_and_contradictions_get_one_line_with_a_cure() {
        assert_eq!(
            of(Some("refracton"), &[]).unwrap_err(),
            "--effects: no effect is called `refracton`; did you mean `refraction`?"
        );
        let both = of(Some("mirror"), &[Effect::Mirror]).unwrap_err();
        assert_eq!(both, "--effects mirror and --no-mirror contradict each other; leave one out");
        assert!(of(Some("all,mirror"), &[]).unwrap_err().contains("`all` stands alone"));
        assert!(of(Some(""), &[]).is_err());
    }
}
