//! From the app's world to the render world.

use crate::effect::LearnedEffect;
use crate::{LearnedError, LearnedFailures};
use bevy::camera::Camera3d;
use bevy::prelude::{Camera, Commands, Entity, Query, ResMut, With};
use bevy::render::sync_component::SyncComponent;
use bevy::render::sync_world::RenderEntity;
use bevy::render::view::Msaa;
use bevy::render::{Extract, RenderApp};

/// What a camera in the render world has for a component.
pub(crate) type OfView<E> = <E as SyncComponent<RenderApp>>::Target;

type Asking<'a, E> = (RenderEntity, &'a Camera, &'a E, &'a Msaa);

/// Takes over what cameras ask for, where it can be had.
pub(crate) fn extract<E: LearnedEffect>(
    mut commands: Commands,
    mut failures: ResMut<LearnedFailures>,
    cameras: Extract<Query<Asking<'_, E>, With<Camera3d>>>,
) {
    let mut asking: Vec<Entity> = Vec::new();
    for (view, camera, wanted, msaa) in &cameras {
        asking.push(view);
        let checked = wanted.checked().and(match *msaa {
            Msaa::Off => Ok(()),
            other => Err(LearnedError::Msaa(other)),
        });
        let Ok(mut view_commands) = commands.get_entity(view) else { continue };
        match checked {
            Ok(()) if camera.is_active => {
                view_commands.insert(*wanted);
            }
            Ok(()) => {
                view_commands.remove::<OfView<E>>();
            }
            Err(error) => {
                failures.tell::<E>(view, &error);
                view_commands.remove::<OfView<E>>();
            }
        }
    }
    failures.keep::<E>(|view| asking.contains(&view));
}
