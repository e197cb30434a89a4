//! Which triangle a ray meets: a scene with bounding volume hierarchies over it; a binary one, built by
//! `obvhs`, for bundles of rays of a camera, and an eight-wide one made from it for all others.
//!
//! Triangles lie in the order of the eight-wide hierarchy's leaves. Where a material is masked or blended,
//! opacity decides whether a triangle is there at all; what chance decides of one is decided by its mesh and
//! its index there, so that images do not depend on how the hierarchies were built.

pub mod bundle;
pub mod clock;
pub mod scene_at_time;
mod translucent;
mod wide;

use crate::sampler::hash;
use crate::scene::memory;
use crate::scene::{AlphaMode, Bounds, Look, Material, Mesh, Scene, SceneError, SceneSource};
use bundle::World;
use glam::{Vec2, Vec3, Vec3A};
use obvhs::{
    Boundable, BvhBuildParams,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
    triangle::Triangle,
};
use scene_at_time::{SceneAtTime, Swept};
use std::sync::Arc;
use wide::{Fan, Ray, Wide};

/// Opacity from which a blended surface is seen by a camera, which cannot see two surfaces at once.
pub const VISIBLE_OPACITY: f32 = 0.5;

/// Largest diagonal of a scene, metres: beyond it products of lengths leave the range of f32, and no scene is
/// meant.
const LARGEST_DIAGONAL: f32 = 1e9;

/// A scene that rays can be traced through. Copies share the hierarchies.
#[derive(Clone)]
pub struct TracedScene {
    scene: Scene,
    bounds: Bounds,
    bvh: Arc<Wide>,
    /// For bundles; its leaves point to `triangles`.
    binary: Arc<Bvh2>,
    /// In the order of `bvh`.
    triangles: Arc<[Triangle]>,
    /// Mesh and triangle in it, of each of `triangles`.
    origins: Arc<[TriangleOrigin]>,
    /// Of each mesh, whether its material could be seen through when the hierarchies were built.
    seen_through: Arc<[bool]>,
    /// Whether a material is blended.
    blended: bool,
    /// For moments other than the middle of the exposure; `None` where nothing moves.
    swept: Option<Arc<Swept>>,
    /// What it was like, the oldest first: from when on.
    past: Arc<[(f32, TracedScene)]>,
}

/// Where a triangle comes from.
#[derive(Clone, Copy, Debug)]
struct TriangleOrigin {
    mesh: u32,
    triangle: u32,
    /// Whether the material's opacity must be asked.
    see_through: bool,
}

impl TriangleOrigin {
    /// A number that no hierarchy changes.
    const fn key(self) -> u32 {
        hash(self.triangle ^ hash(self.mesh))
    }
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in lengths of its direction.
    pub distance: f32,
    /// Index into [`Scene::meshes`].
    pub mesh: u32,
    /// Index into that mesh's triangles.
    pub triangle: u32,
    /// Weights of the second and third corner.
    pub barycentric: Vec2,
}

