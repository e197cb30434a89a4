//! A design as files: what is wanted, as `phosphor design` reads it, and what was found, as it writes it.

use crate::complete::LAMP_ADDED;
use crate::figures::write_atomically;
use crate::phosphor::design::task::{Task, WantedKey, WantedPlace};
use crate::view::window::Window;
use crate::views::Viewpoint;
use anyhow::Result;
use deepshade_glow::file::MaterialFile;
use deepshade_glow::material::Material;
use deepshade_glow::paint::Paint;
use deepshade_glow::spectrum::Bands;
use deepshade_phosphor::wish::{FRAMES, KeyFrame, Wish};
use deepshade_render::scene::glow::Schedule;
use deepshade_render::scene::glow::file::{GlowFile, LampTimes, WrittenSurface};
use deepshade_render::scene::{Glow, SceneSource};
use std::path::{Path, PathBuf, absolute};

/// What is wanted.
pub const WANTED: &str = "wanted.toml";
/// What was found.
pub const GLOW: &str = "glow.toml";
/// And its materials.
const MATERIALS: &str = "materials.toml";

/// The texts of the files.
pub struct Written {
    wanted: String,
    glow: String,
    materials: String,
}

impl Written {
    /// What is designed now, once there is something.
    pub fn of(window: &Window) -> Option<Self> {
        let (design, show) = (&window.design, &window.state.show);
        let (place, wish, glow) = (design.place.as_ref()?, design.wish.as_ref()?, window.glow()?);
        let camera = window.state.controller?.camera;
        let target = camera.position - camera.rotation.z_axis * camera.position.length().max(1.0);
        let task = Task {
            scene: anywhere(&show.source),
            states: design.states,
            bands: Bands::Rgb,
            frames: FRAMES,
            fps: wish.light().dt().recip() as f32,
            reflected: design.reflected,
            spectrum: design.spectrum,
            lamps: lamps(glow),
            places: vec![WantedPlace { at: place.at, keys: keys(wish) }],
            spread: None,
            view: Viewpoint::looking(camera.position, target),
        };
        let (file, materials) = glow_files(glow);
        let wanted = format!("{}{}", head(window), task.text());
        Some(Self { wanted, glow: file.text(), materials: materials.text() })
    }

    /// Writes them into a folder, which is made.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        // What names another file comes after it.
        for (name, text) in [(WANTED, &self.wanted), (MATERIALS, &self.materials), (GLOW, &self.glow)] {
            write_atomically(&folder.join(name), text.as_bytes())?;
        }
        Ok(())
    }
}

/// What of the window the file of a wish cannot say.
fn head(window: &Window) -> String {
    let mut lines = vec!["What a window was asked for; time begins at second 0.".to_owned()];
    let Some(subject) = &window.results.subject else { return String::new() };
    if window.state.lights.as_ref().is_some_and(|lights| *lights != subject.animated.scene.lights) {
        lines.push("Lights are where the scene has them, not where they were dragged to.".to_owned());
    }
    if !window.state.args.props.all().is_empty() {
        lines.push("What --put added is left out.".to_owned());
    }
    lines.extend(subject.added.iter().filter(|line| line.starts_with(LAMP_ADDED)).cloned());
    lines.iter().map(|line| format!("# {line}\n")).collect()
}

/// A scene as it is found from any folder.
fn anywhere(source: &SceneSource) -> SceneSource {
    match source {
        SceneSource::File(file) => SceneSource::File(absolute(file).unwrap_or_else(|_| file.clone())),
        other => other.clone(),
    }
}

/// Keys by seconds from the beginning on.
fn keys(wish: &Wish) -> Vec<WantedKey> {
    let time = |key: &KeyFrame| (key.frame as f64 * wish.light().dt()) as f32;
    let key = |key: &KeyFrame| WantedKey { time: time(key), colour: key.radiance().to_vec() };
    wish.keys().iter().map(key).collect()
}

