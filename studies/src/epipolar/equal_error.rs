//! Trees and their rivals at equal error.

use super::simple_march;
use super::subject::{FogView, Way};
use super::table_number;
use deepshade::shared::figures::Figures;
use deepshade_render::methods::ray_march::{March, shift};
use deepshade_render::methods::shafts::Integration;
use deepshade_render::methods::{Quality, epipolar, epipolar_sampling, min_max, ray_march};
use deepshade_render::metrics::relative_mse::EPSILON;
use deepshade_shaders::lists::quantile;
use glam::Vec3;
use rayon::ThreadPool;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::convert::Infallible;

/// Steps of the march that errors are against.
pub const REFERENCE_STEPS: u32 = 32_768;
/// The fewest and the most steps that are tried.
const STEPS: [u32; 2] = [16, 16_384];
/// By so much at most may be too many steps that are called the fewest.
const PRECISION: f64 = 1.05;
/// Pixels between marched ones of epipolar sampling that are tried,
const SPACINGS: [usize; 6] = [64, 32, 16, 8, 4, 2];
/// each with so many times the steps of the march: what interpolation misses must be made up for.
const FINER: [f64; 4] = [1.0, 1.4, 2.0, 4.0];
/// Every so many pixels are compared.
const EVERY: usize = 16;

/// A method's time and error.
#[derive(Clone, Copy, Debug)]
pub struct TimeAndError {
    /// What a run takes.
    pub seconds: f64,
    /// Its relative squared error.
    pub relmse: f64,
}

/// Trees, and the march that is as good.
#[derive(Clone, Copy, Debug)]
pub struct TreeAgainstMarch {
    light_rays: usize,
    tree: TimeAndError,
    /// Its steps, and what it is; `None` if no march is.
    march: Option<(u32, TimeAndError)>,
    /// Seconds of the march step by step, of as many.
    simple_march: Option<f64>,
}

/// Epipolar sampling.
#[derive(Clone, Copy, Debug)]
struct Sampling {
    spacing: usize,
    steps: u32,
    found: TimeAndError,
    is_as_good: bool,
}

/// All of one scene and view.
pub struct ViewOutcome {
    name: String,
    /// With all light rays and with a quarter.
    comparisons: [TreeAgainstMarch; 2],
    /// The fastest epipolar sampling that is as good as the first trees; the best there is if none is.
    sampling: Option<Sampling>,
    min_max: TimeAndError,
}

/// What errors are against, at some pixels.
struct Reference {
    pixels: Vec<usize>,
    radiance: Vec<f32>,
    exposure: f32,
}

impl Reference {
    fn of(subject: &FogView) -> Self {
        let count = subject.setup.size[0] * subject.setup.size[1];
        // Not in columns: another pixel of every sixteen.
        let pixels: Vec<usize> = (0..count / EVERY).map(|i| i * EVERY + i * 7 % EVERY).collect();
        let radiance = marched(subject, &pixels, REFERENCE_STEPS, |_| 0.5);
        let bright = quantile(radiance.iter().map(|value| f64::from(*value)).collect(), 0.99) as f32;
        Self { pixels, radiance, exposure: 1.0 / bright.max(f32::MIN_POSITIVE) }
    }

    /// Relative squared error of values at the pixels.
    fn error(&self, values: impl Iterator<Item = f32>) -> f64 {
        let relative = values.zip(&self.radiance).map(|(value, truth)| {
            let [value, truth] = [value, *truth].map(|value| f64::from(value * self.exposure));
            (value - truth).powi(2) / (truth * truth + EPSILON)
        });
        relative.sum::<f64>() / self.pixels.len() as f64
    }

    fn error_of_image(&self, radiance: &[Vec3]) -> f64 {
        self.error(self.pixels.iter().map(|pixel| radiance[*pixel].x))
    }

