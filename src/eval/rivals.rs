//! Who is evaluated: an effect's methods at their qualities, and the image of whoever does nothing.

use crate::methods::{self, LEARNED, Runs, STUDY, Setup, TRUTH};
use anyhow::{Result, ensure};
use deepshade_infer::Model;
use deepshade_render::method::Method;
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::{Changes, Tuning};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;

/// A method under the name that figures have for it.
pub struct Rival {
    /// Of an analytic method at another quality than the default one, the quality is part of it: `hbao_low`;
    /// and so is what is set by hand: `gtao_blur_radius_2`.
    pub name: String,
    /// The method's own name.
    pub method_name: &'static str,
    /// Of those that have one.
    pub quality: Option<Quality>,
    /// What of it is set by hand.
    pub changes: Changes,
    /// What is evaluated.
    pub method: Box<dyn Method>,
}

/// Opens methods by name, `all` for all that there are but [`STUDY`], each at some tunings; those of which
/// nothing can be set are opened once. `learned` is left out of `all` where there is no network.
///
/// # Errors
/// If there is no such method, or one cannot be opened.
pub fn rivals(
    effect: Effect,
    names: &[String],
    tunings: &[Tuning],
    (gpu, runs): (&Gpu, Runs),
    model: Option<&Model>,
) -> Result<Vec<Rival>> {
    let all = names.iter().any(|name| name == "all");
    let mut asked: Vec<&str> = names.iter().map(String::as_str).collect();
    if all {
        asked = methods::names_of(effect);
        asked.retain(|name| *name != STUDY && (*name != LEARNED || model.is_some()));
    }
    asked.retain(|name| *name != TRUTH);
    methods::check(effect, &asked)?;
    ensure!(
        all || !asked.is_empty(),
        "`{TRUTH}` is what others are scored against: --methods names none of these"
    );
    ensure!(!asked.is_empty(), "effect `{effect}` has no method yet but truth");
    let tunable = methods::names_with_qualities(effect);
    ensure!(
        tunings.iter().all(|tuning| tuning.changes.is_empty())
            || asked.iter().any(|name| tunable.contains(name)),
        "method `{LEARNED}`: a trained network has no parameters"
    );
    let mut rivals = Vec::new();
    for name in asked {
        let by_quality = tunable.contains(&name);
        let alike = methods::dials(effect, name, Quality::default())?.is_empty();
        for tuning in if alike { once(tunings) } else { tunings } {
            let setup = Setup { gpu, runs, model, tuning };
            for method in methods::open(effect, &[name], setup)? {
                let method_name = method.name();
                let name = if by_quality { tuned_name(method_name, tuning) } else { figure(method_name) };
                rivals.push(Rival {
                    name,
                    method_name,
                    quality: by_quality.then_some(tuning.quality),
                    changes: if by_quality { tuning.changes.clone() } else { Changes::default() },
                    method,
                });
            }
        }
    }
    Ok(rivals)
}

/// The tuning of what is the same in all of them: the one at the default quality, else the first.
fn once(tunings: &[Tuning]) -> &[Tuning] {
    let usual = tunings.iter().position(|tuning| tuning.quality == Quality::default()).unwrap_or(0);
    tunings.get(usual..=usual).unwrap_or_default()
}

/// A method's name in figures, with what is not as it is by default.
fn tuned_name(method: &str, tuning: &Tuning) -> String {
    let quality = (tuning.quality != Quality::default()).then(|| tuning.quality.name().to_owned());
    let changes = tuning.changes.0.iter().map(|(name, value)| format!("{name}_{value}"));
    let parts = std::iter::once(method.to_owned()).chain(quality).chain(changes);
    figure(&parts.collect::<Vec<_>>().join("_"))
}

/// A name in the letters that figures have.
fn figure(name: &str) -> String {
    name.replace(['-', '.'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};

    #[test]
    fn names_in_figures_say_what_is_not_by_default() {
        let changes = Changes(
            [("blur.radius".to_owned(), 2.0.into()), ("slices.thickness".to_owned(), 0.5.into())].into(),
        );
        let tuned = |quality, changes: &Changes| {
            tuned_name("bounced-z", &Tuning { quality, changes: changes.clone() })
        };
        assert_eq!(tuned(Quality::High, &Changes::default()), "bounced_z");
        assert_eq!(tuned(Quality::Low, &Changes::default()), "bounced_z_low");
        assert_eq!(tuned(Quality::High, &changes), "bounced_z_blur_radius_2_slices_thickness_0_5");
    }

    #[test]
    fn what_is_set_is_of_methods_that_have_parameters() {
        let gpu = Gpu::new().expect("an adapter");
        let spec =
            NetSpec::ao(ChannelOrder::Interleaved, Reach { radius: 1.0, diagonal_share: 0.1, height: 24 });
        let model = Model { weights: Weights::random(&spec, 1), spec };
        let changes = Changes([("blur.radius".to_owned(), 2.0.into())].into());
        let tunings = [Tuning { quality: Quality::Low, changes: changes.clone() }];
        let opened = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            rivals(Effect::Ao, &names, &tunings, (&gpu, Runs::Fastest), Some(&model))
        };
        let both = opened(&[LEARNED, "gtao"]).expect("methods");
        assert!(both[0].changes.is_empty() && both[0].name == LEARNED);
        assert_eq!((&both[1].changes, both[1].name.as_str()), (&changes, "gtao_low_blur_radius_2"));
        let error = opened(&[LEARNED]).err().expect("nothing can be set").to_string();
        assert!(error.contains("a trained network has no parameters"), "{error}");
    }

    #[test]
    fn qualities_have_names_of_their_own() {
        let gpu = Gpu::new().expect("an adapter");
        let tunings = [Quality::Low, Quality::High].map(Tuning::from);
        let all =
            rivals(Effect::Ao, &["all".to_owned()], &tunings, (&gpu, Runs::Fastest), None).expect("methods");
        let names: Vec<&str> = all.iter().map(|rival| rival.name.as_str()).collect();
        assert!(
            names.contains(&"hbao") && names.contains(&"hbao_low") && !names.contains(&"learned"),
            "{names:?}"
        );
        assert!(!names.iter().any(|name| name.starts_with("screen_truth")), "for studies: {names:?}");
        let study =
            rivals(Effect::Ao, &[STUDY.to_owned()], &tunings, (&gpu, Runs::Fastest), None).expect("a method");
        assert_eq!(study.len(), tunings.len(), "where it is asked for");
        let aov = names.iter().filter(|name| **name == "aov" || **name == "aov_low");
        assert_eq!(aov.count(), 1, "nothing of it can be set: {names:?}");
        let error = rivals(Effect::Ao, &["sharp".to_owned()], &tunings, (&gpu, Runs::Fastest), None)
            .err()
            .expect("none");
        assert!(error.to_string().contains("no method `sharp`"), "{error}");
        let refused = |effect, name: &str| {
            rivals(effect, &[name.to_owned()], &tunings, (&gpu, Runs::Fastest), None)
                .err()
                .expect("none")
                .to_string()
        };
        assert!(refused(Effect::Real, "all").contains("no method yet but truth"));
        assert!(refused(Effect::Ao, "truth").contains("scored against"));
    }
}
