//! Files that both programs understand: PFM images of f32, binary PLY meshes.

use anyhow::{Context, Result, bail};
use deepshade::shared::figures::write_atomically;
use deepshade_render::path::Estimate;
use deepshade_render::scene::Mesh;
use deepshade_shaders::Planes;
use glam::Vec3;
use std::fmt::Write;
use std::path::Path;

/// Writes an RGB image, given row by row from the top, as a portable float map: little-endian, the lowest row
/// first.
///
/// # Errors
/// If the file cannot be written.
pub fn write_pfm(path: &Path, [width, height]: [usize; 2], texels: &[Vec3]) -> Result<()> {
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for row in texels.chunks(width).rev() {
        bytes.extend(row.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
    }
    write_atomically(path, &bytes)
}

/// Reads the first `channels` channels of a portable float map.
///
/// # Errors
/// If the file is missing or is no colour map with little-endian values.
pub fn read_pfm(path: &Path, channels: usize) -> Result<Planes> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let mut lines = bytes.splitn(4, |byte| *byte == b'\n');
    let mut line = || std::str::from_utf8(lines.next().unwrap_or_default()).unwrap_or_default();
    let (kind, size, scale) = (line(), line(), line());
    let size: Vec<usize> = size.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let data = lines.next().unwrap_or_default();
    match (kind, size.as_slice(), scale.trim().parse::<f32>()) {
        ("PF", [width, height], Ok(scale)) if scale < 0.0 && data.len() == width * height * 12 => {
            Ok(Planes::from_fn(channels, *height, *width, |c, y, x| {
                let at = 12 * ((height - 1 - y) * width + x) + 4 * c;
                f32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]])
            }))
        }
        _ => bail!("{}: no little-endian colour PFM of the size that it states", path.display()),
    }
}

/// What Mitsuba rendered into a folder.
///
/// # Errors
/// If it is not there or damaged.
pub fn read_estimate(folder: &Path, channels: usize, samples: u32) -> Result<Estimate> {
    let read = |name: &str| read_pfm(&folder.join(name), channels);
    Ok(Estimate { mean: read("mean.pfm")?, variance: Some(read("variance.pfm")?), samples })
}

/// Writes a mesh as binary PLY: positions, normals where it has any, the first set of texture coordinates as
/// `s`, `t`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_ply(path: &Path, mesh: &Mesh) -> Result<()> {
    let [uvs, _] = &mesh.uvs;
    let mut names = vec!["x", "y", "z"];
    names.extend(["nx", "ny", "nz"].iter().filter(|_| !mesh.normals.is_empty()));
    names.extend(["s", "t"].iter().filter(|_| !uvs.is_empty()));
    let mut head = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    for name in names {
        writeln!(head, "property float {name}")?;
    }
    writeln!(head, "element face {}\nproperty list uchar int vertex_indices", mesh.triangles.len())?;
    let mut bytes = (head + "end_header\n").into_bytes();
    for (vertex, position) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(vertex).map(|normal| normal.to_array());
        let uv = uvs.get(vertex).map(|uv| uv.to_array());
        let values = position.to_array().into_iter().chain(normal.into_iter().flatten());
        bytes.extend(values.chain(uv.into_iter().flatten()).flat_map(f32::to_le_bytes));
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
    }
    write_atomically(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn a_float_map_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("image.pfm");
        // The byte of a line feed inside the values must not end the header.
        let texels: Vec<Vec3> =
            (0..6).map(|i| Vec3::new(i as f32, f32::from_bits(0x0a0a_0a0a), -0.5)).collect();
        write_pfm(&path, [3, 2], &texels).expect("written");
        let image = read_pfm(&path, 3).expect("read");
        assert_eq!((image.at(0, 0, 2), image.at(0, 1, 0), image.at(2, 1, 2)), (2.0, 3.0, -0.5));
        std::fs::write(&path, b"PF\n3 2\n-1.0\nshort").expect("written");
        assert!(read_pfm(&path, 3).is_err());
    }

    #[test]
    fn a_mesh_has_the_properties_that_it_states() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mesh.ply");
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE], vec![]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        write_ply(&path, &mesh).expect("written");
        let bytes = std::fs::read(&path).expect("a file");
        let head = bytes.windows(11).position(|window| window == b"end_header\n").expect("a header") + 11;
        let text = String::from_utf8_lossy(&bytes[..head]).into_owned();
        assert!(text.contains("property float s\nproperty float t\n") && !text.contains("nx"));
        assert_eq!(bytes.len() - head, 3 * 5 * 4 + 13);
        // The second vertex's x, and the last index.
        assert_eq!(bytes[head + 20..head + 24], 1f32.to_le_bytes());
        assert_eq!(bytes[bytes.len() - 4..], 2u32.to_le_bytes());
    }
}
