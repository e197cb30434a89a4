//! What studies have in common with the program; nothing else of it is public.

/// Command lines, and how a program begins and ends.
pub mod command_line {
    pub use crate::command_line::{ended, with_negative_numbers};
}

/// What command lines hold, read and checked.
pub mod arguments {
    pub use crate::arguments::{Size, page_folder, positive, svg_file, within, written_file};
}

/// What a command found out, as a file.
pub mod figures {
    pub use crate::figures::{Figures, machine, write_atomically};
}

/// Tables, for a terminal and as Markdown.
pub mod table {
    pub use crate::table::{aligned, markdown};
}

/// Curves as SVG.
pub mod plot {
    pub use crate::plot::{Line, Plot, Style};
}

/// Pictures of images and of differences.
pub mod pictures {
    pub use crate::render::picture::Exposure;
    pub use crate::report::colour_map::diverging;
    pub use crate::report::images::{painted, shown, write_png};
}

/// Means with confidence intervals.
pub mod statistics {
    pub use crate::statistics::{MeanInterval, estimate};
}

/// The list of methods.
pub mod methods {
    pub use crate::methods::{LEARNED, TRUTH, open_screen, screen_names};
}

/// Networks as methods, and where they are.
pub mod learned {
    pub use crate::engine::Engine;
    pub use crate::learned::{Learned, is_network, network};
}

/// What training takes by default.
#[cfg(feature = "train")]
pub mod train {
    pub use crate::train::{INPUT_RADIUS, LossName};
}

/// Scenes as they are seen.
pub mod animated_view {
    pub use crate::live::animated_view::{AnimatedView, plain};
    pub use crate::views::Viewpoint;
}

/// What the web page shows.
pub mod web {
    pub use crate::web::shown_scene::{PageRequest, ShownScene, TracedView, scores};
}

/// Folders and object stores.
pub mod location {
    pub use crate::location::Location;
}

/// Rays a second, beside another library.
pub mod rays {
    pub use crate::bench::rays::{Args, Ray, Rival, RivalOf, run_beside};
}
