//! Files that other programs write: several parts, windows, subsampled and deep channels, layers, numbers as
//! attributes.

use super::*;

/// A channel's value at a column and a row.
type Value = fn(usize, usize) -> f32;

/// A file written byte by byte, without compression.
#[derive(Default)]
struct File {
    display: Option<Window>,
    /// Attributes of the first part: name, type and value.
    attributes: Vec<(&'static str, &'static str, Vec<u8>)>,
    parts: Vec<TestPart>,
}

struct TestPart {
    name: &'static str,
    kind: &'static str,
    window: Window,
    /// Name, sampling along both axes, and its value at a column and row of the window.
    channels: Vec<(&'static str, usize, Value)>,
}

const WHOLE: Window = Window::of_size(4, 6);

fn part(name: &'static str, window: Window, channels: &[(&'static str, Value)]) -> TestPart {
    let channels = channels.iter().map(|(name, value)| (*name, 1, *value)).collect();
    TestPart { name, kind: "scanlineimage", window, channels }
}

fn attribute(name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    [name.as_bytes(), &[0], kind.as_bytes(), &[0], &(value.len() as u32).to_le_bytes(), value].concat()
}

fn numbers(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn bounds(window: Window) -> Vec<u8> {
    let (right, bottom) = (window.left + window.width as i32 - 1, window.top + window.height as i32 - 1);
    numbers(&[window.left, window.top, right, bottom])
}

impl TestPart {
    fn is_deep(&self) -> bool {
        self.kind.starts_with("deep")
    }

    fn header(&self, file: &File) -> Vec<u8> {
        let channel = |(name, sampling, _): &(&str, usize, Value)| {
            let sampling = *sampling as i32;
            [name.as_bytes(), &[0], &numbers(&[2, 0, sampling, sampling])].concat()
        };
        let channels: Vec<u8> = self.channels.iter().flat_map(channel).chain([0]).collect();
        let chunks = numbers(&[self.window.height as i32]);
        let display = file.display.unwrap_or(WHOLE);
        let mut header = vec![
            attribute("channels", "chlist", &channels),
            attribute("chunkCount", "int", &chunks),
            attribute("compression", "compression", &[0]),
            attribute("dataWindow", "box2i", &bounds(self.window)),
            attribute("displayWindow", "box2i", &bounds(display)),
            attribute("lineOrder", "lineOrder", &[0]),
            attribute("name", "string", self.name.as_bytes()),
            attribute("pixelAspectRatio", "float", &1f32.to_le_bytes()),
            attribute("screenWindowCenter", "v2f", &[0; 8]),
            attribute("screenWindowWidth", "float", &1f32.to_le_bytes()),
            attribute("type", "string", self.kind.as_bytes()),
        ];
        if self.is_deep() {
            header.push(attribute("maxSamplesPerPixel", "int", &numbers(&[1])));
            header.push(attribute("version", "int", &numbers(&[1])));
        }
        header.push(vec![0]);
        header.concat()
    }

    /// Chunks of a row each.
    fn chunks(&self, index: usize) -> Vec<Vec<u8>> {
        let row = |y: usize| {
            let absolute = self.window.top + y as i32;
            if self.is_deep() {
                // A table of counts and no sample.
                let table = vec![0; 4 * self.window.width];
                let sizes = [table.len() as u64, 0, 0].map(u64::to_le_bytes).concat();
                return [numbers(&[index as i32, absolute]), sizes, table].concat();
            }
            let mut data = Vec::new();
            for (_, sampling, value) in &self.channels {
                if absolute.rem_euclid(*sampling as i32) == 0 {
                    let columns = (0..self.window.width).step_by(*sampling);
                    data.extend(columns.flat_map(|x| value(x, y).to_le_bytes()));
                }
            }
            [numbers(&[index as i32, absolute, data.len() as i32]), data].concat()
        };
        (0..self.window.height).map(row).collect()
    }
}

impl File {
    fn of(parts: Vec<TestPart>) -> Self {
        Self { parts, ..Self::default() }
    }

    fn write(&self, folder: &Path) -> PathBuf {
        let deep = if self.parts.iter().any(TestPart::is_deep) { 0x800 } else { 0 };
        let mut bytes = numbers(&[20_000_630, 2 | 0x1000 | deep]);
        for (index, part) in self.parts.iter().enumerate() {
            let header = part.header(self);
            let (end, more) = (header.len() - 1, self.attributes.iter().filter(|_| index == 0));
            bytes.extend(&header[..end]);
            bytes.extend(more.flat_map(|(name, kind, value)| attribute(name, kind, value)));
            bytes.push(0);
        }
        bytes.push(0);
        let chunks: Vec<Vec<u8>> =
            self.parts.iter().enumerate().flat_map(|(index, part)| part.chunks(index)).collect();
        let mut offset = bytes.len() + 8 * chunks.len();
        for chunk in &chunks {
            bytes.extend((offset as u64).to_le_bytes());
            offset += chunk.len();
        }
        bytes.extend(chunks.concat());
        let path = folder.join("frame.exr");
        std::fs::write(&path, bytes).expect("written");
        path
    }
}

const DEPTH: (&str, Value) = ("depth", |x, y| (10 * y + x + 1) as f32);
const GLOSSINESS: (&str, Value) = ("glossiness", |x, y| (10 * y + x) as f32 / 64.0);
const BOTH: [Attribute; 2] = [Attribute::Depth, Attribute::Glossiness];

fn gbuffer_of(path: &Path) -> Result<GBuffer, ExrError> {
    read_gbuffer(path, &BOTH, None)?.gbuffer(&BOTH)
}

/// What a part of both over the whole window is.
fn expected() -> Planes {
    Planes::from_fn(2, 4, 6, |c, y, x| if c == 0 { DEPTH.1(x, y) } else { GLOSSINESS.1(x, y) })
}

#[test]
fn windows_are_kept_by_reading_and_writing() {
    let folder = tempfile::tempdir().expect("a folder");
    let window = Window { left: -3, top: 7, width: 6, height: 4 };
    let display = Window { left: 1, top: 2, width: 160, height: 120 };
    let file = File { display: Some(display), ..File::of(vec![part("a", window, &[DEPTH, GLOSSINESS])]) };
    let path = file.write(folder.path());
    let image = read(&path).expect("read");
    let windows = image.windows(&BOTH).expect("both");
    assert_eq!(windows, Windows { data: window, display });
    assert_eq!(image.gbuffer(&BOTH).expect("both").planes(), &expected());
    let shown = Planes::filled(1, 4, 6, 0.5);
    write_within(&path, &[Layer::image("ao", &shown)], &Metadata::new(), &windows).expect("written");
    let written = read_where_exr_says(&path);
    assert_eq!(written, windows);
    write(&path, &[Layer::image("ao", &shown)], &Metadata::new()).expect("written");
    assert_eq!(read_where_exr_says(&path), Windows::of(&shown));
}

/// The windows as the crate `exr` reads them.
fn read_where_exr_says(path: &Path) -> Windows {
    let meta = exr::meta::MetaData::read_from_file(path, false).expect("headers");
    let window = |bounds: exr::meta::attribute::IntegerBounds| Window {
        left: bounds.position.0,
        top: bounds.position.1,
        width: bounds.size.0,
        height: bounds.size.1,
    };
    let header = &meta.headers[0];
    Windows { data: window(header.data_window()), display: window(header.shared_attributes.display_window) }
}

#[test]
fn parts_lie_where_their_windows_say() {
    let folder = tempfile::tempdir().expect("a folder");
    // The larger one's pixel (2, 1) is the smaller one's first.
    let small = Window { left: 2, top: 1, width: 3, height: 2 };
    for swapped in [false, true] {
        let mut parts = vec![part("a", WHOLE, &[DEPTH]), part("b", small, &[GLOSSINESS])];
        if swapped {
            parts.reverse();
        }
        let path = File::of(parts).write(folder.path());
        let planes = gbuffer_of(&path).expect("one within the other").planes().clone();
        let value = |c: usize, y: usize, x: usize| {
            if c == 0 { DEPTH.1(x + 2, y + 1) } else { GLOSSINESS.1(x, y) }
        };
        assert_eq!(planes, Planes::from_fn(2, 2, 3, value));
        assert_eq!(read(&path).expect("read").windows(&BOTH).expect("both").data, small);
    }
    let shifted = Window { left: 2, top: 1, ..WHOLE };
    let path =
        File::of(vec![part("a", WHOLE, &[DEPTH]), part("b", shifted, &[GLOSSINESS])]).write(folder.path());
    let error = gbuffer_of(&path).expect_err("apart").to_string();
    for said in ["`a.depth` lies at (0, 0) to (5, 3)", "`b.glossiness` at (2, 1) to (7, 4)"] {
        assert!(error.contains(said), "{error}");
    }
    assert!(read(&path).expect("read").gbuffer(&[Attribute::Depth]).is_ok(), "one of them alone");
}

#[test]
fn what_nobody_reads_does_not_matter_and_is_named_when_it_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut main = part("main", WHOLE, &[DEPTH, GLOSSINESS]);
    // Before and behind the others.
    main.channels.insert(0, ("RY", 2, |x, _| x as f32));
    main.channels.push(("light.R", 2, |_, y| y as f32));
    let thumbnail = part("thumb", Window::of_size(1, 2), &[("Y", |_, _| 1.0)]);
    let mut deep = part("deep", Window::of_size(3, 2), &[("Z", |_, _| 1.0)]);
    deep.kind = "deepscanline";
    let vast = part("vast", Window { left: 0, top: 0, width: 4_000_000, height: 1 }, &[("Y", |_, _| 1.0)]);
    for parts in [vec![thumbnail, main], vec![deep]] {
        let mut file = File::of(parts);
        if file.parts.len() == 1 {
            file.parts.push(part("main", WHOLE, &[DEPTH, GLOSSINESS]));
        }
        let path = file.write(folder.path());
        assert_eq!(gbuffer_of(&path).expect("both").planes(), &expected());
        assert_eq!(read(&path).expect("read").gbuffer(&BOTH).expect("both").planes(), &expected());
    }
    let image = read(&folder.path().join("frame.exr")).expect("read");
    let error = image.layer("deep.Z").expect_err("deep").to_string();
    assert!(error.contains("frame.exr") && error.contains("channel `deep.Z` is deep"), "{error}");
    let file = File::of(vec![vast, part("main", WHOLE, &[DEPTH, GLOSSINESS])]);
    let path = file.write(folder.path());
    assert_eq!(gbuffer_of(&path).expect("both").planes(), &expected());
    assert!(read(&path).expect_err("all of it").to_string().contains("4000000 x 1 pixels"));

    let mut colours = part("main", WHOLE, &[("Y", |_, _| 1.0)]);
    colours.channels.insert(0, ("RY", 2, |x, _| x as f32));
    let path = File::of(vec![colours]).write(folder.path());
    let error = read(&path).expect("read").layer("main.RY").expect_err("subsampled").to_string();
    assert!(error.contains("channel `main.RY` is subsampled"), "{error}");
    assert!(read_colour(&path).expect_err("grey alone").to_string().contains("luminance"));
}

