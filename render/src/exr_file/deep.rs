//! Files with deep parts beside flat ones, which the crate `exr` refuses whole.
//!
//! A deep part is here described as a flat one of as many chunks, in as many bytes, so that every offset in
//! the file stays right. None of its chunks is ever read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// The longest headers that are looked through, bytes.
const MOST: u64 = 1 << 24;

/// What a part's attribute `type` says of deep ones, and of the flat ones with as many chunks.
const KINDS: [(&[u8], &[u8]); 2] = [(b"deepscanline", b"scanlineimage"), (b"deeptile", b"tiledimage")];

/// An attribute that every deep part has and no flat one needs. Its name gives up the bytes that `type`
/// takes.
const SPARE: &[u8] = b"maxSamplesPerPixel";

/// A file whose first bytes are replaced.
pub struct Flat<'a> {
    file: &'a mut File,
    head: Vec<u8>,
    at: u64,
    /// Which of its parts are deep.
    pub deep: Vec<bool>,
}

/// A file with its deep parts described as flat ones; every other file as it is, damaged or not.
///
/// # Errors
/// If the file cannot be read.
pub fn as_flat(file: &mut File) -> io::Result<Flat<'_>> {
    let mut start = [0; 8];
    let count = file.read(&mut start)?;
    // Bit 11 of the version, that a part is deep.
    let is_deep = count == start.len() && start[5] & 0b1000 != 0;
    let mut head = Vec::new();
    file.rewind()?;
    if is_deep {
        file.take(MOST).read_to_end(&mut head)?;
        file.rewind()?;
    }
    let (head, deep) = described(head).unwrap_or_default();
    Ok(Flat { file, head, at: 0, deep })
}

/// Headers in which deep parts are flat, and which parts those were; none if there is no sense in them.
fn described(mut bytes: Vec<u8>) -> Option<(Vec<u8>, Vec<bool>)> {
    const MAGIC_AND_VERSION: usize = 8;
    let several = bytes.get(5)? & 0b1_0000 != 0;
    let (mut at, mut deep) = (MAGIC_AND_VERSION, Vec::new());
    loop {
        let end = header_end(&bytes, at)?;
        deep.push(flatten(&mut bytes[at..end]));
        at = end + 1;
        if !several || *bytes.get(at)? == 0 {
            break;
        }
    }
    bytes[5] &= !0b1000;
    bytes.truncate(at);
    Some((bytes, deep))
}

/// Where a header ends that begins somewhere: at its zero byte.
fn header_end(bytes: &[u8], mut at: usize) -> Option<usize> {
    while *bytes.get(at)? != 0 {
        at = attribute(bytes, at)?.end;
    }
    Some(at)
}

/// Where the pieces of an attribute lie: name, zero, type, zero, size of the value, value.
struct Place {
    start: usize,
    name_end: usize,
    value: usize,
    end: usize,
}

fn attribute(bytes: &[u8], start: usize) -> Option<Place> {
    let zero = |from: usize| Some(from + bytes.get(from..)?.iter().position(|byte| *byte == 0)?);
    let name_end = zero(start)?;
    let size_at = zero(name_end + 1)? + 1;
    let size = u32::from_le_bytes(*bytes.get(size_at..)?.first_chunk()?) as usize;
    let (value, end) = (size_at + 4, (size_at + 4).checked_add(size)?);
    (end < bytes.len()).then_some(Place { start, name_end, value, end })
}

/// Describes a header's part as flat if it is deep. Attributes may stand in any order.
fn flatten(header: &mut [u8]) -> bool {
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = 0;
    let mut longer = 0;
    // A zero behind the header lets its last attribute be told from one that is cut off.
    let bytes = [&*header, &[0]].concat();
    while at < header.len() {
        let Some(place) = attribute(&bytes, at) else { return false };
        let (name, value) = (&bytes[place.start..place.name_end], &bytes[place.value..place.end]);
        let kind = KINDS.iter().find(|(deep, _)| name == b"type" && value == *deep);
        attributes.push(match kind {
            None => bytes[place.start..place.end].to_vec(),
            Some((deep, flat)) => {
                longer = flat.len() - deep.len();
                let size = (flat.len() as u32).to_le_bytes();
                [&bytes[place.start..place.value - 4], &size, flat].concat()
            }
        });
        at = place.end;
    }
    let spare = attributes.iter_mut().find(|attribute| attribute.starts_with(&[SPARE, &[0]].concat()));
    let (true, Some(spare)) = (longer > 0, spare) else { return false };
    spare.drain(..longer);
    header.copy_from_slice(&attributes.concat());
    true
}

impl Read for Flat<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = match self.head.get(self.at as usize..).filter(|rest| !rest.is_empty()) {
            Some(mut rest) => rest.read(into)?,
            None => {
                self.file.seek(SeekFrom::Start(self.at))?;
                self.file.read(into)?
            }
        };
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Flat<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::End(_) => self.file.seek(to)?,
            SeekFrom::Current(by) => self.at.checked_add_signed(by).ok_or(io::ErrorKind::InvalidInput)?,
        };
        Ok(self.at)
    }
}
