//! Real environment maps, and damaged ones.

use crate::{data::files, real_data::data};
use deepshade_render::scene::Environment;
use glam::{Vec2, Vec3};

#[test]
fn real_maps_load_and_shine() {
    let Some(data) = data() else { return };
    let maps = files(&data.join("envmaps"), &["hdr", "exr"]);
    assert_eq!(maps.len(), 7);
    for path in maps {
        let environment = Environment::load(&path).expect("a map");
        let [width, height] = environment.size();
        assert_eq!(width, 2 * height, "{}", path.display());
        assert!(environment.mean().min_element() > 0.0, "{}", path.display());
        // What importance sampling finds is the mean.
        let count = 64;
        let value = |i: usize| {
            let square = Vec2::new((i % count) as f32 + 0.5, (i / count) as f32 + 0.5) / count as f32;
            environment.sample(square).map_or(Vec3::ZERO, |sample| sample.radiance / sample.density)
        };
        let mean = (0..count * count).map(value).sum::<Vec3>() / (count * count) as f32;
        let expected = environment.mean() * 4.0 * std::f32::consts::PI;
        assert!((mean / expected - 1.0).abs().max_element() < 0.03, "{}: {mean}, {expected}", path.display());
    }
}

#[test]
fn tiles_and_mip_maps_are_read_at_full_resolution() {
    let Some(data) = data() else { return };
    let environment = Environment::load(&data.join("envmaps/WavyLinesLatLong.exr")).expect("a map");
    assert_eq!(environment.size(), [1024, 512]);
}

#[test]
fn damaged_maps_are_refused_by_name() {
    let Some(data) = data() else { return };
    let maps = files(&data.join("malformed/images"), &["hdr", "exr"]);
    assert!(maps.len() > 15, "{}", maps.len());
    for path in maps {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let error = Environment::load(&path).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
    }
}