    /// The fewest steps of a march whose error is no larger; `None` if those of all that are tried are.
    fn fewest_steps(&self, subject: &FogView, error: f64) -> Option<u32> {
        let is_enough = |steps: u32| {
            let found = marched(subject, &self.pixels, steps, |pixel| shift(pixel, 1));
            self.error(found.into_iter()) <= error
        };
        fewest(STEPS, |steps| Ok::<_, Infallible>(is_enough(steps))).unwrap_or_else(|never| match never {})
    }
}

/// The fewest steps that are enough, to a few percent, of those between two; `None` if the most are too few.
///
/// # Errors
/// Those of the question.
pub fn fewest<E>(
    [fewest, most]: [u32; 2],
    mut is_enough: impl FnMut(u32) -> Result<bool, E>,
) -> Result<Option<u32>, E> {
    let [mut few, mut enough] = [fewest; 2];
    while !is_enough(enough)? {
        if enough >= most {
            return Ok(None);
        }
        (few, enough) = (enough, 2 * enough);
    }
    while f64::from(enough) > PRECISION * f64::from(few) && enough > few + 1 {
        let middle = ((f64::from(few) * f64::from(enough)).sqrt() as u32).max(few + 1);
        *(if is_enough(middle)? { &mut enough } else { &mut few }) = middle;
    }
    Ok(Some(enough))
}

/// What a march gives for some pixels, on all threads.
fn marched(
    subject: &FogView,
    pixels: &[usize],
    steps: u32,
    jitter: impl Fn(usize) -> f32 + Sync,
) -> Vec<f32> {
    subject.lit(|lit| {
        let march = March::new(lit, 0);
        pixels.par_iter().map(|pixel| march.along(*pixel, steps, jitter(*pixel)).x).collect()
    })
}

impl TreeAgainstMarch {
    fn of(subject: &FogView, reference: &Reference, light_rays: usize, pool: &ThreadPool) -> Self {
        let trees =
            epipolar::EpipolarParameters { light_rays, ..epipolar::EpipolarParameters::of(Quality::High) };
        let tree: &Way<'_> = &|lit, radiance| trees.add(lit, radiance);
        let measured = |(radiance, seconds): &(Vec<Vec3>, f64)| TimeAndError {
            seconds: *seconds,
            relmse: reference.error_of_image(radiance),
        };
        let (radiance, _) = subject.once(tree, pool);
        let Some(steps) = reference.fewest_steps(subject, reference.error_of_image(&radiance)) else {
            let [tree] = subject.timed([tree], pool);
            return Self { light_rays, tree: measured(&tree), march: None, simple_march: None };
        };
        let march =
            ray_march::RayMarchParameters { steps, ..ray_march::RayMarchParameters::of(Quality::High) };
        let [tree, march] = subject.timed([tree, &|lit, radiance| march.add(lit, radiance)], pool);
        Self {
            light_rays,
            tree: measured(&tree),
            march: Some((steps, measured(&march))),
            simple_march: simple_march::seconds(subject, steps, pool),
        }
    }

    /// How many times as long the march takes; no number if none is as good.
    fn speedup(&self) -> f64 {
        self.march.map_or(f64::NAN, |(_, march)| march.seconds / self.tree.seconds)
    }

    /// How many times as long the march takes step by step; no number if none is as good.
    fn speedup_over_simple(&self) -> f64 {
        self.simple_march.map_or(f64::NAN, |seconds| seconds / self.tree.seconds)
    }
}

