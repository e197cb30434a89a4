//! What surfaces let through, and clear coats.

use super::*;
use crate::bvh::TracedScene;
use crate::path::proving::quad;
use crate::scene::coat::Coat;
use crate::scene::transmission::{Transmission, Walls};
use crate::scene::{MaterialId, Mesh, Scene};

const COLOUR: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const SOLID: Walls = Walls::Solid { absorption: Vec3::ZERO };
const IOR: f32 = 1.5;

/// All layers of a square at z = 0, seen from above, where its front is or its back.
fn layered(material: Material, is_front: bool) -> Bsdf {
    let mut corners = [(-9., -9.), (9., -9.), (9., 9.), (-9., 9.)].map(|(x, y)| Vec3::new(x, y, 0.0));
    if !is_front {
        corners.reverse();
    }
    let square = Mesh { material: MaterialId(0), ..quad(corners) };
    let scene = Scene { meshes: vec![square].into(), materials: vec![material], ..Scene::default() };
    let scene = TracedScene::new(scene).expect("a square");
    let hit = scene.hit(Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, 9.0).expect("the square");
    let point = SurfacePoint::new(&scene, &hit, Vec3::NEG_Z);
    assert_eq!(point.is_front, is_front);
    Bsdf::layered(&point)
}

fn glass(walls: Walls, roughness: f32, colour: Vec3, share: f32) -> Material {
    Material {
        ior: IOR,
        transmission: Some(Transmission { share, texture: None, walls }),
        ..material(Gloss::Microfacets, 0.0, roughness, colour)
    }
}

fn coated(base: Material, share: f32, roughness: f32) -> Material {
    Material { coat: Some(Coat { share, roughness, ..Coat::default() }), ..base }
}

/// Wide lobes of every kind.
fn wide() -> Vec<(String, Bsdf)> {
    let mut all = Vec::new();
    for roughness in [0.3, 0.7] {
        for share in [0.6, 1.0] {
            for is_front in [true, false] {
                let solid = layered(glass(SOLID, roughness, COLOUR, share), is_front);
                all.push((format!("solid, roughness {roughness}, share {share}, front {is_front}"), solid));
            }
            let thin = layered(glass(Walls::Thin, roughness, COLOUR, share), true);
            all.push((format!("thin, roughness {roughness}, share {share}"), thin));
        }
        for metallic in [0.0, 1.0] {
            let base = material(Gloss::Microfacets, metallic, 0.6, COLOUR);
            let coat = layered(coated(base, 0.8, roughness), true);
            all.push((format!("coat of roughness {roughness}, metallic {metallic}"), coat));
        }
        let both = coated(glass(Walls::Thin, 0.5, COLOUR, 0.9), 1.0, roughness);
        all.push((format!("coat of roughness {roughness} over a pane"), layered(both, true)));
    }
    all
}

#[test]
fn every_sampler_has_its_density() {
    let angles = [0.0, 50.0, 80.0];
    let tests = wide().len() * angles.len();
    for (name, bsdf) in wide() {
        for to_viewer in angles.map(viewer) {
            let sample = |stream: &mut Stream| bsdf.sample(to_viewer, stream).map(|sample| sample.direction);
            let p = p_value(Vec3::X, sample, |direction| bsdf.density(to_viewer, direction));
            println!("{name}, {to_viewer}: {p}");
            chi_square::proves("chi_square/layers", p, tests);
        }
    }
}

#[test]
fn a_sampler_does_not_have_the_density_of_another_index_of_refraction() {
    let [glass, denser] =
        [IOR, 1.53].map(|ior| layered(Material { ior, ..glass(SOLID, 0.3, Vec3::ONE, 1.0) }, true));
    let sample = |stream: &mut Stream| glass.sample(viewer(50.0), stream).map(|sample| sample.direction);
    let p = p_value(Vec3::X, sample, |direction| denser.density(viewer(50.0), direction));
    chi_square::refutes("chi_square/layers", p, 100);
}

#[test]
fn what_passes_one_way_passes_the_other() {
    let direction = |i, set| {
        let [u, v, ..] = PixelSampler::new(4, 0, 0).sample_4d(i, set);
        cosine_hemisphere(u, v)
    };
    let mut passed = 0;
    for (walls, squared) in [(SOLID, IOR * IOR), (Walls::Thin, 1.0)] {
        for roughness in [0.3, 0.7] {
            let [front, back] =
                [true, false].map(|is_front| layered(glass(walls, roughness, COLOUR, 0.7), is_front));
            for i in 0..300 {
                let (above, below) = (direction(i, 0), -direction(i, 1));
                // The same pair for who sees the other side from above.
                let mirrored = |direction: Vec3| Vec3::new(direction.x, direction.y, -direction.z);
                let there = front.evaluate(above, below) / (-below.z * squared);
                let here = back.evaluate(mirrored(below), mirrored(above)) / above.z;
                let off = (there - here).abs().max_element();
                assert!(off <= 2e-3 * there.max_element().max(1e-4), "{walls:?}: {there} {here}");
                passed += usize::from(there.x > 1e-3);
            }
        }
    }
    assert!(passed > 300, "{passed}");
}

