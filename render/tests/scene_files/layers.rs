//! Light that passes surfaces, indices of refraction and clear coats, as glTF's extensions say them.

use crate::build::{base64, load, png, triangle};
use crate::real_data::data;
use deepshade_render::scene::transmission::{Transmission, Walls};
use deepshade_render::scene::{Material, Scene};
use glam::Vec3;

/// A triangle of a material with some extensions, in a file with two textures.
fn with(extensions: &str) -> Result<Scene, String> {
    let image = base64(&png(1, 1, &[[128, 255, 0]]));
    let text = triangle().gltf(&format!(
        r#""nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"name":"glass","pbrMetallicRoughness":{{"metallicFactor":0}},
            "extensions":{{{extensions}}}}}],
        "textures":[{{"source":0}},{{"source":0}}],"images":[{{"uri":"data:image/png;base64,{image}"}}]"#
    ));
    load(&text, 0.0).map_err(|error| error.to_string())
}

fn material(extensions: &str) -> Material {
    with(extensions).expect(extensions).materials.remove(0)
}

#[test]
fn extensions_say_how_light_passes() {
    let plain = material("");
    assert_eq!((plain.ior, plain.transmission, plain.coat), (1.5, None, None));
    let pane = material(r#""KHR_materials_transmission":{"transmissionFactor":0.5}"#);
    assert_eq!(pane.transmission, Some(Transmission { share: 0.5, texture: None, walls: Walls::Thin }));
    assert_eq!(material(r#""KHR_materials_transmission":{}"#).transmission, None, "its default is 0");
    let body = material(
        r#""KHR_materials_transmission":{"transmissionFactor":1,
            "transmissionTexture":{"index":1,"texCoord":1}},
        "KHR_materials_volume":{"thicknessFactor":0.1,"attenuationDistance":2,
            "attenuationColor":[1,0.5,0.25]},
        "KHR_materials_ior":{"ior":1.33}"#,
    );
    assert_eq!(body.ior, 1.33);
    let transmission = body.transmission.expect("glass");
    assert_eq!(transmission.texture.expect("a texture").uv_set, 1);
    let Walls::Solid { absorption } = transmission.walls else { unreachable!("{transmission:?}") };
    assert!((absorption - Vec3::new(0.0, 0.5, 1.0) * 2f32.ln()).length() < 1e-6, "{absorption}");
}

#[test]
fn extensions_say_coats() {
    let coat = material(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":0.8,"clearcoatTexture":{"index":0},
        "clearcoatRoughnessFactor":0.3,"clearcoatRoughnessTexture":{"index":1},
        "clearcoatNormalTexture":{"index":1,"scale":0.5}}"#,
    );
    let coat = coat.coat.expect("a coat");
    assert_eq!((coat.share, coat.roughness), (0.8, 0.3));
    assert!(coat.texture.is_some() && coat.roughness_texture.is_some());
    assert_eq!(coat.normal_texture.expect("normals").1, 0.5);
    assert_eq!(material(r#""KHR_materials_clearcoat":{"clearcoatRoughnessFactor":1}"#).coat, None);
}

#[test]
fn what_cannot_be_is_named() {
    for (extensions, said) in [
        (r#""KHR_materials_ior":{"ior":0.5}"#, "its ior 0.5 is neither 0 nor 1 or more"),
        (
            r#""KHR_materials_transmission":{"transmissionFactor":2}"#,
            "its transmissionFactor 2 is not 0 to 1",
        ),
        (
            r#""KHR_materials_transmission":{"transmissionFactor":"much"}"#,
            "KHR_materials_transmission: invalid",
        ),
        (
            r#""KHR_materials_transmission":{"transmissionFactor":1,"transmissionTexture":{"index":7}}"#,
            "reads texture 7 of 2",
        ),
        (
            r#""KHR_materials_transmission":{"transmissionFactor":1},
            "KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":-1}"#,
            "KHR_materials_volume: a thickness of 1 m, an attenuation in -1 m",
        ),
        (r#""KHR_materials_clearcoat":{"clearcoatFactor":-1}"#, "its clearcoatFactor -1 is not 0 to 1"),
    ] {
        let error = with(extensions).expect_err(said);
        assert!(error.contains("test.gltf: material `glass`: ") && error.contains(said), "{error}");
    }
}

#[test]
fn real_files_have_glass_and_coats() {
    let Some(folder) = data() else { return };
    let load = |name: &str| Scene::load(&folder.join(name), 0.0).expect(name);
    let vase = load("gltf/GlassVaseFlowers.glb");
    let solid = |material: &Material| {
        material.transmission.as_ref().is_some_and(|of| matches!(of.walls, Walls::Solid { .. }))
    };
    assert_eq!(vase.materials.iter().filter(|material| solid(material)).count(), 1);
    assert_eq!(vase.warnings, [""; 0]);
    let car = load("gltf/ToyCar.glb");
    assert_eq!(car.materials.iter().filter(|material| material.coat.is_some()).count(), 1);
    assert_eq!(car.materials.iter().filter(|material| material.may_pass_light_straight()).count(), 1);
    assert!(car.warnings.len() == 1 && car.warnings[0].contains("KHR_materials_sheen"), "{:?}", car.warnings);
}
