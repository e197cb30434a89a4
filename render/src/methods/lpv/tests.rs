//! The passes against their plain version, and what must hold of images.

use super::in_medium::{Multiple, MultipleScattering};
use super::*;
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{corner, foggy, prove_twin};
use deepshade_shaders::gpu::Gpu;

const FEW: Parameters = Parameters { cells: 14, iterations: 9, steps: 12, scale: 2 };

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    // Shadow maps end within a texel of where shadows do.
    let tolerance = Tolerance { usual: 2e-3, worst: 0.03 };
    prove_twin(&LightVolume::new(&gpu, FEW).expect("valid shaders"), &corner(), tolerance);
    let method = MultipleScattering::new(&gpu, Multiple(FEW)).expect("valid shaders");
    for frame in foggy() {
        prove_twin(&method, &frame, tolerance);
    }
}
