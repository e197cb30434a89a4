use super::*;
use crate::bvh::TracedScene;
use crate::path::{self, Sampling, Shot};
use crate::scene::Camera;
use crate::scene::procedural::Family;
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use exr::prelude::Compression;

mod other_programs;
#[path = "../../tests/real_data/mod.rs"]
mod real_data;

fn gbuffer() -> GBuffer {
    let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Depth];
    // Multiples of 1/8, which half floats hold exactly.
    let planes = Planes::from_fn(7, 21, 34, |c, y, x| (c * 100 + y * 34 + x) as f32 * 0.125 - 20.0);
    GBuffer::new(attributes, planes)
}

fn written(folder: &Path) -> (PathBuf, GBuffer, Planes) {
    let path = folder.join("frame.exr");
    let target = Planes::from_fn(1, 21, 34, |_, y, x| ((y + x) % 5) as f32 * 0.25);
    let metadata = Metadata::from([("scene".to_owned(), "rooms 7".to_owned()), ("seed".into(), "3".into())]);
    let gbuffer = gbuffer();
    let layers = [Layer::gbuffer(&gbuffer), Layer::image("target.ao", &target)];
    write(&path, &layers, &metadata).expect("written");
    (path, gbuffer, target)
}

#[test]
fn a_layer_in_full_keeps_what_half_floats_lose() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("variance.exr");
    let values = Planes::from_data(1, 1, 3, vec![1.234_567e-12, 1e9, 0.1]);
    write(&path, &[Layer::image("variance", &values).in_full()], &Metadata::new()).expect("written");
    assert_eq!(read(&path).expect("read").image("variance", 1).expect("there"), values);
    let small = Planes::from_data(1, 1, 3, vec![1.234_567e-12, 1e4, 0.1]);
    write(&path, &[Layer::image("variance", &small)], &Metadata::new()).expect("written");
    assert_ne!(read(&path).expect("read").image("variance", 1).expect("there"), small);
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, gbuffer, target) = written(folder.path());
    let image = read(&path).expect("read");
    assert_eq!((image.height(), image.width()), (21, 34));
    let has = |attribute: &&Attribute| image.has(**attribute);
    assert_eq!(Attribute::ALL.iter().filter(has).copied().collect::<Vec<_>>(), gbuffer.attributes());
    assert_eq!(image.gbuffer(gbuffer.attributes()).expect("all there"), gbuffer);
    assert_eq!(image.image("target.ao", 1).expect("there"), target);
    assert_eq!(image.metadata()["scene"], "rooms 7");
    assert_eq!(image.metadata()["software"], PROGRAM);
}

#[test]
fn layers_are_what_a_file_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, gbuffer, target) = written(folder.path());
    let image = read(&path).expect("read");
    let mut layers = image.layers();
    layers.sort();
    assert_eq!(layers, ["depth", "normal", "position", "target.ao"]);
    assert_eq!(image.layer("target.ao").expect("there"), target);
    let normal = gbuffer.select(&[Attribute::Normal]).expect("there");
    assert_eq!(image.layer("normal").expect("there"), normal, "X, Y and Z in this order");
    let error = image.layer("shadow").expect_err("none").to_string();
    assert!(error.contains("`shadow`") && error.contains("position.X"), "{error}");

    // Names of other programs: no layer, small letters, a lone component, alpha.
    let names = ["A", "B", "G", "R", "view.n.x", "view.n.y", "view.n.z", "Z", "uv.X", "uv.Y"];
    let planes: Vec<Planes> = (0..names.len()).map(|index| Planes::filled(1, 2, 2, index as f32)).collect();
    let path = folder.path().join("other.exr");
    let layers: Vec<Layer<'_>> =
        names.iter().zip(&planes).map(|(name, planes)| Layer::image(name, planes)).collect();
    write(&path, &layers, &Metadata::new()).expect("written");
    let image = read(&path).expect("read");
    let mut found = image.layers();
    found.sort();
    assert_eq!(found, ["A", "RGB", "Z", "uv.X", "uv.Y", "view.n"]);
    let colour = image.layer("RGB").expect("there");
    assert_eq!([0, 1, 2].map(|channel| colour.at(channel, 0, 0)), [3.0, 2.0, 1.0]);
}

