//! A triangle mesh in world space.

use super::MaterialId;
use glam::{Vec2, Vec3, Vec4};

/// A triangle mesh in world space. Optional attributes are empty or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// What the file calls it.
    pub name: String,
    /// What it is made of.
    pub material: MaterialId,
    /// Vertices, metres.
    pub positions: Vec<Vec3>,
    /// Unit shading normals; where empty, triangles are flat.
    pub normals: Vec<Vec3>,
    /// How far each vertex moves while the shutter is open, world space, metres; where empty, nothing moves.
    /// `positions` are those of the middle of that time.
    pub displacements: Vec<Vec3>,
    /// Unit tangents with the bitangent's sign in w, as glTF has them; may be empty.
    pub tangents: Vec<Vec4>,
    /// Two sets of texture coordinates, origin top left as in glTF; each may be empty.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear vertex colours with alpha; may be empty.
    pub colours: Vec<Vec4>,
    /// Three vertex indices a triangle, all below `positions.len()`, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The three corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// The box around the vertices in use.
    pub fn bounds(&self) -> Bounds {
        self.triangles
            .iter()
            .flatten()
            .fold(Bounds::EMPTY, |bounds, vertex| bounds.grow(self.positions[*vertex as usize]))
    }

    /// Where a vertex is at a moment of the exposure, from -0.5 to 0.5.
    pub fn position_at(&self, vertex: u32, time: f32) -> Vec3 {
        let displacement = self.displacements.get(vertex as usize).copied().unwrap_or(Vec3::ZERO);
        self.positions[vertex as usize] + displacement * time
    }

    /// The box around the ways of the vertices in use, while the shutter is open.
    pub fn swept_bounds(&self) -> Bounds {
        let ends = |vertex: &u32| [-0.5, 0.5].map(|time| self.position_at(*vertex, time));
        self.triangles.iter().flatten().flat_map(ends).fold(Bounds::EMPTY, Bounds::grow)
    }

    /// Takes out triangles without an area.
    pub fn drop_degenerate_triangles(&mut self) {
        let positions = &self.positions;
        self.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            normal.length_squared() > 0.0 && normal.is_finite()
        });
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: Vec3,
    /// Highest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box around nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around this one and a point.
    pub fn grow(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around two.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths.
    pub fn size(self) -> Vec3 {
        self.max - self.min
    }

    /// Its eight corners.
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Middle.
    pub fn centre(self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Length of the diagonal, the unit in which effect radii are stated.
    pub fn diagonal(self) -> f32 {
        self.size().length()
    }
}
