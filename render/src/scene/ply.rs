//! Polygon files (PLY), text and binary. Source: Turk, "The PLY Polygon File Format", 1994, and the names of
//! properties that programs use by now.
//!
//! Of vertices positions, normals, colours and texture coordinates are read, of faces their corners. All else
//! is passed over; elements that may hold surfaces are named in the scene's warnings. Lengths are taken for
//! metres, y for up. A file has no materials: surfaces are white and rough but for colours of vertices.

use super::finish::finish;
use super::polygon::Cutter;
use super::{Material, MaterialId, Mesh, Scene, SceneError, file, memory};
use deepshade_shaders::colour;
use glam::{Vec2, Vec3, Vec4};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult};
use ply_rs_bw::ply::{PropertyType, ScalarType};
use std::path::Path;

/// What properties of vertices are called, the usual name first.
const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [&["nx"], &["ny"], &["nz"]];
const COLOUR: [&[&str]; 4] = [
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["alpha", "a", "diffuse_alpha"],
];
const UV: [&[&str]; 2] = [&["s", "u", "texture_u"], &["t", "v", "texture_v"]];
/// What the list of a face's corners is called.
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];

/// A vertex or a face, as it is read.
#[derive(Clone, Debug)]
struct Element {
    position: [f32; 3],
    normal: [f32; 3],
    /// As the file has it.
    colour: [f32; 4],
    uv: [f32; 2],
    corners: Vec<u32>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self { position: [0.0; 3], normal: [0.0; 3], colour: [0.0; 4], uv: [0.0; 2], corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if CORNERS.contains(&name) {
            return match property.to_u32_list() {
                Some(corners) => {
                    self.corners = corners;
                    PropertyAccessResult::Set
                }
                None => PropertyAccessResult::UnsupportedType,
            };
        }
        let Self { position, normal, colour, uv, .. } = self;
        let all: [(&[&[&str]], &mut [f32]); 4] =
            [(&POSITION, position), (&NORMAL, normal), (&COLOUR, colour), (&UV, uv)];
        for (names, values) in all {
            if let Some(place) = names.iter().position(|names| names.contains(&name)) {
                return match property.to_f32_lossy() {
                    Some(value) => {
                        values[place] = value;
                        PropertyAccessResult::Set
                    }
                    None => PropertyAccessResult::UnsupportedType,
                };
            }
        }
        PropertyAccessResult::Ignored
    }
}

/// Reads a file.
///
/// # Errors
/// If it is missing or damaged, has no faces, a face has a corner that there is not, or there are more
/// triangles than memory holds.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = file::read(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let most = memory::most_triangles(memory::available());
    let (mesh, warnings) = mesh(&name, &bytes, most).map_err(|what| SceneError::invalid(path, what))?;
    let materials = vec![Material { name: "none".to_owned(), ..Material::default() }];
    let about = |what: String| format!("{}: {what}", path.display());
    let warnings = warnings.into_iter().map(about).collect();
    Ok(Scene { name, meshes: vec![mesh].into(), materials, warnings, ..Scene::default() })
}

/// The mesh of a file's bytes, and what of it was passed over.
fn mesh(name: &str, bytes: &[u8], most: usize) -> Result<(Mesh, Vec<String>), String> {
    if !bytes.starts_with(b"ply") {
        return Err("is no PLY file: it does not begin with `ply`".to_owned());
    }
    let mut source = bytes;
    let ply = Parser::<Element>::new().read_ply(&mut source).map_err(|error| error.to_string())?;
    let none = Vec::new();
    let vertices = ply.payload.get("vertex").unwrap_or(&none);
    let faces = ply.payload.get("face").unwrap_or(&none);
    if faces.is_empty() {
        return Err("has no faces: a cloud of points has no surface".to_owned());
    }
    let triangles = triangles(vertices, faces, most)?;
    let has = |names: &[&[&str]]| names.iter().all(|names| property(&ply.header, names).is_some());
    let of_all = |is_there: bool| if is_there { vertices.as_slice() } else { &[] };
    let (colour_scale, has_alpha) = (colour_scale(&ply.header), has(&COLOUR[3..]));
    let mesh = Mesh {
        name: name.to_owned(),
        material: MaterialId(0),
        positions: vertices.iter().map(|vertex| Vec3::from(vertex.position)).collect(),
        normals: of_all(has(&NORMAL)).iter().map(|vertex| Vec3::from(vertex.normal)).collect(),
        colours: of_all(has(&COLOUR[..3]))
            .iter()
            .map(|vertex| linear(vertex.colour, colour_scale, has_alpha))
            .collect(),
        uvs: [
            of_all(has(&UV)).iter().map(|vertex| Vec2::new(vertex.uv[0], 1.0 - vertex.uv[1])).collect(),
            Vec::new(),
        ],
        triangles,
        ..Mesh::default()
    };
    Ok((finish(mesh)?, passed_over(&ply.header)))
}

