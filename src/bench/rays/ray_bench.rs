//! The same rays traced in several ways: one by one, in bundles where the program does so, and one by one by
//! a rival.
//!
//! A rival's rate is always that of single rays. So [`RayRates`]'s `ratio_<kind>` sets single rays beside
//! single rays; what bundles gain over a rival's single rays is `ratio_<kind>_bundles`, which says nothing of
//! the two hierarchies.

use super::Rival;
use super::sets::{Bundle, Kind, Ray, RaySet};
use crate::figures::Figures;
use anyhow::Result;
use deepshade_render::bvh::bundle::BUNDLE;
use deepshade_render::bvh::{Hit, TracedScene};
use deepshade_render::scene::Mesh;
use deepshade_shaders::lists;
use rayon::prelude::*;
use std::hint::black_box;
use std::ops::Range;
use std::time::Instant;

/// Rays that a thread traces at a time.
const CHUNK: usize = 4096;
/// Distances that differ by more than this share are not the same.
const SAME: f32 = 1e-4;

/// Who traces what.
pub struct RayBench<'a> {
    pub scene: &'a TracedScene,
    pub rival: Option<&'a dyn Rival>,
    /// Times that all rays are traced.
    pub runs: usize,
    /// Called whenever that happened once more.
    pub finished: &'a dyn Fn(),
}

/// Millions of rays a second.
#[derive(Clone, Copy, Debug)]
struct Rates {
    one_thread: f64,
    all_threads: f64,
}

/// What came out for a kind of rays.
pub struct RayRates {
    single: Rates,
    /// Where the program traces such rays together.
    bundles: Option<Rates>,
    /// Of single rays.
    rival: Option<Against>,
}

/// Who a rival is, its rates, and the share of rays for which it finds something else.
struct Against {
    name: &'static str,
    rates: Rates,
    disagree: f64,
}

/// A way to trace a part of the rays, from its first to its last; the number that comes out stands for the
/// hits.
type Way<'a> = Box<dyn Fn(Range<usize>) -> u32 + Sync + 'a>;

impl RayBench<'_> {
    /// Measures a kind of rays.
    pub fn of(&self, set: &RaySet) -> RayRates {
        let mut ways = vec![self.single(set)];
        if !set.bundles.is_empty() {
            ways.push(self.bundles(set));
        }
        if let Some(rival) = self.rival {
            ways.push(by_rival(rival, set));
        }
        let mut rates = self.rates(&ways, set.rays.len()).into_iter();
        let single = rates.next().expect("one by one comes first");
        let bundles = if set.bundles.is_empty() { None } else { rates.next() };
        let against = |(rival, rates): (&dyn Rival, Rates)| {
            let disagree = self.disagreement(rival, set);
            Against { name: rival.name(), rates, disagree }
        };
        RayRates { single, bundles, rival: self.rival.zip(rates.next()).map(against) }
    }

    /// Rays one by one.
    fn single<'a>(&'a self, set: &'a RaySet) -> Way<'a> {
        let scene = self.scene;
        match set.kind {
            Kind::Ao => {
                Box::new(move |part| set.rays[part].iter().map(|ray| u32::from(blocked(scene, ray))).sum())
            }
            Kind::Primary | Kind::Diffuse => Box::new(move |part| {
                let hits = set.rays[part].iter().filter_map(|ray| hit(scene, ray));
                hits.map(|hit| hit.triangle).fold(0, u32::wrapping_add)
            }),
        }
    }

    /// Rays in bundles, as the program traces them.
    fn bundles<'a>(&'a self, set: &'a RaySet) -> Way<'a> {
        let scene = self.scene;
        let bundles = move |part| &set.bundles[bundles_of(part, set.rays.len(), set.bundles.len())];
        match set.kind {
            Kind::Ao => Box::new(move |part| {
                let blocked = |Bundle { origin, directions, reach }: &Bundle| {
                    scene.blocked_bundle(*origin, directions, *reach).count_ones()
                };
                bundles(part).iter().map(blocked).sum()
            }),
            Kind::Primary | Kind::Diffuse => Box::new(move |part| {
                let bundles = bundles(part).iter();
                let hits = bundles.flat_map(|bundle| scene.hit_bundle(bundle.origin, &bundle.directions));
                hits.flatten().map(|hit| hit.triangle).fold(0, u32::wrapping_add)
            }),
        }
    }

    /// Median rates of some ways to trace so many rays, which take turns.
    fn rates(&self, ways: &[Way<'_>], rays: usize) -> Vec<Rates> {
        let mut seconds = vec![(vec![], vec![]); ways.len()];
        for _ in 0..self.runs {
            for (way, (one, all)) in ways.iter().zip(&mut seconds) {
                one.push(timed(|| way(0..rays)));
                let chunks = rays.div_ceil(CHUNK);
                let chunk = |i: usize| way(i * CHUNK..rays.min((i + 1) * CHUNK));
                all.push(timed(|| (0..chunks).into_par_iter().map(chunk).reduce(|| 0, u32::wrapping_add)));
            }
            (self.finished)();
        }
        let rate = |seconds: Vec<f64>| rays as f64 / lists::median(seconds) / 1e6;
        seconds
            .into_iter()
            .map(|(one, all)| Rates { one_thread: rate(one), all_threads: rate(all) })
            .collect()
    }

    /// Share of the rays for which a rival finds another distance, or nothing where we find something.
    fn disagreement(&self, rival: &dyn Rival, set: &RaySet) -> f64 {
        let firsts = first_triangles(self.scene);
        let differs = |ray: &&Ray| match set.kind {
            Kind::Ao => blocked(self.scene, ray) != rival.blocked(ray),
            Kind::Primary | Kind::Diffuse => !same(hit(self.scene, ray), rival.nearest(ray), &firsts),
        };
        set.rays.iter().filter(differs).count() as f64 / set.rays.len() as f64
    }
}

