//! A file in memory, and what of it is asked for.

use super::names::Found;
use super::windows::{Window, Windows};
use super::{ExrError, Metadata, check, names, nothing, write};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use exr::meta::header::Header;
use std::path::PathBuf;

/// An EXR file in memory.
#[derive(Clone, Debug)]
pub struct ExrImage {
    pub(super) path: PathBuf,
    pub(super) display: Window,
    /// Data windows of the parts.
    pub(super) parts: Vec<Window>,
    /// Names of the channels.
    pub(super) names: Vec<String>,
    pub(super) channels: Vec<Channel>,
    pub(super) metadata: Metadata,
    pub(super) world_to_camera: Option<[f32; 16]>,
}

/// A channel of a part.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub part: usize,
    /// Which of its part's channels.
    pub index: usize,
    pub values: Values,
}

/// A channel's values, or why there are none.
#[derive(Clone, Debug)]
pub(super) enum Values {
    Read(Vec<f32>),
    /// Nobody asked for it when the file was read.
    Left,
    Subsampled,
    Deep,
}

/// A channel that was looked for by a name.
type Sought = (String, Found);

impl ExrImage {
    /// Rows of the first part.
    pub fn height(&self) -> usize {
        self.parts.first().map_or(0, |part| part.height)
    }

    /// Columns of the first part.
    pub fn width(&self) -> usize {
        self.parts.first().map_or(0, |part| part.width)
    }

    /// Attributes that are text or numbers, as text.
    pub const fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// OpenEXR's standard attribute `worldToCamera`: row vectors times this matrix, which is given row by
    /// row, are points in camera space.
    pub const fn world_to_camera(&self) -> Option<[f32; 16]> {
        self.world_to_camera
    }

    /// Whether all channels of an attribute are there, be it more than once.
    pub fn has(&self, attribute: Attribute) -> bool {
        attribute.channels().all(|channel| names::find(&self.names, channel) != Found::Nothing)
    }

    /// Some attributes as a g-buffer. A pixel counts as one where nothing is seen, and all its channels
    /// become 0, where one of them is not finite or a length is 65,504 or at least 1e9, by which renderers
    /// mean that.
    ///
    /// # Errors
    /// If one of them lacks a channel, has several, or has one that cannot be used, or if they do not lie
    /// over each other.
    pub fn gbuffer(&self, attributes: &[Attribute]) -> Result<GBuffer, ExrError> {
        let mut planes = self.gathered(&self.sought(attributes))?;
        nothing::clear(&mut planes, attributes);
        Ok(GBuffer::new(attributes.to_vec(), planes))
    }

    /// Where the pixels of that g-buffer lie.
    ///
    /// # Errors
    /// As [`ExrImage::gbuffer`].
    pub fn windows(&self, attributes: &[Attribute]) -> Result<Windows, ExrError> {
        let data = self.common_window(&self.channels_of(&self.sought(attributes))?)?;
        Ok(Windows { data, display: self.display })
    }

    /// An image of one or three channels by its layer's name, such as `target.ao`.
    ///
    /// # Errors
    /// If one of its channels is not there, or as [`ExrImage::gbuffer`].
    ///
    /// # Panics
    /// If it is to have another number of channels.
    pub fn image(&self, name: &str, channels: usize) -> Result<Planes, ExrError> {
        let wanted = write::image_names(name, channels).into_iter().map(|name| self.sought_name(&name));
        self.gathered(&wanted.collect::<Vec<_>>())
    }

    /// The file's one picture, as [`super::read_colour`] has it.
    ///
    /// # Errors
    /// As that.
    pub fn colour(&self) -> Result<(Planes, Windows), ExrError> {
        let is_there = |sought: &Sought| sought.1 != Found::Nothing;
        let colours = ["R", "G", "B"].map(|name| self.sought_name(name));
        let grey = self.sought_name("Y");
        if colours.iter().all(is_there) || !is_there(&grey) {
            return self.displayed(&colours);
        }
        if ["RY", "BY"].iter().any(|name| is_there(&self.sought_name(name))) {
            let what = "its colours are luminance `Y` and chroma `RY` and `BY`, which are not read; \
                        write it with `R`, `G` and `B`";
            return Err(ExrError::invalid(&self.path, what));
        }
        self.displayed(&[grey.clone(), grey.clone(), grey])
    }

    /// Channels over the whole display window, black where their data window does not reach.
    fn displayed(&self, sought: &[Sought]) -> Result<(Planes, Windows), ExrError> {
        let data = self.common_window(&self.channels_of(sought)?)?;
        let planes = self.gathered(sought)?;
        let windows = Windows { data, display: self.display };
        if data == self.display {
            return Ok((planes, windows));
        }
        let Window { width, height, .. } = self.display;
        let invalid = |what: String| ExrError::invalid(&self.path, what);
        check::edges(width, height).map_err(|what| invalid(format!("its display window is {what}")))?;
        if width * height * sought.len() > check::MAX_VALUES {
            return Err(invalid(format!("its display window is of {width} x {height} pixels, too many")));
        }
        if !data.meets(&self.display) {
            let what = format!("its pixels lie at {data}, outside its display window, {}", self.display);
            return Err(invalid(what));
        }
        let placed = (0..sought.len()).flat_map(|c| data.placed(planes.plane(c), &self.display)).collect();
        Ok((Planes::from_data(sought.len(), height, width, placed), windows))
    }