#[test]
fn the_same_image_gives_the_same_bytes() {
    let metadata: Metadata = (0..20).map(|i| (format!("key{i}"), format!("value {i}"))).collect();
    let bytes = || {
        let gbuffer = gbuffer();
        encode(Path::new("a.exr"), &[Layer::gbuffer(&gbuffer)], &metadata).expect("encoded")
    };
    let first = bytes();
    assert!((0..5).all(|_| bytes() == first));
}

#[test]
fn metadata_keeps_what_fits_into_a_byte_and_escapes_the_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("names.exr");
    let metadata = Metadata::from([
        ("scene".to_owned(), "café Łódź 10 € \\".to_owned()),
        ("plain".to_owned(), "ÿ".to_owned()),
    ]);
    write(&path, &[Layer::gbuffer(&gbuffer())], &metadata).expect("written");
    let image = read(&path).expect("read");
    assert_eq!(image.metadata()["scene"], "café \\u{141}ód\\u{17a} 10 \\u{20ac} \\");
    assert_eq!(image.metadata()["plain"], "ÿ");
}

#[test]
fn missing_channels_are_named_with_what_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, ..) = written(folder.path());
    let image = read(&path).expect("read");
    let error = image.gbuffer(&[Attribute::Normal, Attribute::WorldNormal]).expect_err("no world normal");
    let text = error.to_string();
    assert!(
        text.contains("frame.exr") && text.contains("no channel `world_normal.X`, `world_normal.Y`"),
        "{text}"
    );
    assert!(text.contains("holds depth, normal.X") && text.contains("target.ao"), "{text}");
}

#[test]
fn values_beyond_half_floats_are_written_in_full_and_none_that_is_not_finite() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dome.exr");
    // A dome 100 km across, or a room in millimetres.
    let value = |c: usize, y: usize, x: usize| if (c, y, x) == (1, 1, 0) { -1e5 } else { 0.1 };
    let planes = Planes::from_fn(3, 2, 2, value);
    let gbuffer = GBuffer::new(vec![Attribute::Position], planes.clone());
    write(&path, &[Layer::gbuffer(&gbuffer)], &Metadata::new()).expect("written");
    let read = read(&path).expect("read").gbuffer(&[Attribute::Position]).expect("there");
    assert_eq!(read.planes().plane(1), planes.plane(1));
    assert_ne!(read.planes().plane(0), planes.plane(0), "half floats, where they do");
    // As a half float this would be the one that stands for "no surface".
    let near = GBuffer::new(vec![Attribute::Depth], Planes::filled(1, 1, 1, 65_500.0));
    write(&path, &[Layer::gbuffer(&near)], &Metadata::new()).expect("written");
    assert_eq!(super::read(&path).expect("read").gbuffer(&[Attribute::Depth]).expect("there"), near);
    for value in [f32::NAN, f32::INFINITY] {
        let planes = Planes::from_fn(1, 2, 2, |_, y, x| if (y, x) == (1, 0) { value } else { 0.0 });
        let error = encode(Path::new("a.exr"), &[Layer::image("depth", &planes)], &Metadata::new());
        let error = error.expect_err("not finite");
        assert!(matches!(error, ExrError::NotHalf { ref channel, .. } if channel == "depth"), "{error}");
    }
}

#[test]
fn a_pixel_that_is_not_finite_is_one_where_nothing_is_seen() {
    let image = exr::prelude::Image::from_channels(
        (2, 1),
        exr::prelude::AnyChannels::sort(
            vec![
                exr::prelude::AnyChannel::new(
                    "Depth.Z",
                    exr::prelude::FlatSamples::F32(vec![f32::INFINITY, 2.0]),
                ),
                exr::prelude::AnyChannel::new("glossiness", exr::prelude::FlatSamples::U32(vec![1, 1])),
            ]
            .into(),
        ),
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.exr");
    exr::prelude::WritableImage::write(&image).to_file(&path).expect("written");
    let image = read(&path).expect("read");
    let gbuffer = image.gbuffer(&[Attribute::Depth, Attribute::Glossiness]).expect("both there");
    assert_eq!(gbuffer.planes().data(), &[0.0, 2.0, 0.0, 1.0]);
}

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, ..) = written(folder.path());
    let bytes = std::fs::read(&path).expect("read");
    for length in (0..bytes.len()).step_by(97).chain([bytes.len() - 1]) {
        std::fs::write(&path, &bytes[..length]).expect("cut");
        let error = read(&path).expect_err("cut off");
        assert!(error.to_string().contains("frame.exr"), "{error}");
    }
}

