//! A g-buffer as networks read it, of one that is in another space or unit, or writes its normals in another
//! way.

use super::camera::{self, CameraSource, Candidate, Pose};
use super::contract;
use super::normals::{self, Normals};
use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::Vec3;

/// Attributes that are lengths.
const LENGTHS: [Attribute; 5] = [
    Attribute::Position,
    Attribute::Depth,
    Attribute::FocalDistance,
    Attribute::Blurriness,
    Attribute::MeanFreePath,
];

/// How positions, normals and depth of a file are to be taken.
#[derive(clap::Args, Clone, Debug)]
pub struct Args {
    /// Space of positions and normals. World space is brought to that of the camera by the file's attribute
    /// `worldToCamera`, or by --camera.
    #[arg(long, value_enum, default_value_t = Space::Camera)]
    space: Space,
    /// Camera of a g-buffer in world space: a scene file, maybe with a camera's name (scene.glb:Camera), or
    /// a text file with the 16 numbers, row by row, of the matrix that brings camera space to world space.
    #[arg(long, value_name = "FILE[:NAME]")]
    camera: Option<CameraSource>,
    /// Which way the camera looks.
    #[arg(long, value_enum, default_value_t = Forward::MinusZ, allow_hyphen_values = true)]
    forward: Forward,
    /// Which way is up.
    #[arg(long, value_enum, default_value_t = Up::Y, allow_hyphen_values = true)]
    up: Up,
    /// How normals are written; several words with commas between them.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "signed")]
    normals: Vec<Normals>,
    /// Which sign depth has before the camera.
    #[arg(long, value_enum, default_value_t = DepthSign::Positive)]
    depth: DepthSign,
    /// Metres of a unit of length: 0.001 where the file is in millimetres.
    #[arg(long, value_name = "METRES", default_value_t = 1.0, value_parser = crate::arguments::positive)]
    metres_per_unit: f32,
}

/// Where positions and normals are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Space {
    /// From the camera.
    Camera,
    /// From the scene's origin, y or z up.
    World,
}

/// Which way a camera looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Forward {
    /// Down its -z, as here, in OpenGL and Blender.
    #[value(name = "-z")]
    MinusZ,
    /// Down its z, as in Direct3D and OpenCV.
    Z,
}

/// Which way is up for a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Up {
    /// Along its y.
    Y,
    /// Along its -y, as in OpenCV.
    #[value(name = "-y")]
    MinusY,
}

/// Which sign depth has before the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DepthSign {
    /// That of a distance.
    Positive,
    /// That of z in camera space.
    Negative,
}

impl Args {
    /// Refuses options that contradict each other.
    ///
    /// # Errors
    /// If some do.
    pub fn check(&self) -> Result<()> {
        let both = [Normals::Signed, Normals::Unsigned].iter().all(|kind| self.normals.contains(kind));
        ensure!(!both, "--normals: signed and unsigned at once");
        ensure!(self.camera.is_none() || self.space == Space::World, "--camera is for --space world");
        Ok(())
    }

    /// Refuses an option that touches nothing of what the network reads.
    ///
    /// # Errors
    /// If there is one.
    pub fn check_use(&self, read: &[Attribute]) -> Result<()> {
        const POSED: &[Attribute] = &[Attribute::Position, Attribute::Normal];
        let used = [
            ("--space world", POSED, self.space == Space::World),
            ("--forward z", POSED, self.forward == Forward::Z),
            ("--up -y", POSED, self.up == Up::MinusY),
            ("--depth negative", &[Attribute::Depth], self.depth == DepthSign::Negative),
            ("--metres-per-unit", &LENGTHS, self.metres_per_unit != 1.0),
        ];
        let normals = self.normals.iter().filter(|how| **how != Normals::Signed);
        let normals = normals.map(|how| {
            let word = how.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
            (format!("--normals {word}"), how.layers())
        });
        let used = used.into_iter().filter(|(.., is_used)| *is_used);
        let used = used.map(|(option, layers, _)| (option.to_owned(), layers)).chain(normals);
        let names = |layers: &[Attribute]| {
            layers.iter().map(|layer| format!("`{}`", layer.name())).collect::<Vec<_>>().join(", ")
        };
        for (option, layers) in used {
            ensure!(
                layers.iter().any(|layer| read.contains(layer)),
                "{option} changes {}, of which the network reads nothing: it reads {}",
                names(layers),
                names(read)
            );
        }
        Ok(())
    }

    /// The g-buffer with components of normals from -1 to 1, and with depth that is positive before the
    /// camera.
    #[must_use]
    pub fn with_signs(&self, gbuffer: GBuffer) -> GBuffer {
        let gbuffer =
            if self.normals.contains(&Normals::Unsigned) { normals::signed(gbuffer) } else { gbuffer };
        let depth = gbuffer.first_plane(Attribute::Depth).ok();
        let Some(depth) = depth.filter(|_| self.depth == DepthSign::Negative) else { return gbuffer };
        let mut planes = gbuffer.planes().clone();
        planes.plane_mut(depth).iter_mut().for_each(|value| *value = -*value);
        GBuffer::new(gbuffer.attributes().to_vec(), planes)
    }

    /// The sign of z before the camera in the file; none in world space.
    pub fn sign_before(&self) -> Option<f32> {
        match (self.space, self.forward) {
            (Space::World, _) => None,
            (Space::Camera, Forward::Z) => Some(1.0),
            (Space::Camera, Forward::MinusZ) => Some(-1.0),
        }
    }

