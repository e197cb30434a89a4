//! The threads that work for the window, what it requests from them, and what they send back.

use super::Args;
use super::design::place::{self, Asked, Found};
use super::file_worker::{self, FileResult, FileTask};
use super::method_worker::{self, MethodFrame};
use super::metrics::{self, Metrics};
use super::request_slot::RequestSlot;
use super::subject::PreparedScene;
#[cfg(feature = "train")]
use super::training_run::{self, TrainingRun};
use super::truth::{self, Truth};
use anyhow::Result;
#[cfg(feature = "train")]
use deepshade_shaders::Effect;
use eframe::egui::{ColorImage, Context};
use std::path::PathBuf;
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// What workers send to the window.
pub enum Update {
    /// Another scene was read.
    PreparedScene(Arc<PreparedScene>),
    /// A frame was made.
    Picture(Arc<MethodFrame>),
    /// Truth has more samples.
    Truth(Truth),
    /// Images were measured.
    Metrics(Metrics),
    /// A place of key frames was found, or why what was asked cannot be.
    Place(Result<Box<Found>, (Box<Asked>, String)>),
    /// A training run has come on.
    #[cfg(feature = "train")]
    TrainingRun(TrainingRun),
    /// A training of an effect has begun, in the folder of its run.
    #[cfg(feature = "train")]
    TrainingBegan(Effect, PathBuf),
    /// And ended: a note, or why it failed.
    #[cfg(feature = "train")]
    TrainingEnded(Result<String, String>),
    /// The requested picture cannot be made.
    NoPicture(String),
    /// An image of the whole window, and the file that it is for, or one that is free.
    Screenshot(Arc<ColorImage>, Option<PathBuf>),
    /// A file task is done, or why it could not be.
    File(Result<FileResult, String>),
    /// Something else cannot be done.
    Error(String),
}

/// How a worker sends updates.
pub type SendUpdate<'a> = &'a (dyn Fn(Update) + Sync);

/// The threads, and the newest request to each.
pub struct Workers {
    /// Frames by methods.
    pub methods: Arc<RequestSlot<method_worker::Request>>,
    /// Truth.
    pub truth: Arc<RequestSlot<truth::Request>>,
    /// Places of key frames, and their light.
    pub place: Arc<RequestSlot<place::Request>>,
    /// Figures of images against truth.
    pub metrics: Arc<RequestSlot<metrics::Request>>,
    /// The folder of the training run that is followed, if any.
    #[cfg(feature = "train")]
    pub training_run: Arc<RequestSlot<Option<PathBuf>>>,
    /// Files; closed when the window is.
    pub files: Option<mpsc::Sender<FileTask>>,
    /// What came of all that.
    pub updates: mpsc::Receiver<Update>,
    /// For others that send updates.
    pub sender: UpdateSender,
    /// Threads that the window's end waits for.
    quick: Vec<JoinHandle<()>>,
    /// Those that may take minutes for a result that is not wanted any more: a frame, the BVH of a large
    /// scene.
    slow: Vec<JoinHandle<()>>,
}

/// For how long the window's end waits for the slow ones.
const PATIENCE: Duration = Duration::from_millis(500);

/// Sends updates to the window and has it painted again.
#[derive(Clone)]
pub struct UpdateSender {
    channel: mpsc::Sender<Update>,
    context: Context,
}

impl UpdateSender {
    /// Sends an update.
    pub fn send(&self, update: Update) {
        // The window may have closed meanwhile.
        let _ = self.channel.send(update);
        self.context.request_repaint();
    }
}

impl Workers {
    /// Starts the threads.
    ///
    /// # Errors
    /// If the system has none to give.
    pub fn new(args: &Arc<Args>, context: &Context) -> Result<Self> {
        let (channel, updates) = mpsc::channel();
        let (files, tasks) = mpsc::channel();
        let sender = UpdateSender { channel, context: context.clone() };
        let mut workers = Self {
            methods: Arc::default(),
            truth: Arc::default(),
            place: Arc::default(),
            metrics: Arc::default(),
            #[cfg(feature = "train")]
            training_run: Arc::default(),
            files: Some(files),
            updates,
            sender: sender.clone(),
            quick: Vec::new(),
            slow: Vec::new(),
        };
        let args = Arc::clone(args);
        let methods = Arc::clone(&workers.methods);
        let run = move |send: SendUpdate<'_>| method_worker::run(&args, &methods, send);
        workers.slow.push(spawn("methods", &sender, run)?);
        let truth = Arc::clone(&workers.truth);
        workers.slow.push(spawn("truth", &sender, move |send| truth::run(&truth, send))?);
        let place = Arc::clone(&workers.place);
        workers.slow.push(spawn("place", &sender, move |send| place::run(&place, send))?);
        let metrics = Arc::clone(&workers.metrics);
        workers.slow.push(spawn("metrics", &sender, move |send| metrics::run(&metrics, send))?);
        #[cfg(feature = "train")]
        workers.quick.push({
            let run = Arc::clone(&workers.training_run);
            spawn("training run", &sender, move |send| training_run::run(&run, send))?
        });
        workers.quick.push(spawn("files", &sender, move |send| file_worker::run(tasks, send))?);
        Ok(workers)
    }
}

fn spawn(
    name: &str,
    sender: &UpdateSender,
    run: impl FnOnce(SendUpdate<'_>) + Send + 'static,
) -> Result<JoinHandle<()>> {
    let sender = sender.clone();
    Ok(thread::Builder::new().name(name.to_owned()).spawn(move || run(&|update| sender.send(update)))?)
}

impl Drop for Workers {
    /// File tasks are done to their end, so that no file is missing. What is slow and takes longer ends with
    /// the program.
    fn drop(&mut self) {
        self.methods.close();
        self.truth.close();
        self.place.close();
        self.metrics.close();
        #[cfg(feature = "train")]
        self.training_run.close();
        self.files = None;
        for thread in self.quick.drain(..) {
            // A thread that panicked has said so itself.
            let _ = thread.join();
        }
        join_within(std::mem::take(&mut self.slow), PATIENCE);
    }
}

/// Waits for threads, but for no longer than a time.
pub fn join_within(mut threads: Vec<JoinHandle<()>>, patience: Duration) {
    let closed = Instant::now();
    while !threads.is_empty() && closed.elapsed() < patience {
        for thread in threads.extract_if(.., |thread| thread.is_finished()) {
            let _ = thread.join();
        }
        thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn slow_threads_are_left_and_quick_ones_are_joined() {
        let done = Arc::new(AtomicBool::new(false));
        let (never, wakes) = mpsc::channel::<()>();
        let slow = thread::spawn(move || {
            let _ = wakes.recv();
        });
        let quick = thread::spawn({
            let done = Arc::clone(&done);
            move || {
                thread::sleep(Duration::from_millis(50));
                done.store(true, Ordering::Relaxed);
            }
        });
        let began = Instant::now();
        join_within(vec![slow, quick], Duration::from_secs(1));
        assert!(done.load(Ordering::Relaxed) && began.elapsed() < Duration::from_secs(60));
        drop(never);
        join_within(vec![thread::spawn(|| {})], Duration::from_secs(600));
        assert!(began.elapsed() < Duration::from_secs(60), "no thread is left to wait for");
    }
}
