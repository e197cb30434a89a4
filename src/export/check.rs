//! A frame by which an engine that runs a network from files can check itself: a g-buffer and its image.

use crate::learned::Learned;
use crate::room_frame::{RoomFrame, SEED};
use anyhow::Result;
use deepshade_infer::Model;
use deepshade_infer::forward::File;
use deepshade_render::method::Repeats;
use deepshade_shaders::{Attribute, Planes};
use serde_json::json;

/// Rows and columns.
const SIZE: [usize; 2] = [96, 160];

/// `check.json` with the frame's numbers, and `check.NAME.bin` with the content of the buffer of each
/// attribute that a host fills, and of its image.
///
/// # Errors
/// If the room cannot be seen, or the network does not run.
pub fn files(model: &Model, attributes: &[Attribute]) -> Result<Vec<File>> {
    let spec = &model.spec;
    let RoomFrame { gbuffer, radius } = RoomFrame::new(spec, SIZE)?;
    let image = Learned::on_processor(model)?.image(&gbuffer, radius, Repeats::ONCE)?.image;
    let file = |name: &str, planes: &Planes| {
        (format!("check.{name}.bin"), bytemuck::cast_slice(planes.data()).to_vec())
    };
    let mut files = vec![file("image", &image)];
    for attribute in attributes {
        files.push(file(attribute.name(), &gbuffer.select(&[*attribute])?));
    }
    let exposure = spec.scaling(&spec.prepared(&gbuffer, radius)?, radius)?.light;
    let focal_length = gbuffer.focal_length().unwrap_or(1.0);
    let frame = json!({
        "height": SIZE[0], "width": SIZE[1], "radius": radius, "focal_length": focal_length,
        "exposure": exposure, "seed": SEED,
    });
    files.push(("check.json".to_owned(), format!("{frame:#}\n").into_bytes()));
    Ok(files)
}
