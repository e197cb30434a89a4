//! A table before a wall in the light of two panels, for captures: what every scene of the two families of
//! neutral things has in common, so that the arrangement of the things is all that changes. The panels are
//! soft, and of two colours, so that light tells how a surface is turned.

use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::block;
use crate::scene::{Material, MaterialId};
use glam::{Quat, Vec2, Vec3};

/// Half of the area that things stand on, metres; its middle is the origin.
const AREA: Vec2 = Vec2::new(0.5, 0.42);
/// Reflectance of table and wall.
const GREY: f32 = 0.65;

/// A panel that shines on the origin.
struct Panel {
    /// Its middle, metres.
    place: Vec3,
    /// Its edge, metres.
    edge: f32,
    /// Radiance.
    radiance: Vec3,
}

/// A warm one on the right and a cool, weaker one on the left. White surfaces on the table that face the
/// first have a radiance of about 0.9.
const PANELS: [Panel; 2] = [
    Panel { place: Vec3::new(1.3, 1.7, 1.1), edge: 1.0, radiance: Vec3::new(21.5, 19.5, 17.0) },
    Panel { place: Vec3::new(-1.5, 1.1, 0.7), edge: 0.6, radiance: Vec3::new(7.5, 10.0, 13.0) },
];

/// Puts table, wall and panels into the scene, and things on the table, none into another. `thing` makes one
/// of any size.
pub fn build(thing: fn(&mut Random) -> Shape, builder: &mut SceneBuilder, random: &mut Random) {
    let grey = builder.material(Material::matte("grey", Vec3::splat(GREY)));
    builder.add("table", grey, block(Vec3::new(-1.8, -0.04, -0.92), Vec3::new(1.8, 0.0, 1.6)));
    builder.add("wall", grey, block(Vec3::new(-1.8, 0.0, -0.92), Vec3::new(1.8, 0.8, -0.88)));
    for panel in &PANELS {
        let emission = panel.radiance;
        let shining = builder.material(Material { emission, ..Material::matte("panel", Vec3::ZERO) });
        builder.add("panel", shining, panel.shape());
    }
    let mut shapes = ShapesByMaterial::new((0..4).map(|_| neutral(builder, random)).collect());
    for (at, radius) in places(random) {
        let turn = Quat::from_rotation_y(random.angle());
        shapes.put(seated(&thing(random), turn, radius).moved(at.x, 0.0, at.y), random);
    }
    shapes.add_to(builder, "things");
}

impl Panel {
    fn shape(&self) -> Shape {
        let half = 0.5 * self.edge;
        let mut shape = Shape::default();
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
        shape.polygon(&corners.map(|(x, z)| Vec3::new(x, 0.0, -z)));
        shape.aimed(-self.place.normalize()).at(self.place)
    }
}

/// A shape that was laid on one of its sides.
pub fn laid(shape: Shape, random: &mut Random) -> Shape {
    shape.turned(random.angle()).pitched(0.5 * std::f32::consts::PI)
}

/// A matte material of a light grey.
fn neutral(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    builder.material(Material::matte("neutral", Vec3::splat(random.within(0.55, 0.75))))
}

/// Where things stand, and how much room each has: middles and radii of circles that do not meet.
fn places(random: &mut Random) -> Vec<(Vec2, f32)> {
    let count = random.count(9, 14);
    let mut taken: Vec<(Vec2, f32)> = Vec::new();
    for _ in 0..40 * count {
        let radius = if taken.len() < 4 { random.within(0.1, 0.16) } else { random.within(0.05, 0.1) };
        let free = AREA - Vec2::splat(radius);
        let at = Vec2::new(random.within(-free.x, free.x), random.within(-free.y, free.y));
        if taken.len() < count && taken.iter().all(|(other, reach)| at.distance(*other) > radius + reach) {
            taken.push((at, radius));
        }
    }
    taken
}

/// A shape turned, scaled to a circle's room, at most twice as high as that is wide, and put onto y = 0.
fn seated(shape: &Shape, turn: Quat, radius: f32) -> Shape {
    let turned = shape.clone().rotated(turn);
    let (low, high) = turned
        .positions
        .iter()
        .fold((Vec3::MAX, Vec3::MIN), |(low, high), position| (low.min(*position), high.max(*position)));
    let middle = 0.5 * (low + high);
    let reach = turned.positions.iter().map(|position| (position - middle).with_y(0.0).length());
    let widest = reach.fold(0.0, f32::max).max(0.25 * (high.y - low.y));
    let scale = radius / widest;
    turned.moved(-middle.x, -low.y, -middle.z).scaled(scale, scale, scale)
}
