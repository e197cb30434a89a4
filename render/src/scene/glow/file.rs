//! Files (TOML) that say which surfaces of a scene keep light and when its lamps shine.

use super::{Glow, GlowSurface, PaintTextures, Schedule, Start};
use crate::scene::{Density, Encoding, Medium, Scene, SceneError, Texture, file};
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
    /// An image that it names cannot be used.
    #[error("{}: its textures", path.display())]
    Texture {
        /// The file.
        path: PathBuf,
        /// Why.
        source: SceneError,
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenSurface {
    /// A material of the scene, or the name that several have: [`Scene::material_names`]; all that no other
    /// names where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// A preset or one of the own materials.
    pub paint: String,
    /// Images of what each place has of the paint, in the file's folder or below: of its excitation rate by
    /// each colour (linear),
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation: Option<PathBuf>,
    /// of its re-radiation rate (linear, the image's red),
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decay: Option<PathBuf>,
    /// of what it gives back (sRGB): a colour, or a grey that says how much of the paint there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<PathBuf>,
}

/// When some lamps shine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LampTimes {
    /// Which of the scene's lights, counted from 0; all that no other names where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<usize>>,
    /// Whether these are times of the environment, too, or of it alone where no lights are named.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sky: bool,
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
        let beside = |name: &Path| file::beside(path.parent().unwrap_or(Path::new("")), Path::new(""), name);
        let own = match &written.materials {
            Some(name) => materials(&beside(name).map_err(sense)?)
                .map_err(|source| GlowError::Materials { path: path.into(), source })?,
            None => Vec::new(),
        };
        let image = |name: &Option<PathBuf>, encoding: Encoding| -> Result<Option<Arc<Texture>>, GlowError> {
            let Some(name) = name else { return Ok(None) };
            let image = Texture::load_as(&beside(name).map_err(sense)?, encoding);
            let image = image.map_err(|source| GlowError::Texture { path: path.into(), source })?;
            Ok(Some(Arc::new(image)))
        };
        let textures = |surface: &WrittenSurface| -> Result<PaintTextures, GlowError> {
            Ok(PaintTextures {
                excitation: image(&surface.excitation, Encoding::Linear)?,
                decay: image(&surface.decay, Encoding::Linear)?,
                emission: image(&surface.emission, Encoding::Srgb)?,
            })
        };
        let textures = written.surfaces.iter().map(textures).collect::<Result<Vec<_>, _>>()?;
        let mut glow = written.glow(&own, moment).map_err(sense)?;
        glow.surfaces.iter_mut().zip(textures).for_each(|(surface, own)| surface.textures = own);
        Ok(glow)
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
        let mut wanted = self.surfaces.iter().filter_map(|surface| surface.material.as_ref());
        if let Some(name) = wanted.find(|name| !has(name)) {
            return Err(format!("the scene has no material `{name}`; there are {}", names.join(", ")));
        }
        let paints = self.paints_of(scene);
        let has_texture =
            |material: usize| paints[material].is_some_and(|paint| self.surfaces[paint].textures.is_any());
        let mut bare = scene.meshes.iter().filter(|mesh| mesh.uvs[0].is_empty());
        if let Some(mesh) = bare.find(|mesh| has_texture(mesh.material.0 as usize)) {
            let name = &names[mesh.material.0 as usize];
            return Err(format!(
                "the paint of `{name}` has textures, and mesh `{}` no texture coordinates",
                mesh.name
            ));
        }
        let boxed = |medium: &Arc<Medium>| !matches!(medium.density, Density::Everywhere);
        if self.medium.is_some() && !scene.medium.as_ref().is_some_and(boxed) {
            return Err("`medium` has a paint, and the scene no medium within a box".to_owned());
        }
        if self.schedule_of_sky().is_some() && scene.environment.is_none() {
            return Err("[[lamps]]: `sky` shines, and the scene has no environment".to_owned());
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
        let mut surfaces: Vec<GlowSurface> = Vec::new();
        for WrittenSurface { material, paint, .. } in self.surfaces {
            if surfaces.iter().any(|surface| surface.material == material) {
                return Err(format!(
                    "{} has two paints",
                    material.unwrap_or_else(|| "everything else".to_owned())
                ));
            }
            surfaces.push(GlowSurface::new(material.as_deref(), found(&paint)?));
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
/// If times are not in order, or a lamp or the sky is named twice; in words.
pub fn schedules(written: Vec<LampTimes>) -> Result<Vec<Schedule>, String> {
    let mut others = None;
    let mut schedules: Vec<Schedule> = Vec::new();
    for LampTimes { lights, sky, on } in written {
        let sound = on.iter().all(|[from, to]| from.is_finite() && from < to);
        if !sound || on.windows(2).any(|pair| pair[0][1] > pair[1][0]) {
            return Err(format!("lamps are on {on:?}: not from one moment to a later one, in order"));
        }
        if sky && schedules.iter().any(|schedule| schedule.sky) {
            return Err("the sky is named twice".to_owned());
        }
        let Some(lights) = lights.or_else(|| sky.then(Vec::new)) else {
            if others.replace(on).is_some() {
                return Err("all other lamps are named twice".to_owned());
            }
            continue;
        };
        let taken = |light: &&usize| schedules.iter().any(|schedule| schedule.lights.contains(light));
        if let Some(light) = lights.iter().find(taken) {
            return Err(format!("light {light} is named twice"));
        }
        schedules.push(Schedule { lights, sky, on });
    }
    let others = others.unwrap_or_else(|| vec![[0.0, f32::INFINITY]]);
    schedules.push(Schedule { on: others, ..Schedule::default() });
    Ok(schedules)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Environment, Light, Material as Look, Mesh};
    use glam::{Vec2, Vec3};
    use std::error::Error;

    fn read(text: &str) -> Result<Glow, GlowError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("glow.toml");
        std::fs::write(&path, text).expect("written");
        let own = "[[material]]\nname = 'mine'\nbands = 'rgb'\n\
                   states = [{ decay = 0.1, excitation = [0.1, 0.2, 0.3], emission = [1, 2, 3] }]";
        std::fs::write(folder.path().join("own.toml"), own).expect("written");
        let image = image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 51, 102, 204]).expect("two texels");
        image.save(folder.path().join("two.png")).expect("written");
        std::fs::write(folder.path().join("none.png"), "no image").expect("written");
        Glow::read(&path, 2.0)
    }

    const GOOD: &str = "start = 'lit'\nmaterials = 'own.toml'\n\
        [[surface]]\nmaterial = 'wall'\npaint = 'mine'\n[[surface]]\npaint = 'orange'\n\
        [[lamps]]\nlights = [0]\non = [[0, 1.5], [2, inf]]\n";

    #[test]
    fn a_file_says_what_glows_and_when_lamps_shine() {
        let glow = read(GOOD).expect("a sound file");
        assert_eq!((glow.start, glow.moment), (Start::LitForLong, 2.0));
        let excitation = glow.surfaces[0].paint.states[0].excitation;
        assert!((excitation - Vec3::new(0.1, 0.2, 0.3)).abs().max_element() < 1e-6);
        assert_eq!(glow.surfaces[1].paint.name, "orange");
        assert_eq!(
            glow.schedules[0],
            Schedule { lights: vec![0], sky: false, on: vec![[0.0, 1.5], [2.0, f32::INFINITY]] }
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
    fn the_sky_has_times_of_its_own_where_there_is_one() {
        let glow = read(&format!("{GOOD}[[lamps]]\nsky = true\non = [[1, 2]]\n")).expect("a sound file");
        assert_eq!(glow.schedule_of_sky(), Some(1));
        assert_eq!([glow.schedule_of(0), glow.schedule_of(1)], [0, 2], "other lamps have theirs");
        assert!(!glow.sky_shines_on(1.5));
        let lamp = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let materials = vec![Look::matte("wall", Vec3::ONE)];
        let mut scene = Scene { materials, lights: vec![lamp], ..Scene::default() };
        assert!(glow.check(&scene).expect_err("none").contains("no environment"));
        scene.environment = Some(Arc::new(Environment::uniform(Vec3::ONE)));
        assert_eq!(glow.check(&scene), Ok(()));
    }

    #[test]
    fn paints_have_textures_where_there_are_texture_coordinates() {
        let textured = GOOD.replace("'mine'\n", "'mine'\nexcitation = 'two.png'\nemission = './two.png'\n");
        let glow = read(&textured).expect("a sound file");
        let PaintTextures { excitation, decay, emission } = &glow.surfaces[0].textures;
        let [linear, srgb] = [excitation, emission].map(|texture| texture.as_ref().expect("an image"));
        assert_eq!((linear.encoding(), srgb.encoding()), (Encoding::Linear, Encoding::Srgb));
        assert!(decay.is_none() && linear.size() == [2, 1] && linear.texels()[1] == [51, 102, 204, 255]);
        assert!(!glow.surfaces[1].textures.is_any() && glow.has_textures());
        let lamp = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let mut mesh = Mesh {
            name: "board".to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = |mesh: &Mesh| Scene {
            meshes: vec![mesh.clone()].into(),
            materials: vec![Look::matte("wall", Vec3::ONE)],
            lights: vec![lamp],
            ..Scene::default()
        };
        let said = glow.check(&scene(&mesh)).expect_err("none");
        assert!(said.contains("paint of `wall` has textures, and mesh `board` no texture"), "{said}");
        mesh.uvs[0] = vec![Vec2::ZERO, Vec2::X, Vec2::Y];
        assert_eq!(glow.check(&scene(&mesh)), Ok(()));
        let weights = [0.25, 0.75, 0.0];
        let factors = glow.surfaces[0].textures.factors(&mesh, 0, weights).expect("textures");
        assert!((factors.excitation - Vec3::new(51.0, 102.0, 204.0) / 255.0).abs().max_element() < 1e-6);
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
            (
                "paint = 'mine'",
                "paint = 'mine'\ndecay = '../two.png'",
                "`../two.png` leads out of the folder",
            ),
            ("paint = 'mine'", "paint = 'mine'\ndecay = 'lost.png'", "lost.png"),
            ("paint = 'mine'", "paint = 'mine'\nemission = 'none.png'", "none.png: is no PNG, JPEG"),
        ] {
            let said = said(from, to);
            assert!(said.contains(expected), "{to}: {said}");
        }
        let twice = format!("{GOOD}[[lamps]]\nlights = [1, 0]\non = []\n");
        assert!(read(&twice).expect_err("twice").to_string().contains("light 0 is named twice"));
        let sky = "[[lamps]]\nsky = true\non = [[1, 2]]\n";
        let twice = read(&format!("{GOOD}{sky}{sky}")).expect_err("twice").to_string();
        assert!(twice.contains("the sky is named twice"), "{twice}");
        assert!(read("surface = []").expect_err("nothing").to_string().contains("no surface glows"));
        let lamps = read("[[lamps]]\non = [[2.0, 1.0]]").expect_err("no order");
        assert!(lamps.to_string().contains("not from one moment to a later one"), "{lamps}");
        let decaying = read("start = 0.5\n[[surface]]\npaint = 'stickers'").expect("it decays");
        assert!(decaying.surfaces[0].paint.states[0].emission.max_element() > 0.1);
    }
}
