//! The threads that work for the window, where it puts its orders, and what it hears from them.

use super::Args;
use super::clerk::{self, Done, Errand};
use super::judge::{self, Verdict};
use super::mailbox::Mailbox;
use super::studio::{self, Picture};
use super::subject::Subject;
#[cfg(feature = "train")]
use super::training::{self, Training};
use super::truth::{self, Truth};
use anyhow::Result;
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
    /// A training run has come on.
    #[cfg(feature = "train")]
    Training(Training),
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
    /// The folder of the training run that is followed, if any.
    #[cfg(feature = "train")]
    pub follower: Arc<Mailbox<Option<PathBuf>>>,
    /// Files; closed when the window is.
    pub clerk: Option<mpsc::Sender<Errand>>,
    /// What came of all that.
    pub news: mpsc::Receiver<News>,
    /// Threads that go home soon when they are told to.
    threads: Vec<JoinHandle<()>>,
    /// The one that makes frames, which may be at one for minutes.
    slow: Option<JoinHandle<()>>,
}

/// For how long the window's end waits for a frame that nobody wants any more.
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
            #[cfg(feature = "train")]
            follower: Arc::default(),
            clerk: Some(clerk),
            news,
            threads: Vec::new(),
            slow: None,
        };
        desk.slow = Some({
            let (args, orders, teller) = (Arc::clone(args), Arc::clone(&desk.studio), teller.clone());
            spawn("studio", move || studio::run(&args, &orders, &|news| teller.tell(news)))?
        });
        desk.threads.push({
            let (orders, teller) = (Arc::clone(&desk.truth), teller.clone());
            spawn("truth", move || truth::run(&orders, &|news| teller.tell(news)))?
        });
        desk.threads.push({
            let (orders, teller) = (Arc::clone(&desk.judge), teller.clone());
            spawn("judge", move || judge::run(&orders, &|news| teller.tell(news)))?
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

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>> {
    Ok(thread::Builder::new().name(name.to_owned()).spawn(work)?)
}

impl Drop for Desk {
    /// Errands are run to their end, so that no file is missing. A frame that takes longer ends with the program.
    fn drop(&mut self) {
        self.studio.close();
        self.truth.close();
        self.judge.close();
        #[cfg(feature = "train")]
        self.follower.close();
        self.clerk = None;
        for thread in self.threads.drain(..) {
            // A thread that panicked has told its own story.
            let _ = thread.join();
        }
        let Some(slow) = self.slow.take() else { return };
        let closed = Instant::now();
        while !slow.is_finished() && closed.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(5));
        }
        if slow.is_finished() {
            let _ = slow.join();
        }
    }
}
