//! The passes against their plain version, and how many froxels there are. Closed forms and where geometry
//! degenerates are in `shafts/tests`.

use super::*;
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{foggy, prove_twin};
use crate::screen::{ScreenMethod, View};
use deepshade_shaders::gpu::Gpu;

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, FroxelParameters { tile: 3, slices: 20, samples: 2 });
    for frame in foggy() {
        // Shadow maps end within a texel of where shadows do.
        prove_twin(&method, &frame, Tolerance { usual: 4e-4, worst: 0.01 });
    }
}

#[test]
fn there_are_no_more_froxels_than_a_binding_holds() {
    let (_, view, _) = foggy().remove(0);
    for quality in Quality::ALL {
        let parameters = FroxelParameters::of(quality);
        for [height, width] in [[1, 1], [720, 1280], [2160, 3840], [8192, 8192]] {
            let settings = parameters.settings(&View { height, width, ..view });
            let count = settings.columns as usize * settings.rows as usize * settings.slices as usize;
            assert!(count <= MOST_FROXELS && count > 0, "{settings:?}");
            assert!(settings.columns * settings.tile >= width as u32, "{settings:?}");
        }
        let settings = parameters.settings(&View { height: 720, width: 1280, ..view });
        assert_eq!((settings.tile as usize, settings.slices), (parameters.tile, parameters.slices));
    }
    for [height, width] in [[1080, 1920], [2160, 3840]] {
        let of = |quality| FroxelParameters::of(quality).settings(&View { height, width, ..view });
        let finer = Quality::ALL.map(of).is_sorted_by(|less, more| less.tile >= more.tile);
        assert!(finer, "{height}");
    }
}
