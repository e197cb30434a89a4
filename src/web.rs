//! The web page: the window's live scene with its methods, by the same code, in a browser that has WebGPU.
//!
//! This program compiled to WebAssembly is what runs there: [`shown_scene`] is a scene with its methods and
//! its truth, on either machine; `page` shows it on a canvas, as the page's script (`src/web/static`) asks,
//! and `worker` refines truth on a thread of its own. `deepshade-studies web` makes on this machine what the
//! page shows where a browser has no WebGPU, and what the browser's images are held against.

#[cfg(target_arch = "wasm32")]
mod canvas;
#[cfg(target_arch = "wasm32")]
mod page;
pub mod shown_scene;
#[cfg(target_arch = "wasm32")]
mod worker;

/// What the page's script has before it asks for anything.
#[cfg(target_arch = "wasm32")]
pub fn start() {
    console_error_panic_hook::set_once();
}
