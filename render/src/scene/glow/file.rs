//! Files (TOML) that say which surfaces of a scene keep light and when its lamps shine.

use super::{Glow, Schedule, Start};
use crate::scene::{Density, Medium, Scene, file};
use deepshade_glow::file::{FileError, MaterialFile};
use deepshade_glow::material::Material;
use deepshade_glow::paint::Paint;
use deepshade_glow::spectrum::lights::Light;
use deepshade_shaders::names::with_meant;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum GlowError {
    /// It cannot be read.
    #[error("{}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not TOML of the right form.
    #[error("{} does not say what glows: {what}", path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// Why, with the line.
        what: String,
    },
    /// A file of materials that it names cannot be used.
    #[error("{}: its materials", path.display())]
    Materials {
        /// The file.
        path: PathBuf,
        /// Why.
        source: FileError,
    },
    /// It says what makes no sense, or what the scene lacks.
    #[error("{}: {what}", path.display())]
    Sense {
        /// The file.
        path: PathBuf,
        /// What.
        what: String,
    },
}

/// What a file says, before anything is looked up.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GlowFile {
    /// How it is at first.
    #[serde(default)]
    pub start: WrittenStart,
    /// Own materials beside the presets, in the file's folder or below.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub materials: Option<PathBuf>,
    /// The spectrum of all lamps, whose colours in the scene then say how bright they are and no more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<Light>,
    /// The paint of the medium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<String>,
    /// What keeps light.
    #[serde(default, rename = "surface")]
    pub surfaces: Vec<WrittenSurface>,
    /// When lamps shine.
    #[serde(default, rename = "lamps")]
    pub lamps: Vec<LampTimes>,
}

/// How surfaces are at first.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged, expecting = "`start` is \"dark\", \"lit\" or a share from 0 to 1")]
pub enum WrittenStart {
    /// By a word.
    Named(NamedStart),
    /// A share of what can be excited.
    Share(f32),
}

/// [`WrittenStart`] by a word.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NamedStart {
    /// Nothing is excited.
    Dark,
    /// All lamps have shone for long.
    Lit,
}

/// The paint of a material.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenSurface {
    /// A material of the scene, or the name that several have: [`Scene::material_names`]; all that no other
    /// names where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// A preset or one of the own materials.
    pub paint: String,
}

/// When some lamps shine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LampTimes {
    /// Which of the scene's lights, counted from 0; all that no other names where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<usize>>,
    /// From when to when, seconds.
    pub on: Vec<[f32; 2]>,
}

impl Default for WrittenStart {
    fn default() -> Self {
        Self::Named(NamedStart::Dark)
    }
}

impl Glow {
    /// What a file says, seen at a moment, seconds. Lamps of which it says nothing shine from second 0 on.
    ///
    /// # Errors
    /// If the file, or one that it names, cannot be read or says what makes no sense.
    pub fn read(path: &Path, moment: f32) -> Result<Self, GlowError> {
        let text = file::text(path).map_err(|source| GlowError::Read { path: path.into(), source })?;
        let written: GlowFile = toml::from_str(&text)
            .map_err(|error| GlowError::Form { path: path.into(), what: with_meant(&error.to_string()) })?;
        let sense = |what| GlowError::Sense { path: path.into(), what };
        let own = match &written.materials {
            Some(name) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                materials(&file::beside(folder, Path::new(""), name).map_err(sense)?)
                    .map_err(|source| GlowError::Materials { path: path.into(), source })?
            }
            None => Vec::new(),
        };
        written.glow(&own, moment).map_err(sense)
    }

    /// Whether a scene has the materials and lamps that are named.
    ///
    /// # Errors
    /// If not; what it lacks is named, in words.
    pub fn check(&self, scene: &Scene) -> Result<(), String> {
        let names = scene.material_names();
        let has = |name: &String| {
            names.contains(name) || scene.materials.iter().any(|material| material.name == *name)
        };
        let mut wanted = self.surfaces.iter().filter_map(|(name, _)| name.as_ref());
        if let Some(name) = wanted.find(|name| !has(name)) {
            return Err(format!("the scene has no material `{name}`; there are {}", names.join(", ")));
        }
        let boxed = |medium: &Arc<Medium>| !matches!(medium.density, Density::Everywhere);
        if self.medium.is_some() && !scene.medium.as_ref().is_some_and(boxed) {
            return Err("`medium` has a paint, and the scene no medium within a box".to_owned());
        }
        let count = scene.lights.len();
        match self.schedules.iter().flat_map(|schedule| &schedule.lights).find(|light| **light >= count) {
            Some(light) => Err(format!("there is no light {light}; the scene has {count}, counted from 0")),
            None => Ok(()),
        }
    }
}

