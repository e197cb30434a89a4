//! The same rays traced in several ways: as the program traces such rays, one by one, and by a rival.

use super::Rival;
use super::sets::{Bundle, Kind, Ray, RaySet};
use crate::figures::Figures;
use anyhow::Result;
use deepshade_render::bvh::{Hit, TracedScene};
use deepshade_shaders::lists;
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Rays that a thread traces at a time.
const CHUNK: usize = 4096;
/// Distances that differ by more than this share are not the same.
const SAME: f32 = 1e-4;

/// Who traces what.
pub struct Contest<'a> {
    pub scene: &'a TracedScene,
    pub rival: Option<&'a dyn Rival>,
    /// Times that all rays are traced.
    pub runs: usize,
}

/// Millions of rays a second.
#[derive(Clone, Copy, Debug)]
struct Rates {
    one_thread: f64,
    all_threads: f64,
}

/// What came out for a kind of rays.
pub struct Outcome {
    ours: Rates,
    single: Rates,
    rival: Option<Against>,
}

/// A rival's rates, and the share of rays for which it finds something else.
struct Against {
    rates: Rates,
    disagree: f64,
}

/// A way to trace a part of the rays, from its first to its last; the number that comes out stands for the hits.
type Way<'a> = Box<dyn Fn(std::ops::Range<usize>) -> u32 + Sync + 'a>;

impl Contest<'_> {
    /// Measures a kind of rays.
    pub fn of(&self, set: &RaySet) -> Outcome {
        let mut ways = vec![self.single(set)];
        if !set.bundles.is_empty() {
            ways.push(self.bundles(set));
        }
        if let Some(rival) = self.rival {
            ways.push(by_rival(rival, set));
        }
        let mut rates = self.rates(&ways, set.rays.len()).into_iter();
        let single = rates.next().expect("one by one comes first");
        let ours = if set.bundles.is_empty() { single } else { rates.next().expect("then bundles") };
        let against = |(rival, rates)| Against { rates, disagree: self.disagreement(rival, set) };
        Outcome { ours, single, rival: self.rival.zip(rates.next()).map(against) }
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

    /// Rays in bundles, as the program traces them. All bundles but those at an image's edges are full.
    fn bundles<'a>(&'a self, set: &'a RaySet) -> Way<'a> {
        let scene = self.scene;
        let share = set.bundles.len() as f64 / set.rays.len() as f64;
        let bundles = move |part: std::ops::Range<usize>| {
            let place = |ray: usize| (ray as f64 * share).round() as usize;
            &set.bundles[place(part.start)..place(part.end)]
        };
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
        }
        let rate = |seconds: Vec<f64>| rays as f64 / lists::median(seconds) / 1e6;
        seconds
            .into_iter()
            .map(|(one, all)| Rates { one_thread: rate(one), all_threads: rate(all) })
            .collect()
    }

    /// Share of the rays for which a rival finds another distance, or nothing where we find something.
    fn disagreement(&self, rival: &dyn Rival, set: &RaySet) -> f64 {
        let firsts = self.first_triangles();
        let differs = |ray: &&Ray| match set.kind {
            Kind::Ao => blocked(self.scene, ray) != rival.blocked(ray),
            Kind::Primary | Kind::Diffuse => !same(hit(self.scene, ray), rival.nearest(ray), &firsts),
        };
        set.rays.iter().filter(differs).count() as f64 / set.rays.len() as f64
    }

    /// How many triangles come before each mesh's.
    fn first_triangles(&self) -> Vec<u32> {
        let count = |before: &mut u32, mesh: &deepshade_render::scene::Mesh| {
            let first = *before;
            *before += mesh.triangles.len() as u32;
            Some(first)
        };
        self.scene.scene().meshes.iter().scan(0, count).collect()
    }
}

/// Whether two hits are one: the same triangle, or another at the same distance, as where two share an edge or lie in
/// one another.
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

impl Outcome {
    /// Sets a kind's figures.
    pub fn write(&self, kind: Kind, figures: &mut Figures) {
        let name = kind.name();
        let mut rates = |what: &str, rates: Rates| {
            figures.set(&format!("mrays_{name}{what}"), rates.one_thread);
            figures.set(&format!("mrays_{name}{what}_all_threads"), rates.all_threads);
        };
        rates("", self.ours);
        rates("_single", self.single);
        if let Some(Against { rates: theirs, disagree }) = &self.rival {
            rates("_embree", *theirs);
            figures.set(&format!("ratio_{name}"), self.ours.one_thread / theirs.one_thread);
            figures.set(&format!("ratio_{name}_single"), self.single.one_thread / theirs.one_thread);
            figures.set(&format!("disagree_{name}"), *disagree);
        }
    }

    /// Prints a kind's rates.
    pub fn print(&self, set: &RaySet) -> Result<()> {
        let line = |who: &str, rates: Rates| {
            let Rates { one_thread, all_threads } = rates;
            say!("          {one_thread:6.2} Mrays/s, all threads {all_threads:6.2}  {who}")
        };
        say!("{:<9} {} rays", set.kind.name(), set.rays.len())?;
        if !set.bundles.is_empty() {
            line("in bundles, as the program traces them", self.ours)?;
        }
        line("one by one", self.single)?;
        let Some(Against { rates, disagree }) = &self.rival else { return Ok(()) };
        line("Embree, one by one", *rates)?;
        let ratio = self.ours.one_thread / rates.one_thread;
        say!("          {ratio:6.2} of Embree's rate, one thread; {:.5} % disagree", 100.0 * disagree)
    }
}
