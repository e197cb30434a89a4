//! What is known of the point where a ray met a surface.

mod bent;
mod start;

pub(crate) use start::{Start, blended};

use crate::bvh::{Hit, corner_weights, scene_at_time::SceneAtTime};
use crate::scene::{Mesh, Surface};
use glam::{Mat3, Quat, Vec2, Vec3, Vec4};

/// A point of a surface, seen from one side; both normals face that side.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// World space, metres.
    pub position: Vec3,
    /// Unit normal of the triangle.
    pub geometric_normal: Vec3,
    /// Unit normal for shading: interpolated, then turned by the normal map.
    pub normal: Vec3,
    /// Unit normal of the clear coat, the same as `normal` where there is none: interpolated, then turned by
    /// the coat's own normal map.
    pub coat_normal: Vec3,
    /// Whether it is the front that is seen, the side that the mesh's normals are on.
    pub is_front: bool,
    /// What the material says there.
    pub surface: Surface,
    /// Index of the mesh.
    pub mesh: u32,
    /// How far the point moves during the exposure, world space, metres.
    pub displacement: Vec3,
    /// Where rays start so that they do not meet the surface.
    start: Start,
}

impl SurfacePoint {
    /// The point of a hit, seen against `direction`, of a scene or of it at the moment of the hit. Shading
    /// normals turn with their triangles as these move.
    pub fn new<'a>(scene: impl Into<SceneAtTime<'a>>, hit: &Hit, direction: Vec3) -> Self {
        let moment: SceneAtTime<'_> = scene.into();
        let scene = moment.scene();
        let mesh = &scene.meshes[hit.mesh as usize];
        let corners = mesh.triangles[hit.triangle as usize];
        let weights = corner_weights(hit.barycentric);
        let placed = moment.corners(mesh, hit.triangle as usize);
        let material = scene.material(mesh.material);
        let (uvs, colour) = (uvs(mesh, corners, weights), colour(mesh, corners, weights));
        let geometric = plane_normal(placed).unwrap_or(-direction);
        let resting = plane_normal(mesh.corners(hit.triangle as usize)).unwrap_or(geometric);
        let smooth = interpolated_normal(mesh, corners, weights).unwrap_or(resting);
        let mapped = material.normal_texture.zip(material.tangent_normal(&scene.textures, uvs)).map(
            |((slot, _), tangent_normal)| {
                tangent_frame(mesh, corners, weights, smooth, slot.uv_set) * tangent_normal
            },
        );
        let coat = material.coat.as_ref().map(|coat| {
            let map = coat.normal_texture.zip(material.coat_normal(&scene.textures, uvs));
            map.map_or(smooth, |((slot, _), tangent_normal)| {
                tangent_frame(mesh, corners, weights, smooth, slot.uv_set) * tangent_normal
            })
        });
        let geometric_normal = facing(geometric, -direction);
        let [smooth, mapped, coat] =
            turned([smooth, mapped.unwrap_or(smooth), coat.unwrap_or(smooth)], resting, geometric);
        // The mesh's normal decides which side of its own the shading normal is on, the viewer which side is
        // meant.
        let side = if smooth.dot(geometric_normal) < 0.0 { -1.0 } else { 1.0 };
        let normal = leaning_to(side * mapped, -direction, geometric_normal);
        let surface = material.surface(&scene.textures, uvs, colour);
        let coat_normal = match surface.coat {
            Some(_) => leaning_to(side * coat, -direction, geometric_normal),
            None => normal,
        };
        Self {
            position: blended(placed, weights),
            geometric_normal,
            normal,
            coat_normal,
            is_front: side > 0.0,
            surface,
            mesh: hit.mesh,
            displacement: interpolated(&mesh.displacements, corners, weights).unwrap_or(Vec3::ZERO),
            start: Start::new(placed, weights, geometric_normal),
        }
    }

    /// Where rays into the upper hemisphere start so that they do not meet their own surface.
    pub fn ray_origin(&self) -> Vec3 {
        self.start.above(self.geometric_normal)
    }

    /// Where rays into the lower hemisphere do.
    pub fn ray_origin_below(&self) -> Vec3 {
        self.start.above(-self.geometric_normal)
    }

    /// The same point with a shading normal in which nothing is mirrored into the surface: bent as far as
    /// that needs, towards the viewer at `to_viewer`, where the surface mirrors at all.
    #[must_use]
    pub fn reflecting(self, to_viewer: Vec3) -> Self {
        if self.surface.specular == Vec3::ZERO {
            return self;
        }
        let [normal, coat_normal] = [self.normal, self.coat_normal]
            .map(|normal| bent::mirroring_above(normal, self.geometric_normal, to_viewer));
        Self { normal, coat_normal, ..self }
    }

    /// The same point, above which rays start at least so many metres: for a copy of its surface that is less
    /// exact.
    #[must_use]
    pub fn raised(self, by: f32) -> Self {
        Self { start: self.start.raised(by), ..self }
    }
}