#[test]
fn a_part_of_a_picture_is_black_around() {
    let folder = tempfile::tempdir().expect("a folder");
    let window = Window { left: 1, top: 2, width: 2, height: 1 };
    let colours: [(&str, Value); 3] = [("B", |x, _| 3.0 + x as f32), ("G", |_, _| 2.0), ("R", |_, _| 1.0)];
    let path = File::of(vec![part("map", window, &colours)]).write(folder.path());
    let value = |c: usize, y: usize, x: usize| match (c, y, x) {
        (2, 2, 1 | 2) => 2.0 + x as f32,
        (c, 2, 1 | 2) => 1.0 + c as f32,
        _ => 0.0,
    };
    let (picture, windows) = read_colour(&path).expect("a picture");
    assert_eq!(picture, Planes::from_fn(3, 4, 6, value));
    assert_eq!(windows, Windows { data: window, display: WHOLE });
    // More than is shown is cut off.
    let display = Some(Window { left: 2, top: 2, width: 1, height: 1 });
    let path = File { display, ..File::of(vec![part("map", window, &colours)]) }.write(folder.path());
    assert_eq!(read_colour(&path).expect("a picture").0.data(), [1.0, 2.0, 4.0]);
    for display in [Window { left: 50, ..WHOLE }, Window::of_size(1, 50_000)] {
        let file = File { display: Some(display), ..File::of(vec![part("map", window, &colours)]) };
        let error = read_colour(&file.write(folder.path())).expect_err("no such frame").to_string();
        assert!(error.contains("display window"), "{error}");
    }
}

