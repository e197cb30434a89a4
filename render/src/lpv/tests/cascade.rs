//! Finer grids in coarser ones.

use super::*;
use crate::lpv::propagation::CellFluence;
use crate::lpv::sides::Begun;
use crate::lpv::sky::Sky;
use crate::scene::Environment;
use glam::BVec3;
use std::f32::consts::PI;

/// Light of a point in a medium that is the same everywhere, in a grid and in a finer one in its middle: mean
/// fluence in the middle of the finer one, and how far it is from that of the coarser one, cell by cell, over
/// the mean.
fn handed_over(extinction: f32, albedo: f32, source: IVec3) -> [f32; 2] {
    let flight = |cell: f32| Flight::new(extinction * cell, albedo);
    let coarse = alike(Scheme::OURS, IVec3::splat(20), flight(1.0));
    let fine = coarse.grid.nested(Vec3::splat(10.0));
    let fine = Volume { grid: fine, ..alike(Scheme::OURS, fine.size, flight(fine.cell)) };
    let outer = iterated(&coarse, lit(&coarse, source, Vec4::W), 80);
    // The source is not in the finer grid.
    let start = Field::scattered(Scheme::OURS, &vec![Light::default(); fine.grid.cells()]);
    let inner = iterated(&fine, start.nested(&fine, (&coarse.grid, &outer.shown)), 80);
    let shown = |field: &Field, grid: &LightGrid, at: IVec3| {
        field.shown.by_medium[grid.index(at).expect("a cell")][0].w / (grid.cell * grid.cell)
    };
    let (mut sums, mut off, mut count) = ([0.0; 2], 0.0, 0.0);
    for i in 0..216 {
        let at = IVec3::new(i % 6, i / 6 % 6, i / 36) + 7;
        let first = fine.grid.in_cells(coarse.grid.middle(at)).floor().as_ivec3();
        let eight = (0..8).map(|i| first - IVec3::new(i & 1, i >> 1 & 1, i >> 2));
        let is = eight.map(|at| shown(&inner, &fine.grid, at)).sum::<f32>() / 8.0;
        let wanted = shown(&outer, &coarse.grid, at);
        sums = [sums[0] + is, sums[1] + wanted];
        off += (is - wanted).abs();
        count += 1.0;
    }
    [sums[0] / sums[1], off / count / (sums[1] / count)]
}

#[test]
fn as_much_light_is_in_a_finer_grid_as_comes_through_its_border() {
    // Without a medium a finer grid is by itself 1.11 times as bright there: light goes straighter in it.
    for (extinction, albedo, most) in [(0.0, 0.0, 0.2), (0.5, 0.5, 0.1), (0.5, 1.0, 0.1), (1.0, 0.9, 0.1)] {
        let [ratio, off] = handed_over(extinction, albedo, IVec3::new(2, 9, 10));
        assert!((ratio - 1.0).abs() < most && off < 1.2 * most, "{extinction} {albedo}: {ratio} {off}");
    }
}

#[test]
fn what_leaves_a_finer_grid_does_not_come_back_twice() {
    let coarse = alike(Scheme::OURS, IVec3::splat(16), Flight::new(0.4, 0.9));
    let fine = coarse.grid.nested(Vec3::splat(8.0));
    let fine = Volume { grid: fine, ..alike(Scheme::OURS, fine.size, Flight::new(0.2, 0.9)) };
    let outer = iterated(&coarse, lit(&coarse, IVec3::splat(8), Vec4::W), 60);
    let middle = fine.grid.in_cells(coarse.grid.middle(IVec3::splat(8))).floor().as_ivec3();
    let own = lit(&fine, middle, Vec4::W);
    let inner = iterated(&fine, own.nested(&fine, (&coarse.grid, &outer.shown)), 60);
    let apart = LightGrid { handed: [BVec3::FALSE; 2], ..fine.grid };
    let alone = iterated(&Volume { grid: apart, ..fine.clone() }, lit(&fine, middle, Vec4::W), 60);
    let sum = |field: &Field, grid: &LightGrid, low: i32, high: i32| -> f32 {
        let is_in = |index: &usize| {
            let at = grid.at(*index);
            at.cmpge(IVec3::splat(low)).all() && at.cmplt(IVec3::splat(high)).all()
        };
        // Fluence times volume.
        let shown = |index: usize| field.shown.by_medium[index][0].w * grid.cell;
        (0..grid.cells()).filter(is_in).map(shown).sum()
    };
    let wanted = sum(&outer, &coarse.grid, 5, 11);
    let [is, alone] = [inner, alone].map(|field| sum(&field, &fine.grid, 2, 14));
    assert!((is / wanted - 1.0).abs() < 0.1, "{is} of {wanted}");
    assert!(alone < 0.97 * is, "light that comes back through the border counts: {alone} {is}");
}

