//! Scenes that the command line puts into another one: a character into a hall.

use crate::arguments::{place, within};
use deepshade_render::scene::{SceneError, SceneSource};
use glam::{Mat4, Quat, Vec3};
use serde::{Deserialize, Serialize};
use std::fmt::{Display, Formatter};
use std::str::FromStr;

/// A scene that is put into another one, written like `fox.gltf@0,0,1.5,0.02,90`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Prop {
    /// The scene.
    pub source: SceneSource,
    /// Where its origin comes to be, metres.
    origin: Vec3,
    scale: f32,
    /// Degrees about the world's y axis.
    turn: f32,
}

/// What is put into a scene.
#[derive(clap::Args, Clone, Debug, Default, PartialEq)]
pub struct Args {
    /// Puts another scene into this one: SCENE@X,Y,Z,SCALE,DEGREES, metres and degrees about the upward axis,
    /// of which the last one or two may be left out. May be given several times.
    #[arg(long, allow_hyphen_values = true)]
    put: Vec<Prop>,
}

impl Args {
    /// These.
    pub const fn new(put: Vec<Prop>) -> Self {
        Self { put }
    }

    /// Everything that is put into the scene.
    pub fn all(&self) -> &[Prop] {
        &self.put
    }
}

/// All of them, for the record.
impl Display for Args {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let all: Vec<String> = self.put.iter().map(ToString::to_string).collect();
        write!(f, "{}", if all.is_empty() { "nothing".to_owned() } else { all.join("; ") })
    }
}

impl Prop {
    /// Where it is put, how large and how turned.
    pub fn place(&self) -> Mat4 {
        let turn = Quat::from_rotation_y(self.turn.to_radians());
        Mat4::from_scale_rotation_translation(Vec3::splat(self.scale), turn, self.origin)
    }
}

impl FromStr for Prop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const FORM: &str = "expected SCENE@X,Y,Z[,SCALE[,DEGREES]], such as fox.gltf@0,0,1.5,0.02,90";
        let (source, numbers) = text.rsplit_once('@').ok_or(FORM)?;
        let numbers: Vec<&str> = numbers.split(',').map(str::trim).collect();
        let (origin, more) = numbers.split_at_checked(3).ok_or(FORM)?;
        let (scale, turn) = match more {
            [] => ("1", "0"),
            [scale] => (*scale, "0"),
            [scale, degrees] => (*scale, *degrees),
            _ => return Err(FORM.to_owned()),
        };
        Ok(Self {
            source: source.parse().map_err(|error: SceneError| error.to_string())?,
            origin: place(&origin.join(","))?,
            scale: within(1e-6..=1e6)(scale).map_err(|what| format!("scale {what}"))?,
            turn: within(-360.0..=360.0)(turn).map_err(|what| format!("degrees {what}"))?,
        })
    }
}

impl TryFrom<String> for Prop {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Prop> for String {
    fn from(prop: Prop) -> Self {
        prop.to_string()
    }
}

impl Display for Prop {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Vec3 { x, y, z } = self.origin;
        write!(f, "{}@{x},{y},{z},{},{}", self.source, self.scale, self.turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn props_say_where_they_stand() {
        let prop: Prop = "a@b/fox.gltf@0,-1,1.5,0.02,90".parse().expect("a prop");
        assert_eq!(prop.source, "a@b/fox.gltf".parse().expect("a file"));
        // Turned to the left, what is to the right looks away from the camera.
        let corner = prop.place().transform_point3(Vec3::X);
        assert!(corner.distance(Vec3::new(0.0, -1.0, 1.48)) < 1e-6, "{corner}");
        assert_eq!(prop.to_string(), "a@b/fox.gltf@0,-1,1.5,0.02,90");
        assert!("stairs:7@0,0,0".parse::<Prop>().is_ok());
        for (wrong, said) in [
            ("fox.gltf", "expected"),
            ("fox.gltf@1,2", "expected"),
            ("fox.gltf@1,2,3,4,5,6", "expected"),
            ("fox.gltf@1,2,x", "`x` is not a number"),
            ("fox.gltf@1,2,1e9", "not within"),
            ("fox.gltf@1,2,3,0", "scale 0 is not within"),
            ("fox.gltf@1,2,3,1,1e9", "degrees"),
            ("fox@1,2,3", "neither a scene file"),
        ] {
            let error = wrong.parse::<Prop>().expect_err("no prop");
            assert!(error.contains(said), "{wrong}: {error}");
        }
    }
}
