//! What an evaluation has come to: scores of all test sets together and of each, the network against its
//! strongest rival, and the scenes in which it is worse than doing nothing.

use super::names::of_set;
use super::paired::Pair;
use super::rivals::Rival;
use super::score::Evaluation;
use super::sets::ARTISTS;
use crate::figures::Figures;
use crate::methods::LEARNED;
use crate::statistics::MeanInterval;
use deepshade_render::methods::Quality;
use deepshade_shaders::Effect;
use serde_json::{Map, Value, json};

/// Scores of a test set.
pub struct Scored {
    /// Its name in figures; empty of one that has none of its own.
    pub name: String,
    /// Its name in words.
    pub title: String,
    /// The scores.
    pub evaluation: Evaluation,
}

/// What an evaluation has come to.
pub struct EvaluationOutcome {
    /// Who was evaluated.
    pub rivals: Vec<Rival>,
    /// All sets together, but for [`ARTISTS`] where it is not the only one.
    pub evaluation: Evaluation,
    /// Each set by itself; at least one.
    pub sets: Vec<Scored>,
}

/// A network against its strongest rival on a test set, or on all.
pub struct NetworkComparison<'a> {
    /// Which.
    pub title: &'a str,
    /// What figures of it end with; none of a set without a name of its own.
    pub suffix: Option<String>,
    /// The two.
    pub pair: Pair<'a>,
}

impl EvaluationOutcome {
    /// Puts sets together.
    pub fn new(rivals: Vec<Rival>, mut sets: Vec<Scored>) -> Self {
        let only = sets.iter().all(|set| set.name == ARTISTS);
        let counted = sets.iter_mut().filter(|set| only || set.name != ARTISTS);
        let evaluation = Evaluation::together(counted.map(|set| &mut set.evaluation));
        Self { rivals, evaluation, sets }
    }

    /// Whether sets have figures of their own, beside those of all.
    pub fn is_divided(&self) -> bool {
        self.sets.len() > 1 || self.sets.iter().any(|set| !set.name.is_empty())
    }

    /// The network against its strongest rival, set by set, and then on all; nothing without a network.
    pub fn pairs(&self) -> Vec<NetworkComparison<'_>> {
        let of = |title, suffix, evaluation: &Evaluation| {
            Some(NetworkComparison { title, suffix, pair: Pair::new(evaluation, &self.rivals)? })
        };
        let divided = self.is_divided();
        let each = self.sets.iter().filter(|_| divided).filter_map(|set| {
            let suffix = (!set.name.is_empty()).then(|| format!("_{}", set.name));
            of(set.title.as_str(), suffix, &set.evaluation)
        });
        let title = if divided { "all" } else { self.sets.first().map_or("", |set| set.title.as_str()) };
        each.chain(of(title, Some(String::new()), &self.evaluation)).collect()
    }

    /// Scenes in which the network is worse than the image of whoever does nothing, set by set; none without
    /// a network.
    pub fn below_trivial(&self, effect: Effect) -> Option<Vec<String>> {
        let [own, trivial] =
            [LEARNED, effect.definition().doing_nothing.name()].map(|name| format!("ssim_{name}"));
        let is_there = self.sets.iter().any(|set| !set.evaluation.values(&own).is_empty());
        let divided = self.is_divided();
        let below = self.sets.iter().flat_map(|set| {
            let scenes = set.evaluation.scenes_below(&own, &trivial).into_iter();
            scenes.map(move |scene| match divided {
                true => format!("{scene} ({})", set.title),
                false => scene.to_owned(),
            })
        });
        is_there.then(|| below.collect())
    }

    /// Sets all figures, and what explains them.
    pub fn set_figures(&self, figures: &mut Figures, effect: Effect) {
        let estimates = self.evaluation.estimates();
        for (name, estimate) in &estimates {
            figures.set(name, estimate.mean);
        }
        figures.set("frames", self.evaluation.frames as f64);
        figures.set("frames_of_flip", self.evaluation.frames_of_flip() as f64);
        figures.set("scenes", self.evaluation.scenes.len() as f64);
        let mut intervals: Map<String, Value> = Map::new();
        intervals.extend(estimates.iter().map(|(name, estimate)| ((*name).to_owned(), interval(estimate))));
        for set in self.sets.iter().filter(|set| !set.name.is_empty()) {
            self.set_figures_of(set, figures, &mut intervals);
        }
        figures.detail("confidence_95", intervals.into());
        for (by, parts) in self.evaluation.parts() {
            figures.detail(by, json!(parts));
        }
        if self.is_divided() {
            let parts = |set: &Scored| (set.title.clone(), json!(set.evaluation.parts()));
            figures.detail("sets", self.sets.iter().map(parts).collect::<Map<_, _>>().into());
        }
        let pairs = self.pairs();
        for NetworkComparison { suffix, pair, .. } in &pairs {
            suffix.iter().for_each(|suffix| pair.set_figures(figures, None, suffix));
        }
        if !pairs.is_empty() {
            let against = pairs.iter().map(|versus| (versus.title.to_owned(), versus.pair.against()));
            figures.detail("paired_against", against.collect::<Map<_, _>>().into());
        }
        if let Some(below) = self.below_trivial(effect) {
            figures.set("scenes_below_trivial", below.len() as f64);
            figures.detail("scenes_below_trivial", json!(below));
        }
        figures.detail("devices", json!(self.evaluation.devices));
    }

    /// Figures of a set under its name.
    fn set_figures_of(&self, set: &Scored, figures: &mut Figures, intervals: &mut Map<String, Value>) {
        let usual = |rival: &&Rival| rival.quality == Some(Quality::default()) && rival.changes.is_empty();
        let plain: Vec<&str> = self.rivals.iter().filter(usual).map(|rival| rival.name.as_str()).collect();
        for (name, estimate) in set.evaluation.estimates() {
            let name = of_set(name, &set.name, &plain);
            figures.set(&name, estimate.mean);
            intervals.insert(name, interval(&estimate));
        }
        figures.set(&format!("frames_{}", set.name), set.evaluation.frames as f64);
        figures.set(&format!("frames_of_flip_{}", set.name), set.evaluation.frames_of_flip() as f64);
        figures.set(&format!("scenes_{}", set.name), set.evaluation.scenes.len() as f64);
    }
}

