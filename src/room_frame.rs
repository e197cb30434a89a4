//! A frame of a procedural room with all that a network reads, for checks of networks.

use crate::complete::{Additions, Completed, Wants, complete};
use crate::learned::{Learned, estimator, reads};
use crate::radius::{self, Space};
use anyhow::Result;
use deepshade_dataset::views::sample_view;
use deepshade_infer::NetSpec;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::methods::estimate::{EstimateInputs, with_estimates};
use deepshade_render::scene::procedural::Family;
use deepshade_shaders::{Attribute, GBuffer, Planes};

/// The room, and its view.
pub const SEED: u32 = 7;

/// What is seen of the room.
pub struct RoomFrame {
    /// What the network reads, estimates among it, and `valid`.
    pub gbuffer: GBuffer,
    /// How far the effect reaches, metres: the network's own radius.
    pub radius: f32,
}

impl RoomFrame {
    /// The frame, `[height, width]`, for a network.
    ///
    /// # Errors
    /// If no view of the room can be found, or the frame lacks something that the network reads.
    pub fn new(spec: &NetSpec, size: [usize; 2]) -> Result<Self> {
        let room = TracedScene::new(Family::Room.scene(u64::from(SEED)))?;
        let camera = sample_view(&room, size, SEED, u64::from(SEED), 0)?;
        let additions = Additions::default();
        let wants = Wants {
            effect: spec.effect,
            size,
            additions: &additions,
            seed: SEED,
            learned: spec.environment.as_ref(),
            animated: false,
            time: 0.0,
        };
        let Completed { scene, camera, .. } = complete(&room, &camera, &wants)?;
        let mut attributes = reads(spec)?;
        if !attributes.contains(&Attribute::Valid) {
            attributes.push(Attribute::Valid);
        }
        // What methods make is made of the scene here: rendered it would be black.
        attributes.retain(|attribute| !Attribute::MADE.contains(attribute));
        let gbuffer = gbuffer::render(&scene, &camera, size[0], size[1], &attributes);
        let radius = radius::wanted(None, Some(spec.reach), &[], Space::seen(&scene, &camera, size));
        let inputs = EstimateInputs { gbuffer: &gbuffer, radius, seed: SEED, scene: Some((&scene, &camera)) };
        let estimators = spec.estimates.iter().map(|estimate| estimator(spec, estimate));
        let gbuffer = with_estimates(&inputs, &estimators.collect::<Result<Vec<_>, _>>()?)?;
        Ok(Self { gbuffer, radius })
    }

    /// The input of the network's first run, `[input channels, height, width]`.
    ///
    /// # Errors
    /// If the frame lacks something that the network reads.
    pub fn input(&self, spec: &NetSpec) -> Result<Planes> {
        Ok(Learned::input(spec, &self.gbuffer, self.radius)?)
    }
}
