//! A glTF scene in a window. Space goes from Bevy's occlusion to the network's, to none; W, A, S, D and the
//! arrow keys move the camera.
//!
//! `cargo run --example gltf -- ../models hall.gltf -9 1.6 0 0 1.2 0`: deepshade's folder `models`, a file,
//! where the camera stands and what it looks at. Without a file it is a room.

#[allow(dead_code, reason = "the tests use the rest of it")]
#[path = "../tests/support/mod.rs"]
mod support;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::pbr::ScreenSpaceAmbientOcclusion;
use bevy::prelude::*;
use bevy::world_serialization::WorldAssetRoot;
use deepshade_bevy::{DeepshadePlugin, LearnedAmbientOcclusion};
use deepshade_render::scene::SceneSource;
use std::error::Error;
use std::path::{Path, PathBuf};
use support::frame::Frame;

/// How far surfaces occlude, metres: Bevy's default.
const RADIUS: f32 = 0.5 * 1.457;

/// Which occlusion the camera has.
#[derive(Clone, Copy, Debug, PartialEq, Resource)]
enum Shown {
    Bevys,
    Learned,
    Nothing,
}

/// The scene's file and where the camera begins.
#[derive(Resource)]
struct Begin {
    file: String,
    place: Transform,
    fov: f32,
}

fn main() -> std::result::Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let models = PathBuf::from(words.next().ok_or("where are the networks? name deepshade's folder models")?);
    let folder = tempfile::tempdir()?;
    let (source, file): (SceneSource, PathBuf) = match words.next() {
        Some(path) => (SceneSource::File(path.clone().into()), std::path::absolute(path)?),
        None => ("room:1".parse()?, folder.path().join("room.glb")),
    };
    let numbers = words.map(|word| word.parse()).collect::<std::result::Result<Vec<f32>, _>>()?;
    let view = match numbers[..] {
        [] => [[1.5, 1.6, 1.3], [-0.5, 0.7, -0.3]],
        [x, y, z, to_x, to_y, to_z] => [[x, y, z], [to_x, to_y, to_z]],
        _ => return Err("six numbers are wanted: where the camera stands, and what it looks at".into()),
    };
    let Frame { camera, .. } = Frame::new(&source, &file, view, [720, 1280])?;
    let place = Transform {
        translation: Vec3::from_array(camera.position.to_array()),
        rotation: Quat::from_mat3(&Mat3::from_cols_array(&camera.rotation.to_cols_array())),
        ..default()
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let assets = file.parent().unwrap_or(Path::new(".")).display().to_string();
    let mut app = App::new();
    support::types::register(&mut app);
    app.add_plugins((
        DefaultPlugins.set(AssetPlugin { file_path: assets, ..default() }),
        DeepshadePlugin { models },
    ))
    .insert_resource(Begin { file: name, place, fov: camera.vertical_fov })
    .insert_resource(Shown::Learned)
    .add_systems(Startup, begin)
    .add_systems(Update, (choose, (show, titled).run_if(resource_changed::<Shown>), travel).chain())
    .run();
    Ok(())
}

fn begin(mut commands: Commands, assets: Res<AssetServer>, begin: Res<Begin>) {
    commands.spawn(WorldAssetRoot(assets.load(format!("{}#Scene0", begin.file))));
    commands.spawn((
        Camera3d::default(),
        Projection::Perspective(PerspectiveProjection { fov: begin.fov, near: 0.02, ..default() }),
        begin.place,
        Msaa::Off,
        Tonemapping::AcesFitted,
        AmbientLight { brightness: 1500.0, ..default() },
    ));
}

fn choose(keys: Res<ButtonInput<KeyCode>>, mut shown: ResMut<Shown>) {
    if keys.just_pressed(KeyCode::Space) {
        *shown = match *shown {
            Shown::Bevys => Shown::Learned,
            Shown::Learned => Shown::Nothing,
            Shown::Nothing => Shown::Bevys,
        };
    }
}

fn show(mut commands: Commands, shown: Res<Shown>, camera: Single<Entity, With<Camera3d>>) {
    let mut camera = commands.entity(*camera);
    camera.remove::<(ScreenSpaceAmbientOcclusion, LearnedAmbientOcclusion)>();
    match *shown {
        Shown::Bevys => camera.insert(ScreenSpaceAmbientOcclusion { radius: RADIUS, ..default() }),
        Shown::Learned => camera.insert(LearnedAmbientOcclusion { radius: RADIUS, ..default() }),
        Shown::Nothing => &mut camera,
    };
}

fn titled(shown: Res<Shown>, mut window: Single<&mut Window>) {
    window.title = match *shown {
        Shown::Bevys => "Bevy's occlusion",
        Shown::Learned => "Occlusion by a network",
        Shown::Nothing => "No occlusion",
    }
    .to_owned();
}

fn travel(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    mut camera: Single<&mut Transform, With<Camera3d>>,
) {
    let held = |key: KeyCode| f32::from(u8::from(keys.pressed(key)));
    let along = |minus, plus| (held(plus) - held(minus)) * time.delta_secs();
    let step = Vec3::new(along(KeyCode::KeyA, KeyCode::KeyD), 0.0, along(KeyCode::KeyW, KeyCode::KeyS));
    let way = camera.rotation * step;
    camera.translation += 1.5 * way;
    camera.rotate_y(along(KeyCode::ArrowRight, KeyCode::ArrowLeft));
    camera.rotate_local_x(along(KeyCode::ArrowDown, KeyCode::ArrowUp));
}
