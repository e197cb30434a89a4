//! What places have of a paint: a board whose texture has two texels against two boards with paints of their
//! own, in truth and in the passes.

use super::*;
use crate::path::phosphor::Afterglow;
use crate::path::{self, Sampling, Shot};
use crate::scene::glow::PaintTextures;
use crate::scene::{Encoding, Filter, Texture, Wrap};
use deepshade_glow::paint::PaintFactors;
use deepshade_shaders::Effect;

/// Half a board, from `left` to the middle or from there on, with texture coordinates across the whole.
fn half(is_right: bool, material: u32) -> Mesh {
    let left = if is_right { 0.0 } else { -1.0 };
    let corners = [(left, 1.0), (left + 1.0, 1.0), (left + 1.0, -1.0), (left, -1.0)];
    let uv = |(x, z): (f32, f32)| Vec2::new(0.5 + 0.5 * x, 0.5 + 0.5 * z);
    Mesh {
        uvs: [corners.map(uv).to_vec(), vec![]],
        ..quad(corners.map(|(x, z)| Vec3::new(x, 0.0, z)), material)
    }
}

/// Bytes of the left and the right texel, and what they mean.
fn two([left, right]: [[u8; 3]; 2]) -> Option<Arc<Texture>> {
    let texels = [left, right].map(|[r, g, b]| [r, g, b, 255]).to_vec();
    let texture = Texture::new(2, 1, texels, Encoding::Linear, [Wrap::Clamp; 2]);
    Some(Arc::new(texture.with_filter(Filter::Nearest)))
}

const EXCITATION: [[u8; 3]; 2] = [[255, 51, 0], [102, 255, 204]];
const DECAY: [[u8; 3]; 2] = [[51, 0, 0], [255, 9, 9]];
const EMISSION: [[u8; 3]; 2] = [[255, 204, 0], [51, 102, 255]];

/// Of the left or the right texel.
fn factors(side: usize) -> PaintFactors {
    let colour = |texels: [[u8; 3]; 2]| Vec3::from(texels[side].map(|byte| f32::from(byte) / 255.0));
    PaintFactors { excitation: colour(EXCITATION), decay: colour(DECAY).x, emission: colour(EMISSION) }
}

fn board(materials: [u32; 2], glow: Glow) -> (TracedScene, View, GBuffer) {
    let meshes = vec![half(false, materials[0]), half(true, materials[1])];
    let above = Camera::look_at(Vec3::new(0.1, 2.4, 0.7), Vec3::ZERO);
    seen(scene(meshes, vec![lamp(Vec3::new(0.4, 1.5, 0.3), 3.0)], glow), above, [24, 32])
}

/// One paint whose textures have two texels.
fn textured() -> (TracedScene, View, GBuffer) {
    let mut glow = glow(&[0.7, 0.2], &[[0.0, 2.0]], 3.0);
    glow.surfaces[0].textures =
        PaintTextures { excitation: two(EXCITATION), decay: two(DECAY), emission: two(EMISSION) };
    board([0, 0], glow)
}

/// Two paints.
fn painted() -> (TracedScene, View, GBuffer) {
    let mut glow = glow(&[0.7, 0.2], &[[0.0, 2.0]], 3.0);
    let whole = glow.surfaces.remove(0);
    for (side, name) in ["floor", "wall"].into_iter().enumerate() {
        let mut own = whole.clone();
        (own.material, own.paint) = (Some(name.to_owned()), whole.paint.scaled(&factors(side)));
        glow.surfaces.push(own);
    }
    board([0, 1], glow)
}

#[test]
fn truth_of_two_texels_is_that_of_two_paints() {
    let truth = |(scene, view, _): &(TracedScene, View, GBuffer)| {
        let shot = Shot::new(scene, &view.camera, [view.height, view.width], 1.0);
        path::render(Effect::Phosphor, &shot, Sampling { samples: 1, scramblings: 1, seed: 5 }).mean
    };
    let [one, two] = [textured(), painted()].map(|frame| truth(&frame));
    assert!(one.data().iter().any(|value| *value > 0.02));
    assert!(near(one.data(), two.data(), 1e-5));
    let [left, right] = [8, 24].map(|x| Vec3::from([0, 1, 2].map(|channel| one.at(channel, 12, x))));
    assert!(left.z == 0.0 && right.z > 0.0 && left.x > right.x, "{left} {right}");
}

#[test]
fn passes_of_two_texels_are_those_of_two_paints_and_of_the_plain_version() {
    let method = ScreenMethod::new(&gpu(), RateEquationParameters::exact(80));
    let [one, two] = [textured(), painted()].map(|frame| shaded(&method, &frame));
    assert!(one.data().iter().any(|value| *value > 0.02));
    // Factors are halves.
    assert!(near(one.data(), two.data(), 2e-3));
    let whole = board([0, 0], glow(&[0.7, 0.2], &[[0.0, 2.0]], 3.0));
    assert!(!near(one.data(), shaded(&method, &whole).data(), 0.02), "textures count");
    prove_twin(&method, &textured(), Tolerance { usual: 5e-4, worst: 0.06 });
}

#[test]
fn a_place_has_the_factors_of_its_texel() {
    let (scene, ..) = textured();
    let afterglow = Afterglow::new(&scene);
    for (mesh, side) in [(0, 0), (1, 1)] {
        let paint = afterglow.paint_at(mesh, 0, [1.0 / 3.0; 3]).expect("a paint");
        let expected = Glow::of(scene.scene()).surfaces[0].paint.scaled(&factors(side));
        for (found, wanted) in paint.states.iter().zip(&expected.states) {
            assert!((found.decay - wanted.decay).abs() < 1e-6);
            assert!((found.emission - wanted.emission).abs().max_element() < 1e-6);
        }
    }
}
