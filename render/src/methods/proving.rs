//! What tests of methods share: surfaces written down as formulas, and the comparison of a method's passes
//! with its plain version.

pub mod beyond;
pub mod receiver;

use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::methods::picture::every_pixel;
use crate::methods::{Quality, gtao, ring_gather};
use crate::sampler::{cosine_hemisphere, frame};
use crate::scene::procedural::Family;
use crate::scene::{Camera, Environment, Lens, Material, Mesh, Scene};
use crate::screen::{
    GpuGBuffer, Inputs, MethodPasses, MethodStep, PlainInputs, ScreenMethod, Technique, View, Written,
};
use deepshade_shaders::gpu;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{IVec2, Mat3, Vec2, Vec3};

/// A camera at the origin that looks down -z.
pub fn camera() -> Camera {
    Camera { position: Vec3::ZERO, rotation: Mat3::IDENTITY, vertical_fov: 50f32.to_radians(), lens: None }
}

/// What [`camera`] sees of an image of this size.
pub fn view(height: usize, width: usize, radius: f32) -> View {
    View { height, width, camera: camera(), radius, seed: 11 }
}

/// Position, normal, depth and validity of the surface that `hit` finds along the ray of each pixel: a point
/// and a normal in camera space.
pub fn gbuffer_of(height: usize, width: usize, hit: impl Fn(Vec3) -> Option<(Vec3, Vec3)>) -> GBuffer {
    let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Depth, Attribute::Valid];
    let at = |y: usize, x: usize| {
        let ray = camera().direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
        hit(ray).map_or([0.0; 8], |(p, n)| [p.x, p.y, p.z, n.x, n.y, n.z, -p.z, 1.0])
    };
    let pixels: Vec<[f32; 8]> = (0..height * width).map(|i| at(i / width, i % width)).collect();
    GBuffer::new(attributes, Planes::from_fn(8, height, width, |c, y, x| pixels[y * width + x][c]))
}

/// Where a ray from the camera meets the front of a plane through `point`.
pub fn plane(ray: Vec3, point: Vec3, normal: Vec3) -> Option<(Vec3, Vec3)> {
    let facing = normal.dot(ray);
    (facing < 0.0).then(|| (ray * (normal.dot(point) / facing), normal)).filter(|(at, _)| at.z < 0.0)
}

/// Where a ray from the camera enters a sphere.
pub fn sphere(ray: Vec3, centre: Vec3, radius: f32) -> Option<(Vec3, Vec3)> {
    let middle = ray.dot(centre);
    let inside = middle * middle - centre.length_squared() + radius * radius;
    (inside > 0.0 && middle > 0.0).then(|| {
        let at = ray * (middle - inside.sqrt());
        (at, (at - centre) / radius)
    })
}

/// The nearest of several.
pub fn nearest(hits: impl IntoIterator<Item = Option<(Vec3, Vec3)>>) -> Option<(Vec3, Vec3)> {
    hits.into_iter().flatten().min_by(|a, b| a.0.length().total_cmp(&b.0.length()))
}

/// A slanted floor, a wall of limited height, two spheres and some sky: nothing symmetric.
pub fn still_life(height: usize, width: usize) -> GBuffer {
    gbuffer_of(height, width, |ray| {
        let floor = plane(ray, Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.05, 1.0, 0.02).normalize());
        let wall = plane(ray, Vec3::new(0.0, 0.0, -6.0), Vec3::new(-0.4, 0.0, 1.0).normalize())
            .filter(|(at, _)| at.y < 0.8);
        let ball = sphere(ray, Vec3::new(-0.7, -0.5, -3.0), 0.5);
        let other = sphere(ray, Vec3::new(0.9, -0.7, -4.2), 0.8);
        nearest([floor, wall, ball, other])
    })
}

