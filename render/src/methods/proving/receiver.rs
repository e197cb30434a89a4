//! A plane and a thing beside it, both in view, and what of the thing the plane's points meet: the closed
//! forms of occlusion and of one bounce, over what the camera sees.

use super::{camera, gbuffer_of, hemisphere_mean, nearest, plane};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{Vec2, Vec3};

/// Rows of the image.
pub const HEIGHT: usize = 111;
/// Columns of the image.
pub const WIDTH: usize = 141;

/// Where a ray meets something, and the normal there.
pub type Met = Option<(Vec3, Vec3)>;

/// A plane, in camera space, that something is near to.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<F> {
    /// A point of the plane and its normal.
    pub plane: [Vec3; 2],
    /// Where a ray from a point first meets the thing.
    pub thing: F,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Which points of the plane face the side of the thing that the camera sees.
    pub is_measured: fn(Vec3) -> bool,
}

impl<F: Fn(Vec3, Vec3) -> Met> Receiver<F> {
    /// What the camera sees.
    pub fn gbuffer(&self) -> GBuffer {
        gbuffer_of(HEIGHT, WIDTH, |ray| self.seen(ray))
    }

    fn seen(&self, ray: Vec3) -> Met {
        nearest([(self.thing)(Vec3::ZERO, ray), plane(ray, self.plane[0], self.plane[1])])
    }

    fn shows(&self, point: Vec3) -> bool {
        let half = (0.5 * camera().vertical_fov).tan() * Vec2::new(WIDTH as f32 / HEIGHT as f32, 1.0);
        let inside = (point.truncate() / -point.z).abs().cmplt(half).all();
        let seen = self.seen(point.normalize());
        inside && seen.is_some_and(|(seen, _)| (seen.length() - point.length()).abs() < 1e-3)
    }

    /// The cosine-weighted share of directions from a point of the plane that meet, within the radius, what
    /// the camera sees of the thing.
    fn share_met(&self, at: Vec3) -> f32 {
        hemisphere_mean(self.plane[1], |direction| {
            let met = (self.thing)(at, direction).filter(|(met, _)| met.distance(at) < self.radius);
            f32::from(met.is_some_and(|(met, _)| self.shows(met)))
        })
    }

    /// Compares the first channel of an image with what the share of directions that meet the thing should
    /// make of it, at pixels of the plane.
    ///
    /// # Errors
    /// In words, where they differ by more than `within`.
    pub fn compare(&self, image: &Planes, expected: impl Fn(f32) -> f32, within: f32) -> Result<(), String> {
        let position = self.gbuffer().select(&[Attribute::Position]).expect("positions");
        let mut met = 0;
        for (y, x) in (3..HEIGHT).step_by(3).flat_map(|y| (3..WIDTH).step_by(7).map(move |x| (y, x))) {
            let at = Vec3::from_array([0, 1, 2].map(|channel| position.at(channel, y, x)));
            let on_plane = at.z < 0.0 && (at - self.plane[0]).dot(self.plane[1]).abs() < 1e-3;
            if !on_plane || !(self.is_measured)(at) {
                continue;
            }
            let share = self.share_met(at);
            let (found, expected) = (image.at(0, y, x), expected(share));
            if (found - expected).abs() > within {
                return Err(format!("{at}: {found}, integral {expected}"));
            }
            met += usize::from(share > 0.05);
        }
        assert!(met > 10, "{met} pixels meet the thing");
        Ok(())
    }
}

/// Where a ray from anywhere meets a plane.
pub fn crossing(origin: Vec3, ray: Vec3, point: Vec3, normal: Vec3) -> Met {
    let distance = (point - origin).dot(normal) / ray.dot(normal);
    (distance > 0.0).then_some((origin + distance * ray, normal))
}

/// A floor and a wall across it, one and a half metres high.
pub fn beside_wall() -> Receiver<impl Fn(Vec3, Vec3) -> Met> {
    let thing = |origin, ray| {
        let met = crossing(origin, ray, Vec3::new(0.0, 0.0, -4.2), Vec3::Z);
        met.filter(|(at, _)| at.y > -1.5 && at.y < 0.0)
    };
    Receiver { plane: [-1.5 * Vec3::Y, Vec3::Y], thing, radius: 1.2, is_measured: |_| true }
}

/// A plane that faces the camera, and a disk above it that does so, too.
pub fn below_disk() -> Receiver<impl Fn(Vec3, Vec3) -> Met> {
    let middle = Vec3::new(0.0, 0.0, -4.4);
    let thing =
        move |origin, ray| crossing(origin, ray, middle, Vec3::Z).filter(|(at, _)| at.distance(middle) < 0.5);
    Receiver { plane: [Vec3::new(0.0, 0.0, -5.0), Vec3::Z], thing, radius: 1.5, is_measured: |_| true }
}
