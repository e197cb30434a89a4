//! Sampling views: positions in a box fitted to the scene, none inside geometry or looking at nothing.
//!
//! The box holds the middles of all triangles but for the outermost hundredth on each side, so that a ground
//! plane or a sky does not drown what stands on it; it is widened by a tenth, and more where it is flat. A
//! position is uniform in it, and the camera looks from there at another such point, with 50 degrees of view
//! (thesis 7.3.1). A view is taken if
//! - a ball of probe rays around the camera finds no more than half of its directions ending on a triangle's
//!   back: inside a closed object all of them do, and below a terrain half;
//! - of a grid of probe rays through the image, at least [`LEAST_SEEN`] meet a surface, and of these
//! - no more than [`MOST_BACKS`] meet a back (leaves and cloth have backs on show, walls have not),
//! - no more than one in twenty is nearer than [`NEAREST`] of the box's diagonal,
//! - the median is [`LEAST_MEDIAN`] to 1 diagonals away,
//! - no two planes hold more than [`MOST_ON_TWO_PLANES`] (a blank wall and its floor teach nothing).

pub mod dolly;
pub mod near;
pub mod sequence;
pub mod whole;

use crate::random::{mix, uniform};
use crate::recipe::{FieldOfView, Views};
use crate::{DatasetError, Recipe};
use deepshade_render::bvh::TracedScene;
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::scene::camera::FIELD_OF_VIEW;
use deepshade_render::scene::{Bounds, Camera};
use glam::{Vec2, Vec3};

/// Views that are tried before a scene is given up.
const ATTEMPTS: u32 = 2048;
/// Edges of the box are at least this share of the diagonal; upwards, since a flat scene lies below its
/// viewer.
const LEAST_EDGE: f32 = 0.3;
/// Directions of the ball.
const BALL: usize = 96;
/// Rows and columns of the grid.
const GRID: usize = 16;
/// Share of the grid's rays that must meet a surface.
pub const LEAST_SEEN: f32 = 0.6;
/// Share of the surfaces seen that may show their back.
pub const MOST_BACKS: f32 = 0.35;
/// Distance, as a share of the diagonal, below which surfaces are too near.
pub const NEAREST: f32 = 0.005;
/// Backs around a camera count as the inside of a wall up to this distance, as a share of the scene's
/// diagonal: thicker walls are rare, and so are rooms that are lower.
const WALL: f32 = 0.1;
/// Smallest median distance as a share of the diagonal.
pub const LEAST_MEDIAN: f32 = 0.02;
/// Share of the surfaces seen that may lie on two planes.
pub const MOST_ON_TWO_PLANES: f32 = 0.85;
/// Share of the triangles that the box leaves out at each of its sides.
const OUTLIERS: f32 = 0.01;
/// How much of its diagonal the box is widened by on each side.
const MARGIN: f32 = 0.1;

/// What is near, as shares of the diagonal.
#[derive(Clone, Copy)]
struct Limits {
    /// Distance below which surfaces are too near.
    nearest: f32,
    /// Smallest median distance.
    least_median: f32,
    /// Surfaces whose planes are nearer to each other are on one plane.
    plane: f32,
}

/// What is fit of views from anywhere.
const LIMITS: Limits = Limits { nearest: NEAREST, least_median: LEAST_MEDIAN, plane: 1e-3 };

/// The view of an index of a recipe's scene: that of [`sample_view`], with the recipe's fixed field of view
/// one that [`dolly_zoom`](dolly::dolly_zoom) can make of it, with a drawn one one that is fit at that, and
/// in a sequence one that [`followed`](sequence::followed) can. With [`Views::NearAndFar`] every other view
/// is one of [`near`].
///
/// # Errors
/// If none of many sampled views is fit.
pub fn recipe_view(
    recipe: &Recipe,
    scene: &TracedScene,
    scene_key: u64,
    view: usize,
) -> Result<Camera, DatasetError> {
    let seed = recipe.view_seed(scene_key, view);
    let size = recipe.size(seed);
    let stream = |view: usize| mix(&[u64::from(recipe.seed), scene_key, view as u64]);
    if let Some(sequence) = recipe.sequence {
        let stream = stream(view / sequence.frames);
        let frame = view % sequence.frames;
        return sample(scene, size, stream, FIELD_OF_VIEW, |first| {
            sequence::followed(scene, &first, size, stream, sequence, frame)
        });
    }
    let degrees = recipe.degrees(seed).unwrap_or(FIELD_OF_VIEW);
    if recipe.views == Views::NearAndFar && near::is_near(scene_key, view) {
        return near::sample(scene, size, stream(view), degrees);
    }
    match recipe.field_of_view {
        None => sample(scene, size, stream(view), FIELD_OF_VIEW, Some),
        Some(FieldOfView::Drawn(_)) => sample(scene, size, stream(view), degrees, Some),
        Some(FieldOfView::Fixed(degrees)) => sample(scene, size, stream(view), FIELD_OF_VIEW, |camera| {
            dolly::dolly_zoom(scene, &camera, degrees)
        }),
    }
}

