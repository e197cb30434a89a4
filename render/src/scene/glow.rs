//! Which surfaces of a scene keep light, and when its lamps shine: what phosphorescence is of.

pub mod file;
pub mod surface;

pub use surface::{GlowSurface, PaintTextures};

use super::{Material, Scene};
use deepshade_glow::file::MaterialFile;
use deepshade_glow::paint::Paint;
use glam::Vec3;
use std::sync::LazyLock;

/// The paint of surfaces where nothing is said: a preset.
const USUAL: &str = "blue";

/// A time so long that every state that changes has reached its equilibrium, seconds.
pub const FOR_LONG: f32 = 1e12;

/// Lamps that stand for the environment where methods draw shadow maps of what surfaces keep.
pub const SKY_LAMPS: u32 = 32;

/// Parts of the past that are looked at to tell what of it matters.
const FINE: usize = 4096;

/// What of a scene keeps light, and the moment at which it is seen. Lamps are the scene's lights without an
/// extent, and the environment where a schedule says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Glow {
    /// What of its surfaces keeps light.
    pub surfaces: Vec<GlowSurface>,
    /// The paint of what fills the space between surfaces: one that nothing is seen through looks like a
    /// surface of it.
    pub medium: Option<Paint>,
    /// When lamps shine; the last is of all lamps that no other names.
    pub schedules: Vec<Schedule>,
    /// How it is at the [beginning](Self::begin).
    pub start: Start,
    /// The moment at which a still shows it, seconds. Before the beginning it is as then.
    pub moment: f32,
}

/// When some lamps shine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schedule {
    /// Their numbers in the scene.
    pub lights: Vec<usize>,
    /// Whether the environment shines then, too. Where no schedule says so nothing keeps its light.
    pub sky: bool,
    /// From when to when, seconds, in order and apart.
    pub on: Vec<[f32; 2]>,
}

/// What surfaces are like at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// This share of each state is excited.
    Share(f32),
    /// All lamps have shone for so long that nothing changes any more.
    LitForLong,
}

/// A time in which no lamp is switched.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// How long it is, seconds.
    pub seconds: f32,
    /// Which schedules have their lamps on.
    pub on: Vec<bool>,
}

impl Piece {
    /// The light of the lamps that shine, of that of each schedule's when they do.
    pub fn light(&self, of_schedules: &[Vec3]) -> Vec3 {
        self.on.iter().zip(of_schedules).filter(|(on, _)| **on).map(|(_, light)| *light).sum()
    }
}

/// All surfaces glow: dark before, lamps have shone for the second before time 0. Longer light would fill all
/// states alike.
static AFTERGLOW: LazyLock<Glow> = LazyLock::new(|| {
    let presets = MaterialFile::presets();
    let material = presets.named(USUAL).expect("a preset");
    Glow {
        surfaces: vec![GlowSurface::new(None, Paint::new(material, None).expect("one state"))],
        medium: None,
        schedules: vec![Schedule { on: vec![[-1.0, 0.0]], ..Schedule::default() }],
        start: Start::Share(0.0),
        moment: 0.0,
    }
});

impl Glow {
    /// That of a scene; where it says nothing, all surfaces are of the preset `blue`, lamps shone for a
    /// second, and it is seen as they go out.
    pub fn of(scene: &Scene) -> &Self {
        scene.glow.as_deref().unwrap_or(&AFTERGLOW)
    }

    /// States of the paint that has most; 1 where there is no paint.
    pub fn most_states(&self) -> usize {
        self.paints().map(|paint| paint.states.len()).max().unwrap_or(1)
    }

    /// All paints: of surfaces, and last that of the medium.
    pub fn paints(&self) -> impl Iterator<Item = &Paint> {
        self.surfaces.iter().map(|surface| &surface.paint).chain(&self.medium)
    }

