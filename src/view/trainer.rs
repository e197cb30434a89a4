//! A training that the window begins: `deepshade train` as a program of its own, so that neither waits for the other. The window
//! follows its run as it follows any, and interrupts it when it is told to or ends itself; the same wish goes on from its newest
//! checkpoint.

use super::caught::caught;
use super::desk::{News, leave};
use super::window::Window;
use crate::output::message;
use anyhow::{Context as _, Result, bail, ensure};
use deepshade_dataset::Manifest;
use deepshade_dataset::holder::Holder;
use deepshade_train::{TrainError, is_taken};
use eframe::egui::{Button, TextEdit, Ui};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// For how long an interrupted program may go on until nobody waits for it.
const PATIENCE: Duration = Duration::from_secs(2);
/// How often it is looked whether a program has begun.
const GLANCE: Duration = Duration::from_millis(100);

/// What hands want to be trained.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wish {
    /// Folder of the dataset.
    pub dataset: String,
    /// Folder of the run; where nothing is said, below `runs`, called as the dataset is.
    pub run: String,
    /// What else `deepshade train` is told.
    pub options: String,
}

impl Wish {
    /// What a line of a script says: the dataset, the run, options.
    ///
    /// # Errors
    /// If it says less.
    pub fn parse(line: &str) -> Result<Self> {
        let mut words = line.split_whitespace();
        let (Some(dataset), Some(run)) = (words.next(), words.next()) else {
            bail!("it takes a dataset and a folder for the run, and then options of `deepshade train`");
        };
        let options = words.collect::<Vec<_>>().join(" ");
        Ok(Self { dataset: dataset.to_owned(), run: run.to_owned(), options })
    }

    /// The folder of the run.
    fn folder(&self) -> PathBuf {
        let dataset = Path::new(self.dataset.trim());
        match self.run.trim() {
            "" => Path::new("runs").join(dataset.file_name().unwrap_or_default()),
            run => run.into(),
        }
    }
}

/// A training under way.
pub struct Trainer {
    /// The folder of its run.
    pub folder: PathBuf,
    /// Whether the program has taken the run's folder: nothing has been refused.
    pub has_begun: bool,
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

impl Trainer {
    /// Begins, and tells of that and of the end.
    ///
    /// # Errors
    /// If nothing is wished for, or something at an address, or the system has no thread to give.
    pub fn begin(wish: &Wish, tell: impl Fn(News) + Send + 'static) -> Result<Self> {
        ensure!(!wish.dataset.trim().is_empty(), "which dataset? `deepshade dataset generate` makes one");
        for place in [&wish.dataset, &wish.run] {
            // A run is followed in its folder, and in a store it is none before it ends.
            ensure!(
                !place.contains("://"),
                "{}: the window trains in folders of this machine; `deepshade train` takes addresses, too",
                place.trim()
            );
        }
        let (folder, running) = (wish.folder(), Arc::<Mutex<Running>>::default());
        let thread = thread::Builder::new().name("trainer".to_owned()).spawn({
            let (wish, folder, running) = (wish.clone(), folder.clone(), Arc::clone(&running));
            move || {
                let ended = caught("training", || train(&wish, &folder, &running, &tell));
                tell(News::TrainingEnded(ended.map_err(|error| format!("training: {}", message(&error)))));
            }
        })?;
        Ok(Self { folder, has_begun: false, running, thread: Some(thread) })
    }

