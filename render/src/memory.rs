//! How many triangles the memory of this machine holds: a scene of too many is refused before the system ends the
//! program.

use crate::scene::SceneError;
use std::fs;

/// What a triangle takes at most while the hierarchies over it are built, bytes. Measured are 390, by the program's peak
/// with grids of one and of three million; the rest is for hierarchies whose leaves are less full. Reading an OBJ file
/// takes 180, its text included.
const BYTES_PER_TRIANGLE: u64 = 512;

/// What is taken to be available where the system does not say, bytes.
const ASSUMED: u64 = 8 << 30;

/// Memory that can be had without swapping, bytes: `MemAvailable` of Linux' /proc/meminfo, 8 GiB elsewhere.
pub(crate) fn available() -> u64 {
    fs::read_to_string("/proc/meminfo").ok().as_deref().and_then(available_in).unwrap_or(ASSUMED)
}

/// That of the text of /proc/meminfo.
fn available_in(text: &str) -> Option<u64> {
    let kibibytes = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(kibibytes.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

/// The most triangles that fit into some bytes.
pub(crate) fn most_triangles(bytes: u64) -> usize {
    usize::try_from(bytes / BYTES_PER_TRIANGLE).unwrap_or(usize::MAX)
}

/// Whether hierarchies over some triangles of a scene fit into some bytes.
///
/// # Errors
/// If they do not.
pub(crate) fn check(scene: &str, triangles: usize, bytes: u64) -> Result<(), SceneError> {
    let most = most_triangles(bytes);
    if triangles > most {
        return Err(SceneError::Memory { name: scene.to_owned(), triangles, most });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_triangles_than_memory_holds_are_refused_by_name() {
        assert!(check("small", 100, 100 * BYTES_PER_TRIANGLE).is_ok());
        let error = check("city", 101, 101 * BYTES_PER_TRIANGLE - 1).expect_err("a byte is missing");
        assert_eq!(
            error.to_string(),
            "scene `city` has 101 triangles; the memory that is available here holds 100"
        );
        assert!(check("dust", 100_000_000, 8 << 30).is_err(), "a hundred million on 8 GiB");
    }

    #[test]
    fn what_the_system_says_is_read() {
        let text = "MemTotal:       24683520 kB\nMemAvailable:   22489000 kB\nSwapTotal: 0 kB\n";
        assert_eq!(available_in(text), Some(22_489_000 << 10));
        assert_eq!(available_in("MemTotal: 1 kB\n"), None);
        assert_eq!(available_in("MemAvailable: much\n"), None);
        assert!(available() > 1 << 20);
    }
}