/// Damage anywhere may give wrong pixels, since EXR has no checksum, but never a panic or a giant allocation.
#[test]
fn damaged_bytes_do_not_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, ..) = written(folder.path());
    let bytes = std::fs::read(&path).expect("read");
    let mut refused = 0;
    for position in (0..bytes.len()).step_by(3) {
        let mut damaged = bytes.clone();
        damaged[position] ^= 0xff;
        std::fs::write(&path, damaged).expect("damaged");
        refused += usize::from(read(&path).is_err());
    }
    assert!(refused > 100, "{refused} refused");
}

/// Files that once broke OpenEXR or the crate `exr`, and why they are refused.
const MALICIOUS: [(&str, &str); 14] = [
    ("exr_NULL_pointer", "reference to missing bytes"),
    ("exr_asan_heap-oob_4cb169_255_", "channel linearity attribute value"),
    ("exr_asan_heap-oob_4cb169_978_", "exceeds total size 300"),
    ("exr_asan_heap-oob_7f11ece681f1_", "reference to missing bytes"),
    ("exr_asan_heap-oob_7f6e5e983398_", "reference to missing bytes"),
    ("exr_clusterfuzz-testcase-minimized-openexr_deepscanlines_", "block type attribute value"),
    ("exr_clusterfuzz-testcase-minimized-openexr_deeptiles_", "reference to missing bytes"),
    ("exr_clusterfuzz-testcase-minimized-openexr_scanlines_", "reference to missing bytes"),
    ("exr_clusterfuzz-testcase-minimized-openexrenvmap_", "reference to missing bytes"),
    ("exr_exrs_invalid_integer_bounds", "window size exceeding integer maximum"),
    ("exr_exrs_zero-tilesize", "tile size"),
    ("exr_heap_overflow", "reference to missing bytes"),
    ("exr_memory_DOS_1", "1 x 452984833 pixels, where 1 to 32768 an edge are accepted"),
    ("exr_oom", "reference to missing bytes"),
];

#[test]
fn malicious_files_are_refused_for_what_is_wrong() {
    let Some(data) = real_data::data() else { return };
    let folder = std::fs::read_dir(data.join("malformed/images")).expect("malformed images");
    let paths = folder.map(|entry| entry.expect("an entry").path());
    let files: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|ending| ending == "exr")).collect();
    assert_eq!(files.len(), MALICIOUS.len());
    for (begin, expected) in MALICIOUS {
        let is_it =
            |path: &&PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(begin));
        let error = read(files.iter().find(is_it).expect(begin)).expect_err(begin).to_string();
        assert!(error.contains(begin) && error.contains(expected), "{error}");
    }
    // Sound, tiled and mip-mapped.
    let waves = read(&data.join("envmaps/WavyLinesLatLong.exr")).expect("a sound file");
    assert!(waves.width() > 100 && waves.names.iter().any(|name| name == "R"));
}

/// Prints how long each lossless compression takes on a rendered pair and what it saves; the one in use must
/// give the smallest file.
#[test]
fn compression() {
    let scene = TracedScene::new(Family::ALL[0].scene(1)).expect("a scene");
    let (centre, corner) = (scene.bounds().centre(), scene.bounds().min);
    let camera = Camera::look_at(centre, corner);
    let attributes = [Attribute::Position, Attribute::Normal, Attribute::Valid];
    let gbuffer = crate::gbuffer::render(&scene, &camera, 256, 256, &attributes);
    let shot = Shot::new(&scene, &camera, [256, 256], 0.05 * scene.diagonal());
    let truth = path::render(Effect::Ao, &shot, Sampling::one(16, 1)).mean;
    let layers = [Layer::gbuffer(&gbuffer), Layer::image("target.ao", &truth)];
    let size = |compression: Compression| {
        let start = std::time::Instant::now();
        let windows = Windows::of(&truth);
        let bytes = write::encode_with(Path::new("a.exr"), &layers, &Metadata::new(), &windows, compression)
            .expect("encoded");
        let writing = start.elapsed();
        let file = tempfile::NamedTempFile::new().expect("a file");
        std::fs::write(file.path(), &bytes).expect("written");
        let start = std::time::Instant::now();
        read(file.path()).expect("read");
        println!(
            "{compression}: {} bytes, written in {writing:.1?}, read in {:.1?}",
            bytes.len(),
            start.elapsed()
        );
        bytes.len()
    };
    let all = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    let smallest = all.map(size).into_iter().min();
    assert_eq!(Some(size(write::COMPRESSION)), smallest);
}
