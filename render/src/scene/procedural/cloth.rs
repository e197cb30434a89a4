//! A square of cloth that falls until it rests: point masses and length constraints (Jakobsen, "Advanced
//! Character Physics", 2001), with solids that push points out.

use super::shape::Shape;
use super::solids::{block, sphere};
use super::surface::sheet;
use super::sweep::{curve, rod};
use glam::{Vec2, Vec3, Vec3A};

/// How far points stay from solids, so that the cloth's facets do not cut them.
const GAP: f32 = 0.02;
/// Fall in the first step: gravity in a hundredth of a second squared, metres.
const FALL: f32 = 9.81 / 10_000.0;
/// Share of a point's speed that is left after a step. Cloth falls slowly through air, and no point may cross
/// a thin solid in one step.
const KEPT: f32 = 0.94;
/// Times the constraints are met in turn in every step.
const PASSES: usize = 3;

/// What cloth falls on.
pub enum Solid {
    /// A bar with round ends, a ball where both are the same.
    Bar {
        /// Middle of one end.
        from: Vec3,
        /// Middle of the other.
        to: Vec3,
        /// Of the bar.
        radius: f32,
    },
    /// A box.
    Box {
        /// Its middle.
        middle: Vec3,
        /// Half its edges.
        half: Vec3,
    },
}

impl Solid {
    /// The vector from the solid's surface to a point outside, by its length the distance; `None` where the
    /// point is farther than [`GAP`].
    fn push(&self, point: Vec3) -> Option<Vec3> {
        match self {
            Self::Bar { from, to, radius } => {
                let axis = to - from;
                let along = ((point - from).dot(axis) / axis.length_squared().max(1e-9)).clamp(0.0, 1.0);
                let outward = point - (from + axis * along);
                let distance = outward.length();
                (distance < radius + GAP).then(|| outward.normalize_or(Vec3::Y) * (radius + GAP - distance))
            }
            Self::Box { middle, half } => {
                let local = point - middle;
                let nearest = local.clamp(-*half, *half);
                let outward = local - nearest;
                let distance = outward.length();
                if distance > 0.0 {
                    return (distance < GAP).then(|| outward * ((GAP - distance) / distance));
                }
                let depth = *half - local.abs();
                let shallow = depth.min_element();
                let axis = if depth.y == shallow {
                    Vec3::Y
                } else if depth.x == shallow {
                    Vec3::X
                } else {
                    Vec3::Z
                };
                Some(axis * local.dot(axis).signum() * (shallow + GAP))
            }
        }
    }

    /// Height of the highest point.
    pub fn top(&self) -> f32 {
        match self {
            Self::Bar { from, to, radius } => from.y.max(to.y) + radius,
            Self::Box { middle, half } => middle.y + half.y,
        }
    }

    /// The solid itself.
    pub fn shape(&self) -> Shape {
        match self {
            Self::Bar { from, to, radius } if from == to => sphere(*radius, 28).at(*from - Vec3::Y * *radius),
            Self::Bar { from, to, radius } => {
                let end = sphere(*radius, 20).moved(0.0, -*radius, 0.0);
                rod(*from, *to, *radius, 20) + end.at_each([*from, *to])
            }
            Self::Box { middle, half } => block(middle - half, middle + half),
        }
    }
}

/// A square of cloth of `side` x `side` points.
pub struct Cloth {
    side: usize,
    points: Vec<Vec3A>,
    before: Vec<Vec3A>,
    /// 1 for free points, 0 for those that are pinned.
    free: Vec<f32>,
    /// Pairs of points and their distance at rest: neighbours and diagonals, which keep it.
    links: Vec<(usize, usize, f32)>,
    /// The same of points two apart, which only resist being nearer.
    stiffeners: Vec<(usize, usize, f32)>,
}

impl Cloth {
    /// A level cloth with its middle at a point, turned about it.
    pub fn square(size: f32, side: usize, middle: Vec3, turn: f32) -> Self {
        let point = |u: f32, v: f32| {
            let at = Vec2::from_angle(turn).rotate(Vec2::new(u - 0.5, v - 0.5) * size);
            middle + Vec3::new(at.x, 0.0, at.y)
        };
        Self::new(size, side, point, |_, _| false)
    }

    /// A cloth that hangs from a line of a given height over x, pinned at some of its points, a little wider
    /// than its place there, so that it falls in folds.
    pub fn hanging(size: f32, side: usize, corner: Vec3, line: impl Fn(f32) -> f32) -> Self {
        let place = 0.9 * size;
        let point = |u: f32, v: f32| {
            let x = corner.x + place * u;
            let fold = 0.03 * (19.0 * u).sin() * (0.3 + v);
            Vec3::new(x, line(x) - size * v, corner.z + fold)
        };
        Self::new(size, side, point, |column, row| row == 0 && (column % 11 == 0 || column + 1 == side))
    }

