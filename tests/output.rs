//! Where the program writes: to people who may stop reading, and to files that may be none.

use std::process::{Command, Output, Stdio};

fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.args(args).current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A run whose output nobody reads.
fn unread(args: &[&str]) -> Output {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    run(program(args).stdout(writer))
}

fn run(command: &mut Command) -> Output {
    let run = command.stderr(Stdio::piped()).spawn().expect("starts");
    run.wait_with_output().expect("ends")
}

#[test]
fn a_reader_that_goes_away_is_no_fault_and_the_figures_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for (index, verb) in [&["scene", "--list"][..], &["scene", "stairs:7"]].into_iter().enumerate() {
        let json = folder.path().join(format!("{index}.json"));
        let output = unread(&[verb, &["--json", &json.display().to_string()]].concat());
        assert!(output.status.success(), "{verb:?}: {output:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{verb:?}");
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(json).expect("written")).expect("JSON");
        assert_eq!(json["command"], "scene");
    }
}

#[test]
fn what_is_said_before_the_work_costs_no_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let recipe = "effect = \"ao\"\nsplit = \"test\"\nseed = 5\nresolution = { height = 32, width = 32 }\n\
        samples = 4\nradius = { diagonal = 0.1 }\nviews_per_scene = 1\n\
        tiles = { samples = 8, one_in = 2, whole_frames = 0 }\nfamilies = [{ name = \"cave\", scenes = 1 }]\n";
    std::fs::write(path("test.toml"), recipe).expect("written");
    let output = unread(&["dataset", "testset", &path("test.toml"), "--out", &path("testset")]);
    let notes = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && notes.contains("from nothing"), "{output:?}");
    assert!(folder.path().join("testset/testset.json").is_file());
}

#[test]
fn a_fault_is_a_fault_even_where_nobody_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let gone = folder.path().join("gone").display().to_string();
    let output = unread(&["dataset", "verify", &gone]);
    assert!(
        !output.status.success() && String::from_utf8_lossy(&output.stderr).contains("gone"),
        "{output:?}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn figures_go_through_a_device() {
    let output = program(&["scene", "stairs:7", "--json", "/dev/stdout"]).output().expect("runs");
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8_lossy(&output.stdout);
    let end = text.rfind('}').expect("JSON") + 1;
    let json: serde_json::Value = serde_json::from_str(&text[..end]).expect("JSON first");
    assert!(json["figures"]["triangles"].is_number());
    assert!(text[end..].contains("scene      stairs"), "then what people read: {text}");
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_is_lost_is_a_fault() {
    let full = std::fs::File::options().write(true).open("/dev/full").expect("a device");
    let output = run(program(&["scene", "--list"]).stdout(full));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && !message.contains("panicked"), "{message}");
    assert!(message.contains("standard output") && message.contains("No space left"), "{message}");
}
