//! Settings with a fixed list of named levels.
//!
//! [`choice!`](crate::choice!) declares a setting once, where its type lives. The command line, file metadata, reports and the study of
//! accuracy read that declaration through [`Choice`].

use std::fmt;

/// A setting with a fixed list of named levels, declared by [`choice!`](crate::choice!).
pub trait Choice: Copy + PartialEq + fmt::Debug + fmt::Display + Send + Sync + 'static {
    /// Name of the setting in reports. The command line's option is this name after two dashes.
    const OPTION: &'static str;
    /// Documentation of the setting, one string for each line.
    const DOC: &'static [&'static str];
    /// All levels, in the order of their declaration. A level with a number has its initial number.
    const LEVELS: &'static [Self];
    /// Level that a command takes if none is given.
    const DEFAULT: Option<Self>;

    /// Name of the level, without its number.
    fn name(self) -> &'static str;

    /// Further names that are accepted as input.
    fn aliases(self) -> &'static [&'static str];

    /// Documentation of the level, one string for each line.
    fn doc(self) -> &'static [&'static str];

    /// Number of the level, and the range of such numbers in words. None for a level without a number.
    fn number(self) -> Option<(f64, &'static str)>;

    /// The level with another number. None if the level has no number or `number` is out of range.
    fn with_number(self, number: f64) -> Option<Self>;

    /// Levels worth comparing: all of them, and a level with a number once for each of its noted numbers.
    fn compared() -> Vec<Self>;

    /// Reads `NAME`, or `NAME=NUMBER` for a level with a number.
    ///
    /// # Errors
    /// The reason for which `text` is no level.
    fn parse(text: &str) -> Result<Self, Unreadable> {
        let (name, number) = text.split_once('=').map_or((text, None), |(name, number)| (name, Some(number)));
        let called = |level: &Self| level.name() == name || level.aliases().contains(&name);
        let level = Self::LEVELS.iter().copied().find(called).ok_or(Unreadable::Name)?;
        match (number, level.number()) {
            (None, _) => Ok(level),
            (Some(_), None) => Err(Unreadable::Name),
            (Some(text), Some((_, range))) => {
                number_of(text).and_then(|x| level.with_number(x)).ok_or(Unreadable::Number(range))
            }
        }
    }

    /// One line about the setting.
    #[must_use]
    fn about() -> String {
        summary(Self::DOC)
    }

    /// One line about the level.
    #[must_use]
    fn help(self) -> String {
        let text = summary(self.doc());
        match self.number() {
            None => text,
            Some((initial, range)) => {
                format!("{text}; {}=C sets its constant: {range} [default: {initial}]", self.name())
            }
        }
    }
}

/// Reason for which a text is no level of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreadable {
    /// No level has this name.
    Name,
    /// The level's number is not in this range.
    Number(&'static str),
}

/// Number of a level, such as the constant of a formula.
pub trait Constant: Copy + PartialEq + 'static {
    /// Range of the number in words.
    const RANGE: &'static str;
    /// Numbers worth comparing.
    const NOTED: &'static [Self];

    /// The number.
    fn number(self) -> f64;

    /// The constant of this number, if it is in range.
    fn of(number: f64) -> Option<Self>;
}

/// Writes `NAME`, or `NAME=NUMBER`. [`Choice::parse`] reads it.
///
/// # Errors
/// Those of the formatter.
pub fn write<C: Choice>(level: C, f: &mut fmt::Formatter) -> fmt::Result {
    match level.number() {
        None => f.pad(level.name()),
        Some((number, _)) => f.pad(&format!("{}={number}", level.name())),
    }
}

/// Reads a number, or a quotient of two such as 1/512.
#[must_use]
pub fn number_of(text: &str) -> Option<f64> {
    let parsed = |text: &str| text.trim().parse::<f64>().ok();
    match text.split_once('/') {
        Some((above, below)) => Some(parsed(above)? / parsed(below)?),
        None => parsed(text),
    }
}

/// First paragraph of a documentation, in one line and without its full stop.
fn summary(doc: &[&str]) -> String {
    let paragraph: Vec<&str> = doc.iter().map(|line| line.trim()).take_while(|line| !line.is_empty()).collect();
    let text = paragraph.join(" ").replace('`', "");
    text.strip_suffix('.').map(String::from).unwrap_or(text)
}

