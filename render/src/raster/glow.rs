//! What of a scene keeps light, on the GPU: its paints, the time that passes from frame to frame, and the
//! pass in which states move on by it.

use super::light::shadow_sampler;
use super::world::World;
use crate::raster::groups;
use crate::scene::Scene;
use crate::scene::glow::{Glow, GlowSurface, Piece};
use crate::screen::{Device, MethodStep, PassDispatch};
use deepshade_glow::paint::{PaintFactors, PaintState as State};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::PaintState;
use half::f16;

/// Turns that the loops of an invocation take at most, but for a few: lavapipe (Mesa 22.3) ends them after
/// 65,535 in all.
const MOST_TURNS: usize = 48_000;
/// Points of a way to a lamp at which a medium is looked up: `shared/light_dimmed.wgsl`.
const POINTS: usize = 32;

/// Numbers of a keeper of light in a list of these: what it is of, and what it has of a paint's numbers where
/// any paint has textures.
const TEXTURED_WORDS: usize = 5;

/// Paints and time. Buffers of time are as `shared/glow_time.wgsl` says.
#[derive(Debug)]
pub struct GlowOnGpu {
    glow: Glow,
    /// The schedule of each lamp.
    schedules: Vec<usize>,
    /// The moment of the frame before.
    before: Option<f32>,
    /// `[paints, states]` records.
    pub paints: wgpu::Buffer,
    /// The time since the frame before. In the first frame, and where time has gone back, it is all of the
    /// past.
    pub since: wgpu::Buffer,
    /// All of the past.
    pub past: wgpu::Buffer,
}

