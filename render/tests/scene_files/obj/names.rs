//! Names of materials and of files: with a number sign, with spaces, with options around them, without any.

use super::{FACE, RED, SQUARE, colour, load};
use crate::build::png;
use deepshade_render::scene::AlphaMode;
use glam::{Vec2, Vec3};

const RED_COLOUR: Vec3 = Vec3::new(0.8, 0.1, 0.1);

#[test]
fn a_number_sign_in_a_name_is_no_comment() {
    let library = b"newmtl Material #1\nKd 0.8 0.1 0.1\nnewmtl Material #2\nKd 0 0 1\n\
        newmtl red # paint\nKd 0.8 0.1 0.1\n";
    let of = |name: &str| colour(&format!("mtllib b.mtl\n{SQUARE}usemtl {name}\n{FACE}"), library);
    assert_eq!(of("Material #1"), (RED_COLOUR, Vec::new()));
    assert_eq!(of("Material #2"), (Vec3::Z, Vec::new()));
    assert_eq!(of("red"), (RED_COLOUR, Vec::new()));
    assert_eq!(of("Material #1 # first"), (RED_COLOUR, Vec::new()));
    let (white, said) = of("Material #3");
    assert!(white == Vec3::ONE && said.len() == 1 && said[0].contains("`Material #3`"), "{said:?}");
}

/// The texel that a `map_Kd` of a red image among others reads, its transform's scale, and what was said.
fn map(rest: &str, name: &str) -> (Vec3, Vec2, Vec<String>) {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}");
    let library = format!("newmtl m\nmap_Kd {rest}\n");
    let (red, other) = (png(1, 1, &[[255, 0, 0]]), png(1, 1, &[[0, 0, 255]]));
    let files: [(&str, &[u8]); 4] =
        [("a.obj", text.as_bytes()), ("b.mtl", library.as_bytes()), ("other.png", &other), (name, &red)];
    let scene = load(&files).expect(rest);
    let slot = scene.materials[0].base_colour_texture.expect(rest);
    let texel = scene.textures[slot.texture.0 as usize].sample(Vec2::splat(0.5)).truncate();
    (texel, slot.transform.matrix2.mul_vec2(Vec2::ONE), scene.warnings)
}

#[test]
fn names_of_images_are_found_among_options_and_comments() {
    for (rest, name) in [
        ("a b #1.png", "a b #1.png"),
        ("a b #1.png # other.png", "a b #1.png"),
        ("t.png # was other.png", "t.png"),
        ("-wood.png", "-wood.png"),
    ] {
        assert_eq!(map(rest, name), (Vec3::X, Vec2::ONE, Vec::new()), "{rest}");
    }
    for rest in ["-s 2 3 1 t.png", "t.png -s 2 3 1", "-o 0 0 0 t.png -s 2 3", "t.png -s 2 3 1 # twice"] {
        assert_eq!(map(rest, "t.png"), (Vec3::X, Vec2::new(2.0, 3.0), Vec::new()), "{rest}");
    }
    let (texel, scale, said) = map("-new 3 -s 2 2 1 t.png", "t.png");
    assert_eq!((texel, scale, said.len()), (Vec3::X, Vec2::splat(2.0), 1), "{said:?}");
    assert!(said[0].contains("b.mtl: line 2: ") && said[0].contains("`-new`"), "{said:?}");
}

#[test]
fn libraries_with_spaces_stand_beside_others() {
    let text = format!("mtllib my lib.mtl b.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n");
    let blue: &[u8] = b"newmtl blue\nKd 0 0 1\n";
    let scene = load(&[("a.obj", text.as_bytes()), ("b.mtl", RED), ("my lib.mtl", blue)]).expect("libraries");
    let colours =
        [0, 1].map(|mesh: usize| scene.material(scene.meshes[mesh].material).base_colour.truncate());
    assert_eq!((colours, scene.warnings), ([RED_COLOUR, Vec3::Z], Vec::new()));
}

#[test]
fn usemtl_without_a_name_is_the_only_material() {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl \n{FACE}");
    assert_eq!(colour(&text, RED).0, RED_COLOUR);
    let (white, said) = colour(&text, b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
    assert!(white == Vec3::ONE && said.len() == 1, "{said:?}");
    assert!(
        said[0].ends_with("a.obj: line 8: `usemtl` without a name; the faces behind it are white"),
        "{said:?}"
    );
}

#[test]
fn opacity_may_be_stated_as_transparency_and_lies_as_the_colour_does() {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}");
    let grey = png(1, 1, &[[51, 51, 51]]);
    let alpha = |lines: &str| {
        let library = format!("newmtl m\n{lines}\n");
        let files: [(&str, &[u8]); 3] =
            [("a.obj", text.as_bytes()), ("b.mtl", library.as_bytes()), ("t.png", &grey)];
        let scene = load(&files).expect(lines);
        assert_eq!(scene.materials[0].alpha, AlphaMode::Mask(0.5), "{lines}");
        let slot = scene.materials[0].base_colour_texture.expect(lines);
        (scene.textures[slot.texture.0 as usize].sample(Vec2::splat(0.5)).w, scene.warnings)
    };
    for (lines, expected) in [
        ("map_d t.png", 0.2),
        ("map_opacity t.png", 0.2),
        ("map_Tr t.png", 0.8),
        ("map_Tr t.png\nmap_d t.png", 0.2),
        ("map_Kd -s 2 2 1 t.png\nmap_d -s 2 2 1 t.png", 0.2),
    ] {
        let (alpha, said) = alpha(lines);
        assert!((alpha - expected).abs() < 1e-6 && said.is_empty(), "{lines}: {alpha}, {said:?}");
    }
    let (_, said) = alpha("map_Kd t.png\nmap_d -s 2 2 1 t.png");
    assert!(
        said.len() == 1 && said[0].contains("b.mtl: line 3: `map_d` is placed as `map_Kd` is"),
        "{said:?}"
    );
}