    fn new(
        size: f32,
        side: usize,
        point: impl Fn(f32, f32) -> Vec3,
        pinned: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let share = |i: usize| i as f32 / (side - 1) as f32;
        let cells = (0..side * side).map(|i| (i % side, i / side));
        // Neighbours in the list of links have no point in common, so that the processor can meet several at
        // once: links along a row are listed column by column.
        let links_along = |rows: usize| {
            cells.clone().map(move |(column, row)| if rows == 0 { (row, column) } else { (column, row) })
        };
        let place = |(column, row)| point(share(column), share(row)).into();
        let points: Vec<Vec3A> = cells.clone().map(place).collect();
        let gap = size / (side - 1) as f32;
        let linked = |offsets: &[(usize, usize)], mirrored: bool| {
            let mut links = Vec::new();
            for (columns, rows) in offsets {
                let length = gap * Vec2::new(*columns as f32, *rows as f32).length();
                for (column, row) in
                    links_along(*rows).filter(|(column, row)| column + columns < side && row + rows < side)
                {
                    let (left, right) =
                        if mirrored { (column + columns, column) } else { (column, column + columns) };
                    links.push((row * side + left, (row + rows) * side + right, length));
                }
            }
            links
        };
        let mut links = linked(&[(1, 0), (0, 1), (1, 1)], false);
        links.extend(linked(&[(1, 1)], true));
        Self {
            side,
            before: points.clone(),
            points,
            free: cells.clone().map(|(column, row)| f32::from(!pinned(column, row))).collect(),
            links,
            stiffeners: linked(&[(2, 0), (0, 2)], false),
        }
    }

    /// Lets the cloth fall for some steps onto the floor at y = 0 and some solids.
    pub fn settle(&mut self, solids: &[Solid], steps: usize) {
        for _ in 0..steps {
            self.fall();
            for _ in 0..PASSES {
                self.keep_lengths();
                self.keep_out(solids);
            }
        }
    }

    fn fall(&mut self) {
        for ((point, before), free) in self.points.iter_mut().zip(&mut self.before).zip(&self.free) {
            let step = (*point - *before) * KEPT - Vec3A::Y * FALL;
            *before = *point;
            *point += step * *free;
        }
    }

    fn keep_lengths(&mut self) {
        for (a, b, length) in &self.links {
            meet(&mut self.points, &self.free, [*a, *b], *length, 1.0);
        }
        for (a, b, length) in &self.stiffeners {
            if self.points[*a].distance_squared(self.points[*b]) < length * length {
                meet(&mut self.points, &self.free, [*a, *b], *length, 0.15);
            }
        }
    }

    /// Pushes points out of solids and the floor; those that touch slide little.
    fn keep_out(&mut self, solids: &[Solid]) {
        for (point, before) in self.points.iter_mut().zip(&mut self.before) {
            let start = *point;
            for solid in solids {
                *point += Vec3A::from(solid.push((*point).into()).unwrap_or(Vec3::ZERO));
            }
            point.y = point.y.max(GAP);
            if *point != start {
                *before = before.lerp(*point, 0.3);
            }
        }
    }

    /// The cloth as a sheet with every cell cut into `finer` x `finer`, along smooth curves through the
    /// points.
    pub fn shape(&self, finer: usize) -> Shape {
        let points: Vec<Vec3> = self.points.iter().map(|point| Vec3::from(*point)).collect();
        let rows: Vec<Vec<Vec3>> = points.chunks(self.side).map(|row| curve(row, finer)).collect();
        let across = rows[0].len();
        let columns: Vec<Vec<Vec3>> =
            (0..across).map(|i| curve(&rows.iter().map(|row| row[i]).collect::<Vec<_>>(), finer)).collect();
        let last = across - 1;
        let at = |share: f32| (share * last as f32).round() as usize;
        sheet(last, last, |u, v| columns[at(u)][at(v)])
    }
}

/// Moves two points, as far as they are free, to a distance, or by a share of the way there.
fn meet(points: &mut [Vec3A], free: &[f32], [a, b]: [usize; 2], length: f32, share: f32) {
    let apart = points[b] - points[a];
    let distance = apart.length().max(1e-9);
    let shift = apart * (share * (distance - length) / (distance * (free[a] + free[b]).max(1.0)));
    points[a] += shift * free[a];
    points[b] -= shift * free[b];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloth_comes_to_rest_on_what_is_below_and_keeps_its_size() {
        let ball = Solid::Bar { from: Vec3::Y * 0.3, to: Vec3::Y * 0.3, radius: 0.2 };
        let mut cloth = Cloth::square(1.0, 30, Vec3::Y * 0.52, 0.3);
        cloth.settle(std::slice::from_ref(&ball), 200);
        assert!(cloth.points.iter().all(|point| point.y > 0.0 && point.distance(Vec3A::Y * 0.3) > 0.2));
        let lowest = cloth.points.iter().fold(f32::MAX, |lowest, point| lowest.min(point.y));
        let highest = cloth.points.iter().fold(0f32, |highest, point| highest.max(point.y));
        assert!(lowest < 0.2 && (0.5..0.55).contains(&highest), "{lowest} {highest}");
        let stretched = |(a, b, length): &&(usize, usize, f32)| {
            cloth.points[*a].distance(cloth.points[*b]) > 1.25 * length
        };
        assert!(cloth.links.iter().filter(stretched).count() < cloth.links.len() / 50);
    }

    #[test]
    fn boxes_push_points_out_of_their_nearest_side() {
        let solid = Solid::Box { middle: Vec3::ZERO, half: Vec3::splat(0.5) };
        let push = solid.push(Vec3::new(0.1, 0.45, 0.0)).expect("the point is inside");
        assert!((push - Vec3::Y * (0.05 + GAP)).length() < 1e-6);
        assert!(solid.push(Vec3::splat(0.6)).is_none());
    }

    #[test]
    fn pinned_points_stay() {
        let mut cloth = Cloth::hanging(0.6, 23, Vec3::ZERO, |_| 1.5);
        let corner = cloth.points[0];
        cloth.settle(&[], 60);
        assert_eq!(cloth.points[0], corner);
        assert!(cloth.points[22 * 23 + 11].y < 1.0);
    }
}