impl ViewOutcome {
    /// Measures one scene and view in a pool of one thread.
    pub fn of(subject: &FogView, pool: &ThreadPool) -> Self {
        let reference = Reference::of(subject);
        let light_rays = subject.setup.light_rays;
        let comparisons =
            [light_rays, light_rays / 4].map(|rays| TreeAgainstMarch::of(subject, &reference, rays, pool));
        let sampling = best_sampling(subject, &reference, &comparisons[0], pool);
        let usual = min_max::MinMaxParameters::of(Quality::High);
        let quarter = min_max::MinMaxParameters { light_rays: light_rays / 4, ..usual };
        let [(radiance, seconds)] = subject.timed([&|lit, radiance| quarter.add(lit, radiance)], pool);
        let min_max = TimeAndError { seconds, relmse: reference.error_of_image(&radiance) };
        Self { name: subject.name.clone(), comparisons, sampling, min_max }
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        let Self { name, comparisons: [all, quarter], sampling, min_max } = self;
        figures.set(&format!("speedup_{name}"), all.speedup());
        figures.set(&format!("speedup_{name}_quarter"), quarter.speedup());
        figures.set(&format!("speedup_simple_{name}"), all.speedup_over_simple());
        figures.set(&format!("relmse_tree_{name}"), all.tree.relmse);
        figures.set(&format!("relmse_march_{name}"), all.march.map_or(f64::NAN, |(_, march)| march.relmse));
        figures.set(&format!("seconds_tree_{name}"), all.tree.seconds);
        figures.set(&format!("seconds_min_max_{name}"), min_max.seconds);
        figures.set(&format!("relmse_min_max_{name}"), min_max.relmse);
        let good = sampling.filter(|sampling| sampling.is_as_good);
        let over = good.map_or(f64::NAN, |Sampling { found, .. }| found.seconds / all.tree.seconds);
        figures.set(&format!("sampling_{name}"), over);
        let relmse = sampling.map_or(f64::NAN, |Sampling { found, .. }| found.relmse);
        figures.set(&format!("relmse_sampling_{name}"), relmse);
    }

    /// Everything that was measured.
    pub fn to_json(&self) -> Value {
        let measured = |found: &TimeAndError| json!({ "seconds": found.seconds, "relmse": found.relmse });
        let comparison = |comparison: &TreeAgainstMarch| {
            json!({
                "light_rays": comparison.light_rays, "tree": measured(&comparison.tree),
                "march": comparison.march.as_ref().map(|(steps, found)| json!([steps, measured(found)])),
                "simple_march_seconds": comparison.simple_march,
            })
        };
        json!({
            "name": self.name, "duels": self.comparisons.iter().map(comparison).collect::<Vec<_>>(),
            "sampling": self.sampling.as_ref()
                .map(|Sampling { spacing, steps, found, .. }| json!([spacing, steps, measured(found)])),
            "min_max": measured(&self.min_max),
        })
    }
}

