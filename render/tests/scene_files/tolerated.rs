//! glTF files that leave something out or ask for what is not supported: the rest of them loads, and what was
//! passed over is said.

use crate::build::{Builder, ONE_MESH, base64, load, png, triangle};
use deepshade_render::bvh::TracedScene;
use deepshade_render::path::lights::Arrival;
use deepshade_render::scene::{Filter, Scene, Texture};
use glam::{Vec2, Vec3};

/// Images of two texels, white and black, with textures and samplers around.
fn textured(textures: &str, rest: &str) -> Scene {
    let image = base64(&png(2, 1, &[[255, 255, 255], [0, 0, 0]]));
    let text = triangle().gltf(&format!(
        r#""nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"baseColorTexture":{{"index":0}}}},
            "normalTexture":{{"index":1}},"emissiveTexture":{{"index":0}}}}],
        "textures":[{textures},{{"source":0}}],
        "images":[{{"uri":"data:image/png;base64,{image}"}},{{"uri":"bark.DDS"}},
            {{"uri":"leaf","mimeType":"image/webp"}}]{rest}"#
    ));
    load(&text, 0.0).expect("the triangle")
}

fn warnings(rest: &str) -> Vec<String> {
    load(&triangle().gltf(rest), 0.0).expect("a file").warnings
}

#[test]
fn samplers_that_ask_for_the_nearest_texel_get_it() {
    let filtered = |sampler: &str| {
        let samplers = format!(r#","samplers":[{{{sampler}}}]"#);
        let scene = textured(r#"{"source":0,"sampler":0}"#, &samplers);
        let slot = scene.materials[0].base_colour_texture.expect("a texture");
        Texture::clone(&scene.textures[slot.texture.0 as usize])
    };
    let at = |texture: &Texture, u: f32| texture.sample(Vec2::new(u, 0.5)).x;
    for sampler in [r#""magFilter":9728"#, r#""magFilter":9728,"minFilter":9987"#] {
        let nearest = filtered(sampler);
        assert_eq!(nearest.filter(), Filter::Nearest);
        assert_eq!([0.26, 0.49, 0.51, 0.74].map(|u| at(&nearest, u)), [1.0, 1.0, 0.0, 0.0]);
    }
    for sampler in ["", r#""magFilter":9729"#, r#""magFilter":9729,"minFilter":9728"#] {
        let linear = filtered(sampler);
        assert_eq!(linear.filter(), Filter::Linear);
        assert!((at(&linear, 0.5) - 0.5).abs() < 1e-6, "half way between the texels");
    }
}

#[test]
fn one_image_is_read_in_two_ways_by_two_samplers() {
    let image = base64(&png(2, 1, &[[255, 255, 255], [0, 0, 0]]));
    let text = triangle().gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}},"emissiveTexture":{{"index":1}}}}],
        "samplers":[{{"magFilter":9728}},{{"magFilter":9729}}],
        "textures":[{{"source":0,"sampler":0}},{{"source":0,"sampler":1}}],
        "images":[{{"uri":"data:image/png;base64,{image}"}}]"#
    ));
    let filters: Vec<_> =
        load(&text, 0.0).expect("a file").textures.iter().map(|texture| texture.filter()).collect();
    assert_eq!(filters, [Filter::Nearest, Filter::Linear]);
}

#[test]
fn textures_without_an_image_are_as_if_they_were_not_there() {
    let webp = r#"{"extensions":{"EXT_texture_webp":{"source":2}}}"#;
    let none = "texture 0 has no PNG, JPEG or KTX2 image and is left out";
    for (texture, said) in [
        ("{}", none),
        (webp, "texture 0 has its image by EXT_texture_webp, which is not supported, and is left out"),
        (r#"{"source":1}"#, none),
        (r#"{"source":2}"#, none),
        (r#"{"extensions":{"KHR_texture_basisu":{"source":1}}}"#, none),
        (r#"{"extensions":{"KHR_texture_basisu":{"source":9}}}"#, none),
        (r#"{"extensions":{"KHR_texture_basisu":7}}"#, none),
    ] {
        let scene = textured(texture, "");
        let material = &scene.materials[0];
        assert!(material.base_colour_texture.is_none() && material.emission_texture.is_none());
        assert!(material.normal_texture.is_some(), "that of the other texture stays");
        assert_eq!(scene.warnings.len(), 1, "once, though two slots have it: {:?}", scene.warnings);
        assert!(scene.warnings[0].ends_with(&format!("test.gltf: {said}")), "{:?}", scene.warnings);
    }
    let fallback = r#"{"source":0,"extensions":{"EXT_texture_webp":{"source":2}}}"#;
    let scene = textured(fallback, "");
    assert!(scene.materials[0].base_colour_texture.is_some());
    assert_eq!(scene.warnings, [""; 0]);
}

#[test]
fn textures_by_other_coordinates_than_sets_0_and_1_are_left_out() {
    let text = triangle().gltf(
        r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
        "materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0,"texCoord":3}}}],
        "textures":[{"source":0}],"images":[{"uri":"gone.png"}]"#,
    );
    let scene = load(&text, 0.0).expect("the triangle");
    assert!(scene.materials[0].base_colour_texture.is_none());
    let said = "texture 0 is placed by texture coordinates 3 and left out: sets 0 and 1 are read";
    assert!(scene.warnings.len() == 1 && scene.warnings[0].ends_with(said), "{:?}", scene.warnings);
}

/// Two primitives, of which the first has no positions.
fn half_placed(indices: &str) -> String {
    let mut builder = triangle();
    builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0}}}}],
        "meshes":[{{"name":"pair","primitives":[
            {{"attributes":{{"NORMAL":2}}{indices}}},
            {{"attributes":{{"POSITION":0,"NORMAL":2}},"indices":1,"material":0}}]}}]"#
    ))
}

