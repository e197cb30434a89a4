//! What a command line gives a scene: an environment, a lens, a medium, a mean free path.

use super::listeners;
use anyhow::{Context, Result, ensure};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::medium::{DensityFile, LARGEST_COEFFICIENT};
use deepshade_render::scene::{Bounds, Density, Glow, Medium, Scene};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use glam::Vec3;
use std::path::PathBuf;

/// Share of the extinction that is scattering, where none is stated.
const ALBEDO: Vec3 = Vec3::splat(0.9);
/// How far fog reaches beyond the scene's box, as a share of the diagonal.
const FOG_MARGIN: f32 = 0.1;

/// What a scene is given beside what its file brings.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "Light, lens, fog and skin")]
pub struct Additions {
    /// An environment map (.hdr, .exr) around the scene.
    #[arg(long)]
    pub environment: Option<PathBuf>,
    /// Radius of the lens, metres.
    #[arg(long, value_parser = crate::arguments::positive)]
    pub aperture: Option<f32>,
    /// Depth that the lens focuses, metres; by default that of what is in the middle of the picture.
    #[arg(long, value_parser = crate::arguments::positive)]
    pub focus: Option<f32>,
    /// Densities of a medium: a Mitsuba volume (.vol), or a description (.toml) of an array of numbers (.npy,
    /// raw) or of clouds, smoke or a fog bank, which drift and change with --time.
    #[arg(long)]
    pub medium: Option<PathBuf>,
    /// Extinction where the medium's density is 1, per metre: one number, or red,green,blue. Without --medium
    /// it is that of fog all over the scene.
    #[arg(long, value_parser = colour)]
    pub extinction: Option<Vec3>,
    /// Share of the extinction that is scattering, the rest being absorption: one number, or red,green,blue;
    /// 0.9 by default.
    #[arg(long, value_parser = colour)]
    pub scattering_albedo: Option<Vec3>,
    /// Mean cosine of the angle by which the medium scatters (Henyey-Greenstein), from -0.99 to 0.99; 0 by
    /// default.
    #[arg(long)]
    pub anisotropy: Option<f32>,
    /// How far light goes within every material before it is scattered or absorbed, metres: one number, or
    /// red,green,blue. By default what the scene's materials say, and where none says anything 6, 4 and 3
    /// pixels (at 512 rows) of what is in the middle of the picture.
    #[arg(long, value_parser = colour)]
    pub mean_free_path: Option<Vec3>,
    /// What glows: a file (.toml) that says which materials keep light, and when lamps shine; the book's
    /// chapter on phosphorescent materials has one. By default all surfaces do, as the preset blue, after a
    /// second of light that ends at second 0. --time is the moment that is seen. For daylight: `[[lamps]]
    /// sky = true`, `on = [[0.0, 60.0]]`, and --environment.
    #[arg(long)]
    pub phosphor: Option<PathBuf>,
}