fn interval(estimate: &MeanInterval) -> Value {
    json!([estimate.low, estimate.high])
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::evaluation;
    use super::*;

    fn scored(name: &str, scene: &str, learned: f64, white: f64) -> Scored {
        let frame = [("flip_learned", 0.1), ("ssim_learned", learned), ("ssim_white", white)];
        let title = if name.is_empty() { "testset" } else { name }.to_owned();
        Scored { name: name.to_owned(), title, evaluation: evaluation(&[(scene, &[&frame])]) }
    }

    fn figures_of(sets: Vec<Scored>) -> Value {
        let mut figures = Figures::new("eval");
        EvaluationOutcome::new(Vec::new(), sets).set_figures(&mut figures, Effect::Ao);
        figures.to_json()
    }

    #[test]
    fn each_set_has_figures_of_its_own_and_artists_scenes_are_in_no_others() {
        let sets = vec![
            scored("artists", "hall.gltf", 0.1, 0.3),
            scored("small", "cave:1", 0.6, 0.5),
            scored("large", "bridge:1", 0.8, 0.9),
        ];
        let json = figures_of(sets);
        let figure = |name: &str| json["figures"][name].as_f64().expect("a figure");
        for (name, expected) in [
            ("ssim_learned", 0.7),
            ("ssim_learned_small", 0.6),
            ("ssim_learned_large", 0.8),
            ("ssim_learned_artists", 0.1),
            ("ssim_white_artists", 0.3),
            ("frames", 2.0),
            ("scenes_small", 1.0),
            ("frames_of_flip", 2.0),
            ("frames_of_flip_small", 1.0),
            ("scenes_below_trivial", 2.0),
        ] {
            assert!((figure(name) - expected).abs() < 1e-12, "{name}: {}", figure(name));
        }
        let below = &json["details"]["scenes_below_trivial"];
        assert_eq!(*below, json!(["hall.gltf (artists)", "bridge:1 (large)"]));
        assert!(json["details"]["confidence_95"]["ssim_learned_small"].is_array());
    }

    #[test]
    fn the_only_set_has_no_other_figures() {
        let json = figures_of(vec![scored("", "cave:1", 0.6, 0.5)]);
        let names: Vec<&String> = json["figures"].as_object().expect("figures").keys().collect();
        let expected = [
            "flip_learned",
            "frames",
            "frames_of_flip",
            "scenes",
            "scenes_below_trivial",
            "ssim_learned",
            "ssim_white",
        ];
        assert_eq!(names, expected);
        assert_eq!(json["figures"]["scenes_below_trivial"], 0.0);
        let artists = figures_of(vec![scored("artists", "hall.gltf", 0.1, 0.3)]);
        assert_eq!(artists["figures"]["ssim_learned"], 0.1, "where there is nothing else");
    }
}
