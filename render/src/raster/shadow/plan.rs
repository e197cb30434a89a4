//! Which lights have maps, and from where these look.

use crate::raster::view::{parallel, square};
use crate::scene::{Bounds, Camera, Light};
use deepshade_shaders::wgsl::uniforms::FrameView;
use glam::{Mat3, Vec3};

/// Slices of a directional light.
pub const CASCADES: usize = 4;

/// Most layers of a texture that WebGPU guarantees.
const MOST_MAPS: usize = 256;

/// Most memory of all maps, bytes.
const MOST_MEMORY: usize = 512 << 20;

/// Smallest edge of a map, texels, before lights go without.
const SMALLEST: usize = 256;

/// Wider spots, by the cosine of half their angle, have a cube: 60 degrees.
const WIDEST_MAP: f32 = 0.5;

/// How much of each cascade's reach goes by equal shares of depth; the rest by equal ratios.
const EVEN_SHARE: f32 = 0.3;

/// Which maps the lights of a scene have.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPlan {
    /// Edge of every map, texels.
    pub size: usize,
    /// For each light its first map and how many it has; none for one without shadow.
    pub of_lights: Vec<Option<(usize, usize)>>,
    /// Number of maps.
    pub maps: usize,
}

impl MapPlan {
    /// Gives maps of at most `size` texels to the lights, the strongest first. From the light `around` on
    /// each has one around all of the scene, wherever the camera looks.
    pub fn new(lights: &[Light], around: usize, size: usize) -> Self {
        let map_count = |light: usize| if light < around { map_count(&lights[light]) } else { 1 };
        let wanted: usize = (0..lights.len()).map(map_count).sum();
        let most = |size: usize| MOST_MAPS.min(MOST_MEMORY / (4 * size * size));
        let mut size = size.max(SMALLEST);
        while most(size) < wanted && size / 2 >= SMALLEST {
            size /= 2;
        }
        let mut order: Vec<usize> = (0..lights.len()).collect();
        order.sort_by(|a, b| strength(&lights[*b]).total_cmp(&strength(&lights[*a])));
        let (mut of_lights, mut maps) = (vec![None; lights.len()], 0);
        for light in order {
            let count = map_count(light);
            if maps + count <= most(size) {
                of_lights[light] = Some((maps, count));
                maps += count;
            }
        }
        Self { size, of_lights, maps }
    }

    /// No map for any of the lights.
    pub fn without(lights: &[Light]) -> Self {
        Self { size: SMALLEST, of_lights: vec![None; lights.len()], maps: 0 }
    }

    /// How many lights cast no shadow.
    pub fn without_shadow(&self) -> usize {
        self.of_lights.iter().filter(|maps| maps.is_none()).count()
    }

    /// From where every map looks.
    pub fn views(&self, lights: &[Light], seen: CameraView) -> Vec<FrameView> {
        let mut all = vec![bytemuck::Zeroable::zeroed(); self.maps];
        for (light, maps) in lights.iter().zip(&self.of_lights) {
            let Some((first, count)) = *maps else { continue };
            let views = (0..count).map(|map| view(light, [map, count], self.size, seen));
            all.iter_mut().skip(first).zip(views).for_each(|(view, own)| *view = own);
        }
        all
    }
}

/// What maps are to show: what a camera sees of a scene.
#[derive(Clone, Copy, Debug)]
pub struct CameraView {
    /// From where.
    pub camera: Camera,
    /// Columns of the image for each row.
    pub aspect: f32,
    /// Of the scene.
    pub bounds: Bounds,
}

/// From where the maps of a light look, `size` texels wide each.
pub fn views(light: &Light, size: usize, seen: CameraView) -> Vec<FrameView> {
    let count = map_count(light);
    (0..count).map(|map| view(light, [map, count], size, seen)).collect()
}

