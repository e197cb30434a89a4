//! What makes a recipe sound: values within limits, keys that mean something, families and scene files that
//! are for what the recipe is for.

use super::drawn::SIZE_STEP;
use super::{FamilyShare, FieldOfView, Radius, Recipe, Resolution, Sequence, Viewpoint, Views, split_name};
use crate::DatasetError;
use crate::identity::Identity;
use crate::views::dolly::FIELDS_OF_VIEW;
use deepshade_render::methods::estimate::Estimator;
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::sampler::MAX_SAMPLES;
use deepshade_render::scene::Scene;
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_shaders::Effect;
use std::path::Path;

const EDGE: std::ops::RangeInclusive<usize> = 16..=8192;
const MAX_PIXELS: usize = 1 << 25;
const MAX_PAIRS: usize = 1_000_000;
const MAX_RADIUS: f32 = 1e5;
const MAX_DIAGONAL_SHARE: f32 = 10.0;
const MAX_RADIUS_PIXELS: f32 = 8192.0;

/// Whether what `holds` says of a key is so; else that it must be within its limits.
fn between(key: &str, holds: bool, limits: &str) -> Result<(), String> {
    if holds { Ok(()) } else { Err(format!("`{key}` must be {limits}")) }
}

impl Recipe {
    /// Checks all but the scene files of a recipe that `path` holds.
    pub(crate) fn check(&self, path: &Path) -> Result<(), DatasetError> {
        let wrong = |what| DatasetError::Recipe { path: path.to_owned(), what };
        self.check_limits().and_then(|()| self.check_use()).map_err(wrong)?;
        self.check_families(path)
    }

    fn check_limits(&self) -> Result<(), String> {
        let Resolution { height, width } = self.resolution;
        let edge = format!("{} to {} pixels", EDGE.start(), EDGE.end());
        between("resolution.height", EDGE.contains(&height), &edge)?;
        between("resolution.width", EDGE.contains(&width), &edge)?;
        between("resolution", height * width <= MAX_PIXELS, &format!("at most {MAX_PIXELS} pixels in all"))?;
        let samples = format!("1 to {MAX_SAMPLES}");
        between("samples", (1..=MAX_SAMPLES).contains(&self.samples), &samples)?;
        let holds =
            (1..=SCRAMBLINGS).contains(&self.scramblings) && self.samples.is_multiple_of(self.scramblings);
        between("scramblings", holds, &format!("1 to {SCRAMBLINGS}, and a divisor of `samples`"))?;
        between("error", self.error.is_none_or(|error| error > 0.0 && error < 1.0), "above 0 and below 1")?;
        between("validation_share", (0.0..=0.5).contains(&self.validation_share), "0 to 0.5")?;
        self.check_smallest()?;
        self.check_radius()?;
        self.check_estimates()?;
        if let Some(Viewpoint { position, target }) = self.camera {
            let away = (position - target).length();
            between("camera", away.is_finite() && away > 1e-3, "two places that are finite and apart")?;
        }
        let degrees = format!("{} to {} degrees", FIELDS_OF_VIEW.start(), FIELDS_OF_VIEW.end());
        let holds = match self.field_of_view {
            None => true,
            Some(FieldOfView::Fixed(degrees)) => FIELDS_OF_VIEW.contains(&degrees),
            Some(FieldOfView::Drawn([low, high])) => {
                low <= high && [low, high].iter().all(|degrees| FIELDS_OF_VIEW.contains(degrees))
            }
        };
        between("field_of_view", holds, &degrees)?;
        if let Some(Sequence { frames, turn, step }) = self.sequence {
            let holds = (2..=1000).contains(&frames) && self.views_per_scene.is_multiple_of(frames);
            between("sequence.frames", holds, "2 to 1000, and `views_per_scene` a multiple of it")?;
            between("sequence.turn", (0.0..=10.0).contains(&turn), "0 to 10 degrees")?;
            between("sequence.step", (0.0..=0.1).contains(&step), "0 to 0.1 of the diagonal")?;
        }
        if let Some(tiles) = self.tiles {
            let whole = tiles.samples.is_multiple_of(SCRAMBLINGS);
            let holds = whole && (SCRAMBLINGS..=MAX_SAMPLES).contains(&tiles.samples);
            between("tiles.samples", holds, &format!("a multiple of {SCRAMBLINGS} up to {MAX_SAMPLES}"))?;
            between("tiles.one_in", (1..=64).contains(&tiles.one_in), "1 to 64")?;
        }
        between(
            "families",
            self.scene_count() > 0,
            "given, or `files` or `captures`, so that there is a scene",
        )?;
        let pairs = self.scene_count().saturating_mul(self.views_per_scene);
        let limits = format!("such that there are 1 to {MAX_PAIRS} views in all");
        between("views_per_scene", (1..=MAX_PAIRS).contains(&pairs), &limits)
    }

