//! Which triangle a ray meets: a scene with bounding volume hierarchies over it, built by `obvhs`; an eight-wide one for
//! single rays, a binary one for bundles of rays from one point.
//!
//! Triangles lie in the order of the eight-wide hierarchy's leaves. Where a material is masked or blended, opacity
//! decides whether a triangle is there at all.

pub mod bundle;

use crate::scene::{AlphaMode, Bounds, Scene, SceneError};
use bundle::{Start, World};
use glam::{Vec2, Vec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh},
    ploc::PlocBuilder,
    ray::{Ray, RayHit},
    triangle::Triangle,
};

/// Opacity from which a blended surface is seen by a camera, which cannot see two surfaces at once.
const VISIBLE_OPACITY: f32 = 0.5;

/// Largest diagonal of a scene, metres: beyond it products of lengths leave the range of f32, and no scene is meant.
const LARGEST_DIAGONAL: f32 = 1e9;

/// A scene that rays can be traced through.
pub struct TracedScene {
    scene: Scene,
    bounds: Bounds,
    bvh: CwBvh,
    /// For bundles; its leaves point to `triangles`.
    binary: Bvh2,
    /// In the order of `bvh`.
    triangles: Vec<Triangle>,
    /// Mesh and triangle in it, of each of `triangles`.
    origins: Vec<TriangleOrigin>,
}

/// Where a triangle comes from.
#[derive(Clone, Copy, Debug)]
struct TriangleOrigin {
    mesh: u32,
    triangle: u32,
    /// Whether the material's opacity must be asked.
    see_through: bool,
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
    /// Builds the hierarchy.
    ///
    /// # Errors
    /// If a vertex is not finite, there is no triangle, or the scene is more than 1e9 m across.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        let finite = |mesh: &crate::scene::Mesh| mesh.positions.iter().all(|position| position.is_finite());
        if let Some(mesh) = scene.meshes.iter().find(|mesh| !finite(mesh)) {
            return Err(SceneError::invalid(
                scene.name.as_ref(),
                format!("mesh `{}` has a vertex that is not finite", mesh.name),
            ));
        }
        if scene.triangle_count() == 0 {
            return Err(SceneError::Empty { name: scene.name });
        }
        let diagonal = scene.bounds().diagonal();
        if !diagonal.is_finite() || diagonal > LARGEST_DIAGONAL {
            let what = format!("is {diagonal:e} m across, more than {LARGEST_DIAGONAL:e} m");
            return Err(SceneError::invalid(scene.name.as_ref(), what));
        }
        let (triangles, origins) = flattened(&scene);
        let (bvh, binary) = hierarchies(&triangles);
        let in_order = |index: &u32| *index as usize;
        Ok(Self {
            bounds: scene.bounds(),
            scene,
            triangles: bvh.primitive_indices.iter().map(|index| triangles[in_order(index)]).collect(),
            origins: bvh.primitive_indices.iter().map(|index| origins[in_order(index)]).collect(),
            bvh,
            binary,
        })
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

    /// The nearest surface that a camera sees along a ray, up to `reach` lengths of `direction`. What masks leave
    /// out and what is more than half transparent is not seen.
    pub fn hit(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        let ray = ray(origin, direction, reach);
        let mut nearest = RayHit::none();
        self.bvh.ray_traverse(ray, &mut nearest, |ray, index| {
            self.distance(ray, index, |opacity| opacity >= VISIBLE_OPACITY)
        });
        if nearest.t >= reach {
            return None;
        }
        Some(self.hit_at(&ray, nearest.primitive_id, nearest.t))
    }

