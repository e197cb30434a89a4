//! Media that are denser in one cell than in another.

use super::*;
use crate::lpv::flight::reflectance;
use crate::lpv::lattice::{DISTANCES, SHARES, mean, neighbours};
use crate::lpv::studies::Xorshift;
use glam::IVec2;

/// Extinctions from nothing to a hundred thousand mean free paths in a cell.
const EXTINCTIONS: [f32; 8] = [0.0, 0.3, 1.0, 4.0, 20.0, 300.0, 1e4, 1e5];

/// A volume of cells of these extinctions, in no order.
fn mixed(size: IVec3, albedo: f32) -> Volume {
    let mut volume = alike(Scheme::OURS, size, Flight::new(0.0, albedo));
    let number = |index: usize| index.wrapping_mul(2_654_435_769) >> 7;
    for (index, flights) in volume.flights.iter_mut().enumerate() {
        *flights = [Flight::new(EXTINCTIONS[number(index) % EXTINCTIONS.len()], albedo); 3];
    }
    volume
}

/// Even light of a fluence of 1 in every cell of a volume, and what an iteration makes of it.
fn even(volume: &Volume) -> Field {
    // What arrives is what is sent.
    let sets_out = |flights: &[Flight; 3]| [Vec4::W * mean(|class| flights[0].even[class]); 3];
    let light: Vec<Light> = volume.flights.iter().map(sets_out).collect();
    let mut field = Field::scattered(volume.scheme, &light);
    field.step(volume);
    field
}

/// The largest of what cells that have all neighbours show, over the least.
fn spread(volume: &Volume, field: &Field) -> f32 {
    let inner = |index: &usize| {
        let at = volume.grid.at(*index);
        at.cmpgt(IVec3::ZERO).all() && at.cmplt(volume.grid.size - 1).all()
    };
    let shown = || (0..volume.grid.cells()).filter(inner).map(|cell| field.shown.by_medium[cell][0].w);
    shown().fold(0.0, f32::max) / shown().fold(f32::INFINITY, f32::min)
}

#[test]
fn even_light_stays_even_whatever_the_medium() {
    let volume = mixed(IVec3::splat(7), 1.0);
    let spread_of_ours = spread(&volume, &even(&volume));
    assert!((spread_of_ours - 1.0).abs() < 0.05, "{spread_of_ours}");
    // Where nothing turns back, dense cells are far too bright.
    let mut open = volume;
    for flight in open.flights.iter_mut().flatten() {
        flight.even = [1.0; 3];
    }
    let light = vec![[Vec4::W; 3]; open.grid.cells()];
    let mut field = Field::scattered(open.scheme, &light);
    field.iterate(&open, 2);
    assert!(spread(&open, &field) > 1e3, "a control: {}", spread(&open, &field));
}

#[test]
fn energy_is_kept_between_cells_of_all_densities() {
    let volume = mixed(IVec3::splat(11), 1.0);
    let mut field = lit(&volume, IVec3::splat(5), Vec4::new(0.3, -0.2, 0.1, 1.0));
    for _ in 0..5 {
        let before = field.energy();
        field.step(&volume);
        assert!((field.energy() / before - 1.0).abs() < 2e-5, "{} of {before}", field.energy());
    }
}

/// What half a space of isotropic scattering reflects of diffuse light, by a walk: photons that enter by
/// Lambert's cosine go on by exponential flights, and count by the albedo to the number of their collisions
/// where they leave.
fn walked(albedo: f64) -> f64 {
    let mut numbers = Xorshift::new(1);
    let mut random = || numbers.number();
    let photons = 20_000;
    let mut reflected = 0.0;
    for _ in 0..photons {
        let (mut depth, mut cosine, mut weight) = (0.0, random().sqrt(), 1.0);
        while weight > 1e-4 {
            depth -= cosine * (1.0 - random()).ln();
            if depth < 0.0 {
                reflected += weight;
                break;
            }
            weight *= albedo;
            cosine = 2.0 * random() - 1.0;
        }
    }
    reflected / f64::from(photons)
}

#[test]
fn half_a_space_reflects_what_a_walk_says() {
    for albedo in [0.2, 0.5, 0.9, 0.99] {
        let (is, wanted) = (reflectance(albedo), walked(f64::from(albedo)) as f32);
        assert!((is - wanted).abs() < 0.015, "albedo {albedo}: {is} for {wanted}");
    }
    assert_eq!([reflectance(0.0), reflectance(1.0)], [0.0, 1.0]);
}

/// What of light that a clear cell sends into a dense medium comes back, and the largest fluence there over
/// what is sent: a column of cells whose neighbours across reflect everything in the medium and nothing
/// before.
fn sent_into(extinction: f32, albedo: f32) -> [f32; 2] {
    let clear = Flight::new(0.0, 0.0);
    let mut volume = alike(Scheme::OURS, IVec3::new(3, 3, 8), clear);
    for index in 0..volume.grid.cells() {
        if volume.grid.at(index).z > 0 {
            volume.flights[index] = [Flight::new(extinction, albedo); 3];
            volume.reflectances[index] = [1.0; 3];
        }
    }
    let along: Vec<bool> = neighbours().skip(LINKS).map(|n| n.offset.truncate() == IVec2::ZERO).collect();
    volume.passing.fill(std::array::from_fn(|link| f32::from(u8::from(along[link]))));
    let source = Vec4::new(0.0, 0.0, 0.7, 1.0);
    let ahead = neighbours().find(|n| n.offset == IVec3::Z).expect("a neighbour");
    let sent = SHARES[ahead.class] * Lobes::Squared.towards(Lobes::Squared.begins(source), &ahead);
    let mut field = lit(&volume, IVec3::new(1, 1, 0), source);
    field.iterate(&volume, 60);
    let shown = |z: i32| field.shown.by_medium[volume.grid.index(IVec3::new(1, 1, z)).expect("a cell")][0].w;
    // What comes back goes half a cell to the middle, and on.
    let back = (shown(0) - clear.track_out) / (clear.tracks_in[ahead.class] + clear.track_out);
    [back / sent, (1..8).map(shown).fold(0.0, f32::max) / sent]
}

#[test]
fn a_dense_medium_reflects_as_half_a_space_does_and_is_no_brighter_than_what_shines_on_it() {
    // Even light is as bright.
    let most = 1.05 * mean(|class| DISTANCES[class]) / SHARES[0];
    for (extinction, off) in [(300.0, 0.04), (1e5, 0.02)] {
        for albedo in [0.5f32, 0.9, 0.99] {
            let ([is, brightest], wanted) = (sent_into(extinction, albedo), walked(f64::from(albedo)) as f32);
            assert!((is - wanted).abs() < off, "{extinction}, albedo {albedo}: {is} for {wanted}");
            assert!(brightest < most, "{extinction}, albedo {albedo}: {brightest}");
        }
        // Of what nothing absorbs a walk never ends; it all comes back.
        let [is, brightest] = sent_into(extinction, 1.0);
        assert!((is - 1.0).abs() < 0.02 && brightest < most, "{extinction}: {is} {brightest}");
    }
}