impl TracedScene {
    /// Builds the hierarchy, and one more over the triangles' ways where some move.
    ///
    /// # Errors
    /// If a vertex is not finite or its displacement is missing, there is no triangle, there are more than
    /// memory holds (at 512 bytes each, twice that where any moves), the scene is more than 1e9 m across, or
    /// [`Scene::check_look`] refuses its look.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        check(&scene)?;
        let triangles = scene.triangle_count() * if scene.moves() { 2 } else { 1 };
        memory::check(&scene.name, triangles, memory::available())?;
        let seen_through: Arc<[bool]> = seen_through(&scene).collect();
        let (triangles, origins) = flattened(&scene, &seen_through);
        let (bvh, binary) = hierarchies(&triangles, &origins);
        let in_order = |index: &u32| *index as usize;
        Ok(Self {
            bounds: scene.bounds(),
            swept: Swept::new(&scene, &seen_through).map(Arc::new),
            seen_through,
            blended: has_blended(&scene),
            scene,
            triangles: bvh.order().iter().map(|index| triangles[in_order(index)]).collect(),
            origins: bvh.order().iter().map(|index| origins[in_order(index)]).collect(),
            bvh: Arc::new(bvh),
            binary: Arc::new(binary),
            past: Arc::new([]),
        })
    }

    /// The same triangles with another look.
    ///
    /// # Errors
    /// If [`Scene::check_look`] refuses it, or a mesh that was opaque when the hierarchies were built can be
    /// seen through.
    pub fn with_look(&self, look: Look) -> Result<Self, SceneError> {
        let mut copy = self.clone();
        copy.scene.set_look(look);
        let scene = &copy.scene;
        scene.check_look()?;
        let changed = seen_through(scene).zip(&*self.seen_through).position(|(now, built)| now && !built);
        if let Some(Mesh { name, material, .. }) = changed.map(|index| &scene.meshes[index]) {
            let material = &scene.material(*material).name;
            let what =
                format!("mesh `{name}` was built opaque, and material `{material}` can be seen through");
            return Err(SceneError::invalid(scene.name.as_ref(), what));
        }
        copy.blended = has_blended(scene);
        Ok(copy)
    }

    /// The same triangles on other ways: one list a mesh, as [`Mesh::displacements`] is. Only the hierarchy
    /// over the ways is built.
    ///
    /// # Errors
    /// If there is not a list for each mesh, and those of [`TracedScene::new`].
    pub fn with_motion(&self, displacements: Vec<Vec<Vec3>>) -> Result<Self, SceneError> {
        let (lists, meshes) = (displacements.len(), self.scene.meshes.len());
        if lists != meshes {
            let what = format!("has {meshes} meshes, and there are displacements for {lists}");
            return Err(SceneError::invalid(self.scene.name.as_ref(), what));
        }
        let mut copy = self.clone();
        for (mesh, displacements) in copy.scene.meshes.iter_mut().zip(displacements) {
            mesh.displacements = displacements;
        }
        check(&copy.scene)?;
        memory::check(&copy.scene.name, copy.scene.triangle_count(), memory::available())?;
        copy.swept = Swept::new(&copy.scene, &copy.seen_through).map(Arc::new);
        Ok(copy)
    }

    /// The same, with what it was like before: poses, each with the moment from which on it stands for the
    /// scene, seconds, the oldest first. The first stands for all before it, too.
    ///
    /// # Errors
    /// If a pose has not the same triangles, moved.
    pub fn with_past(self, past: Vec<(f32, Self)>) -> Result<Self, SceneError> {
        let shape = |scene: &Scene| -> Vec<(usize, u32)> {
            scene.meshes.iter().map(|mesh| (mesh.triangles.len(), mesh.material.0)).collect()
        };
        let own = shape(&self.scene);
        if past.iter().any(|(_, pose)| shape(&pose.scene) != own) {
            let what = "has triangles that come and go as it moves".to_owned();
            return Err(SceneError::invalid(self.scene.name.as_ref(), what));
        }
        Ok(Self { past: past.into(), ..self })
    }

    /// What it was like before, as [`Self::with_past`] says; nothing where it stays.
    pub fn past(&self) -> &[(f32, Self)] {
        &self.past
    }

    /// The scene itself.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The box around it.
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Length of that box's diagonal, metres.
    pub fn diagonal(&self) -> f32 {
        self.bounds.diagonal()
    }

    /// The scene at a moment of the exposure, from -0.5 at its beginning to 0.5 at its end. Times outside are
    /// those two. Everything else here shows the middle, 0.
    pub const fn at(&self, time: f32) -> SceneAtTime<'_> {
        SceneAtTime::new(self, time)
    }

    /// The nearest surface that a camera sees along a ray, up to `reach` lengths of `direction`. What masks
    /// leave out and what is more than half transparent is not seen.
    pub fn hit(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        self.nearest(ray(origin, direction, reach), |opacity, _| opacity >= VISIBLE_OPACITY)
    }

    /// [`TracedScene::hit`] for rays without an end that start together, at most [`bundle::BUNDLE`] of them;
    /// the nearer neighbours are to each other, the faster it goes.
    pub fn hit_bundle(&self, origin: Vec3, directions: &[Vec3]) -> Vec<Option<Hit>> {
        let endless = |direction: Vec3| ray(origin, direction, f32::INFINITY);
        let visible = |index: u32, direction: Vec3| {
            self.opacity(&endless(direction), index as usize) >= VISIBLE_OPACITY
        };
        let met = clock::around(|| self.world(visible).nearest(origin, directions));
        let hit = |(met, direction): (Option<(f32, u32)>, &Vec3)| {
            met.map(|(distance, index)| self.hit_at(&endless(*direction), index, distance))
        };
        met.into_iter().zip(directions).map(hit).collect()
    }

    /// Whether anything stops light along a ray within `reach` lengths of `direction`. A blended surface
    /// stops it with the probability of its opacity, decided by a hash of the ray and the triangle.
    pub fn blocked(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        let ray = ray(origin, direction, reach);
        self.meets_any(ray, |opacity, triangle| stops(opacity, &ray, triangle))
    }

    /// [`TracedScene::blocked`] for rays that start together: bit `i` is set where `directions[i]` is
    /// blocked, of at most [`bundle::BUNDLE`]; the nearer neighbours are to each other, the faster it goes.
    pub fn blocked_bundle(&self, origin: Vec3, directions: &[Vec3], reach: f32) -> u64 {
        let there = |index: u32, direction: Vec3| {
            let ray = ray(origin, direction, reach);
            stops(self.opacity(&ray, index as usize), &ray, self.origins[index as usize])
        };
        let directions = &directions[..directions.len().min(bundle::BUNDLE)];
        clock::around(|| self.bvh.all_blocked(Fan { origin, directions, reach }, there))
    }

    /// What bundles are traced through.
    fn world<P: Fn(u32, Vec3) -> bool>(&self, stops: P) -> World<'_, impl Fn(u32) -> bool, P> {
        let opaque = |index: u32| !self.origins[index as usize].see_through;
        World { bvh: &self.binary, triangles: &self.triangles, opaque, stops }
    }

    /// Where a ray met a triangle, by its index in the hierarchy.
    fn hit_at(&self, ray: &Ray, index: u32, distance: f32) -> Hit {
        let TriangleOrigin { mesh, triangle, .. } = self.origins[index as usize];
        Hit { distance, mesh, triangle, barycentric: barycentric(&self.triangles[index as usize], ray) }
    }

    /// The nearest triangle that a ray meets, of those that can be seen through only where `present` says so
    /// of their opacity there.
    fn nearest(&self, ray: Ray, present: impl Fn(f32, TriangleOrigin) -> bool) -> Option<Hit> {
        let there = |index: u32| present(self.opacity(&ray, index as usize), self.origins[index as usize]);
        let (distance, index) = clock::around(|| self.bvh.nearest(&ray, there))?;
        Some(self.hit_at(&ray, index, distance))
    }

    /// Whether a ray meets any triangle, of those that can be seen through only where they are `present`.
    fn meets_any(&self, ray: Ray, present: impl Fn(f32, TriangleOrigin) -> bool) -> bool {
        let there = |index: u32| present(self.opacity(&ray, index as usize), self.origins[index as usize]);
        clock::around(|| self.bvh.blocked(&ray, there))
    }

    /// Opacity of a triangle where a ray meets it.
    #[cold]
    fn opacity(&self, ray: &Ray, index: usize) -> f32 {
        opacity(&self.scene, self.origins[index], barycentric(&self.triangles[index], ray))
    }
}