/// From where one map of so many looks.
fn view(light: &Light, [map, count]: [usize; 2], size: usize, seen: CameraView) -> FrameView {
    let near = 1e-4 * seen.bounds.diagonal();
    // Two texels on each side for the filter.
    let wider = 1.0 + 4.0 / size as f32;
    match *light {
        Light::Spot { position, direction, cos_outer, .. } if count == 1 => {
            let tangent = (1.0 - cos_outer * cos_outer).max(0.0).sqrt() / cos_outer;
            square(position, looking(direction), tangent * wider, near, size)
        }
        Light::Point { position, .. } | Light::Spot { position, .. } => {
            square(position, looking(FACES[map]), wider, near, size)
        }
        Light::Directional { direction, .. } => {
            // The last are the widest.
            cascade(direction, slice(map + CASCADES - count, seen), seen.bounds, size)
        }
    }
}

/// A map of a directional light around a sphere, moved by whole texels.
fn cascade(direction: Vec3, (centre, radius): (Vec3, f32), bounds: Bounds, size: usize) -> FrameView {
    let axes = looking(direction);
    // Two texels on each side for the filter.
    let radius = radius * (1.0 + 4.0 / size as f32);
    let texel = 2.0 * radius / size as f32;
    let mut at = axes.transpose() * centre;
    at.x = (at.x / texel).floor() * texel;
    at.y = (at.y / texel).floor() * texel;
    // From before all that could throw a shadow to behind all that could receive one.
    let depths = bounds.corners().map(|corner| axes.z_axis.dot(corner));
    let nearest = depths.iter().copied().fold(f32::MIN, f32::max);
    let farthest = depths.iter().copied().fold(f32::MAX, f32::min);
    let margin = 1e-3 * (nearest - farthest).max(radius);
    at.z = nearest + margin;
    parallel(axes * at, axes, radius, nearest - farthest + 2.0 * margin, size)
}

/// Sides of a cube, in the order in which shaders look for them.
const FACES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

/// How many maps a light needs.
pub fn map_count(light: &Light) -> usize {
    match *light {
        Light::Directional { .. } => CASCADES,
        Light::Spot { cos_outer, .. } if cos_outer >= WIDEST_MAP => 1,
        Light::Spot { .. } | Light::Point { .. } => 6,
    }
}

/// What decides which lights cast shadows.
fn strength(light: &Light) -> f32 {
    match *light {
        Light::Directional { irradiance, .. } => 1e6 * irradiance.element_sum(),
        Light::Spot { intensity, .. } | Light::Point { intensity, .. } => intensity.element_sum(),
    }
}

/// Axes of a view along a direction.
fn looking(direction: Vec3) -> Mat3 {
    Camera::look_at(Vec3::ZERO, direction).rotation
}

/// The sphere around a cascade's slice of what a camera sees, as far as the scene goes; the last around all
/// of the scene, for what is lit where the camera does not look.
fn slice(cascade: usize, CameraView { camera, aspect, bounds }: CameraView) -> (Vec3, f32) {
    if cascade + 1 == CASCADES {
        return (bounds.centre(), rounded_up(0.5 * bounds.diagonal()));
    }
    let farthest =
        bounds.corners().map(|corner| camera.position.distance(corner)).into_iter().fold(0.0, f32::max);
    let nearest = 2e-3 * farthest;
    let depth = |part: f32| {
        let even = nearest + (farthest - nearest) * part;
        let ratio = nearest * (farthest / nearest).powf(part);
        EVEN_SHARE * even + (1.0 - EVEN_SHARE) * ratio
    };
    let part = |i: usize| i as f32 / CASCADES as f32;
    let (near, far) = (if cascade == 0 { 0.0 } else { depth(part(cascade)) }, depth(part(cascade + 1)));
    // The sphere through the corners of both ends of the slice, or around its far end where that is wider.
    let tangent = (0.5 * camera.vertical_fov).tan();
    let corner = tangent * (1.0 + aspect * aspect).sqrt();
    let middle = (0.5 * (near + far) * (1.0 + corner * corner)).min(far);
    let radius = rounded_up((far - middle).hypot(far * corner));
    (camera.position - camera.rotation.z_axis * middle, radius)
}

