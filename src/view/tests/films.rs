//! Films of animations.

use super::Opened;
use std::path::Path;
use std::process::Command;

/// A file in which a tile goes over another one within half a second.
fn write_moving_tile(folder: &Path) {
    let corners: [[f32; 3]; 6] =
        [[-1., 0., -1.], [1., 0., -1.], [1., 0., 1.], [-1., 0., -1.], [1., 0., 1.], [-1., 0., 1.]];
    let raised = corners.map(|[x, y, z]| [0.3 * x, y + 0.5, 0.3 * z]);
    let floats = corners.iter().chain(&raised).flatten().copied();
    let moves = [0.0f32, 0.5, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let bytes: Vec<u8> = floats.chain(moves).flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.join("tile.bin"), bytes).expect("written");
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],"scene":0,
        "nodes":[{"mesh":0},{"mesh":1}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},{"primitives":[{"attributes":{"POSITION":1}}]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
            "samplers":[{"input":2,"output":3}]}],
        "accessors":[
            {"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]},
            {"bufferView":1,"componentType":5126,"count":6,"type":"VEC3","min":[-0.3,0.5,-0.3],"max":[0.3,0.5,0.3]},
            {"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[0.5]},
            {"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":72},
            {"buffer":0,"byteOffset":144,"byteLength":8},{"buffer":0,"byteOffset":152,"byteLength":24}],
        "buffers":[{"byteLength":176,"uri":"tile.bin"}]}"#;
    std::fs::write(folder.join("tile.gltf"), text).expect("written");
}

/// Chooses frames a second, records, and waits for the film.
fn record(opened: &mut Opened, rate: f32) {
    opened.click("truth, up to");
    opened.wait_until_complete();
    opened.window_mut().state.film_rate = rate;
    opened.click("record");
    opened.wait("the film", |window| window.recording.is_none() && window.is_idle());
}

#[test]
fn an_animation_is_recorded_at_its_own_times() {
    let folder = tempfile::tempdir().expect("a folder");
    write_moving_tile(folder.path());
    let scene = folder.path().join("tile.gltf");
    let options = "--eye 1,2,2 --look-at 0,0,0 --methods gtao,hbao --radius 1";
    let mut opened = Opened::new(&format!("--scene {} {options}", scene.display()));
    opened.wait_until_complete();
    opened.click("tiles");
    record(&mut opened, 10.0);
    let path = |name: String| opened.path("film-1").join(name);
    let frame = |frame: u32| image::open(path(format!("{frame:05}.png"))).expect("a frame").to_rgb8();
    assert!(!path("00005.png".to_owned()).exists(), "half a second at 10 frames a second");
    // How far to the right it is dark, on the whole: the shade goes with the tile.
    let shade = |frame: image::RgbImage| {
        assert_eq!(frame.dimensions(), (128, 48), "two methods in a row");
        let dark = |x: u32| (0..48).map(|y| f64::from(255 - frame.get_pixel(x, y)[0])).sum::<f64>();
        (0..64).map(|x| f64::from(x) * dark(x)).sum::<f64>() / (0..64).map(dark).sum::<f64>()
    };
    let shades: Vec<f64> = (0..5).map(frame).map(shade).collect();
    assert!(shades.windows(2).all(|pair| pair[1] > pair[0] + 0.2), "{shades:?}");
    match Command::new("ffmpeg").arg("-version").output() {
        Ok(_) => assert_eq!(&std::fs::read(path("film.mp4".to_owned())).expect("a video")[4..8], b"ftyp"),
        Err(_) => assert!(opened.window().messages.note.as_ref().is_some_and(|note| note.contains("ffmpeg"))),
    }
}

#[test]
fn time_that_has_no_end_is_recorded_as_long_as_the_user_chooses() {
    let mut opened = Opened::new("--effect phosphor --methods rate-equation");
    opened.window_mut().state.film_seconds = 0.2;
    record(&mut opened, 10.0);
    let frames = [0, 1, 2].map(|frame| opened.path("film-1").join(format!("{frame:05}.png")).is_file());
    assert_eq!(frames, [true, true, false], "0.2 seconds at 10 frames a second");
}
