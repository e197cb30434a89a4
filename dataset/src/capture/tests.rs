//! Folders of both layouts, sound and damaged, and the real ones where they are.

use super::*;
use crate::shipped::contents;
use deepshade_shaders::Attribute;
use glam::Vec3;
use image::{ImageBuffer, Luma, Rgb};
use std::fs;

mod real;

/// Writes a colour and a depth image of 6 x 4 pixels: the depth of pixel (x, y) is `first` + x + 10 y.
fn write_images(colour: &Path, depth: &Path, first: u16) {
    for path in [colour, depth] {
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    }
    ImageBuffer::from_fn(6, 4, |x, y| Rgb([(10 * x) as u8, (10 * y) as u8, 188]))
        .save(colour)
        .expect("written");
    let depths = ImageBuffer::from_fn(6, 4, |x, y| Luma([first + x as u16 + 10 * y as u16]));
    depths.save(depth).expect("written");
}

const CAMERA: &str = "width = 6\nheight = 4\nfx = 5.0\nfy = 5.0\ncx = 2.5\ncy = 1.5\n";
const MATRIX: &str = "{\"width\": 6, \"height\": 4, \"intrinsic_matrix\": [5, 0, 0, 0, 5, 0, 2.5, 1.5, 1]}";

/// Three frames, and a colour image that has no depth image.
fn tum() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    for (index, first) in [(0, 5000), (1, 10_000), (2, 0)] {
        write_images(&at(&format!("rgb/{index}.png")), &at(&format!("depth/{index}.png")), first);
    }
    let write = |name: &str, text: &str| fs::write(at(name), text).expect("written");
    write("rgb.txt", "# time file\n1.00 rgb/0.png\n2.00 rgb/1.png\n3.00 rgb/2.png\n9.00 rgb/2.png\n");
    write("depth.txt", "3.01 depth/2.png\n1.015 depth/0.png\n1.99 depth/1.png\n\n9.03 depth/0.png\n");
    write("groundtruth.txt", "1.001 1 2 3 0 0 0 1\n2.5 0 0 0 1 0 0 0\n");
    write("camera.toml", CAMERA);
    folder
}

fn open3d() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    write_images(&at("color/00000.png"), &at("depth/00000.png"), 1000);
    write_images(&at("color/00001.png"), &at("depth/00001.png"), 2000);
    fs::write(at("camera_intrinsic.json"), MATRIX).expect("written");
    let matrix = "1 0 0 0.5\n0 0 -1 0\n0 1 0 0\n0 0 0 1\n";
    fs::write(at("trajectory.log"), format!("1 1 2\n{matrix}")).expect("written");
    folder
}

#[test]
fn a_tum_folder_is_read_by_time() {
    let folder = tum();
    let capture = Capture::open(folder.path()).expect("a capture");
    assert_eq!(capture.count(), 3, "what has no partner within 20 ms is left out");
    let frames = [0, 1, 2].map(|index| capture.frame(index).expect("a frame"));
    assert_eq!(frames.each_ref().map(|frame| frame.time), [Some(1.0), Some(2.0), Some(3.0)]);
    assert_eq!(
        frames.each_ref().map(|frame| frame.depth.at(0, 2, 3)),
        [5023.0, 10_023.0, 23.0].map(|z| z / 5000.0)
    );
    assert_eq!(frames[2].depth.at(0, 0, 0), 0.0, "a hole");
    // 188 in sRGB is half the light of white.
    let colour = &frames[0].colour;
    assert!((colour.at(2, 0, 0) - 0.503).abs() < 1e-3 && colour.at(0, 0, 5) > colour.at(0, 3, 4));
    assert_eq!(frames[0].pose.expect("a pose").position, Vec3::new(1.0, 2.0, 3.0));
    assert!(frames[1].pose.is_none() && frames[2].pose.is_none());
    // The principal point is the middle of the image.
    assert_eq!(capture.camera().intrinsics.centre, glam::Vec2::new(3.0, 2.0));
}

#[test]
fn an_open3d_folder_is_read_by_name() {
    let folder = open3d();
    let capture = Capture::open(folder.path()).expect("a capture");
    let frames = [0, 1].map(|index| capture.frame(index).expect("a frame"));
    assert_eq!(frames.each_ref().map(|frame| frame.depth.at(0, 1, 0)), [1.01, 2.01]);
    assert!(frames[0].pose.is_none());
    let pose = frames[1].pose.expect("a pose");
    // The file's camera looks along its z axis, the matrix' third column.
    assert!((pose.rotation * Vec3::NEG_Z - Vec3::NEG_Y).length() < 1e-6);
    assert_eq!(pose.position, Vec3::new(0.5, 0.0, 0.0));
}

#[test]
fn cameras_of_the_benchmark_are_known_by_the_folder_s_name() {
    let folder = tum();
    fs::remove_file(folder.path().join("camera.toml")).expect("removed");
    let error = Capture::open(folder.path()).expect_err("nobody knows").to_string();
    assert!(error.contains("nothing says what its camera was") && error.contains("camera.toml"), "{error}");
    let named = folder.path().join("rgbd_dataset_freiburg2_desk");
    fs::create_dir(&named).expect("made");
    for name in ["rgb.txt", "depth.txt"] {
        fs::copy(folder.path().join(name), named.join(name)).expect("copied");
    }
    let capture = Capture::open(&named).expect("known");
    assert_eq!((capture.camera().intrinsics.fx, capture.camera().size), (520.9, [480, 640]));
}

