use super::super::sets;
use super::*;
use deepshade_render::scene::{Camera, Material, Scene};
use glam::Vec3;

/// About two quarters of a wall, of two triangles and of one, before a camera, none of whose rays meets an
/// edge: there, triangles are a matter of rounding.
fn scene() -> TracedScene {
    let mesh = |corners: &[[f32; 2]], triangles: &[[u32; 3]]| Mesh {
        positions: corners.iter().map(|[x, y]| Vec3::new(*x, *y, -2.0)).collect(),
        triangles: triangles.to_vec(),
        ..Mesh::default()
    };
    let meshes = vec![
        mesh(&[[-1.03, -0.97], [0.02, -1.01], [0.01, 0.03], [-0.98, 0.01]], &[[0, 1, 2], [0, 2, 3]]),
        mesh(&[[0.06, 0.07], [0.99, 0.01], [1.02, 0.98]], &[[0, 1, 2]]),
    ];
    let materials = vec![Material::default()];
    TracedScene::new(Scene { meshes: meshes.into(), materials, ..Scene::default() }).expect("triangles")
}

fn primary(scene: &TracedScene, size: usize) -> RaySet {
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
    let [primary, ..] = sets::all(scene, std::iter::once(&camera), size);
    primary
}

/// Our own hierarchy under another name, with a fault.
struct FaultyTracer<'a> {
    scene: &'a TracedScene,
    /// Distances are so many times as large.
    stretch: f32,
    /// Triangles are counted from this.
    first: u32,
    /// Rays to the right of this meet nothing.
    right: f32,
}

impl<'a> FaultyTracer<'a> {
    const fn faultless(scene: &'a TracedScene) -> Self {
        Self { scene, stretch: 1.0, first: 0, right: f32::INFINITY }
    }
}

impl Rival for FaultyTracer<'_> {
    fn name(&self) -> &'static str {
        "Mirror"
    }

    fn build_seconds(&self) -> f64 {
        0.0
    }

    fn nearest(&self, ray: &Ray) -> Option<(f32, u32)> {
        let met = hit(self.scene, ray).filter(|_| ray.direction.x < self.right)?;
        let index = first_triangles(self.scene)[met.mesh as usize] + met.triangle;
        Some((met.distance * self.stretch, self.first + index))
    }

    fn blocked(&self, ray: &Ray) -> bool {
        self.nearest(ray).is_some()
    }
}

#[test]
fn a_rival_disagrees_where_it_meets_something_else() {
    let scene = scene();
    let set = primary(&scene, 32);
    let ray_bench = RayBench { scene: &scene, rival: None, runs: 1, finished: &|| {} };
    let met = |keep: fn(&Ray) -> bool| {
        let rays = set.rays.iter().filter(|ray| keep(ray) && hit(&scene, ray).is_some());
        rays.count() as f64 / set.rays.len() as f64
    };
    let (all, right) = (met(|_| true), met(|ray| ray.direction.x >= 0.0));
    assert!(right > 0.02 && all > right + 0.02 && all < 0.9, "{right} of {all}");
    let share = |rival: FaultyTracer<'_>| ray_bench.disagreement(&rival, &set);
    let faultless = || FaultyTracer::faultless(&scene);
    assert_eq!(share(faultless()), 0.0);
    assert_eq!(share(FaultyTracer { right: 0.0, ..faultless() }), right, "nothing where something is");
    // Either alone may be another triangle at the same place, or another distance by rounding.
    assert_eq!(share(FaultyTracer { first: 1, ..faultless() }), 0.0);
    assert_eq!(
        share(FaultyTracer { first: 1, stretch: 1.01, ..faultless() }),
        all,
        "another triangle elsewhere"
    );
    let occlusion = RaySet { kind: Kind::Ao, rays: set.rays.clone(), bundles: vec![] };
    assert_eq!(ray_bench.disagreement(&faultless(), &occlusion), 0.0);
    assert_eq!(ray_bench.disagreement(&FaultyTracer { right: 0.0, ..faultless() }, &occlusion), right);
}

#[test]
fn triangles_are_one_by_their_index_or_their_distance() {
    let ours = Hit { distance: 2.0, mesh: 1, triangle: 3, barycentric: Default::default() };
    let is = |theirs| same(Some(ours), theirs, &[0, 10]);
    assert!(is(Some((2.0, 13))) && is(Some((2.0001, 5))) && same(None, None, &[0, 10]));
    assert!(!is(Some((2.001, 5))) && !is(Some((2.001, 3))), "neither one nor the other");
    assert!(!is(None) && !same(None, Some((2.0, 13)), &[0, 10]));
}

#[test]
fn parts_of_the_rays_have_every_bundle_once() {
    // Edges of 60 pixels cut some bundles short.
    for (rays, bundles) in [(3600, 64), (4096 * 64 + 40, 4097), (1, 1), (64, 2)] {
        for chunk in [1, 63, 64, 1000, CHUNK, rays] {
            let mut next = 0;
            for start in (0..rays).step_by(chunk) {
                let part = bundles_of(start..rays.min(start + chunk), rays, bundles);
                assert_eq!(part.start, next, "{rays} rays by {chunk}");
                next = part.end;
            }
            assert_eq!(next, bundles, "{rays} rays by {chunk}");
        }
    }
}

#[test]
fn bundles_meet_what_single_rays_do() {
    let scene = scene();
    let ray_bench = RayBench { scene: &scene, rival: None, runs: 1, finished: &|| {} };
    // Not a multiple of a bundle's edge.
    let set = primary(&scene, 21);
    let met = |way: Way<'_>, parts: &[Range<usize>]| {
        parts.iter().map(|part| way(part.clone())).fold(0, u32::wrapping_add)
    };
    let (all, parts) = (0..set.rays.len(), [0..100, 100..300, 300..set.rays.len()]);
    let single = met(ray_bench.single(&set), std::slice::from_ref(&all));
    assert!(single > 0);
    assert_eq!(met(ray_bench.single(&set), &parts), single);
    assert_eq!(met(ray_bench.bundles(&set), std::slice::from_ref(&all)), single);
    assert_eq!(met(ray_bench.bundles(&set), &parts), single);
    assert_ne!(met(ray_bench.bundles(&set), &parts[..2]), single, "a part is missed");
}

#[test]
fn ratios_are_of_single_rays_and_bundles_are_called_so() {
    let rates = |one_thread| Rates { one_thread, all_threads: 2.0 * one_thread };
    let rival = Against { name: "Embree", rates: rates(4.0), disagree: 0.25 };
    let outcome = RayRates { single: rates(3.0), bundles: Some(rates(8.0)), rival: Some(rival) };
    let mut figures = Figures::new("bench rays");
    outcome.write(Kind::Ao, &mut figures);
    let figures = &figures.to_json()["figures"];
    for (name, value) in [
        ("ratio_ao", 0.75),
        ("ratio_ao_bundles", 2.0),
        ("mrays_ao", 3.0),
        ("mrays_ao_bundles_all_threads", 16.0),
        ("mrays_ao_embree", 4.0),
        ("disagree_ao", 0.25),
    ] {
        assert_eq!(figures[name], value, "{name}");
    }
}
