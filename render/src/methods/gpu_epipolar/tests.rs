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

/// As where a binding holds so many bytes.
#[derive(Debug)]
struct Within(usize, GpuEpipolarParameters);

impl Technique for Within {
    fn about(&self) -> About {
        self.1.about()
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.1.uniforms_within(self.0, view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(self.1.part(self.0, to.size()), to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        self.1.reference(inputs, view)
    }
}

#[test]
fn lines_in_parts_make_the_same_image() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let parameters = GpuEpipolarParameters { light_rays: 256, ..GpuEpipolarParameters::of(Quality::Low) };
    let seen = foggy().remove(0);
    let (scene, view, gbuffer) = &seen;
    let size = [view.height, view.width];
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: 1.0, seed: view.seed };
    let whole = ScreenMethod::new(&gpu, parameters).shade_in_passes(&frame, Repeats::ONCE).expect("an image");
    for (lines, parts) in [(13, (most_lines(size) - 1).div_ceil(12)), (150, 2)] {
        let room = lines * 256 * OF_RAY + 9;
        let part = parameters.part(room, size);
        assert_eq!((part, part.count(size)), (Part { light_rays: 256, lines }, parts));
        let method = ScreenMethod::new(&gpu, Within(room, parameters));
        let found = method.shade_in_passes(&frame, Repeats::ONCE).expect("an image");
        assert_eq!(found.image.data(), whole.image.data(), "{lines} lines at once");
        if lines == 13 {
            prove_twin(&method, &seen, Tolerance { usual: 4e-4, worst: 0.02 });
        }
    }
}

#[test]
fn qualities_mean_as_many_light_rays_at_every_size_and_a_binding_holds_their_sums() {
    for quality in Quality::ALL {
        let parameters = GpuEpipolarParameters::of(quality);
        for size in [[1, 1], [720, 1280], [1080, 1920], [2160, 3840], [8192, 8192]] {
            let part = parameters.part(ROOM, size);
            assert_eq!(part.light_rays, parameters.light_rays, "{size:?}");
            assert!(part.lines > 1 && part.lines * part.light_rays * OF_RAY <= ROOM, "{part:?}");
            // Together they hold all lines, and none is without any.
            let last = (part.count(size) - 1) * (part.lines - 1);
            assert!((last + 1..=last + part.lines).contains(&most_lines(size)), "{part:?} at {size:?}");
        }
    }
    let parts =
        |size| Quality::ALL.map(|quality| GpuEpipolarParameters::of(quality).part(ROOM, size).count(size));
    assert_eq!([parts([720, 1280]), parts([1080, 1920])], [[1, 1, 2, 3], [1, 1, 2, 4]]);
}
