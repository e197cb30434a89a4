//! Files with what the crate `exr` refuses whole: deep parts and subsampled channels, be it only beside
//! others.
//!
//! They are here described to it as flat parts with as many chunks and channels of full resolution, in as
//! many bytes, so that every offset in the file stays right. What they truly are is kept beside that. No
//! chunk of a deep part is ever read.

use exr::prelude::Vec2;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// The longest headers that are looked through, and how much of a file is first read for them, bytes.
const MOST: u64 = 1 << 24;
const FIRST: u64 = 1 << 16;

/// What a part's attribute `type` says of deep ones, and of the flat ones with as many chunks.
const KINDS: [(&[u8], &[u8]); 2] = [(b"deepscanline", b"scanlineimage"), (b"deeptile", b"tiledimage")];

/// An attribute that every deep part has and no flat one needs. Its name gives up the bytes that `type`
/// takes.
const SPARE: &[u8] = b"maxSamplesPerPixel";

/// Bits of the second byte of a file's version: that a part is deep, and that there are several parts.
const DEEP: u8 = 0b1000;
const SEVERAL: u8 = 0b1_0000;

/// What a part truly is.
#[derive(Clone, Debug, Default)]
pub struct PartContents {
    /// Whether its pixels have samples at several depths.
    pub deep: bool,
    /// Of every so many pixels along both axes a channel has one.
    pub sampling: Vec<Vec2<usize>>,
}

/// A file whose first bytes are replaced.
pub struct Plain<'a> {
    file: &'a mut File,
    head: Vec<u8>,
    at: u64,
}

/// A file that describes nothing which `exr` refuses, and what its parts truly are. A file that makes no
/// sense is left as it is, for `exr` to say so.
///
/// # Errors
/// If the file cannot be read.
pub fn described(file: &mut File) -> io::Result<(Plain<'_>, Vec<PartContents>)> {
    let mut head = Vec::new();
    let mut length = FIRST;
    loop {
        file.by_ref().take(length - head.len() as u64).read_to_end(&mut head)?;
        let found = plain_headers(&head);
        if found.is_some() || (head.len() as u64) < length || length >= MOST {
            let (head, truly) = found.unwrap_or_default();
            return Ok((Plain { file, head, at: 0 }, truly));
        }
        length *= 4;
    }
}

/// The headers in plain words, and what they truly say; none where they make no sense, or are cut off.
fn plain_headers(head: &[u8]) -> Option<(Vec<u8>, Vec<PartContents>)> {
    const MAGIC_AND_VERSION: usize = 8;
    let several = head.get(5)? & SEVERAL != 0;
    let mut bytes = head.get(..MAGIC_AND_VERSION)?.to_vec();
    bytes[5] &= !DEEP;
    let (mut at, mut truly) = (MAGIC_AND_VERSION, Vec::new());
    loop {
        let end = header_end(head, at)?;
        let (header, part) = plain(&head[at..=end])?;
        bytes.extend(header);
        truly.push(part);
        at = end + 1;
        if !several || *head.get(at)? == 0 {
            return Some((bytes, truly));
        }
    }
}

/// Where a header ends that begins somewhere: at its zero byte.
fn header_end(bytes: &[u8], mut at: usize) -> Option<usize> {
    while *bytes.get(at)? != 0 {
        at = attribute(bytes, at)?.end;
    }
    Some(at)
}

/// Where the pieces of an attribute lie: name, zero, type, zero, size of the value, value.
struct AttributeSpan {
    name_end: usize,
    value: usize,
    end: usize,
}

fn attribute(bytes: &[u8], start: usize) -> Option<AttributeSpan> {
    let name_end = zero(bytes, start)?;
    let size_at = zero(bytes, name_end + 1)? + 1;
    let size = u32::from_le_bytes(*bytes.get(size_at..)?.first_chunk()?) as usize;
    let (value, end) = (size_at + 4, (size_at + 4).checked_add(size)?);
    (end < bytes.len()).then_some(AttributeSpan { name_end, value, end })
}

fn zero(bytes: &[u8], from: usize) -> Option<usize> {
    Some(from + bytes.get(from..)?.iter().position(|byte| *byte == 0)?)
}

/// A header in plain words, with its zero byte and as long as it was. Attributes may stand in any order.
fn plain(header: &[u8]) -> Option<(Vec<u8>, PartContents)> {
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let (mut at, mut longer, mut truly) = (0, 0, PartContents::default());
    while header[at] != 0 {
        let place = attribute(header, at)?;
        let (name, value) = (&header[at..place.name_end], &header[place.value..place.end]);
        let kind = KINDS.iter().find(|(deep, _)| name == b"type" && value == *deep);
        let before = &header[at..place.value];
        attributes.push(match kind {
            None if name == b"channels" => {
                let (channels, sampling) = full_channels(value)?;
                truly.sampling = sampling;
                [before, &channels].concat()
            }
            None => header[at..place.end].to_vec(),
            Some((deep, flat)) => {
                (truly.deep, longer) = (true, flat.len() - deep.len());
                let size = (flat.len() as u32).to_le_bytes();
                [&before[..before.len() - size.len()], &size, flat].concat()
            }
        });
        at = place.end;
    }
    if truly.deep {
        let is_spare = |attribute: &&mut Vec<u8>| attribute.starts_with(&[SPARE, &[0]].concat());
        attributes.iter_mut().find(is_spare)?.drain(..longer);
    }
    attributes.push(vec![0]);
    Some((attributes.concat(), truly))
}

/// A list of channels as of full resolution, and their true sampling: each a name, a zero, its type, four
/// bytes, and the sampling along x and y.
fn full_channels(list: &[u8]) -> Option<(Vec<u8>, Vec<Vec2<usize>>)> {
    let (mut full, mut sampling) = (list.to_vec(), Vec::new());
    let mut at = 0;
    while *list.get(at)? != 0 {
        let x = zero(list, at)? + 9;
        let number = |at: usize| Some(i32::from_le_bytes(*list.get(at..)?.first_chunk()?));
        let [across, down] = [number(x)?, number(x + 4)?].map(|number| usize::try_from(number).ok());
        sampling.push(Vec2(across.filter(|across| *across > 0)?, down.filter(|down| *down > 0)?));
        full[x..x + 4].copy_from_slice(&1i32.to_le_bytes());
        full[x + 4..x + 8].copy_from_slice(&1i32.to_le_bytes());
        at = x + 8;
    }
    Some((full, sampling))
}

impl Read for Plain<'_> {
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

impl Seek for Plain<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::End(_) => self.file.seek(to)?,
            SeekFrom::Current(by) => self.at.checked_add_signed(by).ok_or(io::ErrorKind::InvalidInput)?,
        };
        Ok(self.at)
    }
}
