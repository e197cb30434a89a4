//! Materials, textures, vertex colours, lights and cameras.

use crate::build::{base64, load, png, triangle};
use deepshade_render::bvh::TracedScene;
use deepshade_render::path::lights::Arrival;
use deepshade_render::scene::{AlphaMode, Light, Scene, SceneError, TextureId};
use glam::{Vec2, Vec3, Vec4};

/// A triangle with one material, with further JSON beside it.
fn material(json: &str, rest: &str) -> Scene {
    let text = triangle().gltf(&format!(
        r#""nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{{json}}}]{rest}"#
    ));
    load(&text, 0.0).expect("a material")
}

#[test]
fn factors_and_modes_are_read() {
    let scene = material(
        r#""name":"glow","alphaMode":"MASK","alphaCutoff":0.25,"emissiveFactor":[1,0.5,0],
        "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}},
        "pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,"roughnessFactor":0.75}"#,
        r#","extensionsRequired":["KHR_materials_emissive_strength"]"#,
    );
    let material = &scene.materials[0];
    assert_eq!(material.name, "glow");
    assert_eq!(material.base_colour, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!((material.metallic, material.roughness), (0.5, 0.75));
    assert_eq!(material.emission, Vec3::new(8.0, 4.0, 0.0));
    assert_eq!(material.alpha, AlphaMode::Mask(0.25));
    assert_eq!(self::material(r#""alphaMode":"BLEND""#, "").materials[0].alpha, AlphaMode::Blend);
    let plain = &self::material("", "").materials[0];
    assert_eq!((plain.alpha, plain.metallic, plain.roughness), (AlphaMode::Opaque, 1.0, 1.0));
}

#[test]
fn textures_are_read_as_what_they_hold_and_each_way_once() {
    let image = base64(&png(2, 1, &[[188, 188, 188], [0, 0, 0]]));
    let scene = material(
        r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}},
        "emissiveTexture":{"index":1},"emissiveFactor":[1,1,1],
        "normalTexture":{"index":0,"scale":0.5,"texCoord":1,
            "extensions":{"KHR_texture_transform":{"offset":[0.5,0],"texCoord":0}}}"#,
        &format!(
            r#","textures":[{{"source":0}},{{"source":0}},{{"source":0,"sampler":0}}],
            "samplers":[{{"wrapS":33071,"wrapT":33648}}],
            "images":[{{"uri":"data:image/png;base64,{image}"}}]"#
        ),
    );
    let material = &scene.materials[0];
    assert_eq!(scene.textures.len(), 2, "one as sRGB, one as linear");
    assert_eq!(
        material.base_colour_texture.map(|slot| slot.texture),
        material.emission_texture.map(|slot| slot.texture)
    );
    let value = |slot: deepshade_render::scene::TextureSlot| {
        scene.textures[slot.texture.0 as usize]
            .sample(slot.transform.transform_point2(Vec2::new(0.25, 0.5)))
            .x
    };
    assert!((value(material.base_colour_texture.expect("a slot")) - 0.5029).abs() < 1e-3);
    assert!((value(material.metallic_roughness_texture.expect("a slot")) - 188.0 / 255.0).abs() < 1e-6);
    let (slot, scale) = material.normal_texture.expect("a slot");
    assert_eq!((slot.uv_set, scale), (0, 0.5));
    assert_eq!(value(slot), 0.0, "moved on to the black texel");
}

#[test]
fn samplers_wrap_each_axis_in_its_way() {
    let image = base64(&png(2, 2, &[[255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]]));
    let scene = material(
        r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#,
        &format!(
            r#","textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33648}}],
            "images":[{{"uri":"data:image/png;base64,{image}"}}]"#
        ),
    );
    let texel = |u, v| scene.textures[0].sample(Vec2::new(u, v)).truncate();
    assert_eq!(texel(1.25, 0.25), Vec3::Y, "u stays at the right edge");
    assert_eq!(texel(0.25, 1.25), Vec3::Z, "v is mirrored below the lower edge");
}

#[test]
fn a_primitive_without_material_has_the_default_one() {
    let text = triangle().gltf(
        r#""nodes":[{"mesh":0}],"materials":[{"name":"other"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    let scene = load(&text, 0.0).expect("a triangle");
    assert_eq!(scene.material(scene.meshes[0].material).name, "none");
}

#[test]
fn vertex_colours_have_alpha_one_unless_they_say() {
    let mut builder = triangle();
    let three =
        builder.accessor("VEC3", 5121, 3, &[255, 0, 51, 255, 0, 51, 255, 0, 51], r#","normalized":true"#);
    let four = builder.floats("VEC4", &[0.1, 0.2, 0.3, 0.4].repeat(3));
    for (accessor, expected) in
        [(three, Vec4::new(1.0, 0.0, 0.2, 1.0)), (four, Vec4::new(0.1, 0.2, 0.3, 0.4))]
    {
        let text = builder.gltf(&format!(
            r#""nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":{accessor}}}}}]}}]"#
        ));
        assert_eq!(load(&text, 0.0).expect("colours").meshes[0].colours, [expected; 3]);
    }
}

#[test]
fn lights_shine_down_their_nodes_minus_z() {
    let text = triangle().gltf(
        r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[
            {"type":"point","color":[1,0.5,0],"intensity":10},
            {"type":"directional","intensity":3},
            {"type":"spot","range":7.5,"spot":{"innerConeAngle":0.5,"outerConeAngle":1.0}}]}},
        "nodes":[{"mesh":0},
            {"translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},
            {"rotation":[-0.70710678,0,0,0.70710678],"scale":[5,5,5],"extensions":{"KHR_lights_punctual":{"light":1}}},
            {"translation":[4,5,6],"extensions":{"KHR_lights_punctual":{"light":2}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    let lights = load(&text, 0.0).expect("lights").lights;
    let [point, sun, spot] = *lights.first_chunk().expect("three lights");
    let expected = Light::Point {
        position: Vec3::new(1.0, 2.0, 3.0),
        intensity: Vec3::new(10.0, 5.0, 0.0),
        range: f32::INFINITY,
    };
    assert_eq!(point, expected);
    let is_down = |direction: Vec3| (direction - Vec3::NEG_Y).length() < 1e-6;
    let three = Vec3::splat(3.0);
    assert!(
        matches!(sun, Light::Directional { direction, irradiance, pattern: None } if is_down(direction) && irradiance == three),
        "{sun:?}"
    );
    let expected = Light::Spot {
        position: Vec3::new(4.0, 5.0, 6.0),
        direction: Vec3::NEG_Z,
        intensity: Vec3::ONE,
        range: 7.5,
        cos_inner: 0.5f32.cos(),
        cos_outer: 1f32.cos(),
        slide: None,
    };
    assert_eq!(spot, expected);
}

/// A triangle with two textures of one colour each, red and green, under a spot and a sun that have extras.
fn projecting(spot: &str, sun: &str) -> Result<Scene, SceneError> {
    let image = |colour: [u8; 3]| base64(&png(1, 1, &[colour]));
    let (red, green) = (image([255, 0, 0]), image([0, 255, 0]));
    load(
        &triangle().gltf(&format!(
            r#""extensionsUsed":["KHR_lights_punctual"],
            "extensions":{{"KHR_lights_punctual":{{"lights":[
                {{"type":"spot","spot":{{"outerConeAngle":1.0}},"extras":{spot}}},
                {{"type":"directional","extras":{sun}}}]}}}},
            "nodes":[{{"mesh":0}},
                {{"name":"lantern","extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},
                {{"name":"sun","extensions":{{"KHR_lights_punctual":{{"light":1}}}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "textures":[{{"source":0}},{{"source":1}}],
            "images":[{{"uri":"data:image/png;base64,{red}"}},{{"uri":"data:image/png;base64,{green}"}}]"#
        )),
        0.0,
    )
}

#[test]
fn lights_project_the_textures_that_their_extras_name() {
    let scene =
        projecting(r#"{"slide":1,"note":"x"}"#, r#"{"pattern":0,"patternWidth":4.5}"#).expect("lights");
    let slide = |light: &Light| if let Light::Spot { slide, .. } = light { *slide } else { None };
    let pattern =
        |light: &Light| if let Light::Directional { pattern, .. } = light { *pattern } else { None };
    let slide = slide(&scene.lights[0]).expect("a slide");
    let (pattern, width) = pattern(&scene.lights[1]).expect("a pattern");
    let colour = |texture: TextureId| scene.textures[texture.0 as usize].sample(Vec2::splat(0.5)).truncate();
    let is = |colour: Vec3, expected: Vec3| (colour - expected).length() < 1e-5;
    assert!(is(colour(slide), Vec3::Y) && is(colour(pattern), Vec3::X) && width == 4.5);
    let traced = TracedScene::new(scene).expect("a scene");
    let arrives = |light: &Light| Arrival::new(traced.scene(), light, Vec3::NEG_Z).irradiance;
    assert!(
        is(arrives(&traced.scene().lights[0]), Vec3::Y) && is(arrives(&traced.scene().lights[1]), Vec3::X)
    );

    let plain = projecting(r#""words""#, r#"{"other":[1]}"#).expect("extras of others");
    assert!(matches!(
        plain.lights[..],
        [Light::Spot { slide: None, .. }, Light::Directional { pattern: None, .. }]
    ));
}

#[test]
fn textures_that_lights_cannot_project_are_named() {
    let error = |spot: &str, sun: &str| projecting(spot, sun).expect_err("a bad picture").to_string();
    for slide in ["2", "-1", "0.5", "\"red\"", "null"] {
        let what = error(&format!(r#"{{"slide":{slide}}}"#), "{}");
        assert!(what.contains("`lantern`: its slide is") && what.contains("2 textures"), "{what}");
    }
    for width in ["0", "-1", "1e99", "\"4\"", "null"] {
        let what = error("{}", &format!(r#"{{"pattern":0,"patternWidth":{width}}}"#));
        assert!(what.contains("`sun`: its patternWidth is"), "{what}");
    }
    let what = error("{}", r#"{"pattern":0}"#);
    assert!(what.contains("`sun`: its patternWidth is null"), "{what}");
}

#[test]
fn light_below_zero_is_refused_by_name() {
    let text = triangle().gltf(
        r#""extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":-3}]}},
        "nodes":[{"mesh":0},{"extensions":{"KHR_lights_punctual":{"light":0}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    let error = |scene: Scene| TracedScene::new(scene).expect_err("dark light").to_string();
    let what = error(load(&text, 0.0).expect("a file"));
    assert_eq!(what, "test: light 0: its power is negative or not finite");
    let what = error(material(r#""name":"hole","emissiveFactor":[-1,0,0]"#, ""));
    assert!(what.starts_with("test: material `hole` emits [-1, 0, 0]"), "{what}");
}

#[test]
fn cones_that_are_nearly_alike_are_spots_too() {
    for angles in [r#""innerConeAngle":0.1,"outerConeAngle":0.10000001"#, r#""outerConeAngle":0.0001"#] {
        let text = triangle().gltf(&format!(
            r#""extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","spot":{{{angles}}}}}]}}}},
            "nodes":[{{"mesh":0}},{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#
        ));
        let traced = TracedScene::new(load(&text, 0.0).expect("a file")).expect("a spot");
        let light = &traced.scene().lights[0];
        assert_eq!(Arrival::new(traced.scene(), light, Vec3::NEG_Z).irradiance, Vec3::ONE);
    }
}

#[test]
fn cameras_look_where_their_nodes_do() {
    let text = triangle().gltf(
        r#""nodes":[{"mesh":0},
            {"name":"door","camera":0,"translation":[0,1,0],"rotation":[0,0.70710678,0,0.70710678],"scale":[3,3,3]},
            {"camera":1}],
        "cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1,"aspectRatio":2}},
            {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":1}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    let cameras = load(&text, 0.0).expect("cameras").cameras;
    assert_eq!(cameras.len(), 1, "orthographic cameras are left out");
    let (name, camera) = &cameras[0];
    assert_eq!((name.as_str(), camera.vertical_fov), ("door", 0.8));
    assert_eq!(camera.position, Vec3::Y);
    let middle = camera.direction(Vec2::new(8.0, 4.0), 8, 16);
    assert!((middle - Vec3::NEG_X).length() < 1e-6, "{middle}");
    assert!((camera.rotation.y_axis - Vec3::Y).length() < 1e-6);
}
