//! How many triangles the memory of this machine holds: a scene of too many is refused before the system ends
//! the program.

use super::SceneError;
use std::fs;
use std::path::Path;

/// What a triangle takes at most while the hierarchies over it are built, bytes. Measured are 390, by the
/// program's peak with grids of one and of three million; the rest is for hierarchies whose leaves are less
/// full. Reading an OBJ file takes 180, its text included.
const BYTES_PER_TRIANGLE: u64 = 512;

/// What is taken to be available where the system does not say, bytes.
const ASSUMED: u64 = 8 << 30;

/// Where Linux shows control groups.
const GROUPS: &str = "/sys/fs/cgroup";

/// Memory that can be had without swapping, bytes: `MemAvailable` of Linux' /proc/meminfo, 8 GiB elsewhere,
/// and no more than the control groups of this process leave it, as those of containers and batch systems do.
pub(crate) fn available() -> u64 {
    let text = |path: &str| fs::read_to_string(path).ok();
    let system = text("/proc/meminfo").as_deref().and_then(available_in).unwrap_or(ASSUMED);
    let groups = text("/proc/self/cgroup").and_then(|groups| left_by_groups(Path::new(GROUPS), &groups));
    groups.map_or(system, |left| left.min(system))
}

/// What the control groups of a process leave it, if one of them has a bound (version 2 of cgroups(7)): the
/// least of what its own and those above it do. `groups` is the text of /proc/self/cgroup.
fn left_by_groups(root: &Path, groups: &str) -> Option<u64> {
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    Path::new(own).ancestors().filter_map(|group| left_by(&root.join(group))).min()
}

/// What a control group leaves: files that are kept in memory and were not used lately go where room is
/// needed.
fn left_by(group: &Path) -> Option<u64> {
    let text = |name: &str| fs::read_to_string(group.join(name)).ok();
    let bytes = |name: &str| text(name)?.trim().parse::<u64>().ok();
    let (most, taken) = (bytes("memory.max")?, bytes("memory.current")?);
    let statistics = text("memory.stat").unwrap_or_default();
    let files = statistics.lines().find_map(|line| line.strip_prefix("inactive_file ")?.parse::<u64>().ok());
    Some(most.saturating_sub(taken.saturating_sub(files.unwrap_or(0))))
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

    #[test]
    fn the_tightest_control_group_bounds_what_is_available() {
        let root = tempfile::tempdir().expect("a folder");
        let group = |name: &str, most: &str, taken: &str| {
            let folder = root.path().join(name);
            fs::create_dir_all(&folder).expect("a folder");
            for (file, text) in [("memory.max", most), ("memory.current", taken)] {
                fs::write(folder.join(file), format!("{text}\n")).expect("written");
            }
        };
        let left = |groups: &str| left_by_groups(root.path(), groups);
        assert_eq!(left("0::/jobs/task\n"), None, "no bound anywhere");
        group("jobs/task", "max", "500");
        group("jobs", "1000", "600");
        assert_eq!(left("4:cpu:/x\n0::/jobs/task\n"), Some(400), "that of the group above");
        fs::write(root.path().join("jobs/memory.stat"), "anon 300\ninactive_file 250\n").expect("written");
        assert_eq!(left("0::/jobs/task\n"), Some(650));
        group("jobs/task", "550", "500");
        assert_eq!(left("0::/jobs/task\n"), Some(50));
        group("jobs/task", "400", "500");
        assert_eq!(left("0::/jobs/task\n"), Some(0), "more was taken than is left");
        assert_eq!(left("0::/\n"), None);
        group("", "70", "0");
        assert_eq!(left("0::/\n"), Some(70), "as a container sees its own");
        assert_eq!(left("4:memory:/jobs\n"), None, "version 1");
    }
}
