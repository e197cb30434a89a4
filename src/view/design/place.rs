//! The thread that finds a place on a scene's surfaces, and the light of lamps that it gets over time.

use crate::output::message;
use crate::phosphor::design::light::{self, Spot};
use crate::view::catch_panic::catch_panic;
use crate::view::request_slot::RequestSlot;
use crate::view::subject::PreparedScene;
use crate::view::workers::{SendUpdate, Update};
use anyhow::{Context, Result};
use deepshade_glow::paint::LightInterval;
use deepshade_glow::spectrum::lights::Light as Spectrum;
use deepshade_phosphor::wish::FrameLight;
use deepshade_render::path::phosphor::Afterglow;
use deepshade_render::scene::{Glow, Light};
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// Where a place is wanted.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// Where a ray meets a surface, at the moment that is shown: from where, and in which direction.
    Ray([Vec3; 2]),
    /// The point of all surfaces next to this one, metres, as time begins.
    Point(Vec3),
    /// There.
    Spot(Spot),
}

/// What is asked; where this changes, the answer is another one.
#[derive(Clone, PartialEq)]
pub struct Asked {
    /// Where.
    pub target: Target,
    /// Under which lights.
    pub lights: Vec<Light>,
    /// For how long from the beginning of time on, seconds.
    pub seconds: f32,
    /// The spectrum of all lamps for what is sought.
    pub spectrum: Option<Spectrum>,
    /// Whether what the place reflects is wanted, too.
    pub reflected: bool,
}

/// A place that is wanted.
pub struct Request {
    /// Of which scene.
    pub subject: Arc<PreparedScene>,
    /// The moment that is shown, seconds.
    pub time: f32,
    /// From where it is shown, metres: towards there it reflects.
    pub eye: Vec3,
    /// What is asked.
    pub asked: Asked,
}

/// A place.
pub struct Place {
    /// Where it is.
    pub spot: Spot,
    /// What files call its material.
    pub material: String,
    /// Where it is as time begins, metres.
    pub at: Vec3,
}

/// A place that was found, and its light.
pub struct Found {
    /// What was asked.
    pub asked: Asked,
    /// The place.
    pub place: Place,
    /// Its light.
    pub light: FrameLight,
}

/// Finds what is requested until the slot is closed.
pub fn run(requests: &RequestSlot<Request>, send: SendUpdate<'_>) {
    while let Some(request) = requests.take() {
        let asked = request.asked.clone();
        let found = catch_panic("the light of a place", || find(request));
        send(Update::Place(found.map(Box::new).map_err(|error| (Box::new(asked), message(&error)))));
    }
}