/// How many triangles come before each mesh's.
fn first_triangles(scene: &TracedScene) -> Vec<u32> {
    let count = |before: &mut u32, mesh: &Mesh| {
        let first = *before;
        *before += mesh.triangles.len() as u32;
        Some(first)
    };
    scene.scene().meshes.iter().scan(0, count).collect()
}

/// The bundles that stand for a part of the rays: every bundle for one part, whatever the parts. All bundles
/// but those at an image's edges are full, so that parts of as many rays have as many bundles, or one more.
fn bundles_of(part: Range<usize>, rays: usize, bundles: usize) -> Range<usize> {
    let place = |ray: usize| (ray * bundles + rays / 2) / rays;
    place(part.start)..place(part.end)
}

/// Whether two hits are one: the same triangle, or another at the same distance, as where two share an edge
/// or lie in one another.
fn same(ours: Option<Hit>, theirs: Option<(f32, u32)>, firsts: &[u32]) -> bool {
    let (ours, (distance, triangle)) = match (ours, theirs) {
        (None, None) => return true,
        (Some(ours), Some(theirs)) => (ours, theirs),
        _ => return false,
    };
    firsts[ours.mesh as usize] + ours.triangle == triangle
        || (ours.distance - distance).abs() <= SAME * distance
}

fn by_rival<'a>(rival: &'a dyn Rival, set: &'a RaySet) -> Way<'a> {
    match set.kind {
        Kind::Ao => Box::new(move |part| rival.count_of_blocked(&set.rays[part])),
        Kind::Primary | Kind::Diffuse => Box::new(move |part| rival.sum_of_nearest(&set.rays[part])),
    }
}

fn hit(scene: &TracedScene, ray: &Ray) -> Option<Hit> {
    scene.hit(ray.origin, ray.direction, ray.reach)
}

fn blocked(scene: &TracedScene, ray: &Ray) -> bool {
    scene.blocked(ray.origin, ray.direction, ray.reach)
}

fn timed(work: impl FnOnce() -> u32) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

impl RayRates {
    /// Sets a kind's figures.
    pub fn write(&self, kind: Kind, figures: &mut Figures) {
        let name = kind.name();
        let mut ways = vec![(String::new(), self.single)];
        ways.extend(self.bundles.map(|rates| ("_bundles".to_owned(), rates)));
        ways.extend(
            self.rival.as_ref().map(|rival| (format!("_{}", rival.name.to_lowercase()), rival.rates)),
        );
        for (way, rates) in ways {
            figures.set(&format!("mrays_{name}{way}"), rates.one_thread);
            figures.set(&format!("mrays_{name}{way}_all_threads"), rates.all_threads);
        }
        let Some(Against { rates: theirs, disagree, .. }) = &self.rival else { return };
        figures.set(&format!("ratio_{name}"), self.single.one_thread / theirs.one_thread);
        if let Some(bundles) = self.bundles {
            figures.set(&format!("ratio_{name}_bundles"), bundles.one_thread / theirs.one_thread);
        }
        figures.set(&format!("disagree_{name}"), *disagree);
    }

    /// Prints a kind's rates.
    pub fn print(&self, set: &RaySet) -> Result<()> {
        say!("{:<9} {} rays", set.kind.name(), set.rays.len())?;
        self.line("single rays", self.single)?;
        if let Some(bundles) = self.bundles {
            self.line(&format!("in bundles of {BUNDLE}, as the program traces them"), bundles)?;
        }
        let Some(Against { name, rates, disagree }) = &self.rival else { return Ok(()) };
        self.line(&format!("{name}, single rays"), *rates)?;
        say!("          {:.5} % of the rays meet something else in {name}", 100.0 * disagree)
    }

    /// A way's rates, and what part they are of the rival's single rays.
    fn line(&self, way: &str, Rates { one_thread, all_threads }: Rates) -> Result<()> {
        let part = |rival: &Against| {
            format!(", {:.2} of {}'s single rays", one_thread / rival.rates.one_thread, rival.name)
        };
        let part = self.rival.as_ref().map(part).unwrap_or_default();
        say!("          {one_thread:6.2} Mrays/s, all threads {all_threads:6.2}  {way}{part}")
    }
}

#[cfg(test)]
mod tests;