/// What [`still_life`] shows, with light that has edges of its own, a lens' blur, motion and a mean free
/// path: attributes of every effect that is made of the picture.
pub fn lit_still_life(height: usize, width: usize) -> GBuffer {
    let surface = still_life(height, width);
    let planes = surface.planes().clone();
    let at = |plane: usize, y: usize, x: usize| planes.at(plane, y, x);
    let more = vec![Attribute::Light, Attribute::Blurriness, Attribute::Motion, Attribute::MeanFreePath];
    let attributes = [surface.attributes().to_vec(), more].concat();
    let pixel = |y: usize, x: usize| {
        let (position, depth) = (Vec3::new(at(0, y, x), at(1, y, x), at(2, y, x)), at(6, y, x));
        let facing = Vec3::new(at(3, y, x), at(4, y, x), at(5, y, x)).dot(Vec3::new(0.3, 0.8, 0.5));
        let checks = (position * 3.0).floor().element_sum().rem_euclid(2.0);
        let light = Vec3::new(0.9, 0.7, 0.5) * facing.max(0.0) * (0.2 + checks);
        let moves = f32::from(position.x > 0.0 && position.y < 0.1 && depth < 5.0);
        let motion = [0.4 + 0.2 * depth, moves * 9.0];
        let length = Vec3::new(0.3, 0.1, 0.0) * moves + Vec3::new(0.0, 0.04, 0.02);
        [&light.to_array()[..], &[6.0 * (depth - 3.5)], &motion, &length.to_array()].concat()
    };
    let seen = |y: usize, x: usize| at(7, y, x) > 0.5;
    let planes = Planes::from_fn(8 + 9, height, width, |c, y, x| match c {
        0..8 => at(c, y, x),
        _ if seen(y, x) => pixel(y, x)[c - 8],
        _ => 0.0,
    });
    GBuffer::new(attributes, planes)
}

/// Light and validity of every pixel, given its column and row; `None` where no surface is seen.
pub fn picture_of(height: usize, width: usize, light: impl Fn(IVec2) -> Option<Vec3> + Sync) -> GBuffer {
    let pixels = every_pixel(height, width, |at| light(at).map_or([0.0; 4], |l| [l.x, l.y, l.z, 1.0]));
    let planes = Planes::from_fn(4, height, width, |c, y, x| pixels[y * width + x][c]);
    GBuffer::new(vec![Attribute::Light, Attribute::Valid], planes)
}

/// A plane that faces the camera: what each pixel shows of it gives `light` and takes light from so many
/// pixels away as its mean free path has.
pub fn facing_plane(
    height: usize,
    width: usize,
    pixels: Vec3,
    light: impl Fn(IVec2) -> Vec3 + Sync,
) -> GBuffer {
    const DEPTH: f32 = 4.0;
    let size = DEPTH / camera().focal_length(height);
    let at = |at: IVec2| {
        let right = (at.x as f32 + 0.5 - 0.5 * width as f32) * size;
        let up = (0.5 * height as f32 - 0.5 - at.y as f32) * size;
        let (light, length) = (light(at), pixels * size);
        [right, up, -DEPTH, length.x, length.y, length.z, light.x, light.y, light.z, 1.0]
    };
    let pixels = every_pixel(height, width, at);
    let planes = Planes::from_fn(10, height, width, |c, y, x| pixels[y * width + x][c]);
    let attributes = [Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid];
    GBuffer::new(attributes.to_vec(), planes)
}

/// A floor and two walls that meet in a corner.
pub fn corner() -> TracedScene {
    let (x, y, z) = (3.0 * Vec3::X, 3.0 * Vec3::Y, 3.0 * Vec3::Z);
    let quad = |along: Vec3, beside: Vec3| Mesh {
        positions: vec![Vec3::ZERO, along, along + beside, beside],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let materials = vec![Material::matte("grey", Vec3::splat(0.5))];
    let meshes = vec![quad(z, x), quad(x, y), quad(y, z)];
    TracedScene::new(Scene { meshes: meshes.into(), materials, ..Scene::default() }).expect("three squares")
}

/// Mean over the cosine-weighted hemisphere around a normal of what a direction brings.
pub fn hemisphere_mean(normal: Vec3, brings: impl Fn(Vec3) -> f32) -> f32 {
    let edge = 200;
    let middle = |i: usize| (i as f32 + 0.5) / edge as f32;
    let to_space = frame(normal);
    let value = |i: usize| brings(to_space * cosine_hemisphere(middle(i % edge), middle(i / edge)));
    (0..edge * edge).map(value).sum::<f32>() / (edge * edge) as f32
}

/// Mean distance of an image's values from another's.
pub fn mean_difference(a: &Planes, b: &Planes) -> f32 {
    let differences = a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs());
    differences.sum::<f32>() / a.data().len() as f32
}

