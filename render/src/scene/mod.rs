//! Scenes: triangles in world space with materials, textures, lights and cameras, from files or from seeds.

pub mod animated;
pub mod box_mapping;
pub mod camera;
pub mod coat;
mod decode;
pub mod environment;
mod file;
mod finish;
pub mod glow;
pub mod gltf;
pub mod light;
pub mod look;
pub mod material;
pub mod medium;
pub(crate) mod memory;
pub mod mesh;
mod mesh_list;
mod naming;
pub mod obj;
pub mod ply;
mod polygon;
pub mod procedural;
pub mod source;
pub mod summary;
pub mod texture;
pub mod transmission;

pub use animated::AnimatedScene;
pub use camera::{Camera, Lens};
pub(crate) use environment::Cumulative;
pub use environment::Environment;
pub use glow::Glow;
pub use light::Light;
pub use look::Look;
pub use material::{AlphaMode, Gloss, Material, Surface, TextureSlot};
pub use medium::{Density, DensityGrid, Medium};
pub use mesh::{Bounds, Mesh};
pub use mesh_list::Meshes;
pub use source::SceneSource;
pub use summary::SceneSummary;
pub use texture::{Encoding, Filter, Texture, Wrap};

use deepshade_shaders::names::did_you_mean;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// Index into [`Scene::textures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// Everything light can meet, at one moment of time, flattened to world space.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What the scene is called in tables and file names.
    pub name: String,
    /// Triangle meshes in world space; an object placed twice is two meshes. Copies of the scene share them.
    pub meshes: Meshes,
    /// Materials; never empty where there is a mesh.
    pub materials: Vec<Material>,
    /// Textures of the materials.
    pub textures: Vec<Arc<Texture>>,
    /// Lights other than emissive triangles.
    pub lights: Vec<Light>,
    /// What shines from infinitely far away, where nothing else is.
    pub environment: Option<Arc<Environment>>,
    /// What fills the space between surfaces.
    pub medium: Option<Arc<Medium>>,
    /// Which surfaces keep light, and when lamps shine; see [`Glow::of`].
    pub glow: Option<Arc<Glow>>,
    /// Cameras that the file brings, with their names.
    pub cameras: Vec<(String, Camera)>,
    /// What of the file was passed over or put right, each a sentence that names the file and the line or the
    /// thing.
    pub warnings: Vec<String>,
}

/// Why a scene could not be had; each names the file and the thing in it.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The file, or one that it refers to, could not be read.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is damaged or uses what is not supported.
    #[error("{path}: {what}")]
    Invalid {
        /// Which file.
        path: PathBuf,
        /// What is wrong, with the mesh, material, texture or accessor named.
        what: String,
    },
    /// The scene has no triangle with an area.
    #[error("scene `{name}` has no triangle with an area")]
    Empty {
        /// Which scene.
        name: String,
    },
    /// There are more triangles than memory holds.
    #[error("scene `{name}` has {triangles} triangles; the memory that is available here holds {most}")]
    Memory {
        /// Which scene.
        name: String,
        /// How many it has.
        triangles: usize,
        /// How many would fit.
        most: usize,
    },
    /// The ending says neither glTF nor OBJ nor PLY.
    #[error("{path}: not a scene file that is known here (.gltf, .glb, .obj, .ply)")]
    UnknownFormat {
        /// Which file.
        path: PathBuf,
    },
    /// Neither a scene file nor a seed of a family.
    #[error(
        "`{text}` is neither a scene file (.gltf, .glb, .obj, .ply) nor a family and a seed such as \
         `stairs:7`"
    )]
    UnknownSource {
        /// What was asked for.
        text: String,
    },
    /// No procedural family of that name.
    #[error("no procedural family `{name}`{}; there are {known}", did_you_mean(name, known.split(", ")))]
    UnknownFamily {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
}

impl SceneError {
    /// [`SceneError::Invalid`] of a file.
    pub fn invalid(path: &Path, what: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), what: what.into() }
    }
}

impl Scene {
    /// Reads a glTF 2.0 (.gltf, .glb), Wavefront (.obj) or polygon (.ply) file, with animations, skins and
    /// morph targets at `time` seconds.
    ///
    /// # Errors
    /// If a file is missing, damaged or unsupported, or holds no triangle with an area.
    pub fn load(path: &Path, time: f32) -> Result<Self, SceneError> {
        Self::load_moving(path, time, 0.0)
    }

