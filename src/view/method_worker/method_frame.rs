//! A frame that is wanted, and one that was made.

use super::{Pass, PreparedScene, Show};
use crate::render::picture::Exposure;
use crate::view::display_image::DisplayImage;
use anyhow::Result;
use deepshade_render::gbuffer;
use deepshade_render::scene::{Camera, Light};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use std::sync::Arc;

/// A frame that is wanted.
#[derive(Clone)]
pub struct Request {
    /// What is made of it.
    pub show: Show,
    /// From where it is seen; where nothing is said, from where the scene is seen first.
    pub camera: Option<Camera>,
    /// When, seconds.
    pub time: f32,
    /// Under which lights; where nothing is said, the scene's own.
    pub lights: Option<Vec<Light>>,
    /// How it is exposed; by default as suits the first image.
    pub exposure: Option<Exposure>,
    /// Chooses random numbers. A picture of the same number is the same one, but for its exposure.
    pub number: u32,
}

impl Request {
    /// How it is exposed, for images of which this is the first.
    pub fn exposed(&self, first: Option<&Planes>) -> Option<Exposure> {
        self.exposure.or_else(|| Some(Exposure::new(self.show.effect, first?, None)))
    }
}

/// A frame that was made.
#[derive(Clone)]
pub struct MethodFrame {
    /// What was ordered.
    pub request: Request,
    /// Of what.
    pub subject: Arc<PreparedScene>,
    /// From where it is seen.
    pub camera: Camera,
    /// Under which lights.
    pub lights: Vec<Light>,
    /// How far the effect reached, metres.
    pub radius: f32,
    /// What is to be said of it where it is unlike what the network was trained on.
    pub warning: Option<String>,
    /// How it was exposed, if there was anything to expose.
    pub exposure: Option<Exposure>,
    /// What each method made.
    pub images: Vec<DisplayImage>,
    /// The attribute that is inspected.
    pub inspected: Option<DisplayImage>,
    /// Milliseconds of passes, as far as they are known.
    pub passes: Vec<Pass>,
}

impl MethodFrame {
    /// The requested picture, where it is this one in another exposure: no image is made anew.
    pub fn exposed(&self, request: &Request) -> Option<Self> {
        let made = &self.request;
        let is_this = (&request.show, request.number, request.time) == (&made.show, made.number, made.time)
            && (request.camera, request.lights.as_ref()) == (Some(self.camera), Some(&self.lights));
        let exposure =
            request.exposed(self.images.first().map(|image| &*image.values)).filter(|_| is_this)?;
        let images = self.images.iter().map(|image| image.exposed(exposure)).collect();
        Some(Self { request: request.clone(), exposure: Some(exposure), images, ..self.clone() })
    }

    /// All attributes of what it shows, by a ray a pixel, whatever its methods read.
    ///
    /// # Errors
    /// If there is no such moment.
    pub fn gbuffer(&self) -> Result<GBuffer> {
        let [height, width] = self.request.show.size;
        let scene = self.subject.traced(self.request.time, &self.lights)?;
        Ok(gbuffer::render(&scene, &self.camera, height, width, &Attribute::ALL))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::state::State;
    use crate::view::tests::args;

    #[test]
    fn another_exposure_makes_no_other_images() {
        let args = args("--scene still-life:1 --height 16 --width 16 --effect gi --methods ssgi");
        let show = State::new(&args).expect("methods").show;
        let subject = Arc::new(PreparedScene::load(&args, &show.source, show.effect).expect("a scene"));
        let (camera, lights) = (subject.controller.camera, subject.lights(None));
        let exposure = Exposure::Tone { middle: 0.5, white: 1.0 };
        let request = Request {
            show,
            camera: Some(camera),
            time: 0.0,
            lights: Some(lights.clone()),
            exposure: Some(exposure),
            number: 3,
        };
        let values = Planes::from_fn(3, 16, 16, |_, y, x| (y + x) as f32 / 32.0);
        let picture = MethodFrame {
            request: request.clone(),
            subject,
            camera,
            lights,
            radius: 0.5,
            warning: None,
            exposure: Some(exposure),
            images: vec![DisplayImage::new("ssgi", values, exposure)],
            inspected: None,
            passes: Vec::new(),
        };
        let brighter = Request { exposure: Some(exposure.brighter(2.0)), ..request.clone() };
        let exposed = picture.exposed(&brighter).expect("the same picture");
        assert!(Arc::ptr_eq(&exposed.images[0].values, &picture.images[0].values));
        assert_eq!(exposed.exposure, brighter.exposure);
        let light = |picture: &MethodFrame| {
            picture.images[0].picture.pixels.iter().map(|it| u32::from(it.r())).sum::<u32>()
        };
        assert!(light(&exposed) > light(&picture) + 1000);
        let suits =
            picture.exposed(&Request { exposure: None, ..request.clone() }).expect("the same picture");
        assert_eq!(suits.exposure, Some(Exposure::new(request.show.effect, &picture.images[0].values, None)));
        for other in [
            Request { number: 4, ..brighter.clone() },
            Request { time: 1.0, ..brighter.clone() },
            Request { lights: Some(Vec::new()), ..brighter.clone() },
            Request { show: Show { size: [8, 8], ..request.show.clone() }, ..brighter.clone() },
        ] {
            assert!(picture.exposed(&other).is_none());
        }
    }
}
