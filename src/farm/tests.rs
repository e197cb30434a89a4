use super::plan::FarmPlan;
use super::{Engine, RAY_TASKS, kubernetes, slurm};
use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

fn plan(engine: Engine) -> FarmPlan {
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
        "#SBATCH --time=92",
        "#SBATCH --output=\"/jobs/100 %%/logs/%a.log\"",
        "#SBATCH --requeue",
        "#SBATCH --signal=B:USR1@30",
        r#"'/opt/it'\''s/deepshade' farm work '/jobs/100 %' --shard "$SLURM_ARRAY_TASK_ID" &"#,
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

/// When Slurm says that a task's time is all but up.
#[cfg(unix)]
#[derive(Clone, Copy, PartialEq, Eq)]
enum Signal {
    Never,
    /// As the script has begun its program, and does not know it yet.
    Early,
    AtWork,
}

/// Runs a task's script with a program and a Slurm of a few lines of shell; gives its code and what it asked
/// of Slurm.
#[cfg(unix)]
fn task(work: &str, restarts: u32, signal: Signal) -> (Option<i32>, String) {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let asked = folder.path().join("asked");
    for (name, text) in [
        ("work", format!("#!/bin/bash\ntouch '{}/started'\n{work}\n", folder.path().display())),
        ("scontrol", format!("#!/bin/bash\necho \"$@\" > '{}'\n", asked.display())),
        // Before each command of a script bash does what it traps as DEBUG.
        ("early", r#"trap '[ "$BASH_COMMAND" = "worker=\$!" ] && kill -USR1 $$' DEBUG"#.into()),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("allowed");
    }
    let mut plan = plan(Engine::Slurm);
    plan.program = folder.path().join("work");
    let script = folder.path().join("slurm.sh");
    std::fs::write(&script, slurm::script(&plan, folder.path()).expect("a script")).expect("written");
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap_or_default());
    let mut bash = Command::new("bash");
    bash.arg(&script).env("PATH", path).env("SLURM_ARRAY_JOB_ID", "12").env("SLURM_ARRAY_TASK_ID", "7");
    if signal == Signal::Early {
        bash.env("BASH_ENV", folder.path().join("early"));
    }
    let mut child = bash.env("SLURM_RESTART_COUNT", restarts.to_string()).spawn().expect("bash");
    if signal == Signal::AtWork {
        while !folder.path().join("started").exists() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let told = Command::new("kill").args(["-USR1", &child.id().to_string()]).status();
        assert!(told.expect("kill").success());
    }
    let code = child.wait().expect("ends").code();
    (code, std::fs::read_to_string(asked).unwrap_or_default())
}

#[cfg(unix)]
#[test]
fn a_task_of_slurm_puts_itself_back_where_it_fails_or_its_time_is_up() {
    let back = "requeue 12_7\n".to_owned();
    assert_eq!(task("exit 0", 0, Signal::Never), (Some(0), String::new()));
    assert_eq!(task("exit 3", 0, Signal::Never), (Some(3), back.clone()));
    assert_eq!(task("exit 3", 2, Signal::Never), (Some(3), back.clone()));
    assert_eq!(task("exit 3", 3, Signal::Never), (Some(3), String::new()), "its retries are used up");
    // As the program does it, which ends its pair's tile first.
    let stuck = "trap 'exit 143' TERM\nwhile true; do sleep 0.01; done";
    assert_eq!(task(stuck, 0, Signal::AtWork), (Some(143), back.clone()));
    assert_eq!(task(stuck, 0, Signal::Early), (Some(143), back));
    assert_eq!(task(stuck, 3, Signal::AtWork), (Some(143), String::new()));
}

#[test]
fn rays_script_is_one_that_python_reads() {
    let check = "import ast, sys; ast.parse(sys.stdin.read())";
    assert_ne!(read_by("python3", &["-c", check], RAY_TASKS), Some(false));
}

#[test]
fn kubernetes_job_has_one_index_a_shard_and_its_own_retries() {
    let text = kubernetes::job(&plan(Engine::Kubernetes), Path::new("/jobs")).expect("a job");
    let job: Value = serde_json::from_str(&text).expect("JSON");
    let spec = &job["spec"];
    assert_eq!((&spec["completionMode"], &spec["completions"]), (&"Indexed".into(), &12.into()));
    assert_eq!((&spec["backoffLimitPerIndex"], &spec["maxFailedIndexes"]), (&3.into(), &12.into()));
    let pod = &spec["template"]["spec"];
    assert_eq!(pod["activeDeadlineSeconds"], 90 * 60);
    let container = &pod["containers"][0];
    assert_eq!(container["image"], "registry/deepshade:1");
    let secret = serde_json::json!([{ "secretRef": { "name": "deepshade", "optional": true } }]);
    assert_eq!(container["envFrom"], secret, "without one that is not needed, too");
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
fn kubernetes_shards_are_where_its_volume_is() {
    let way = |out: &str, jobs: &str| super::plan::in_volume(Path::new(out), Path::new(jobs));
    assert_eq!(way("/jobs/ao/shards", "/jobs/ao").expect("below"), Path::new("shards"));
    assert_eq!(way("jobs/shards/1", "./jobs").expect("below"), Path::new("shards/1"));
    for out in ["/elsewhere/ao", "/jobs/ao2", "/jobs/ao/../ao2", "/jobs"] {
        let error = way(out, "/jobs/ao").expect_err(out).to_string();
        assert!(error.contains(out) && error.contains("/jobs/ao/shards"), "{error}");
    }
}

#[test]
fn missing_shards_are_handed_to_the_engine_by_its_own_command() {
    let said = |engine: Engine, shards: &[usize]| engine.command(Path::new("/jobs"), shards);
    assert_eq!(said(Engine::Slurm, &[]), "sbatch /jobs/slurm.sh");
    assert_eq!(said(Engine::Slurm, &[2, 5]), "sbatch --array=2,5 /jobs/slurm.sh");
    assert_eq!(said(Engine::Ray, &[]), "python3 /jobs/ray_tasks.py");
    assert_eq!(said(Engine::Ray, &[2, 5]), "python3 /jobs/ray_tasks.py 2 5");
    assert_eq!(said(Engine::Kubernetes, &[2]), "kubectl replace --force -f /jobs/kubernetes.json");
}
