//! The window in egui's harness: its own panel and canvas, clicked by the labels that people see, with its
//! own workers.

mod designs;
mod files;
mod films;
#[cfg(feature = "train")]
mod trainings;

use super::*;
use crate::view::window::Window;
use clap::Parser as _;
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use image::RgbaImage;
use std::time::{Duration, Instant};

/// How long a window may take until something is there.
const PATIENCE: Duration = Duration::from_mins(3);

/// What a command line says.
pub fn args(line: &str) -> Args {
    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }
    let words = std::iter::once("deepshade").chain(line.split_whitespace());
    Line::try_parse_from(words).expect("a command line").args
}

/// A small window on `still-life:1` that a command line opens, and the folder that it saves into.
pub struct Opened {
    harness: Harness<'static, Option<Window>>,
    folder: tempfile::TempDir,
}

impl Opened {
    /// With more options, as soon as there is a picture or a reason why there is none. What comes for the
    /// first time moves the controls below it, and a click would miss them.
    pub fn new(line: &str) -> Self {
        let mut opened = Self::at_once(line);
        let shows = |window: &Window| window.results.picture.is_some() || window.messages.first().is_some();
        opened.wait("a picture", shows);
        opened
    }

    /// With more options, though nothing is shown yet.
    fn at_once(line: &str) -> Self {
        let scene = if line.contains("--scene") { "" } else { "--scene still-life:1" };
        let size = if line.contains("--height") { "" } else { "--height 48 --width 64" };
        let args = args(&format!("{scene} {size} --quality low --spp 8 {line}"));
        let mut state = Some(State::new(&args).expect("a state"));
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().to_owned();
        let show = move |ui: &mut egui::Ui, window: &mut Option<Window>| {
            let window = window.get_or_insert_with(|| {
                let outcome = Arc::new(Mutex::new(WindowFigures::new()));
                let state = state.take().expect("opened once");
                let mut window = open(state, outcome, ui.ctx()).expect("workers");
                window.files.folder.clone_from(&place);
                window
            });
            window.advance(ui.ctx());
            window.show(ui);
        };
        let harness = Harness::builder().with_size([1280.0, 1600.0]).with_context_setup(style).wgpu();
        let harness = harness.build_ui_state(show, None);
        Self { harness, folder }
    }

    pub fn window(&self) -> &Window {
        self.harness.state().as_ref().expect("an open window")
    }

    pub fn window_mut(&mut self) -> &mut Window {
        self.harness.state_mut().as_mut().expect("an open window")
    }

    /// A place in its folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Waits until something is so.
    pub fn wait(&mut self, what: &str, is_so: impl Fn(&Window) -> bool) {
        let began = Instant::now();
        while !is_so(self.window()) {
            assert!(began.elapsed() < PATIENCE, "{what}: {}", told(self.window()));
            self.harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        self.harness.run_steps(2);
    }

    /// Waits until everything is there that the user has chosen.
    pub fn wait_until_complete(&mut self) {
        // A click takes effect, and so does what came before it.
        self.harness.run_steps(2);
        self.wait("everything", |window| window.is_complete() || window.is_refused());
        assert!(!self.window().is_refused(), "{:?}", self.window().messages.first());
    }

    /// Waits until a message is shown.
    pub fn wait_for_error(&mut self, part: &str) {
        self.wait(part, |window| window.messages.error.as_ref().is_some_and(|error| error.contains(part)));
        assert!(self.harness.query_by_label_contains(part).is_some(), "it is seen: {part}");
        self.window_mut().messages = Default::default();
    }

    /// Clicks what has a label.
    pub fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.run_steps(2);
    }

    /// Clicks what has a role and a label, where others have the label, too.
    pub fn click_role(&mut self, role: Role, label: &str) {
        self.harness.get_by_role_and_label(role, label).click();
        self.harness.run_steps(2);
    }

    /// Chooses an entry of a list, which may be longer than what is seen of it.
    pub fn choose(&mut self, list: &str, entry: &str) {
        self.click_role(Role::ComboBox, list);
        self.harness.get_by_role_and_label(Role::Button, entry).scroll_to_me();
        // The list moves for a while.
        self.harness.run_steps(30);
        self.click_role(Role::Button, entry);
    }

    /// The images as they are painted.
    fn canvas(&mut self) -> RgbaImage {
        let picture = self.harness.render().expect("a painted window");
        let (width, height) = picture.dimensions();
        image::imageops::crop_imm(&picture, width / 3, height / 4, 2 * width / 3, height / 2).to_image()
    }
}

/// What a window lacks that is not complete.
fn told(window: &Window) -> String {
    let (error, [picture, files]) = (window.messages.first(), [window.is_up_to_date(), window.is_idle()]);
    let metrics = window.reference().is_none() || window.metrics_of_picture().is_some();
    format!("{error:?}, there is: picture {picture}, files {files}, metrics {metrics}")
}

/// The share of an image that is no grey.
fn coloured(image: &RgbaImage) -> f64 {
    let range = |[red, green, blue, _]: [u8; 4]| red.max(green).max(blue) - red.min(green).min(blue);
    let count = image.pixels().filter(|pixel| range(pixel.0) > 24).count();
    count as f64 / f64::from(image.width() * image.height())
}

