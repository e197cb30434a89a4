//! Closed forms and properties of propagation.

use super::lattice::LINKS;
use super::propagation::{Field, Light, Shown, Volume};
use super::{Flight, LightGrid};
use crate::scene::Bounds;
use glam::{IVec3, Vec3, Vec4, Vec4Swizzles};

/// Cells of one metre, all alike, nothing between them.
fn volume(size: IVec3, flight: Flight) -> Volume {
    let grid = LightGrid { low: Vec3::ZERO, cell: 1.0, size };
    Volume { grid, flights: vec![[flight; 3]; grid.cells()], passing: vec![[1.0; LINKS]; grid.cells()] }
}

/// Light of one colour in one cell.
fn lit(volume: &Volume, at: IVec3, moments: Vec4) -> Field {
    let mut light = vec![[Vec4::ZERO; 3]; volume.grid.cells()];
    let none = light.clone();
    light[volume.grid.index(at).expect("a cell")] = [moments, Vec4::ZERO, Vec4::ZERO];
    Field::new(&none, &light)
}

fn iterated(volume: &Volume, mut field: Field, iterations: usize) -> Field {
    (0..iterations).for_each(|_| field.step(volume, Shown::Scattered));
    field
}

#[test]
fn energy_is_kept_to_rounding_without_absorption_and_blockers() {
    for extinction in [0.0, 0.3, 2.0, 40.0, 1e6] {
        let volume = volume(IVec3::splat(25), Flight::new(extinction, 1.0));
        let mut field = lit(&volume, IVec3::splat(12), Vec4::new(0.5, -0.3, 0.8, 2.0));
        for iteration in 0..11 {
            let before = field.energy();
            field.step(&volume, Shown::Scattered);
            let loss = (field.energy() / before - 1.0).abs();
            assert!(loss < 2e-6, "extinction {extinction}, iteration {iteration}: {loss}");
        }
    }
}

#[test]
fn absorption_takes_what_its_closed_form_says() {
    for (extinction, albedo) in [(0.7f64, 0.0), (0.7, 0.6), (3.0, 0.9)] {
        let flight = Flight::new(extinction as f32, albedo);
        let volume = volume(IVec3::splat(21), flight);
        let start = lit(&volume, IVec3::splat(10), Vec4::new(0.1, 0.9, 0.0, 1.0));
        // Of a cell's energy what leaves it, scattered within or not, and what is left of that where it arrives.
        let mean = |of: &dyn Fn(usize) -> f32| f64::from(super::lattice::mean(of));
        let kept = f64::from(1.0 + flight.scattered)
            * mean(&|k| flight.leaves[k] * (flight.enters[k] + albedo * (1.0 - flight.enters[k])));
        let field = iterated(&volume, start, 9);
        let wanted = kept.powi(9);
        assert!((field.energy() / wanted - 1.0).abs() < 1e-5, "{} for {wanted}", field.energy());
        if albedo == 0.0 {
            let straight = mean(&|k| (-extinction * f64::from(super::lattice::DISTANCES[k])).exp() as f32);
            assert!((kept / straight - 1.0).abs() < 1e-5, "exp(-sigma d) of each way");
        }
    }
}

/// Everything turned over along x.
fn mirrored(volume: &Volume, light: &[Light]) -> Vec<Light> {
    let turned = |index: usize| {
        let at = volume.grid.at(index);
        let from = IVec3::new(volume.grid.size.x - 1 - at.x, at.y, at.z);
        light[volume.grid.index(from).expect("a cell")].map(|of| of * Vec4::new(-1.0, 1.0, 1.0, 1.0))
    };
    (0..volume.grid.cells()).map(turned).collect()
}

#[test]
fn mirrored_light_makes_a_mirrored_image() {
    let volume = volume(IVec3::new(12, 9, 10), Flight::new(0.8, 0.7));
    let start = Vec4::new(0.9, 0.4, -0.2, 2.0);
    let here = iterated(&volume, lit(&volume, IVec3::new(4, 5, 3), start), 6);
    let there = start * Vec4::new(-1.0, 1.0, 1.0, 1.0);
    let there = iterated(&volume, lit(&volume, IVec3::new(7, 5, 3), there), 6);
    let largest = here.shown.iter().map(|of| of[0].w).fold(0.0, f32::max);
    let off = |(a, b): (&Light, &Light)| (a[0] - b[0]).abs().max_element();
    let worst = mirrored(&volume, &here.shown).iter().zip(&there.shown).map(off).fold(0.0, f32::max);
    assert!(worst < 1e-6 * largest, "{worst} of {largest}");
    let unturned = here.shown.iter().zip(&there.shown).map(off).fold(0.0, f32::max);
    assert!(unturned > 0.1 * largest, "a control: {unturned}");
}

/// Mean squared distance of collisions over `2 l^2 / (1 - albedo)`, for an isotropic source at a point.
fn moment_ratio(path: f32, albedo: f32, half: i32, iterations: usize) -> f64 {
    let volume = volume(IVec3::splat(2 * half + 1), Flight::new(1.0 / path, albedo));
    let field = lit(&volume, IVec3::splat(half), Vec4::W);
    let field = iterated(&volume, field, iterations);
    let (mut all, mut second) = (0.0, 0.0);
    for (index, shown) in field.shown.iter().enumerate() {
        let squared = (volume.grid.at(index) - half).as_dvec3().length_squared();
        all += f64::from(shown[0].w);
        second += f64::from(shown[0].w) * squared;
    }
    second / all / f64::from(2.0 * path * path / (1.0 - albedo))
}

