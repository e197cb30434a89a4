//! Installing Debian and Ubuntu packages where that is allowed.

use crate::command::{command, run, succeeds};
use anyhow::{Context, Result, bail};

/// Installs packages with apt-get, as root or by sudo without a password.
///
/// # Errors
/// If there is no apt-get, no permission, or it fails; the message says what to install by hand.
pub fn install(packages: &[&str], purpose: &str) -> Result<()> {
    let list = packages.join(" ");
    let advice = format!(
        "{purpose} is missing. Install it and start again; on Debian or Ubuntu:\n    \
         sudo apt-get install --no-install-recommends {list}"
    );
    if !succeeds(&mut command("apt-get", &["--version"])) {
        bail!("{advice}");
    }
    let Some(prefix) = privileges() else { bail!("{advice}") };
    println!("{purpose} is missing: installing {list}");
    let apt = |args: &[&str]| {
        let words = [prefix, &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"], args].concat();
        run(&mut command(words[0], &words[1..])).with_context(|| advice.clone())
    };
    apt(&["update", "--quiet"])?;
    apt(&[&["install", "--yes", "--quiet", "--no-install-recommends"], packages].concat())
}

/// What to put before a command so that it runs as root; nothing if there is no way without a password.
fn privileges() -> Option<&'static [&'static str]> {
    if is_root() {
        return Some(&[]);
    }
    succeeds(&mut command("sudo", &["-n", "true"])).then_some(&["sudo", "-n"])
}

fn is_root() -> bool {
    let id = command("id", &["-u"]).output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}