    /// [`TracedScene::hit`] for rays without an end that start together, at most [`bundle::BUNDLE`] of them; the nearer
    /// neighbours are to each other, the faster it goes.
    pub fn hit_bundle(&self, origin: Vec3, directions: &[Vec3]) -> Vec<Option<Hit>> {
        let start = Start { origin, above: Vec3::ZERO, reach: f32::INFINITY };
        let endless = |direction: Vec3| ray(origin, direction, f32::INFINITY);
        let visible = |index: u32, direction: Vec3| {
            self.opacity(&endless(direction), index as usize) >= VISIBLE_OPACITY
        };
        let met = self.world(visible).nearest(start, directions);
        let hit = |(met, direction): (Option<(f32, u32)>, &Vec3)| {
            met.map(|(distance, index)| self.hit_at(&endless(*direction), index, distance))
        };
        met.into_iter().zip(directions).map(hit).collect()
    }

    /// Whether anything stops light along a ray within `reach` lengths of `direction`. A blended surface stops it
    /// with the probability of its opacity, decided by a hash of the ray and the triangle.
    pub fn blocked(&self, origin: Vec3, direction: Vec3, reach: f32) -> bool {
        let ray = ray(origin, direction, reach);
        !self.bvh.ray_traverse_miss(ray, |ray, index| {
            self.distance(ray, index, |opacity| stops(opacity, ray, index))
        })
    }

