//! Wavefront OBJ and MTL.

use crate::build::{png, write};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::texture::Wrap;
use deepshade_render::scene::{AlphaMode, Scene, SceneError, TextureSlot};
use glam::{Vec2, Vec3, Vec4};
use std::path::Path;

mod missing;
mod names;

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
    assert!((texel - Vec4::new(1.0, 0.0, 0.0, 0.2)).length() < 1e-6, "{texel}");
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
fn what_is_damaged_is_refused_by_name() {
    let face = |more: &str| format!("{more}{SQUARE}f 1 2 3\n");
    let cases: [(&str, String, &str, &str); 7] = [
        (
            "a damaged texture",
            face("mtllib b.mtl\n"),
            "newmtl m\nmap_Kd b.mtl\n",
            "b.mtl: is no PNG, JPEG, BMP, TGA or KTX2",
        ),
        ("a face out of range", format!("{SQUARE}f 1 2 9\n"), "", "line 7"),
        ("a face of nothing", format!("{SQUARE}f 1 2 x\n"), "", "line 7"),
        (
            "a vertex that is no number",
            format!("{SQUARE}o flag\nv 0 nan 0\nf 1 2 5\n"),
            "",
            "mesh `flag`: vertex 2",
        ),
        ("a vertex with two numbers", "v 0 0\n".to_owned(), "", "line 1: `v 0 0` is no position"),
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

/// A library of a red paint, and what makes a square of it below a library's name.
const RED: &[u8] = b"newmtl red\nKd 0.8 0.1 0.1\n";
const FACE: &str = "f 1/1/1 2/1/1 3/1/1 4/1/1\n";

/// The colour of the first face, of a scene with two triangles, and what was said.
fn colour(obj: &str, library: &[u8]) -> (Vec3, Vec<String>) {
    let dot = png(1, 1, &[[255, 255, 255]]);
    let files: [(&str, &[u8]); 4] =
        [("a.obj", obj.as_bytes()), ("b.mtl", library), ("none.mtl", b"# empty\n"), ("t.png", &dot)];
    let scene = load(&files).expect(obj);
    assert_eq!(scene.triangle_count(), 2, "{obj}");
    (scene.material(scene.meshes[0].material).base_colour.truncate(), scene.warnings)
}

#[test]
fn valid_lines_that_others_stumble_over_are_read() {
    let red = Vec3::new(0.8, 0.1, 0.1);
    let use_red = format!("{SQUARE}usemtl red\n{FACE}");
    let objects = [
        format!("\u{feff}mtllib b.mtl\n{use_red}"),
        format!("mtllib none.mtl b.mtl\n{use_red}"),
        format!("{use_red}mtllib b.mtl\n"),
        format!("mtllib\tb.mtl\n{SQUARE}usemtl\tred\n{FACE}"),
        format!("mtllib b.mtl # colours\n{SQUARE}usemtl red # paint\nf 1/1/1 2/1/1 3/1/1 4/1/1 # front\n"),
        format!("mtllib b.mtl\n{SQUARE}usemtl red\nf 1/1/1 2/1/1 \\\n 3/1/1 4/1/1\n"),
        format!("mtllib b.mtl\r\n{}", use_red.replace('\n', "\r\n")),
        format!("mtllib b.mtl\n{SQUARE}usemtl red\nvt 1\n{FACE}"),
        format!("mtllib b.mtl\n\u{feff}{SQUARE}\u{feff}usemtl red\nf 1/1/1 2/1/1 3/1/1 4/1/1#front\n"),
    ];
    for obj in objects {
        assert_eq!(colour(&obj, RED), (red, Vec::new()), "{obj:?}");
    }
    let with_mark = [b"\xef\xbb\xbf", RED].concat();
    assert_eq!(colour(&format!("mtllib b.mtl\n{use_red}"), &with_mark).0, red);
}

#[test]
fn odd_lines_of_a_material_lose_nothing_else() {
    let use_red = format!("mtllib b.mtl\n{SQUARE}usemtl red\n{FACE}");
    let silent = ["Ke 0", "norm -bm 0.5 t.png", "map_Kd -s 2 2 1 -o 0.5 0 0 t.png", "map_Kd -clamp on t.png"];
    let said = [
        "Ka",
        "map_d",
        "d -halo 0",
        "Pr very",
        "Pm inf",
        "d inf",
        "Ks 1 1",
        "Ke spectral a.rfl",
        "Kx 1",
        "bump t.png",
        "map_Ks t.png",
        "map_Kd -cc on t.png",
        "map_Kd gone.png",
        "Pr 3",
        "Ke -1 0 0",
        "Tf 0 1 1",
    ];
    let of = |line: &&str| colour(&use_red, format!("newmtl red\nKd 0.8 0.1 0.1\n{line}\n").as_bytes());
    for line in &silent {
        assert_eq!(of(line), (Vec3::new(0.8, 0.1, 0.1), Vec::new()), "{line}");
    }
    for line in &said[1..] {
        let (colour, warnings) = of(line);
        assert_eq!(colour, Vec3::new(0.8, 0.1, 0.1), "{line}");
        assert!(warnings.len() == 1 && warnings[0].contains("b.mtl: line 3: "), "{line}: {warnings:?}");
    }
    assert_eq!(of(&said[0]).1, Vec::<String>::new(), "nothing is read of an ambient colour");
}

#[test]
fn materials_that_no_library_has_are_named() {
    let (white, warnings) = colour(&format!("mtllib b.mtl\n{SQUARE}usemtl blue\n{FACE}"), RED);
    assert_eq!(white, Vec3::ONE);
    assert!(
        warnings.len() == 1 && warnings[0].contains("line 8: no library has the material `blue`"),
        "{warnings:?}"
    );
}

#[test]
fn options_of_maps_place_them() {
    let library = b"newmtl m\nmap_Kd -s 2 4 -o 0.25 0.5 -clamp on t.png\nnorm -bm 0.5 t.png\n";
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}");
    let scene = load(&[("a.obj", text.as_bytes()), ("b.mtl", library), ("t.png", &png(1, 1, &[[9, 9, 9]]))]);
    let scene = scene.expect("options");
    let material = &scene.materials[0];
    let slot = material.base_colour_texture.expect("a texture");
    // Upwards 0.2 becomes 4 * 0.2 + 0.5.
    let placed = slot.transform.transform_point2(Vec2::new(0.3, 0.8));
    assert!((placed - Vec2::new(0.85, 1.0 - 1.3)).length() < 1e-6, "{placed}");
    assert_eq!(scene.textures[slot.texture.0 as usize].wrap(), [Wrap::Clamp; 2]);
    assert_eq!(material.normal_texture.expect("normals").1, 0.5);
}

#[test]
fn maps_are_of_four_formats() {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}");
    let pixel = image::RgbImage::from_pixel(3, 2, image::Rgb([255, 0, 0]));
    for (name, format) in [
        ("t.png", image::ImageFormat::Png),
        ("t.jpg", image::ImageFormat::Jpeg),
        ("t.bmp", image::ImageFormat::Bmp),
        ("t.tga", image::ImageFormat::Tga),
    ] {
        let mut bytes = std::io::Cursor::new(Vec::new());
        pixel.write_to(&mut bytes, format).expect("encoded");
        let library = format!("newmtl m\nmap_Kd {name}\n");
        let files =
            [("a.obj", text.as_bytes()), ("b.mtl", library.as_bytes()), (name, bytes.get_ref().as_slice())];
        let scene = load(&files).expect(name);
        let texel = scene.textures[0].sample(Vec2::splat(0.5)).truncate();
        assert!((texel - Vec3::X).length() < 0.02, "{name}: {texel}");
    }
}