/// The triangles of faces, as the indices of vertices.
fn triangles(vertices: &[Element], faces: &[Element], most: usize) -> Result<Vec<[u32; 3]>, String> {
    let mut triangles = Vec::new();
    let (mut cutter, mut positions) = (Cutter::new(), Vec::new());
    for (number, face) in faces.iter().enumerate() {
        positions.clear();
        for corner in &face.corners {
            let vertex = vertices.get(*corner as usize).ok_or_else(|| {
                format!("face {number} has the vertex {corner}, and there are {}", vertices.len())
            })?;
            positions.push(Vec3::from(vertex.position));
        }
        if positions.len() >= 3 {
            let of_face = cutter.triangles(&positions);
            triangles.extend(of_face.map(|triangle| triangle.map(|corner| face.corners[corner as usize])));
        }
        if triangles.len() > most {
            return Err(format!("has more triangles than the {most} that memory holds"));
        }
    }
    Ok(triangles)
}

/// A property of vertices by its names.
fn property<'a>(header: &'a Header, names: &[&str]) -> Option<&'a PropertyType> {
    let vertex: &ElementDef = header.elements.get("vertex")?;
    names.iter().find_map(|name| vertex.properties.get(*name)).map(|property| &property.data_type)
}

/// What colours are multiplied by, to be 0 to 1: whole numbers count to the greatest of their type.
fn colour_scale(header: &Header) -> f32 {
    match property(header, COLOUR[0]) {
        Some(PropertyType::Scalar(ScalarType::UChar | ScalarType::Char)) => 1.0 / 255.0,
        Some(PropertyType::Scalar(ScalarType::UShort | ScalarType::Short)) => 1.0 / 65535.0,
        _ => 1.0,
    }
}

/// The linear colour of a vertex, whose alpha is 1 where the file has none. Files hold them as sRGB, by the
/// use of the programs that write them.
fn linear([red, green, blue, alpha]: [f32; 4], scale: f32, has_alpha: bool) -> Vec4 {
    let within = |value: f32| (value * scale).clamp(0.0, 1.0);
    let [red, green, blue] = [red, green, blue].map(|value| colour::srgb_decoded(within(value)));
    Vec4::new(red, green, blue, if has_alpha { within(alpha) } else { 1.0 })
}