    /// [`Scene::load`] with what moves while the shutter is open: `shutter` seconds, around `time`. Vertices
    /// move on straight lines between where they are at the beginning and at the end, seen from where they
    /// are in the middle; meshes that stay are those of [`Scene::load`].
    ///
    /// # Errors
    /// Those of [`Scene::load`], and if the shutter is not a time.
    pub fn load_moving(path: &Path, time: f32, shutter: f32) -> Result<Self, SceneError> {
        if !(shutter.is_finite() && shutter >= 0.0) {
            return Err(SceneError::invalid(path, format!("cannot be exposed for {shutter} seconds")));
        }
        let mut scene = match ending(path).as_str() {
            "gltf" | "glb" => gltf::load(path, time, shutter)?,
            "obj" => obj::load(path)?,
            "ply" => ply::load(path)?,
            _ => return Err(SceneError::UnknownFormat { path: path.to_owned() }),
        };
        scene.drop_degenerate_triangles();
        if scene.triangle_count() == 0 {
            return Err(SceneError::Empty { name: scene.name });
        }
        Ok(scene)
    }

    /// When the animation that [`Scene::load`] poses a file by begins and ends, seconds; `None` where nothing
    /// is animated.
    ///
    /// # Errors
    /// If a file is missing or damaged.
    pub fn animation_span(path: &Path) -> Result<Option<[f32; 2]>, SceneError> {
        match ending(path).as_str() {
            "gltf" | "glb" => gltf::animation_span(path),
            _ => Ok(None),
        }
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.triangles.len()).sum()
    }

    /// The box around all vertices that a triangle uses.
    pub fn bounds(&self) -> Bounds {
        self.meshes.iter().fold(Bounds::EMPTY, |bounds, mesh| bounds.union(mesh.bounds()))
    }

    /// The box around the ways of all vertices that a triangle uses, while the shutter is open.
    pub fn swept_bounds(&self) -> Bounds {
        self.meshes.iter().fold(Bounds::EMPTY, |bounds, mesh| bounds.union(mesh.swept_bounds()))
    }

    /// Whether any vertex moves while the shutter is open.
    pub fn moves(&self) -> bool {
        let moves = |mesh: &Mesh| mesh.displacements.iter().any(|way| *way != glam::Vec3::ZERO);
        self.meshes.iter().any(moves)
    }

    /// A material by its index.
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }

    /// Whether any surface emits light by itself.
    pub fn emits(&self) -> bool {
        let is_lit = |slot: TextureSlot| !self.textures[slot.texture.0 as usize].is_black();
        let emits = |material: &Material| {
            material.emission.max_element() > 0.0 && material.emission_texture.is_none_or(is_lit)
        };
        self.meshes.iter().any(|mesh| emits(self.material(mesh.material)))
    }

    /// Whether nothing in the scene shines: no light, no surface that emits, no environment.
    pub fn is_dark(&self) -> bool {
        self.lights.is_empty() && self.environment.is_none() && !self.emits()
    }

    /// Whether any of its surface keeps light.
    pub fn keeps_light(&self) -> bool {
        self.glow.as_deref().is_some_and(|glow| !glow.surfaces.is_empty())
    }

    /// Whether its medium keeps light.
    pub fn medium_keeps_light(&self) -> bool {
        self.medium.is_some() && self.glow.as_deref().is_some_and(|glow| glow.medium.is_some())
    }

    /// Of which lamps light is there at a moment, seconds: all, but for those that a glowing scene has
    /// switched off.
    pub fn shining(&self, moment: f32) -> Vec<bool> {
        let shines = |light| self.glow.as_deref().is_none_or(|glow| glow.shines_at(light, moment));
        (0..self.lights.len()).map(shines).collect()
    }

    /// The lamps that shine at the moment that it shows.
    pub fn shining_lights(&self) -> impl Iterator<Item = &Light> {
        let shines = |light| self.glow.as_deref().is_none_or(|glow| glow.shines(light));
        self.lights.iter().enumerate().filter(move |(light, _)| shines(*light)).map(|(_, light)| light)
    }

    /// The environment, unless a glowing scene has switched it off at the moment that it shows.
    pub fn shining_environment(&self) -> Option<&Environment> {
        let shines = self.glow.as_deref().is_none_or(Glow::sky_shines);
        self.environment.as_deref().filter(|_| shines)
    }

    /// Takes out triangles without an area, which have no normal, and meshes that lose all of theirs.
    fn drop_degenerate_triangles(&mut self) {
        for mesh in &mut self.meshes {
            mesh.drop_degenerate_triangles();
        }
        self.meshes.retain(|mesh| !mesh.triangles.is_empty());
    }
}

/// The ending of a file's name, which says its format, in small letters.
fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}