    /// [`TracedScene::blocked`] for rays that start together: bit `i` is set where `directions[i]` is blocked. The
    /// directions are unit vectors, at most [`bundle::BUNDLE`] of them; the nearer neighbours are to each other, the
    /// faster it goes.
    pub fn blocked_bundle(&self, start: Start, directions: &[Vec3]) -> u64 {
        let stops = |index: u32, direction: Vec3| {
            let ray = ray(start.origin, direction, start.reach);
            stops(self.opacity(&ray, index as usize), &ray, index as usize)
        };
        self.world(stops).blocked(start, directions)
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

    /// Distance to a triangle if the ray meets it and `present` says so of its opacity there, else infinity.
    #[inline]
    fn distance(&self, ray: &Ray, index: usize, present: impl Fn(f32) -> bool) -> f32 {
        let distance = self.triangles[index].intersect(ray);
        if distance < ray.tmax && self.origins[index].see_through && !present(self.opacity(ray, index)) {
            return f32::INFINITY;
        }
        distance
    }

    /// Opacity of a triangle where a ray meets it.
    #[cold]
    fn opacity(&self, ray: &Ray, index: usize) -> f32 {
        let TriangleOrigin { mesh, triangle, .. } = self.origins[index];
        let mesh = &self.scene.meshes[mesh as usize];
        let weights = corner_weights(barycentric(&self.triangles[index], ray));
        let corners = mesh.triangles[triangle as usize];
        self.scene.material(mesh.material).opacity(
            &self.scene.textures,
            crate::intersection::uvs(mesh, corners, weights),
            crate::intersection::colour(mesh, corners, weights),
        )
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

/// All triangles of a scene, with where they come from.
fn flattened(scene: &Scene) -> (Vec<Triangle>, Vec<TriangleOrigin>) {
    let mut triangles = Vec::with_capacity(scene.triangle_count());
    let mut origins = Vec::with_capacity(scene.triangle_count());
    for (mesh_index, mesh) in scene.meshes.iter().enumerate() {
        let see_through = scene.material(mesh.material).alpha != AlphaMode::Opaque;
        for triangle in 0..mesh.triangles.len() {
            let [v0, v1, v2] = mesh.corners(triangle).map(Vec3A::from);
            triangles.push(Triangle { v0, v1, v2 });
            origins.push(TriangleOrigin { mesh: mesh_index as u32, triangle: triangle as u32, see_through });
        }
    }
    (triangles, origins)
}

/// The hierarchies over triangles: one build, two layouts.
fn hierarchies(triangles: &[Triangle]) -> (CwBvh, Bvh2) {
    const MOST_IN_A_WIDE_LEAF: u32 = 3;
    let params = BvhBuildParams::medium_build();
    let mut binary = PlocBuilder::with_capacity(triangles.len()).build(
        params.ploc_search_distance,
        triangles,
        (0..triangles.len() as u32).collect(),
        params.sort_precision,
        params.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut binary, params.reinsertion_batch_ratio, None);
    let wide = bvh2_to_cwbvh(&binary, MOST_IN_A_WIDE_LEAF, true, false);
    collapse(&mut binary, params.max_prims_per_leaf, params.collapse_traversal_cost);
    let mut places = vec![0; triangles.len()];
    for (place, triangle) in wide.primitive_indices.iter().enumerate() {
        places[*triangle as usize] = place as u32;
    }
    for triangle in &mut binary.primitive_indices {
        *triangle = places[*triangle as usize];
    }
    (wide, binary)
}

/// Whether a surface of some opacity stops a ray.
fn stops(opacity: f32, ray: &Ray, index: usize) -> bool {
    opacity >= 1.0 || (opacity > 0.0 && opacity > ray_hash(ray, index))
}

fn ray(origin: Vec3, direction: Vec3, reach: f32) -> Ray {
    // Adding zero turns -0 into 0: the hierarchy takes a ray's octant from `direction < 0` but its slabs from the
    // sign of the inverse, which differ for -0 and lose hits.
    Ray::new(origin.into(), (direction + Vec3::ZERO).into(), 0.0, reach)
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
fn ray_hash(ray: &Ray, index: usize) -> f32 {
    let words = [ray.direction.x, ray.direction.y, ray.direction.z, ray.origin.x, ray.origin.y, ray.origin.z];
    let hash =
        words.iter().fold(index as u32, |hash, word| crate::path::sampler::hash(hash ^ word.to_bits()));
    hash as f32 / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Encoding, Material, Mesh, Texture, TextureId, TextureSlot, Wrap};
    use glam::{Affine2, Vec4};

    fn square_at(z: f32) -> Mesh {
        Mesh {
            positions: [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
            uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], vec![]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    fn scene(meshes: Vec<Mesh>, material: Material) -> Scene {
        Scene { meshes, materials: vec![material], ..Scene::default() }
    }

    #[test]
    fn nearest_of_two_squares_with_its_barycentrics() {
        let meshes = vec![square_at(0.0), square_at(-1.0)];
        let traced = TracedScene::new(scene(meshes, Material::default())).expect("two squares");
        let hit = traced.hit(Vec3::new(0.75, 0.25, 2.0), Vec3::NEG_Z, f32::INFINITY).expect("a hit");
        assert_eq!((hit.mesh, hit.triangle, hit.distance), (0, 0, 2.0));
        let corners = traced.scene().meshes[0].corners(0);
        let weights = corner_weights(hit.barycentric);
        let point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
        assert!((point - Vec3::new(0.75, 0.25, 0.0)).length() < 1e-6);
        assert!(traced.hit(Vec3::new(0.75, 0.25, 2.0), Vec3::NEG_Z, 1.9).is_none());
        assert!(traced.blocked(Vec3::new(0.3, 0.3, 2.0), Vec3::NEG_Z, 2.1));
        assert!(!traced.blocked(Vec3::new(0.3, 0.3, 2.0), Vec3::Z, 9.0));
    }

    #[test]
    fn negative_zero_is_a_direction_like_zero() {
        let traced = TracedScene::new(scene(vec![square_at(0.0)], Material::default())).expect("a square");
        let origin = Vec3::new(0.3, 0.6, -1.0);
        assert!(traced.blocked(origin, -Vec3::NEG_Z, f32::INFINITY));
        assert!(traced.hit(origin, -Vec3::NEG_Z, f32::INFINITY).is_some());
    }

    fn random(i: u32) -> f32 {
        crate::path::sampler::hash(i) as f32 / 4_294_967_296.0
    }

    /// Opaque triangles every which way in a cube of 10 m, and two panes of glass.
    fn clutter() -> TracedScene {
        let glass = Material {
            base_colour: Vec4::new(1.0, 1.0, 1.0, 0.5),
            alpha: AlphaMode::Blend,
            ..Material::default()
        };
        let mut clutter = Mesh::default();
        for i in 0..3_000 {
            let middle = Vec3::new(random(9 * i), random(9 * i + 1), random(9 * i + 2)) * 10.0;
            for corner in 0..3 {
                let at = 9 * (i + 5_000 * corner);
                clutter.positions.push(middle + Vec3::new(random(at + 3), random(at + 4), random(at + 5)));
            }
            clutter.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let panes = Mesh { material: crate::scene::MaterialId(1), ..square_at(3.0) };
        let materials = vec![Material::default(), glass];
        TracedScene::new(Scene { meshes: vec![clutter, panes], materials, ..Scene::default() })
            .expect("triangles")
    }

    #[test]
    fn a_bundle_meets_what_its_rays_meet() {
        let traced = clutter();
        let mut met = 0;
        for i in 0..200 {
            let origin = Vec3::new(random(7 * i), random(7 * i + 1), random(7 * i + 2)) * 14.0 - 2.0;
            let towards = Vec3::splat(5.0) - origin;
            let spread = |ray: u32| {
                let at = 3 * (64 * i + ray);
                Vec3::new(random(at) - 0.5, random(at + 1) - 0.5, random(at + 2) - 0.5)
            };
            let directions: Vec<Vec3> =
                (0..1 + i % 64).map(|ray| (towards.normalize() + 0.7 * spread(ray)).normalize()).collect();
            let hits = traced.hit_bundle(origin, &directions);
            assert_eq!(hits.len(), directions.len());
            for (direction, hit) in directions.iter().zip(hits) {
                let alone = traced.hit(origin, *direction, f32::INFINITY);
                let what = |hit: Option<Hit>| hit.map(|hit| (hit.mesh, hit.triangle, hit.barycentric));
                assert_eq!(what(hit), what(alone), "bundle {i}");
                met += usize::from(hit.is_some());
                let distances =
                    hit.zip(alone).map_or([0.0; 2], |(hit, alone)| [hit.distance, alone.distance]);
                assert!((distances[0] - distances[1]).abs() < 1e-4, "{distances:?}");
            }
        }
        assert!(met > 3_000, "{met} rays met something");
    }

    #[test]
    fn a_bundle_is_blocked_where_its_rays_are() {
        use crate::path::ao::hemisphere;
        use crate::path::sampler::{PixelSampler, frame};
        let traced = clutter();
        let mut share = 0.0;
        for i in 0..300 {
            let origin = Vec3::new(random(7 * i), random(7 * i + 1), random(7 * i + 2)) * 10.0;
            let above = frame(Vec3::new(random(i) - 0.5, random(i + 400), 0.3).normalize()).z_axis;
            let reach = 0.5 + 4.0 * random(i + 900);
            let rays = 1 + i % 64;
            let directions = hemisphere(&PixelSampler::new(i as usize, 0, 0), rays, above);
            let blocked = traced.blocked_bundle(Start { origin, above, reach }, &directions);
            for (ray, direction) in directions.iter().enumerate() {
                let alone = traced.blocked(origin, *direction, reach);
                assert_eq!(blocked >> ray & 1 == 1, alone, "ray {ray} of bundle {i}");
            }
            assert_eq!(blocked.checked_shr(rays).unwrap_or(0), 0, "no rays, no bits");
            share += f64::from(blocked.count_ones()) / f64::from(rays) / 300.0;
        }
        assert!((0.2..0.8).contains(&share), "{share} of the rays are blocked");
    }

    #[test]
    fn no_ray_slips_through_an_edge() {
        // A closed icosahedron-like fan around the origin, traced from inside: every ray must be blocked.
        let rim = |i: u32| {
            let (sin, cos) = (std::f32::consts::TAU * (i % 7) as f32 / 7.0).sin_cos();
            Vec3::new(1.3 * cos, 0.1, 1.1 * sin)
        };
        let mut hat =
            Mesh { positions: vec![Vec3::new(0.2, 0.9, -0.1), Vec3::new(0.1, -1.0, 0.2)], ..Mesh::default() };
        for i in 0..7 {
            hat.positions.push(rim(i));
            let (a, b) = (2 + i, 2 + (i + 1) % 7);
            hat.triangles.extend([[0, a, b], [1, b, a]]);
        }
        let traced = TracedScene::new(scene(vec![hat], Material::default())).expect("triangles");
        // Straight at the edges and corners, and at points all along them.
        let corners: Vec<Vec3> = traced.scene().meshes[0].positions.clone();
        for step in 0..=500 {
            for triangle in &traced.scene().meshes[0].triangles {
                let [a, b, _] = triangle.map(|corner| corners[corner as usize]);
                let direction = a.lerp(b, step as f32 / 500.0).normalize();
                let start = Start { origin: Vec3::ZERO, above: direction, reach: 9.0 };
                assert_eq!(traced.blocked_bundle(start, &[direction]), 1, "towards {direction}");
            }
        }
    }

    #[test]
    fn a_mask_leaves_holes() {
        let texels = vec![[255, 255, 255, 255], [255, 255, 255, 0]];
        let texture = Texture::new(2, 1, texels, Encoding::Srgb, [Wrap::Clamp; 2]);
        let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
        let material =
            Material { base_colour_texture: Some(slot), alpha: AlphaMode::Mask(0.5), ..Material::default() };
        let scene = Scene { textures: vec![texture.into()], ..scene(vec![square_at(0.0)], material) };
        let traced = TracedScene::new(scene).expect("a square");
        assert!(traced.blocked(Vec3::new(0.2, 0.5, 1.0), Vec3::NEG_Z, 9.0));
        assert!(!traced.blocked(Vec3::new(0.8, 0.5, 1.0), Vec3::NEG_Z, 9.0));
        assert!(traced.hit(Vec3::new(0.8, 0.5, 1.0), Vec3::NEG_Z, 9.0).is_none());
    }

    #[test]
    fn a_blended_surface_stops_its_share_of_rays() {
        let material = Material {
            base_colour: Vec4::new(1.0, 1.0, 1.0, 0.3),
            alpha: AlphaMode::Blend,
            ..Material::default()
        };
        let traced = TracedScene::new(scene(vec![square_at(0.0)], material)).expect("a square");
        let blocked = (0..10_000)
            .filter(|i| {
                let origin = Vec3::new((i % 100) as f32 / 101.0, (i / 100) as f32 / 101.0, 1.0);
                traced.blocked(origin, Vec3::NEG_Z, 9.0)
            })
            .count();
        // Three standard deviations of a binomial with p = 0.3 are 137.
        assert!((blocked as i32 - 3_000).abs() < 140, "{blocked} of 10,000 stopped");
    }

    #[test]
    fn vertices_that_are_not_finite_are_refused_by_name() {
        let mut mesh = Mesh { name: "broken".to_owned(), ..square_at(0.0) };
        mesh.positions[1].x = f32::NAN;
        let error = TracedScene::new(scene(vec![mesh], Material::default())).expect_err("a NaN");
        assert!(error.to_string().contains("mesh `broken`"), "{error}");
        let empty = TracedScene::new(Scene { materials: vec![Material::default()], ..Scene::default() });
        assert!(matches!(empty, Err(SceneError::Empty { .. })));
    }

    #[test]
    fn scenes_too_large_to_trace_are_refused_by_name() {
        let reaching = |far: f32| {
            let positions = vec![Vec3::ZERO, Vec3::new(far, far, 0.0), Vec3::X, Vec3::Z];
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 1, 3]], ..Mesh::default() };
            let scene = scene(vec![mesh], Material::default());
            TracedScene::new(Scene { name: "far".to_owned(), ..scene })
        };
        assert!(reaching(7e8).is_ok());
        for far in [7.1e8, 1e20, f32::MAX] {
            let error = reaching(far).expect_err("too large").to_string();
            assert!(error.starts_with("far: is ") && error.contains("more than 1e9 m"), "{error}");
        }
    }
}