/// What each of several grids around a point shows, the coarsest first.
fn shown_by_all(
    flight: impl Fn(f32) -> Flight,
    (size, focus): (IVec3, Vec3),
    begins: impl Fn(&Volume) -> Field,
) -> Vec<(LightGrid, CellFluence)> {
    let mut all: Vec<(LightGrid, CellFluence)> = Vec::new();
    for _ in 0..4 {
        let outside = all.last();
        let volume = match outside {
            None => alike(Scheme::OURS, size, flight(1.0)),
            Some((outside, _)) => {
                let grid = outside.nested(focus);
                Volume { grid, ..alike(Scheme::OURS, grid.size, flight(grid.cell)) }
            }
        };
        let field = begins(&volume);
        let field = match outside {
            None => field,
            Some((grid, shown)) => field.nested(&volume, (grid, shown)),
        };
        all.push((volume.grid, iterated(&volume, field, 60).shown));
    }
    all
}

/// Fluence of even radiance over all directions is 4 pi of it, in cells of any size.
#[test]
fn an_even_sky_is_as_bright_in_grids_within_grids() {
    let sky = Sky::new(&Environment::uniform(Vec3::ONE));
    let begins = |volume: &Volume| {
        let none = vec![Light::default(); volume.grid.cells()];
        Field::steady(Scheme::OURS, Begun::under(volume, &none, Some(&sky), |_, _| Vec3::ONE))
    };
    let size = IVec3::new(16, 7, 15);
    for focus in [0.5 * size.as_vec3(), Vec3::new(-3.0, 2.0, 14.0)] {
        for (grid, shown) in shown_by_all(|_| Flight::new(0.0, 0.0), (size, focus), begins) {
            let inside = |index: &usize| !grid.is_border(grid.at(*index));
            let fluences = (0..grid.cells()).filter(inside).map(|index| shown.by_medium[index][0].w);
            let off = fluences.map(|of| (of / (4.0 * PI * grid.cell * grid.cell) - 1.0).abs());
            let worst = off.fold(0.0, f32::max);
            assert!(worst < 5e-3, "{focus}, cells of {} m: {worst}", grid.cell);
        }
    }
}

#[test]
fn light_of_a_medium_is_handed_down_from_grid_to_grid() {
    let begins = |volume: &Volume| match volume.grid.border().next() {
        None => lit(volume, IVec3::new(3, 9, 10), Vec4::W),
        // The source is in none of the finer grids.
        Some(_) => Field::scattered(Scheme::OURS, &vec![Light::default(); volume.grid.cells()]),
    };
    let ratios = [0.5, 0.9, 1.0].map(|albedo| {
        let flight = |cell: f32| Flight::new(0.5 * cell, albedo);
        let all = shown_by_all(flight, (IVec3::splat(20), Vec3::splat(10.0)), begins);
        // Mean fluence of two cells of the coarsest along each axis.
        let mean = |(grid, shown): &(LightGrid, CellFluence)| {
            let [low, high] = [9.0, 11.0].map(|at| grid.in_cells(Vec3::splat(at)).round().as_ivec3());
            let is_in = |index: &usize| {
                let at = grid.at(*index);
                at.cmpge(low).all() && at.cmplt(high).all()
            };
            let fluences = (0..grid.cells()).filter(is_in).map(|index| shown.by_medium[index][0].w);
            fluences.sum::<f32>() * grid.cell
        };
        let means: Vec<f32> = all.iter().map(mean).collect();
        means.iter().map(|mean| mean / means[0]).collect::<Vec<f32>>()
    });
    assert!(ratios.iter().flatten().all(|ratio| (ratio - 1.0).abs() < 0.1), "{ratios:?}");
}