/// The view of an index of a scene, for an image of this size. The same for the same `seed`, `scene_key` and
/// `view`.
///
/// # Errors
/// If none of many sampled views is fit.
pub fn sample_view(
    scene: &TracedScene,
    size: [usize; 2],
    seed: u32,
    scene_key: u64,
    view: usize,
) -> Result<Camera, DatasetError> {
    sample(scene, size, mix(&[u64::from(seed), scene_key, view as u64]), FIELD_OF_VIEW, Some)
}

/// The first view of a stream of random numbers that is fit at a vertical field of view, in degrees, and of
/// which `shown` makes one, as that makes it.
fn sample(
    scene: &TracedScene,
    [height, width]: [usize; 2],
    stream: u64,
    degrees: f32,
    shown: impl Fn(Camera) -> Option<Camera>,
) -> Result<Camera, DatasetError> {
    let bounds = fitted_box(scene);
    let (aspect, diagonal) = (width as f32 / height as f32, bounds.diagonal());
    let camera = |attempt: u32| {
        let (position, target) = candidate_from(&bounds, stream, attempt)?;
        Some(Camera { vertical_fov: degrees.to_radians(), ..Camera::look_at(position, target) })
    };
    first_fit(scene, camera, |camera| match refusal(scene, &camera, aspect, diagonal, LIMITS) {
        Some(reason) => Err(reason),
        None => shown(camera).ok_or(NOT_SHOWN),
    })
}

/// Two places of a box for an attempt of a stream of random numbers; `None` if they are too near to each
/// other.
fn candidate_from(bounds: &Bounds, stream: u64, attempt: u32) -> Option<(Vec3, Vec3)> {
    let point = |first: u64| {
        let share = |axis| uniform(&[stream, u64::from(attempt), first + axis]);
        bounds.min + bounds.size() * Vec3::new(share(0), share(1), share(2))
    };
    let (from, to) = (point(0), point(3));
    (from.distance(to) > 1e-3 * bounds.diagonal()).then_some((from, to))
}

/// The first camera of all attempts that passes, as `fit` gives it; that says why others do not by an index
/// into [`REASONS`].
fn first_fit(
    scene: &TracedScene,
    camera: impl Fn(u32) -> Option<Camera>,
    fit: impl Fn(Camera) -> Result<Camera, usize>,
) -> Result<Camera, DatasetError> {
    let mut refusals = [0; REASONS.len()];
    for camera in (0..ATTEMPTS).filter_map(camera) {
        match fit(camera) {
            Ok(camera) => return Ok(camera),
            Err(reason) => refusals[reason] += 1,
        }
    }
    let most = (0..REASONS.len()).max_by_key(|reason| refusals[*reason]).unwrap_or(0);
    Err(DatasetError::NoView { scene: scene.scene().name.clone(), attempts: ATTEMPTS, reason: REASONS[most] })
}

/// Why views are refused, for the error that names the scene.
const REASONS: [&str; 7] = [
    "it stands inside of geometry",
    "it sees too little",
    "it sees the backs of surfaces",
    "surfaces are too near",
    "what it sees is too near or too far away",
    "it sees little but a plane or two",
    "it cannot be had at every field of view, or be followed by the others of its sequence",
];
/// Index into [`REASONS`] of a view of which its user makes none.
const NOT_SHOWN: usize = 6;

