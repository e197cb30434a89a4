//! A finer grid in a coarser one.

use super::*;

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
    let alone = iterated(&fine, lit(&fine, middle, Vec4::W), 60);
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
