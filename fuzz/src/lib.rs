//! The readers as libFuzzer runs them: on one thread, with a bound on memory, in a folder of their own.

mod readers;

use cap::Cap;
use readers::{MOST_BYTES, READERS, Reader};
use std::alloc::System;
use std::path::PathBuf;
use std::sync::OnceLock;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, MOST_BYTES);

/// Reads bytes as the reader of a name does; panics, as everywhere, are findings.
pub fn run(name: &str, data: &[u8]) {
    static READER: OnceLock<(&Reader, PathBuf)> = OnceLock::new();
    let (reader, folder) = READER.get_or_init(|| {
        // Else each input would be handed to another thread and back.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
        pool.build_global().expect("nothing has used the pool before");
        let folder = std::env::temp_dir().join(format!("deepshade-fuzz-{name}-{}", std::process::id()));
        (READERS.iter().find(|reader| reader.name == name).expect("a reader's name"), folder)
    });
    reader.read(folder, data);
}
