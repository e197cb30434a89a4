//! Things to ride on and to play with: lofted bodies on wheels, springs and turntables.

use super::playground::Piece;
use super::random::Random;
use super::shape::Shape;
use super::solids::{bevelled_box, cuboid, cylinder, frustum, pipe, sphere, torus};
use super::surface::sheet;
use super::sweep::{curve, lathe, rod, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A body along z around the origin, `half(t)` its half width and height and `rise(t)` the height of its
/// middle at the share `t` of its length; sections are rounded squares, the ends are closed.
pub fn loft(length: f32, rings: usize, half: impl Fn(f32) -> Vec2, rise: impl Fn(f32) -> f32) -> Shape {
    let sides = 28;
    let rounded = |value: f32| value.signum() * value.abs().sqrt();
    // One ring more at each end, drawn together to a point, closes the body.
    let total = rings + 2;
    let body = sheet(sides, total, |u, v| {
        let ring = (v * total as f32).round();
        let t = ((ring - 1.0) / rings as f32).clamp(0.0, 1.0);
        let open = if ring == 0.0 || ring == total as f32 { 0.0 } else { 1.0 };
        // The seam is put where it began, exactly.
        let around =
            Vec2::from_angle(-TAU * (u * sides as f32).round().rem_euclid(sides as f32) / sides as f32);
        let section = Vec2::new(rounded(around.x), rounded(around.y)) * half(t) * open;
        Vec3::new(section.x, section.y + rise(t), length * (t - 0.5))
    });
    body.welded().smoothed()
}

/// A tyre around the y axis with treads.
pub fn tyre(radius: f32) -> Shape {
    let section = [
        (0.62, -0.26),
        (0.9, -0.3),
        (1.0, -0.22),
        (1.0, 0.22),
        (0.9, 0.3),
        (0.62, 0.26),
        (0.8, 0.2),
        (0.84, 0.0),
        (0.8, -0.2),
        (0.62, -0.26),
    ];
    let body = lathe(&section.map(|(x, y)| Vec2::new(x * radius, y * radius)), 40);
    let tread = cuboid(0.06 * radius, 0.2 * radius, 0.1 * radius);
    body + (tread.clone().moved(radius, -0.24 * radius, 0.0)
        + tread.turned(0.1).moved(0.99 * radius, 0.04 * radius, 0.1 * radius))
    .around(26)
}

/// A wheel with its axle along x, its middle at the origin.
fn wheel(radius: f32) -> Shape {
    let spokes = rod(Vec3::ZERO, Vec3::X * 0.7 * radius, 0.07 * radius, 8).around(6);
    (tyre(radius) + spokes + cylinder(0.2 * radius, 0.3 * radius, 16).moved(0.0, -0.15 * radius, 0.0))
        .rolled(0.5 * PI)
}

/// A train of an engine and a wagon or two.
pub fn train(random: &mut Random) -> Piece {
    let boiler = random.within(0.2, 0.27);
    let hull = loft(0.9, 20, |t| Vec2::new(boiler, boiler) * (0.75 + 0.25 * (PI * t).sin()), |_| 0.55)
        .moved(0.0, 0.0, 0.55);
    let cab = bevelled_box(0.6, 0.5, 0.03, 0.01).at_each([0.05, -0.4].map(|z| Vec3::new(0.0, 0.35, z)))
        + bevelled_box(0.03, 0.5, 0.45, 0.01).at_each([-0.29, 0.29].map(|x| Vec3::new(x, 0.35, -0.17)))
        + rod(Vec3::ZERO, Vec3::Y * 0.45, 0.018, 8).at_each(
            [(0.27, 0.03), (-0.27, 0.03), (0.27, -0.38), (-0.27, -0.38)].map(|(x, z)| Vec3::new(x, 0.84, z)),
        );
    let roof = loft(0.62, 10, |_| Vec2::new(0.36, 0.04), |_| 1.31).moved(0.0, 0.0, -0.18);
    let chimney = lathe(
        &[
            (0.0, 0.0),
            (0.07, 0.0),
            (0.05, 0.1),
            (0.06, 0.26),
            (0.11, 0.34),
            (0.085, 0.34),
            (0.05, 0.26),
            (0.0, 0.2),
        ]
        .map(|(x, y)| Vec2::new(x, y)),
        24,
    );
    let top = 0.55 + 0.9 * boiler;
    let domes = chimney.moved(0.0, top, 0.8)
        + sphere(0.1, 20).moved(0.0, top - 0.08, 0.45)
        + frustum(0.09, 0.11, 0.08, 24).pitched(0.5 * PI).moved(0.0, 0.62, 0.98);
    let frame = bevelled_box(0.5, 0.1, 1.6, 0.02).moved(0.0, 0.26, 0.28);
    let wagon_z = -0.95;
    let wagon = bevelled_box(0.6, 0.06, 0.7, 0.015).moved(0.0, 0.26, wagon_z)
        + bevelled_box(0.6, 0.3, 0.04, 0.01)
            .at_each([wagon_z - 0.33, wagon_z + 0.33].map(|z| Vec3::new(0.0, 0.3, z)))
        + bevelled_box(0.04, 0.3, 0.66, 0.01).at_each([-0.28, 0.28].map(|x| Vec3::new(x, 0.3, wagon_z)));
    let axles = [(0.85, 0.17), (0.5, 0.17), (-0.1, 0.24), (wagon_z - 0.2, 0.17), (wagon_z + 0.2, 0.17)];
    let wheels =
        axles.iter().flat_map(|(z, radius)| [-0.33, 0.33].map(|x| wheel(*radius).moved(x, *radius, *z)));
    let rods = rod(Vec3::new(-0.36, 0.17, 0.85), Vec3::new(-0.36, 0.2, -0.1), 0.02, 8)
        + rod(Vec3::new(0.36, 0.17, 0.85), Vec3::new(0.36, 0.2, -0.1), 0.02, 8);
    let hook = rod(Vec3::new(0.0, 0.3, -0.5), Vec3::new(0.0, 0.29, -0.62), 0.03, 10);
    Piece {
        steel: rods
            + hook
            + axles
                .iter()
                .map(|(z, radius)| {
                    rod(Vec3::new(-0.33, *radius, *z), Vec3::new(0.33, *radius, *z), 0.025, 10)
                })
                .collect(),
        wood: frame,
        painted: vec![hull, cab, roof, domes, wagon, wheels.collect()],
    }
}

/// Animals on coil springs, and a seesaw between them.
pub fn springs(random: &mut Random) -> Piece {
    let mut piece = Piece::default();
    for (x, turn) in [(-0.65, 0.3), (0.65, -0.4)] {
        let turns = random.count(5, 7);
        let coil: Vec<Vec3> = (0..=turns * 12)
            .map(|i| i as f32 / 12.0)
            .map(|t| {
                Vec3::new(0.12 * (TAU * t).cos(), 0.03 + 0.34 * t / turns as f32, 0.12 * (TAU * t).sin())
            })
            .collect();
        piece.steel.join(
            tube(&coil, 0.02, 8).moved(x, 0.0, -0.4)
                + cylinder(0.2, 0.03, 24).moved(x, 0.0, -0.4)
                + cylinder(0.15, 0.03, 20).moved(x, 0.37, -0.4),
        );
        let tall = random.within(0.15, 0.2);
        let body = loft(
            0.75,
            18,
            |t| Vec2::new(0.13, tall) * (0.35 + 0.75 * (PI * t).sin()),
            |t| 0.1 * (2.0 * t - 1.0).powi(2),
        );
        let head = loft(0.34, 12, |t| Vec2::new(0.09, 0.1) * (0.4 + 0.7 * (PI * t).sin()), |t| -0.06 * t)
            .pitched(0.3);
        let ears = frustum(0.035, 0.0, 0.12, 10).at_each([-0.05, 0.05].map(|x| Vec3::new(x, 0.38, 0.38)));
        let neck = tube(
            &curve(&[Vec3::new(0.0, 0.05, 0.25), Vec3::new(0.0, 0.2, 0.34), Vec3::new(0.0, 0.3, 0.42)], 4),
            0.08,
            14,
        );
        let grip = rod(Vec3::new(-0.22, 0.27, 0.3), Vec3::new(0.22, 0.27, 0.3), 0.018, 10);
        let animal = body + head.moved(0.0, 0.32, 0.46) + ears + neck;
        piece.painted.push(animal.moved(0.0, 0.4 + tall, 0.0).turned(turn).moved(x, 0.0, -0.4));
        piece.steel.join(grip.moved(0.0, 0.4 + tall, 0.0).turned(turn).moved(x, 0.0, -0.4));
    }
    let tilt = random.pick(&[-0.2, 0.2]);
    let plank = bevelled_box(2.1, 0.05, 0.22, 0.012).rolled(tilt).moved(0.0, 0.32, 0.7);
    let stand =
        frustum(0.2, 0.1, 0.28, 16) + rod(Vec3::new(0.0, 0.3, -0.16), Vec3::new(0.0, 0.3, 0.16), 0.04, 12);
    let handle = tube(
        &curve(
            &[
                Vec3::new(0.0, 0.05, -0.09),
                Vec3::new(0.0, 0.27, -0.09),
                Vec3::new(0.0, 0.27, 0.09),
                Vec3::new(0.0, 0.05, 0.09),
            ],
            4,
        ),
        0.014,
        8,
    );
    piece.steel.join(
        stand.moved(0.0, 0.0, 0.7)
            + handle.at_each([-0.7, 0.7].map(|x| Vec3::X * x)).rolled(tilt).moved(0.0, 0.32, 0.7),
    );
    piece.wood.join(plank);
    piece
}

/// A turntable with seats and bars.
pub fn roundabout(random: &mut Random) -> Piece {
    let radius = random.within(0.85, 1.05);
    let seats = random.count(4, 6);
    let plate = lathe(
        &[(0.0, 0.08), (1.0, 0.08), (1.02, 0.11), (1.0, 0.14), (0.0, 0.14)]
            .map(|(x, y)| Vec2::new(x * radius, y)),
        48,
    );
    let bar = tube(
        &curve(
            &[
                Vec3::new(0.06, 0.75, 0.0),
                Vec3::new(0.6 * radius, 0.78, 0.0),
                Vec3::new(0.93 * radius, 0.7, 0.0),
                Vec3::new(0.95 * radius, 0.13, 0.0),
            ],
            6,
        ),
        0.02,
        10,
    );
    let hub = cylinder(0.08, 0.8, 20) + sphere(0.1, 20).moved(0.0, 0.72, 0.0) + cylinder(0.3, 0.09, 24);
    let wheel = torus(0.25, 0.02, 36, 10).moved(0.0, 0.62, 0.0);
    let seat = loft(0.36, 10, |t| Vec2::new(0.11, 0.03 + 0.01 * (PI * t).sin()), |_| 0.42).moved(
        0.62 * radius,
        0.0,
        0.0,
    );
    let post = cylinder(0.025, 0.28, 10).moved(0.62 * radius, 0.13, 0.0);
    let back = loft(0.36, 10, |_| Vec2::new(0.02, 0.1), |_| 0.56).moved(0.76 * radius, 0.0, 0.0);
    let turned = PI / seats as f32;
    Piece {
        steel: bar.around(seats) + hub + wheel + post.around(seats).turned(turned),
        painted: vec![plate, (seat + back).around(seats).turned(turned)],
        ..Piece::default()
    }
}

/// Something small that lies about.
pub fn toy(random: &mut Random) -> Shape {
    let turn = random.angle();
    let toy = match random.count(0, 3) {
        0 => {
            let bucket = lathe(
                &[
                    (0.0, 0.0),
                    (0.09, 0.0),
                    (0.13, 0.2),
                    (0.14, 0.21),
                    (0.125, 0.21),
                    (0.085, 0.01),
                    (0.0, 0.01),
                ]
                .map(|(x, y)| Vec2::new(x, y)),
                28,
            );
            let handle: Vec<Vec3> = (0..=12)
                .map(|i| PI * i as f32 / 12.0)
                .map(|a| Vec3::new(0.13 * a.cos(), 0.2 + 0.12 * a.sin(), 0.0))
                .collect();
            bucket + tube(&handle, 0.006, 6)
        }
        1 => {
            let hull = loft(0.5, 16, |t| Vec2::new(0.13, 0.07) * (0.6 + 0.45 * (PI * t).sin()), |_| 0.17);
            let top = loft(0.26, 10, |t| Vec2::new(0.1, 0.05) * (0.6 + 0.4 * (PI * t).sin()), |_| 0.27);
            let places = [(0.13, 0.15), (-0.13, 0.15), (0.13, -0.15), (-0.13, -0.15)]
                .map(|(x, z)| Vec3::new(x, 0.08, z));
            hull + top + wheel(0.08).at_each(places)
        }
        2 => sphere(random.within(0.09, 0.16), 28),
        _ => pipe(0.2, 0.12, 0.08, 32) + bevelled_box(0.12, 0.12, 0.12, 0.01).moved(0.28, 0.0, 0.05),
    };
    toy.turned(turn)
}
