//! Triangles without a material, and how they are placed, bent and joined.
//!
//! Shapes stand on y = 0 around the y axis unless they say otherwise. Texture coordinates are in metres, so
//! that a texture has the same size on everything.

use glam::{Affine3A, Mat3, Quat, Vec2, Vec3};
use std::collections::HashMap;
use std::ops::Add;

/// An indexed triangle mesh with normals and texture coordinates for every vertex.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Vertices, metres.
    pub positions: Vec<Vec3>,
    /// Unit shading normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, metres.
    pub uvs: Vec<Vec2>,
    /// Counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Adds a vertex and gives its index.
    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// Adds a flat convex polygon, counter-clockwise seen from the front.
    pub fn polygon(&mut self, corners: &[Vec3]) {
        let normal = newell(corners);
        let along = (corners[1] - corners[0]).normalize_or(Vec3::X);
        let across = along.cross(normal);
        let place =
            |corner: &Vec3| Vec2::new((corner - corners[0]).dot(along), (corner - corners[0]).dot(across));
        let first = self.positions.len() as u32;
        for corner in corners {
            self.vertex(*corner, normal, place(corner));
        }
        self.triangles.extend((1..corners.len() as u32 - 1).map(|i| [first, first + i, first + i + 1]));
    }

    /// Adds the two triangles of a quadrilateral of vertices, counter-clockwise seen from the front.
    pub fn connect(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// Adds another shape.
    pub fn join(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }

    /// The shape moved.
    pub fn moved(mut self, x: f32, y: f32, z: f32) -> Self {
        self.positions.iter_mut().for_each(|position| *position += Vec3::new(x, y, z));
        self
    }

    /// The shape moved to a point.
    pub fn at(self, point: Vec3) -> Self {
        self.moved(point.x, point.y, point.z)
    }

    /// The shape turned about the y axis, counter-clockwise seen from above, radians.
    pub fn turned(self, angle: f32) -> Self {
        self.rotated(Quat::from_rotation_y(angle))
    }

    /// The shape turned about the x axis, from y towards z, radians.
    pub fn pitched(self, angle: f32) -> Self {
        self.rotated(Quat::from_rotation_x(angle))
    }

    /// The shape turned about the z axis, from x towards y, radians.
    pub fn rolled(self, angle: f32) -> Self {
        self.rotated(Quat::from_rotation_z(angle))
    }

    /// The shape rotated about the origin.
    pub fn rotated(self, rotation: Quat) -> Self {
        self.transformed(Affine3A::from_quat(rotation))
    }

    /// The shape with its y axis pointing along a direction.
    pub fn aimed(self, direction: Vec3) -> Self {
        self.rotated(Quat::from_rotation_arc(Vec3::Y, direction.normalize()))
    }

    /// The shape scaled about the origin by positive factors.
    pub fn scaled(self, x: f32, y: f32, z: f32) -> Self {
        self.transformed(Affine3A::from_scale(Vec3::new(x, y, z)))
    }

    /// The shape after a transform that keeps its handedness.
    pub fn transformed(mut self, transform: Affine3A) -> Self {
        let normal_matrix = Mat3::from(transform.matrix3).inverse().transpose();
        for position in &mut self.positions {
            *position = transform.transform_point3(*position);
        }
        for normal in &mut self.normals {
            *normal = (normal_matrix * *normal).normalize();
        }
        self
    }

    /// The shape with every vertex put somewhere else; vertices in the same place must go to the same place.
    /// Normals are made new, smooth over shared vertices.
    pub fn bent(mut self, bend: impl Fn(Vec3, Vec3) -> Vec3) -> Self {
        for (position, normal) in self.positions.iter_mut().zip(&self.normals) {
            *position = bend(*position, *normal);
        }
        self.smoothed()
    }

    /// The shape with normals averaged over the triangles around each vertex, weighted by their areas.
    pub fn smoothed(mut self) -> Self {
        self.normals = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            triangle.iter().for_each(|vertex| self.normals[*vertex as usize] += normal);
        }
        self.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(Vec3::Y));
        self
    }

    /// The shape with vertices in the same place made one, so that [`Self::bent`] and [`Self::smoothed`] see
    /// no seams.
    pub fn welded(self) -> Self {
        let mut welded = Self::default();
        let mut found = HashMap::new();
        let places: Vec<u32> = (0..self.positions.len())
            .map(|i| {
                let position = self.positions[i];
                // Adding zero makes -0 and 0 the same.
                let key = (position + Vec3::ZERO).to_array().map(f32::to_bits);
                *found.entry(key).or_insert_with(|| welded.vertex(position, self.normals[i], self.uvs[i]))
            })
            .collect();
        let triangles = self.triangles.iter().map(|triangle| triangle.map(|vertex| places[vertex as usize]));
        welded.triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        welded
    }

    /// The shape seen from its other side.
    pub fn reversed(mut self) -> Self {
        self.normals.iter_mut().for_each(|normal| *normal = -*normal);
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self
    }

    /// Copies of the shape, one at each point.
    pub fn at_each(&self, points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().map(|point| self.clone().at(point)).collect()
    }

    /// Copies of the shape turned about the y axis in equal steps.
    pub fn around(&self, count: usize) -> Self {
        let step = std::f32::consts::TAU / count as f32;
        (0..count).map(|i| self.clone().turned(step * i as f32)).collect()
    }

    /// Volume of a closed shape, positive where triangles face outwards.
    #[cfg(test)]
    pub fn signed_volume(&self) -> f32 {
        let corner = |vertex: u32| self.positions[vertex as usize];
        let cone = |[a, b, c]: &[u32; 3]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0;
        self.triangles.iter().map(cone).sum()
    }
}

impl Add for Shape {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.join(other);
        self
    }
}

impl FromIterator<Shape> for Shape {
    fn from_iter<I: IntoIterator<Item = Shape>>(shapes: I) -> Self {
        shapes.into_iter().fold(Self::default(), Add::add)
    }
}

/// Unit normal of a polygon by Newell's method (Sutherland, Sproull and Schumacker 1974), which bears
/// repeated corners.
fn newell(corners: &[Vec3]) -> Vec3 {
    let next = corners.iter().cycle().skip(1);
    let sum: Vec3 = corners.iter().zip(next).map(|(a, b)| (a - corners[0]).cross(b - corners[0])).sum();
    sum.normalize_or(Vec3::Y)
}