impl GlowOnGpu {
    /// That of a scene, for whose environment so many lamps stand.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &wgpu::Device, scene: &Scene, of_sky: usize) -> Result<Self, GpuError> {
        let glow = Glow::of(scene).clone();
        let lamps = (0..scene.lights.len()).map(|light| glow.schedule_of(light));
        let schedules: Vec<usize> =
            lamps.chain(glow.schedule_of_sky().into_iter().cycle().take(of_sky)).collect();
        let paints = gpu::uniforms(device, "frame.paints", &records(&glow))?;
        let nothing = vec![0.0f32; 1 + schedules.len() + glow.most_pieces() * (1 + glow.schedules.len())];
        let since = gpu::storage(device, "frame.glow_since", &nothing)?;
        let past = gpu::storage(device, "frame.glow_past", &nothing)?;
        Ok(Self { glow, schedules, before: None, paints, since, past })
    }

    /// Says which moment the next frame shows, seconds.
    pub fn set(&mut self, queue: &wgpu::Queue, moment: f32) {
        let past = self.time(true, &self.glow.past(moment));
        let since = match self.before.filter(|before| moment >= *before) {
            Some(before) => self.time(false, &self.glow.between(before.max(self.glow.begin()), moment)),
            None => past.clone(),
        };
        queue.write_buffer(&self.past, 0, bytemuck::cast_slice(&past));
        queue.write_buffer(&self.since, 0, bytemuck::cast_slice(&since));
        self.before = Some(moment);
    }

    /// Has the next frame go through all of the past again, since what is known of it is no longer true.
    pub const fn forget(&mut self) {
        self.before = None;
    }

    /// Replaces the paints, as if they had always been these. Whether there is room: only their numbers may
    /// differ, not what has a paint, how many states they have at most, or when lamps shine.
    pub fn repaint(&mut self, queue: &wgpu::Queue, glow: &Glow) -> bool {
        let is_same = glow.surfaces == self.glow.surfaces && glow.medium == self.glow.medium;
        if !is_laid_out_alike(glow, &self.glow) {
            return false;
        }
        if !is_same {
            queue.write_buffer(&self.paints, 0, bytemuck::cast_slice(&records(glow)));
            self.glow = glow.clone();
            self.forget();
        }
        true
    }

    /// Says that the next frame goes from one moment to another only, from the first state of all on where it
    /// is the `first`.
    pub fn set_stretch(&mut self, queue: &wgpu::Queue, is_first: bool, [from, to]: [f32; 2], moment: f32) {
        let pieces = if is_first { self.glow.past(to) } else { self.glow.between(from, to) };
        queue.write_buffer(&self.since, 0, bytemuck::cast_slice(&self.time(is_first, &pieces)));
        queue.write_buffer(&self.past, 0, bytemuck::cast_slice(&self.time(true, &self.glow.past(moment))));
        self.before = Some(to);
    }

    /// What it is of.
    pub const fn glow(&self) -> &Glow {
        &self.glow
    }

    /// States that each paint has room for.
    pub fn states(&self) -> usize {
        self.glow.most_states()
    }

    /// The constants of passes that move states on.
    pub fn constants(&self) -> [(&'static str, u32); 4] {
        [
            ("SCHEDULES", self.glow.schedules.len() as u32),
            ("PIECES", self.glow.most_pieces() as u32),
            ("STATES", self.states() as u32),
            self.paint_states(),
        ]
    }

    /// Numbers of each keeper, as [`keeper_words`] has them.
    pub fn words(&self) -> (&'static str, u32) {
        ("KEEPER_WORDS", words(&self.glow) as u32)
    }

    /// The length of the list of paints.
    pub fn paint_states(&self) -> (&'static str, u32) {
        ("PAINT_STATES", (self.glow.paints().count().max(1) * self.states()) as u32)
    }

    /// The passes of such a shader that move the states of `count` keepers on: several, one after the other,
    /// where one would take too many turns.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn moving_on(
        &self,
        device: &Device,
        (shader, constants): (Shader, &[(&'static str, u32)]),
        euler: u32,
        resources: &[(u32, wgpu::BindingResource<'_>)],
        (count, states): (usize, &wgpu::Buffer),
    ) -> Result<Vec<MethodStep>, GpuError> {
        let step = |[first, pieces]: [u32; 2]| {
            let own = [("EULER", euler), ("FIRST_PIECE", first), ("PIECES_AT_ONCE", pieces)];
            let pass = device.pass(shader, &[constants, &own[..]].concat())?;
            let pass = pass.bind_at(device, resources.iter().cloned())?;
            Ok(MethodStep {
                step: PassDispatch { pass, workgroups: groups(count).into() },
                writes: Vec::new(),
            })
        };
        let mut steps =
            rounds(&self.glow, euler).into_iter().map(step).collect::<Result<Vec<_>, GpuError>>()?;
        if let Some(last) = steps.last_mut() {
            last.writes.push(states.clone());
        }
        Ok(steps)
    }

    /// How many moments of the past a dispatch may look at, in light through a medium or not.
    pub fn samples_at_once(&self, is_dimmed: bool) -> u32 {
        let per_lamp = if is_dimmed { 1 + POINTS } else { 1 };
        let per_sample = self.states() * (1 + self.glow.most_pieces() + self.schedules.len() * per_lamp);
        (MOST_TURNS / per_sample).max(1) as u32
    }

    /// A stretch of time as passes read it; what is not needed of its room passes in no time.
    fn time(&self, anew: bool, pieces: &[Piece]) -> Vec<f32> {
        let number = |is: bool| f32::from(u8::from(is));
        let mut time = vec![number(anew)];
        time.extend(self.schedules.iter().map(|schedule| *schedule as f32));
        for piece in pieces {
            time.push(piece.seconds);
            time.extend(piece.on.iter().map(|on| number(*on)));
        }
        let stride = 1 + self.glow.schedules.len();
        time.resize(1 + self.schedules.len() + self.glow.most_pieces() * stride, 0.0);
        time
    }
}

/// What keeps light, on the GPU, and the states that it has.
#[derive(Clone, Copy)]
pub struct Keeping<'a> {
    /// Steps of Euler's scheme for each time in which no lamp is switched; without any the step is exact.
    pub euler: u32,
    /// The pass that moves states on, in a clear scene and in one whose medium dims light.
    pub shaders: [Shader; 2],
    /// What the pass reads of what keeps light.
    pub keepers: [&'a wgpu::Buffer; 2],
    /// How many of them there are, an invocation each.
    pub count: usize,
    /// `[2, count, states]`: excited shares, and what rounding leaves of their changes.
    pub states: &'a wgpu::Buffer,
}

impl Keeping<'_> {
    /// The passes that move all states on by the time since the frame before.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn steps(&self, device: &Device, world: &World) -> Result<Vec<MethodStep>, GpuError> {
        let Self { euler, shaders, keepers: [first, second], count, states } = *self;
        let (shader, mut constants) = world.dimmed(shaders);
        constants.push(world.glow.words());
        let sampler = shadow_sampler(device);
        let own = [&world.glow.paints, first, second, &world.geometry.posed, &world.glow.since];
        let own = own.map(|buffer| buffer.as_entire_binding()).into_iter();
        let resources = own.chain(world.lamps(&sampler)).chain([states.as_entire_binding()]);
        let resources: Vec<_> = (0..).zip(resources.chain(world.dimming())).collect();
        world.glow.moving_on(device, (shader, &constants), euler, &resources, (count, states))
    }
}

/// What passes read of a keeper of light: a number of what it is part of, and, where any paint has textures,
/// what it has of its paint's numbers, as halves: of excitation by red, green and blue and of decay, of
/// radiance's red, green and blue, nothing.
pub fn keeper_words(
    glow: &Glow,
    of: u32,
    factors: impl FnOnce() -> Option<PaintFactors>,
) -> impl Iterator<Item = u32> {
    let mut all = [of, 0, 0, 0, 0];
    if glow.has_textures() {
        let factors = factors().unwrap_or(PaintFactors::ONE);
        let (rates, radiance) = (factors.excitation.extend(factors.decay), factors.of_radiance());
        let two = |low: f32, high: f32| {
            let [low, high] = [low, high].map(|number| u32::from(f16::from_f32(number).to_bits()));
            high << 16 | low
        };
        all = [
            of,
            two(rates.x, rates.y),
            two(rates.z, rates.w),
            two(radiance.x, radiance.y),
            two(radiance.z, 0.0),
        ];
    }
    all.into_iter().take(words(glow))
}

fn words(glow: &Glow) -> usize {
    if glow.has_textures() { TEXTURED_WORDS } else { 1 }
}

/// The pieces of time that each dispatch of a pass that moves states on goes through, by so many steps of
/// Euler's scheme each: from which one on, and how many.
fn rounds(glow: &Glow, euler: u32) -> Vec<[u32; 2]> {
    let per_piece = glow.most_states() * (1 + glow.schedules.len() + euler as usize);
    let count = (MOST_TURNS / per_piece).max(1);
    (0..glow.most_pieces()).step_by(count).map(|first| [first as u32, count as u32]).collect()
}

/// Whether buffers and passes of one suit the other.
fn is_laid_out_alike(glow: &Glow, other: &Glow) -> bool {
    let laid_out = |surface: &GlowSurface| (surface.material.clone(), surface.textures.clone());
    let names = glow.surfaces.iter().map(laid_out).eq(other.surfaces.iter().map(laid_out));
    let room = |glow: &Glow| (glow.most_states(), glow.medium.is_some());
    names && room(glow) == room(other) && (&glow.schedules, glow.start) == (&other.schedules, other.start)
}

/// All paints, filled up with states that stay dark.
fn records(glow: &Glow) -> Vec<PaintState> {
    let before = glow.before();
    let record = |state: &State| PaintState {
        rates: state.excitation.extend(state.decay).to_array(),
        emission: state.emission.extend(before).to_array(),
    };
    let of_paint = |own: &[State]| {
        let mut records: Vec<PaintState> = own.iter().map(record).collect();
        records.resize(glow.most_states(), bytemuck::Zeroable::zeroed());
        records
    };
    let mut all: Vec<PaintState> = glow.paints().flat_map(|paint| of_paint(&paint.states)).collect();
    // A binding holds at least one.
    all.resize(all.len().max(glow.most_states()), bytemuck::Zeroable::zeroed());
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::glow::Schedule;
    use crate::scene::glow::tests::glow;

    #[test]
    fn paints_are_replaced_where_only_their_numbers_differ() {
        let before = glow(&[0.1, 0.2], &[[0.0, 1.0]], 2.0);
        let alike = |change: fn(&mut Glow)| {
            let mut other = before.clone();
            change(&mut other);
            is_laid_out_alike(&other, &before)
        };
        assert!(
            alike(|glow| glow.surfaces[0].paint.states[1].decay = 7.0) && alike(|glow| glow.moment = 5.0)
        );
        assert!(!alike(|glow| glow.surfaces[0].material = Some("wall".to_owned())));
        assert!(!alike(|glow| glow.surfaces[0].paint.states.truncate(1)));
        assert!(!alike(|glow| glow.medium = Some(glow.surfaces[0].paint.clone())));
        assert!(!alike(|glow| glow.schedules[0].on[0][1] = 2.0));
        assert!(!alike(|glow| glow.start = crate::scene::glow::Start::LitForLong));
    }

    /// Rounds follow one another through all pieces, and none takes too many turns.
    #[test]
    fn rounds_are_all_pieces_and_short() {
        let flashes: Vec<[f32; 2]> = (0..400u16).map(|at| [f32::from(at), f32::from(at) + 0.5]).collect();
        for (decays, euler) in [(&[0.1; 4][..], 4096), (&[0.1], 4096), (&[0.1; 2], 7), (&[0.1], 0)] {
            let mut glow = glow(decays, &flashes, 9.0);
            glow.schedules.push(Schedule::default());
            let rounds = rounds(&glow, euler);
            let mut next = 0;
            for [first, count] in &rounds {
                assert_eq!(*first, next);
                next += count;
                let turns = decays.len() * *count as usize * (3 + euler as usize);
                assert!(turns < 65_535, "{turns}");
            }
            assert!(next as usize >= glow.most_pieces(), "{next}");
            assert_eq!(rounds.len() > 1, euler == 4096, "{}", rounds.len());
        }
    }
}
