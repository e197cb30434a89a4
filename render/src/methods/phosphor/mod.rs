//! Phosphorescence by states that stay on surfaces (`rate-equation`, thesis 8.5), and its rival (`glassner`).
//!
//! Every triangle that keeps light has a lattice of texels of its own ([`tile`]), so that a mesh needs no
//! texture coordinates, and texels keep their place however it moves or bends. Each frame one pass moves
//! their states on by the time that went by, under the lamps' shadow maps as they are now, exactly for light
//! that stays the same, or by Euler's scheme as in the thesis ([`rate`](deepshade_glow::rate)). A pixel finds
//! its triangle by where its surface is, in a tree of boxes that is fitted to the triangles of each frame: a
//! g-buffer knows objects, not triangles, and one that rays made is as good as one that was drawn. What it
//! shows is linear between texels.
//!
//! A still goes through all of the past in one frame, lamps being switched at their moments; where something
//! moves, a stretch after the other, each under shadow maps of a pose of its own. In a sequence a frame costs
//! the same however long it has lasted; states are the past. Its first frame takes all of the past as it is
//! then.
//!
//! A medium may keep light, too: states of the cells of a grid, lit through it, which a march shows
//! ([`cells`]).
//!
//! Why it: cost does not grow with time, strong light saturates, what moves takes its light along. Why not:
//! light is kept only where texels are; what the camera never looks at costs as much as what it sees.
//!
//! Limits. Lamps without an extent excite, as they are at a frame's end, and [lamps that stand for the
//! environment](crate::scene::glow::SKY_LAMPS); light of emissive surfaces and by detours does not. What
//! places have of a paint is told texel by texel. Texels are as many as the mesh's area asks for, where it is
//! largest of some poses of an animation, and slivers have more.

pub(crate) mod cells;
pub mod glassner;
pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;
pub mod tile;

use super::Quality;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use cells::{Cells, edge};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use passes::Finding;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct RateEquationParameters {
    /// Texels along the scene's diagonal.
    #[schemars(range(min = 8, max = 4096))]
    pub texels: u32,
    /// Steps of Euler's scheme, as the thesis has it, for each time between frames or switches of lamps;
    /// without any the step is the exact one.
    #[schemars(range(min = 0, max = 4096))]
    pub euler: u32,
}

/// What both methods read of a g-buffer.
const ATTRIBUTES: &[Attribute] = &[Attribute::Position, Attribute::ObjectId, Attribute::Valid];

impl RateEquationParameters {
    /// So many texels along the scene's diagonal, whose steps are exact.
    pub const fn exact(texels: u32) -> Self {
        Self { texels, euler: 0 }
    }

    /// More time is finer texels.
    pub const fn of(quality: Quality) -> Self {
        let texels = match quality {
            Quality::Low => 128,
            Quality::Medium => 256,
            Quality::High => 512,
            Quality::Ultra => 1536,
        };
        Self::exact(texels)
    }
}

impl Technique for RateEquationParameters {
    fn about(&self) -> About {
        About::beyond_screen("rate-equation", Effect::Phosphor, ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        vec![bytes_of(&view.perspective()).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, world, gbuffer) = (to.device, to.scene()?, to.gbuffer);
        let finding = Finding::new(device, world, gbuffer, self.texels)?;
        let mut steps = finding.steps(device, world, gbuffer, &to.uniforms[0])?;
        let states = finding.states(device, world)?;
        let cells = Cells::new(device, world, edge(world.scene(), self.texels))?;
        let kept = cells.as_ref().filter(|_| world.glow.glow().medium.is_some());
        for pose in world.poses() {
            steps.extend(finding.keeping(&states, self.euler).steps(device, pose)?);
            if let Some(cells) = kept {
                steps.extend(cells.steps(device, pose, self.euler)?);
            }
        }
        steps.push(finding.show(device, world, &states, to.output)?);
        if let Some(cells) = &cells {
            steps.push(cells.shine(device, world, gbuffer, [&to.uniforms[0], to.output])?);
        }
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(inputs.scene.map(|scene| reference::shade(scene, view, *self)).into_iter().flatten().collect())
    }
}
