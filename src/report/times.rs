//! Whose milliseconds stand side by side: those that were taken on one device.

use super::summary::{Kind, Line};

/// The device that most methods ran on, the first of several; `None` without a method. Tables and plots have
/// times of this one alone.
pub fn device(lines: &[Line]) -> Option<&str> {
    let methods = || lines.iter().filter(|line| line.kind == Kind::Method);
    let count = |device: &str| methods().filter(|line| line.device == device).count();
    let devices = methods().map(|line| line.device.as_str());
    // Of equals `max_by_key` gives the last.
    devices.rev().max_by_key(|device| count(device))
}

/// Where tables have their times from, and the times that they leave out, in sentences.
pub fn said(lines: &[Line]) -> Vec<String> {
    let Some(device) = device(lines) else { return Vec::new() };
    let methods = || lines.iter().filter(|line| line.kind == Kind::Method);
    let mut clocks: Vec<&str> = Vec::new();
    for line in methods().filter(|line| line.device == device) {
        if !clocks.contains(&line.clock) {
            clocks.push(line.clock);
        }
    }
    let mut said = vec![format!("ms on {device}, {}", clocks.join(" and "))];
    let apart = methods().filter(|line| line.device != device);
    said.extend(apart.map(|line| {
        let time = in_words(line.milliseconds);
        format!("{}: {time} on {}, which is not to be compared", line.name, line.device)
    }));
    let truth = lines.iter().find(|line| line.kind == Kind::Ceiling);
    said.extend(truth.map(|line| format!("truth: {}", in_words(line.milliseconds))));
    said
}

fn in_words(milliseconds: Option<f64>) -> String {
    milliseconds.map_or_else(|| "no time".to_owned(), |time| format!("{time:.2} ms"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::metrics::Scores;

    /// A line of a method on a device.
    fn line(name: &str, device: &str, milliseconds: f64, ssim: f64) -> Line {
        Line {
            name: name.to_owned(),
            label: name.to_owned(),
            kind: Kind::Method,
            method: name.to_owned(),
            file: None,
            scores: Scores { ssim, psnr: 20.0, flip: 1.0 - ssim, relative_mse: 1.0 - ssim },
            milliseconds: Some(milliseconds),
            clock: "wall clock",
            device: device.to_owned(),
        }
    }

    #[test]
    fn times_are_of_the_device_of_most_methods_and_those_of_others_are_said_apart() {
        let lines = [
            line("march", "a processor", 90.0, 0.9),
            line("gtao", "a card", 2.0, 0.9),
            line("hbao", "a card", 1.0, 0.8),
        ];
        assert_eq!(device(&lines), Some("a card"));
        assert_eq!(device(&lines[..2]), Some("a processor"), "the first of equals");
        assert_eq!(device(&[]), None);
        let cells = lines.each_ref().map(|line| line.cells(device(&lines))[4].clone());
        assert_eq!(cells, ["", "2.00", "1.00"]);
        let said = said(&lines);
        assert_eq!(said[0], "ms on a card, wall clock");
        assert_eq!(said[1], "march: 90.00 ms on a processor, which is not to be compared");
        assert_eq!(said.len(), 2);
    }
}