impl std::fmt::Debug for TracedScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "TracedScene({}, {} triangles)", self.scene.name, self.scene.triangle_count())
    }
}

/// Weights of all three corners.
pub fn corner_weights(barycentric: Vec2) -> [f32; 3] {
    [1.0 - barycentric.x - barycentric.y, barycentric.x, barycentric.y]
}

/// What [`TracedScene::new`] refuses, whatever the memory.
fn check(scene: &Scene) -> Result<(), SceneError> {
    let invalid = |what: String| Err(SceneError::invalid(scene.name.as_ref(), what));
    for mesh in &scene.meshes {
        let (name, vertices, displacements) = (&mesh.name, mesh.positions.len(), mesh.displacements.len());
        if !mesh.positions.iter().all(|position| position.is_finite()) {
            return invalid(format!("mesh `{name}` has a vertex that is not finite"));
        }
        if !mesh.displacements.iter().all(|displacement| displacement.is_finite()) {
            return invalid(format!("mesh `{name}` has a displacement that is not finite"));
        }
        if displacements != 0 && displacements != vertices {
            return invalid(format!(
                "mesh `{name}` has {displacements} displacements for {vertices} vertices"
            ));
        }
    }
    if scene.triangle_count() == 0 {
        return Err(SceneError::Empty { name: scene.name.clone() });
    }
    let diagonal = scene.swept_bounds().diagonal();
    if !diagonal.is_finite() || diagonal > LARGEST_DIAGONAL {
        return invalid(format!("is {diagonal:e} m across, more than {LARGEST_DIAGONAL:e} m"));
    }
    scene.check_look()
}

/// Of each mesh, whether its material must be asked if light passes.
fn seen_through(scene: &Scene) -> impl Iterator<Item = bool> {
    let asked = |material: &Material| material.can_be_seen_through() || material.may_pass_light_straight();
    scene.meshes.iter().map(move |mesh| asked(scene.material(mesh.material)))
}

fn has_blended(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| material.alpha == AlphaMode::Blend)
}

