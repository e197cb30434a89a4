//! A training that the window begins: `deepshade train` as a program of its own, so that neither waits for
//! the other. The window follows its run as it follows any, and interrupts it when it is told to or ends
//! itself; the same choice goes on from its newest checkpoint.

use super::catch_panic::catch_panic;
use super::workers::{Update, join_within};
use crate::output::message;
use anyhow::{Context as _, Result, bail, ensure};
use deepshade_dataset::Manifest;
use deepshade_dataset::holder::Holder;
use deepshade_train::{TrainError, is_taken};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// For how long an interrupted program may go on until nobody waits for it.
const PATIENCE: Duration = Duration::from_secs(2);

/// What the user wants to be trained.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrainingOptions {
    /// Folder of the dataset.
    pub dataset: String,
    /// Folder of the run; where nothing is said, below `runs`, called as the dataset is.
    pub run: String,
    /// What else `deepshade train` is told.
    pub options: String,
}

impl TrainingOptions {
    /// The folder of the run.
    pub fn folder(&self) -> PathBuf {
        let dataset = Path::new(self.dataset.trim());
        match self.run.trim() {
            "" => Path::new("runs").join(dataset.file_name().unwrap_or_default()),
            run => run.into(),
        }
    }
}

/// A training under way.
pub struct TrainingProcess {
    /// The folder of its run.
    pub folder: PathBuf,
    running: Arc<Mutex<Running>>,
    thread: Option<JoinHandle<()>>,
}

/// What two threads know of the program.
#[derive(Default)]
struct Running {
    /// It, from its beginning to its end.
    child: Option<Child>,
    /// Whether it was told to end.
    stopped: bool,
}

impl TrainingProcess {
    /// Begins by a program `deepshade`, and sends updates on its beginning and its end.
    ///
    /// # Errors
    /// If no dataset is chosen, or something at an address, or the system has no thread to give.
    pub fn begin(
        program: PathBuf,
        options: &TrainingOptions,
        send: impl Fn(Update) + Send + 'static,
    ) -> Result<Self> {
        ensure!(!options.dataset.trim().is_empty(), "which dataset? `deepshade dataset generate` makes one");
        for place in [&options.dataset, &options.run] {
            // A run is followed in its folder, and in a store it is none before it ends.
            ensure!(
                !place.contains("://"),
                "{}: the window trains in folders of this machine; `deepshade train` takes addresses, too",
                place.trim()
            );
        }
        let (folder, running) = (options.folder(), Arc::<Mutex<Running>>::default());
        let thread = thread::Builder::new().name("training".to_owned()).spawn({
            let (options, folder, running) = (options.clone(), folder.clone(), Arc::clone(&running));
            move || {
                let ended = catch_panic("training", || train(&program, &options, &folder, &running, &send));
                send(Update::TrainingEnded(ended.map_err(|error| format!("training: {}", message(&error)))));
            }
        })?;
        Ok(Self { folder, running, thread: Some(thread) })
    }

    /// Interrupts it, as Ctrl-C does.
    pub fn stop(&self) {
        let mut running = locked(&self.running);
        running.stopped = true;
        running.child.iter_mut().for_each(interrupt);
    }
}

impl Drop for TrainingProcess {
    /// A window leaves nothing running that nobody sees.
    fn drop(&mut self) {
        self.stop();
        join_within(self.thread.take().into_iter().collect(), PATIENCE);
    }
}

/// Runs the program to its end, and says how that came.
fn train(
    program: &Path,
    options: &TrainingOptions,
    folder: &Path,
    running: &Mutex<Running>,
    send: &impl Fn(Update),
) -> Result<String> {
    let dataset = Path::new(options.dataset.trim());
    let effect = Manifest::load(dataset)?.origin.recipe.effect;
    if is_taken(folder) {
        return Err(TrainError::Busy { folder: folder.to_owned(), holder: Holder::of(folder) }.into());
    }
    let mut child = Command::new(program)
        .arg("train")
        .arg("--dataset")
        .arg(dataset)
        .arg("--out")
        .arg(folder)
        .args(options.options.split_whitespace())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .context("`deepshade train` does not start")?;
    let stderr = child.stderr.take();
    {
        let mut running = locked(running);
        if running.stopped {
            interrupt(&mut child);
        }
        running.child = Some(child);
    }
    send(Update::TrainingBegan(effect, folder.to_owned()));
    let said = stderr.map(|said| last_words(BufReader::new(said))).unwrap_or_default();
    // It says nothing more: it is at its end.
    let (child, stopped) = {
        let mut running = locked(running);
        (running.child.take(), running.stopped)
    };
    let is_done = child.map(|mut child| child.wait()).transpose()?.is_some_and(|status| status.success());
    let place = folder.display();
    match (is_done, stopped) {
        (true, _) => Ok(format!("{place} is trained")),
        (false, true) if said.is_empty() => {
            Ok(format!("training in {place} was stopped; it goes on from its newest checkpoint"))
        }
        // It says at which step.
        (false, true) => Ok(said),
        (false, false) => bail!("{said}"),
    }
}