/// Declares an enum whose variants are the levels of a setting, with everything that names them.
///
/// The first paragraph of each documentation comment is the help text of the setting or level.
///
/// ```
/// use vitrum::choice::Choice as _;
///
/// vitrum::choice! {
///     /// Colour of the sky.
///     pub enum Sky("sky", derive(Eq, Hash), default(Blue)) {
///         /// Black everywhere.
///         "none" | "black" => Black,
///         /// Blue above the horizon.
///         "blue" => Blue,
///     }
/// }
///
/// assert_eq!(Sky::parse("black"), Ok(Sky::Black));
/// assert_eq!(Sky::Blue.to_string(), "blue");
/// assert_eq!((Sky::about(), Sky::Black.help()), ("Colour of the sky".into(), "Black everywhere".into()));
/// ```
///
/// A level may hold a [`Constant`]: `"bent" => Bent(by: Bend = Bend::LITTLE)` is read from `bent` and `bent=0.5`.
///
/// With `visitor(Visitor, Formula)` each level names, after `by`, a value of a type that implements the trait `Formula`. The enum's
/// `dispatch` then calls the method of a `Visitor` with it, so that code that is generic over formulas is called for a level that is
/// known at run time only.
#[macro_export]
macro_rules! choice {
    (
        $(#[doc = $doc:literal])+
        $vis:vis enum $Name:ident(
            $option:literal
            $(, derive($($derive:path),+))? $(, default($default:ident))? $(, visitor($Visitor:ident, $Formula:path))?
        ) $levels:tt
    ) => {
        $crate::choice! { @enum [$($doc),+] $vis $Name $option [$($($derive),+)?] [$($default)?] $levels }
        $($crate::choice! { @visitor $vis $Name $Visitor $Formula, $levels })?
    };

    (
        @enum [$($doc:literal),+] $vis:vis $Name:ident $option:literal [$($derive:path),*] [$($default:ident)?]
        {$(
            $(#[doc = $level_doc:literal])+
            $name:literal $(| $alias:literal)* => $Level:ident $(($bind:ident: $Constant:ty = $initial:expr))? $(by $formula:expr)?,
        )+}
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, $($derive),*)]
        $vis enum $Name {
            $($(#[doc = $level_doc])+ $Level $(($Constant))?,)+
        }

        impl $Name {
            /// All levels, in the order of their declaration.
            $vis const ALL: [Self; [$($name),+].len()] = [$(Self::$Level $(($initial))?),+];

            /// Name of the level on the command line and in reports, without its number.
            #[must_use]
            $vis const fn name(self) -> &'static str {
                match self {
                    $(Self::$Level { .. } => $name,)+
                }
            }
        }

        impl $crate::choice::Choice for $Name {
            const OPTION: &'static str = $option;
            const DOC: &'static [&'static str] = &[$($doc),+];
            const LEVELS: &'static [Self] = &Self::ALL;
            const DEFAULT: Option<Self> = $crate::choice!(@option $(Self::$default)?);

            fn name(self) -> &'static str {
                self.name()
            }

            fn aliases(self) -> &'static [&'static str] {
                match self {
                    $(Self::$Level { .. } => &[$($alias),*],)+
                }
            }

            fn doc(self) -> &'static [&'static str] {
                match self {
                    $(Self::$Level { .. } => &[$($level_doc),+],)+
                }
            }

            fn number(self) -> Option<(f64, &'static str)> {
                match self {
                    $(Self::$Level $(($bind))? => $crate::choice!(
                        @option $(($crate::choice::Constant::number($bind), <$Constant as $crate::choice::Constant>::RANGE))?
                    ),)+
                }
            }

            fn with_number(self, number: f64) -> Option<Self> {
                let _ = number;
                match self {
                    $(Self::$Level { .. } => $crate::choice!(
                        @first $([<$Constant as $crate::choice::Constant>::of(number).map(Self::$Level)])? [None]
                    ),)+
                }
            }

            fn compared() -> Vec<Self> {
                [$($crate::choice!(
                    @first $([<$Constant as $crate::choice::Constant>::NOTED.iter().copied().map(Self::$Level).collect::<Vec<_>>()])?
                        [vec![Self::$Level]]
                )),+].concat()
            }
        }

        impl std::fmt::Display for $Name {
            fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                $crate::choice::write(*self, f)
            }
        }

        $(impl Default for $Name {
            fn default() -> Self {
                Self::$default
            }
        })?
    };

    (
        @visitor $vis:vis $Name:ident $Visitor:ident $Formula:path,
        {$(
            $(#[doc = $level_doc:literal])+
            $name:literal $(| $alias:literal)* => $Level:ident $(($bind:ident: $Constant:ty = $initial:expr))? $(by $formula:expr)?,
        )+}
    ) => {
        #[doc = concat!("Code to be called with the formula of a [`", stringify!($Name), "`].")]
        $vis trait $Visitor {
            /// Result of the call.
            type Output;

            /// Is called with the formula.
            fn visit<F: $Formula>(self, formula: F) -> Self::Output;
        }

        impl $Name {
            /// Calls `visitor` with the formula of this level.
            #[inline]
            $vis fn dispatch<V: $Visitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$Level $(($bind))? => visitor.visit($($formula)?),)+
                }
            }
        }
    };

    (@option) => { None };
    (@option $value:expr) => { Some($value) };
    (@first [$first:expr] $([$rest:expr])?) => { $first };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Bend(f64);

    impl Constant for Bend {
        const RANGE: &'static str = "a number above 0";
        const NOTED: &'static [Self] = &[Self(1.0), Self(2.0)];

        fn number(self) -> f64 {
            self.0
        }

        fn of(number: f64) -> Option<Self> {
            (number > 0.0).then_some(Self(number))
        }
    }

    trait Formula {
        fn result(self, x: f64) -> f64;
    }

    struct Half;

    impl Formula for Half {
        fn result(self, x: f64) -> f64 {
            x / 2.0
        }
    }

    impl Formula for Bend {
        fn result(self, x: f64) -> f64 {
            x * self.0
        }
    }

    choice! {
        /// Formula for a test:
        /// in two lines.
        ///
        /// A second paragraph is no help text.
        enum Model("model", default(Half), visitor(Visitor, Formula)) {
            /// One half.
            "half" | "1/2" => Half by Half,
            /// A product.
            "product" => Product(bend: Bend = Bend(3.0)) by bend,
        }
    }

    #[test]
    fn one_declaration_is_read_written_explained_and_dispatched() {
        struct At(f64);
        impl Visitor for At {
            type Output = f64;
            fn visit<F: Formula>(self, formula: F) -> f64 {
                formula.result(self.0)
            }
        }
        assert_eq!((Model::parse("half"), Model::parse("1/2")), (Ok(Model::Half), Ok(Model::Half)));
        assert_eq!(Model::parse("product"), Ok(Model::Product(Bend(3.0))));
        assert_eq!(Model::parse("product=5/2"), Ok(Model::Product(Bend(2.5))));
        assert_eq!(Model::parse("product=-1"), Err(Unreadable::Number("a number above 0")));
        assert_eq!(Model::parse("product=a"), Err(Unreadable::Number("a number above 0")));
        for unknown in ["halves", "", "half=1", "=1"] {
            assert_eq!(Model::parse(unknown), Err(Unreadable::Name), "{unknown}");
        }
        assert_eq!(Model::compared(), [Model::Half, Model::Product(Bend(1.0)), Model::Product(Bend(2.0))]);
        for level in Model::compared().into_iter().chain(Model::ALL) {
            assert_eq!(Model::parse(&level.to_string()), Ok(level));
        }
        assert_eq!(format!("{:<8}|{}", Model::Half, Model::ALL[1]), "half    |product=3");
        assert_eq!(Model::about(), "Formula for a test: in two lines");
        assert_eq!(Model::Half.help(), "One half");
        assert_eq!(Model::ALL[1].help(), "A product; product=C sets its constant: a number above 0 [default: 3]");
        assert_eq!((Model::DEFAULT, Model::default()), (Some(Model::Half), Model::Half));
        assert_eq!((Model::Half.dispatch(At(8.0)), Model::ALL[1].dispatch(At(8.0))), (4.0, 24.0));
    }
}