    fn sought(&self, attributes: &[Attribute]) -> Vec<Sought> {
        let channels = attributes.iter().flat_map(|attribute| attribute.channels());
        channels.map(|channel| (channel.to_string(), names::find(&self.names, channel))).collect()
    }

    fn sought_name(&self, name: &str) -> Sought {
        (name.to_owned(), names::find_name(&self.names, name))
    }

    /// Planes of the channels that were sought, over the window that they have in common.
    pub(super) fn gathered(&self, sought: &[Sought]) -> Result<Planes, ExrError> {
        let channels = self.channels_of(sought)?;
        let window = self.common_window(&channels)?;
        let mut data = Vec::with_capacity(channels.len() * window.width * window.height);
        for channel in &channels {
            let (part, values) = (self.parts[self.channels[*channel].part], self.values(*channel)?);
            match part == window {
                true => data.extend_from_slice(values),
                false => data.extend(part.placed(values, &window)),
            }
        }
        Ok(Planes::from_data(channels.len(), window.height, window.width, data))
    }

    /// The indices of the channels that were sought, or an error that names those not found, or found twice.
    fn channels_of(&self, sought: &[Sought]) -> Result<Vec<usize>, ExrError> {
        let missing = sought.iter().filter(|(_, found)| *found == Found::Nothing);
        let missing: Vec<String> = missing.map(|(name, _)| format!("`{name}`")).collect();
        if !missing.is_empty() {
            return Err(ExrError::MissingChannels {
                path: self.path.clone(),
                missing: missing.join(", "),
                held: if self.names.is_empty() { "none".to_owned() } else { self.names.join(", ") },
            });
        }
        let index = |(name, found): &Sought| match found {
            Found::One(index) => Ok(*index),
            Found::Nothing => unreachable!("what is missing was named"),
            Found::Several(several) => {
                let candidates: Vec<_> = several.iter().map(|at| format!("`{}`", self.names[*at])).collect();
                Err(ExrError::Ambiguous {
                    path: self.path.clone(),
                    wanted: name.clone(),
                    candidates: candidates.join(" or "),
                })
            }
        };
        sought.iter().map(index).collect()
    }

    /// A channel's values, or an error that says why there are none.
    fn values(&self, channel: usize) -> Result<&[f32], ExrError> {
        let what = match &self.channels[channel].values {
            Values::Read(values) => return Ok(values),
            Values::Left => "was not read with the file",
            Values::Subsampled => "is subsampled, which is not supported",
            Values::Deep => "is deep, which is not supported",
        };
        Err(ExrError::invalid(&self.path, format!("channel `{}` {what}", self.names[channel])))
    }

    /// The data window of some channels. Where their parts have several, that is the one which lies within
    /// all others, of which the rest is left out.
    fn common_window(&self, channels: &[usize]) -> Result<Window, ExrError> {
        if channels.is_empty() {
            return Ok(self.parts.first().copied().unwrap_or(Window::of_size(0, 0)));
        }
        let window = |channel: &usize| self.parts[self.channels[*channel].part];
        let within_all = |one: &Window| channels.iter().all(|channel| window(channel).contains(one));
        if let Some(common) = channels.iter().map(window).find(within_all) {
            return Ok(common);
        }
        let pairs = channels.iter().flat_map(|a| channels.iter().map(move |b| (a, b)));
        let is_apart =
            |(a, b): &(&usize, &usize)| !window(a).contains(&window(b)) && !window(b).contains(&window(a));
        let mut apart = pairs.filter(is_apart);
        let (a, b) = apart.next().expect("of windows that lie in each other the smallest lies in all");
        let [a_name, b_name] = [a, b].map(|channel| &self.names[*channel]);
        let what = format!(
            "channel `{a_name}` lies at {} and `{b_name}` at {}: they are not of the same pixels",
            window(a),
            window(b)
        );
        Err(ExrError::invalid(&self.path, what))
    }

    /// For each part and each of its channels an empty plane where it is wanted.
    pub(super) fn wanted(&self, headers: &[Header]) -> Vec<Vec<Option<Vec<f32>>>> {
        let mut planes: Vec<Vec<Option<Vec<f32>>>> =
            headers.iter().map(|header| vec![None; header.channels.list.len()]).collect();
        for channel in &self.channels {
            if let Values::Read(_) = channel.values {
                planes[channel.part][channel.index] = Some(Vec::new());
            }
        }
        planes
    }

    /// Takes the values that were read.
    pub(super) fn fill(&mut self, mut planes: Vec<Vec<Option<Vec<f32>>>>) {
        for channel in &mut self.channels {
            if let Some(plane) = planes[channel.part][channel.index].take() {
                channel.values = Values::Read(plane);
            }
        }
    }
}
