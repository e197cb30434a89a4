//! Wavefront OBJ and MTL.

use crate::build::{png, write};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AlphaMode, Scene, SceneError, TextureSlot};
use glam::{Vec2, Vec3};
use std::path::Path;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvn 0 0 2\n";

/// Writes files into a new folder and loads the one called `a.obj`.
fn load(files: &[(&str, &[u8])]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        write(folder.path(), name, bytes);
    }
    Scene::load(&folder.path().join("a.obj"), 0.0)
}

#[test]
fn polygons_negative_indices_and_both_coordinates_of_v() {
    let text =
        format!("{SQUARE}o square\nf -4/1/1 -3/1/1 -2/1/1 -1/1/1\nv 0.5 2 0\no roof\nf 1 2 3 5 4\nl 1 2\n");
    let scene = load(&[("a.obj", text.as_bytes())]).expect("polygons");
    assert_eq!(scene.meshes.len(), 2);
    let (square, roof) = (&scene.meshes[0], &scene.meshes[1]);
    assert_eq!((square.name.as_str(), square.triangles.len()), ("square", 2));
    assert_eq!((roof.name.as_str(), roof.triangles.len()), ("roof", 3));
    assert_eq!(square.uvs[0], [Vec2::new(0.0, 0.75); 4], "v points down");
    assert_eq!(square.normals, [Vec3::Z; 4]);
    assert!(roof.normals.is_empty() && roof.uvs[0].is_empty());
    assert_eq!(scene.material(square.material).name, "none");
}

#[test]
fn materials_are_converted() {
    let library = "newmtl lamp\nKd 0.5 0.25 1\nKe 3 2 1\nKs 0.1 0.1 0.1\nNs 30\n\
        newmtl glass\nd 0.5\nnewmtl veil\nTr 0.25\nnewmtl leaf\nmap_Kd colour.png\nmap_d holes.png\n";
    let text = format!(
        "mtllib b.mtl\n{SQUARE}usemtl lamp\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl veil\nf 1 2 3\nusemtl leaf\nf 1/1 2/1 3/1\n"
    );
    let colour = png(1, 1, &[[255, 0, 0]]);
    let holes = png(1, 1, &[[51, 51, 51]]);
    let scene = load(&[
        ("a.obj", text.as_bytes()),
        ("b.mtl", library.as_bytes()),
        ("colour.png", &colour),
        ("holes.png", &holes),
    ])
    .expect("materials");
    let [lamp, glass, veil, leaf] = scene.materials.first_chunk().expect("four materials");
    assert_eq!(lamp.base_colour.to_array(), [0.5, 0.25, 1.0, 1.0]);
    assert_eq!(lamp.emission, Vec3::new(3.0, 2.0, 1.0));
    assert!((lamp.roughness - 0.5).abs() < 1e-6);
    assert_eq!((glass.alpha, glass.base_colour.w), (AlphaMode::Blend, 0.5));
    assert_eq!((veil.alpha, veil.base_colour.w), (AlphaMode::Blend, 0.75));
    assert_eq!(leaf.alpha, AlphaMode::Mask(0.5));
    let slot = leaf.base_colour_texture.expect("a texture");
    let texel = scene.textures[slot.texture.0 as usize].sample(Vec2::splat(0.5));
    assert!((texel - glam::Vec4::new(1.0, 0.0, 0.0, 0.2)).length() < 1e-6, "{texel}");
}

