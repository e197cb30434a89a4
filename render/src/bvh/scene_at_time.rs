//! A scene at one moment of the exposure: what rays meet when triangles have moved.
//!
//! Where anything moves, a hierarchy of its own holds every triangle in the box of its whole way, and a
//! triangle is put where it is at the ray's time before it is met (linear motion: Glassner 1988, "Spacetime
//! ray tracing for animation"). The middle of the exposure, and scenes in which nothing moves, are traced as
//! if there were no time.

use super::translucent::left;
use super::wide::{Ray, Wide};
use super::{
    Hit, TracedScene, TriangleOrigin, VISIBLE_OPACITY, barycentric, binary_hierarchy, clock, opacity, ray,
    stops,
};
use crate::scene::{Mesh, Scene};
use glam::{Vec3, Vec3A};
use obvhs::{Boundable, aabb::Aabb, triangle::Triangle};

/// A scene at one moment of the exposure.
#[derive(Clone, Copy, Debug)]
pub struct SceneAtTime<'a> {
    traced: &'a TracedScene,
    time: f32,
}

impl<'a> SceneAtTime<'a> {
    /// [`TracedScene::at`].
    pub(super) const fn new(traced: &'a TracedScene, time: f32) -> Self {
        Self { traced, time: time.clamp(-0.5, 0.5) }
    }

    /// The scene, as it is in the middle of the exposure.
    pub const fn scene(&self) -> &'a Scene {
        self.traced.scene()
    }

    /// The moment, from -0.5 at the beginning of the exposure to 0.5 at its end.
    pub const fn time(&self) -> f32 {
        self.time
    }

    /// The three corners of a triangle of a mesh, now.
    pub fn corners(&self, mesh: &Mesh, triangle: usize) -> [Vec3; 3] {
        match self.swept() {
            Some(_) => mesh.triangles[triangle].map(|vertex| mesh.position_at(vertex, self.time)),
            None => mesh.corners(triangle),
        }
    }

    /// [`TracedScene::hit`] at this moment.
    pub fn hit(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        let Some(swept) = self.swept() else { return self.traced.hit(origin, direction, reach) };
        let ray = Ray { time: self.time, ..ray(origin, direction, reach) };
        let visible = |index| self.opacity(swept, &ray, index) >= VISIBLE_OPACITY;
        let (distance, index) = clock::around(|| swept.bvh.nearest(&ray, visible))?;
        let TriangleOrigin { mesh, triangle, .. } = swept.origins[index as usize];
        let barycentric = barycentric(&swept.triangles[index as usize].at(self.time), &ray);
        Some(Hit { distance, mesh, triangle, barycentric })
    }

    /// [`TracedScene::blocked`] at this moment.
    pub fn blocked(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        let Some(swept) = self.swept() else { return self.traced.blocked(origin, direction, reach) };
        let ray = Ray { time: self.time, ..ray(origin, direction, reach) };
        let stops = |index| stops(self.opacity(swept, &ray, index), &ray, swept.origins[index as usize]);
        clock::around(|| swept.bvh.blocked(&ray, stops))
    }

    /// [`TracedScene::let_through`] at this moment.
    pub fn let_through(&self, origin: Vec3, direction: Vec3, reach: f32) -> f32 {
        let Some(swept) = self.swept() else { return self.traced.let_through(origin, direction, reach) };
        let ray = Ray { time: self.time, ..ray(origin, direction, reach) };
        left(|ends| {
            let stops = |index| ends(self.opacity(swept, &ray, index));
            clock::around(|| swept.bvh.blocked(&ray, stops))
        })
    }

    /// The ways to trace through; `None` where the triangles are at their places in the middle.
    fn swept(&self) -> Option<&'a Swept> {
        self.traced.swept.as_deref().filter(|_| self.time != 0.0)
    }

    /// Opacity of a triangle where a ray meets it.
    #[cold]
    fn opacity(&self, swept: &Swept, ray: &Ray, index: u32) -> f32 {
        let triangle = swept.triangles[index as usize].at(self.time);
        opacity(self.scene(), swept.origins[index as usize], barycentric(&triangle, ray))
    }
}

impl<'a> From<&'a TracedScene> for SceneAtTime<'a> {
    /// The middle of the exposure.
    fn from(scene: &'a TracedScene) -> Self {
        scene.at(0.0)
    }
}

/// All triangles of a scene on their ways.
pub(super) struct Swept {
    /// Its boxes hold the whole ways.
    bvh: Wide,
    /// In the order of `bvh`.
    triangles: Vec<MovingTriangle>,
    /// Mesh and triangle in it, of each of `triangles`.
    origins: Vec<TriangleOrigin>,
}

impl Swept {
    /// The ways of a scene's triangles, of meshes that can be `seen_through` or not; `None` where none moves.
    pub fn new(scene: &Scene, seen_through: &[bool]) -> Option<Self> {
        if !scene.moves() {
            return None;
        }
        let (mut triangles, mut origins) = (Vec::new(), Vec::new());
        for (mesh_index, (mesh, see_through)) in scene.meshes.iter().zip(seen_through).enumerate() {
            for triangle in 0..mesh.triangles.len() {
                triangles.push(MovingTriangle::new(mesh, triangle));
                origins.push(TriangleOrigin {
                    mesh: mesh_index as u32,
                    triangle: triangle as u32,
                    see_through: *see_through,
                });
            }
        }
        let moving = |index: u32| -> &MovingTriangle { &triangles[index as usize] };
        let asked = |index: u32| origins[index as usize].see_through;
        let bvh =
            Wide::new(&binary_hierarchy(&triangles), |index| moving(index).corners.map(Vec3::from), asked)
                .moving(|index| moving(index).displacements.map(Vec3::from));
        let in_order = |index: &u32| *index as usize;
        Some(Self {
            triangles: bvh.order().iter().map(|index| triangles[in_order(index)]).collect(),
            origins: bvh.order().iter().map(|index| origins[in_order(index)]).collect(),
            bvh,
        })
    }
}

/// A triangle whose corners move on straight lines.
#[derive(Clone, Copy, Debug)]
struct MovingTriangle {
    /// In the middle of the exposure.
    corners: [Vec3A; 3],
    /// Of each corner, during all of it.
    displacements: [Vec3A; 3],
}

impl MovingTriangle {
    fn new(mesh: &Mesh, triangle: usize) -> Self {
        let displacement =
            |vertex: u32| mesh.displacements.get(vertex as usize).copied().unwrap_or(Vec3::ZERO);
        Self {
            corners: mesh.corners(triangle).map(Vec3A::from),
            displacements: mesh.triangles[triangle].map(|vertex| displacement(vertex).into()),
        }
    }

    /// Where it is at a moment.
    #[inline]
    fn at(&self, time: f32) -> Triangle {
        let corner = |i: usize| self.corners[i] + self.displacements[i] * time;
        Triangle { v0: corner(0), v1: corner(1), v2: corner(2) }
    }
}

impl Boundable for MovingTriangle {
    /// The box of the whole way: corners between its ends round to between the ends.
    fn aabb(&self) -> Aabb {
        self.at(-0.5).aabb().union(&self.at(0.5).aabb())
    }
}

#[cfg(test)]
mod tests;
