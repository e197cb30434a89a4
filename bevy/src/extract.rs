//! From the app's world to the render world.

use crate::{LearnedAmbientOcclusion, LearnedError, LearnedFailures, LearnedShading};
use bevy::camera::Camera3d;
use bevy::pbr::{
    ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionResources, SsaoBindGroups, SsaoPipelineId,
};
use bevy::prelude::{Camera, Commands, Entity, Query, ResMut, With};
use bevy::render::sync_component::SyncComponent;
use bevy::render::sync_world::RenderEntity;
use bevy::render::view::Msaa;
use bevy::render::{Extract, RenderApp};

/// What a camera in the render world has for learned ambient occlusion. Bevy's own components are among it:
/// they have its materials read the texture.
pub(crate) type OfView = (
    LearnedAmbientOcclusion,
    LearnedShading,
    ScreenSpaceAmbientOcclusion,
    ScreenSpaceAmbientOcclusionResources,
    SsaoPipelineId,
    SsaoBindGroups,
);

impl SyncComponent<RenderApp> for LearnedAmbientOcclusion {
    type Target = OfView;
}

type Asking<'a> = (RenderEntity, &'a Camera, &'a LearnedAmbientOcclusion, &'a Msaa);

/// Takes over what cameras ask for, where it can be had.
pub(crate) fn extract(
    mut commands: Commands,
    mut failures: ResMut<LearnedFailures>,
    cameras: Extract<Query<Asking<'_>, With<Camera3d>>>,
) {
    let mut asking: Vec<Entity> = Vec::new();
    for (view, camera, wanted, msaa) in &cameras {
        asking.push(view);
        let checked = wanted.check().and(match *msaa {
            Msaa::Off => Ok(()),
            other => Err(LearnedError::Msaa(other)),
        });
        let Ok(mut view_commands) = commands.get_entity(view) else { continue };
        match checked {
            Ok(()) if camera.is_active => {
                view_commands.insert(*wanted);
            }
            Ok(()) => {
                view_commands.remove::<OfView>();
            }
            Err(error) => {
                failures.tell(view, &error);
                view_commands.remove::<OfView>();
            }
        }
    }
    failures.keep(|view| asking.contains(&view));
}