impl GlowFile {
    /// Its text, which [`Glow::read`] understands.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("tables of numbers and text")
    }

    fn glow(self, own: &[Material], moment: f32) -> Result<Glow, String> {
        if !moment.is_finite() {
            return Err(format!("{moment} s is no moment"));
        }
        let schedules = schedules(self.lamps)?;
        let start = match self.start {
            WrittenStart::Named(NamedStart::Dark) => Start::Share(0.0),
            WrittenStart::Named(NamedStart::Lit) => Start::LitForLong,
            WrittenStart::Share(share) if (0.0..=1.0).contains(&share) => Start::Share(share),
            WrittenStart::Share(share) => return Err(format!("`start` is {share}, no share from 0 to 1")),
        };
        if self.surfaces.is_empty() && self.medium.is_none() {
            return Err("no surface glows, nor a medium".to_owned());
        }
        let found = |paint: &str| found(paint, own, start, self.spectrum);
        let medium = self.medium.as_deref().map(found).transpose()?;
        let mut surfaces: Vec<(Option<String>, Paint)> = Vec::new();
        for WrittenSurface { material, paint } in self.surfaces {
            if surfaces.iter().any(|(name, _)| *name == material) {
                return Err(format!(
                    "{} has two paints",
                    material.unwrap_or_else(|| "everything else".to_owned())
                ));
            }
            surfaces.push((material, found(&paint)?));
        }
        Ok(Glow { surfaces, medium, schedules, start, moment })
    }
}

/// The materials of a file that anybody may have written.
fn materials(path: &Path) -> Result<Vec<Material>, FileError> {
    let text = file::text(path).map_err(|source| FileError::Read { path: path.into(), source })?;
    Ok(MaterialFile::parse(&text, path)?.materials)
}

/// The paint of that name under lamps of such a spectrum, own ones first.
fn found(name: &str, own: &[Material], start: Start, lamp: Option<Light>) -> Result<Paint, String> {
    let presets = MaterialFile::presets().materials;
    let material = own.iter().chain(&presets).find(|material| material.name == name).ok_or_else(|| {
        let known: Vec<&str> = own.iter().chain(&presets).map(|material| material.name.as_str()).collect();
        format!("there is no paint `{name}`; there are {}", known.join(", "))
    })?;
    if !material.excitation_is_known() && !matches!(start, Start::Share(share) if share > 0.0) {
        return Err(format!(
            "how light excites {name} was never measured: it can only decay, from a `start` that is a number"
        ));
    }
    Paint::new(material, lamp)
}

