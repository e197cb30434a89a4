//! The rotation that takes one list of unit vectors to another as well as any can.

use glam::{DMat4, DVec4, Vec3};

/// How often a matrix is squared, by which the largest eigenvalue outgrows all others.
const SQUARED: u32 = 16;

/// A rotation of all vectors.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// By how much, degrees.
    pub degrees: f32,
    /// The mean cosine between the vectors of each pair once the first are turned.
    pub mean_cosine: f32,
}

/// The rotation that brings the first of each pair nearest to the second (Horn 1987, "Closed-form Solution of
/// Absolute Orientation Using Unit Quaternions"): the eigenvector of the largest eigenvalue of a matrix of
/// sums of products. None of no pairs.
pub fn nearest(pairs: &[(Vec3, Vec3)]) -> Option<Rotation> {
    if pairs.is_empty() {
        return None;
    }
    let sums: DMat4 = pairs.iter().map(|(from, to)| products(*from, *to)).sum();
    let matrix = sums * (1.0 / pairs.len() as f64);
    // No eigenvalue is below -1; from here on none is below 0.
    let power = (0..SQUARED).fold(matrix + DMat4::IDENTITY, |power, _| {
        let squared = power * power;
        squared * (1.0 / squared.to_cols_array().iter().fold(0.0, |most: f64, one| most.max(one.abs())))
    });
    let columns = [power.x_axis, power.y_axis, power.z_axis, power.w_axis];
    let quaternion = columns.into_iter().max_by(|a, b| a.length().total_cmp(&b.length()))?.try_normalize()?;
    Some(Rotation {
        degrees: (2.0 * quaternion.x.abs().min(1.0).acos()).to_degrees() as f32,
        mean_cosine: quaternion.dot(matrix * quaternion) as f32,
    })
}

/// Horn's matrix of one pair; quaternions have their real part first.
fn products(from: Vec3, to: Vec3) -> DMat4 {
    let (a, b) = (from.as_dvec3(), to.as_dvec3());
    let cross = a.cross(b);
    let [xy, yz, zx] = [a.x * b.y + a.y * b.x, a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z];
    let [x, y, z] = (a * b).to_array();
    DMat4::from_cols(
        DVec4::new(x + y + z, cross.x, cross.y, cross.z),
        DVec4::new(cross.x, x - y - z, xy, zx),
        DVec4::new(cross.y, xy, y - x - z, yz),
        DVec4::new(cross.z, zx, yz, z - x - y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_rotation_is_found_again() {
        let vectors = [Vec3::X, Vec3::new(0.3, 0.9, -0.4), Vec3::new(-0.5, 0.2, 0.7)].map(Vec3::normalize);
        for degrees in [0.0f32, 8.0, 75.0, 170.0] {
            let turn = Quat::from_axis_angle(Vec3::new(1.0, -2.0, 0.5).normalize(), degrees.to_radians());
            let found = nearest(&vectors.map(|vector| (vector, turn * vector))).expect("pairs");
            assert!((found.degrees - degrees).abs() < 0.05 && found.mean_cosine > 0.9999, "{found:?}");
        }
        let mirrored = nearest(&vectors.map(|vector| (vector, -vector))).expect("pairs");
        assert!(mirrored.mean_cosine < 0.9, "{mirrored:?}");
        assert!(nearest(&[]).is_none());
    }
}