    /// Whether any surface's paint has textures.
    pub fn has_textures(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.textures.is_any())
    }

    /// The paint of each of a scene's materials: its place in `surfaces`.
    pub fn paints_of(&self, scene: &Scene) -> Vec<Option<usize>> {
        let named = |wanted: Option<&str>| {
            self.surfaces.iter().position(|surface| surface.material.as_deref() == wanted)
        };
        let paint = |(material, own): (&Material, String)| {
            named(Some(&own)).or_else(|| named(Some(&material.name))).or_else(|| named(None))
        };
        scene.materials.iter().zip(scene.material_names()).map(paint).collect()
    }

    /// Which schedule a lamp follows.
    pub fn schedule_of(&self, light: usize) -> usize {
        let named = self.schedules.iter().position(|schedule| schedule.lights.contains(&light));
        named.unwrap_or(self.schedules.len() - 1)
    }

    /// Which schedule the environment follows; none where nothing keeps its light.
    pub fn schedule_of_sky(&self) -> Option<usize> {
        self.schedules.iter().position(|schedule| schedule.sky)
    }

    /// Whether the environment shines at the moment that a still shows, or nothing keeps its light.
    pub fn sky_shines(&self) -> bool {
        let shines = |on: &[f32; 2]| (on[0]..on[1]).contains(&self.moment);
        self.schedule_of_sky().is_none_or(|sky| self.schedules[sky].on.iter().any(shines))
    }

    /// Whether the environment shines from a moment on for ever, seconds, or nothing keeps its light.
    pub fn sky_shines_on(&self, moment: f32) -> bool {
        let last = |schedule: &Schedule| schedule.on.last().copied();
        let last = self.schedule_of_sky().map(|sky| last(&self.schedules[sky]));
        last.is_none_or(|last| last.is_some_and(|[on, off]| on <= moment && off == f32::INFINITY))
    }

    /// Whether a lamp shines at the moment that a still shows.
    pub fn shines(&self, light: usize) -> bool {
        self.shines_at(light, self.moment)
    }

    /// Whether a lamp shines at a moment, seconds.
    pub fn shines_at(&self, light: usize, moment: f32) -> bool {
        let on = &self.schedules[self.schedule_of(light)].on;
        on.iter().any(|[on, off]| (*on..*off).contains(&moment))
    }

    /// The share of each state that is excited before the first piece of [`Self::past`].
    pub const fn before(&self) -> f32 {
        match self.start {
            Start::Share(share) => share,
            Start::LitForLong => 0.0,
        }
    }

    /// When time begins, seconds: at 0, or before, when the first lamp is switched.
    pub fn begin(&self) -> f32 {
        self.switches().fold(0.0, f32::min)
    }

    /// All time until a moment, from its beginning on.
    pub fn past(&self, moment: f32) -> Vec<Piece> {
        let lit = Piece { seconds: FOR_LONG, on: vec![true; self.schedules.len()] };
        let first = (self.start == Start::LitForLong).then_some(lit);
        first.into_iter().chain(self.between(self.begin(), moment)).collect()
    }

    /// The time from one moment to another, cut where a lamp is switched; nothing where the other is not
    /// later.
    pub fn between(&self, from: f32, to: f32) -> Vec<Piece> {
        let mut cuts: Vec<f32> = self.switches().filter(|at| (from..to).contains(at)).collect();
        cuts.extend((from < to).then_some([from, to]).into_iter().flatten());
        cuts.sort_unstable_by(f32::total_cmp);
        cuts.dedup();
        let is_on = |at: f32| {
            move |schedule: &Schedule| schedule.on.iter().any(|[on, off]| (*on..*off).contains(&at))
        };
        let piece = |ends: &[f32]| Piece {
            seconds: ends[1] - ends[0],
            on: self.schedules.iter().map(is_on(ends[0])).collect(),
        };
        cuts.windows(2).map(piece).collect()
    }

    /// `count` stretches of the past that matter alike at a moment, for what moves: from when on each is, and
    /// a moment in its middle, seconds. What matters is time in which a lamp shines, by what is left of its
    /// light; where lamps had shone for long, the beginning is the first. None where none shone.
    pub fn stretches(&self, moment: f32, count: usize) -> Vec<[f32; 2]> {
        let begin = self.begin();
        let step = (moment - begin) / FINE as f32;
        let at = |index: usize| begin + index as f32 * step;
        let decays: Vec<f32> =
            self.paints().flat_map(|paint| &paint.states).map(|state| state.decay).collect();
        let left = |ago: f32| decays.iter().map(|decay| decay.max(1e-6) * (-decay * ago).exp()).sum::<f32>();
        // For how long of a part a lamp shines, at most: however short a flash is, it counts.
        let lit = |index: usize| {
            let within = |[on, off]: &[f32; 2]| (off.min(at(index + 1)) - on.max(at(index))).max(0.0);
            let of_schedule = |schedule: &Schedule| schedule.on.iter().map(within).sum::<f32>();
            self.schedules.iter().map(of_schedule).fold(0.0, f32::max)
        };
        let weight = |index: usize| f64::from(lit(index) * left(moment - at(index) - 0.5 * step));
        let mut sums: Vec<f64> = vec![0.0];
        for index in 0..FINE {
            sums.push(sums[index] + weight(index));
        }
        let whole = sums[FINE];
        // Lamps that shone for long did so where all was in the beginning.
        let first = (self.start == Start::LitForLong).then_some([begin; 2]);
        // Not a number either.
        if step.is_nan() || step <= 0.0 || count == 0 {
            return Vec::new();
        }
        if whole <= 0.0 {
            return first.into_iter().collect();
        }
        let quantile = |share: f64| {
            let index = sums.partition_point(|sum| *sum < share * whole).max(1);
            let within = (share * whole - sums[index - 1]) / (sums[index] - sums[index - 1]);
            begin + (index as f32 - 1.0 + within as f32) * step
        };
        let share = |part: f64| quantile(part.max(1e-9) / count as f64);
        let count_of_later = count - usize::from(first.is_some() && count > 1);
        let later = (0..count_of_later).map(|index| [share(index as f64), share(index as f64 + 0.5)]);
        first.into_iter().chain(later).collect()
    }

    /// No stretch of time has more pieces.
    pub fn most_pieces(&self) -> usize {
        2 + self.switches().count()
    }

    fn switches(&self) -> impl Iterator<Item = f32> {
        self.schedules.iter().flat_map(|schedule| &schedule.on).flatten().copied()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use deepshade_glow::paint::PaintState;

    /// White paint that red light excites and that decays at these rates.
    pub fn paint(decays: &[f32]) -> Paint {
        let state = |decay: &f32| PaintState {
            decay: *decay,
            excitation: Vec3::new(0.4, 0.0, 0.0),
            emission: Vec3::new(1.0, 0.5, 0.25) * *decay,
        };
        Paint { name: "test".to_owned(), states: decays.iter().map(state).collect() }
    }

    /// All surfaces of that paint, dark at first, under lamps that all shine at these times.
    pub fn glow(decays: &[f32], on: &[[f32; 2]], moment: f32) -> Glow {
        Glow {
            surfaces: vec![GlowSurface::new(None, paint(decays))],
            medium: None,
            schedules: vec![Schedule { on: on.to_vec(), ..Schedule::default() }],
            start: Start::Share(0.0),
            moment,
        }
    }

    #[test]
    fn time_is_cut_where_lamps_are_switched() {
        let mut glow = glow(&[1.0], &[[1.0, 2.5]], 4.0);
        glow.schedules.insert(0, Schedule { lights: vec![3], on: vec![[0.0, f32::INFINITY]], sky: true });
        assert!(glow.sky_shines_on(0.0) && !glow.sky_shines_on(-1.0) && glow.schedule_of_sky() == Some(0));
        assert_eq!([glow.schedule_of(3), glow.schedule_of(0)], [0, 1]);
        let piece = |seconds, on: [bool; 2]| Piece { seconds, on: on.to_vec() };
        let expected = vec![piece(1.0, [true, false]), piece(1.5, [true, true]), piece(1.5, [true, false])];
        assert_eq!(glow.past(4.0), expected);
        assert_eq!(glow.between(1.5, 2.0), vec![piece(0.5, [true, true])]);
        for nothing in [glow.between(2.0, 2.0), glow.between(3.0, 2.0), glow.past(-1.0), glow.past(f32::NAN)]
        {
            assert_eq!(nothing, Vec::new());
        }
        glow.start = Start::LitForLong;
        assert_eq!(glow.past(0.0), vec![piece(FOR_LONG, [true; 2])]);
        assert!(glow.past(1e9).len() <= glow.most_pieces());
    }

    #[test]
    fn stretches_of_the_past_matter_alike() {
        let glow = glow(&[0.5], &[[1.0, 2.0], [4.0, 9.0]], 6.0);
        let stretches = glow.stretches(6.0, 8);
        assert!(stretches.is_sorted_by(|a, b| a[0] < a[1] && a[1] < b[0]), "{stretches:?}");
        let light = |from: f32, to: f32| {
            let pieces = glow.between(from, to);
            let ends = pieces.iter().scan(from, |at, piece| {
                *at += piece.seconds;
                Some((*at, piece))
            });
            let left = |ago: f32| (-0.5 * ago).exp();
            let of_piece = |(end, piece): (f32, &Piece)| {
                if piece.on[0] { left(6.0 - end) - left(6.0 - end + piece.seconds) } else { 0.0 }
            };
            ends.map(of_piece).sum::<f32>()
        };
        let whole = light(0.0, 6.0);
        for (index, [from, middle]) in stretches.iter().enumerate() {
            let to = stretches.get(index + 1).map_or(6.0, |next| next[0]);
            assert!((light(*from, to) * 8.0 / whole - 1.0).abs() < 0.02, "{from} to {to}");
            assert!((light(*from, *middle) * 16.0 / whole - 1.0).abs() < 0.03, "{from} to {middle}");
        }
        assert!(glow.stretches(0.5, 8).is_empty() && glow.stretches(f32::NAN, 8).is_empty());
    }

    #[test]
    fn a_flash_is_not_missed_and_long_light_was_there_in_the_beginning() {
        let mut flash = glow(&[1e-3], &[[3.000_1, 3.000_6]], 3000.0);
        let stretches = flash.stretches(3000.0, 2);
        assert!(
            stretches.iter().all(|[from, at]| (2.0..4.0).contains(from) && (2.0..4.0).contains(at)),
            "{stretches:?}"
        );
        flash.start = Start::LitForLong;
        let stretches = flash.stretches(3000.0, 2);
        assert_eq!((stretches.len(), stretches[0]), (2, [0.0; 2]));
        assert!((2.0..4.0).contains(&stretches[1][0]));
        let mut dark = glow(&[0.5], &[], 5.0);
        dark.start = Start::LitForLong;
        assert_eq!(dark.stretches(5.0, 8), [[0.0; 2]]);
    }

    #[test]
    fn a_scene_that_says_nothing_was_lit_for_a_second() {
        let scene = Scene::default();
        let glow = Glow::of(&scene);
        assert_eq!(
            glow.past(2.0),
            vec![Piece { seconds: 1.0, on: vec![true] }, Piece { seconds: 2.0, on: vec![false] }]
        );
        assert!(glow.past(-1.0).is_empty() && !glow.shines(0) && glow.before() == 0.0);
        assert_eq!(glow.surfaces[0].paint.name, USUAL);
    }

    #[test]
    fn materials_have_the_paint_of_their_name_or_of_all_others() {
        let mut glow = glow(&[1.0], &[], 0.0);
        let materials = ["wall", "paint", "floor", "paint", "paint"];
        let materials = materials.map(|name| Material::matte(name, Vec3::ONE)).to_vec();
        let scene = Scene { materials, ..Scene::default() };
        for name in ["paint", "wall", "paint#2"] {
            glow.surfaces.insert(0, GlowSurface::new(Some(name), paint(&[2.0])));
        }
        assert_eq!(glow.paints_of(&scene), [1, 2, 3, 0, 2].map(Some));
        glow.surfaces.pop();
        assert_eq!(glow.paints_of(&scene)[2], None);
    }
}