#[test]
fn primitives_without_positions_are_left_out() {
    for indices in ["", r#","indices":1"#, r#","mode":5"#] {
        let scene = load(&half_placed(indices), 0.0).expect("the other");
        assert_eq!((scene.meshes.len(), scene.triangle_count()), (1, 1));
        assert_eq!(scene.meshes[0].name, "pair/1");
        let said = "test.gltf: primitive 0 of mesh `pair` has no POSITION and is left out";
        assert!(scene.warnings.len() == 1 && scene.warnings[0].ends_with(said), "{:?}", scene.warnings);
    }
    let nothing =
        Builder::default().gltf(r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{}}]}]"#);
    let error = load(&nothing, 0.0).and_then(TracedScene::new).expect_err("nothing to show").to_string();
    assert!(error.contains("has no triangle with an area"), "{error}");
}

/// A spot along -z with cone angles as a file's decimals say them.
fn spot(inner: &str, outer: &str) -> Result<TracedScene, String> {
    let text = triangle().gltf(&format!(
        r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{{"KHR_lights_punctual":{{"lights":[
            {{"type":"spot","spot":{{"innerConeAngle":{inner},"outerConeAngle":{outer}}}}}]}}}},
        "nodes":[{{"mesh":0}},{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#
    ));
    load(&text, 0.0).and_then(TracedScene::new).map_err(|error| error.to_string())
}

#[test]
fn spots_whose_cones_are_the_same_have_a_hard_edge() {
    for (inner, outer) in [
        ("0.08968102931976317", "0.08968102931976318"),
        ("0.3", "0.30000001"),
        ("0.3", "0.3"),
        ("1.5707963267948965", "1.5707963267948966"),
    ] {
        let scene = spot(inner, outer).expect("a spot");
        let angle: f32 = outer.parse().expect("a number");
        let at = |angle: f32| {
            let point = Vec3::new(angle.sin(), 0.0, -angle.cos());
            Arrival::new(scene.scene(), &scene.scene().lights[0], point).irradiance.x
        };
        let [inside, outside] = [0.99, 1.01].map(|part| at(part * angle));
        assert!((inside - 1.0).abs() < 1e-5 && outside == 0.0, "{inner}: {inside}, {outside}");
    }
    for (inner, outer) in [("0.31", "0.3"), ("0", "0"), ("-0.1", "0.3"), ("0.3", "1.6")] {
        let error = spot(inner, outer).expect_err("no cones");
        assert!(error.contains("are not 0 <= inner < outer <= pi/2"), "{error}");
    }
}

#[test]
fn what_has_no_material_is_no_metal_and_scenes_of_metals_are_told_of() {
    let scene = load(&triangle().gltf(ONE_MESH), 0.0).expect("a triangle");
    let material = scene.material(scene.meshes[0].material);
    assert_eq!((material.metallic, material.roughness, material.base_colour), (0.0, 1.0, glam::Vec4::ONE));
    assert_eq!(scene.warnings, [""; 0]);
    let of_material = |material: &str| {
        warnings(&format!(
            r#""nodes":[{{"mesh":0}}],"materials":[{material}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}]"#
        ))
    };
    for metal in ["{}", r#"{"pbrMetallicRoughness":{"metallicFactor":1}}"#] {
        let said = of_material(metal);
        assert!(said.len() == 1 && said[0].contains("test.gltf: all surfaces are metals"), "{said:?}");
    }
    assert_eq!(of_material(r#"{"pbrMetallicRoughness":{"metallicFactor":0.5}}"#), [""; 0]);
}

#[test]
fn extensions_that_are_not_supported_are_named() {
    let with = |extensions: &str| warnings(&format!(r#"{ONE_MESH},"extensionsUsed":[{extensions}]"#));
    assert_eq!(with(r#""KHR_materials_unlit","KHR_texture_transform""#), [""; 0]);
    let said = with(r#""KHR_materials_iridescence""#);
    let one = "test.gltf: uses KHR_materials_iridescence, which is not supported: what it adds is not shown";
    assert!(said.len() == 1 && said[0].ends_with(one), "{said:?}");
    let said = with(r#""KHR_materials_unlit","A","KHR_materials_sheen","B""#);
    let three = "uses A, KHR_materials_sheen and B, which are not supported: what they add is not shown";
    assert!(said.len() == 1 && said[0].ends_with(three), "{said:?}");
}
