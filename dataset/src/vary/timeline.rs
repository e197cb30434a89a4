//! Frames of a timeline: lamps go on and off, objects go on moving, and surfaces have kept light of all that
//! was before.

use super::{StagedScene, Variation, Vary, look, motion};
use crate::DatasetError;
use deepshade_render::bvh::TracedScene;
use deepshade_render::past::remembered;
use deepshade_render::scene::glow::Schedule;
use deepshade_render::scene::{AnimatedScene, Camera, Glow, Look, Mesh, Scene, SceneError};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// When lamps shine while the frames of a sequence follow each other. All is dark before second 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timeline {
    /// From one frame to the next, seconds; the first frame is as long after second 0.
    pub seconds: f32,
    /// From when to when lamps shine, seconds, in order.
    pub on: Vec<[f32; 2]>,
}

/// The moment of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimelineMoment {
    /// Seconds.
    pub time: f32,
    /// From where the sequence's first frame is seen, by which its lamp and movements are drawn.
    pub first: Camera,
}

/// Least and most seconds between frames.
const STEPS: [f32; 2] = [1e-3, 3600.0];

impl Timeline {
    /// What is wrong with it, in words.
    pub(super) fn check(&self) -> Result<(), String> {
        let [least, most] = STEPS;
        if !(least..=most).contains(&self.seconds) {
            return Err(format!("`vary.timeline.seconds` must be {least} to {most}"));
        }
        let sound = self.on.iter().all(|[from, to]| from.is_finite() && from < to && *from >= 0.0);
        if self.on.is_empty() || !sound || self.on.windows(2).any(|pair| pair[0][1] > pair[1][0]) {
            return Err(
                "`vary.timeline.on` must be times from second 0 on, `[[from, to], ..]`, in order".to_owned()
            );
        }
        Ok(())
    }

    /// When a frame of a sequence is, seconds.
    pub(super) fn time(&self, frame: usize) -> f32 {
        (frame + 1) as f32 * self.seconds
    }
}

/// Poses of the past at most: what moves by some pixels a frame goes by about one of them from pose to pose.
const POSES: usize = 16;

/// What moves in a sequence.
struct Moving<'a> {
    /// How it looks now, with meshes as they are at second 0.
    look: &'a Scene,
    animation: Option<&'a AnimatedScene>,
    /// How far each vertex of each mesh goes from frame to frame; an empty list of what stays or is animated.
    ways: Vec<Vec<Vec3>>,
    /// Whether lamps are the scene's own, which its animation may move.
    own_lamps: bool,
    seconds: f32,
}

impl Moving<'_> {
    /// Whether anything does.
    fn moves(&self) -> bool {
        self.animation.is_some() || self.ways.iter().any(|ways| !ways.is_empty())
    }

    /// The scene at a time, seconds, with what moves in the `shutter` seconds around it.
    fn at(&self, time: f32, shutter: f32) -> Result<Scene, SceneError> {
        let mut scene = self.look.clone();
        for (mesh, ways) in scene.meshes.iter_mut().zip(&self.ways).filter(|(_, ways)| !ways.is_empty()) {
            let (gone, seen) = (time / self.seconds, shutter / self.seconds);
            mesh.positions.iter_mut().zip(ways).for_each(|(position, way)| *position += gone * *way);
            mesh.displacements =
                if shutter > 0.0 { ways.iter().map(|way| seen * *way).collect() } else { Vec::new() };
        }
        if let Some(animated) = self.animation {
            let posed = animated.at(time, shutter)?;
            for part in animated.rigs.iter().flat_map(|rig| &rig.parts) {
                follow(&mut scene.meshes[part.mesh], &posed.meshes[part.mesh]);
            }
            if self.own_lamps {
                animated.light(&mut scene.lights, time);
            }
        }
        Ok(scene)
    }
}

/// Puts the corners of a mesh's triangles to where another mesh has them: that it was made of, before
/// textures cut its vertices apart.
fn follow(mesh: &mut Mesh, posed: &Mesh) {
    let count = mesh.positions.len();
    let room = |has: bool| if has { count } else { 0 };
    mesh.normals.resize(room(!posed.normals.is_empty()), Vec3::Y);
    mesh.tangents.resize(room(!posed.tangents.is_empty()), glam::Vec4::X);
    mesh.displacements = vec![Vec3::ZERO; room(!posed.displacements.is_empty())];
    for (own, its) in mesh.triangles.iter().zip(&posed.triangles) {
        for (own, its) in own.iter().zip(its).map(|(own, its)| (*own as usize, *its as usize)) {
            mesh.positions[own] = posed.positions[its];
            if let Some(normal) = posed.normals.get(its) {
                mesh.normals[own] = *normal;
            }
            if let Some(tangent) = posed.tangents.get(its) {
                mesh.tangents[own] = *tangent;
            }
            if let Some(displacement) = posed.displacements.get(its) {
                mesh.displacements[own] = *displacement;
            }
        }
    }
}

impl StagedScene<'_> {
    /// The scene at a moment of a timeline. What moves does so, for a g-buffer, in the time between two
    /// frames around that moment.
    pub(super) fn at_moment(
        &self,
        (vary, timeline): (&Vary, &Timeline),
        variation: &Variation,
        moment: &TimelineMoment,
    ) -> Result<TracedScene, DatasetError> {
        let base = self.base();
        let schedules = vec![Schedule { on: timeline.on.clone(), ..Schedule::default() }];
        let glow = Glow { schedules, moment: moment.time, ..Glow::of(base.scene()).clone() };
        let look = Look { glow: Some(Arc::new(glow)), ..look::look(base, vary, variation, self.props)? };
        let now = base.with_look(look)?;
        let animated = |mesh: usize| {
            let rigs = self.timeline_animation().into_iter().flat_map(|animated| &animated.rigs);
            rigs.flat_map(|rig| &rig.parts).any(|part| part.mesh == mesh)
        };
        let drawn = |range| {
            let ways =
                motion::displacements(base, &moment.first, self.size(variation.seed), range, variation.seed);
            let own = ways.into_iter().enumerate();
            own.map(|(mesh, ways)| if animated(mesh) { Vec::new() } else { ways }).collect()
        };
        let moving = Moving {
            look: now.scene(),
            animation: self.timeline_animation(),
            ways: vary.motion.map_or_else(Vec::new, drawn),
            own_lamps: variation.lamp.is_none(),
            seconds: timeline.seconds,
        };
        if !moving.moves() {
            return Ok(now);
        }
        let scene = TracedScene::new(moving.at(moment.time, timeline.seconds)?)?;
        Ok(remembered(scene, POSES, |time| moving.at(time, 0.0))?)
    }
}

/// A scene of whose lamps those are left that shine at the moment that it shows.
pub(super) fn shining(scene: &TracedScene) -> TracedScene {
    let mut look = scene.scene().look();
    let glow = Glow::of(scene.scene());
    let lights = look.lights.into_iter().enumerate().filter(|(light, _)| glow.shines(*light));
    look.lights = lights.map(|(_, light)| light).collect();
    scene.with_look(look).expect("fewer lights of the same scene")
}

#[cfg(test)]
mod tests;
