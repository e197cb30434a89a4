//! A finer grid in a coarser one.

use super::*;

/// Light of a point, in a grid and in a finer one in its middle: mean fluence in the middle of the finer one,
/// and how far it is from that of the coarser one, cell by cell, over the mean.
fn handed_over(source: IVec3) -> [f32; 2] {
    let coarse = alike(Scheme::OURS, IVec3::splat(20), Flight::new(0.0, 0.0));
    let fine = coarse.grid.nested(Vec3::splat(10.0));
    let fine = Volume { grid: fine, ..alike(Scheme::OURS, fine.size, Flight::new(0.0, 0.0)) };
    let mut light = vec![Light::default(); coarse.grid.cells()];
    light[coarse.grid.index(source).expect("a cell")][0] = Vec4::W;
    let outer = iterated(&coarse, Field::new(&coarse, Kinds::ONE, &light, &[]), 80);
    // The source is not in the finer grid.
    let start = Field::new(&fine, Kinds::ONE, &vec![Light::default(); fine.grid.cells()], &[]);
    let inner = iterated(&fine, start.nested(&fine, (&coarse.grid, &outer.shown.by_surfaces)), 80);
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
    // A finer grid is by itself 1.11 times as bright there: light goes straighter in it.
    let [ratio, off] = handed_over(IVec3::new(2, 9, 10));
    assert!((ratio - 1.0).abs() < 0.2 && off < 0.24, "{ratio} {off}");
}