/// Index into [`REASONS`] if a view is not fit.
fn refusal(
    scene: &TracedScene,
    camera: &Camera,
    aspect: f32,
    diagonal: f32,
    limits: Limits,
) -> Option<usize> {
    if back_share_around(scene, camera.position) > 0.5 {
        return Some(0);
    }
    let mut seen: Vec<Probe> =
        grid(camera, aspect).filter_map(|ray| Probe::new(scene, camera.position, ray)).collect();
    let count = seen.len() as f32;
    if count < LEAST_SEEN * (GRID * GRID) as f32 {
        return Some(1);
    }
    if seen.iter().filter(|probe| probe.back).count() as f32 > MOST_BACKS * count {
        return Some(2);
    }
    seen.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    if seen[seen.len() / 20].distance < limits.nearest * diagonal {
        return Some(3);
    }
    if !(limits.least_median * diagonal..=diagonal).contains(&seen[seen.len() / 2].distance) {
        return Some(4);
    }
    (share_on_two_planes(&seen, limits.plane * diagonal) > MOST_ON_TWO_PLANES).then_some(5)
}

/// Share of the probes that lie on the two planes with the most of them, up to a tolerance of the planes'
/// offset.
fn share_on_two_planes(probes: &[Probe], tolerance: f32) -> f32 {
    let same =
        |a: &Probe, b: &Probe| a.normal.dot(b.normal) > 0.999 && (a.offset - b.offset).abs() < tolerance;
    let mut rest: Vec<&Probe> = probes.iter().collect();
    for _ in 0..2 {
        let largest = rest.iter().copied().max_by_key(|a| rest.iter().filter(|b| same(a, b)).count());
        rest.retain(|probe| largest.is_some_and(|plane| !same(plane, probe)));
    }
    1.0 - rest.len() as f32 / probes.len() as f32
}

/// What a probe ray met.
struct Probe {
    distance: f32,
    /// Unit normal of the triangle, facing the ray.
    normal: Vec3,
    /// Distance of the triangle's plane from the camera.
    offset: f32,
    /// Whether it met the triangle's back.
    back: bool,
}

impl Probe {
    fn new(scene: &TracedScene, origin: Vec3, direction: Vec3) -> Option<Self> {
        let hit = scene.hit(origin, direction, f32::INFINITY)?;
        let [a, b, c] = scene.scene().meshes[hit.mesh as usize].corners(hit.triangle as usize);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let back = normal.dot(direction) > 0.0;
        let offset = normal.dot(direction).abs() * hit.distance;
        Some(Self { distance: hit.distance, normal: if back { -normal } else { normal }, offset, back })
    }
}

/// Whether a camera at `position`, which somebody else chose, is stuck inside of something: most directions
/// end on the back of a triangle nearer than [`WALL`]. A room that was modelled with its triangles facing
/// outwards shows backs too, but far away.
pub fn inside_geometry(scene: &TracedScene, position: Vec3) -> bool {
    let near = WALL * scene.diagonal();
    let stuck = ball(scene, position).filter(|probe| probe.back && probe.distance < near);
    stuck.count() > BALL / 2
}

/// Share of all directions that end on the back of a triangle.
fn back_share_around(scene: &TracedScene, position: Vec3) -> f32 {
    ball(scene, position).filter(|probe| probe.back).count() as f32 / BALL as f32
}

/// What rays in all directions meet.
fn ball(scene: &TracedScene, position: Vec3) -> impl Iterator<Item = Probe> {
    (0..BALL).filter_map(move |i| {
        // A Fibonacci lattice on the sphere.
        let z = 1.0 - (2 * i + 1) as f32 / BALL as f32;
        let angle = i as f32 * 2.399_963_2;
        let ring = (1.0 - z * z).sqrt();
        Probe::new(scene, position, Vec3::new(ring * angle.cos(), z, ring * angle.sin()))
    })
}

/// Directions through the middles of a grid over the image.
fn grid(camera: &Camera, aspect: f32) -> impl Iterator<Item = Vec3> {
    // In pixels of an image of 1000 rows, whatever the image's real size.
    let (height, width) = (1000.0, 1000.0 * aspect);
    (0..GRID * GRID).map(move |i| {
        let share = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
        camera.direction(share * Vec2::new(width, height), 1000, width as usize)
    })
}

