//! A method's uniform buffers in terms of any frame, for engines that run its passes from files.

use super::View;
use crate::scene::Camera;
use deepshade_shaders::host::{Extent, FrameNumber, HostValue};
use deepshade_shaders::wgsl::uniforms::{Field, Layout};
use glam::Vec3;
use std::collections::BTreeMap;

/// What fields hold, by their names.
pub type Values = BTreeMap<&'static str, HostValue>;

/// What a frame has, of which one is doubled to see which fields follow.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Rows,
    Columns,
    Of(FrameNumber),
}

const QUANTITIES: [Quantity; 5] = [
    Quantity::Rows,
    Quantity::Columns,
    Quantity::Of(FrameNumber::Radius),
    Quantity::Of(FrameNumber::FocalLength),
    Quantity::Of(FrameNumber::Seed),
];

impl Quantity {
    /// What it is where it is not doubled.
    const fn base(self) -> f32 {
        match self {
            Self::Rows => 64.0,
            Self::Columns => 96.0,
            Self::Of(FrameNumber::FocalLength) => 128.0,
            Self::Of(_) => 1.0,
        }
    }
}

/// What the fields of a uniform buffer hold in any frame, found by what `told` has for a few views. None if a
/// field is neither a constant, nor rows or columns, nor a number of the frame times or under a constant.
pub fn values(layout: &Layout, told: impl Fn(&View) -> Vec<u8>) -> Option<Values> {
    let base = told(&view(None));
    let doubled = QUANTITIES.map(|quantity| (quantity, told(&view(Some(quantity)))));
    let value = |field: &Field| {
        let held = number(&base, field);
        let changed = doubled.iter().map(|(quantity, bytes)| (*quantity, number(bytes, field)));
        // Focal lengths are rounded.
        let differs = |number: f64| (number - held).abs() > 1e-5 * held.abs();
        match changed.filter(|(_, number)| differs(*number)).collect::<Vec<_>>()[..] {
            [] => Some(HostValue::Constant(held)),
            [(quantity, number)] => follows(quantity, held, number / held),
            _ => None,
        }
    };
    layout.fields.iter().map(|field| Some((field.name, value(field)?))).collect()
}

/// What a field holds that is so many times as large where a quantity is doubled.
fn follows(quantity: Quantity, held: f64, times: f64) -> Option<HostValue> {
    let is = |expected: f64| (times - expected).abs() < 1e-5;
    let base = f64::from(quantity.base());
    match quantity {
        Quantity::Rows if is(2.0) && held == base => Some(HostValue::Rows(Extent::IMAGE)),
        Quantity::Columns if is(2.0) && held == base => Some(HostValue::Columns(Extent::IMAGE)),
        Quantity::Of(of) if is(2.0) => Some(HostValue::Times(of, held / base)),
        Quantity::Of(of) if is(0.5) => Some(HostValue::Over(held * base, of)),
        _ => None,
    }
}

/// A view of the base quantities, one of them doubled.
fn view(doubled: Option<Quantity>) -> View {
    let of = |quantity: Quantity| if doubled == Some(quantity) { 2.0 } else { 1.0 } * quantity.base();
    let [rows, columns, radius, focal_length, seed] = QUANTITIES.map(of);
    let camera = Camera {
        vertical_fov: 2.0 * (0.5 * rows / focal_length).atan(),
        ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z)
    };
    View { height: rows as usize, width: columns as usize, camera, radius, seed: seed as u32 }
}

/// The number of a field of a buffer.
fn number(bytes: &[u8], field: &Field) -> f64 {
    let four = [0, 1, 2, 3].map(|byte| bytes[field.offset + byte]);
    match field.kind {
        "f32" => f64::from(f32::from_le_bytes(four)),
        "i32" => f64::from(i32::from_le_bytes(four)),
        _ => f64::from(u32::from_le_bytes(four)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::{Quality, blur::BlurParameters, gtao::GtaoParameters, march::Marched};
    use bytemuck::bytes_of;
    use deepshade_shaders::Effect;
    use deepshade_shaders::wgsl::uniforms;

    /// What a host puts into a field for a view.
    fn told(value: &HostValue, view: &View) -> f64 {
        let of = |number: &FrameNumber| match number {
            FrameNumber::Radius => f64::from(view.radius),
            FrameNumber::FocalLength => f64::from(view.focal_length()),
            FrameNumber::Seed => f64::from(view.seed),
            FrameNumber::Exposure | FrameNumber::Run => 0.0,
        };
        match value {
            HostValue::Constant(constant) => *constant,
            HostValue::Rows(_) => view.height as f64,
            HostValue::Columns(_) => view.width as f64,
            HostValue::Times(number, factor) => of(number) * factor,
            HostValue::Over(factor, number) => factor / of(number),
        }
    }

    #[test]
    fn what_a_host_computes_is_what_methods_are_told() {
        let other = View { height: 37, width: 53, radius: 0.37, seed: 9, ..view(None) };
        for quality in Quality::ALL {
            let gtao = GtaoParameters::of(quality);
            let march = |view: &View| bytes_of(&gtao.march(view)).to_vec();
            let blur = |view: &View| bytes_of(&gtao.blur.settings(view, Effect::Ao)[1]).to_vec();
            assert_same(&uniforms::Slices::LAYOUT, march, &other);
            assert_same(&uniforms::Blur::LAYOUT, blur, &other);
        }
    }

    fn assert_same(layout: &Layout, of: impl Fn(&View) -> Vec<u8>, view: &View) {
        let values = values(layout, &of).expect("each field follows one number");
        let bytes = of(view);
        for field in layout.fields {
            let (host, own) = (told(&values[field.name], view), number(&bytes, field));
            assert!((host - own).abs() <= 1e-5 * own.abs(), "{} {host} {own}", field.name);
        }
    }

    #[test]
    fn a_field_that_follows_no_number_is_refused() {
        let blur = BlurParameters { radius: 2, sharpness: 1.0 };
        let squared = |view: &View| {
            let mut blur = blur.settings(view, Effect::Ao)[0];
            blur.falloff = view.radius * view.radius;
            bytes_of(&blur).to_vec()
        };
        assert_eq!(values(&uniforms::Blur::LAYOUT, squared), None);
        let of_two = |view: &View| {
            let mut blur = blur.settings(view, Effect::Ao)[0];
            blur.falloff = view.radius * view.height as f32;
            bytes_of(&blur).to_vec()
        };
        assert_eq!(values(&uniforms::Blur::LAYOUT, of_two), None);
    }
}
