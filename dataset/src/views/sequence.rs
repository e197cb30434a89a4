//! Views that follow each other: the camera goes on from a sampled one and turns, always as fast, in
//! directions of the sequence's own.

use super::{LIMITS, refusal};
use crate::random::uniform;
use crate::recipe::Sequence;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use glam::{Mat3, Vec3};
use std::f32::consts::TAU;

/// The camera of a frame of the sequence that begins with `first`; the same for the same `stream`. `None` if
/// one of the sequence's frames is not fit for an image of this size.
pub fn followed(
    scene: &TracedScene,
    first: &Camera,
    [height, width]: [usize; 2],
    stream: u64,
    sequence: Sequence,
    frame: usize,
) -> Option<Camera> {
    let diagonal = scene.diagonal();
    let camera = |frame: usize| moved(first, stream, sequence, diagonal, frame);
    let is_fit =
        |frame| refusal(scene, &camera(frame), width as f32 / height as f32, diagonal, LIMITS).is_none();
    (1..sequence.frames).all(is_fit).then(|| camera(frame))
}

/// The camera after so many frames.
fn moved(first: &Camera, stream: u64, sequence: Sequence, diagonal: f32, frame: usize) -> Camera {
    let angle = |number: u64| TAU * uniform(&[stream, u64::from(u32::MAX), number]);
    let across = |angle: f32| first.rotation * Vec3::new(angle.cos(), angle.sin(), 0.0);
    let frames = frame as f32;
    let turned = Mat3::from_axis_angle(across(angle(1)), frames * sequence.turn.to_radians());
    Camera {
        position: first.position + frames * sequence.step * diagonal * across(angle(0)),
        rotation: turned * first.rotation,
        ..*first
    }
}

#[cfg(test)]
mod tests {
    use crate::Recipe;
    use crate::recipe::Sequence;
    use crate::views::recipe_view;

    /// A recipe for testing, with sequences, and its first scene's cameras.
    fn cameras(sequence: Sequence) -> (f32, Vec<deepshade_render::scene::Camera>) {
        let mut recipe: Recipe = crate::shipped::shrunk("ao-test.toml");
        (recipe.sequence, recipe.views_per_scene) = (Some(sequence), 2 * sequence.frames);
        let planned = &recipe.plan().expect("scenes")[0];
        let scene = planned.scene.load(&recipe.folder).expect("a scene");
        let view = |index| recipe_view(&recipe, &scene, planned.key, index).expect("a view");
        (scene.diagonal(), (0..recipe.views_per_scene).map(view).collect())
    }

    #[test]
    fn a_camera_goes_on_as_fast_as_it_is_told_and_each_sequence_begins_anew() {
        let (diagonal, cameras) = cameras(Sequence { frames: 3, turn: 2.0, step: 0.01 });
        for sequence in cameras.chunks(3) {
            for (frame, camera) in sequence.iter().enumerate() {
                let gone = camera.position.distance(sequence[0].position) / diagonal;
                assert!((gone - 0.01 * frame as f32).abs() < 1e-4, "{gone}");
                let turned =
                    (sequence[0].rotation.transpose() * camera.rotation).z_axis.z.acos().to_degrees();
                assert!((turned - 2.0 * frame as f32).abs() < 0.05, "{turned}");
            }
        }
        assert!(cameras[3].position.distance(cameras[0].position) > 0.03 * diagonal);
    }
}
