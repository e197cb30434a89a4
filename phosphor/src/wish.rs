//! Key frames of one place that are set by hand, on a curve of its glow over time, and the material that
//! comes closest to them.
//!
//! Nothing here knows a window. A point of the curve is a moment and a brightness. What the hand does is
//! [`Wish::click`], [`Wish::grab`], [`Wish::drag`] and [`Wish::remove_at`].

mod answer;
mod light;

pub use answer::{Answer, WishError};
pub use light::{FRAMES, FrameLight};

use deepshade_shaders::colour::luminance;

/// How much higher the curve's area is than what is in it.
const ROOM: f64 = 1.25;
/// Brightness below which nothing is seen, W/m²/sr.
const LEAST: f64 = 1e-6;

/// A point of the curve's area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Time of the scene, seconds.
    pub seconds: f64,
    /// Luminance of radiance, W/m²/sr.
    pub brightness: f64,
}

/// How the place should look in a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyFrame {
    /// The frame, below [`FRAMES`].
    pub frame: usize,
    /// The moment that it was set at, seconds of the scene. On a curve of another length it has the frame
    /// next to it.
    pub seconds: f64,
    /// Luminance of radiance, W/m²/sr.
    pub brightness: f64,
    /// Linear RGB of luminance 1.
    pub hue: [f64; 3],
}

/// What is wanted of a place.
#[derive(Clone, Debug)]
pub struct Wish {
    light: FrameLight,
    /// What the place gives back by the material that it had, linear RGB radiance of each frame.
    before: Vec<[f64; 3]>,
    /// By their frames, one a frame at most.
    keys: Vec<KeyFrame>,
    /// The frame of the key that was touched last.
    selected: Option<usize>,
    is_held: bool,
    top: f64,
}

impl KeyFrame {
    /// Radiance, linear RGB.
    pub fn radiance(&self) -> [f64; 3] {
        self.hue.map(|part| part * self.brightness)
    }
}

impl Wish {
    /// Nothing yet, of a place under a light; `before` is what it gives back in each frame by the material
    /// that it has, linear RGB radiance.
    pub fn new(light: FrameLight, before: Vec<[f64; 3]>) -> Self {
        let mut wish = Self { light, before, keys: Vec::new(), selected: None, is_held: false, top: 0.0 };
        wish.fit(&[]);
        wish
    }

    /// The same under another light. Keys keep their moments as far as there are frames; of those at the same
    /// frame the later has the next one that is free.
    pub fn relight(&mut self, light: FrameLight, before: Vec<[f64; 3]>) {
        let selected = self.keys.iter().position(|key| Some(key.frame) == self.selected);
        let (mut free, count) = (0, self.keys.len());
        for (index, key) in self.keys.iter_mut().enumerate() {
            // Room is left for those after it.
            key.frame = light.frame(key.seconds).clamp(free, FRAMES - count + index);
            free = key.frame + 1;
        }
        self.selected = selected.map(|index| self.keys[index].frame);
        (self.light, self.before, self.is_held) = (light, before, false);
    }

    /// The place's light.
    pub const fn light(&self) -> &FrameLight {
        &self.light
    }

    /// What the place gave back before anything was wanted, linear RGB radiance of each frame.
    pub fn before(&self) -> &[[f64; 3]] {
        &self.before
    }

    /// All keys, in order.
    pub fn keys(&self) -> &[KeyFrame] {
        &self.keys
    }

    /// The key that was touched last.
    pub fn selected(&self) -> Option<&KeyFrame> {
        self.keys.iter().find(|key| Some(key.frame) == self.selected)
    }

    /// Where a key is.
    pub fn point(&self, key: &KeyFrame) -> CurvePoint {
        CurvePoint { seconds: self.light.seconds(key.frame), brightness: key.brightness }
    }

    /// Height of the curve's area, W/m²/sr.
    pub const fn top(&self) -> f64 {
        self.top
    }

    /// Makes the area as high as keys and curves ask for, but not while a key is held: it would flee.
    pub fn fit(&mut self, reached: &[[f64; 3]]) {
        if self.is_held {
            return;
        }
        let curves = self.before.iter().chain(reached).map(|colour| brightness(*colour));
        let highest = curves.chain(self.keys.iter().map(|key| key.brightness)).fold(0.0, f64::max);
        self.top = if highest > LEAST { ROOM * highest } else { 1.0 };
    }