#[test]
fn physically_based_materials_are_read() {
    let library = "newmtl car\nPr 0.25\nPm 0.75\nKs 1 1 1\nNs 900\nmap_Ke glow.png\nnorm flat.png\n\
        newmtl sign\nKe 2 0 0\nmap_Ke glow.png\nmap_Kd flat.png\n";
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl car\nf 1/1 2/1 3/1\nusemtl sign\nf 1/1 2/1 3/1\n");
    let glow = png(1, 1, &[[255, 0, 255]]);
    let flat = png(1, 1, &[[188, 188, 255]]);
    let scene = load(&[
        ("a.obj", text.as_bytes()),
        ("b.mtl", library.as_bytes()),
        ("glow.png", &glow),
        ("flat.png", &flat),
    ])
    .expect("materials");
    let [car, sign] = scene.materials.first_chunk().expect("two materials");
    assert_eq!((car.roughness, car.metallic), (0.25, 0.75));
    assert_eq!((car.emission, sign.emission), (Vec3::ONE, Vec3::new(2.0, 0.0, 0.0)));
    assert_eq!(car.emission_texture, sign.emission_texture);
    let texel = |slot: Option<TextureSlot>| {
        let slot = slot.expect("a texture");
        scene.textures[slot.texture.0 as usize].sample(Vec2::splat(0.5)).truncate()
    };
    assert_eq!(texel(car.emission_texture), Vec3::new(1.0, 0.0, 1.0));
    assert!((texel(car.normal_texture.map(|(slot, _)| slot)).x - 188.0 / 255.0).abs() < 1e-6, "linear");
    assert!((texel(sign.base_colour_texture).x - 0.5029).abs() < 1e-3, "sRGB");
    assert_eq!(scene.textures.len(), 3);
}

#[test]
fn emission_below_zero_is_refused_by_name() {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl hole\nf 1 2 3\n");
    let scene = load(&[("a.obj", text.as_bytes()), ("b.mtl", b"newmtl hole\nKe -1 0 0\n")]).expect("a file");
    let what = TracedScene::new(scene).expect_err("dark light").to_string();
    assert!(what.starts_with("a: material `hole` emits [-1, 0, 0]"), "{what}");
}

#[test]
fn what_is_missing_or_damaged_is_named() {
    let face = |more: &str| format!("{more}{SQUARE}f 1 2 3\n");
    let cases: [(&str, String, &str, &str); 17] = [
        ("a library elsewhere", face("mtllib ../b.mtl\n"), "", "`../b.mtl` leads out of the folder"),
        (
            "a texture elsewhere",
            face("mtllib b.mtl\n"),
            "newmtl m\nmap_Kd /etc/hostname\n",
            "`/etc/hostname` leads out of the folder",
        ),
        ("a missing library", face("mtllib gone.mtl\n"), "", "gone.mtl"),
        ("a missing texture", face("mtllib b.mtl\n"), "newmtl m\nmap_Kd gone.png\n", "gone.png"),
        (
            "a damaged texture",
            face("mtllib b.mtl\n"),
            "newmtl m\nmap_Kd b.mtl\n",
            "b.mtl: is neither a PNG nor a JPEG",
        ),
        ("a texture option", face("mtllib b.mtl\n"), "newmtl m\nmap_Kd -s 2 2 2 a.png\n", "material `m`"),
        ("a missing emission map", face("mtllib b.mtl\n"), "newmtl m\nmap_Ke gone.png\n", "gone.png"),
        (
            "a roughness in words",
            face("mtllib b.mtl\n"),
            "newmtl m\nPr very\n",
            "material `m` has the Pr `very`",
        ),
        ("an infinite metal", face("mtllib b.mtl\n"), "newmtl m\nPm inf\n", "material `m` holds a value"),
        ("a short colour", face("mtllib b.mtl\n"), "newmtl m\nKd 1 1\n", "b.mtl: line 2"),
        ("an infinite alpha", face("mtllib b.mtl\n"), "newmtl m\nd inf\n", "material `m`"),
        ("a face out of range", format!("{SQUARE}f 1 2 9\n"), "", "line 7"),
        ("a face of nothing", format!("{SQUARE}f 1 2 x\n"), "", "line 7"),
        (
            "a vertex that is no number",
            format!("{SQUARE}o flag\nv 0 nan 0\nf 1 2 5\n"),
            "",
            "mesh `flag`: vertex 2",
        ),
        ("a vertex with two numbers", "v 0 0\n".to_owned(), "", "position"),
        ("no face", SQUARE.to_owned(), "", "no triangle"),
        ("only flat triangles", format!("{SQUARE}f 1 1 2\n"), "", "no triangle"),
    ];
    for (case, text, library, expected) in cases {
        let error =
            load(&[("a.obj", text.as_bytes()), ("b.mtl", library.as_bytes())]).expect_err(case).to_string();
        assert!(error.contains(expected), "{case}: {error}");
    }
    let missing = Scene::load(Path::new("no such folder/a.obj"), 0.0).expect_err("no file").to_string();
    assert!(missing.contains("no such folder/a.obj"), "{missing}");
}
