//! Files that are not there, or not where a file of another computer says.

use super::{FACE, RED, SQUARE, colour, load};
use crate::build::png;
use deepshade_render::scene::Scene;
use glam::{Vec2, Vec3};

#[test]
fn a_missing_library_is_none_and_said() {
    for name in ["gone.mtl", "../gone.mtl", "/etc/gone.mtl", "gone away.mtl"] {
        let (white, said) = colour(&format!("mtllib {name}\n{SQUARE}usemtl red\n{FACE}"), RED);
        assert_eq!((white, said.len()), (Vec3::ONE, 2), "{name}: {said:?}");
        assert!(said[0].contains(&format!("a.obj: line 1: there is no library `{name}`")), "{said:?}");
    }
    let (red, said) = colour(&format!("mtllib C:\\Users\\x\\b.mtl\n{SQUARE}usemtl red\n{FACE}"), RED);
    assert_eq!((red, said.len()), (Vec3::new(0.8, 0.1, 0.1), 1), "{said:?}");
}

/// A scene with a `map_Kd`, and an image beside its library or in a folder there.
fn with_map(file: &str, image: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("textures")).expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect(name);
    write("a.obj", format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}").as_bytes());
    write("b.mtl", format!("newmtl m\nKd 1 1 1\nmap_Kd {file}\nPm 0.5\n").as_bytes());
    write(image, &png(1, 1, &[[255, 0, 0]]));
    Scene::load(&folder.path().join("a.obj"), 0.0).expect(file)
}

#[test]
fn images_are_looked_for_by_the_last_part_of_their_path() {
    let paths =
        ["C:\\Users\\x\\t.png", "C:/Users/x/t.png", "/home/x/t.png", "../t.png", "-s 2 2 1 D:\\y z\\t.png"];
    for path in paths {
        for image in ["t.png", "textures/t.png"] {
            let scene = with_map(path, image);
            let slot = scene.materials[0].base_colour_texture.expect(path);
            let texel = scene.textures[slot.texture.0 as usize].sample(Vec2::splat(0.5)).truncate();
            assert_eq!((texel, scene.warnings.len()), (Vec3::X, 1), "{path}: {:?}", scene.warnings);
            assert!(scene.warnings[0].contains("b.mtl: line 3: `map_Kd`: there is no image `"), "{path}");
            let is_scaled = slot.transform.matrix2.x_axis.x == 2.0;
            assert_eq!(is_scaled, path.starts_with("-s"), "{path}");
        }
    }
}

#[test]
fn a_missing_image_is_left_out_and_said() {
    for path in ["gone.png", "/etc/hostname", "../../t.png.gone", "textures", "-new 3 gone.png"] {
        let scene = with_map(path, "t.png");
        let material = &scene.materials[0];
        assert!(material.base_colour_texture.is_none() && scene.textures.is_empty(), "{path}");
        assert_eq!(material.metallic, 0.5, "{path}: what follows is read");
        let said = &scene.warnings;
        assert!(
            said.len() == 1 && said[0].contains("b.mtl: line 3: `map_Kd`: there is no image `"),
            "{said:?}"
        );
    }
}

#[test]
fn an_image_of_another_kind_is_left_out_and_said() {
    for name in ["t.tif", "t.DDS", "-s 2 2 1 t.webp"] {
        let image = name.rsplit(' ').next().expect("a name");
        let scene = with_map(name, image);
        assert!(scene.materials[0].base_colour_texture.is_none(), "{name}");
        let said = &scene.warnings;
        assert!(
            said.len() == 1 && said[0].contains("b.mtl: line 3: `map_Kd`: `") && said[0].contains(image),
            "{said:?}"
        );
    }
}

#[test]
fn a_damaged_image_is_refused() {
    let text = format!("mtllib b.mtl\n{SQUARE}usemtl m\n{FACE}");
    let library = b"newmtl m\nmap_Kd t.png\n";
    let files: [(&str, &[u8]); 3] = [("a.obj", text.as_bytes()), ("b.mtl", library), ("t.png", b"no image")];
    let error = load(&files).expect_err("a damaged image").to_string();
    assert!(error.contains("t.png: is no PNG, JPEG, BMP, TGA or KTX2"), "{error}");
}
