//! Options of a model by itself, for every command that reads a scene.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::DVec3;

use crate::load::{ModelLight, Surface, Up, colour};
use crate::scene::Rgb;

const HEADING: &str = "A model by itself";

/// Axis that points up, as typed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum UpArg {
    Y,
    Z,
}

impl From<UpArg> for Up {
    fn from(up: UpArg) -> Self {
        match up {
            UpArg::Y => Self::Y,
            UpArg::Z => Self::Z,
        }
    }
}

/// Options of the scene around a model.
#[derive(Clone, Debug, Args)]
pub(in crate::cli) struct ModelArgs {
    /// Axis of the model that points up [default: y]
    #[arg(long, value_enum, help_heading = HEADING)]
    pub up: Option<UpArg>,

    /// Shade smoothly where faces without normals bend by less than ANGLE degrees [default: by smoothing groups]
    #[arg(long, value_name = "ANGLE", value_parser = crease, help_heading = HEADING)]
    pub smooth: Option<f64>,

    /// Position of the camera [default: where all is seen]
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true, help_heading = HEADING)]
    pub eye: Option<DVec3>,

    /// Point in the middle of the picture [default: the middle of the model]
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true, help_heading = HEADING)]
    pub target: Option<DVec3>,

    /// Full vertical angle of view in degrees [default: 40]
    #[arg(long, value_name = "DEGREES", value_parser = fov, help_heading = HEADING)]
    pub fov: Option<f64>,

    /// Give a material of the model another surface: glass:bk7, thin:1.5, metal:gold, mirror, diffuse:#rrggbb, emissive:1,1,1;
    /// `default` is the one of faces without a material, `*` all of them
    #[arg(long, value_name = "NAME=SURFACE", value_parser = material, help_heading = HEADING)]
    pub material: Vec<(String, Surface)>,

    /// Colour of the surroundings: #rrggbb, or linear as 0.8,0.2,0.1 [default: a sky]
    #[arg(long, value_name = "COLOUR", value_parser = colour, conflicts_with = "environment", help_heading = HEADING)]
    pub background: Option<Rgb>,

    /// Equirectangular picture of the surroundings
    #[arg(long, value_name = "FILE", help_heading = HEADING)]
    pub environment: Option<PathBuf>,

    /// Put a light there, in place of the usual ones; an intensity of 1 shows a facing white surface as white
    #[arg(long, value_name = "X,Y,Z[,INTENSITY]", value_parser = light, allow_hyphen_values = true, help_heading = HEADING)]
    pub light: Vec<ModelLight>,

    /// Folder outside that of the scene or model whose files may be read; may be given several times
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    pub allow_outside: Vec<PathBuf>,
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|n| n.trim().parse::<f64>().ok().filter(|x| x.abs() <= 1e18))
        .collect::<Option<_>>()
        .ok_or_else(|| String::from("not finite numbers with commas between"))
}

fn place(text: &str) -> Result<DVec3, String> {
    match numbers(text)?.as_slice() {
        [x, y, z] => Ok(DVec3::new(*x, *y, *z)),
        _ => Err(String::from("not three numbers; write x,y,z")),
    }
}

fn light(text: &str) -> Result<ModelLight, String> {
    let (position, intensity) = match numbers(text)?.as_slice() {
        [x, y, z] => (DVec3::new(*x, *y, *z), 1.0),
        [x, y, z, intensity] if *intensity >= 0.0 && *intensity <= 1e6 => (DVec3::new(*x, *y, *z), *intensity as f32),
        _ => {
            return Err(String::from(
                "not three numbers, and an intensity from 0 to 1e6; write x,y,z or x,y,z,intensity",
            ));
        }
    };
    Ok(ModelLight { position, intensity })
}

fn between(text: &str, [above, to]: [f64; 2]) -> Result<f64, String> {
    match numbers(text)?.as_slice() {
        [x] if *x > above && *x <= to => Ok(*x),
        _ => Err(format!("not a number above {above} and up to {to}")),
    }
}

fn crease(text: &str) -> Result<f64, String> {
    between(text, [0.0, 180.0])
}

fn fov(text: &str) -> Result<f64, String> {
    between(text, [0.0, 179.0])
}

fn material(text: &str) -> Result<(String, Surface), String> {
    // A name may hold `=`, a surface does not.
    match text.rsplit_once('=') {
        Some((name, surface)) if !name.is_empty() => Ok((name.to_owned(), surface.parse()?)),
        _ => Err(String::from("no `NAME=SURFACE`, such as `body=glass:bk7`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lights_and_materials_are_read_or_told() {
        assert_eq!(place("-1, 2,3e1"), Ok(DVec3::new(-1.0, 2.0, 30.0)));
        assert_eq!(light("0,1,2").unwrap().intensity, 1.0);
        assert_eq!(light("0,1,2,0.5").unwrap().intensity, 0.5);
        assert_eq!(material("a=b=metal:gold"), Ok((String::from("a=b"), Surface::Metal("gold"))));
        assert!(place("1,2").is_err() && place("nan,0,0").is_err() && light("1,2,3,-1").is_err());
        assert!(material("gold").is_err() && material("=mirror").is_err() && material("a=wood").is_err());
        assert_eq!((crease("180"), fov("40")), (Ok(180.0), Ok(40.0)));
        assert!(crease("0").is_err() && fov("180").is_err());
    }
}