/// The fastest epipolar sampling that is as good as trees, or the best if none is.
fn best_sampling(
    subject: &FogView,
    reference: &Reference,
    comparison: &TreeAgainstMarch,
    pool: &ThreadPool,
) -> Option<Sampling> {
    let (fewest, _) = comparison.march?;
    let of = |(spacing, finer): (usize, f64)| {
        let steps = (f64::from(fewest) * finer) as u32;
        let usual = epipolar_sampling::EpipolarSamplingParameters::of(Quality::High);
        let sampling = epipolar_sampling::EpipolarSamplingParameters { spacing, steps, ..usual };
        let (radiance, seconds) = subject.once(&|lit, radiance| sampling.add(lit, radiance), pool);
        let found = TimeAndError { seconds, relmse: reference.error_of_image(&radiance) };
        Sampling { spacing, steps, found, is_as_good: found.relmse <= comparison.tree.relmse }
    };
    let all = SPACINGS.into_iter().flat_map(|spacing| FINER.map(|finer| (spacing, finer)));
    // Good ones come first, by time; others by error.
    let rank = |sampling: &Sampling| {
        let Sampling { found, is_as_good, .. } = sampling;
        (!is_as_good, if *is_as_good { found.seconds } else { found.relmse })
    };
    all.map(of).min_by(|a, b| {
        let [a, b] = [a, b].map(rank);
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}

/// Sets the least and the greatest speed-up, and the worst errors.
pub fn set_extremes(outcomes: &[ViewOutcome], figures: &mut Figures) {
    for (which, suffix) in [(0, ""), (1, "_quarter")] {
        let speedups = || outcomes.iter().map(|outcome| outcome.comparisons[which].speedup());
        figures.set(&format!("speedup_min{suffix}"), speedups().fold(f64::INFINITY, f64::min));
        figures.set(&format!("speedup_max{suffix}"), speedups().fold(0.0, f64::max));
    }
    let worst = |error: fn(&TreeAgainstMarch) -> f64| {
        outcomes.iter().map(|outcome| error(&outcome.comparisons[0])).fold(0.0, f64::max)
    };
    figures.set("relmse_tree", worst(|comparison| comparison.tree.relmse));
    figures.set("relmse_march", worst(|comparison| comparison.march.map_or(0.0, |(_, march)| march.relmse)));
}

/// Rows of a table.
pub fn rows(outcomes: &[ViewOutcome]) -> Vec<Vec<String>> {
    let head = [
        "scene and view",
        "light rays",
        "relmse",
        "tree s",
        "steps",
        "march s",
        "speed-up",
        "simple march s",
        "speed-up",
        "sampling",
        "min/max s",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for ViewOutcome { name, comparisons, sampling, min_max } in outcomes {
        for (which, comparison) in comparisons.iter().enumerate() {
            let march = |of: &dyn Fn(&(u32, TimeAndError)) -> String| {
                comparison.march.as_ref().map_or("worse".to_owned(), of)
            };
            let first = |text: String| if which == 0 { text } else { String::new() };
            let sampling = match sampling {
                Some(Sampling { found, is_as_good: true, .. }) => {
                    format!("{:.1} times", found.seconds / comparison.tree.seconds)
                }
                Some(Sampling { found, .. }) => format!("relmse {}", table_number(found.relmse)),
                None => String::new(),
            };
            rows.push(vec![
                first(name.clone()),
                comparison.light_rays.to_string(),
                table_number(comparison.tree.relmse),
                format!("{:.3}", comparison.tree.seconds),
                march(&|(steps, _)| steps.to_string()),
                march(&|(_, found)| format!("{:.2}", found.seconds)),
                march(&|(_, found)| format!("{:.1}", found.seconds / comparison.tree.seconds)),
                comparison.simple_march.map_or(String::new(), |seconds| format!("{seconds:.1}")),
                comparison
                    .simple_march
                    .map_or(String::new(), |_| format!("{:.0}", comparison.speedup_over_simple())),
                first(sampling),
                first(format!("{:.3}", min_max.seconds)),
            ]);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::subject::{Kind, Setup, View};
    use super::*;

    #[test]
    fn trees_and_marches_are_measured_as_small_as_they_go() {
        let setup = Setup { size: [96, 128], light_rays: 512, shadow_size: 512 };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let subject = FogView::new(Kind::Indoor, View::Side, setup).expect("a scene");
        let outcome = ViewOutcome::of(&subject, &pool);
        for comparison in &outcome.comparisons {
            assert!(comparison.tree.relmse < 1e-2 && comparison.tree.relmse > 0.0, "{comparison:?}");
            assert!(
                comparison.march.is_some_and(|(steps, _)| (STEPS[0]..=STEPS[1]).contains(&steps)),
                "{comparison:?}"
            );
            assert!(comparison.speedup() > 0.0 && comparison.speedup().is_finite(), "{comparison:?}");
            assert!(comparison.speedup_over_simple() > 0.0, "{comparison:?}");
        }
        // As good, to what chance decides of pixels that were not compared alike.
        let [all, _] = outcome.comparisons;
        let (_, march) = all.march.expect("as good");
        assert!(march.relmse <= 1.1 * all.tree.relmse, "{all:?}");
        // No march is better than truth.
        assert_eq!(Reference::of(&subject).fewest_steps(&subject, 0.0), None);
        let mut figures = Figures::new("epipolar");
        outcome.set(&mut figures);
        set_extremes(&[outcome], &mut figures);
        let written = figures.to_json();
        for name in
            ["speedup_indoor_side", "speedup_min", "speedup_max_quarter", "relmse_tree", "relmse_march"]
        {
            assert!(written["figures"][name].is_number(), "{name}");
        }
    }
}
