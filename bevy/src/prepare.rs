//! What is made before a frame is drawn.

use crate::networks::Networks;
use crate::textures::Seen;
use crate::{LearnedAmbientOcclusion, LearnedError, LearnedFailures, LearnedShading, extract};
use bevy::pbr::{ScreenSpaceAmbientOcclusion, SsaoBindGroups};
use bevy::prelude::{Commands, Entity, Query, Res, ResMut, Vec2, With};
use bevy::render::camera::{ExtractedCamera, TemporalJitter};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue};
use bevy::render::view::ExtractedView;
use deepshade_shaders::gpu::Gpu;
use std::sync::Arc;

/// Storage textures that Bevy's own passes bind.
const STORAGE_TEXTURES: u32 = 5;

type Asking<'a> = (
    Entity,
    &'a LearnedAmbientOcclusion,
    &'a ExtractedCamera,
    &'a ExtractedView,
    Option<&'a TemporalJitter>,
    Option<&'a LearnedShading>,
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

/// Makes the passes of cameras that ask for occlusion and have none of their size yet, and tells them of the
/// frame. Bevy's component on the view has Bevy make the texture, and its materials read it.
pub(crate) fn shadings(
    mut commands: Commands,
    mut networks: ResMut<Networks>,
    mut failures: ResMut<LearnedFailures>,
    bevy: BevyGpu,
    views: Query<Asking<'_>>,
) {
    for (entity, wanted, camera, view, jitter, made) in &views {
        let Some(size) = camera.physical_viewport_size.filter(|size| size.x > 0 && size.y > 0) else {
            continue;
        };
        let size = [size.y as usize, size.x as usize];
        let fits = |made: &&LearnedShading| made.size == size && made.quality == wanted.quality;
        let fitting = made.filter(fits);
        let checked = check(view, &bevy.device);
        let shading = checked.map_err(Arc::new).and_then(|()| match fitting {
            Some(_) => Ok(None),
            None => {
                let network = networks.of(wanted.quality, &bevy.gpu())?;
                LearnedShading::new(network, wanted.quality, size).map(Some).map_err(Arc::new)
            }
        });
        let mut view_commands = commands.entity(entity);
        match shading {
            Ok(new) => {
                if let Some(shading) = fitting.or(new.as_ref()) {
                    tell(shading, wanted, camera, view, jitter);
                }
                view_commands.insert(ScreenSpaceAmbientOcclusion::default());
                if let Some(new) = new {
                    failures.forget(entity);
                    view_commands.insert(new);
                }
            }
            Err(error) => {
                failures.tell(entity, &error);
                view_commands.remove::<extract::OfView>();
            }
        }
    }
}

/// Checks what only the render world knows.
fn check(view: &ExtractedView, device: &RenderDevice) -> Result<(), LearnedError> {
    let allowed = device.limits().max_storage_textures_per_shader_stage;
    if allowed < STORAGE_TEXTURES {
        return Err(LearnedError::StorageTextures(allowed));
    }
    let is_perspective = view.clip_from_view.w_axis.w == 0.0 && view.clip_from_view.z_axis.w == -1.0;
    if is_perspective { Ok(()) } else { Err(LearnedError::Projection) }
}

/// Tells a camera's passes of a frame, from its projection as Bevy draws it.
fn tell(
    shading: &LearnedShading,
    wanted: &LearnedAmbientOcclusion,
    camera: &ExtractedCamera,
    view: &ExtractedView,
    jitter: Option<&TemporalJitter>,
) {
    let [height, width] = shading.size;
    let mut clip_from_view = view.clip_from_view;
    if let Some(jitter) = jitter {
        jitter.jitter_projection(&mut clip_from_view, Vec2::new(width as f32, height as f32));
    }
    let seen = Seen {
        view_from_clip: clip_from_view.inverse(),
        view_from_world: view.world_from_view.to_matrix().inverse(),
        size: [width as u32, height as u32].into(),
        origin: camera.viewport.as_ref().map_or_else(Default::default, |part| part.physical_position),
    };
    shading.tell(&seen, &clip_from_view, wanted.radius);
}

/// Keeps Bevy's own passes from running for cameras that have learned occlusion: they run where these bind
/// groups are. The texture that they would write, and with it their others, stays.
pub(crate) fn silence_ssao(mut commands: Commands, views: Query<Entity, With<LearnedShading>>) {
    for view in &views {
        commands.entity(view).remove::<SsaoBindGroups>();
    }
}
