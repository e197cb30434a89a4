//! The passes against their plain version, and how many light rays there are. Closed forms and where geometry
//! degenerates are in `shafts/tests`.

use super::*;
use crate::method::{Frame, Method, Repeats};
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{foggy, prove_twin};
use crate::screen::{ScreenMethod, View};
use deepshade_shaders::gpu::Gpu;

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let parameters = GpuEpipolarParameters { light_rays: 256, ..GpuEpipolarParameters::of(Quality::Low) };
    let method = ScreenMethod::new(&gpu, parameters);
    prove_twin(&method, &foggy().remove(0), Tolerance { usual: 4e-4, worst: 0.02 });
}

#[test]
fn grids_are_refused_by_name() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, GpuEpipolarParameters::of(Quality::Low));
    let (scene, view, gbuffer) = &foggy()[1];
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: 1.0, seed: 1 };
    let refused = Method::shade(&method, &frame, Repeats::ONCE).expect_err("a grid").to_string();
    assert!(refused.contains("grid") && refused.contains("gpu-epipolar"), "{refused}");
}

#[test]
fn there_are_no_more_light_rays_than_a_binding_holds() {
    let (_, view, _) = foggy().remove(0);
    for quality in Quality::ALL {
        for [height, width] in [[1, 1], [720, 1280], [1080, 1920], [2160, 3840], [8192, 8192]] {
            let settings = GpuEpipolarParameters::of(quality).settings(&View { height, width, ..view });
            let (rays, lines) = (settings.light_rays as usize, settings.lines as usize);
            assert!(rays.is_multiple_of(LEAVES) && rays > 0, "{settings:?}");
            assert!(LEVELS * lines * rays * 8 <= ROOM || rays == LEAVES, "{settings:?}");
        }
    }
    let rays = |height, width| {
        Quality::ALL.map(|quality| {
            GpuEpipolarParameters::of(quality).settings(&View { height, width, ..view }).light_rays
        })
    };
    assert_eq!([rays(720, 1280), rays(1080, 1920)], [[256, 512, 832, 832], [256, 512, 512, 512]]);
    assert_eq!(rays(2160, 3840), [256; 4]);
}
