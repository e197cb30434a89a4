//! The threads that work for the window, where it puts its orders, and what it hears from them.

use super::Args;
use super::clerk::{self, Done, Errand};
use super::judge::{self, Verdict};
use super::layers::{self, Choice};
use super::mailbox::Mailbox;
use super::pictures::Developed;
use super::studio::{self, Picture};
use super::subject::Subject;
#[cfg(feature = "train")]
use super::trainer::{Trainer, Wish};
#[cfg(feature = "train")]
use super::training::{self, Training};
use super::truth::{self, Truth};
use anyhow::Result;
#[cfg(feature = "train")]
use deepshade_shaders::Effect;
use eframe::egui::Context;
#[cfg(feature = "train")]
use std::path::PathBuf;
use std::sync::{Arc, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// What threads tell the window.
pub enum News {
    /// Another scene was read.
    Subject(Arc<Subject>),
    /// A frame was made.
    Picture(Arc<Picture>),
    /// Truth is better known.
    Truth(Truth),
    /// Images were judged.
    Judged(Verdict),
    /// Layers of an EXR file were developed as they were chosen, or why they could not be.
    Layers(Choice, Result<Vec<Developed>, String>),
    /// A training run has come on.
    #[cfg(feature = "train")]
    Training(Training),
    /// A training of an effect has begun, in the folder of its run.
    #[cfg(feature = "train")]
    TrainingBegan(Effect, PathBuf),
    /// And ended: what is to be said, or why it failed.
    #[cfg(feature = "train")]
    TrainingEnded(Result<String, String>),
    /// The picture that is ordered cannot be made.
    NoPicture(String),
    /// An errand was run, or why it could not be.
    Errand(Result<Done, String>),
    /// Something else cannot be done.
    Refused(String),
}

/// Where the window puts its orders, and hears what came of them.
pub struct Desk {
    /// Frames.
    pub studio: Arc<Mailbox<studio::Order>>,
    /// Truth.
    pub truth: Arc<Mailbox<truth::Order>>,
    /// Images to be judged.
    pub judge: Arc<Mailbox<judge::Case>>,
    /// Layers of an EXR file to be developed.
    pub darkroom: Arc<Mailbox<Choice>>,
    /// The folder of the training run that is followed, if any.
    #[cfg(feature = "train")]
    pub follower: Arc<Mailbox<Option<PathBuf>>>,
    /// Files; closed when the window is.
    pub clerk: Option<mpsc::Sender<Errand>>,
    /// What came of all that.
    pub news: mpsc::Receiver<News>,
    /// Who tells of trainings that the window begins.
    #[cfg(feature = "train")]
    teller: Teller,
    /// Threads that go home soon when they are told to, or may not be left alone.
    threads: Vec<JoinHandle<()>>,
    /// Those that may be at something for minutes which nobody wants any more: a frame, the hierarchy of a large scene.
    slow: Vec<JoinHandle<()>>,
}

/// For how long the window's end waits for what nobody wants any more.
const PATIENCE: Duration = Duration::from_millis(500);

/// Tells the window something and wakes it.
#[derive(Clone)]
struct Teller {
    sender: mpsc::Sender<News>,
    context: Context,
}

impl Teller {
    fn tell(&self, news: News) {
        // The window may have closed meanwhile.
        let _ = self.sender.send(news);
        self.context.request_repaint();
    }
}

impl Desk {
    /// Starts the threads.
    ///
    /// # Errors
    /// If the system has none to give.
    pub fn new(args: &Arc<Args>, context: &Context) -> Result<Self> {
        let (sender, news) = mpsc::channel();
        let (clerk, errands) = mpsc::channel();
        let teller = Teller { sender, context: context.clone() };
        let mut desk = Self {
            studio: Arc::default(),
            truth: Arc::default(),
            judge: Arc::default(),
            darkroom: Arc::default(),
            #[cfg(feature = "train")]
            follower: Arc::default(),
            clerk: Some(clerk),
            news,
            #[cfg(feature = "train")]
            teller: teller.clone(),
            threads: Vec::new(),
            slow: Vec::new(),
        };
        desk.slow.push({
            let (args, orders, teller) = (Arc::clone(args), Arc::clone(&desk.studio), teller.clone());
            spawn("studio", move || studio::run(&args, &orders, &|news| teller.tell(news)))?
        });
        desk.slow.push({
            let (orders, teller) = (Arc::clone(&desk.truth), teller.clone());
            spawn("truth", move || truth::run(&orders, &|news| teller.tell(news)))?
        });
        desk.slow.push({
            let (orders, teller) = (Arc::clone(&desk.judge), teller.clone());
            spawn("judge", move || judge::run(&orders, &|news| teller.tell(news)))?
        });
        desk.slow.push({
            let (orders, teller) = (Arc::clone(&desk.darkroom), teller.clone());
            spawn("darkroom", move || layers::run(&orders, &|news| teller.tell(news)))?
        });
        #[cfg(feature = "train")]
        desk.threads.push({
            let (orders, teller) = (Arc::clone(&desk.follower), teller.clone());
            spawn("follower", move || training::run(&orders, &|news| teller.tell(news)))?
        });
        desk.threads.push(spawn("clerk", move || clerk::run(errands, &|news| teller.tell(news)))?);
        Ok(desk)
    }
}

#[cfg(feature = "train")]
impl Desk {
    /// Begins a training.
    ///
    /// # Errors
    /// As [`Trainer::begin`].
    pub fn train(&self, wish: &Wish) -> Result<Trainer> {
        let teller = self.teller.clone();
        Trainer::begin(wish, move |news| teller.tell(news))
    }
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>> {
    Ok(thread::Builder::new().name(name.to_owned()).spawn(work)?)
}

impl Drop for Desk {
    /// Errands are run to their end, so that no file is missing. What is slow and takes longer ends with the program.
    fn drop(&mut self) {
        self.studio.close();
        self.truth.close();
        self.judge.close();
        self.darkroom.close();
        #[cfg(feature = "train")]
        self.follower.close();
        self.clerk = None;
        for thread in self.threads.drain(..) {
            // A thread that panicked has told its own story.
            let _ = thread.join();
        }
        leave(std::mem::take(&mut self.slow), PATIENCE);
    }
}

/// Waits for threads, but for no longer than a time.
pub fn leave(mut threads: Vec<JoinHandle<()>>, patience: Duration) {
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
    fn who_is_slow_is_left_and_who_is_not_is_waited_for() {
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
        leave(vec![slow, quick], Duration::from_secs(1));
        assert!(done.load(Ordering::Relaxed) && began.elapsed() < Duration::from_secs(60));
        drop(never);
        leave(vec![thread::spawn(|| {})], Duration::from_secs(600));
        assert!(began.elapsed() < Duration::from_secs(60), "nobody is left to be waited for");
    }
}