    fn check_smallest(&self) -> Result<(), String> {
        let Some(Resolution { height, width }) = self.smallest else { return Ok(()) };
        let most = self.resolution;
        let edges = [height, width, most.height, most.width];
        let holds = height >= *EDGE.start()
            && width >= *EDGE.start()
            && height <= most.height
            && width <= most.width
            && edges.iter().all(|edge| edge.is_multiple_of(SIZE_STEP));
        let limits = format!(
            "{} pixels or more and no more than `resolution`, both in multiples of {SIZE_STEP}",
            EDGE.start()
        );
        between("smallest", holds, &limits)?;
        if self.split == Split::Test {
            return Err("`smallest` is for training: frames of a test set have one size".to_owned());
        }
        Ok(())
    }

    fn check_estimates(&self) -> Result<(), String> {
        if !self.captures.is_empty() {
            // Refused with the other keys that are for scenes.
            return Ok(());
        }
        if self.split == Split::Test && !self.estimates.is_empty() {
            return Err("`estimates` is for training: whoever is measured makes its own".to_owned());
        }
        for (index, text) in self.estimates.iter().enumerate() {
            let estimator = Estimator::parse(self.effect, text);
            let estimator = estimator.map_err(|error| format!("`estimates`: {error}"))?;
            let earlier = self.estimates[..index].iter();
            let earlier = earlier.filter_map(|text| Estimator::parse(self.effect, text).ok());
            if earlier.flat_map(|other| other.makes()).any(|made| estimator.makes().contains(made)) {
                return Err(format!("`estimates`: `{text}` makes what one before it makes"));
            }
        }
        Ok(())
    }

    fn check_radius(&self) -> Result<(), String> {
        let (key, range, most) = match self.radius {
            Radius::Diagonal(share) => ("radius.diagonal", [share; 2], MAX_DIAGONAL_SHARE),
            Radius::Metres(metres) => ("radius.metres", [metres; 2], MAX_RADIUS),
            Radius::Pixels(range) => ("radius.pixels", range, MAX_RADIUS_PIXELS),
            Radius::MetresBetween(range) => ("radius.metres-between", range, MAX_RADIUS),
        };
        let holds = range[0] > 0.0 && range[0] <= range[1] && range[1] <= most;
        between(key, holds, &format!("above 0 and at most {most}"))
    }

    /// Whether no key is there that means nothing in this recipe, and none is missing that its effect needs.
    fn check_use(&self) -> Result<(), String> {
        if !self.captures.is_empty() {
            return self.check_captures();
        }
        self.vary.clone().unwrap_or_default().check(self.effect)?;
        self.check_noise()?;
        let other = [
            ("camera", self.camera.is_some()),
            ("field_of_view", self.field_of_view.is_some()),
            ("vary", self.vary.is_some() && !self.is_timeline()),
            ("views", self.views != Views::Anywhere),
            (self.drawn_key().unwrap_or_default(), self.drawn_key().is_some()),
        ];
        if self.is_timeline() && self.sequence.is_none() {
            return Err("`vary.timeline` is of the frames of a `sequence`".to_owned());
        }
        if let (Some(_), Some((key, _))) = (self.sequence, other.into_iter().find(|(_, given)| *given)) {
            let but = if key == "vary" { ", but for one with a `timeline`" } else { "" };
            return Err(format!(
                "`sequence` moves the camera through a scene as it is: without `{key}`{but}"
            ));
        }
        let draws_camera =
            self.views != Views::Anywhere || matches!(self.field_of_view, Some(FieldOfView::Drawn(_)));
        if self.camera.is_some() && draws_camera {
            return Err(
                "`camera` is that of all views: without `views` and a drawn `field_of_view`".to_owned()
            );
        }
        if self.split == Split::Test && self.validation_share > 0.0 {
            return Err(
                "`validation_share` is for training: a recipe for testing holds nothing apart".to_owned()
            );
        }
        if !self.test_recipes.is_empty() && (self.split == Split::Test || self.files.is_empty()) {
            return Err("`test_recipes` is for training recipes with `files`".to_owned());
        }
        if self.test_recipes.is_empty() && self.split == Split::Train && !self.files.is_empty() {
            return Err(
                "a training recipe with `files` must name `test_recipes` to stay away from".to_owned()
            );
        }
        Ok(())
    }