/// Unit normal of a triangle's front; `None` of one without an area.
fn plane_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    (b - a).cross(c - a).try_normalize()
}

/// Vectors turned as one unit vector must be to become another. Where that is no turn, they stay what they
/// are to the sign of a zero, which decides on which tangents belong to a normal.
fn turned<const N: usize>(vectors: [Vec3; N], from: Vec3, to: Vec3) -> [Vec3; N] {
    if from == to { vectors } else { vectors.map(|vector| Quat::from_rotation_arc(from, to) * vector) }
}

/// Both sets of texture coordinates at a point of a triangle; zero where the mesh has none.
pub fn uvs(mesh: &Mesh, corners: [u32; 3], weights: [f32; 3]) -> [Vec2; 2] {
    [0, 1].map(|set| interpolated(&mesh.uvs[set], corners, weights).unwrap_or(Vec2::ZERO))
}

/// The vertex colour at a point of a triangle; white where the mesh has none.
pub fn colour(mesh: &Mesh, corners: [u32; 3], weights: [f32; 3]) -> Vec4 {
    interpolated(&mesh.colours, corners, weights).unwrap_or(Vec4::ONE)
}

fn interpolated_normal(mesh: &Mesh, corners: [u32; 3], weights: [f32; 3]) -> Option<Vec3> {
    interpolated(&mesh.normals, corners, weights).and_then(Vec3::try_normalize)
}

fn interpolated<T>(values: &[T], corners: [u32; 3], weights: [f32; 3]) -> Option<T>
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    if values.is_empty() {
        return None;
    }
    let [a, b, c] = corners.map(|vertex| values[vertex as usize]);
    Some(a * weights[0] + b * weights[1] + c * weights[2])
}

/// Columns: tangent, bitangent and normal. From the mesh's tangents, else from the triangle's texture
/// coordinates.
fn tangent_frame(mesh: &Mesh, corners: [u32; 3], weights: [f32; 3], normal: Vec3, uv_set: usize) -> Mat3 {
    let (tangent, sign) = match interpolated(&mesh.tangents, corners, weights) {
        Some(tangent) => (tangent.truncate(), tangent.w.signum()),
        None => uv_tangent(mesh, corners, uv_set),
    };
    let tangent = (tangent - normal * normal.dot(tangent)).normalize_or(normal.any_orthonormal_vector());
    Mat3::from_cols(tangent, normal.cross(tangent) * sign, normal)
}

/// Direction in which u grows on a triangle, and the sign of the bitangent, which points up in the image, to
/// where v shrinks.
fn uv_tangent(mesh: &Mesh, corners: [u32; 3], uv_set: usize) -> (Vec3, f32) {
    let uvs = &mesh.uvs[uv_set];
    if uvs.is_empty() {
        return (Vec3::ZERO, 1.0);
    }
    let [p0, p1, p2] = corners.map(|vertex| mesh.positions[vertex as usize]);
    let [t0, t1, t2] = corners.map(|vertex| uvs[vertex as usize]);
    let (d1, d2) = (t1 - t0, t2 - t0);
    let orientation = d1.perp_dot(d2).signum();
    (((p1 - p0) * d2.y - (p2 - p0) * d1.y) * orientation, -orientation)
}

/// `normal` or its opposite, whichever faces `direction`.
fn facing(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) < 0.0 { -normal } else { normal }
}