#[test]
fn what_is_wrong_is_named_with_the_file() {
    let refused = |made: tempfile::TempDir, damage: &dyn Fn(&Path), expected: &[&str]| {
        damage(made.path());
        let read =
            |capture: Capture| (0..capture.count()).try_for_each(|index| capture.frame(index).map(drop));
        let error = Capture::open(made.path()).and_then(read).expect_err("refused").to_string();
        assert!(expected.iter().all(|part| error.contains(part)), "{error}");
        assert!(!contents(made.path()).is_empty(), "nothing is deleted");
    };
    let write = |name: &'static str, text: &'static str| {
        move |folder: &Path| fs::write(folder.join(name), text).expect("written")
    };
    let remove =
        |name: &'static str| move |folder: &Path| fs::remove_file(folder.join(name)).expect("removed");
    let truncate = |name: &'static str| {
        move |folder: &Path| {
            let bytes = fs::read(folder.join(name)).expect("read");
            fs::write(folder.join(name), &bytes[..bytes.len() / 2]).expect("written");
        }
    };
    let larger = |folder: &Path| {
        ImageBuffer::from_pixel(7, 4, Luma([1u16])).save(folder.join("depth/1.png")).expect("written");
    };
    let shallow = |folder: &Path| {
        ImageBuffer::from_pixel(6, 4, Luma([1u8])).save(folder.join("depth/1.png")).expect("written");
    };
    refused(tum(), &remove("depth/1.png"), &["depth/1.png"]);
    refused(tum(), &remove("rgb.txt"), &["neither `rgb.txt` and `depth.txt`"]);
    refused(tum(), &truncate("depth/1.png"), &["depth/1.png", "damaged image"]);
    refused(tum(), &truncate("rgb/0.png"), &["rgb/0.png", "damaged image"]);
    refused(tum(), &larger, &["depth/1.png", "7 x 4 pixels where 6 x 4 are due"]);
    refused(tum(), &shallow, &["depth/1.png", "16 bits"]);
    refused(tum(), &write("depth.txt", "5.0 depth/0.png\n"), &["no colour image has a depth image"]);
    refused(tum(), &write("rgb.txt", ""), &["no colour image has a depth image"]);
    refused(tum(), &write("rgb.txt", "1.0 rgb/0.png\nsoon rgb/1.png\n"), &["rgb.txt", "line 2", "`soon`"]);
    refused(tum(), &write("rgb.txt", "\n1.0\n"), &["rgb.txt", "line 2", "too few"]);
    for (name, text) in [("rgb.txt", "1.0 ../rgb/0.png\n"), ("depth.txt", "1.0 /etc/hostname\n")] {
        refused(tum(), &write(name, text), &[name, "line 1", "is not in the capture's folder"]);
    }
    refused(tum(), &write("groundtruth.txt", "1 0 0 0 0 0 0 3\n"), &["groundtruth.txt", "quaternion"]);
    refused(tum(), &write("camera.toml", "width = 6\n"), &["camera.toml", "missing field"]);
    refused(
        tum(),
        &write("camera.toml", "width = 6\nheight = 4\nfx = -5\nfy = 5\ncx = 2\ncy = 1\n"),
        &["camera.toml", "focal lengths"],
    );
    refused(open3d(), &remove("depth/00001.png"), &["color/00001.png", "no depth image"]);
    refused(open3d(), &remove("color/00001.png"), &["depth/00001.png", "no colour image"]);
    refused(open3d(), &remove("camera_intrinsic.json"), &["nothing says what its camera was"]);
    refused(open3d(), &write("camera_intrinsic.json", "{\"width\": 6"), &["camera_intrinsic.json"]);
    refused(
        open3d(),
        &write("trajectory.log", "0 0 1\n1 0 0 0\n"),
        &["trajectory.log", "line 1", "four lines"],
    );
    let empty = |folder: &Path| {
        for name in ["color/00000.png", "color/00001.png", "depth/00000.png", "depth/00001.png"] {
            fs::remove_file(folder.join(name)).expect("removed");
        }
    };
    refused(open3d(), &empty, &["the folder `color` holds no image"]);
}

/// World-space positions and normals of a frame's surfaces.
fn in_world(capture: &Capture, frame: &CaptureFrame) -> Vec<(Vec3, Vec3)> {
    let surface = surface(&frame.depth, &capture.camera().intrinsics);
    let pose = frame.pose.expect("a pose");
    let planes = surface.select(&[Attribute::Position, Attribute::Normal]).expect("both");
    let vector = |first: usize, pixel: usize| {
        Vec3::from_array(std::array::from_fn(|c| planes.plane(first + c)[pixel]))
    };
    let seen = surface.seen().expect("a mask");
    let pixels = (0..planes.pixels()).filter(|pixel| seen[*pixel]);
    pixels.map(|pixel| (pose.to_world(vector(0, pixel)), pose.rotation * vector(3, pixel))).collect()
}
