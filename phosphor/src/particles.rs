//! Particles whose paths are known, of a simulation for example: as a glTF file with a small octahedron a
//! particle, each on a joint of its own, so that they are moved, lit, traced and, where their material keeps
//! light, remembered like any mesh (thesis, Figure 8.17: each particle keeps track of its excitation).

use crate::table::{Table, TableError};
use deepshade_shaders::random::random;
use glam::Vec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Where particles are, each at moments of its own: seconds and metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracks(Vec<Vec<(f32, Vec3)>>);

/// A path's moments a second, of a fountain.
const RATE: f32 = 60.0;
/// How much of its speed a drop keeps where it meets the floor.
const KEPT: f32 = 0.45;

impl Tracks {
    /// Reads a table with the columns `particle`, `time`, `x`, `y` and `z`; rows may be in any order.
    ///
    /// # Errors
    /// If it is no such table, or a particle is at two places at a time.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let table = Table::read(path)?;
        let [x, y, z] = ["x", "y", "z"].map(|name| table.column(name));
        let (particles, times) = (table.column("particle")?, table.not_negative("time")?);
        let places =
            x?.into_iter().zip(y?).zip(z?).map(|((x, y), z)| Vec3::new(x as f32, y as f32, z as f32));
        let places: Vec<Vec3> = places.collect();
        if let Some(row) = places.iter().position(|place| !place.is_finite()) {
            return Err(table.says(format!("has a place in row {} that is too far away", row + 1)));
        }
        let mut tracks: BTreeMap<u64, Vec<(f32, Vec3)>> = BTreeMap::new();
        for ((particle, time), place) in particles.into_iter().zip(times).zip(places) {
            tracks.entry(particle.to_bits()).or_default().push((time as f32, place));
        }
        for track in tracks.values_mut() {
            track.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let Some(twice) = track.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                return Err(table.says(format!("has a particle twice at {} seconds", twice[0].0)));
            }
        }
        Ok(Self(tracks.into_values().collect()))
    }

    /// Drops of a fountain at the origin that rises about a metre and a half and whose drops bounce off the
    /// floor, for `seconds`.
    pub fn fountain(drops: usize, seconds: f32, seed: u32) -> Self {
        let drop = |index: usize| {
            let number = |which: u32| random(index as u32, 0, seed, which);
            let begin = 0.7 * seconds * index as f32 / drops as f32;
            let (turn, aslant) = (std::f32::consts::TAU * number(0), 0.2 + 0.8 * number(1));
            let mut speed = Vec3::new(aslant * turn.cos(), 4.5 + 1.2 * number(2), aslant * turn.sin());
            let (mut place, step) = (Vec3::ZERO, 1.0 / RATE);
            let mut track = vec![(begin, place)];
            for frame in 1..=((seconds - begin) * RATE) as u32 {
                speed.y -= 9.81 * step;
                place += speed * step;
                if place.y < 0.0 {
                    (place.y, speed) = (-place.y, speed * Vec3::new(0.8, -KEPT, 0.8));
                }
                track.push((begin + frame as f32 * step, place));
            }
            track
        };
        Self((0..drops).map(drop).collect())
    }

    /// At how many moments places of particles are known, of all together.
    pub fn moments(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// A binary glTF file of octahedra whose corners are `radius` metres from the particles, of one matte
    /// white material of that name. Between its moments a particle moves evenly; before the first and after
    /// the last it stays.
    pub fn glb(&self, radius: f32, material: &str) -> Vec<u8> {
        let mut file = Contents::default();
        let corners = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        let all = |corner: &dyn Fn(Vec3) -> Vec3| -> Vec<f32> {
            (0..self.count()).flat_map(|_| corners).flat_map(|at| corner(at).to_array()).collect()
        };
        let positions = file.floats("VEC3", 3, &all(&|at| at * radius), Some(radius));
        let normals = file.floats("VEC3", 3, &all(&|at| at), None);
        let joints: Vec<u16> =
            (0..self.count()).flat_map(|particle| [[particle as u16, 0, 0, 0]; 6]).flatten().collect();
        let joints = file.accessor("VEC4", 5123, joints.len() / 4, bytemuck::cast_slice(&joints));
        let weights = file.floats("VEC4", 4, &[1.0, 0.0, 0.0, 0.0].repeat(6 * self.count()), None);
        let indices: Vec<u32> =
            (0..self.count() as u32).flat_map(|i| FACES.map(|corner| 6 * i + corner)).collect();
        let indices = file.accessor("SCALAR", 5125, indices.len(), bytemuck::cast_slice(&indices));
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for (particle, track) in self.0.iter().enumerate() {
            let times: Vec<f32> = track.iter().map(|(time, _)| *time).collect();
            let places: Vec<f32> = track.iter().flat_map(|(_, place)| place.to_array()).collect();
            let (input, output) = (file.times(&times), file.floats("VEC3", 3, &places, None));
            channels
                .push(json!({ "sampler": particle, "target": { "node": particle, "path": "translation" } }));
            samplers.push(json!({ "input": input, "output": output }));
        }
        let nodes = self.0.iter().map(|track| json!({ "translation": track[0].1.to_array() }));
        let particles = json!({ "mesh": 0, "skin": 0, "name": "particles" });
        let count = self.count();
        let attributes =
            json!({ "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights });
        let text = json!({
            "asset": { "version": "2.0", "generator": "deepshade" },
            "scene": 0,
            "scenes": [{ "nodes": (0..=count).collect::<Vec<_>>() }],
            "nodes": nodes.chain([particles]).collect::<Vec<_>>(),
            "skins": [{ "joints": (0..count).collect::<Vec<_>>() }],
            "materials": [{ "name": material, "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 } }],
            "meshes": [{ "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
            "animations": [{ "samplers": samplers, "channels": channels }],
            "accessors": file.accessors,
            "bufferViews": file.views,
            "buffers": [{ "byteLength": file.bytes.len() }],
        });
        container(text.to_string().into_bytes(), file.bytes)
    }
}

/// Corners of an octahedron's faces, seen from outside.
const FACES: [u32; 24] = [0, 2, 4, 4, 2, 1, 1, 2, 5, 5, 2, 0, 4, 3, 0, 1, 3, 4, 5, 3, 1, 0, 3, 5];

/// What a glTF file says of its bytes, and these.
#[derive(Default)]
struct Contents {
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: Vec<u8>,
}

impl Contents {
    /// Adds an accessor of so many elements and returns its index.
    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    /// Numbers in elements of `width`; all between the extent and its negative, where that must be said.
    fn floats(&mut self, kind: &str, width: usize, numbers: &[f32], extent: Option<f32>) -> usize {
        let index = self.accessor(kind, 5126, numbers.len() / width, bytemuck::cast_slice(numbers));
        if let Some(extent) = extent {
            self.accessors[index]["min"] = json!(vec![-extent; width]);
            self.accessors[index]["max"] = json!(vec![extent; width]);
        }
        index
    }

    /// Moments in their order.
    fn times(&mut self, times: &[f32]) -> usize {
        let index = self.floats("SCALAR", 1, times, None);
        self.accessors[index]["min"] = json!([times[0]]);
        self.accessors[index]["max"] = json!([times[times.len() - 1]]);
        index
    }
}

/// A binary glTF file: its header, its text and its bytes (glTF 2.0, section 4.4).
fn container(mut text: Vec<u8>, bytes: Vec<u8>) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let words = |words: [u32; 3]| words.into_iter().flat_map(u32::to_le_bytes);
    let length = (12 + 8 + text.len() + 8 + bytes.len()) as u32;
    let mut file: Vec<u8> = words([u32::from_le_bytes(*b"glTF"), 2, length]).collect();
    for (kind, chunk) in [(*b"JSON", text), (*b"BIN\0", bytes)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Tracks, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("tracks.csv");
        std::fs::write(&path, text).expect("written");
        Tracks::read(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_no_table_of_tracks_is_said() {
        let twice = read("particle,time,x,y,z\n1,0,0,0,0\n1,0,0,0,1\n").expect_err("at two places");
        assert!(twice.ends_with("has a particle twice at 0 seconds"), "{twice}");
        assert!(read("particle,time,x,y\n1,0,0,0\n").expect_err("no z").contains("no column z"));
        let far = read("particle,time,x,y,z\n1,0,0,0,0\n1,1,1e39,0,0\n").expect_err("infinite");
        assert!(far.ends_with("has a place in row 2 that is too far away"), "{far}");
    }

    #[test]
    fn drops_stay_above_the_floor_and_fall_as_they_must() {
        let fountain = Tracks::fountain(40, 3.0, 1);
        assert_eq!((fountain.count(), &fountain), (40, &Tracks::fountain(40, 3.0, 1)));
        assert!(fountain != Tracks::fountain(40, 3.0, 2));
        for track in &fountain.0 {
            assert!(track.iter().all(|(_, place)| (0.0..2.0).contains(&place.y)));
            let [a, b, c] = [5, 6, 7].map(|frame| track[frame].1.y);
            assert!((a - 2.0 * b + c + 9.81 / (RATE * RATE)).abs() < 1e-5, "gravity");
        }
    }
}
