//! Contradictions in words, with the option that mends each.

use super::{Contradiction, DepthKind};
use deepshade_shaders::Attribute;
use std::fmt;

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f32| (100.0 * share).round();
        match *self {
            Self::LooksForward(share) => write!(
                f,
                "{} % of what is seen has a positive z, which is behind the camera: it looks like a camera \
                 that looks down +z (--forward z)",
                percent(share)
            ),
            Self::OtherSpace(share) => write!(
                f,
                "positions do not lie where their pixels see them, and {} % have a positive z, which is \
                 behind the camera: it looks like world space (--space world, with --camera FILE where the \
                 file has no `worldToCamera`)",
                percent(share)
            ),
            Self::UpsideDown => f.write_str("y grows downwards (--up -y)"),
            Self::Mirrored => f.write_str("x grows to the left: the image or its space is mirrored"),
            Self::UnsignedNormals(layer) => write!(
                f,
                "no component of the layer `{}` is negative: it looks like vectors of which 0 to 1 stands \
                 for -1 to 1 ({})",
                layer.name(),
                mended(layer, "unsigned")
            ),
            Self::NotUnit(layer, share, median) => write!(
                f,
                "{} % of the layer `{}` are not of length 1, their median length is {median} ({})",
                percent(share),
                layer.name(),
                mended(layer, "normalised")
            ),
            Self::FacingAway(share) => write!(
                f,
                "{} % of the normals face away from the camera (--normals turned, where these are backs of \
                 surfaces)",
                percent(share)
            ),
            Self::Reversed(axes) => {
                let named = |prefix: &str, between: &str| {
                    let reversed = ["x", "y", "z"].into_iter().zip(axes).filter(|(_, is_so)| *is_so);
                    let names: Vec<String> = reversed.map(|(axis, _)| format!("{prefix}{axis}")).collect();
                    names.join(between)
                };
                write!(
                    f,
                    "normals do not stand on the surface that the positions make, but would if their {} was \
                     reversed (--normals {})",
                    named("", " and "),
                    named("reversed-", ",")
                )
            }
            Self::OtherNormals(share) => write!(
                f,
                "{} % of the normals do not stand on the surface that the positions make: it looks like \
                 normals of another space than the positions'",
                percent(share)
            ),
            Self::Turned(degrees) => write!(
                f,
                "normals stand on the surface that the positions make once all are turned by {} degrees: it \
                 looks like normals of another space than the positions'",
                degrees.round()
            ),
            Self::OtherWorldNormals(share) => write!(
                f,
                "the layers `normal` and `world_normal` are not of the same surfaces: {} % of the angles \
                 between two pixels differ, and no rotation takes one layer to the other",
                percent(share)
            ),
            Self::MirroredWorldNormals => f.write_str(
                "the layer `world_normal` is a mirror image of `normal`: one of its axes, or all, is \
                 reversed; write it in a right-handed world whose y is up",
            ),
            Self::FromCamera => f.write_str(
                "the layer `to_camera` holds directions from the camera: write it from the surface to the \
                 camera, in a right-handed world whose y is up",
            ),
            Self::Depth(ratio, DepthKind::OtherUnit) => {
                write!(f, "the layer `depth` is {ratio} times what the positions say: the units differ")
            }
            Self::Depth(_, DepthKind::Distance) => f.write_str(
                "the layer `depth` is the distance from the camera and not along its viewing direction, \
                 -position.Z",
            ),
            Self::Depth(_, DepthKind::Negative) => f.write_str(
                "the layer `depth` is negative: it looks like z in camera space and not -z \
                 (--depth negative)",
            ),
            Self::Depth(_, DepthKind::Buffer) => f.write_str(
                "the layer `depth` lies within 0 to 1 and mostly above 0.9: it looks like a depth buffer; \
                 write the depth along the viewing direction in metres",
            ),
            Self::Depth(ratio, DepthKind::Unknown) => {
                write!(f, "the layer `depth` is not -position.Z, in the middle {ratio} times that")
            }
        }
    }
}

/// How vectors of a layer are mended.
fn mended(layer: Attribute, option: &str) -> String {
    match layer {
        Attribute::Normal | Attribute::WorldNormal => format!("--normals {option}"),
        _ => "no option mends it".to_owned(),
    }
}
