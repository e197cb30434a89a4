//! A network against the best method that takes no longer: the difference of the two frame by frame, whose
//! interval is narrower than those of both, since what makes a scene hard for one makes it hard for the
//! other.

use super::rivals::Rival;
use super::score::Evaluation;
use crate::figures::Figures;
use crate::methods::LEARNED;
use crate::statistics::{MeanInterval, paired};
use serde_json::{Value, json};

/// What differences are of, as figures name it.
pub const METRICS: [&str; 4] = ["ssim", "psnr", "flip", "relmse"];

/// A network and the rival that it is held against.
pub struct Pair<'a> {
    /// The rival.
    pub rival: &'a Rival,
    /// Mean milliseconds of the network, and of the rival where it ran on the same device.
    pub milliseconds: (f64, Option<f64>),
    /// How far the network is above the rival, by [`METRICS`], where both were measured.
    pub differences: [Option<MeanInterval>; 4],
}

/// A rival's figures.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate<'a> {
    /// Its name in figures.
    name: &'a str,
    /// Whether it ran where the network did, so that their times say something of each other.
    same_device: bool,
    milliseconds: f64,
    ssim: f64,
}

impl<'a> Pair<'a> {
    /// The pair of an evaluation; none without a network, or without a rival that was measured on the same
    /// frames.
    pub fn new(evaluation: &Evaluation, rivals: &'a [Rival]) -> Option<Self> {
        let analytic = rivals.iter().filter(|rival| rival.method_name != LEARNED);
        let names: Vec<&str> = analytic.map(|rival| rival.name.as_str()).collect();
        let own = candidate(evaluation, LEARNED)?;
        let found = strongest(own.milliseconds, &candidates(evaluation, &names))?;
        let values = |metric: &str, name: &str| evaluation.values(&format!("{metric}_{name}"));
        Some(Self {
            rival: rivals.iter().find(|rival| rival.name == found.name)?,
            milliseconds: (own.milliseconds, found.same_device.then_some(found.milliseconds)),
            differences: METRICS.map(|metric| paired(values(metric, LEARNED), values(metric, found.name))),
        })
    }

    /// Sets `paired_ssim`, `paired_ssim_low` and `paired_ssim_high` (the ends of the interval), and so on,
    /// each with a suffix. Of one of several networks `paired_<network>` is of SSIM, `paired_psnr_<network>`
    /// of PSNR.
    pub fn set_figures(&self, figures: &mut Figures, network: Option<&str>, suffix: &str) {
        for (metric, difference) in METRICS.iter().zip(self.differences) {
            let Some(MeanInterval { mean, low, high }) = difference else { continue };
            let stem = match network {
                None => format!("paired_{metric}"),
                Some(network) if *metric == "ssim" => format!("paired_{network}"),
                Some(network) => format!("paired_{metric}_{network}"),
            };
            for (end, value) in [("", mean), ("_low", low), ("_high", high)] {
                figures.set(&format!("{stem}{end}{suffix}"), value);
            }
        }
    }

    /// Whom the network is held against, as a detail of the figures.
    pub fn against(&self) -> Value {
        let (own, rival) = self.milliseconds;
        json!({
            "method": self.rival.method_name,
            "quality": self.rival.quality.map(|quality| quality.name()),
            "figures": self.rival.name,
            "ms": rival,
            "ms_learned": own,
        })
    }
}

/// What was measured on all frames that a network was measured on.
fn candidates<'a>(evaluation: &Evaluation, names: &[&'a str]) -> Vec<Candidate<'a>> {
    let frames = evaluation.values(&format!("ssim_{LEARNED}")).len();
    let complete = |name: &&&str| evaluation.values(&format!("ssim_{name}")).len() == frames;
    names.iter().filter(complete).filter_map(|name| candidate(evaluation, name)).collect()
}

fn candidate<'a>(evaluation: &Evaluation, name: &'a str) -> Option<Candidate<'a>> {
    let mean = |metric: &str| evaluation.mean(&format!("{metric}_{name}"));
    let device = |name: &str| evaluation.devices.get(name);
    let same_device = evaluation.all_on_processor || device(name) == device(LEARNED);
    Some(Candidate { name, same_device, milliseconds: mean("ms")?, ssim: mean("ssim")? })
}