/// A scene that moves, is lit and has a lens, with every attribute: the dominoes' playground, some sky
/// included.
pub fn everything(height: usize, width: usize) -> (TracedScene, View, GBuffer) {
    let mut scene = Family::Playground.scene(3);
    let diagonal = scene.bounds().diagonal();
    for material in &mut scene.materials {
        material.mean_free_path = diagonal * Vec3::new(0.02, 0.01, 0.0);
    }
    for mesh in scene.meshes.iter_mut().step_by(3) {
        mesh.displacements = vec![diagonal * Vec3::new(0.05, 0.02, -0.05); mesh.positions.len()];
    }
    let scene = TracedScene::new(scene).expect("a scene");
    let bounds = scene.bounds();
    let eye = bounds.centre() + bounds.size() * Vec3::new(0.35, 0.3, 0.4);
    let camera = Camera::look_at(eye, bounds.centre());
    let lens = Lens::new(0.02 * scene.diagonal(), 0.4 * scene.diagonal()).expect("a lens");
    let camera = Camera { lens: Some(lens), ..camera };
    let gbuffer = gbuffer::render(&scene, &camera, height, width, &Attribute::ALL);
    (scene, View { height, width, camera, radius: 0.1 * bounds.diagonal(), seed: 11 }, gbuffer)
}

/// How much rounding may do. It differs a little between processors, and now and then it puts a sample on the
/// neighbouring pixel.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// 99 of 100 values differ by no more.
    pub usual: f32,
    /// No value differs by more.
    pub worst: f32,
}

/// Whether two images agree value by value.
///
/// # Errors
/// In words, how they differ.
pub fn agree(a: &Planes, b: &Planes, tolerance: Tolerance) -> Result<(), String> {
    assert!(a.same_shape(b));
    values_agree(a.data(), b.data(), tolerance)
}

fn values_agree(a: &[f32], b: &[f32], tolerance: Tolerance) -> Result<(), String> {
    assert_eq!(a.len(), b.len());
    let mut differences: Vec<f32> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    if differences.iter().any(|difference| difference.is_nan()) {
        return Err("not a number".to_owned());
    }
    differences.sort_unstable_by(f32::total_cmp);
    let usual = differences[(differences.len() * 99 / 100).min(differences.len() - 1)];
    let worst = differences[differences.len() - 1];
    if usual <= tolerance.usual && worst <= tolerance.worst {
        Ok(())
    } else {
        Err(format!("99 % differ by up to {usual}, the worst by {worst}"))
    }
}

/// What each of a method's passes writes of a g-buffer, read before the next one runs.
pub fn written_on_gpu(
    method: &ScreenMethod,
    gbuffer: &GBuffer,
    environment: Option<&Environment>,
    view: &View,
) -> Written {
    let gpu = method.gpu();
    let uploaded =
        GpuGBuffer::upload(&gpu.device, gbuffer, method.attributes()).expect("attributes and room");
    let inputs = Inputs { gbuffer: &uploaded, environment, world: None };
    let passes = MethodPasses::new(method, &inputs, view).expect("passes");
    let read = |buffer: &wgpu::Buffer| gpu::read::<f32>(&gpu.device, &gpu.queue, buffer).expect("values");
    let submit = |record: &dyn Fn(&mut wgpu::CommandEncoder)| {
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| record(encoder)).expect("valid passes");
    };
    let mut written = Written::new();
    for MethodStep { step, writes } in passes.steps() {
        submit(&|encoder| step.encode(encoder, "test", None));
        written.extend(writes.iter().map(read));
    }
    submit(&|encoder| passes.encode(encoder));
    let bits = |image: &[f32]| image.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
    let last = written.last().expect("an image");
    assert!(bits(last) == bits(&read(passes.output())), "{}: all at once gives the same bits", method.name());
    written
}

/// What a method's passes make of a g-buffer.
pub fn on_gpu(
    method: &ScreenMethod,
    gbuffer: &GBuffer,
    environment: Option<&Environment>,
    view: &View,
) -> Planes {
    let image = written_on_gpu(method, gbuffer, environment, view).pop().expect("an image");
    Planes::from_data(method.effect().channels(), view.height, view.width, image)
}

