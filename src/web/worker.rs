//! Truth, refined on a thread of the browser's own, so that the page goes on.

use super::page::said;
use super::shown_scene::{PageRequest, TracedView};
use anyhow::Result;
use deepshade_render::path::{Estimate, Taken};
use deepshade_render::scene::Camera;
use serde::Deserialize;
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;

/// What truth is of, as the page says it.
#[derive(Deserialize)]
struct Asked {
    wish: PageRequest,
    camera: Camera,
    radius: f32,
    time: f32,
}

/// Truth that is being refined.
#[wasm_bindgen]
pub struct Truth {
    traced_view: TracedView,
    camera: Camera,
    taken: Option<Taken>,
}

#[wasm_bindgen]
impl Truth {
    /// No samples yet, of what [`Page::sight`](super::page::Page::sight) says.
    ///
    /// # Errors
    /// If there is no such scene.
    #[wasm_bindgen(constructor)]
    pub fn new(asked: &str) -> Result<Self, JsError> {
        let open = || -> Result<Self> {
            let Asked { wish, camera, radius, time } = serde_json::from_str(asked)?;
            Ok(Self {
                traced_view: TracedView::new(&wish, &wish.open()?, time, radius)?,
                camera,
                taken: None,
            })
        };
        said(open())
    }

    /// Takes so many more samples of each of eight scramblings, and gives the image so far,
    /// `[channels, height, width]`.
    pub fn refine(&mut self, count: u32) -> Vec<f32> {
        let (Estimate { mean, .. }, taken) = self.traced_view.refine(&self.camera, self.taken.take(), count);
        self.taken = Some(taken);
        mean.data().to_vec()
    }

    /// Samples of a pixel so far.
    pub fn samples(&self) -> u32 {
        self.taken.as_ref().map_or(0, Taken::samples)
    }
}