#[test]
fn collisions_are_as_far_away_as_in_an_infinite_medium() {
    for (path, albedo, half, [low, high]) in [
        (0.25, 0.5, 8, [0.99, 1.01]),
        (0.25, 0.9, 12, [0.98, 1.01]),
        (0.5, 0.5, 10, [0.99, 1.01]),
        (0.5, 0.9, 16, [0.98, 1.01]),
        (1.0, 0.5, 14, [0.93, 1.01]),
        (2.0, 0.5, 18, [0.75, 0.9]),
    ] {
        let ratio = moment_ratio(path, albedo, half, 3 * half as usize);
        assert!(ratio > low && ratio < high, "path {path}, albedo {albedo}: {ratio}");
    }
}

#[test]
fn far_from_a_source_light_falls_as_diffusion_has_it() {
    let (path, albedo) = (0.5f64, 0.9f64);
    let half = 14;
    let volume = volume(IVec3::splat(2 * half + 1), Flight::new((1.0 / path) as f32, albedo as f32));
    let field = iterated(&volume, lit(&volume, IVec3::splat(half), Vec4::W), 60);
    // phi = exp(-s r) / (4 pi D r) with D = l / 3 and s the root of transport, albedo l s = tanh^-1(l s).
    let decay = |s: f64| albedo * (s * path).atanh() - s * path;
    let (mut low, mut high) = (1e-6, 1.0 / path - 1e-9);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if decay(middle) < 0.0 { low = middle } else { high = middle }
    }
    let at = |r: i32| f64::from(field.shown[volume.grid.index(IVec3::new(half + r, half, half)).expect("a cell")][0].w);
    let of = |r: f64| (-low * r).exp() / r;
    for r in [2, 3, 4, 5, 6] {
        let ratio = at(r) / at(2) / (of(f64::from(r)) / of(2.0));
        assert!((ratio - 1.0).abs() < 0.15, "at {r}: {ratio}");
    }
}

#[test]
fn extremes_have_documented_results() {
    for (extinction, albedo) in [(0.0, 1.0), (1e30, 1.0), (1e30, 0.5), (1e-30, 0.0), (1e6, 1.0)] {
        for size in [IVec3::ONE, IVec3::new(1, 5, 1), IVec3::splat(4)] {
            let mut volume = volume(size, Flight::new(extinction, albedo));
            for passing in [1.0, 0.0] {
                volume.passing.fill([passing; LINKS]);
                let field = lit(&volume, IVec3::ZERO, Vec4::new(3.0, 0.0, 0.0, 1.0));
                let field = iterated(&volume, field, 5);
                let all = field.shown.iter().chain(&field.scattered).flatten();
                assert!(all.clone().all(|of| of.is_finite()), "{extinction} {albedo} {size}");
                assert!(field.shown.iter().flatten().all(|of| of.w >= 0.0));
                if passing == 0.0 || size == IVec3::ONE {
                    assert_eq!(field.energy(), 0.0, "nothing arrives anywhere");
                }
            }
        }
    }
}

#[test]
fn walls_between_cells_let_nothing_through() {
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(10.0) };
    let grid = LightGrid::around(bounds, 12);
    let mut blockers = super::Blockers::new(&grid);
    // A wall across x, between the middles of two layers of cells.
    for i in 0..14 * 14 {
        let point = Vec3::new(5.7, (i % 14) as f32 - 1.5, (i / 14) as f32 - 1.5);
        blockers.add(point, Vec3::X, 1.0);
    }
    let open = volume(grid.size, Flight::new(0.2, 1.0));
    let walled = Volume { grid, passing: blockers.passing(&grid), ..open.clone() };
    let start = grid.in_cells(Vec3::new(3.5, 5.5, 5.5)).as_ivec3();
    let behind = |volume: &Volume| -> f64 {
        let field = iterated(volume, lit(volume, start, Vec4::W), 20);
        let is_behind = |index: &usize| grid.middle(grid.at(*index)).x > 5.7;
        (0..grid.cells()).filter(is_behind).map(|index| f64::from(field.shown[index][0].w)).sum()
    };
    let [open, walled] = [behind(&open), behind(&walled)];
    assert!(open > 1.0 && walled < 0.2 * open, "{walled} of {open}");
}

#[test]
fn flux_along_axes_and_diagonals_is_stated() {
    let volume = volume(IVec3::splat(31), Flight::new(0.0, 0.0));
    let field = iterated(&volume, lit(&volume, IVec3::splat(15), Vec4::W), 15);
    // Fluence times squared distance is 1 / (4 pi) of a point source, along every direction.
    let scaled = |offset: IVec3| {
        let at = volume.grid.index(IVec3::splat(15) + offset).expect("a cell");
        4.0 * std::f32::consts::PI * field.shown[at][0].w * offset.as_vec3().length_squared()
    };
    let [axis, edge, corner] = [IVec3::new(8, 0, 0), IVec3::new(6, 6, 0), IVec3::new(5, 5, 5)].map(scaled);
    eprintln!("axis {axis}, edge {edge}, corner {corner}");
    assert!(field.shown.iter().all(|of| of[0].xyz().length() <= of[0].w * 1.001));
}
