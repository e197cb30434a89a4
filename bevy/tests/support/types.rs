//! The types that a glTF scene brings into a world. Apps with Bevy's default features have all registered;
//! here they are not, so that less of Bevy is built.

use bevy::app::App;
use bevy::camera::Camera3d;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{InheritedVisibility, ViewVisibility, Visibility, VisibilityClass};
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::name::Name;
use bevy::gltf::{
    GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneExtras,
    GltfSceneName,
};
use bevy::mesh::Mesh3d;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::transform::components::{GlobalTransform, Transform, TransformTreeChanged};

/// Registers them.
pub fn register(app: &mut App) {
    app.register_type::<Aabb>()
        .register_type::<Camera3d>()
        .register_type::<ChildOf>()
        .register_type::<Children>()
        .register_type::<GlobalTransform>()
        .register_type::<GltfExtras>()
        .register_type::<GltfMaterialExtras>()
        .register_type::<GltfMaterialName>()
        .register_type::<GltfMeshExtras>()
        .register_type::<GltfMeshName>()
        .register_type::<GltfSceneExtras>()
        .register_type::<GltfSceneName>()
        .register_type::<InheritedVisibility>()
        .register_type::<Mesh3d>()
        .register_type::<MeshMaterial3d<StandardMaterial>>()
        .register_type::<Name>()
        .register_type::<Transform>()
        .register_type::<TransformTreeChanged>()
        .register_type::<ViewVisibility>()
        .register_type::<Visibility>()
        .register_type::<VisibilityClass>();
}
