//! What a run measures as an event file, which TensorBoard shows beside those of other runs.
//!
//! It is a list of records: the length, a checksum of that, the content, and a checksum of it, as in
//! TensorFlow's `record_writer.h`. The content is an `Event` of its `event.proto`. A run that is resumed
//! writes the file anew: its earlier events have the time of that.

use crate::TrainError;
use crate::metrics::Line;
use prost::Message;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Name of the event file in the run's folder. TensorBoard looks for `tfevents` in it.
pub const EVENTS_FILE: &str = "events.out.tfevents.deepshade";
/// What the first event of a file says.
const VERSION: &str = "brain.Event:2";

/// Something that happened at a step.
#[derive(Clone, PartialEq, Message)]
struct Event {
    /// Seconds since 1970.
    #[prost(double, tag = "1")]
    wall_time: f64,
    #[prost(int64, tag = "2")]
    step: i64,
    #[prost(string, optional, tag = "3")]
    file_version: Option<String>,
    #[prost(message, optional, tag = "5")]
    summary: Option<Summary>,
}

/// What was measured.
#[derive(Clone, PartialEq, Message)]
struct Summary {
    #[prost(message, repeated, tag = "1")]
    value: Vec<Value>,
}

/// A number with a name.
#[derive(Clone, PartialEq, Message)]
struct Value {
    #[prost(string, tag = "1")]
    tag: String,
    #[prost(float, optional, tag = "2")]
    simple_value: Option<f32>,
}

/// The event file of a run.
pub(crate) struct EventFile {
    path: PathBuf,
    file: File,
}

impl EventFile {
    /// A new one in the run's folder, in place of an older one, with lines that are there.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn new(folder: &Path, lines: &[Line]) -> Result<Self, TrainError> {
        let path = folder.join(EVENTS_FILE);
        let file = File::create(&path).map_err(TrainError::io("write", &path))?;
        let mut events = Self { path, file };
        events.write(&Event { file_version: Some(VERSION.to_owned()), ..event(0) })?;
        lines.iter().try_for_each(|line| events.add(line))?;
        Ok(events)
    }

    /// Adds a line.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, line: &Line) -> Result<(), TrainError> {
        self.write(&Event { summary: Some(summary(line)), ..event(line.step) })
    }

    fn write(&mut self, event: &Event) -> Result<(), TrainError> {
        self.file.write_all(&record(&event.encode_to_vec())).map_err(TrainError::io("write", &self.path))
    }
}

/// An event of now.
fn event(step: usize) -> Event {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Event { wall_time: now.as_secs_f64(), step: step as i64, file_version: None, summary: None }
}

fn summary(line: &Line) -> Summary {
    let value = |tag: &str, value: f32| Value { tag: tag.to_owned(), simple_value: Some(value) };
    let validation = line.validation_loss.map(|loss| value("loss/validation", loss));
    let others = [
        value("loss/training", line.loss),
        value("rate", line.rate as f32),
        value("images_per_second", line.images_per_second as f32),
    ];
    Summary { value: others.into_iter().chain(validation).collect() }
}

/// A record of a content.
fn record(content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u64).to_le_bytes();
    let checksum = |bytes: &[u8]| masked(crc32c::crc32c(bytes)).to_le_bytes();
    [&length[..], &checksum(&length), content, &checksum(content)].concat()
}

/// A checksum, turned so that checksums of what holds checksums are no worse.
const fn masked(checksum: u32) -> u32 {
    checksum.rotate_right(15).wrapping_add(0xa282_ead8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The events of a file, each of whose checksums is right.
    fn events(mut bytes: &[u8]) -> Vec<Event> {
        let mut events = Vec::new();
        while !bytes.is_empty() {
            let length = u64::from_le_bytes(bytes[..8].try_into().expect("eight bytes")) as usize;
            assert_eq!(bytes[..length + 16], record(&bytes[12..12 + length]));
            events.push(Event::decode(&bytes[12..12 + length]).expect("an event"));
            bytes = &bytes[length + 16..];
        }
        events
    }

    fn line(step: usize, validation_loss: Option<f32>) -> Line {
        Line { step, loss: 0.25, validation_loss, rate: 0.0, images_per_second: 9.5 }
    }

    #[test]
    fn checksums_are_those_of_the_format() {
        // RFC 3720, B.4: 32 bytes of zeros.
        assert_eq!(crc32c::crc32c(&[0; 32]), 0x8a91_36aa);
        // The head of every event file: the length of its first event, 24, and its checksum.
        assert_eq!(record(&[0; 24])[..12], [24, 0, 0, 0, 0, 0, 0, 0, 0xa3, 0x7f, 0x4b, 0x22]);
    }

    #[test]
    fn each_line_is_an_event_and_a_resumed_run_begins_a_new_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let read = || std::fs::read(folder.path().join(EVENTS_FILE)).expect("a file");
        let mut file = EventFile::new(folder.path(), &[line(20, None)]).expect("written");
        file.add(&line(40, Some(0.125))).expect("written");
        let all = events(&read());
        assert_eq!(all[0].file_version.as_deref(), Some(VERSION));
        assert_eq!(all.iter().map(|event| event.step).collect::<Vec<_>>(), [0, 20, 40]);
        let values = |event: &Event| {
            let summary = event.summary.clone().expect("one");
            summary.value.into_iter().map(|value| (value.tag, value.simple_value)).collect::<Vec<_>>()
        };
        assert_eq!(values(&all[1]).len(), 3, "nothing was validated");
        assert!(values(&all[2]).contains(&("loss/validation".to_owned(), Some(0.125))));
        assert!(values(&all[2]).contains(&("rate".to_owned(), Some(0.0))), "a zero is written, too");
        EventFile::new(folder.path(), &[line(20, None)]).expect("written");
        assert_eq!(events(&read()).len(), 2);
    }
}
