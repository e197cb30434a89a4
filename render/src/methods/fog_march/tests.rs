//! The pass against its plain version. Closed forms and where geometry degenerates are in `shafts/tests`.

use super::*;
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{foggy, prove_twin};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;

#[test]
fn the_pass_makes_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, FogMarchParameters { steps: 24 });
    for frame in foggy() {
        // Shadow maps end within a texel of where shadows do.
        prove_twin(&method, &frame, Tolerance { usual: 4e-4, worst: 0.01 });
    }
}
