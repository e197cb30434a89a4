//! What is made before a frame is drawn.

use crate::effect::{LearnedEffect, Reach};
use crate::extract::OfView;
use crate::networks::Networks;
use crate::textures::Seen;
use crate::{LearnedError, LearnedFailures, LearnedShading};
use bevy::pbr::SsaoBindGroups;
use bevy::prelude::{Commands, Entity, Query, Res, ResMut, Vec2, With};
use bevy::render::camera::{ExtractedCamera, TemporalJitter};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use deepshade_render::scene::Lens;
use deepshade_shaders::gpu::Gpu;
use std::sync::Arc;

type Asking<'a, E> = (
    Entity,
    &'a E,
    &'a ExtractedCamera,
    &'a ExtractedView,
    Option<&'a TemporalJitter>,
    Option<&'a LearnedShading<E>>,
);

/// Bevy's device as deepshade's crates take it.
#[derive(bevy::ecs::system::SystemParam)]
pub(crate) struct BevyGpu<'w> {
    device: Res<'w, RenderDevice>,
    queue: Res<'w, RenderQueue>,
    info: Res<'w, RenderAdapterInfo>,
}

impl BevyGpu<'_> {
    fn gpu(&self) -> Gpu {
        Gpu {
            device: self.device.wgpu_device().clone(),
            queue: (**self.queue).clone(),
            info: (**self.info).clone(),
        }
    }
}

/// Makes the passes of cameras that ask for an effect and have none of their size yet, and tells them of the
/// frame.
pub(crate) fn shadings<E: LearnedEffect>(
    mut commands: Commands,
    mut networks: ResMut<Networks>,
    mut failures: ResMut<LearnedFailures>,
    bevy: BevyGpu,
    views: Query<Asking<'_, E>>,
) {
    for (entity, wanted, camera, view, jitter, made) in &views {
        let Some(size) = camera.physical_viewport_size.filter(|size| size.x > 0 && size.y > 0) else {
            continue;
        };
        let size = [size.y as usize, size.x as usize];
        let fitting = made.filter(|made| made.size == size && made.folder == wanted.folder());
        let checked = check(view).and(E::check_device(&bevy.device));
        let shading = checked.map_err(Arc::new).and_then(|()| match fitting {
            Some(_) => Ok(None),
            None => {
                let network = networks.of(wanted, &bevy.gpu())?;
                LearnedShading::new(network, wanted.folder(), E::SHOWN, size).map(Some).map_err(Arc::new)
            }
        });
        let mut view_commands = commands.entity(entity);
        match shading {
            Ok(new) => {
                if let Some(shading) = fitting.or(new.as_ref()) {
                    tell(shading, wanted.reach(), camera, view, jitter);
                }
                view_commands.insert(E::OfBevy::default());
                if let Some(new) = new {
                    failures.forget::<E>(entity);
                    view_commands.insert(new);
                }
            }
            Err(error) => {
                failures.tell::<E>(entity, &error);
                view_commands.remove::<OfView<E>>();
            }
        }
    }
}

/// Checks what only the render world knows.
fn check(view: &ExtractedView) -> Result<(), LearnedError> {
    let is_perspective = view.clip_from_view.w_axis.w == 0.0 && view.clip_from_view.z_axis.w == -1.0;
    if is_perspective { Ok(()) } else { Err(LearnedError::Projection) }
}

/// Tells a camera's passes of a frame, from its projection as Bevy draws it.
fn tell<E>(
    shading: &LearnedShading<E>,
    reach: Reach,
    camera: &ExtractedCamera,
    view: &ExtractedView,
    jitter: Option<&TemporalJitter>,
) {
    let [height, width] = shading.size;
    let mut clip_from_view = view.clip_from_view;
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut clip_from_view, Vec2::new(width as f32, height as f32));
    }
    let focal_length = 0.5 * height as f32 * clip_from_view.y_axis.y;
    let blur = |lens: Lens| [focal_length * lens.radius / lens.focus, lens.focus];
    let [blur_at_infinity, focus] = reach.lens.map_or([0.0; 2], blur);
    let seen = Seen {
        view_from_clip: clip_from_view.inverse(),
        view_from_world: view.world_from_view.to_matrix().inverse(),
        size: [width as u32, height as u32].into(),
        origin: camera.viewport.as_ref().map_or_else(Default::default, |part| part.physical_position),
        blur_at_infinity,
        focus,
        spare: [0.0; 2],
    };
    shading.tell(&seen, focal_length, reach);
}

/// Keeps Bevy's own passes from running for cameras that have learned occlusion: they run where these bind
/// groups are. The texture that they would write, and with it their others, stays.
pub(crate) fn silence_ssao(mut commands: Commands, views: Query<Entity, With<LearnedShading>>) {
    for view in &views {
        commands.entity(view).remove::<SsaoBindGroups>();
    }
}