impl Additions {
    /// Whether all that is given means something to an effect.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self, effect: Effect) -> Result<()> {
        self.check_any(&[effect])
    }

    /// Whether all that is given means something to one at least of some effects.
    ///
    /// # Errors
    /// If not.
    pub fn check_any(&self, effects: &[Effect]) -> Result<()> {
        let environment = [("--environment", self.environment.is_some())];
        let lens = [("--aperture", self.aperture.is_some()), ("--focus", self.focus.is_some())];
        let medium = [("--medium", self.medium.is_some()), ("--extinction", self.extinction.is_some())];
        let inside = [("--mean-free-path", self.mean_free_path.is_some())];
        let phosphor = [("--phosphor", self.phosphor.is_some())];
        listeners::check_any(effects, EffectSetting::Phosphor, &phosphor)?;
        listeners::check_any(effects, EffectSetting::MeanFreePath, &inside)?;
        listeners::check_any(effects, EffectSetting::Environment, &environment)?;
        listeners::check_any(effects, EffectSetting::Lens, &lens)?;
        listeners::check_any(effects, EffectSetting::Medium, &medium)?;
        listeners::check_any(effects, EffectSetting::Medium, &self.of_a_medium())
    }

    /// What of this means something to an effect.
    #[must_use]
    pub fn heard_by(&self, effect: Effect) -> Self {
        let [inside, around, lens, medium] = [
            EffectSetting::MeanFreePath,
            EffectSetting::Environment,
            EffectSetting::Lens,
            EffectSetting::Medium,
        ]
        .map(|setting| effect.listens_to(setting));
        Self {
            environment: self.environment.clone().filter(|_| around),
            aperture: self.aperture.filter(|_| lens),
            focus: self.focus.filter(|_| lens),
            medium: self.medium.clone().filter(|_| medium),
            extinction: self.extinction.filter(|_| medium),
            scattering_albedo: self.scattering_albedo.filter(|_| medium),
            anisotropy: self.anisotropy.filter(|_| medium),
            mean_free_path: self.mean_free_path.filter(|_| inside),
            phosphor: self.phosphor.clone().filter(|_| effect.listens_to(EffectSetting::Phosphor)),
        }
    }

    /// The options that say more of a medium, each with whether it is given.
    pub const fn of_a_medium(&self) -> [(&'static str, bool); 2] {
        [
            ("--scattering-albedo", self.scattering_albedo.is_some()),
            ("--anisotropy", self.anisotropy.is_some()),
        ]
    }

    /// The medium that is stated, if one is, at a time, seconds.
    ///
    /// # Errors
    /// If its file cannot be read, or a coefficient is impossible.
    pub fn medium(&self, scene: &TracedScene, time: f32) -> Result<Option<Medium>> {
        let density = match &self.medium {
            Some(path) => Density::Grid(DensityFile::read(path)?.grid(scene.bounds(), time)?),
            None if self.extinction.is_some() => Density::Within(around(scene)),
            None => return Ok(None),
        };
        let extinction = self.extinction.context("--medium needs --extinction, that of density 1")?;
        self.of_density(extinction, density).map(Some)
    }

    /// Fog all over a scene, of optical depth 1 along its diagonal.
    ///
    /// # Errors
    /// If a coefficient is impossible.
    pub fn fog(&self, scene: &TracedScene) -> Result<Medium> {
        self.of_density(Vec3::splat(1.0 / scene.diagonal()), Density::Within(around(scene)))
    }

    /// The medium that is stated, for the record.
    pub fn medium_in_words(&self) -> String {
        let path = self.medium.as_ref().map_or("none".to_owned(), |path| path.display().to_string());
        let extinction =
            self.extinction.map_or("as the scene's".to_owned(), |extinction| extinction.to_string());
        format!(
            "{path}; extinction {extinction}, albedo {}, anisotropy {}",
            self.albedo(),
            self.mean_cosine()
        )
    }

    /// What of a scene glows, at a time, seconds; whether that is said.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn glow(&self, scene: &Scene, time: f32) -> Result<(Glow, bool)> {
        let Some(path) = &self.phosphor else {
            return Ok((Glow { moment: time, ..Glow::of(scene).clone() }, scene.glow.is_some()));
        };
        Ok((Glow::read(path, time)?, true))
    }

    /// Whether a scene has what its glow names, and an effect shows it as that says at a time, seconds.
    ///
    /// # Errors
    /// If not.
    pub fn check_glow(&self, effect: Effect, scene: &Scene, time: f32) -> Result<()> {
        let (Some(path), Some(glow)) = (&self.phosphor, scene.glow.as_deref()) else { return Ok(()) };
        glow.check(scene).map_err(anyhow::Error::msg).with_context(|| path.display().to_string())?;
        // Its methods see the environment at every moment.
        ensure!(
            effect.is_lit_by_lamps_alone() || glow.sky_shines_on(time),
            "{}: {effect} always shows the sky, which is off at second {time} or later; its last time \
             must begin before that and end with inf",
            path.display()
        );
        Ok(())
    }

    fn albedo(&self) -> Vec3 {
        self.scattering_albedo.unwrap_or(ALBEDO)
    }

    fn mean_cosine(&self) -> f32 {
        self.anisotropy.unwrap_or(0.0)
    }

    fn of_density(&self, extinction: Vec3, density: Density) -> Result<Medium> {
        let albedo = self.albedo();
        ensure!(
            albedo.max_element() <= 1.0,
            "--scattering-albedo {albedo}: more than all cannot be scattered"
        );
        ensure!(
            extinction.max_element() <= LARGEST_COEFFICIENT,
            "--extinction {extinction}: at most {LARGEST_COEFFICIENT:e} per metre"
        );
        Ok(Medium::new((1.0 - albedo) * extinction, albedo * extinction, self.mean_cosine(), density)?)
    }
}

/// A scene's box and a little around it.
fn around(scene: &TracedScene) -> Bounds {
    let margin = Vec3::splat(FOG_MARGIN * scene.diagonal());
    let Bounds { min, max } = scene.bounds();
    Bounds { min: min - margin, max: max + margin }
}

/// Reads one number for all colours, or three.
fn colour(text: &str) -> Result<Vec3, String> {
    let number =
        |text: &str| text.trim().parse::<f32>().ok().filter(|value| value.is_finite() && *value >= 0.0);
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some([all]) => Ok(Vec3::splat(*all)),
        Some([red, green, blue]) => Ok(Vec3::new(*red, *green, *blue)),
        _ => Err(format!("`{text}` is neither a number nor red,green,blue, none of them negative")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_one_number_or_three() {
        assert_eq!(colour("0.5"), Ok(Vec3::splat(0.5)));
        assert_eq!(colour("1, 0.5,0"), Ok(Vec3::new(1.0, 0.5, 0.0)));
        for wrong in ["", "1,2", "-1", "nan", "1,2,x", "inf"] {
            assert!(colour(wrong).is_err(), "{wrong}");
        }
    }
}
