use super::plan::Plan;
use super::record::{End, Record, Try};
use super::status::Progress;
use super::submit::ranges;
use super::{Engine, kubernetes, ray, slurm};
use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

fn plan(engine: Engine) -> Plan {
    let plan = serde_json::json!({
        "version": 1, "recipe": "/data/it's a recipe.toml", "recipe_blake3": "", "scenes": null, "out": "s3://bucket/ao",
        "shards": 12, "pairs": 100, "engine": engine, "cores": 4, "minutes": 90, "retries": 3,
        "program": "/opt/it's/deepshade", "image": "registry/deepshade:1",
    });
    serde_json::from_value(plan).expect("a plan")
}

/// What a program makes of a text that it reads, if the program is there.
fn read_by(program: &str, args: &[&str], text: &str) -> Option<bool> {
    let child = Command::new(program).args(args).stdin(Stdio::piped()).stderr(Stdio::inherit()).spawn();
    let mut child = child.ok()?;
    child.stdin.take().expect("piped").write_all(text.as_bytes()).expect("read");
    Some(child.wait().expect("ends").success())
}

#[test]
fn slurms_script_is_one_that_bash_reads_with_paths_as_they_are() {
    let script = slurm::script(&plan(Engine::Slurm), Path::new("/jobs/100 %")).expect("a script");
    for line in [
        "#SBATCH --job-name=deepshade-it-s-a-recipe",
        "#SBATCH --array=1-12",
        "#SBATCH --cpus-per-task=4",
        "#SBATCH --time=90",
        "#SBATCH --output=\"/jobs/100 %%/logs/%a.log\"",
        r#"'/opt/it'\''s/deepshade' farm work '/jobs/100 %' --shard "$SLURM_ARRAY_TASK_ID" && exit 0"#,
        "if [ \"${SLURM_RESTART_COUNT:-0}\" -lt 3 ]; then",
    ] {
        assert!(script.lines().any(|found| found == line), "{line}\nnot in\n{script}");
    }
    assert_ne!(read_by("bash", &["-n"], &script), Some(false));
    assert_eq!(
        read_by("bash", &["-n"], "if"),
        read_by("bash", &["-n"], "").map(|sound| !sound),
        "bash tells"
    );
    assert!(slurm::script(&plan(Engine::Slurm), Path::new("/a\n#SBATCH --uid=0")).is_err());
}

#[test]
fn rays_script_is_one_that_python_reads() {
    let check = "import ast, sys; ast.parse(sys.stdin.read())";
    assert_ne!(read_by("python3", &["-c", check], ray::SCRIPT), Some(false));
}

#[test]
fn kubernetes_job_has_one_index_a_shard_and_its_own_retries() {
    let text = kubernetes::job(&plan(Engine::Kubernetes), Path::new("/jobs")).expect("a job");
    let job: Value = serde_json::from_str(&text).expect("JSON");
    let spec = &job["spec"];
    assert_eq!((&spec["completionMode"], &spec["completions"]), (&"Indexed".into(), &12.into()));
    assert_eq!((&spec["backoffLimitPerIndex"], &spec["maxFailedIndexes"]), (&3.into(), &12.into()));
    let container = &spec["template"]["spec"]["containers"][0];
    assert_eq!(container["image"], "registry/deepshade:1");
    // The shell gets what the index stands for.
    let words: Vec<&str> =
        container["command"].as_array().expect("words").iter().filter_map(Value::as_str).collect();
    let said = words[2].replace("exec", "echo");
    let mut shell = Command::new("sh");
    shell.args(["-c", &said, words[3], words[4]]).env("JOB_COMPLETION_INDEX", "11");
    let output = shell.output().expect("a shell");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said, "/opt/it's/deepshade farm work /jobs --shard 12\n");
}

#[test]
fn numbers_are_written_as_ranges() {
    assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
    assert_eq!(ranges(&[4]), "4");
}

#[test]
fn progress_is_what_records_say() {
    let jobs = tempfile::tempdir().expect("a folder");
    let plan = plan(Engine::Slurm);
    let shards: Vec<_> = plan.shards().collect();
    let one = |end: Option<End>| Try { worker: "process 1".to_owned(), end };
    let failed = || End::Failed { seconds: 1800.0, error: "no light".to_owned() };
    let made = End::Made { seconds: 3600.0, rendered: 5, pairs: 8, bytes: 100 };
    for (shard, tries) in [
        (shards[0], vec![one(Some(failed())), one(None), one(Some(made))]),
        (shards[1], vec![one(Some(failed()))]),
        (shards[2], vec![one(Some(failed())), one(None)]),
    ] {
        Record { tries }.save(jobs.path(), shard).expect("saved");
    }
    let progress = Progress::of(&plan, jobs.path()).expect("read");
    assert_eq!((progress.made, progress.tries, progress.pairs, progress.rendered), (1, 6, 8, 5));
    assert_eq!(progress.failed, [(shards[1], "no light".to_owned())]);
    assert_eq!(progress.begun, [shards[2]]);
    assert!((progress.hours - 2.5).abs() < 1e-9);
}