fn find(Request { subject, time, eye, asked }: Request) -> Result<Found> {
    let (scene, lights) = (&subject.animated.scene, &asked.lights);
    let begin = Glow::of(scene).begin();
    let spot = match &asked.target {
        Target::Spot(spot) => spot.clone(),
        Target::Point(at) => light::spot(&*subject.traced(begin, lights)?, *at)?,
        Target::Ray([origin, direction]) => {
            let now = subject.traced(time, lights)?;
            let hit = now.hit(*origin, *direction, f32::INFINITY).context("no surface is there")?;
            Spot::of(now.scene(), &hit)
        }
    };
    let end = subject.traced(begin + asked.seconds, lights)?;
    let afterglow = Afterglow::new(&end);
    let history = afterglow.history(spot.mesh, spot.triangle, spot.weights);
    let mut light = FrameLight::new(begin.into(), asked.seconds.into(), &history).under(asked.spectrum);
    if asked.reflected {
        let albedo = spot.albedo(&end);
        let seen = afterglow.history_seen_from(eye, (spot.mesh, spot.triangle), spot.weights);
        let turned = |lit: LightInterval| LightInterval { irradiance: albedo * lit.irradiance / PI, ..lit };
        light = light.reflecting(asked.seconds.into(), &seen.into_iter().map(turned).collect::<Vec<_>>());
    }
    let first = end.past().first().map_or(&*end, |(_, pose)| pose);
    let place = Place {
        at: spot.position_in(first.scene()),
        material: scene.material_names()[spot.material].clone(),
        spot,
    };
    Ok(Found { asked, place, light })
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::view::tests::args;
    use deepshade_phosphor::wish::brightness;
    use deepshade_shaders::Effect;
    use glam::Vec2;

    /// A place that the scene's first view sees, and that lamps light.
    pub fn lit_place(subject: &Arc<PreparedScene>, seconds: f32) -> Found {
        let (camera, lights) = (subject.controller.camera, subject.lights(None));
        let of_pixel = |pixel: u16| {
            let at = Vec2::new(f32::from(pixel % 8), f32::from(pixel / 8)) + 0.5;
            let target = Target::Ray([camera.position, camera.direction(at, 8, 8)]);
            let asked = Asked { target, lights: lights.clone(), seconds, spectrum: None, reflected: false };
            find(Request { subject: Arc::clone(subject), time: 0.0, eye: camera.position, asked }).ok()
        };
        // From the middle down.
        let mut found = (28..64).chain(0..28).filter_map(of_pixel);
        found.find(|found| !found.light.is_dark()).expect("a lit place")
    }

    /// What a place gives back by its curve is what rays see of it.
    #[test]
    fn the_light_of_a_place_is_what_truth_has() {
        let args = args("--scene still-life:1 --effect phosphor --height 16 --width 16");
        let subject = Arc::new(PreparedScene::load(&args, &args.scene, Effect::Phosphor).expect("a scene"));
        let camera = subject.controller.camera;
        let lights = subject.lights(None);
        let Found { place, light, .. } = lit_place(&subject, 8.0);
        let asked =
            |target| Asked { target, lights: lights.clone(), seconds: 8.0, spectrum: None, reflected: false };
        let request =
            |asked| Request { subject: Arc::clone(&subject), time: 0.0, eye: camera.position, asked };
        assert_eq!((light.seconds(0), light.frame(7.0)), (-1.0, 199));
        let glow = Glow::of(&subject.animated.scene);
        let material = glow.surfaces[0].paint.material();
        let curve = light.glow(&material).expect("measured");
        let moment = light.seconds(100);
        let seen = subject.traced(moment as f32, &lights).expect("a moment");
        let Spot { mesh, triangle, weights, .. } = place.spot;
        let truth = Afterglow::new(&seen).emission_at(mesh, triangle, weights);
        let (found, truth) = (brightness(curve[100]), brightness(truth.as_dvec3().to_array()));
        assert!(truth > 0.0 && (found / truth - 1.0).abs() < 1e-3, "{found} {truth}");
        let again = find(request(asked(Target::Point(place.at)))).expect("the same place");
        assert!(again.place.at.distance(place.at) < 1e-4 && again.place.material == place.material);
        // What is reflected towards the camera is what of the lamps' light arrives, diffusely.
        let reflecting = Asked { reflected: true, ..asked(Target::Spot(again.place.spot.clone())) };
        let reflecting = find(request(reflecting)).expect("the same place").light.reflected();
        let lit = subject.traced(0.0, &lights).expect("a moment");
        let received = Afterglow::new(&lit).history(mesh, triangle, weights)[0].irradiance;
        let expected = place.spot.albedo(&lit) * received / PI;
        let off = Vec3::from(reflecting[3].map(|part| part as f32)) - expected;
        assert!(off.abs().max_element() < 1e-5 * expected.max_element(), "{off} of {expected}");
        assert_eq!(reflecting[190], [0.0; 3], "the lamp is off");
        let nowhere = Target::Ray([camera.position + 1e4 * Vec3::Y, Vec3::Y]);
        assert!(find(request(asked(nowhere))).is_err_and(|error| error.to_string().contains("no surface")));
    }
}