#[test]
fn of_two_layers_one_is_chosen() {
    let folder = tempfile::tempdir().expect("a folder");
    let channels: [(&str, Value); 4] = [
        ("ViewLayer.Depth.Z", DEPTH.1),
        ("ViewLayer.glossiness", GLOSSINESS.1),
        ("ViewLayer_001.Depth.Z", |_, _| 2.0),
        ("ViewLayer_001.glossiness", |_, _| 0.5),
    ];
    let path = File::of(vec![part("", WHOLE, &channels)]).write(folder.path());
    let error = gbuffer_of(&path).expect_err("two").to_string();
    assert!(error.contains("`depth` is ambiguous"), "{error}");
    for candidate in ["ViewLayer.Depth.Z", "ViewLayer_001.Depth.Z"] {
        assert!(error.contains(candidate), "{error}");
    }
    let chosen = |layer| read_gbuffer(&path, &BOTH, Some(layer))?.gbuffer(&BOTH);
    assert_eq!(chosen("viewlayer").expect("one").planes(), &expected());
    assert_eq!(chosen("ViewLayer_001").expect("one").planes().plane(0), [2.0; 24]);
    let error = chosen("ViewLayer_002").expect_err("none").to_string();
    assert!(error.contains("no layer `ViewLayer_002`") && error.contains("ViewLayer.Depth.Z"), "{error}");
}