    /// The key nearest to a point, within a reach of both axes.
    pub fn nearest(&self, at: CurvePoint, reach: CurvePoint) -> Option<&KeyFrame> {
        let away = |key: &KeyFrame| {
            let CurvePoint { seconds, brightness } = self.point(key);
            let along = (seconds - at.seconds) / reach.seconds;
            along.hypot((brightness - at.brightness) / reach.brightness)
        };
        let all = self.keys.iter().map(|key| (key, away(key))).filter(|(_, away)| *away <= 1.0);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(key, _)| key)
    }

    /// Selects the key at a point, or adds one. Whether one was added.
    pub fn click(&mut self, at: CurvePoint, reach: CurvePoint) -> bool {
        if let Some(frame) = self.nearest(at, reach).map(|key| key.frame) {
            self.selected = Some(frame);
            return false;
        }
        self.add(at, None)
    }

    /// Adds a key, of the colour of the one next to it where none is given. A frame that has one already
    /// keeps it. Whether it was added.
    pub fn add(&mut self, at: CurvePoint, colour: Option<[f64; 3]>) -> bool {
        let frame = self.light.frame(at.seconds);
        let Err(index) = self.place_of(frame) else { return false };
        let hue = colour.and_then(hue).unwrap_or_else(|| self.hue_at(frame));
        self.keys
            .insert(index, KeyFrame { frame, seconds: at.seconds, brightness: at.brightness.max(0.0), hue });
        self.selected = Some(frame);
        true
    }

    /// Takes hold of the key at a point, if one is there.
    pub fn grab(&mut self, at: CurvePoint, reach: CurvePoint) {
        if let Some(frame) = self.nearest(at, reach).map(|key| key.frame) {
            (self.selected, self.is_held) = (Some(frame), true);
        }
    }

    /// Moves the key that is held. It stays within the area, and out of frames that have a key. Whether it
    /// has moved.
    pub fn drag(&mut self, to: CurvePoint) -> bool {
        let held = self.selected.filter(|_| self.is_held);
        let Some(index) = held.and_then(|frame| self.place_of(frame).ok()) else { return false };
        let frame = self.light.frame(to.seconds);
        let held = self.keys[index].clone();
        let moved = match self.place_of(frame) {
            Ok(_) => held.clone(),
            Err(_) => KeyFrame { frame, seconds: to.seconds, ..held.clone() },
        };
        let key = KeyFrame { brightness: to.brightness.clamp(0.0, self.top), ..moved };
        if held == key {
            return false;
        }
        self.selected = Some(key.frame);
        self.keys[index] = key;
        self.keys.sort_by_key(|key| key.frame);
        true
    }

    /// Lets go of it.
    pub const fn release(&mut self) {
        self.is_held = false;
    }

    /// Removes the key at a point. Whether there was one.
    pub fn remove_at(&mut self, at: CurvePoint, reach: CurvePoint) -> bool {
        let frame = self.nearest(at, reach).map(|key| key.frame);
        frame.is_some_and(|frame| self.remove(frame))
    }

    /// Removes the key that was touched last. Whether there was one.
    pub fn remove_selected(&mut self) -> bool {
        self.selected.is_some_and(|frame| self.remove(frame))
    }

    /// Removes all keys. Whether there were any.
    pub fn clear(&mut self) -> bool {
        (self.selected, self.is_held) = (None, false);
        !std::mem::take(&mut self.keys).is_empty()
    }

    /// Gives the key that was touched last another colour, as bright as it is. Black is none. Whether it
    /// has changed.
    pub fn set_hue(&mut self, colour: [f64; 3]) -> bool {
        let index = self.selected.and_then(|frame| self.place_of(frame).ok());
        let (Some(index), Some(hue)) = (index, hue(colour)) else { return false };
        let changes = self.keys[index].hue != hue;
        self.keys[index].hue = hue;
        changes
    }

    fn remove(&mut self, frame: usize) -> bool {
        (self.selected, self.is_held) = (None, false);
        self.place_of(frame).is_ok_and(|index| {
            self.keys.remove(index);
            true
        })
    }

    /// Where the key of a frame is in the list, or would be.
    fn place_of(&self, frame: usize) -> Result<usize, usize> {
        self.keys.binary_search_by_key(&frame, |key| key.frame)
    }

    /// The colour of a new key: that of the one nearest in time, else of what the place gave back, else
    /// white.
    fn hue_at(&self, frame: usize) -> [f64; 3] {
        if let Some(next) = self.keys.iter().min_by_key(|key| key.frame.abs_diff(frame)) {
            return next.hue;
        }
        let brightest = self.before.iter().max_by(|a, b| brightness(**a).total_cmp(&brightness(**b)));
        brightest.and_then(|colour| hue(*colour)).unwrap_or([1.0; 3])
    }
}

/// The luminance of a linear RGB colour.
pub fn brightness(colour: [f64; 3]) -> f64 {
    luminance(colour.map(|part| part as f32)).into()
}

/// A colour of luminance 1; none of black.
fn hue(colour: [f64; 3]) -> Option<[f64; 3]> {
    let bright = brightness(colour);
    (bright.is_finite() && bright > LEAST).then(|| colour.map(|part| part / bright))
}

#[cfg(test)]
mod tests;
