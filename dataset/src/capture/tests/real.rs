//! Frames of the TUM benchmark and of ICL-NUIM, laid out as these are: what they show agrees between frames,
//! and the floor is where it is.

use super::*;

#[path = "../../../../render/tests/real_data/mod.rs"]
mod real_data;

/// The folder of one of the captures; `None`, with a line on stderr, where it is not.
fn captured(name: &str) -> Option<PathBuf> {
    let folder = real_data::data()?.join("rgbd").join(name);
    if !folder.is_dir() {
        eprintln!("{name} is not tested: no {}", folder.display());
        return None;
    }
    Some(folder)
}

/// A list of frames with the intrinsics in its head, laid out as the TUM benchmark has it.
fn as_tum(source: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let list = fs::read_to_string(source.join("frames.tsv")).expect("a list");
    let stated = |key: &str| {
        let from = list.split(&format!("{key}=")).nth(1).expect("in the head");
        from.split([' ', ';']).next().expect("a number").trim().to_owned()
    };
    let [fx, fy, cx, cy] = ["fx", "fy", "cx", "cy"].map(stated);
    let camera = format!("width = 640\nheight = 480\nfx = {fx}\nfy = {fy}\ncx = {cx}\ncy = {cy}\n");
    fs::write(folder.path().join("camera.toml"), camera).expect("written");
    let mut texts = [const { String::new() }; 3];
    for line in list.lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (index, pose) = (words[0], words[words.len() - 7..].join(" "));
        // The TUM frames say when colour and depth were taken, the others do not.
        let time = |word: usize| match words.len() {
            10 => words[word].trim_end_matches(".png").to_owned(),
            _ => index.to_owned(),
        };
        for (text, what) in texts.iter_mut().zip([
            format!("{} {index}_rgb.jpg\n", time(1)),
            format!("{} {index}_depth.png\n", time(2)),
            format!("{} {pose}\n", time(1)),
        ]) {
            text.push_str(&what);
        }
        for name in [format!("{index}_rgb.jpg"), format!("{index}_depth.png")] {
            fs::copy(source.join(&name), folder.path().join(&name)).expect("copied");
        }
    }
    for (text, name) in texts.iter().zip(["rgb.txt", "depth.txt", "groundtruth.txt"]) {
        fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

/// The share of what both frames see of `points` of the first that lies where the second has its surface,
/// within 3 % of the depth; points that something is in front of do not count.
fn agreement(capture: &Capture, points: &[Vec3], second: &CaptureFrame) -> f64 {
    let intrinsics = capture.camera().intrinsics;
    let pose = second.pose.expect("a pose");
    let (mut agreeing, mut seen) = (0, 0);
    for point in points {
        let point = pose.to_camera(*point);
        let x = intrinsics.centre.x - intrinsics.fx * point.x / point.z;
        let y = intrinsics.centre.y + intrinsics.fy * point.y / point.z;
        let inside = point.z < 0.0 && (0.0..640.0).contains(&x) && (0.0..480.0).contains(&y);
        let depth = if inside { second.depth.at(0, y as usize, x as usize) } else { 0.0 };
        if depth > 0.0 && -point.z < 1.03 * depth + 0.3 {
            seen += 1;
            agreeing += usize::from((-point.z - depth).abs() < 0.03 * depth);
        }
    }
    assert!(seen > 10_000, "{seen} points are seen twice");
    f64::from(agreeing as u32) / f64::from(seen as u32)
}

#[test]
fn frames_of_the_tum_benchmark_show_the_same_desk() {
    let Some(source) = captured("tum_fr1_rpy") else { return };
    let folder = as_tum(&source);
    let capture = Capture::open(folder.path()).expect("a capture");
    assert_eq!(capture.count(), 12);
    let frames = [7, 8].map(|index| capture.frame(index).expect("a frame"));
    let surfaces = in_world(&capture, &frames[0]);
    let points: Vec<Vec3> = surfaces.iter().map(|(position, _)| *position).collect();
    let right = agreement(&capture, &points, &frames[1]);
    // The control: a camera whose y axis was not turned over.
    let pose = frames[0].pose.expect("a pose");
    let flipped = |point: &Vec3| pose.to_world(pose.to_camera(*point) * Vec3::new(1.0, -1.0, 1.0));
    let wrong = agreement(&capture, &points.iter().map(flipped).collect::<Vec<_>>(), &frames[1]);
    assert!(right > 0.8 && wrong < 0.5, "{right} of the points agree, flipped {wrong}");
    // Most of what a hand-held camera sees at a desk is seen from above; z is up there.
    let share = |up: f32| {
        surfaces.iter().filter(|(_, normal)| up * normal.z > 0.966).count() as f64 / surfaces.len() as f64
    };
    assert!(share(1.0) > 0.2 && share(-1.0) < 0.02, "{} up, {} down", share(1.0), share(-1.0));
    // Kinects leave holes, and not many.
    let seen = surfaces.len() as f64 / (640.0 * 480.0);
    assert!((0.5..0.98).contains(&seen), "{seen} of the pixels have a normal");
}

#[test]
fn a_living_room_of_icl_nuim_stands_upright_though_its_focal_length_is_negative() {
    let Some(source) = captured("icl_nuim") else { return };
    let folder = as_tum(&source);
    let capture = Capture::open(folder.path()).expect("a capture");
    assert!(capture.camera().y_up && capture.camera().intrinsics.fy == 480.0);
    let (mut upright, mut all) = (0, 0);
    for index in 0..3 {
        let surfaces = in_world(&capture, &capture.frame(index).expect("a frame"));
        // Free of noise: walls, floor and ceiling stand at right angles.
        upright += surfaces.iter().filter(|(_, normal)| normal.abs().max_element() > 0.999).count();
        all += surfaces.len();
        let mean = |up: f32| {
            let heights: Vec<f32> =
                surfaces.iter().filter(|(_, n)| up * n.y > 0.999).map(|(p, _)| p.y).collect();
            (!heights.is_empty()).then(|| heights.iter().sum::<f32>() / heights.len() as f32)
        };
        if let (Some(floor), Some(ceiling)) = (mean(1.0), mean(-1.0)) {
            assert!(floor < ceiling, "frame {index}: floor at {floor} m, ceiling at {ceiling} m");
        }
    }
    assert!(upright > 7 * all / 10 && all > 900_000, "{upright} of {all} pixels");
}