/// Of those that take no longer than a network, on the same device, the one of the highest similarity; where
/// all take longer, the fastest on that device; where all ran on others, the one of the highest similarity.
fn strongest<'a>(milliseconds: f64, candidates: &[Candidate<'a>]) -> Option<Candidate<'a>> {
    let comparable = || candidates.iter().filter(|candidate| candidate.same_device);
    let most_similar = |a: &&Candidate<'_>, b: &&Candidate<'_>| a.ssim.total_cmp(&b.ssim);
    let best = comparable().filter(|candidate| candidate.milliseconds <= milliseconds).max_by(most_similar);
    let fastest = || comparable().min_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
    best.or_else(fastest).or_else(|| candidates.iter().max_by(most_similar)).copied()
}

#[cfg(test)]
pub mod tests {
    use super::super::score::tests::evaluation;
    use super::*;
    use deepshade_render::method::{Frame, Method, MethodError, Repeats, Shaded};
    use deepshade_render::methods::Quality;
    use deepshade_render::methods::dials::Changes;
    use deepshade_shaders::Effect;

    fn candidates_of(all: &[(&'static str, f64, f64)]) -> Vec<Candidate<'static>> {
        all.iter()
            .map(|(name, milliseconds, ssim)| Candidate {
                name,
                same_device: true,
                milliseconds: *milliseconds,
                ssim: *ssim,
            })
            .collect()
    }

    #[test]
    fn the_rival_is_the_best_of_those_that_take_no_longer() {
        let all = candidates_of(&[
            ("gtao", 1.0, 0.9),
            ("gtao_ultra", 5.0, 0.8),
            ("hbao_ultra", 6.0, 0.7),
            ("surfel", 4.0, 0.85),
        ]);
        let found = |milliseconds: f64| strongest(milliseconds, &all).map(|candidate| candidate.name);
        assert_eq!(found(0.5), Some("gtao"), "all take longer: the fastest");
        assert_eq!(found(1.0), Some("gtao"), "as long to the last digit");
        assert_eq!(found(4.5), Some("gtao"), "what is better and faster is one, too");
        let worse = candidates_of(&[("gtao", 1.0, 0.7), ("gtao_ultra", 5.0, 0.95), ("surfel", 4.0, 0.85)]);
        let found = |milliseconds: f64| strongest(milliseconds, &worse).map(|candidate| candidate.name);
        assert_eq!(found(4.5), Some("surfel"), "what is better and slower is none");
        assert_eq!(found(9.0), Some("gtao_ultra"));
        assert_eq!(strongest(1.0, &[]), None);
    }

    #[test]
    fn times_on_another_device_count_for_nothing() {
        let mut all = candidates_of(&[("gtao", 1.0, 0.7), ("hbao", 900.0, 0.8), ("surfel", 0.1, 0.9)]);
        all[1].same_device = false;
        all[2].same_device = false;
        let found = |all: &[Candidate<'static>]| strongest(0.5, all).map(|candidate| candidate.name);
        assert_eq!(found(&all), Some("gtao"), "the others are better, and elsewhere");
        assert_eq!(found(&all[1..]), Some("surfel"), "none ran there: the best of all");
    }

    #[test]
    fn a_software_adapter_is_the_processor() {
        let frame = [("ssim_learned", 0.5), ("ms_learned", 5.0), ("ssim_fxaa", 0.4), ("ms_fxaa", 2.0)];
        let mut found = evaluation(&[("cave:1", &[&frame])]);
        let devices = [("learned", "a processor"), ("fxaa", "a software adapter")];
        found.devices = devices.map(|(name, device)| (name.to_owned(), device.to_owned())).into();
        let same = |found: &Evaluation| candidates(found, &["fxaa"])[0].same_device;
        assert!(!same(&found));
        found.all_on_processor = true;
        assert!(same(&found));
    }

    #[test]
    fn what_was_not_measured_on_all_frames_is_no_rival() {
        let frame = [
            ("ssim_learned", 0.5),
            ("ssim_gtao", 0.4),
            ("ms_gtao", 2.0),
            ("ssim_hbao", 0.4),
            ("ms_hbao", 3.0),
        ];
        let found = evaluation(&[("cave:1", &[&frame, &frame[..3]])]);
        let names: Vec<&str> =
            candidates(&found, &["gtao", "hbao", "aov"]).iter().map(|one| one.name).collect();
        assert_eq!(names, ["gtao"]);
    }

    /// A method that is only named.
    struct Named;

    impl Method for Named {
        fn name(&self) -> &'static str {
            "gtao"
        }

        fn effect(&self) -> Effect {
            Effect::Ao
        }

        fn shade(&self, _: &Frame<'_>, _: Repeats) -> Result<Shaded, MethodError> {
            Err(MethodError::Other { method: "gtao", what: "it is only named".to_owned() })
        }
    }

    pub fn rival(name: &str, method_name: &'static str) -> Rival {
        rival_at(name, method_name, Quality::High)
    }

    fn rival_at(name: &str, method_name: &'static str, quality: Quality) -> Rival {
        let (name, quality) = (name.to_owned(), Some(quality));
        Rival { name, method_name, quality, changes: Changes::default(), method: Box::new(Named) }
    }

    #[test]
    fn figures_are_of_the_differences_of_the_pair() {
        let frame = |learned: f64, flips: [f64; 2]| {
            [
                ("ms_learned", 2.0),
                ("ssim_learned", learned),
                ("flip_learned", flips[0]),
                ("ms_gtao", 1.5),
                ("ssim_gtao", 0.5),
                ("flip_gtao", flips[1]),
                ("ms_gtao_ultra", 3.0),
                ("ssim_gtao_ultra", 0.99),
                ("flip_gtao_ultra", 0.0),
            ]
        };
        let frames = [frame(0.6, [0.1, 0.2]), frame(0.8, [0.1, 0.4]), frame(0.3, [0.3, 0.2])];
        let found = evaluation(&[("cave:1", &[&frames[0], &frames[1]]), ("drapery:1", &[&frames[2]])]);
        let rivals = [
            rival_at("learned", "learned", Quality::High),
            rival_at("gtao", "gtao", Quality::High),
            rival_at("gtao_ultra", "gtao", Quality::Ultra),
        ];
        let pair = Pair::new(&found, &rivals).expect("a pair");
        assert_eq!(
            (pair.against()["method"].as_str(), pair.against()["quality"].as_str()),
            (Some("gtao"), Some("high"))
        );
        assert_eq!(pair.milliseconds, (2.0, Some(1.5)));
        let mut figures = Figures::new("eval");
        pair.set_figures(&mut figures, None, "_small");
        let json = figures.to_json();
        let figure = |name: &str| json["figures"][name].as_f64().expect("a figure");
        // Scenes differ by 0.2 and -0.2 in similarity, by -0.2 and 0.1 in FLIP.
        for (name, expected) in [
            ("paired_ssim_small", 0.0),
            ("paired_ssim_low_small", -0.2),
            ("paired_ssim_high_small", 0.2),
            ("paired_flip_small", -0.05),
            ("paired_flip_low_small", -0.2),
            ("paired_flip_high_small", 0.1),
        ] {
            assert!((figure(name) - expected).abs() < 1e-12, "{name}: {}", figure(name));
        }
        assert!(json["figures"]["paired_psnr_small"].is_null(), "it was not measured");
        let mut of_several = Figures::new("eval");
        pair.set_figures(&mut of_several, Some("ao"), "_artists");
        let of_several = of_several.to_json()["figures"].clone();
        for (name, of_one) in [
            ("paired_ao_artists", "paired_ssim_small"),
            ("paired_ao_low_artists", "paired_ssim_low_small"),
            ("paired_flip_ao_high_artists", "paired_flip_high_small"),
        ] {
            assert_eq!(of_several[name], json["figures"][of_one], "{name}");
        }
        assert!(Pair::new(&found, &rivals[..1]).is_none(), "no rival");
        let without = evaluation(&[("cave:1", &[&frames[0][3..]])]);
        assert!(Pair::new(&without, &rivals).is_none(), "no network");
    }
}