/// Opacity of a triangle at a point of it.
fn opacity(scene: &Scene, TriangleOrigin { mesh, triangle, .. }: TriangleOrigin, barycentric: Vec2) -> f32 {
    let mesh = &scene.meshes[mesh as usize];
    let weights = corner_weights(barycentric);
    let corners = mesh.triangles[triangle as usize];
    scene.material(mesh.material).opacity(
        &scene.textures,
        crate::intersection::uvs(mesh, corners, weights),
        crate::intersection::colour(mesh, corners, weights),
    )
}

/// All triangles of a scene, of meshes that can be `seen_through` or not, with where they come from.
fn flattened(scene: &Scene, seen_through: &[bool]) -> (Vec<Triangle>, Vec<TriangleOrigin>) {
    let mut triangles = Vec::with_capacity(scene.triangle_count());
    let mut origins = Vec::with_capacity(scene.triangle_count());
    for (mesh_index, (mesh, see_through)) in scene.meshes.iter().zip(seen_through).enumerate() {
        for triangle in 0..mesh.triangles.len() {
            let [v0, v1, v2] = mesh.corners(triangle).map(Vec3A::from);
            triangles.push(Triangle { v0, v1, v2 });
            let (mesh, triangle, see_through) = (mesh_index as u32, triangle as u32, *see_through);
            origins.push(TriangleOrigin { mesh, triangle, see_through });
        }
    }
    (triangles, origins)
}

/// The hierarchies over triangles: one build, two layouts.
fn hierarchies(triangles: &[Triangle], origins: &[TriangleOrigin]) -> (Wide, Bvh2) {
    let params = BvhBuildParams::medium_build();
    let mut binary = binary_hierarchy(triangles);
    let corners = |index: u32| {
        let Triangle { v0, v1, v2 } = triangles[index as usize];
        [v0.into(), v1.into(), v2.into()]
    };
    let wide = Wide::new(&binary, corners, |index| origins[index as usize].see_through);
    collapse(&mut binary, params.max_prims_per_leaf, params.collapse_traversal_cost);
    let mut places = vec![0; triangles.len()];
    for (place, triangle) in wide.order().iter().enumerate() {
        places[*triangle as usize] = place as u32;
    }
    for triangle in &mut binary.primitive_indices {
        *triangle = places[*triangle as usize];
    }
    (wide, binary)
}

/// A binary hierarchy with one primitive a leaf.
fn binary_hierarchy<T: Boundable>(primitives: &[T]) -> Bvh2 {
    let params = BvhBuildParams::medium_build();
    let mut binary = PlocBuilder::with_capacity(primitives.len()).build(
        params.ploc_search_distance,
        primitives,
        (0..primitives.len() as u32).collect(),
        params.sort_precision,
        params.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut binary, params.reinsertion_batch_ratio, None);
    binary
}

/// Whether a surface of some opacity stops a ray.
fn stops(opacity: f32, ray: &Ray, triangle: TriangleOrigin) -> bool {
    opacity >= 1.0 || (opacity > 0.0 && opacity > ray_hash(ray, triangle))
}

/// A ray in the middle of the exposure.
fn ray(origin: Vec3, direction: Vec3, reach: f32) -> Ray {
    Ray { origin: origin.into(), direction: direction.into(), reach, time: 0.0 }
}

/// Weights of the second and third corner where a ray meets a triangle's plane.
fn barycentric(triangle: &Triangle, ray: &Ray) -> Vec2 {
    let edge1 = triangle.v1 - triangle.v0;
    let edge2 = triangle.v2 - triangle.v0;
    let across = ray.direction.cross(edge2);
    let inverse = edge1.dot(across).recip();
    let from_corner = ray.origin - triangle.v0;
    let u = from_corner.dot(across) * inverse;
    let v = ray.direction.dot(from_corner.cross(edge1)) * inverse;
    Vec2::new(u, v).clamp(Vec2::ZERO, Vec2::ONE)
}

/// A number in [0, 1) that a ray and a triangle share, for decisions that must not depend on threads.
fn ray_hash(ray: &Ray, triangle: TriangleOrigin) -> f32 {
    let words = [ray.direction.x, ray.direction.y, ray.direction.z, ray.origin.x, ray.origin.y, ray.origin.z];
    let mixed = words.iter().fold(triangle.key(), |mixed, word| hash(mixed ^ word.to_bits()));
    (mixed >> 8) as f32 / 16_777_216.0
}

impl SceneSource {
    /// [`SceneSource::scene`], ready for rays.
    ///
    /// # Errors
    /// If the file is missing or damaged.
    pub fn trace(&self, time: f32) -> Result<TracedScene, SceneError> {
        TracedScene::new(self.scene(time)?)
    }
}

#[cfg(test)]
mod tests;
