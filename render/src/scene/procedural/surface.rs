//! Surfaces given by a function: sheets over a grid, ground, and the zero sets of fields in space.

use super::shape::Shape;
use glam::{IVec3, Vec2, Vec3};

/// A sheet of `columns` x `rows` quadrilaterals through the points of a function of (u, v) in [0, 1]^2. Its
/// front is where v's direction x u's direction points: up where u goes along x and v along z.
pub fn sheet(columns: usize, rows: usize, point: impl Fn(f32, f32) -> Vec3) -> Shape {
    let mut shape = Shape::default();
    let grid: Vec<Vec<Vec3>> = (0..=rows)
        .map(|row| {
            let v = row as f32 / rows as f32;
            (0..=columns).map(|column| point(column as f32 / columns as f32, v)).collect()
        })
        .collect();
    let width: f32 = grid[0].windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let length: f32 = grid.windows(2).map(|pair| pair[0][0].distance(pair[1][0])).sum();
    let line = columns as u32 + 1;
    for (row, points) in grid.iter().enumerate() {
        for (column, position) in points.iter().enumerate() {
            let u = column as f32 / columns as f32 * width;
            shape.vertex(*position, Vec3::ZERO, Vec2::new(u, row as f32 / rows as f32 * length));
        }
    }
    for row in 0..rows as u32 {
        for column in 0..columns as u32 {
            let at = row * line + column;
            shape.connect([at, at + line, at + line + 1, at + 1]);
        }
    }
    shape.smoothed()
}

