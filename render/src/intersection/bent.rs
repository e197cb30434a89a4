//! Shading normals in which a viewer is mirrored above the surface.
//!
//! A normal map may turn a normal so far that the mirrored viewer lies below the triangle. A mirror then sees
//! the inside of its own surface, which is black, and metals get dark crescents. The mirror direction is
//! lifted to just above the triangle, and the normal is halfway between it and the viewer (Keller et al.,
//! "The Iray Light Transport Simulation and Rendering System", 2017, appendix A.3).

use glam::Vec3;

/// Least cosine of the mirror direction to the triangle's normal, for viewers who see the triangle from no
/// nearer to its plane; others get a little less than their own.
const LEAST_COSINE: f32 = 0.01;

/// Part of the viewer's own cosine that a mirror direction near the triangle's plane gets.
const OF_VIEWER: f32 = 0.9;

/// The unit shading `normal`, or as much of it as leaves the mirror direction of `to_viewer` above the
/// triangle, whose unit normal on the viewer's side is `geometric`.
pub(super) fn mirroring_above(normal: Vec3, geometric: Vec3, to_viewer: Vec3) -> Vec3 {
    let mirrored = normal * (2.0 * normal.dot(to_viewer)) - to_viewer;
    let least = LEAST_COSINE.min(OF_VIEWER * geometric.dot(to_viewer)).max(0.0);
    let cosine = mirrored.dot(geometric);
    if cosine >= least {
        return normal;
    }
    let lifted = (mirrored + geometric * (least - cosine)).normalize_or(geometric);
    (to_viewer + lifted).normalize_or(geometric)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Unit vectors at angles from z, aside from all axes, all around it.
    fn around_z(degrees: [f32; 6]) -> impl Iterator<Item = Vec3> {
        degrees.into_iter().flat_map(|degrees| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            (0..7).map(move |i| {
                let (y, x) = (i as f32 * 0.9 + 0.2).sin_cos();
                Vec3::new(sin * x, sin * y, cos)
            })
        })
    }

    fn mirrored(normal: Vec3, to_viewer: Vec3) -> Vec3 {
        normal * (2.0 * normal.dot(to_viewer)) - to_viewer
    }

    #[test]
    fn no_viewer_is_mirrored_below_the_triangle_and_good_normals_stay() {
        let (mut bent, mut kept) = (0, 0);
        for normal in around_z([0.0, 12.0, 33.0, 51.0, 70.0, 88.0]) {
            for viewer in around_z([1.0, 20.0, 45.0, 65.0, 80.0, 89.5]) {
                if normal.dot(viewer) <= 1e-3 {
                    continue;
                }
                let before = mirrored(normal, viewer).z;
                let found = mirroring_above(normal, Vec3::Z, viewer);
                let after = mirrored(found, viewer).z;
                assert!(after > 0.0, "normal {normal}, viewer {viewer}: {before} became {after}");
                assert!((found.length() - 1.0).abs() < 1e-6 && found.dot(viewer) > 0.0);
                if before >= LEAST_COSINE {
                    assert_eq!(found, normal);
                    kept += 1;
                } else if before < 0.0 {
                    assert_ne!(found, normal);
                    bent += 1;
                }
            }
        }
        assert!(bent > 100 && kept > 100, "{bent} bent, {kept} kept");
    }

    #[test]
    fn a_normal_is_bent_no_farther_than_to_the_plane() {
        // A viewer at 50 degrees and a normal at 39 on the other side: mirrored at 128 degrees from z.
        let at = |degrees: f32| Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let found = mirroring_above(at(-39.0), Vec3::Z, at(50.0));
        let mirror = mirrored(found, at(50.0));
        assert!(mirror.x < 0.0 && (LEAST_COSINE..1.5 * LEAST_COSINE).contains(&mirror.z), "{mirror}");
        assert_eq!(mirroring_above(Vec3::Z, Vec3::Z, at(50.0)), Vec3::Z);
    }
}
