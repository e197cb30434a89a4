//! The version for the processor against the reference, pixel by pixel, and against closed forms.

use super::*;
use crate::methods::Quality;
use crate::methods::gtao::reference;
use crate::methods::march::blurred;
use crate::methods::proving::receiver::beside_wall;
use crate::methods::proving::{
    Tolerance, agree, everything, gbuffer_of, plane, prove_comparator, prove_twin_on_processor, still_life,
    view,
};
use glam::Vec3;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// As between the passes on the GPU and the reference.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.05 };

const QUALITIES: [Quality; 4] = [Quality::Low, Quality::Medium, Quality::High, Quality::Ultra];

fn image(surface: &Surface, parameters: &GtaoParameters, view: &View) -> Planes {
    let [.., image] = on_processor(parameters, surface, view);
    image
}

#[test]
fn it_and_the_reference_agree_at_every_pixel() {
    for quality in QUALITIES {
        // The radius of 30 reaches beyond the scene.
        for (height, width, radius) in
            [(HEIGHT, WIDTH, 1.0), (HEIGHT, WIDTH, 30.0), (1, 1, 1.0), (17, 5, 0.4), (33, 130, 0.4)]
        {
            let gbuffer = still_life(height, width);
            let parameters = GtaoParameters::of(quality);
            prove_twin_on_processor(&parameters, &gbuffer, &view(height, width, radius), TOLERANCE);
        }
    }
    let (_, view, gbuffer) = everything(37, 50);
    prove_twin_on_processor(&GtaoParameters::of(Quality::High), &gbuffer, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let (parameters, view_of_right) = (GtaoParameters::of(Quality::High), view(HEIGHT, WIDTH, 1.0));
    let noisy = reference::occlude(&surface, &parameters.march(&view_of_right));
    let [.., right] = blurred(&parameters, &surface, &view_of_right, noisy);
    prove_comparator(&right, TOLERANCE);
    let reseeded = View { seed: 12, ..view(HEIGHT, WIDTH, 1.0) };
    let reseeded = image(&surface, &GtaoParameters::of(Quality::High), &reseeded);
    assert!(agree(&right, &reseeded, TOLERANCE).is_err(), "another seed");
}

#[test]
fn threads_do_not_matter() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let (parameters, view) = (GtaoParameters::of(Quality::High), view(HEIGHT, WIDTH, 1.0));
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| on_processor(&parameters, &surface, &view))
    });
    assert!(one == two, "the same bits");
}

#[test]
fn a_plane_is_open_however_it_is_tilted() {
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(-2.0, 1.0, 1.0), Vec3::new(0.0, 6.0, 1.0)] {
        let gbuffer =
            gbuffer_of(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal.normalize()));
        let surface = Surface::of(&gbuffer).expect("all attributes");
        for quality in QUALITIES {
            let openness = image(&surface, &GtaoParameters::of(quality), &view(HEIGHT, WIDTH, 1.5));
            let darkest = openness.data().iter().fold(1.0f32, |a, b| a.min(*b));
            assert!(darkest > 0.999, "normal {normal}: {darkest}");
        }
    }
}

#[test]
fn a_floor_beside_a_wall_has_its_integral() {
    let receiver = beside_wall();
    let surface = Surface::of(&receiver.gbuffer()).expect("all attributes");
    let view = view(surface.height, surface.width, receiver.radius);
    let mut parameters = GtaoParameters::of(Quality::High);
    (parameters.slices.slices, parameters.slices.steps, parameters.blur.radius) = (64, 1000, 0);
    parameters.slices.thickness = 0.25;
    let open = image(&surface, &parameters, &view);
    assert_eq!(receiver.compare(&open, |met| 1.0 - met, 0.02), Ok(()));
    parameters.slices.thickness = 0.001;
    let thin = image(&surface, &parameters, &view);
    assert!(
        receiver.compare(&thin, |met| 1.0 - met, 0.02).is_err(),
        "between samples of a thin wall light leaks"
    );
}
