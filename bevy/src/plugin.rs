//! The plugin.

use crate::networks::Networks;
use crate::textures::TexturePasses;
use crate::{
    LearnedAmbientOcclusion, LearnedDepthOfField, LearnedFailures, effect::LearnedEffect, extract, prepare,
    record,
};
use bevy::core_pipeline::schedule::{Core3d, Core3dSystems};
use bevy::prelude::{App, Commands, IntoScheduleConfigs, Plugin};
use bevy::reflect::GetTypeRegistration;
use bevy::render::sync_component::SyncComponentPlugin;
use bevy::render::{ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems};
use std::path::PathBuf;

/// Runs deepshade's networks for cameras that ask for it: [`LearnedAmbientOcclusion`],
/// [`LearnedDepthOfField`]. It goes behind Bevy's `DefaultPlugins`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeepshadePlugin {
    /// The folder that has the networks' folders, `ao`, `ao-small` and `dof`: deepshade's `models`.
    pub models: PathBuf,
}

impl Plugin for DeepshadePlugin {
    fn build(&self, app: &mut App) {
        add::<LearnedAmbientOcclusion>(app);
        add::<LearnedDepthOfField>(app);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        let models = self.models.clone();
        // Again where a device was lost: what is compiled is of the old one.
        let networks = move |mut commands: Commands<'_, '_>| {
            commands.insert_resource(Networks::new(models.clone()));
        };
        render_app
            .init_resource::<LearnedFailures>()
            .init_gpu_resource::<TexturePasses>()
            .add_systems(RenderStartup, networks)
            .add_systems(
                Render,
                prepare::silence_ssao.after(RenderSystems::PrepareBindGroups).before(RenderSystems::Render),
            )
            // Where Bevy's own passes stand.
            .add_systems(
                Core3d,
                (
                    record::occlusion.after(Core3dSystems::Prepass).before(Core3dSystems::MainPass),
                    record::depth_of_field.in_set(Core3dSystems::EarlyPostProcess),
                ),
            );
    }
}

/// Has cameras in the render world get what they ask for by a component.
fn add<E: LearnedEffect + GetTypeRegistration>(app: &mut App) {
    app.register_type::<E>();
    app.add_plugins(SyncComponentPlugin::<E>::default());
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
    render_app.add_systems(ExtractSchedule, extract::extract::<E>).add_systems(
        Render,
        // Before Bevy asks which views have ambient occlusion, on which their pipelines depend.
        prepare::shadings::<E>.after(RenderSystems::ExtractCommands).before(RenderSystems::PrepareAssets),
    );
}