/// The median depth of what the rays of a grid through an image meet, metres along the camera's axis; `None`
/// if that is nothing.
pub fn median_depth(scene: &TracedScene, camera: &Camera, [height, width]: [usize; 2]) -> Option<f32> {
    let depth = |direction: Vec3| {
        let hit = scene.hit(camera.position, direction, f32::INFINITY)?;
        Some(-hit.distance * direction.dot(camera.rotation.z_axis))
    };
    let mut depths: Vec<f32> = grid(camera, width as f32 / height as f32).filter_map(depth).collect();
    depths.sort_unstable_by(f32::total_cmp);
    depths.get(depths.len() / 2).copied()
}

/// What the rays of a grid through an image meet.
pub(crate) fn seen_points(
    scene: &TracedScene,
    camera: &Camera,
    [height, width]: [usize; 2],
) -> Vec<SurfacePoint> {
    let met = |direction: Vec3| {
        let hit = scene.hit(camera.position, direction, f32::INFINITY)?;
        Some(SurfacePoint::new(scene, &hit, direction))
    };
    grid(camera, width as f32 / height as f32).filter_map(met).collect()
}

/// Whether a place is neither inside of geometry nor nearer to it than `clearance`, as far as rays in all
/// directions tell.
pub(crate) fn is_open(scene: &TracedScene, place: Vec3, clearance: f32) -> bool {
    let (mut backs, mut nearest) = (0, f32::INFINITY);
    for probe in ball(scene, place) {
        backs += usize::from(probe.back);
        nearest = nearest.min(probe.distance);
    }
    2 * backs <= BALL && nearest >= clearance
}

/// The box that views are sampled in: around all but the outermost triangles, then widened.
pub(crate) fn fitted_box(scene: &TracedScene) -> Bounds {
    let meshes = &scene.scene().meshes;
    let corners = meshes.iter().flat_map(|mesh| (0..mesh.triangles.len()).map(|index| mesh.corners(index)));
    let middles: Vec<Vec3> = corners.map(|[a, b, c]| (a + b + c) / 3.0).collect();
    let left_out = (OUTLIERS * middles.len() as f32) as usize;
    // Nothing is left out of a scene of few triangles, whose middles say little of its size.
    let inner = if left_out == 0 { scene.bounds() } else { without_outliers(&middles, left_out) };
    let margin = Vec3::splat(MARGIN * inner.diagonal());
    let Bounds { min, max } = scene.bounds();
    widened(Bounds { min: (inner.min - margin).max(min), max: (inner.max + margin).min(max) })
}

/// The box around points but for `left_out` of them at each side.
fn without_outliers(points: &[Vec3], left_out: usize) -> Bounds {
    let mut inner = Bounds::EMPTY;
    for axis in 0..3 {
        let mut values: Vec<f32> = points.iter().map(|point| point[axis]).collect();
        inner.min[axis] = *values.select_nth_unstable_by(left_out, f32::total_cmp).1;
        inner.max[axis] = *values.select_nth_unstable_by(points.len() - 1 - left_out, f32::total_cmp).1;
    }
    inner
}

