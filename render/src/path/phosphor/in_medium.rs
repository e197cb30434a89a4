//! What a medium before a surface gives back of light that it kept, and lets through of the surface's
//! (thesis, Figure 8.17). Its radiance where nothing is seen through it is that of a surface of its paint; a
//! thin layer has as much of that as it hides.

use super::Afterglow;
use crate::path::medium::Segment;
use crate::scene::Medium;
use deepshade_glow::paint::Paint;
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

    /// Whether the medium keeps light.
    pub const fn is_in_medium(&self) -> bool {
        self.glow.medium.is_some()
    }

    /// One sample of the radiance that the medium sends against a segment of a ray, where it keeps light.
    /// `passes` says what of it goes through the medium to the segment's beginning.
    pub fn of_medium(&self, segment: &Segment, number: f32, passes: impl FnOnce(&Segment) -> Vec3) -> Vec3 {
        let (Some(paint), Some(medium)) = (&self.glow.medium, self.scene.scene().medium.as_deref()) else {
            return Vec3::ZERO;
        };
        let [from, to] = medium.seen_span(segment.origin, segment.direction, segment.length);
        if to <= from {
            return Vec3::ZERO;
        }
        let distance = from + number * (to - from);
        let point = segment.start_at(distance, self.scene);
        // What scatters light sends none of its own: deep inside, paths would add it up to more than the
        // paint has.
        let absorption = medium.absorption * medium.density.inside(point);
        if absorption == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let sent = paint.emission(&self.shares_in_medium(point, paint));
        (to - from) * absorption * sent * passes(&Segment { length: distance, ..*segment })
    }
}

#[cfg(test)]
mod tests {
    use crate::bvh::TracedScene;
    use crate::path::proving::{MeanWithError, quad};
    use crate::path::{FullPath, Shot};
    use crate::scene::glow::Start;
    use crate::scene::glow::tests::glow;
    use crate::scene::{Bounds, Camera, Density, Gloss, Material, Medium, Scene};
    use glam::Vec3;

    /// A wall, black and without paint, behind a metre of fog that is full of light and scatters half of what
    /// it takes, or none.
    fn wall_in_fog(scatters: bool) -> TracedScene {
        let mut full = glow(&[0.3], &[], 0.0);
        full.start = Start::Share(1.0);
        full.medium = full.surfaces.pop().map(|surface| surface.paint);
        let density = Density::Within(Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) });
        let half = Vec3::splat(0.45);
        let [absorption, scattering] = if scatters { [half, half] } else { [2.0 * half, Vec3::ZERO] };
        let corners = [(-9., -9.), (9., -9.), (9., 9.), (-9., 9.)].map(|(x, y)| Vec3::new(x, y, -0.6));
        TracedScene::new(Scene {
            meshes: vec![quad(corners)].into(),
            materials: vec![Material { gloss: Gloss::None, ..Material::matte("black", Vec3::ZERO) }],
            medium: Some(Medium::new(absorption, scattering, 0.0, density).expect("fog").into()),
            glow: Some(full.into()),
            ..Scene::default()
        })
        .expect("a wall")
    }

    fn seen(scene: &TracedScene) -> MeanWithError {
        // So narrow that all rays are alike.
        let ahead = Camera::look_at(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO);
        let camera = Camera { vertical_fov: 1e-3, ..ahead };
        let shot = Shot::new(scene, &camera, [1, 1], f32::INFINITY);
        MeanWithError::of(&FullPath::new(&shot), &shot, 4096)
    }

    #[test]
    fn paths_find_light_that_the_medium_kept() {
        let emission = Vec3::new(1.0, 0.5, 0.25) * 0.3;
        let expected = emission * (1.0 - (-0.9f32).exp());
        let found = seen(&wall_in_fog(false));
        found.proves("phosphor/medium", expected);
        found.refutes("phosphor/medium", 1.02 * expected);
        // Half of it absorbs, and what is scattered adds light of the fog's other parts, never more than
        // there is inside.
        let scattered = seen(&wall_in_fog(true)).mean;
        assert!(scattered.cmpgt(0.55 * expected).all() && scattered.cmplt(emission).all(), "{scattered}");
    }
}
