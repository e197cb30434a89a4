//! The faces of a run as a triangle mesh.

use super::parse::{Corner, FaceRun, NONE, Obj};
use crate::scene::polygon::{Cutter, area_vector};
use crate::scene::{MaterialId, Mesh};
use deepshade_shaders::colour;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// A mesh of a run's faces. `v` points up in OBJ, down here.
///
/// What only some of the faces have, the others get so that they look as they would alone: flat normals, the
/// first texel, white.
pub(super) fn mesh(obj: &Obj, run: &FaceRun, material: MaterialId) -> Mesh {
    let has = |is_there: fn(&Corner) -> bool| run.corners.iter().any(is_there);
    let is_coloured = |corner: &Corner| colour_of(obj, *corner).is_some();
    let mut builder = Builder {
        obj,
        has_normals: has(|corner| corner.normal != NONE),
        has_uvs: has(|corner| corner.uv != NONE),
        has_colours: !obj.colours.is_empty() && run.corners.iter().any(is_coloured),
        known: HashMap::with_capacity(run.corners.len() / 2),
        mesh: Mesh { name: run.name.clone(), material, ..Mesh::default() },
    };
    let (mut cutter, mut begin, mut places) = (Cutter::new(), 0, Vec::new());
    let mut positions = Vec::new();
    for (face, sides) in run.sides.iter().enumerate() {
        let corners = &run.corners[begin..][..*sides as usize];
        begin += corners.len();
        positions.clear();
        positions.extend(corners.iter().map(|corner| obj.positions[corner.position as usize]));
        places.clear();
        places.extend(corners.iter().map(|corner| builder.vertex(*corner, face, &positions)));
        let triangles = cutter.triangles(&positions);
        builder
            .mesh
            .triangles
            .extend(triangles.map(|triangle| triangle.map(|corner| places[corner as usize])));
    }
    builder.mesh
}

struct Builder<'a> {
    obj: &'a Obj,
    has_normals: bool,
    has_uvs: bool,
    has_colours: bool,
    /// Vertices by what they are of, and by their face where their normal is that of the face.
    known: HashMap<(Corner, usize), u32>,
    mesh: Mesh,
}

impl Builder<'_> {
    /// The vertex of a corner of a face.
    fn vertex(&mut self, corner: Corner, face: usize, positions: &[Vec3]) -> u32 {
        let is_flat = self.has_normals && corner.normal == NONE;
        match self.known.entry((corner, if is_flat { face } else { 0 })) {
            Entry::Occupied(known) => return *known.get(),
            Entry::Vacant(new) => new.insert(self.mesh.positions.len() as u32),
        };
        let (obj, mesh) = (self.obj, &mut self.mesh);
        if self.has_normals {
            // A face without an area has no triangle that is kept.
            let flat = || area_vector(positions).normalize_or_zero().as_vec3();
            mesh.normals.push(obj.normals.get(corner.normal as usize).copied().unwrap_or_else(flat));
        }
        if self.has_uvs {
            let uv = obj.uvs.get(corner.uv as usize).map(|uv| Vec2::new(uv.x, 1.0 - uv.y));
            mesh.uvs[0].push(uv.unwrap_or(Vec2::ZERO));
        }
        if self.has_colours {
            mesh.colours.push(colour_of(obj, corner).unwrap_or(Vec4::ONE));
        }
        mesh.positions.push(obj.positions[corner.position as usize]);
        (mesh.positions.len() - 1) as u32
    }
}

/// The linear colour of a corner's vertex, if it has one. Files hold them as sRGB, by the use of the programs
/// that write them.
fn colour_of(obj: &Obj, corner: Corner) -> Option<Vec4> {
    let colour = obj.colours.get(corner.position as usize).filter(|colour| colour.is_finite())?;
    let linear = colour::srgb_decoded;
    Some(Vec4::new(linear(colour.x), linear(colour.y), linear(colour.z), colour.w))
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::super::warnings::Warnings;
    use super::*;

    const SQUARES: &str = "v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0.25\nvn 1 0 0\n";

    fn first(faces: &str) -> Mesh {
        let obj = parse(&format!("{SQUARES}{faces}"), 99, &mut Warnings::default()).expect("a file");
        mesh(&obj, &obj.runs[0], MaterialId(0))
    }

    #[test]
    fn corners_with_the_same_attributes_are_one_vertex() {
        let mesh = first("f 2 3 4\nf 4 3 2\nf 2/1 3/1 4/1\n");
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 0], [3, 4, 5]]);
    }

    #[test]
    fn a_face_without_normals_is_flat_among_faces_that_have_them() {
        let mesh = first("f 2//1 3//1 4//1\nf 2 3 4\nf 4 3 2\n");
        assert_eq!(
            mesh.normals,
            [Vec3::X, Vec3::X, Vec3::X, Vec3::Z, Vec3::Z, Vec3::Z, -Vec3::Z, -Vec3::Z, -Vec3::Z]
        );
        assert!(first("f 2 3 4\n").normals.is_empty());
    }

    #[test]
    fn a_face_without_coordinates_is_of_the_first_texel_among_faces_that_have_them() {
        let mesh = first("f 2/1 3/1 4/1\nf 2 3 4\n");
        assert_eq!(
            mesh.uvs[0][..4],
            [Vec2::new(0.5, 0.75), Vec2::new(0.5, 0.75), Vec2::new(0.5, 0.75), Vec2::ZERO]
        );
        assert!(first("f 2 3 4\n").uvs[0].is_empty());
    }

    #[test]
    fn a_vertex_without_a_colour_is_white_among_those_that_have_one() {
        let mesh = first("f 1 2 3\n");
        assert_eq!(mesh.colours, [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::ONE, Vec4::ONE]);
        assert!(first("f 2 3 4\n").colours.is_empty());
    }
}
