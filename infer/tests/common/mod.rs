//! A frame that tests share.

use deepshade_infer::parity::noise;
use deepshade_shaders::{Attribute, AttributeKind, GBuffer, Planes};

/// Bumps and steps with holes, in which lies what renderers leave there.
pub fn gbuffer(height: usize, width: usize) -> GBuffer {
    let attributes =
        [&Attribute::ALL[..], &[Attribute::Openness, Attribute::RawOpenness, Attribute::Estimate]].concat();
    let channels = attributes.iter().map(|attribute| attribute.width()).sum();
    let mut planes = noise(channels, height, width, 3);
    let focal_length = 0.8 * height as f32;
    let mut first = 0;
    for attribute in &attributes {
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let (across, down) = (x as f32 + 0.5 - 0.5 * width as f32, 0.5 * height as f32 - 0.5 - y as f32);
            let step = f32::from(u8::from(x > y));
            let depth = 2.0 + step + 0.3 * (0.2 * x as f32).sin() + 0.2 * (0.3 * y as f32).cos();
            let hole = (x / 7 + y / 5) % 4 == 1 || (x > 20 && x < 32 && y < 24);
            let here = |planes: &mut Planes, component: usize, value: f32| {
                planes.plane_mut(first + component)[y * width + x] = value;
            };
            match attribute {
                Attribute::Position => {
                    let place = [across * depth / focal_length, down * depth / focal_length, -depth];
                    (0..3).for_each(|c| here(&mut planes, c, if hole { f32::INFINITY } else { place[c] }));
                }
                // As methods make them.
                Attribute::Openness | Attribute::RawOpenness | Attribute::Estimate => {
                    for c in 0..attribute.width() {
                        let value = 0.5 + 0.28 * planes.at(first + c, y, x);
                        here(&mut planes, c, value);
                    }
                }
                Attribute::Valid => here(&mut planes, 0, if hole { 0.25 } else { 1.0 }),
                _ if hole && attribute.kind() == AttributeKind::Scalar => here(&mut planes, 0, f32::NAN),
                _ => {}
            }
        }
        first += attribute.width();
    }
    GBuffer::new(attributes, planes)
}
