//! A hall like a church's nave, closed all around but for tall windows with bars in one wall.

use deepshade_render::scene::{Material, Mesh, Scene};
use glam::Vec3;

/// Length along x, height, and depth along z, metres; the windows are in the wall at z = 0.
const SIZE: Vec3 = Vec3::new(24.0, 9.0, 12.0);
/// Thickness of the walls, metres.
const WALL: f32 = 0.4;
/// How many windows there are, how far from each other, and half of how wide each is, metres.
const WINDOWS: (usize, f32, f32) = (6, 4.0, 1.0);
/// Bottom and top of the windows, metres.
const OPENING: [f32; 2] = [1.5, 7.5];
/// Panes beside and above each other in a window, and half the thickness of the bars between them, metres.
const PANES: (usize, usize, f32) = (3, 8, 0.03);

/// The hall, without lights.
pub fn hall() -> Scene {
    let mut meshes = shell();
    let (windows, apart, half) = WINDOWS;
    for window in 0..windows {
        let middle = (window as f32 + 0.5) * apart;
        // The wall up to the next window.
        meshes.push(in_wall([middle + half, middle + apart - half], OPENING));
        meshes.extend(bars([middle - half, middle + half]));
        for z in [0.3, 0.7] {
            let foot = Vec3::new(middle + 0.5 * apart, 0.0, z * SIZE.z);
            meshes.push(block(foot - Vec3::new(0.4, 0.0, 0.4), foot + Vec3::new(0.4, SIZE.y, 0.4)));
        }
    }
    Scene { meshes: meshes.into(), materials: vec![Material::default()], ..Scene::default() }
}

/// Floor, ceiling and walls, that of the windows only below, above and before the first.
fn shell() -> Vec<Mesh> {
    let out = Vec3::splat(WALL);
    let outside = |axis: usize, low: bool| {
        let (mut min, mut max) = (-out, SIZE + out);
        if low {
            max[axis] = 0.0
        } else {
            min[axis] = SIZE[axis]
        }
        block(min, max)
    };
    let (_, apart, half) = WINDOWS;
    vec![
        outside(0, true),
        outside(0, false),
        outside(1, true),
        outside(1, false),
        outside(2, false),
        in_wall([0.0, SIZE.x], [0.0, OPENING[0]]),
        in_wall([0.0, SIZE.x], [OPENING[1], SIZE.y]),
        in_wall([0.0, 0.5 * apart - half], OPENING),
    ]
}

/// The bars of a window.
fn bars(x: [f32; 2]) -> Vec<Mesh> {
    let (beside, above, half) = PANES;
    let at = |[low, high]: [f32; 2], i: usize, count: usize| low + (high - low) * i as f32 / count as f32;
    let around = |middle: f32| [middle - half, middle + half];
    let upright = (1..beside).map(|i| in_wall(around(at(x, i, beside)), OPENING));
    let across = (1..above).map(|i| in_wall(x, around(at(OPENING, i, above))));
    upright.chain(across).collect()
}

/// A part of the wall of the windows.
fn in_wall(x: [f32; 2], y: [f32; 2]) -> Mesh {
    block(Vec3::new(x[0], y[0], -WALL), Vec3::new(x[1], y[1], 0.0))
}

/// A box.
fn block(min: Vec3, max: Vec3) -> Mesh {
    let corner = |i: usize| {
        let on = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
        Vec3::new(on(0), on(1), on(2))
    };
    let sides: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::bvh::TracedScene;

    #[test]
    fn light_comes_in_through_windows_and_nowhere_else() {
        let scene = TracedScene::new(hall()).expect("triangles");
        let middle = 0.5 * SIZE;
        let is_open = |target: Vec3| {
            !scene.blocked(
                Vec3::new(target.x, target.y, 2.0),
                target - Vec3::new(target.x, target.y, 2.0),
                1.0,
            )
        };
        // Through a pane, against a bar, against the wall between windows, and against every other wall.
        assert!(is_open(Vec3::new(2.0, 1.8, -5.0)));
        assert!(!is_open(Vec3::new(2.333, 1.8, -5.0)) && !is_open(Vec3::new(4.0, 4.0, -5.0)));
        for way in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z] {
            assert!(scene.blocked(middle, way * 50.0, 1.0), "{way}");
        }
    }
}