#[test]
fn attributes_that_are_numbers_count_as_text() {
    let folder = tempfile::tempdir().expect("a folder");
    for (kind, value, text) in [
        ("string", b"0.25".to_vec(), "0.25"),
        ("float", 0.25f32.to_le_bytes().to_vec(), "0.25"),
        ("double", 0.25f64.to_le_bytes().to_vec(), "0.25"),
        ("int", 2i32.to_le_bytes().to_vec(), "2"),
    ] {
        let attributes = vec![("radius_metres", kind, value)];
        let file = File { attributes, ..File::of(vec![part("a", WHOLE, &[DEPTH])]) };
        let image = read(&file.write(folder.path())).expect("read");
        assert_eq!(image.metadata()["radius_metres"], text, "{kind}");
    }
    let matrix: Vec<f32> = (0..16).map(|value| value as f32).collect();
    let bytes = matrix.iter().flat_map(|value| value.to_le_bytes()).collect();
    let attributes = vec![("worldToCamera", "m44f", bytes)];
    let file = File { attributes, ..File::of(vec![part("a", WHOLE, &[DEPTH])]) };
    let image = read(&file.write(folder.path())).expect("read");
    assert_eq!(image.world_to_camera().map(|matrix| matrix.to_vec()), Some(matrix));
}
