//! Pictures that lights project, gathered by the light pass against the lights themselves.

use super::*;
use crate::path::proving;
use crate::scene::{Encoding, Filter, Texture, TextureId, Wrap};

fn picture(seed: u32, encoding: Encoding) -> std::sync::Arc<Texture> {
    let byte = |i: u32, c: u32| (deepshade_shaders::random::random(i, c, seed, 0) * 255.0) as u8;
    let texels = (0..35).map(|i| std::array::from_fn(|c| byte(i, c as u32))).collect();
    Texture::new(7, 5, texels, encoding, [Wrap::Mirror; 2]).into()
}

fn floor_under(light: Light) -> Scene {
    let nearest = |seed, encoding| (*picture(seed, encoding)).clone().with_filter(Filter::Nearest).into();
    Scene {
        meshes: vec![proving::floor()].into(),
        materials: vec![Material { gloss: Gloss::None, ..Material::matte("", Vec3::splat(0.5)) }],
        textures: vec![
            picture(1, Encoding::Srgb),
            picture(2, Encoding::Linear),
            nearest(1, Encoding::Srgb),
            nearest(2, Encoding::Linear),
        ],
        lights: vec![light],
        ..Scene::default()
    }
}

#[test]
fn slides_and_patterns_fall_where_the_lights_throw_them() {
    let gpu = Gpu::new().expect("an adapter");
    let axis = Vec3::new(0.3, -1.0, 0.2).normalize();
    let spot = |slide: Option<TextureId>, cos_outer: f32| Light::Spot {
        position: Vec3::new(-0.5, 4.0, 0.3),
        direction: axis,
        intensity: Vec3::new(30.0, 20.0, 40.0),
        range: 30.0,
        cos_inner: 0.95,
        cos_outer,
        slide,
    };
    let sun = |pattern: Option<TextureId>| Light::Directional {
        direction: axis,
        irradiance: Vec3::new(3.0, 2.0, 4.0),
        pattern: pattern.map(|texture| (texture, 1.7)),
    };
    let camera = Camera::look_at(Vec3::new(1.0, 6.0, 5.0), Vec3::ZERO);
    for (texture, other) in [(0, 1), (1, 0), (2, 0), (3, 1)].map(|(a, b)| (TextureId(a), TextureId(b))) {
        for [light, wrong, plain] in [
            [spot(Some(texture), 0.7), spot(Some(other), 0.7), spot(None, 0.7)],
            [spot(Some(texture), 0.3), spot(Some(other), 0.3), spot(None, 0.3)],
            [sun(Some(texture)), sun(Some(other)), sun(None)],
        ] {
            let found = rasterised(&gpu, &floor_under(light), &camera);
            let expected = |light: Light| {
                let scene = TracedScene::new(floor_under(light)).expect("a floor");
                gbuffer::render(&scene, &camera, HEIGHT, WIDTH, &[Attribute::Light, Attribute::DiffuseLight])
            };
            let off = |light: Light| share_outside(&found, &expected(light), Attribute::Light, 2e-3);
            // Edges of texels: 0.0027 on an H100, and where the nearest one is read their borders.
            assert!(
                off(light) < if texture.0 < 2 { 4e-3 } else { 2e-2 },
                "{} of the pixels differ: {light:?}",
                off(light)
            );
            assert!(off(wrong) > 0.2 && off(plain) > 0.2, "another picture is noticed: {light:?}");
        }
    }
}
