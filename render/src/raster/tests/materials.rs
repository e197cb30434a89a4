//! Materials of every kind, rasterised against traced: normal maps of meshes without tangents from both
//! sides, transformed coordinates of both sets, vertex colours, holes.

use super::*;
use crate::scene::{AlphaMode, Encoding, Filter, Mesh, Texture, TextureId, TextureSlot, Wrap};
use glam::{Affine2, Vec2, Vec4};

/// Colours that change smoothly and are symmetric in nothing.
fn texels(seed: u32) -> Vec<[u8; 4]> {
    let random = |i: u32, c: u32| (deepshade_shaders::random::random(i, c, seed, 0) * 130.0) as u8;
    // Alpha is high enough for a good part to be seen.
    let byte = |i: u32, c: u32| random(i, c) + if c == 3 { 125 } else { 60 };
    (0..12).map(|i| std::array::from_fn(|c| byte(i, c as u32))).collect()
}

/// A tilted square, one set of coordinates a mirror image of the other, its colours and their alpha different
/// at all corners.
fn square(smooth: bool) -> Mesh {
    let tilt = |x: f32, y: f32| Vec3::new(x, y, 0.3 * x - 0.2 * y);
    let normal = Vec3::new(-0.3, 0.2, 1.0).normalize();
    Mesh {
        normals: if smooth { vec![normal; 4] } else { Vec::new() },
        uvs: [
            vec![Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO],
            vec![Vec2::ONE, Vec2::Y, Vec2::new(0.2, 0.1), Vec2::X],
        ],
        colours: vec![
            Vec4::new(1.0, 0.5, 0.2, 1.0),
            Vec4::new(0.3, 1.0, 0.6, 0.7),
            Vec4::new(0.9, 0.1, 1.0, 0.2),
            Vec4::ONE,
        ],
        ..quad([tilt(-1.0, -1.0), tilt(1.0, -1.0), tilt(1.0, 1.0), tilt(-1.0, 1.0)])
    }
}

fn scene(mesh: Mesh, slot: TextureSlot, alpha: AlphaMode) -> Scene {
    let texture = |seed: u32| {
        let wrap = [Wrap::Mirror, Wrap::Repeat];
        std::sync::Arc::new(Texture::new(4, 3, texels(seed), Encoding::Linear, wrap))
    };
    let material = Material {
        base_colour_texture: Some(TextureSlot { texture: TextureId(1), ..slot }),
        normal_texture: Some((slot, 1.3)),
        alpha,
        ..Material::default()
    };
    Scene {
        meshes: vec![mesh].into(),
        materials: vec![material],
        textures: vec![texture(1), texture(2)],
        ..Scene::default()
    }
}

/// Of a normal map, with its green turned over: what the bitangent upside down would show.
fn upside_down(mut scene: Scene) -> Scene {
    let turned = texels(1).into_iter().map(|[r, g, b, a]| [r, 255 - g, b, a]).collect();
    let wrap = scene.textures[0].wrap();
    scene.textures[0] = Texture::new(4, 3, turned, Encoding::Linear, wrap).into();
    scene
}

#[test]
fn materials_are_rasterised_as_they_are_traced_on_both_sides() {
    let gpu = Gpu::new().expect("an adapter");
    let attributes = [Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
    let turned = Affine2::from_scale_angle_translation(Vec2::new(1.5, 0.7), 2.1, Vec2::new(0.3, 0.1));
    let mirrored = Affine2::from_scale_angle_translation(Vec2::new(-1.0, 1.0), 0.4, Vec2::X);
    let (opaque, mask) = (AlphaMode::Opaque, AlphaMode::Mask(0.3));
    for (transform, uv_set, alpha, smooth) in [
        (Affine2::IDENTITY, 0, opaque, true),
        (Affine2::IDENTITY, 1, opaque, false),
        (turned, 0, mask, false),
        (turned, 1, AlphaMode::Blend, true),
        (mirrored, 0, AlphaMode::Blend, false),
        (mirrored, 1, mask, true),
    ] {
        let slot = TextureSlot { texture: TextureId(0), uv_set, transform };
        let scene = scene(square(smooth), slot, alpha);
        for eye in [Vec3::new(0.3, 0.4, 2.0), Vec3::new(-0.2, 0.3, -2.0)] {
            let what = format!("{transform:?}, set {uv_set}, {alpha:?}, smooth {smooth}, from {eye}");
            let camera = Camera::look_at(eye, Vec3::ZERO);
            let traced = |scene: Scene| {
                let traced = TracedScene::new(scene).expect("a square");
                gbuffer::render(&traced, &camera, HEIGHT, WIDTH, &attributes)
            };
            let found = rasterised(&gpu, &scene, &camera);
            let expected = traced(scene.clone());
            for attribute in attributes {
                let outside = share_outside(&found, &expected, attribute, 0.02);
                assert!(outside < 0.01, "{what}: {outside} of {}", attribute.name());
            }
            let wrong = share_outside(&found, &traced(upside_down(scene.clone())), Attribute::Normal, 0.02);
            let valid = expected.select(&[Attribute::Valid]).expect("rendered");
            let seen = valid.data().iter().sum::<f32>() / valid.pixels() as f32;
            assert!(wrong > 0.5 * seen, "{what}: {wrong} with green upside down");
            assert!((0.1..0.9).contains(&seen), "{what}: {seen} are seen");
        }
    }
}

#[test]
fn single_texels_are_rasterised_as_they_are_traced() {
    let gpu = Gpu::new().expect("an adapter");
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    let linear = scene(square(true), slot, AlphaMode::Opaque);
    let mut nearest = linear.clone();
    for texture in &mut nearest.textures {
        *texture = Texture::clone(texture).with_filter(Filter::Nearest).into();
    }
    let camera = Camera::look_at(Vec3::new(0.3, 0.4, 2.0), Vec3::ZERO);
    let found = rasterised(&gpu, &nearest, &camera);
    let share = |scene: Scene, attribute| {
        let traced = TracedScene::new(scene).expect("a square");
        let expected =
            gbuffer::render(&traced, &camera, HEIGHT, WIDTH, &[Attribute::Normal, Attribute::Diffuse]);
        share_outside(&found, &expected, attribute, 0.02)
    };
    for attribute in [Attribute::Normal, Attribute::Diffuse] {
        // Where texels meet, the last digit of a coordinate decides.
        let [same, blended] = [&nearest, &linear].map(|scene| share(scene.clone(), attribute));
        assert!(same < 0.02 && blended > 0.1, "{}: {same}, {blended} if bilinear", attribute.name());
    }
}