/// A unit shading normal that does not look away from the viewer: bent towards the viewer until it faces;
/// `geometric` where nothing is left of it.
fn leaning_to(normal: Vec3, to_viewer: Vec3, geometric: Vec3) -> Vec3 {
    const LEAST_COSINE: f32 = 1e-3;
    let cosine = normal.dot(to_viewer);
    if cosine >= LEAST_COSINE {
        return normal.normalize_or(geometric);
    }
    (normal + to_viewer * (LEAST_COSINE - cosine)).normalize_or(geometric)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::bvh::bundle::BUNDLE;
    use crate::scene::{Encoding, Material, Scene, Texture, TextureId, TextureSlot, Wrap};
    use glam::Affine2;

    /// A square in the plane z = 0 that faces +z, with u along x, v down along -y, and a normal map of one
    /// colour.
    fn mapped_square(texel: [u8; 4]) -> TracedScene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            uvs: [vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO], vec![]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
        let texture = Texture::new(1, 1, vec![texel], Encoding::Linear, [Wrap::Repeat; 2]);
        let material = Material { normal_texture: Some((slot, 1.0)), ..Material::default() };
        TracedScene::new(Scene {
            meshes: vec![mesh].into(),
            materials: vec![material],
            textures: vec![texture.into()],
            ..Scene::default()
        })
        .expect("a square")
    }

    fn seen_from(scene: &TracedScene, z: f32) -> SurfacePoint {
        let origin = Vec3::new(0.4, 0.7, z);
        let direction = Vec3::new(0.0, 0.0, -z.signum());
        let hit = scene.hit(origin, direction, f32::INFINITY).expect("the square");
        SurfacePoint::new(scene, &hit, direction)
    }

    #[test]
    fn red_tilts_to_the_right_and_green_up() {
        let red = seen_from(&mapped_square([218, 128, 218, 255]), 1.0).normal;
        assert!((red - Vec3::new(0.707, 0.0, 0.707)).length() < 0.01, "{red}");
        let green = seen_from(&mapped_square([128, 218, 218, 255]), 1.0).normal;
        assert!((green - Vec3::new(0.0, 0.707, 0.707)).length() < 0.01, "{green}");
    }

    #[test]
    fn normals_face_the_viewer_on_both_sides() {
        let scene = mapped_square([218, 128, 218, 255]);
        let (front, back) = (seen_from(&scene, 1.0), seen_from(&scene, -1.0));
        assert_eq!(front.geometric_normal, Vec3::Z);
        assert_eq!(back.geometric_normal, Vec3::NEG_Z);
        assert!((back.normal + front.normal).length() < 1e-6);
        assert!(back.ray_origin().z < 0.0);
    }

    /// A tilted square of 1 km around the world's origin.
    fn tilted_ground() -> TracedScene {
        let corner = |x: f32, z: f32| Vec3::new(x, 0.3137 * x - 0.1719 * z, z);
        let mesh = Mesh {
            positions: [(-500., -500.), (-500., 500.), (500., 500.), (500., -500.)]
                .map(|(x, z)| corner(x, z))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        TracedScene::new(Scene {
            meshes: vec![mesh].into(),
            materials: vec![Material::default()],
            ..Scene::default()
        })
        .expect("a square")
    }

    #[test]
    fn a_large_tilted_ground_does_not_shadow_itself() {
        let scene = tilted_ground();
        let mut shadowed = 0;
        for i in 0..400 {
            let (x, z) = ((i % 20) as f32 * 0.21 - 2.03, (i / 20) as f32 * 0.19 - 1.87);
            let hit = scene.hit(Vec3::new(x, 3.0, z), Vec3::NEG_Y, f32::INFINITY).expect("the ground");
            let point = SurfacePoint::new(&scene, &hit, Vec3::NEG_Y);
            let (right, up) = point.geometric_normal.any_orthonormal_pair();
            let directions: Vec<Vec3> = (0..BUNDLE)
                .map(|ray| {
                    let (sin, cos) = (std::f32::consts::TAU * ray as f32 / BUNDLE as f32).sin_cos();
                    // From almost along the ground to almost straight up.
                    let height = 0.01 + 0.3 * (ray % 4) as f32;
                    let aside = (1.0 - height * height).sqrt();
                    point.geometric_normal * height + (right * cos + up * sin) * aside
                })
                .collect();
            let origin = point.ray_origin();
            shadowed += scene.blocked_bundle(origin, &directions, 1e4).count_ones();
            shadowed += directions.iter().filter(|d| scene.blocked(origin, **d, 1e4)).count() as u32;
        }
        assert_eq!(shadowed, 0, "of {} rays", 400 * 2 * BUNDLE);
    }

    #[test]
    fn a_normal_that_looks_away_is_bent_to_the_viewer() {
        let normal = leaning_to(Vec3::new(1.0, 0.0, -0.1).normalize(), Vec3::Z, Vec3::Z);
        assert!(normal.z > 0.0 && (normal.length() - 1.0).abs() < 1e-6);
    }
}