/// All schedules, that of all other lamps last.
///
/// # Errors
/// If times are not in order, or a lamp is named twice; in words.
pub fn schedules(written: Vec<LampTimes>) -> Result<Vec<Schedule>, String> {
    let mut others = None;
    let mut schedules: Vec<Schedule> = Vec::new();
    for LampTimes { lights, on } in written {
        let sound = on.iter().all(|[from, to]| from.is_finite() && from < to);
        if !sound || on.windows(2).any(|pair| pair[0][1] > pair[1][0]) {
            return Err(format!("lamps are on {on:?}: not from one moment to a later one, in order"));
        }
        let Some(lights) = lights else {
            if others.replace(on).is_some() {
                return Err("all other lamps are named twice".to_owned());
            }
            continue;
        };
        let taken = |light: &&usize| schedules.iter().any(|schedule| schedule.lights.contains(light));
        if let Some(light) = lights.iter().find(taken) {
            return Err(format!("light {light} is named twice"));
        }
        schedules.push(Schedule { lights, on });
    }
    let others = others.unwrap_or_else(|| vec![[0.0, f32::INFINITY]]);
    schedules.push(Schedule { lights: Vec::new(), on: others });
    Ok(schedules)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, Material as Look};
    use glam::Vec3;
    use std::error::Error;

    fn read(text: &str) -> Result<Glow, GlowError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("glow.toml");
        std::fs::write(&path, text).expect("written");
        let own = "[[material]]\nname = 'mine'\nbands = 'rgb'\n\
                   states = [{ decay = 0.1, excitation = [0.1, 0.2, 0.3], emission = [1, 2, 3] }]";
        std::fs::write(folder.path().join("own.toml"), own).expect("written");
        Glow::read(&path, 2.0)
    }

    const GOOD: &str = "start = 'lit'\nmaterials = 'own.toml'\n\
        [[surface]]\nmaterial = 'wall'\npaint = 'mine'\n[[surface]]\npaint = 'orange'\n\
        [[lamps]]\nlights = [0]\non = [[0, 1.5], [2, inf]]\n";

    #[test]
    fn a_file_says_what_glows_and_when_lamps_shine() {
        let glow = read(GOOD).expect("a sound file");
        assert_eq!((glow.start, glow.moment), (Start::LitForLong, 2.0));
        let excitation = glow.surfaces[0].1.states[0].excitation;
        assert!((excitation - Vec3::new(0.1, 0.2, 0.3)).abs().max_element() < 1e-6);
        assert_eq!(glow.surfaces[1].1.name, "orange");
        assert_eq!(
            glow.schedules[0],
            Schedule { lights: vec![0], on: vec![[0.0, 1.5], [2.0, f32::INFINITY]] }
        );
        assert_eq!(glow.schedules[1].on, [[0.0, f32::INFINITY]], "others shine from second 0 on");
        let lamp = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let mut scene = Scene { materials: vec![Look::matte("wall", Vec3::ONE)], ..Scene::default() };
        assert!(glow.check(&scene).expect_err("dark").contains("no light 0"));
        scene.lights.push(lamp);
        assert_eq!(glow.check(&scene), Ok(()));
        scene.materials[0].name = "floor".to_owned();
        assert!(glow.check(&scene).expect_err("none").contains("no material `wall`; there are floor"));
        scene.materials = vec![Look::matte("wall", Vec3::ONE); 2];
        assert_eq!(glow.check(&scene), Ok(()), "several are called so");
        let second = read(&GOOD.replace("'wall'", "'wall#2'")).expect("a sound file");
        assert_eq!(second.check(&scene), Ok(()));
        scene.materials.pop();
        assert!(second.check(&scene).expect_err("one").contains("no material `wall#2`; there are wall"));
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        let said = |from: &str, to: &str| {
            let error = read(&GOOD.replace(from, to)).expect_err("refused");
            let (mut said, mut cause) = (error.to_string(), error.source());
            while let Some(error) = cause {
                said = format!("{said}: {error}");
                cause = error.source();
            }
            said
        };
        for (from, to, expected) in [
            ("'lit'", "1.5", "`start` is 1.5"),
            ("'lit'", "nan", "`start` is NaN"),
            ("'lit'", "'bright'", "`start` is \"dark\", \"lit\" or a share from 0 to 1"),
            ("'orange'", "'orang'", "there is no paint `orang`; there are mine, blue"),
            ("'orange'", "'stickers'", "stickers was never measured"),
            ("material = 'wall'\n", "", "everything else has two paints"),
            ("[0, 1.5]", "[0, 2.5]", "not from one moment to a later one"),
            ("[0, 1.5]", "[1.5, 1.5]", "not from one moment to a later one"),
            ("[0, 1.5]", "[nan, 1.5]", "not from one moment to a later one"),
            ("paint = 'mine'", "pant = 'mine'", "pant"),
            ("own.toml", "none.toml", "none.toml"),
            ("own.toml", "../own.toml", "`../own.toml` leads out of the folder"),
            ("own.toml", "/dev/zero", "`/dev/zero` leads out of the folder"),
            ("own.toml", ".", "is not a plain file"),
        ] {
            let said = said(from, to);
            assert!(said.contains(expected), "{to}: {said}");
        }
        let twice = format!("{GOOD}[[lamps]]\nlights = [1, 0]\non = []\n");
        assert!(read(&twice).expect_err("twice").to_string().contains("light 0 is named twice"));
        assert!(read("surface = []").expect_err("nothing").to_string().contains("no surface glows"));
        let lamps = read("[[lamps]]\non = [[2.0, 1.0]]").expect_err("no order");
        assert!(lamps.to_string().contains("not from one moment to a later one"), "{lamps}");
        let decaying = read("start = 0.5\n[[surface]]\npaint = 'stickers'").expect("it decays");
        assert!(decaying.surfaces[0].1.states[0].emission.max_element() > 0.1);
    }
}
