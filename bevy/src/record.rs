//! What is recorded of every frame.

use crate::textures::TexturePasses;
use crate::{LearnedFailures, LearnedShading};
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ScreenSpaceAmbientOcclusionResources;
use bevy::prelude::ResMut;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::renderer::{RenderContext, ViewQuery};

type Made<'a> = (&'a mut LearnedShading, &'a ViewPrepassTextures, &'a ScreenSpaceAmbientOcclusionResources);

/// Records a camera's passes between its prepass and its main pass.
pub(crate) fn occlusion(
    view: ViewQuery<Made<'static>>,
    mut passes: ResMut<TexturePasses>,
    mut failures: ResMut<LearnedFailures>,
    mut context: RenderContext,
) {
    let entity = view.entity();
    let (mut shading, prepass, bevys) = view.into_inner();
    let (Some(depth), Some(normals)) = (prepass.depth_only_view(), prepass.normal_view()) else { return };
    let openness = &bevys.screen_space_ambient_occlusion_texture.default_view;
    if let Err(error) = shading.bind(&mut passes, [depth, normals, openness]) {
        return failures.tell(entity, &error.into());
    }
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = context.command_encoder();
    let span = diagnostics.time_span(encoder, "deepshade_ao");
    shading.encode(encoder);
    span.end(encoder);
}
