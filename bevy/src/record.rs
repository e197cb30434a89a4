//! What is recorded of every frame.

use crate::textures::TexturePasses;
use crate::{LearnedAmbientOcclusion, LearnedDepthOfField, LearnedFailures, LearnedShading};
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ScreenSpaceAmbientOcclusionResources;
use bevy::prelude::ResMut;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::ViewTarget;

type Occluded<'a> =
    (&'a mut LearnedShading, &'a ViewPrepassTextures, &'a ScreenSpaceAmbientOcclusionResources);

type Blurred<'a> = (
    &'a mut LearnedShading<LearnedDepthOfField>,
    &'a LearnedDepthOfField,
    &'a ViewPrepassTextures,
    &'a ViewTarget,
);

/// Records a camera's passes of occlusion between its prepass and its main pass.
pub(crate) fn occlusion(
    view: ViewQuery<Occluded<'static>>,
    mut passes: ResMut<TexturePasses>,
    mut failures: ResMut<LearnedFailures>,
    mut context: RenderContext,
) {
    let entity = view.entity();
    let (mut shading, prepass, bevys) = view.into_inner();
    let (Some(depth), Some(normals)) = (prepass.depth_only_view(), prepass.normal_view()) else { return };
    let openness = &bevys.screen_space_ambient_occlusion_texture.default_view;
    let bound =
        shading.bind([depth, normals, openness], |inside, views| passes.around_occlusion(inside, views));
    match bound {
        Ok(()) => record(&shading, "deepshade_ao", &mut context),
        Err(error) => failures.tell::<LearnedAmbientOcclusion>(entity, &error.into()),
    }
}

/// Records a camera's passes of depth of field behind its main passes.
pub(crate) fn depth_of_field(
    view: ViewQuery<Blurred<'static>>,
    mut passes: ResMut<TexturePasses>,
    mut failures: ResMut<LearnedFailures>,
    mut context: RenderContext,
) {
    let entity = view.entity();
    let (mut shading, wanted, prepass, target) = view.into_inner();
    let Some(depth) = prepass.depth_only_view().filter(|_| wanted.aperture_radius > 0.0) else { return };
    let (source, destination) = (target.main_texture_view(), target.main_texture_other_view());
    let format = target.main_texture_format();
    let bound = shading.bind([depth, source, destination], |inside, views| {
        passes.around_depth_of_field(inside, views, format)
    });
    match bound {
        Ok(()) => {
            // Both change places: what is written here is what is shown.
            target.post_process_write();
            record(&shading, "deepshade_dof", &mut context);
        }
        Err(error) => failures.tell::<LearnedDepthOfField>(entity, &error.into()),
    }
}

/// Records passes within a span of Bevy's diagnostics.
fn record<E>(shading: &LearnedShading<E>, span: &'static str, context: &mut RenderContext<'_, '_>) {
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = context.command_encoder();
    let span = diagnostics.time_span(encoder, span);
    shading.encode(encoder);
    span.end(encoder);
}
