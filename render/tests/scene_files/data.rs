//! Real scene files.

use crate::real_data::data;
use deepshade_render::scene::{Mesh, Scene, SceneSummary, gltf, obj};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// All files below a folder with one of the endings, sorted.
pub fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a data folder") {
        let path = entry.expect("a data folder").path();
        if path.is_dir() {
            found.extend(files(&path, endings));
        } else if endings.iter().any(|ending| path.extension().is_some_and(|found| found == *ending)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Triangles that the files show, before those without an area are dropped; instances count each. From the
/// data's own table, made by other means.
const TRIANGLES: [(&str, usize); 31] = [
    ("scenes/sponza/sponza.gltf", 262_267),
    ("scenes/breakfast_room/breakfast_room.gltf", 269_538),
    ("scenes/classroom/classroom.gltf", 103_830),
    ("scenes/forest_pines/forest_pines.gltf", 1_165_082),
    ("scenes/terrain_st_helens/terrain_st_helens.gltf", 71_906),
    ("gltf/Avocado/Avocado.gltf", 682),
    ("gltf/BoomBox.glb", 6_036),
    ("gltf/CesiumMan/CesiumMan.gltf", 4_672),
    ("gltf/DamagedHelmet/DamagedHelmet.gltf", 15_452),
    ("gltf/FlightHelmet.glb", 94_722),
    ("gltf/ToyCar.glb", 108_936),
    ("gltf_conformance/AnimatedMorphCube-Quantized/AnimatedMorphCube.gltf", 12),
    ("gltf_conformance/AttenuationTest.glb", 292),
    ("gltf_conformance/Box With Spaces/Box With Spaces.gltf", 12),
    ("gltf_conformance/Box-Draco/Box.gltf", 12),
    ("gltf_conformance/BoxInterleaved.glb", 12),
    ("gltf_conformance/ClearCoatTest.glb", 37_116),
    ("gltf_conformance/InterpolationTest.glb", 110),
    ("gltf_conformance/MeshPrimitiveModes.gltf", 16),
    ("gltf_conformance/MetalRoughSpheresNoTextures.glb", 1_040_409),
    ("gltf_conformance/NegativeScaleTest.glb", 7_724),
    ("gltf_conformance/RecursiveSkeletons.glb", 6_384),
    ("gltf_conformance/SimpleMeshes.gltf", 2),
    ("gltf_conformance/SimpleSkin.gltf", 8),
    ("gltf_conformance/SimpleSparseAccessor.gltf", 12),
    ("gltf_conformance/VertexColorTest.glb", 36),
    ("scenes/cornell_box/CornellBox-Original.obj", 36),
    ("scenes/cornell_box/CornellBox-Sphere.obj", 2_188),
    ("scenes/cornell_box/CornellBox-Water.obj", 7_088),
    ("objects/stanford-bunny.obj", 69_451),
    ("objects/spot.obj", 5_856),
];

#[test]
fn triangles_are_those_of_the_data_table() {
    let Some(folder) = data() else { return };
    for (name, triangles) in TRIANGLES {
        let path = folder.join(name);
        let scene = if name.ends_with(".obj") { obj::load(&path) } else { gltf::load(&path, 0.0, 0.0) };
        let scene = scene.expect(name);
        assert_eq!(scene.triangle_count(), triangles, "{name}");
    }
}

#[test]
fn all_files_load() {
    let Some(folder) = data() else { return };
    let mut loaded = 0;
    for path in ["scenes", "gltf", "gltf_conformance", "objects"]
        .iter()
        .flat_map(|part| files(&folder.join(part), &["gltf", "glb", "obj"]))
    {
        let begin = Instant::now();
        let result = Scene::load(&path, 0.5);
        let seconds = begin.elapsed().as_secs_f64();
        let name = path.to_string_lossy();
        let scene = result.expect(&name);
        check(&scene);
        loaded += 1;
        println!("{seconds:.3} s\n{}", SceneSummary::of(&scene));
    }
    assert!(loaded >= 50, "{loaded} files");
}

/// What every scene must hold, so that nothing downstream has to check it again.
fn check(scene: &Scene) {
    for Mesh { name, material, positions, normals, displacements, tangents, uvs, colours, triangles } in
        &scene.meshes
    {
        let lengths = [normals, displacements].map(Vec::len);
        let lengths = [&lengths[..], &[tangents.len(), uvs[0].len(), uvs[1].len(), colours.len()]].concat();
        assert!(lengths.iter().all(|length| [0, positions.len()].contains(length)), "{name}: {lengths:?}");
        assert!(triangles.iter().flatten().all(|vertex| (*vertex as usize) < positions.len()), "{name}");
        assert!(positions.iter().all(|position| position.is_finite()), "{name}");
        assert!(normals.iter().all(|normal| normal.is_normalized()), "{name}");
        assert!((material.0 as usize) < scene.materials.len(), "{name}");
    }
    for material in &scene.materials {
        let slots =
            [material.base_colour_texture, material.metallic_roughness_texture, material.emission_texture];
        let slots = slots.into_iter().flatten().chain(material.normal_texture.map(|(slot, _)| slot));
        for slot in slots {
            assert!((slot.texture.0 as usize) < scene.textures.len() && slot.uv_set < 2, "{}", material.name);
        }
    }
    for (name, camera) in &scene.cameras {
        assert!((camera.rotation.determinant() - 1.0).abs() < 1e-4, "{name}");
    }
}

#[test]
fn instances_are_placed() {
    let Some(folder) = data() else { return };
    let scene = Scene::load(&folder.join("gltf_conformance/SimpleInstancing.glb"), 0.0).expect("instances");
    assert_eq!(scene.meshes.len(), 125);
    assert_eq!(scene.triangle_count(), 125 * 12);
}

#[test]
fn a_texture_transform_turns_as_khronos_shows() {
    let Some(folder) = data() else { return };
    let path = folder.join("gltf_conformance/TextureTransformMultiTest.glb");
    let scene = Scene::load(&path, 0.0).expect("texture transforms");
    let uvs = |name: &str, set: usize| {
        let mesh = scene.meshes.iter().find(|mesh| mesh.name == name).expect("a mesh of that name");
        let slot = scene.material(mesh.material).base_colour_texture.expect("a base colour texture");
        assert_eq!(slot.uv_set, set, "{name}");
        let mut uvs: Vec<_> = mesh.positions.iter().zip(&mesh.uvs[set]).collect();
        // Left before right, top before bottom, so that corners of different meshes match.
        uvs.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(b.y.total_cmp(&a.y)));
        uvs.into_iter().map(|(_, uv)| slot.transform.transform_point2(*uv)).collect::<Vec<_>>()
    };
    // The sample's own coordinates are what the transformed ones should come to, written less precisely.
    for (test, set) in [("UnlitUV0", 0), ("UnlitUV1", 1), ("BaseColorUV0", 0)] {
        for (moved, sample) in uvs(test, set).iter().zip(uvs(&test.replace(&format!("UV{set}"), "Sample"), 0))
        {
            assert!((*moved - sample).length() < 0.01, "{test}: {moved} for {sample}");
        }
    }
}

#[test]
fn a_walk_moves_and_is_clamped_at_its_end() {
    let Some(folder) = data() else { return };
    let path = folder.join("gltf/CesiumMan/CesiumMan.gltf");
    let at = |time| Scene::load(&path, time).expect("a walk").meshes[0].positions.clone();
    let distance =
        |a: &[glam::Vec3], b: &[glam::Vec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(distance(&at(0.5), &at(1.0)) > 0.1);
    assert_eq!(at(100.0), at(200.0));
    assert_eq!(at(-1.0), at(0.0));
}