    /// A g-buffer that has `valid` as networks read it: in metres and camera space.
    ///
    /// # Errors
    /// If a camera is needed and there is none.
    pub fn converted(&self, gbuffer: GBuffer, attribute: Option<[f32; 16]>) -> Result<GBuffer> {
        let seen = gbuffer.seen()?;
        let gbuffer = self.in_metres(gbuffer);
        let pose = match self.space {
            Space::Camera => None,
            Space::World => Some(self.pose(&gbuffer, &seen, attribute)?),
        };
        let axes = Vec3::new(
            1.0,
            if self.up == Up::MinusY { -1.0 } else { 1.0 },
            if self.forward == Forward::Z { -1.0 } else { 1.0 },
        );
        let at = |at: usize, value: Vec3, turn: &dyn Fn(Vec3) -> Vec3| match seen[at] {
            true => axes * turn(value),
            false => value,
        };
        let point = |value| pose.map_or(value, |pose| pose.point(value));
        let direction = |value| pose.map_or(value, |pose| pose.direction(value));
        let gbuffer = mapped(&gbuffer, Attribute::Position, |pixel, value| at(pixel, value, &point));
        let gbuffer = mapped(&gbuffer, Attribute::Normal, |pixel, value| at(pixel, value, &direction));
        Ok(normals::mended(gbuffer, &self.normals))
    }

    /// The g-buffer with all that is a length in metres.
    fn in_metres(&self, gbuffer: GBuffer) -> GBuffer {
        if self.metres_per_unit == 1.0 {
            return gbuffer;
        }
        let mut planes = gbuffer.planes().clone();
        let mut first = 0;
        for attribute in gbuffer.attributes() {
            for plane in (first..first + attribute.width()).filter(|_| LENGTHS.contains(attribute)) {
                planes.plane_mut(plane).iter_mut().for_each(|value| *value *= self.metres_per_unit);
            }
            first += attribute.width();
        }
        GBuffer::new(gbuffer.attributes().to_vec(), planes)
    }

    /// The pose that brings a world, in metres, to the camera: of those that may be meant, the one that sees
    /// positions where their pixels are.
    fn pose(&self, gbuffer: &GBuffer, seen: &[bool], attribute: Option<[f32; 16]>) -> Result<Pose> {
        let candidates = match (&self.camera, attribute) {
            (Some(source), _) => camera::of_source(source)?,
            (None, Some(attribute)) => camera::of_attribute(attribute),
            (None, None) => Vec::new(),
        };
        let candidates = candidates.into_iter().map(|candidate| self.scaled(candidate));
        let mut best: Option<(f64, Candidate)> = None;
        for candidate in candidates {
            let fit = fit(&candidate.pose, gbuffer, seen)?;
            // Of two that fit alike the first is the more usual.
            if best.as_ref().is_none_or(|(other, _)| fit > other + 0.01) {
                best = Some((fit, candidate));
            }
        }
        let (_, Candidate { name, pose, .. }) = best.context(
            "world space needs a camera: the file has no attribute `worldToCamera`; --camera FILE names one",
        )?;
        note!("world space to camera space by {name}");
        Ok(pose)
    }

    /// A pose in metres.
    fn scaled(&self, mut candidate: Candidate) -> Candidate {
        if candidate.in_file_units {
            candidate.pose.eye *= self.metres_per_unit;
        }
        candidate
    }
}

/// How well a pose sees positions where their pixels are, 0 to 1.
fn fit(pose: &Pose, gbuffer: &GBuffer, seen: &[bool]) -> Result<f64> {
    let Some(positions) = vectors(gbuffer, Attribute::Position) else { return Ok(0.0) };
    let positions: Vec<Vec3> = positions.into_iter().map(|at| pose.point(at)).collect();
    let seen: Vec<usize> = (0..seen.len()).filter(|at| seen[*at]).collect();
    let before = seen.iter().filter(|at| positions[**at].z < 0.0).count() as f64 / seen.len().max(1) as f64;
    let fit = contract::projection(gbuffer.width(), gbuffer.height(), &positions, &seen);
    let fit = fit.filter(|fit| !fit.mirrored && !fit.upside_down);
    Ok(before * fit.map_or(0.0, |fit| fit.explained))
}

/// A vector of every pixel, if the g-buffer has that attribute.
pub fn vectors(gbuffer: &GBuffer, attribute: Attribute) -> Option<Vec<Vec3>> {
    let first = gbuffer.first_plane(attribute).ok()?;
    let [x, y, z] = [0, 1, 2].map(|component| gbuffer.planes().plane(first + component));
    Some((0..x.len()).map(|at| Vec3::new(x[at], y[at], z[at])).collect())
}

/// The g-buffer with other vectors for an attribute, if it has that, each made of its pixel's index and what
/// it was.
pub fn mapped(gbuffer: &GBuffer, attribute: Attribute, map: impl Fn(usize, Vec3) -> Vec3) -> GBuffer {
    let Some(values) = vectors(gbuffer, attribute) else { return gbuffer.clone() };
    let first = gbuffer.first_plane(attribute).unwrap_or_default();
    let mut planes: Planes = gbuffer.planes().clone();
    for (at, value) in values.into_iter().enumerate() {
        let value = map(at, value).to_array();
        (0..3).for_each(|component| planes.plane_mut(first + component)[at] = value[component]);
    }
    GBuffer::new(gbuffer.attributes().to_vec(), planes)
}