/// When lamps shine, from the beginning on.
fn lamps(glow: &Glow) -> Vec<LampTimes> {
    let begin = glow.begin();
    let times = |schedule: &Schedule| LampTimes {
        lights: (!schedule.lights.is_empty()).then(|| schedule.lights.clone()),
        sky: schedule.sky,
        on: schedule.on.iter().map(|times| times.map(|at| at - begin)).collect(),
    };
    glow.schedules.iter().map(times).collect()
}

/// What glows, its beginning at second 0, and the materials that it names: in RGB, under any lamp.
fn glow_files(glow: &Glow) -> (GlowFile, MaterialFile) {
    let mut materials: Vec<Material> = Vec::new();
    let mut named = |paint: &Paint| {
        // Paints of the same name may differ: of what a file has, one was designed.
        let names = (1..).map(|number: u32| match number {
            1 => paint.name.clone(),
            number => format!("{}, {number}", paint.name),
        });
        let mut own = names.map(|name| Material { name, ..paint.material() });
        let is_free = |own: &Material| materials.iter().all(|known| known.name != own.name || known == own);
        let own = own.find(is_free).expect("numbers without an end");
        let name = own.name.clone();
        if !materials.contains(&own) {
            materials.push(own);
        }
        name
    };
    let surfaces = glow.surfaces.iter();
    let surfaces = surfaces.map(|surface| WrittenSurface {
        material: surface.material.clone(),
        paint: named(&surface.paint),
        ..WrittenSurface::default()
    });
    let (surfaces, medium) = (surfaces.collect(), glow.medium.as_ref().map(&mut named));
    let file = GlowFile {
        materials: Some(PathBuf::from(MATERIALS)),
        medium,
        surfaces,
        lamps: lamps(glow),
        ..GlowFile::default()
    };
    (file, MaterialFile { materials, fragments: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::Scene;
    use deepshade_render::scene::glow::GlowSurface;

    #[test]
    fn what_glows_is_read_again_as_it_is_written() {
        let scene = Scene::default();
        let mut glow = Glow::of(&scene).clone();
        glow.surfaces.insert(0, GlowSurface::new(Some("wall"), glow.surfaces[0].paint.clone()));
        glow.surfaces[0].paint.name = "wall, designed".to_owned();
        glow.surfaces[0].paint.states[0].decay = 0.25;
        let folder = tempfile::tempdir().expect("a folder");
        let (file, materials) = glow_files(&glow);
        let written = Written { wanted: String::new(), glow: file.text(), materials: materials.text() };
        written.write(folder.path()).expect("written");
        let again = Glow::read(&folder.path().join(GLOW), 0.0).expect("read");
        assert_eq!(again.schedules[0].on, [[0.0, 1.0]], "time begins at second 0");
        let names = |glow: &Glow| -> Vec<_> {
            glow.surfaces.iter().map(|surface| surface.material.clone()).collect()
        };
        assert_eq!(names(&again), names(&glow));
        let states = |glow: &Glow| glow.surfaces[0].paint.states[0];
        let (found, own) = (states(&again), states(&glow));
        assert_eq!((found.decay, found.excitation), (own.decay, own.excitation));
        assert!((found.emission - own.emission).abs().max_element() <= 1e-6 * own.emission.max_element());
        // Another one of the same name stays another one.
        glow.surfaces.push(GlowSurface::new(Some("floor"), glow.surfaces[0].paint.clone()));
        glow.surfaces[0].paint.states[0].decay = 0.125;
        let (file, materials) = glow_files(&glow);
        let written = Written { wanted: String::new(), glow: file.text(), materials: materials.text() };
        written.write(folder.path()).expect("written");
        let again = Glow::read(&folder.path().join(GLOW), 0.0).expect("read");
        assert_eq!([0, 2].map(|index| again.surfaces[index].paint.states[0].decay), [0.125, 0.25]);
        assert!(written.write(&folder.path().join(GLOW).join("deep")).is_err(), "the error is told");
    }
}
