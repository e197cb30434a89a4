//! Scenes over time: what does not move once, and how the rest does, so that a frame can be posed without
//! reading a file again. And one scene put into another: a character into a hall.

use super::gltf::{self, Rig};
use super::{Bounds, Light, Scene, SceneError, SceneSource, TextureId, ending};
use glam::{Mat3, Mat4, Vec3};
use std::path::Path;

/// A scene, and what of it moves.
#[derive(Clone, Debug)]
pub struct AnimatedScene {
    /// The scene at one moment. The vertices of its meshes that move are replaced by poses of the rigs.
    pub scene: Scene,
    /// What moves, by the meshes and lights of `scene`.
    pub rigs: Vec<Rig>,
}

impl From<Scene> for AnimatedScene {
    /// A scene that stays.
    fn from(scene: Scene) -> Self {
        Self { scene, rigs: Vec::new() }
    }
}

impl AnimatedScene {
    /// Reads a scene as it is at `time` seconds, with what moves in it. What moves while a shutter is open is
    /// said by its poses; procedural scenes stay.
    ///
    /// # Errors
    /// As [`SceneSource::scene`].
    pub fn load(source: &SceneSource, time: f32) -> Result<Self, SceneError> {
        let SceneSource::File(path) = source else { return Ok(source.scene(time)?.into()) };
        if !matches!(ending(path).as_str(), "gltf" | "glb") {
            return Ok(source.scene(time)?.into());
        }
        let mut scene = gltf::load(path, time, 0.0)?;
        let rig = gltf::rig(path)?;
        // What moves may have no area at this moment and one at another.
        let follows = |mesh: usize| rig.iter().flat_map(|rig| &rig.parts).any(|part| part.mesh == mesh);
        for (index, mesh) in scene.meshes.iter_mut().enumerate() {
            if !follows(index) {
                mesh.drop_degenerate_triangles();
            }
        }
        if scene.triangle_count() == 0 {
            return Err(SceneError::Empty { name: scene.name });
        }
        let mut kept = 0;
        let places: Vec<Option<usize>> = scene
            .meshes
            .iter()
            .map(|mesh| {
                let place = kept;
                kept += usize::from(!mesh.triangles.is_empty());
                (!mesh.triangles.is_empty()).then_some(place)
            })
            .collect();
        scene.meshes.retain(|mesh| !mesh.triangles.is_empty());
        let rigs = rig.map(|rig| rig.renumbered(&places)).into_iter().collect();
        Ok(Self { scene, rigs })
    }

    /// Puts another scene into this one, moved by `place`.
    pub fn add(&mut self, other: Self, place: Mat4) {
        let (meshes, lights) = (self.scene.meshes.len(), self.scene.lights.len());
        let rigs = other.rigs.into_iter().map(|rig| rig.after(meshes, lights).placed(place));
        self.rigs.extend(rigs);
        self.scene.add(other.scene, place);
    }

    /// The box around all that is seen of it at any moment, as far as a number of moments tell.
    pub fn reach(&self) -> Bounds {
        self.rigs.iter().fold(self.scene.swept_bounds(), |bounds, rig| bounds.union(rig.reach()))
    }

    /// When its animations begin and end, seconds; `None` where nothing is animated.
    pub fn span(&self) -> Option<[f32; 2]> {
        let spans = self.rigs.iter().map(Rig::span);
        spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// The scene as it is at `time`, seconds, with what moves in the `shutter` seconds around that. The file
    /// is not read again. Its triangles are the same at all times: what moves keeps those that have no area
    /// now.
    ///
    /// # Errors
    /// If the time is none, or a vertex is nowhere then.
    pub fn at(&self, time: f32, shutter: f32) -> Result<Scene, SceneError> {
        let invalid = |what: String| SceneError::invalid(Path::new(&self.scene.name), what);
        if !(time.is_finite() && shutter.is_finite()) {
            return Err(invalid(format!("cannot be posed at {time} seconds for {shutter}")));
        }
        let mut scene = self.scene.clone();
        for rig in &self.rigs {
            rig.put(&mut scene.meshes, time, shutter).map_err(invalid)?;
            rig.light(&mut scene.lights, time);
        }
        Ok(scene)
    }

    /// The corners of a triangle as they are at a time, seconds; none where there is no such triangle.
    pub fn corners(&self, mesh: usize, triangle: usize, time: f32) -> Option<[Vec3; 3]> {
        let there = self.scene.meshes.get(mesh).filter(|mesh| triangle < mesh.triangles.len())?;
        let moved = self.rigs.iter().find_map(|rig| rig.corners(mesh, triangle, time));
        Some(moved.unwrap_or_else(|| there.corners(triangle)))
    }

    /// Moves the scene's lights, or such as stand for them, to where animations have them at a time, seconds.
    pub fn light(&self, lights: &mut [Light], time: f32) {
        self.rigs.iter().for_each(|rig| rig.light(lights, time));
    }
}

impl Scene {
    /// Puts another scene into this one, moved by `place`. Environment and medium stay what they are here;
    /// cameras of the other are left out.
    pub fn add(&mut self, other: Self, place: Mat4) {
        let (materials, textures) = (self.materials.len() as u32, self.textures.len() as u32);
        let moved = |texture: TextureId| TextureId(texture.0 + textures);
        self.textures.extend(other.textures);
        self.warnings.extend(other.warnings);
        self.materials.extend(other.materials.into_iter().map(|mut material| {
            let normal = material.normal_texture.as_mut().map(|(slot, _)| slot);
            let slots = [
                material.base_colour_texture.as_mut(),
                material.metallic_roughness_texture.as_mut(),
                material.emission_texture.as_mut(),
                normal,
            ];
            slots.into_iter().flatten().for_each(|slot| slot.texture = moved(slot.texture));
            material
        }));
        for mesh in &other.meshes {
            let mut mesh = gltf::moved(mesh, place);
            mesh.material.0 += materials;
            self.meshes.push(mesh);
        }
        self.lights.extend(other.lights.into_iter().map(|light| light_at(light, place, moved)));
    }
}

/// A light moved with its scene; its power stays.
fn light_at(light: Light, place: Mat4, picture: impl Fn(TextureId) -> TextureId) -> Light {
    let turned = |direction: Vec3| (Mat3::from_mat4(place) * direction).normalize_or(direction);
    let mut light = light.moved(|at| place.transform_point3(at), turned);
    match &mut light {
        Light::Spot { slide: Some(texture), .. } | Light::Directional { pattern: Some((texture, _)), .. } => {
            *texture = picture(*texture);
        }
        _ => {}
    }
    light
}