#[test]
fn coats_reflect_the_same_both_ways() {
    for (name, bsdf) in wide().into_iter().filter(|(name, _)| name.contains("coat")) {
        for i in 0..200 {
            let [u, v, s, t] = PixelSampler::new(4, 0, 0).sample_4d(i, 0);
            let (a, b) = (cosine_hemisphere(u, v), cosine_hemisphere(s, t));
            let (there, back) = (bsdf.evaluate(a, b) / b.z, bsdf.evaluate(b, a) / a.z);
            let off = (there - back).abs().max_element();
            assert!(off <= 1e-3 * there.max_element(), "{name}: {there} {back}");
        }
    }
}

/// What a surface sends of even light from all sides.
fn sent(bsdf: &Bsdf, to_viewer: Vec3) -> (Vec3, Vec3) {
    let (mean, error) = estimated(bsdf, to_viewer, |_| 1.0, 1024);
    (mean + bsdf.straight(to_viewer).map_or(Vec3::ZERO, |straight| straight.share), error)
}

#[test]
fn white_glass_sends_all_that_it_gets() {
    // Of bodies microfacets hide more from each other the rougher they are, above all from within.
    for (roughness, of_body, of_pane) in [(0.0, 0.001, 0.001), (0.3, 0.04, 0.02), (0.6, 0.3, 0.09)] {
        for (walls, is_front, lost) in
            [(SOLID, true, of_body), (SOLID, false, of_body), (Walls::Thin, true, of_pane)]
        {
            let bsdf = layered(glass(walls, roughness, Vec3::ONE, 1.0), is_front);
            // Beyond 41.8 degrees all is reflected within.
            for angle in [0.0, 35.0, 41.0, 43.0, 65.0] {
                let (mean, error) = sent(&bsdf, viewer(angle));
                let name = format!("{walls:?}, front {is_front}, roughness {roughness}, {angle}: {mean}");
                println!("{name} +- {error}");
                assert!(mean.max_element() < 1.001 + 3.0 * error.max_element(), "{name}");
                assert!(mean.min_element() > 1.0 - lost - 3.0 * error.max_element(), "{name}");
            }
        }
    }
}

#[test]
fn coated_white_sends_no_more_than_it_gets_and_little_less() {
    for (metallic, least) in [(1.0, 0.96), (0.0, 0.93)] {
        for angle in [0.0, 35.0, 65.0, 84.0] {
            let base = material(Gloss::Microfacets, metallic, 0.1, Vec3::ONE);
            let (mean, error) = sent(&layered(coated(base.clone(), 1.0, 0.1), true), viewer(angle));
            println!("metallic {metallic}, {angle}: {mean} +- {error}");
            assert!(mean.max_element() < 1.002 + 3.0 * error.max_element(), "{metallic}, {angle}: {mean}");
            assert!(mean.min_element() > least - 3.0 * error.max_element(), "{metallic}, {angle}: {mean}");
            let (bare, _) = sent(&layered(base, true), viewer(angle));
            assert!((bare - mean).x.abs() > 1e-4 || metallic == 1.0, "{bare}, {mean}: the coat is noticed");
        }
    }
}

#[test]
fn smooth_glass_bends_light_as_snell_says() {
    for (is_front, ratio) in [(true, IOR), (false, 1.0 / IOR)] {
        let bsdf = layered(glass(SOLID, 0.0, Vec3::ONE, 1.0), is_front);
        for angle in [10.0, 25.0, 38.0] {
            let to_viewer = viewer(angle);
            let mut bent = 0;
            for i in 0..200 {
                let Some(sample) = bsdf.sample(to_viewer, &mut Stream::new(PixelSampler::new(0, 0, 0), i))
                else {
                    continue;
                };
                if sample.direction.z > 0.0 {
                    continue;
                }
                bent += 1;
                let aside = |direction: Vec3| Vec3::new(direction.x, direction.y, 0.0);
                // The smoothest microfacets lean by a thousandth or a few.
                let off = aside(sample.direction) * ratio + aside(to_viewer);
                assert!(off.length() < 0.02, "{angle} degrees, front {is_front}: {off}");
            }
            assert!(bent > 150, "{bent} of 200");
        }
    }
}

#[test]
fn a_smooth_pane_lets_light_straight_on_and_only_layers_know() {
    let pane = glass(Walls::Thin, 0.0, COLOUR, 1.0);
    let straight = layered(pane.clone(), true).straight(Vec3::Z).expect("glass").share;
    assert!((straight - COLOUR * 0.96).abs().max_element() < 1e-6, "{straight}");
    assert!(layered(glass(Walls::Thin, 0.3, COLOUR, 1.0), true).straight(Vec3::Z).is_none(), "spread");
    let opaque = Material { transmission: None, ..pane.clone() };
    let of = |material: &Material| flat(material).evaluate(viewer(20.0), viewer(50.0));
    assert_eq!(of(&pane), of(&opaque));
    assert!(flat(&pane).straight(Vec3::Z).is_none());
    assert_eq!(flat(&pane).evaluate(viewer(20.0), -viewer(50.0)), Vec3::ZERO);
}