#[test]
fn what_is_said_where_there_is_no_screen_names_no_source_file() {
    let said = "winit EventLoopError: os error at /home/a/winit-0.30/src/linux/mod.rs:765: no DISPLAY is set";
    assert_eq!(without_source(said), "no DISPLAY is set");
    assert_eq!(without_source("another: error"), "another: error");
}

#[test]
fn images_truth_and_maps_are_seen_as_they_are_chosen() {
    let mut opened = Opened::new("--methods gtao,hbao");
    opened.wait_until_complete();
    let names = |opened: &Opened| -> Vec<String> {
        opened.window().shown().iter().map(|shown| shown.name.to_owned()).collect()
    };
    assert_eq!(names(&opened), ["gtao", "hbao", "truth"]);
    let plain = opened.canvas();
    opened.click("tiles");
    opened.click("difference");
    let difference = opened.canvas();
    opened.click("flip");
    let flip = opened.canvas();
    // Ambient occlusion is grey, maps of what differs are not.
    let colours = [&plain, &difference, &flip].map(coloured);
    assert!(colours[0] < 0.01 && colours[1] > 0.05 && colours[2] > 0.05, "{colours:?}");
    assert_ne!(difference, flip);
    // A method can be the reference, and what is put away is seen no more.
    opened.choose("is held against", "hbao");
    opened.wait("figures", |window| window.metrics_of_picture().is_some());
    assert!(opened.window().metrics_of_picture().is_some_and(|metrics| metrics.images.len() == 1));
    opened.click("truth, up to");
    opened.click_role(Role::CheckBox, "hbao");
    opened.wait_until_complete();
    assert_eq!(names(&opened), ["gtao"]);
    opened.choose("of the g-buffer", "normal");
    opened.wait_until_complete();
    assert_eq!(names(&opened), ["gtao", "normal"]);
    opened.choose("effect", "gi");
    opened.wait_until_complete();
    assert!(opened.window().state.show.effect == Effect::Gi && !names(&opened).contains(&"gtao".to_owned()));
}

#[test]
fn every_control_says_what_it_does() {
    let mut opened = Opened::new("--methods gtao,hbao --effect ao");
    opened.click("truth, up to");
    opened.wait_until_complete();
    let headers = opened.harness.query_all_by_role(Role::DisclosureTriangle);
    headers.for_each(|header| header.click());
    opened.harness.run_steps(30);
    // Numbers have their hint for a name, where they have no other.
    opened.harness.check_accessibility();
    let is_control = |node: &egui_kittest::Node<'_>| {
        let role = node.accesskit_node().role();
        egui::accessibility::is_input(role) && ![Role::SpinButton, Role::Splitter].contains(&role)
    };
    let root = opened.harness.root();
    let controls: Vec<_> = root.children_recursive().filter(is_control).collect();
    assert!(controls.len() > 30, "{controls:#?}");
    let silent: Vec<_> =
        controls.iter().filter(|node| node.accesskit_node().description().is_none()).collect();
    assert!(silent.is_empty(), "{silent:#?}");
}

#[test]
fn keys_do_what_they_are_said_to_do() {
    let mut opened = Opened::new("--methods gtao");
    opened.wait_until_complete();
    for key in [Key::M, Key::T, Key::P] {
        opened.harness.key_press(key);
    }
    opened.harness.run_steps(2);
    let state = &opened.window().state;
    assert!(state.look.map == state::Map::Difference && !state.truth);
    let (before, middle) = (state.controller, egui::pos2(800.0, 800.0));
    opened.wait("the screenshot", Window::is_idle);
    assert!(opened.path("window-1.png").is_file());
    opened.harness.drag_at(middle);
    opened.harness.step();
    opened.harness.event(Event::PointerMoved(middle + egui::vec2(60.0, 10.0)));
    opened.harness.step();
    opened.harness.drop_at(middle + egui::vec2(60.0, 10.0));
    opened.harness.step();
    assert!(opened.window().state.controller != before, "the camera has moved");
    opened.wait_until_complete();
}

#[test]
fn closing_does_not_wait_for_a_slow_method() {
    let opened = Opened::at_once("--scene room:7 --methods aov --height 288 --width 448");
    let began = Instant::now();
    drop(opened);
    assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
}

#[test]
fn what_cannot_be_made_is_said() {
    assert!(State::new(&args("--methods shadows")).is_err());
    let mut opened = Opened::new("--model nowhere --methods learned");
    opened.wait("a refusal", Window::is_refused);
    assert!(opened.window().messages.error.is_some());
}

#[test]
fn a_number_of_a_method_is_set_and_saved_with_it() {
    let mut opened = Opened::new("--methods hbao");
    opened.click("truth, up to");
    opened.wait_until_complete();
    let brightness = |opened: &Opened| {
        let picture = opened.window().results.picture.clone().expect("a picture");
        let values = picture.images[0].values.data();
        values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64
    };
    let usual = brightness(&opened);
    opened.click_role(Role::DisclosureTriangle, "hbao");
    opened.harness.run_steps(20);
    opened.harness.get_by_role_and_label(Role::Slider, "strength").set_value_accesskit(0.2);
    opened.wait_until_complete();
    let set = brightness(&opened);
    assert!(set > usual + 0.02, "{usual} {set}");
    opened.click("save");
    opened.wait("files", Window::is_idle);
    let text = std::fs::read_to_string(opened.path("view-1/compare.toml")).expect("written");
    assert!(text.contains("strength = 0.2"), "{text}");
}