/// Solid ground: the height field `height(x, z)` over a rectangle around the origin, with walls down to
/// `base` and a floor below, in `cells` x `cells` quadrilaterals.
pub fn ground(size: Vec2, cells: usize, base: f32, height: impl Fn(f32, f32) -> f32) -> Shape {
    let point = |u: f32, v: f32| {
        let at = size * (Vec2::new(u, v) - Vec2::splat(0.5));
        Vec3::new(at.x, height(at.x, at.y), at.y)
    };
    let top = sheet(cells, cells, point);
    let low = |position: Vec3| position.with_y(base);
    let edge = |i: usize| i as f32 / cells as f32;
    let mut shape = top;
    let sides: [&dyn Fn(f32) -> Vec3; 4] =
        [&|t| point(t, 1.0), &|t| point(1.0, 1.0 - t), &|t| point(1.0 - t, 0.0), &|t| point(0.0, t)];
    for side in sides {
        for i in 0..cells {
            let (from, to) = (side(edge(i)), side(edge(i + 1)));
            shape.polygon(&[low(from), low(to), to, from]);
        }
    }
    let corner = |u, v| low(point(u, v));
    shape.polygon(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
    shape
}

/// The surface where a field is 0, facing where it is positive, inside a box: naive surface nets (Gibson
/// 1998), one vertex for every cell of about `cell` metres that the surface passes through.
pub fn isosurface(low: Vec3, high: Vec3, cell: f32, field: impl Fn(Vec3) -> f32) -> Shape {
    let grid = Grid::sampled(low, high, cell, field);
    let mut shape = Shape::default();
    let mut vertices = vec![u32::MAX; grid.values.len()];
    for at in grid.cells() {
        if let Some(position) = grid.vertex(at) {
            vertices[grid.index(at)] =
                shape.vertex(position, Vec3::ZERO, Vec2::new(position.x + position.z, position.y));
        }
    }
    for at in grid.cells() {
        for (axis, side, other) in
            [(IVec3::X, IVec3::Y, IVec3::Z), (IVec3::Y, IVec3::Z, IVec3::X), (IVec3::Z, IVec3::X, IVec3::Y)]
        {
            let inside = [at, at + axis].map(|corner| grid.value(corner) < 0.0);
            let around = [at, at - side, at - side - other, at - other];
            if inside[0] == inside[1] || !around.iter().all(|cell| grid.has_cell(*cell)) {
                continue;
            }
            let quad = around.map(|cell| vertices[grid.index(cell)]);
            match inside {
                [true, false] => shape.connect(quad),
                [false, true] => shape.connect([quad[3], quad[2], quad[1], quad[0]]),
                _ => {}
            }
        }
    }
    shape.smoothed()
}

/// A field's values at the points of a grid.
struct Grid {
    low: Vec3,
    spacing: Vec3,
    /// Number of points along each axis.
    size: IVec3,
    values: Vec<f32>,
}

impl Grid {
    fn sampled(low: Vec3, high: Vec3, cell: f32, field: impl Fn(Vec3) -> f32) -> Self {
        let cells = ((high - low) / cell).round().max(Vec3::ONE);
        let size = cells.as_ivec3() + 1;
        let spacing = (high - low) / cells;
        let mut values = Vec::with_capacity((size.x * size.y * size.z) as usize);
        for z in 0..size.z {
            for y in 0..size.y {
                values.extend((0..size.x).map(|x| field(low + spacing * IVec3::new(x, y, z).as_vec3())));
            }
        }
        Self { low, spacing, size, values }
    }

    fn index(&self, at: IVec3) -> usize {
        ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize
    }

    fn value(&self, at: IVec3) -> f32 {
        self.values[self.index(at)]
    }

    fn has_cell(&self, at: IVec3) -> bool {
        at.cmpge(IVec3::ZERO).all() && at.cmplt(self.size - 1).all()
    }

    /// The lowest corners of all cells.
    fn cells(&self) -> impl Iterator<Item = IVec3> + use<> {
        let cells = self.size - 1;
        (0..cells.z)
            .flat_map(move |z| (0..cells.y).flat_map(move |y| (0..cells.x).map(move |x| IVec3::new(x, y, z))))
    }

    /// The mean of the places where the surface crosses a cell's edges; `None` where it does not pass.
    fn vertex(&self, at: IVec3) -> Option<Vec3> {
        let corner = |i: usize| IVec3::new(i as i32 & 1, (i as i32 >> 1) & 1, i as i32 >> 2);
        let values: [f32; 8] = std::array::from_fn(|i| self.value(at + corner(i)));
        if values.iter().all(|value| (*value < 0.0) == (values[0] < 0.0)) {
            return None;
        }
        let (mut sum, mut crossings) = (Vec3::ZERO, 0);
        for a in 0..8usize {
            for b in [a | 1, a | 2, a | 4] {
                if a != b && (values[a] < 0.0) != (values[b] < 0.0) {
                    // Kept off the ends, so that no two vertices fall together.
                    let share = (values[a] / (values[a] - values[b])).clamp(0.02, 0.98);
                    sum += corner(a).as_vec3().lerp(corner(b).as_vec3(), share);
                    crossings += 1;
                }
            }
        }
        Some(self.low + self.spacing * (at.as_vec3() + sum / crossings as f32))
    }
}

/// The smaller of two distances with a rounded meeting, which is about `radius` wide (polynomial smooth
/// minimum).
pub fn smooth_min(a: f32, b: f32, radius: f32) -> f32 {
    let overlap = (radius - (a - b).abs()).max(0.0) / radius;
    a.min(b) - 0.25 * overlap * overlap * radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn sheets_face_up_and_have_texture_coordinates_in_metres() {
        let shape = sheet(4, 3, |u, v| Vec3::new(2.0 * u, 0.0, 3.0 * v));
        assert_eq!(shape.triangles.len(), 24);
        assert!(shape.normals.iter().all(|normal| (normal - Vec3::Y).length() < 1e-6));
        assert!((shape.uvs[shape.uvs.len() - 1] - Vec2::new(2.0, 3.0)).length() < 1e-5);
    }

    #[test]
    fn ground_is_a_closed_solid() {
        let shape = ground(Vec2::new(2.0, 3.0), 8, -1.0, |x, _| 0.5 * x);
        assert!((shape.signed_volume() - 6.0).abs() < 1e-3);
    }

    #[test]
    fn the_surface_of_a_ball_is_closed_and_faces_outwards() {
        let shape = isosurface(Vec3::splat(-1.5), Vec3::splat(1.5), 0.06, |p| p.length() - 1.0);
        assert!((shape.signed_volume() / (4.0 / 3.0 * PI) - 1.0).abs() < 0.01);
        assert!(shape.positions.iter().zip(&shape.normals).all(|(p, n)| p.normalize().dot(*n) > 0.98));
        let hollow = isosurface(Vec3::splat(-1.5), Vec3::splat(1.5), 0.06, |p| 1.0 - p.length());
        assert!(hollow.signed_volume() < -4.0);
    }

    #[test]
    fn smooth_minimum_is_the_minimum_away_from_the_meeting() {
        assert_eq!(smooth_min(1.0, 3.0, 0.5), 1.0);
        assert!((smooth_min(1.0, 1.0, 0.4) - 0.9).abs() < 1e-6);
    }
}
