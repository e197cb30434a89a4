//! Which keys of the table `vary` an effect needs, which it may have, and their limits.

use super::{FogRange, Surroundings, Textures, Timeline, Vary};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::Definition;

/// Most procedural textures, which all stay in memory.
const MOST_TEXTURES: usize = 512;
/// Most skies, which all stay in memory.
const MOST_SKIES: usize = 256;

impl Vary {
    /// Whether the table has what the effect needs, nothing that means nothing for it, and no absurd value.
    pub(crate) fn check(&self, effect: Effect) -> Result<(), String> {
        let given = [
            ("materials", self.materials),
            ("textures", self.textures.is_some()),
            ("light", self.light),
            ("environment", self.environment.is_some()),
            ("lens", self.lens.is_some()),
            ("motion", self.motion.is_some()),
            ("mean_free_path", self.mean_free_path.is_some()),
            ("fog", self.fog.is_some()),
            ("timeline", self.timeline.is_some()),
            ("sensor", self.sensor.is_some()),
        ];
        let Definition { needs, varies, .. } = effect.definition();
        for (key, is_given) in given {
            if *needs == Some(key) && !is_given {
                return Err(format!("effect `{effect}` needs the key `vary.{key}`"));
            }
            if is_given && *needs != Some(key) && !varies.contains(&key) {
                return Err(format!("`vary.{key}` means nothing for effect `{effect}`"));
            }
        }
        // What moves says what light was kept, where there is a past.
        let of_a_past = *needs != Some("motion");
        if of_a_past && self.motion.is_some() && self.timeline.is_none() {
            return Err(format!("`vary.motion` means nothing for effect `{effect}` without `vary.timeline`"));
        }
        if self.environment_share.is_some() && (self.environment.is_none() || *needs == Some("environment")) {
            let without = "without `vary.environment`, or of an effect that needs one";
            return Err(format!("`vary.environment_share` means nothing {without}"));
        }
        self.check_limits()
    }

    fn check_limits(&self) -> Result<(), String> {
        if let Some(Textures::Procedural(count)) = self.textures
            && !(1..=MOST_TEXTURES).contains(&count)
        {
            return Err(format!("`vary.textures.procedural` must be 1 to {MOST_TEXTURES}"));
        }
        if let Some(Surroundings::Skies(count)) = self.environment
            && !(2..=MOST_SKIES).contains(&count)
        {
            return Err(format!("`vary.environment.skies` must be 2 to {MOST_SKIES}"));
        }
        if !self.environment_share.is_none_or(|share| (0.0..=1.0).contains(&share)) {
            return Err("`vary.environment_share` must be 0 to 1".to_owned());
        }
        let FogRange { optical_depth, smoke_share } =
            self.fog.unwrap_or(FogRange { optical_depth: [1.0; 2], smoke_share: 0.0 });
        if !(0.0..=1.0).contains(&smoke_share) {
            return Err("`vary.fog.smoke_share` must be 0 to 1".to_owned());
        }
        self.timeline.iter().try_for_each(Timeline::check)?;
        range("lens", self.lens, 0.01, 256.0)?;
        range("motion", self.motion, 0.01, 256.0)?;
        range("mean_free_path", self.mean_free_path, 1e-5, 1.0)?;
        range("fog.optical_depth", Some(optical_depth), 0.01, 100.0)
    }
}

/// Whether a range is one, within limits.
fn range(key: &str, range: Option<[f32; 2]>, least: f32, most: f32) -> Result<(), String> {
    let sound = |[low, high]: [f32; 2]| low >= least && low <= high && high <= most;
    if range.is_none_or(sound) {
        return Ok(());
    }
    Err(format!("`vary.{key}` must be two numbers from {least} to {most}, the smaller one first"))
}
