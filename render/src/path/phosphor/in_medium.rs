//! What a medium before a surface gives back of light that it kept, and lets through of the surface's (thesis, Figure 8.17). Its
//! radiance where nothing is seen through it is that of a surface of its paint; a thin layer has as much of that as it hides.

use super::Afterglow;
use crate::phosphor::paint::Paint;
use crate::scene::Medium;
use glam::Vec3;

/// Pieces of a way through the medium, in each of which it is alike.
const PIECES: u32 = 64;

/// What is seen along a ray whose surface, `reach` metres away, sends `surface`.
pub fn seen_through(
    (medium, paint): (&Medium, Option<&Paint>),
    (origin, direction, reach): (Vec3, Vec3, f32),
    surface: Vec3,
    sent: impl Fn(Vec3, &Paint) -> Vec3,
) -> Vec3 {
    let [from, to] = medium.seen_span(origin, direction, reach);
    let step = (to - from).max(0.0) / PIECES as f32;
    let (mut passes, mut sum) = (Vec3::ONE, Vec3::ZERO);
    for piece in 0..PIECES {
        let point = origin + direction * (from + (piece as f32 + 0.5) * step);
        let depth = medium.extinction() * medium.density.inside(point) * step;
        // Without loss where little is hidden.
        let hidden = Vec3::from(depth.to_array().map(|depth| -(-depth).exp_m1()));
        if let Some(paint) = paint.filter(|_| hidden != Vec3::ZERO) {
            sum += passes * hidden * sent(point, paint);
        }
        passes *= 1.0 - hidden;
    }
    sum + passes * surface
}

impl Afterglow<'_> {
    /// What a ray brings: from the surface, `reach` metres away, and from the medium before it.
    pub fn through_medium(&self, ray: (Vec3, Vec3, f32), surface: Vec3) -> Vec3 {
        let Some(medium) = self.scene.scene().medium.as_deref() else { return surface };
        let sent = |point: Vec3, paint: &Paint| paint.emission(&self.shares_in_medium(point, paint));
        seen_through((medium, self.glow.medium.as_ref()), ray, surface, sent)
    }
}