/// A box with every edge at least [`LEAST_EDGE`] of the diagonal.
fn widened(bounds: Bounds) -> Bounds {
    let missing = (Vec3::splat(LEAST_EDGE * bounds.diagonal()) - bounds.size()).max(Vec3::ZERO);
    Bounds {
        min: bounds.min - missing * Vec3::new(0.5, 0.0, 0.5),
        max: bounds.max + missing * Vec3::new(0.5, 1.0, 0.5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::{Material, Mesh, Scene};

    /// An axis-aligned box whose triangles face outwards, or inwards.
    pub(super) fn block(min: Vec3, max: Vec3, outwards: bool) -> Mesh {
        let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4), max, min);
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut triangles: Vec<[u32; 3]> =
            faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
        if !outwards {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
    }

    pub(super) fn traced(meshes: Vec<Mesh>) -> TracedScene {
        let scene = Scene {
            name: "boxes".into(),
            meshes: meshes.into(),
            materials: vec![Material::default()],
            ..Scene::default()
        };
        TracedScene::new(scene).expect("boxes")
    }

    #[test]
    fn views_of_a_room_stand_in_it_and_not_in_its_furniture() {
        let furniture = block(Vec3::new(1.0, 0.0, 1.0), Vec3::new(3.0, 1.5, 2.5), true);
        let scene = traced(vec![block(Vec3::ZERO, Vec3::new(6.0, 3.0, 5.0), false), furniture]);
        let mut positions = Vec::new();
        for view in 0..50 {
            let camera = sample_view(&scene, [64, 64], 1, 9, view).expect("a view");
            let p = camera.position;
            let in_furniture = (1.0..=3.0).contains(&p.x) && p.y <= 1.5 && (1.0..=2.5).contains(&p.z);
            assert!(!in_furniture && p.y > 0.0 && p.y < 3.0, "{p}");
            let up = camera.rotation.y_axis;
            assert!(up.y >= 0.0, "upright");
            positions.push(p);
        }
        assert!(positions.iter().any(|p| p.distance(positions[0]) > 2.0), "views differ");
        let again = sample_view(&scene, [64, 64], 1, 9, 7).expect("a view");
        assert_eq!(again.position, positions[7]);
    }

    #[test]
    fn an_object_in_the_open_is_seen_from_outside() {
        let scene = traced(vec![
            block(Vec3::new(-4.0, -0.1, -4.0), Vec3::new(4.0, 0.0, 4.0), true),
            block(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, 1.0), true),
        ]);
        for view in 0..30 {
            let p = sample_view(&scene, [64, 96], 3, 1, view).expect("a view").position;
            assert!(p.y > 0.0 && (p.x.abs() > 1.0 || p.z.abs() > 1.0 || p.y > 1.0), "{p}");
        }
    }

    #[test]
    fn a_camera_in_a_wall_is_found_and_one_in_a_room_facing_outwards_is_not() {
        let wall = block(Vec3::new(0.0, 0.0, 4.0), Vec3::new(6.0, 3.0, 4.1), true);
        let scene = traced(vec![block(Vec3::ZERO, Vec3::new(6.0, 3.0, 5.0), true), wall]);
        assert!(inside_geometry(&scene, Vec3::new(3.0, 1.5, 4.05)));
        assert!(!inside_geometry(&scene, Vec3::new(3.0, 1.5, 2.0)));
        assert!(!inside_geometry(&scene, Vec3::new(3.0, 1.5, 9.0)));
    }

    #[test]
    fn a_camera_in_a_wall_as_thick_as_those_of_a_castle_is_found() {
        let partition = block(Vec3::new(0.0, 0.0, 4.0), Vec3::new(10.0, 10.0, 5.0), true);
        for outwards in [false, true] {
            let scene = traced(vec![block(Vec3::ZERO, Vec3::splat(10.0), outwards), partition.clone()]);
            for z in [4.1, 4.3, 4.5, 4.9] {
                assert!(inside_geometry(&scene, Vec3::new(5.0, 5.0, z)), "{z}");
            }
            for z in [2.0, 3.0, 7.0] {
                assert!(!inside_geometry(&scene, Vec3::new(5.0, 5.0, z)), "{z}");
            }
        }
        // A room whose own walls are a metre thick: one shell faces outwards, the other inwards.
        let scene = traced(vec![
            block(Vec3::ZERO, Vec3::splat(10.0), true),
            block(Vec3::ONE, Vec3::splat(9.0), false),
        ]);
        assert!(inside_geometry(&scene, Vec3::new(0.5, 5.0, 5.0)));
        assert!(!inside_geometry(&scene, Vec3::new(1.3, 5.0, 5.0)));
    }

    #[test]
    fn a_wide_ground_does_not_draw_the_views_away() {
        let ground = block(Vec3::new(-500.0, -0.1, -500.0), Vec3::new(500.0, 0.0, 500.0), true);
        let crowd = (0..400).map(|i| {
            let corner = Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32);
            block(corner, corner + Vec3::new(0.5, 1.0 + (i % 3) as f32, 0.5), true)
        });
        let scene = traced(std::iter::once(ground).chain(crowd).collect());
        for view in 0..20 {
            let p = sample_view(&scene, [64, 64], 5, 1, view).expect("a view").position;
            assert!(p.x > -10.0 && p.x < 30.0 && p.z > -10.0 && p.z < 30.0, "{p}");
        }
    }

    #[test]
    fn a_scene_without_a_fit_view_is_named() {
        // All that can be seen is one plane.
        let floor = Mesh {
            positions: [(-9., -9.), (-9., 9.), (9., 9.), (9., -9.)]
                .map(|(x, z)| Vec3::new(x, 0.0, z))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let error = sample_view(&traced(vec![floor]), [64, 64], 0, 0, 0).expect_err("a plane").to_string();
        assert!(error.contains("scene `boxes`: none of 2048"), "{error}");
    }
}