/// Proves that each of a method's passes writes what its plain version does, and that all at once they make
/// the same bits.
///
/// # Panics
/// If they do not.
pub fn prove_twin(
    method: &ScreenMethod,
    gbuffer: &GBuffer,
    environment: Option<&Environment>,
    view: &View,
    tolerance: Tolerance,
) {
    let inputs = PlainInputs { gbuffer, environment, scene: None };
    let wanted = method.reference(&inputs, view).expect("all attributes");
    let found = written_on_gpu(method, gbuffer, environment, view);
    let compared = passes_agree(&found, &wanted, tolerance);
    assert_eq!(compared, Ok(()), "{} at {}x{}", method.name(), view.width, view.height);
}

/// Compares what a method's version for the processor writes of a g-buffer with its plain version.
pub fn prove_twin_on_processor(
    method: &impl Technique,
    gbuffer: &GBuffer,
    view: &View,
    tolerance: Tolerance,
) {
    let inputs = PlainInputs { gbuffer, environment: None, scene: None };
    let wanted = method.reference(&inputs, view).expect("all attributes");
    let found = method.on_processor(&inputs, view).expect("such a version").expect("all attributes");
    let compared = passes_agree(&found, &wanted, tolerance);
    assert_eq!(compared, Ok(()), "{}x{} at a radius of {}", view.width, view.height, view.radius);
}

/// Whether what passes write agrees, buffer by buffer.
fn passes_agree(a: &Written, b: &Written, tolerance: Tolerance) -> Result<(), String> {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).enumerate().try_for_each(|(index, (a, b))| {
        values_agree(a, b, tolerance).map_err(|what| format!("buffer {index}: {what}"))
    })
}

/// Proves that this tolerance tells an image from those that mistakes make of it: shifted by a pixel,
/// mirrored, upside down, 1 % too bright, with one value that is no number. An image that is alike everywhere
/// would pass for them.
///
/// # Panics
/// If it does not.
pub fn prove_comparator(right: &Planes, tolerance: Tolerance) {
    let (channels, height, width) = (right.channels(), right.height(), right.width());
    let changed =
        |value: &dyn Fn(usize, usize, usize) -> f32| Planes::from_fn(channels, height, width, value);
    let wrong = [
        ("shifted", changed(&|c, y, x| right.at(c, y, x.saturating_sub(1)))),
        ("mirrored", changed(&|c, y, x| right.at(c, y, width - 1 - x))),
        ("upside down", changed(&|c, y, x| right.at(c, height - 1 - y, x))),
        ("brighter", changed(&|c, y, x| 1.01 * right.at(c, y, x))),
        (
            "broken",
            changed(&|c, y, x| if (y, x) == (height / 2, width / 2) { f32::NAN } else { right.at(c, y, x) }),
        ),
    ];
    assert_eq!(agree(right, right, tolerance), Ok(()));
    for (how, image) in wrong {
        assert!(agree(right, &image, tolerance).is_err(), "an image that is {how} passes");
    }
}

#[test]
fn a_pass_between_that_is_wrong_is_found_out() {
    let gpu = gpu::Gpu::new().expect("an adapter; lavapipe will do");
    let tolerance = Tolerance { usual: 1e-4, worst: 0.05 };
    let gtao = ScreenMethod::new(&gpu, gtao::GtaoParameters::of(Quality::High));
    let ring_gather = ScreenMethod::new(&gpu, ring_gather::RingGatherParameters::of(Quality::High));
    let gbuffer = lit_still_life(43, 61);
    let view = view(43, 61, 1.0);
    for (method, buffers) in [(&gtao as &ScreenMethod, 3), (&ring_gather, 6)] {
        let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: None };
        let right = method.reference(&inputs, &view).expect("all attributes");
        assert_eq!((right.len(), passes_agree(&right, &right, tolerance)), (buffers, Ok(())));
        for buffer in 0..buffers {
            let mut wrong = right.clone();
            wrong[buffer].iter_mut().for_each(|value| *value *= 1.01);
            let error = passes_agree(&right, &wrong, tolerance).expect_err("1 % too much");
            assert!(error.starts_with(&format!("buffer {buffer}: ")), "{}: {error}", method.name());
        }
    }
}
