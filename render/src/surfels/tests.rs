//! Surfels stand for the surface: their areas, sizes and places, and the passes against the plain version.

use super::reference::{self, Disk, roulette};
use super::{Cloud, HEIGHT, LEAF, MOST, Surfel, SurfelDensity, SurfelLight, Tree, cloud};
use crate::methods::proving;
use crate::raster::World;
use crate::raster::patches::{Patch, area_of, of_scene};
use crate::raster::view::perspective;
use crate::scene::procedural::Family;
use crate::scene::{Material, Mesh, Scene};
use crate::screen::{Device, MethodStep, View};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::wgsl::uniforms;
use glam::{Mat3, Vec3};
use std::f32::consts::PI;

const PARAMETERS: SurfelDensity = SurfelDensity { scale: 0.02, near: 0.25 };

/// A scene of one mesh.
fn scene(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Scene {
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    Scene { meshes: vec![mesh].into(), materials: vec![Material::default()], ..Scene::default() }
}

/// A grid of `n` x `n` squares of an edge each, `edge` metres, in the plane z = `z` in front of the camera.
fn sheet(n: u32, edge: f32, z: f32) -> Scene {
    let at = |i: u32| edge * (i as f32 - 0.5 * n as f32);
    let positions = (0..(n + 1) * (n + 1)).map(|i| Vec3::new(at(i % (n + 1)), at(i / (n + 1)), z)).collect();
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    scene(positions, (0..n * n).flat_map(square).collect())
}

fn view(reach: f32) -> View {
    proving::view(96, 128, reach)
}

fn disks(scene: &Scene, parameters: &SurfelDensity, reach: f32) -> Vec<Disk> {
    reference::surfels(scene, parameters, &view(reach))
}

fn total_area(disks: &[Disk]) -> f32 {
    disks.iter().map(|disk| PI * disk.radius * disk.radius).sum()
}

#[test]
fn their_areas_sum_up_to_the_surface() {
    // Nothing is left out where the effect reaches everything.
    let procedural = |family: Family| family.scene(3);
    let scenes = [
        ("triangles smaller than a surfel", sheet(120, 0.05, -4.0)),
        ("triangles larger than many", sheet(2, 4.0, -4.0)),
        (
            "one as large as the world",
            scene(
                vec![Vec3::new(-900., -2., 9.), Vec3::new(900., -2., 9.), Vec3::new(0., -2., -900.)],
                vec![[0, 1, 2]],
            ),
        ),
        ("a plain of 100 km, whose surfels have radii of hundreds of metres", sheet(8, 12_500.0, -50_000.0)),
        ("a room", procedural(Family::Room)),
        ("machinery", procedural(Family::Machinery)),
    ];
    for (name, scene) in scenes {
        let reach = 10.0 * scene.bounds().diagonal();
        let parameters = SurfelDensity { near: 0.01, ..PARAMETERS };
        let (wanted, found) = (area_of(&scene), total_area(&disks(&scene, &parameters, reach)));
        assert!((found / wanted - 1.0).abs() < 0.01, "{name}: {found} m² of {wanted} m²");
    }
}

#[test]
fn they_look_equally_large_wherever_they_are() {
    let scene = Family::Room.scene(1);
    let disks = disks(&scene, &PARAMETERS, 2.0);
    let settings = PARAMETERS.settings(&view(2.0));
    let size = |disk: &Disk| {
        let aside = reference::outside(disk.place, &settings).max(0.0);
        disk.radius / (settings.slope * ((disk.place.z + settings.near).abs() + settings.near + aside))
    };
    let mut sizes: Vec<f32> = disks.iter().map(size).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    let at = |share: f32| sizes[(share * (sizes.len() - 1) as f32) as usize];
    // The last one of a patch is a fraction; patches are small beside their distance.
    assert!(disks.len() > 2000, "{}", disks.len());
    assert!(at(0.9) < 1.1 && at(0.99) < 1.25 && at(0.5) > 0.9, "{} {} {}", at(0.5), at(0.9), at(0.99));
}

#[test]
fn what_lies_beside_the_camera_is_not_laid_out_finely() {
    // A wall in the plane of the camera, 100 m wide; it stands 10 m aside.
    let (near, far) = (Vec3::new(10.0, -50.0, 0.0), Vec3::new(110.0, 50.0, 0.0));
    let corners = vec![near, Vec3::new(far.x, near.y, 0.0), far, Vec3::new(near.x, far.y, 0.0)];
    let wall = scene(corners, vec![[0, 1, 2], [0, 2, 3]]);
    let parameters = SurfelDensity { near: 1e-5, ..PARAMETERS };
    let disks = disks(&wall, &parameters, 1e4);
    let slope = parameters.settings(&view(1e4)).slope;
    let fine = disks.iter().filter(|disk| disk.radius < 5.0 * slope).count();
    // The last one of a patch is a fraction.
    assert!(fine * 10 < disks.len(), "{fine} of {} are as if they were less than 5 m away", disks.len());
    assert!((total_area(&disks) / 1e4 - 1.0).abs() < 0.05);
}

#[test]
fn a_share_of_a_surfel_is_right_in_the_mean_and_never_jumps() {
    let steps = 200_000;
    let threshold = |i: i32| (i as f32 + 0.5) / steps as f32;
    for share in [0.001, 0.05, 0.3, 0.7, 0.8, 0.85, 0.95, 0.999] {
        let mean =
            (0..steps).map(|i| f64::from(roulette(share, threshold(i)))).sum::<f64>() / f64::from(steps);
        assert!((mean / f64::from(share) - 1.0).abs() < 0.01, "{share}: {mean}");
    }
    for fixed in [0.05, 0.4, 0.9] {
        let sizes: Vec<f32> = (1..=1000).map(|i| roulette(i as f32 / 1000.0, fixed)).collect();
        let jump = sizes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(sizes[0], f32::max);
        let is_share = sizes.iter().all(|size| (0.0..=1.0).contains(size));
        assert!(jump < 0.1 && sizes[999] == 1.0 && is_share, "{fixed}: {jump}");
    }
}

#[test]
fn they_stay_where_they_are_when_the_camera_comes_closer() {
    let far = sheet(4, 1.0, -6.0);
    let near = sheet(4, 1.0, -5.9);
    let [far, near] = [far, near].map(|scene| disks(&scene, &PARAMETERS, 20.0));
    assert!(near.len() > far.len(), "{} and {}", near.len(), far.len());
    let moved = |disk: &Disk| disk.place + Vec3::Z * 0.1;
    let kept = |disk: &&Disk| {
        near.iter().any(|other| other.patch == disk.patch && other.place.distance(moved(disk)) < 0.01)
    };
    let kept = far.iter().filter(kept).count();
    assert_eq!(kept, far.len());
}

/// What the passes make of a scene: amounts, starts, surfels, nodes.
struct Made {
    patches: Vec<Patch>,
    amounts: Vec<f32>,
    starts: Vec<u32>,
    count: [u32; 2],
    surfels: Vec<Surfel>,
    nodes: Vec<[f32; 8]>,
}

fn made(gpu: &Gpu, scene: &Scene, parameters: &SurfelDensity, view: &View) -> Made {
    let Gpu { device, queue, .. } = gpu;
    let world = World::new(gpu, &scene.clone().into(), None).expect("a scene");
    let cloud = Cloud::new(device, &world, None).expect("room");
    let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
    let settings = gpu::uniform(device, "settings", &parameters.settings(view)).expect("room");
    let camera = gpu::uniform(device, "camera", &camera).expect("room");
    let level = |level: uniforms::TreeLevel| gpu::uniform(device, "level", &level).expect("room");
    let levels: Vec<wgpu::Buffer> = cloud::tree_levels().map(level).collect();
    let uniforms = cloud::Uniforms { settings: &settings, view: &camera };
    let compiler = Device::new(device);
    let mut steps = cloud.surfel_steps(&compiler, &world, uniforms).expect("bindings");
    steps.extend(cloud.tree_steps(&compiler, Tree::All, &levels).expect("bindings"));
    gpu::submit(device, queue, "test", |encoder| {
        steps.iter().for_each(|MethodStep { step, .. }| step.encode(encoder, "test", None));
    })
    .expect("valid passes");
    let count = cloud.count(device, queue).expect("counts");
    let mut surfels: Vec<Surfel> = gpu::read(device, queue, &cloud.surfels).expect("surfels");
    surfels.truncate(count[0] as usize);
    Made {
        patches: world.patches(SurfelLight::reflectance(None)).to_vec(),
        amounts: gpu::read(device, queue, &cloud.amounts).expect("amounts"),
        starts: gpu::read(device, queue, &cloud.starts).expect("starts"),
        count,
        surfels,
        nodes: gpu::read(device, queue, &cloud.nodes).expect("nodes"),
    }
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    for (name, scene) in
        [("room", Family::Room.scene(2)), ("grove", Family::Grove.scene(1)), ("sheet", sheet(3, 2.0, -5.0))]
    {
        let mut view = view(0.1 * scene.bounds().diagonal());
        view.camera.position = scene.bounds().centre();
        let made = made(&gpu, &scene, &PARAMETERS, &view);
        assert_eq!(made.patches, of_scene(&scene, SurfelLight::reflectance(None)));
        let settings = PARAMETERS.settings(&view);
        let vertices = reference::vertices(scene.meshes.iter(), &view.camera);
        let amounts = reference::amounts(&made.patches, &vertices, &settings);
        let differ =
            amounts.iter().zip(&made.amounts).filter(|(a, b)| (*a - *b).abs() > 1e-3 * a.max(**b)).count();
        assert!(differ * 1000 < amounts.len(), "{name}: {differ} amounts of {}", amounts.len());
        assert!(
            made.amounts.iter().any(|amount| *amount > 0.0) && made.amounts.contains(&0.0),
            "{name}: some are left out"
        );

        let mut before = 0;
        for (amount, start) in made.amounts.iter().zip(&made.starts) {
            assert_eq!(*start, before, "{name}");
            before += amount.ceil() as u32;
        }
        assert_eq!(made.count, [before; 2], "{name}");
        let disks = reference::disks(&made.patches, &vertices, &made.amounts, &settings);
        assert_eq!((disks.len(), made.surfels.len()), (before as usize, before as usize), "{name}");
        // Rounding may lead to the other one of two radii; of normals to all that face one way.
        let mut differ = 0;
        for (disk, surfel) in disks.iter().zip(made.surfels.iter().map(|surfel| Disk::from(*surfel))) {
            let near = surfel.place.distance(disk.place) < 1e-3 * (1.0 + disk.place.length());
            let alike = near && (surfel.radius - disk.radius).abs() < 0.02 * disk.radius + 1e-7;
            let turned = surfel.normal.dot(disk.normal) < 0.9999 || surfel.open != disk.open;
            assert!(alike && !turned, "{name}: {disk:?} {surfel:?}");
            differ += usize::from(surfel.radius != disk.radius);
        }
        assert!(differ * 1000 <= disks.len(), "{name}: {differ} of {} have another radius", disks.len());
        let area: f32 = made.surfels.iter().map(|surfel| PI * surfel.radius().powi(2)).sum();
        assert!((area / total_area(&disks) - 1.0).abs() < 1e-4, "{name}: {area} m²");
        holds_all_below(&made);
    }
}

/// Whether the box of every node holds the surfels below, tightly.
fn holds_all_below(made: &Made) {
    for height in 0..=HEIGHT {
        let width = LEAF << (2 * height);
        let first_node = ((1usize << (2 * (HEIGHT - height))) - 1) / 3;
        for (index, below) in made.surfels.chunks(width).enumerate() {
            let [lx, ly, lz, reach, hx, hy, hz, _] = made.nodes[first_node + index];
            let places = || below.iter().map(|surfel| Vec3::from_array(surfel.place));
            let low = places().fold(Vec3::INFINITY, Vec3::min);
            let high = places().fold(Vec3::NEG_INFINITY, Vec3::max);
            let largest = below.iter().map(Surfel::radius).fold(0.0, f32::max);
            assert_eq!(
                (Vec3::new(lx, ly, lz), Vec3::new(hx, hy, hz), reach),
                (low, high, largest),
                "{height} {index}"
            );
        }
    }
}

#[test]
fn odd_scenes_have_defined_surfels() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let nothing = Scene { materials: vec![Material::default()], ..Scene::default() };
    assert_eq!(made(&gpu, &nothing, &PARAMETERS, &view(1.0)).count, [0, 0], "no triangle");
    let far_away = sheet(4, 1.0, 400.0);
    assert_eq!(made(&gpu, &far_away, &PARAMETERS, &view(1.0)).count, [0, 0], "far behind the camera");
    let behind = made(&gpu, &sheet(4, 1.0, 0.5), &PARAMETERS, &view(1.0));
    assert!(
        behind.count[0] > 100 && behind.surfels.iter().all(|surfel| surfel.place[2] > 0.0),
        "just behind"
    );
    let everywhere = made(&gpu, &sheet(4, 1.0, 0.0), &PARAMETERS, &view(0.0));
    assert!(
        everywhere.surfels.iter().all(|surfel| surfel.radius().is_finite()),
        "an effect that reaches nowhere"
    );

    let fine = SurfelDensity { scale: 1e-4, near: 0.01 };
    let many = made(&gpu, &sheet(8, 1.0, -3.0), &fine, &view(20.0));
    assert!(many.count[0] as usize == MOST && many.count[1] > many.count[0], "{:?}", many.count);
    let area: f32 = many.surfels.iter().map(|surfel| PI * surfel.radius().powi(2)).sum();
    assert!((area / 64.0 - 1.0).abs() < 0.02, "fewer stand for all: {area} m²");
    let turned = View {
        camera: crate::scene::Camera { rotation: Mat3::from_rotation_y(PI), ..view(1.0).camera },
        ..view(1.0)
    };
    assert_eq!(made(&gpu, &sheet(4, 1.0, -40.0), &PARAMETERS, &turned).count[0], 0, "looking away");
}