#[test]
fn colours_of_vertices_are_srgb_and_stay_with_their_objects() {
    let coloured = "o a\nv 0 0 0 1 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 1 0 0\nf 1 2 3\n";
    let scene = load(&[("a.obj", format!("{coloured}o b\nv 2 0 0\nv 3 0 0\nv 3 1 0\nf 4 5 6\n").as_bytes())]);
    let scene = scene.expect("a file");
    let colours = &scene.meshes[0].colours;
    assert!((colours[1] - Vec4::new(0.2140, 0.2140, 0.2140, 1.0)).length() < 1e-3, "{colours:?}");
    assert_eq!(colours[0], Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert!(scene.meshes[1].colours.is_empty());
    let of_255 = "v 0 0 0 255 0 0\nv 1 0 0 51 51 51\nv 1 1 0 0 0 255\nf 1 2 3\n";
    let scene = load(&[("a.obj", of_255.as_bytes())]).expect("a file");
    assert!((scene.meshes[0].colours[1] - Vec4::new(0.0331, 0.0331, 0.0331, 1.0)).length() < 1e-3);
    assert!(
        scene.warnings.len() == 1 && scene.warnings[0].contains("a.obj: line 1: "),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn lines_have_no_surface_and_notches_stay_empty() {
    let corners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv 0 -0.5 0\nv -1 1 0\n";
    let what = load(&[("a.obj", format!("{corners}l 1 2 3 4 5\n").as_bytes())]).and_then(TracedScene::new);
    assert!(what.expect_err("no triangle").to_string().contains("no triangle"));
    let notched = load(&[("a.obj", format!("{corners}f 1 2 3 4 5\n").as_bytes())]).expect("a polygon");
    let scene = TracedScene::new(notched).expect("triangles");
    let meets = |x: f32, y: f32| scene.hit(Vec3::new(x, y, 1.0), Vec3::NEG_Z, f32::INFINITY).is_some();
    assert!(!meets(0.0, 0.0) && meets(0.0, -0.75) && meets(0.8, 0.5) && meets(-0.8, 0.5));
}