    /// Interrupts it, as Ctrl-C does.
    pub fn stop(&self) {
        let mut running = locked(&self.running);
        running.stopped = true;
        running.child.iter_mut().for_each(interrupt);
    }
}

impl Drop for Trainer {
    /// A window leaves nothing running that nobody sees.
    fn drop(&mut self) {
        self.stop();
        leave(self.thread.take().into_iter().collect(), PATIENCE);
    }
}

/// Runs the program to its end, and says how that came.
fn train(wish: &Wish, folder: &Path, running: &Mutex<Running>, tell: &impl Fn(News)) -> Result<String> {
    let dataset = Path::new(wish.dataset.trim());
    let effect = Manifest::load(dataset)?.origin.recipe.effect;
    if is_taken(folder) {
        return Err(TrainError::Busy { folder: folder.to_owned(), holder: Holder::of(folder) }.into());
    }
    let mut child = Command::new(std::env::current_exe().context("the program's own file")?)
        .arg("train")
        .arg("--dataset")
        .arg(dataset)
        .arg("--out")
        .arg(folder)
        .args(wish.options.split_whitespace())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .context("`deepshade train` does not start")?;
    let (process, stderr) = (child.id(), child.stderr.take());
    {
        let mut running = locked(running);
        if running.stopped {
            interrupt(&mut child);
        }
        running.child = Some(child);
    }
    let began = || tell(News::TrainingBegan(effect, folder.to_owned()));
    let (said, has_begun) = thread::scope(|scope| {
        let words = scope.spawn(|| stderr.map(|said| last_words(BufReader::new(said))));
        let has_begun = is_taken_before(folder, process, || words.is_finished());
        if has_begun {
            began();
        }
        (words.join().ok().flatten().unwrap_or_default(), has_begun)
    });
    // It says nothing more: it is at its end.
    let (child, stopped) = {
        let mut running = locked(running);
        (running.child.take(), running.stopped)
    };
    let is_done = child.map(|mut child| child.wait()).transpose()?.is_some_and(|status| status.success());
    if is_done && !has_begun {
        began();
    }
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

/// Waits for a process to take a run's folder. Whether it has before it was over; one that the run there refuses lets go of it at once.
fn is_taken_before(folder: &Path, process: u32, is_over: impl Fn() -> bool) -> bool {
    let mut looks = 0;
    while looks < 2 && !is_over() {
        thread::sleep(GLANCE);
        looks = if Holder::is(folder, process) { looks + 1 } else { 0 };
    }
    looks == 2 && !is_over()
}

/// Nothing is lost by it: whatever is written is whole at every moment.
fn interrupt(child: &mut Child) {
    #[cfg(unix)]
    let _ =
        rustix::process::kill_process(rustix::process::Pid::from_child(child), rustix::process::Signal::INT);
    #[cfg(not(unix))]
    let _ = child.kill();
}

/// Whoever panicked while it held the lock has left what is whole: it is moved in and out at once.
fn locked(running: &Mutex<Running>) -> MutexGuard<'_, Running> {
    running.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a program says at its end: why it fails, else its last line. All of it is read, so that it never waits for its reader.
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

impl Window {
    /// Begins the training that is wished for.
    pub fn train(&mut self) {
        if self.trainer.is_some() {
            return self.refuse("a training is under way: stop it first".to_owned());
        }
        match self.begin_training() {
            Ok(trainer) => self.trainer = Some(trainer),
            Err(error) => self.refuse(message(&error)),
        }
    }
}

/// What hands can train, or stop.
pub fn show(ui: &mut Ui, window: &mut Window) {
    if let Some(trainer) = &window.trainer {
        ui.horizontal_wrapped(|ui| {
            ui.label(format!("training {}", trainer.folder.display()));
            let hint = "the same wish goes on from its newest checkpoint; the window's end stops it, too";
            if ui.button("stop").on_hover_text(hint).clicked() {
                trainer.stop();
            }
        });
        return;
    }
    let training = ui.collapsing("train a network", |ui| {
        let usual = window.wish.folder().display().to_string();
        let Wish { dataset, run, options } = &mut window.wish;
        let field = |text, hint: &str| TextEdit::singleline(text).hint_text(hint.to_owned());
        ui.add(field(dataset, "folder of a dataset")).on_hover_text("what `deepshade dataset generate` made");
        let run = ui.add(field(run, &format!("folder of the run: {usual}")));
        run.on_hover_text("where checkpoints are kept; a run that lies there goes on");
        let options = ui.add(field(options, "options, such as --steps 20000"));
        options.on_hover_text("what else `deepshade train` is told");
        let train = ui.add_enabled(!dataset.trim().is_empty(), Button::new("train"));
        let train = train.on_disabled_hover_text("the folder of a dataset is missing");
        if train.on_hover_text("begins; the network is shown as it learns").clicked() {
            window.train();
        }
    });
    training.header_response.on_hover_text("of a dataset, beside the images, by `deepshade train`");
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_wish_is_a_dataset_a_run_and_options() {
        let wish = Wish::parse(" data/ao  runs/a --steps 20 --crop 64").expect("a wish");
        assert_eq!((wish.dataset.as_str(), wish.options.as_str()), ("data/ao", "--steps 20 --crop 64"));
        assert_eq!(wish.folder(), Path::new("runs/a"));
        assert_eq!(Wish { run: " ".to_owned(), ..wish }.folder(), Path::new("runs/ao"));
        assert!(Wish::parse("data/ao").is_err());
        assert!(Trainer::begin(&Wish::default(), |_| {}).is_err());
        for line in ["s3://sets/ao runs/a", "data/ao s3://runs/a"] {
            let refused = Trainer::begin(&Wish::parse(line).expect("a wish"), |_| {}).err().expect(line);
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
    fn a_training_has_begun_once_its_folder_is_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let this = std::process::id();
        let begins = |process: u32| {
            let looks = Cell::new(0);
            is_taken_before(folder, process, || {
                looks.set(looks.get() + 1);
                looks.get() > 5
            })
        };
        assert!(!begins(this), "it was refused");
        let _holder = Holder::sign(folder);
        assert!(begins(this));
        assert!(!begins(this + 1), "it is another's");
    }

    #[test]
    fn what_is_no_dataset_is_told() {
        let (sender, told) = std::sync::mpsc::channel();
        let folder = tempfile::tempdir().expect("a folder");
        let wish = Wish { dataset: folder.path().display().to_string(), ..Wish::default() };
        let trainer = Trainer::begin(&wish, move |news| drop(sender.send(news))).expect("begins");
        let ended = told.recv().expect("its end");
        assert!(matches!(ended, News::TrainingEnded(Err(what)) if what.contains("manifest")));
        drop(trainer);
    }
}