    /// Whether the noise of targets is asked for only where it is truth's, and once.
    fn check_noise(&self) -> Result<(), String> {
        let asked = [("error", self.error.is_some()), ("scramblings", self.scramblings > 1)];
        let Some((key, _)) = asked.into_iter().find(|(_, given)| *given) else { return Ok(()) };
        if self.vary.iter().any(|vary| vary.sensor.is_some()) {
            return Err(format!(
                "`{key}` is for truth, and with `vary.sensor` targets have a camera's noise"
            ));
        }
        if self.target.is_some() {
            return Err(format!(
                "`{key}` is for truth, and `target` names a method, whose images have no noise"
            ));
        }
        let has_its_own = [("`error`", self.error.is_some()), ("a test set", self.split == Split::Test)];
        match has_its_own.into_iter().find(|(_, given)| *given && self.scramblings > 1) {
            Some((what, _)) => {
                Err(format!("without `scramblings`: truth of {what} always has {SCRAMBLINGS}"))
            }
            None => Ok(()),
        }
    }

    /// Whether nothing is asked of captures that only scenes can give.
    fn check_captures(&self) -> Result<(), String> {
        let for_scenes = [
            ("families", !self.families.is_empty()),
            ("files", !self.files.is_empty()),
            ("test_recipes", !self.test_recipes.is_empty()),
            ("camera", self.camera.is_some()),
            ("sequence", self.sequence.is_some()),
            ("vary", self.vary.is_some()),
            ("target", self.target.is_some()),
            ("error", self.error.is_some()),
            ("estimates", !self.estimates.is_empty()),
            ("scramblings", self.scramblings > 1),
            ("radius.diagonal", matches!(self.radius, Radius::Diagonal(_))),
            ("views", self.views != Views::Anywhere),
            (self.drawn_key().unwrap_or_default(), self.drawn_key().is_some()),
        ];
        if let Some((key, _)) = for_scenes.into_iter().find(|(_, given)| *given) {
            return Err(format!("`{key}` is for scenes, and `captures` are none"));
        }
        if self.effect != Effect::Real {
            return Err(format!("`captures` are for effect `real`, not for `{}`", self.effect));
        }
        if self.split == Split::Test {
            return Err(
                "`captures` are for training: a test set is rendered anew by who is measured".to_owned()
            );
        }
        Ok(())
    }

    fn check_families(&self, path: &Path) -> Result<(), DatasetError> {
        for (index, FamilyShare { name, .. }) in self.families.iter().enumerate() {
            let wrong = |what: String| DatasetError::Recipe { path: path.to_owned(), what };
            let family = Family::by_name(name).map_err(|error| wrong(format!("`families`: {error}")))?;
            if self.families[..index].iter().any(|other| other.name == *name) {
                return Err(wrong(format!("`families` names `{name}` twice")));
            }
            if family.split() != self.split {
                let (own, wanted) = (split_name(family.split()), split_name(self.split));
                let what = format!("family `{name}` is for {own} only, the recipe is for {wanted}");
                return Err(DatasetError::Mixed { path: path.to_owned(), what });
            }
        }
        Ok(())
    }

    /// Whether no scene file of a training recipe is also in one of its test recipes, whose files are in
    /// `scenes` or, without it, where each of these recipes is.
    pub(super) fn check_files(&self, scenes: Option<&Path>) -> Result<(), DatasetError> {
        if self.test_recipes.is_empty() {
            return Ok(());
        }
        let own = self.file_identities()?;
        let folder = self.path.parent().unwrap_or(Path::new(""));
        for path in &self.test_recipes {
            let mut test = Self::parse(&folder.join(path))?;
            if let Some(scenes) = scenes {
                scenes.clone_into(&mut test.folder);
            }
            if test.split != Split::Test {
                let what = format!("`test_recipes`: {} is not for testing", path.display());
                return Err(DatasetError::Recipe { path: self.path.clone(), what });
            }
            let theirs = test.file_identities()?;
            for (file, identity) in self.files.iter().zip(&own) {
                if theirs.iter().any(|other| identity.same(other)) {
                    let what = format!("the scene in {} is also in {}", file.display(), path.display());
                    return Err(DatasetError::Mixed { path: self.path.clone(), what });
                }
            }
        }
        Ok(())
    }

    /// What the scenes in `files` are; no two of them the same to the last bit.
    pub(crate) fn file_identities(&self) -> Result<Vec<Identity>, DatasetError> {
        let mut identities: Vec<Identity> = Vec::new();
        for (index, file) in self.files.iter().enumerate() {
            let identity = Identity::of(&Scene::load(&self.folder.join(file), 0.0)?);
            if let Some(twin) = identities.iter().position(|earlier| earlier.hash == identity.hash) {
                let [first, second] = [twin, index].map(|index| self.files[index].display().to_string());
                let what = format!("`files`: {first} and {second} hold the same scene");
                return Err(DatasetError::Recipe { path: self.path.clone(), what });
            }
            identities.push(identity);
        }
        Ok(identities)
    }
}