/// Elements that may hold surfaces and are not read.
fn passed_over(header: &Header) -> Vec<String> {
    let names = ["tristrips", "material", "multi_texture_face"];
    let held = names.into_iter().filter(|name| header.elements.contains_key(*name));
    held.map(|name| format!("its element `{name}` is passed over")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Mesh, Vec<String>), String> {
        mesh("square", text.as_bytes(), 99)
    }

    const HEAD: &str = "ply\nformat ascii 1.0\n";
    const FACES: &str = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

    /// A square of four vertices, with more properties, and values of these.
    fn square(properties: &str, values: [&str; 4]) -> String {
        let places = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
        let rows: String =
            places.iter().zip(values).map(|(place, value)| format!("{place} {value}\n")).collect();
        let xyz = "property float x\nproperty float y\nproperty float z\n";
        format!("{HEAD}element vertex 4\n{xyz}{properties}{FACES}{rows}4 0 1 2 3\n")
    }

    #[test]
    fn polygons_are_cut_into_triangles() {
        let (mesh, warnings) = read(&square("", [""; 4])).expect("a square");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((mesh.positions[2], warnings.len()), (Vec3::new(1.0, 1.0, 0.0), 0));
        assert!(mesh.normals.is_empty() && mesh.colours.is_empty() && mesh.uvs[0].is_empty());
    }

    #[test]
    fn normals_colours_and_coordinates_are_read_by_their_usual_names() {
        let properties = "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n\
                          property uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n";
        let values = ["0 0 2 255 0 188 0.25 1", "0 0 1 0 0 0 0 0", "0 0 1 0 0 0 0 0", "0 0 1 0 0 0 0 0"];
        let (mesh, _) = read(&square(properties, values)).expect("a square");
        assert_eq!((mesh.normals[0], mesh.uvs[0][0]), (Vec3::Z, Vec2::new(0.25, 0.0)));
        let expected = Vec4::new(1.0, 0.0, 0.502, 1.0);
        assert!((mesh.colours[0] - expected).abs().max_element() < 5e-3, "{}", mesh.colours[0]);
    }

    #[test]
    fn colours_of_floats_are_taken_as_they_are() {
        let properties = "property float r\nproperty float g\nproperty float b\nproperty float a\n";
        let (mesh, _) =
            read(&square(properties, ["1 0 1 0.5", "0 0 0 1", "0 0 0 1", "0 0 0 1"])).expect("it");
        assert_eq!(mesh.colours[0], Vec4::new(1.0, 0.0, 1.0, 0.5));
        let bytes = properties.replace("float", "uchar");
        let (mesh, _) =
            read(&square(&bytes, ["255 0 255 1", "0 0 0 255", "0 0 0 0", "0 0 0 0"])).expect("it");
        assert_eq!([0, 1].map(|vertex: usize| mesh.colours[vertex].w), [1.0 / 255.0, 1.0]);
    }

    #[test]
    fn binary_files_of_both_orders_are_the_same_mesh() {
        let (expected, _) = read(&square("", [""; 4])).expect("text");
        for (order, is_little) in [("little", true), ("big", false)] {
            let head = format!("ply\nformat binary_{order}_endian 1.0\n");
            let mut bytes = square("", [""; 4]).replace(HEAD, &head).into_bytes();
            let end =
                String::from_utf8_lossy(&bytes).find("end_header\n").expect("it") + "end_header\n".len();
            bytes.truncate(end);
            for value in expected.positions.iter().flat_map(|position| position.to_array()) {
                bytes.extend(if is_little { value.to_le_bytes() } else { value.to_be_bytes() });
            }
            bytes.push(4);
            for corner in 0i32..4 {
                bytes.extend(if is_little { corner.to_le_bytes() } else { corner.to_be_bytes() });
            }
            let (mesh, _) = mesh("square", &bytes, 99).expect("binary");
            assert_eq!(
                (mesh.positions, mesh.triangles),
                (expected.positions.clone(), expected.triangles.clone())
            );
        }
    }

    #[test]
    fn what_has_no_surface_or_is_damaged_is_refused() {
        let refused = |text: &str| read(text).expect_err("refused");
        let cloud = format!("{HEAD}element vertex 1\nproperty float x\nend_header\n0\n");
        assert!(refused(&cloud).contains("no faces"));
        assert!(refused(&square("", [""; 4]).replace("4 0 1 2 3", "3 0 1 7")).contains("the vertex 7"));
        assert!(refused(&square("", [""; 4]).replace("4 0 1 2 3", "3 0 1 -1")).contains("vertex_indices"));
        refused("ply\nformat ascii 1.0\nelement vertex 3\n");
        assert!(refused("solid cube").contains("is no PLY file"));
        refused(&square("", [""; 4]).replace("1 1 0 \n", ""));
        assert!(mesh("square", square("", [""; 4]).as_bytes(), 1).is_err_and(|what| what.contains("memory")));
        let far = refused(&square("", [""; 4]).replace("1 1 0", "1 1e99 0"));
        assert!(far.contains("not finite"), "{far}");
    }

    #[test]
    fn what_is_passed_over_is_said() {
        let strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
        let text = square("", [""; 4]).replace("end_header\n", strips) + "3 0 1 2\n";
        let (_, warnings) = read(&text).expect("a square");
        assert_eq!(warnings, ["its element `tristrips` is passed over"]);
    }
}
