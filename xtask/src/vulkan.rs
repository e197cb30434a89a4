//! A Vulkan adapter for the GPU passes: a graphics card with its driver, or Mesa's software rasteriser,
//! lavapipe.

use crate::{apt, command::command};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};

const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// Makes sure that there is a Vulkan adapter, by installing lavapipe if need be. Other systems than Linux
/// bring their own graphics interface.
///
/// # Errors
/// If there is none and none can be installed.
pub fn ensure() -> Result<()> {
    if !cfg!(target_os = "linux") || found() {
        return Ok(());
    }
    apt::install(&PACKAGES, "A Vulkan adapter (software Vulkan will do)")?;
    if !found() {
        bail!("no Vulkan adapter although {} are installed", PACKAGES.join(" and "));
    }
    Ok(())
}

/// Whether there is a loader, and a driver with something to drive. The files tell it without a program that
/// would have to be built first; whether the adapter works, the program itself finds out.
fn found() -> bool {
    let drivers = drivers();
    let software = drivers.iter().any(|driver| is_software(driver));
    loader() && (software || (!drivers.is_empty() && graphics_card()))
}

/// Whether the dynamic linker knows the Vulkan loader.
fn loader() -> bool {
    // ldconfig is in a folder that is not on every user's search path.
    ["ldconfig", "/sbin/ldconfig"].iter().any(|ldconfig| {
        let list = command(ldconfig, &["-p"]).output();
        list.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("libvulkan.so.1"))
    })
}

/// The drivers' manifests, where the loader looks for them.
fn drivers() -> Vec<PathBuf> {
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(files) = std::env::var_os(variable) {
            return std::env::split_paths(&files).filter(|file| file.exists()).collect();
        }
    }
    let folders = ["/etc/vulkan/icd.d", "/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|kind| kind == "json")).collect()
}

/// Whether a driver needs no graphics card.
fn is_software(driver: &Path) -> bool {
    let name = driver.file_name().unwrap_or_default().to_string_lossy().into_owned();
    ["lvp", "swiftshader"].iter().any(|prefix| name.contains(prefix))
}

/// Whether the kernel shows a graphics card.
fn graphics_card() -> bool {
    let render_node = std::fs::read_dir("/dev/dri").is_ok_and(|nodes| {
        nodes.flatten().any(|node| node.file_name().to_string_lossy().starts_with("renderD"))
    });
    render_node || Path::new("/dev/nvidia0").exists()
}