/// Nothing is lost by it: whatever is written is whole at every moment.
fn interrupt(child: &mut Child) {
    #[cfg(unix)]
    let _ =
        rustix::process::kill_process(rustix::process::Pid::from_child(child), rustix::process::Signal::INT);
    #[cfg(not(unix))]
    let _ = child.kill();
}

/// A thread that panicked while it held the lock has left a whole value: it is moved in and out at once.
fn locked(running: &Mutex<Running>) -> MutexGuard<'_, Running> {
    running.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a program says at its end: why it fails, else its last line. All of it is read, so that it never
/// waits for its reader.
fn last_words(said: impl BufRead) -> String {
    /// Letters of a message that can be read in a window.
    const LONGEST: usize = 600;
    let mut words = String::new();
    for line in said.split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        match line.trim() {
            "" => {}
            line if words.starts_with("error: ") && words.len() < LONGEST => words += &format!(" {line}"),
            line => line.clone_into(&mut words),
        }
    }
    words.strip_prefix("error: ").map(str::to_owned).unwrap_or(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(dataset: &str, run: &str) -> TrainingOptions {
        TrainingOptions { dataset: dataset.to_owned(), run: run.to_owned(), options: String::new() }
    }

    #[test]
    fn a_dataset_and_a_folder_of_this_machine_are_needed() {
        assert_eq!(options(" data/ao", " runs/a ").folder(), Path::new("runs/a"));
        assert_eq!(options("data/ao ", " ").folder(), Path::new("runs/ao"));
        let begin = |options| TrainingProcess::begin(PathBuf::new(), &options, |_| {});
        assert!(begin(options("", "runs/a")).is_err());
        for (dataset, run) in [("s3://sets/ao", "runs/a"), ("data/ao", "s3://runs/a")] {
            let refused = begin(options(dataset, run)).err().expect("no address");
            assert!(refused.to_string().contains("folders of this machine"), "{refused}");
        }
    }

    #[test]
    fn the_last_words_are_why_it_fails() {
        let words = |said: &[u8]| last_words(said);
        assert_eq!(words(b"step 1\nstep 2\n\n"), "step 2");
        assert_eq!(words(b"step 1\nerror: no such option\n\n  --stepz\n"), "no such option --stepz");
        assert_eq!(words(b"\xff\n"), "\u{fffd}");
        assert_eq!(words(b""), "");
    }

    #[test]
    fn what_is_no_dataset_is_told() {
        let (sender, told) = std::sync::mpsc::channel();
        let folder = tempfile::tempdir().expect("a folder");
        let options = options(&folder.path().display().to_string(), "");
        let send = move |update| drop(sender.send(update));
        let process = TrainingProcess::begin(PathBuf::new(), &options, send).expect("begins");
        let ended = told.recv().expect("its end");
        assert!(matches!(ended, Update::TrainingEnded(Err(what)) if what.contains("manifest")));
        drop(process);
    }

    /// The program beside the tests, which cargo makes for those of the whole workspace.
    fn program() -> PathBuf {
        let own = std::env::current_exe().expect("this test");
        let folder = own.ancestors().nth(2).expect("deps are in a folder");
        let program = folder.join(format!("deepshade{}", std::env::consts::EXE_SUFFIX));
        assert!(program.is_file(), "no {}: `cargo build --release` makes it", program.display());
        program
    }

    #[test]
    fn a_training_begins_and_is_stopped_and_a_wrong_option_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name).display().to_string();
        let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
        let mut generate = Command::new(program());
        generate.args(["dataset", "generate", "--out", &place("data")]).arg(recipe);
        assert!(generate.output().expect("starts").status.success());
        let begin = |words: &str| {
            let (sender, updates) = std::sync::mpsc::channel();
            let words = format!("--batch 2 --crop 64 {words}");
            let options = TrainingOptions { options: words, ..options(&place("data"), &place("run")) };
            let send = move |update| drop(sender.send(update));
            (TrainingProcess::begin(program(), &options, send).expect("begins"), updates)
        };
        let (process, updates) = begin("--steps 1000000");
        let began = updates.recv().expect("its beginning");
        assert!(matches!(began, Update::TrainingBegan(deepshade_shaders::Effect::Ao, _)));
        // It takes the interruption once it has taken the run's folder.
        while !is_taken(Path::new(&place("run"))) {
            thread::sleep(Duration::from_millis(20));
        }
        process.stop();
        assert!(matches!(updates.recv().expect("its end"), Update::TrainingEnded(Ok(_))));
        let (_process, updates) = begin("--stepz 1");
        let ended = updates.iter().last().expect("its end");
        assert!(matches!(ended, Update::TrainingEnded(Err(error)) if error.contains("--stepz")));
    }
}