/// A little more, one of eight steps to the next power of two: a map that is as wide from frame to frame has
/// the same texels.
fn rounded_up(radius: f32) -> f32 {
    ((radius.log2() * 8.0).ceil() / 8.0).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(power: f32) -> Light {
        Light::Point { position: Vec3::ZERO, intensity: Vec3::splat(power), range: f32::INFINITY }
    }

    #[test]
    fn maps_shrink_before_lights_lose_their_shadows_and_the_faintest_lose_them_first() {
        let few = MapPlan::new(&[lamp(1.0), lamp(2.0)], 2, 1024);
        assert_eq!((few.size, few.maps, few.without_shadow()), (1024, 12, 0));
        let many: Vec<Light> = (0..40).map(|i| lamp(i as f32)).collect();
        let many = MapPlan::new(&many, 40, 1024);
        assert_eq!((many.size, many.maps, many.without_shadow()), (512, 240, 0));
        let crowd: Vec<Light> = (0..200).map(|i| lamp(i as f32)).collect();
        let crowd = MapPlan::new(&crowd, 200, 1024);
        assert_eq!((crowd.size, crowd.maps, crowd.without_shadow()), (256, 252, 158));
        assert!(crowd.of_lights[199].is_some() && crowd.of_lights[0].is_none());
    }

    #[test]
    fn cascades_hold_their_slices_and_move_by_whole_texels() {
        let bounds = Bounds { min: Vec3::new(-20.0, 0.0, -20.0), max: Vec3::new(20.0, 10.0, 20.0) };
        let sun = Light::Directional {
            direction: Vec3::new(0.3, -1.0, 0.2).normalize(),
            irradiance: Vec3::ONE,
            pattern: None,
        };
        let plan = MapPlan::new(&[sun], 1, 512);
        let camera = Camera::look_at(Vec3::new(-15.0, 2.0, 3.0), Vec3::new(10.0, 1.0, 0.0));
        let seen = CameraView { camera, aspect: 1.5, bounds };
        let views = plan.views(&[sun], seen);
        assert_eq!(views.len(), CASCADES);
        // Points of the image's edge at depths up to the scene's end are in some cascade.
        for depth in [0.5, 2.0, 9.0, 20.0, 33.0] {
            let edge = camera.direction(glam::Vec2::new(0.5, 0.5), 100, 150);
            let point = camera.position + edge * (depth / -camera.direction_to_camera(edge).z);
            let inside = |view: &FrameView| {
                let offset = point - Vec3::from_slice(&view.eye[..3]);
                let across = Vec3::from_slice(&view.right[..3]).dot(offset) * view.scale_x;
                let upwards = Vec3::from_slice(&view.up[..3]).dot(offset) * view.scale_y;
                across.abs() < 1.0 && upwards.abs() < 1.0
            };
            assert!(views.iter().any(inside), "depth {depth}");
        }
        assert!(views.windows(2).all(|pair| pair[0].scale_x > pair[1].scale_x), "the first is the finest");
        let beside = Camera { position: camera.position + Vec3::new(0.013, 0.0, 0.007), ..camera };
        let around = MapPlan::new(&[sun, sun], 1, 512);
        let all = around.views(&[sun, sun], seen);
        let bytes = |views: [&FrameView; 2]| views.map(|view| bytemuck::bytes_of(view).to_vec());
        assert_eq!(around.maps, CASCADES + 1);
        assert_eq!(bytes([&all[0], &all[4]]), bytes([&views[0], &views[3]]), "the widest alone");
        for (a, b) in views.iter().zip(plan.views(&[sun], CameraView { camera: beside, ..seen })) {
            let texel = 2.0 / (a.scale_x * a.width as f32);
            let way = Vec3::from_slice(&b.eye[..3]) - Vec3::from_slice(&a.eye[..3]);
            let texels = Vec3::from_slice(&a.right[..3]).dot(way) / texel;
            assert!((texels - texels.round()).abs() < 2e-2, "{texels} texels");
        }
    }
}
