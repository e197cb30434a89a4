//! What a file shows, layer by layer, whoever wrote it: for looking at, where [`ExrImage::image`] knows what
//! it wants.

use super::names::Found;
use super::{ExrError, ExrImage};
use deepshade_shaders::Planes;

/// Components that make one layer where all of them are there.
const TRIPLES: [[&str; 3]; 2] = [["R", "G", "B"], ["X", "Y", "Z"]];

impl ExrImage {
    /// Names of the layers, in the file's order: channels `diffuse.R`, `.G` and `.B` are the layer `diffuse`,
    /// vectors in X, Y and Z as well, and every other channel is one by itself. Colours without a layer's
    /// name are `RGB`.
    pub fn layers(&self) -> Vec<String> {
        self.grouped().into_iter().map(|(name, _)| name).collect()
    }

    /// A layer by its name: `[3, height, width]`, or one plane.
    ///
    /// # Errors
    /// If there is none of that name.
    pub fn layer(&self, name: &str) -> Result<Planes, ExrError> {
        let mut layers = self.grouped();
        let channels = match layers.iter().position(|(other, _)| other == name) {
            Some(index) => layers.swap_remove(index).1,
            None => return self.gathered(&[(name.to_owned(), Found::Nothing)]),
        };
        let found = channels.into_iter().map(|index| (name.to_owned(), Found::One(index)));
        self.gathered(&found.collect::<Vec<_>>())
    }

    /// Every layer with the indices of its channels.
    fn grouped(&self) -> Vec<(String, Vec<usize>)> {
        let mut layers: Vec<(String, Vec<usize>)> = Vec::new();
        let mut taken = vec![false; self.names.len()];
        for index in 0..self.names.len() {
            if taken[index] {
                continue;
            }
            let (name, channels) = self.layer_of(index, &taken);
            channels.iter().for_each(|channel| taken[*channel] = true);
            layers.push((name, channels));
        }
        layers
    }

    /// The layer to which a channel belongs, made of those that no other layer has taken.
    fn layer_of(&self, index: usize, taken: &[bool]) -> (String, Vec<usize>) {
        let whole = &self.names[index];
        let (layer, component) = whole.rsplit_once('.').unwrap_or(("", whole));
        let find = |component: &str| {
            let wanted = if layer.is_empty() { component.to_owned() } else { format!("{layer}.{component}") };
            let mut free = (0..self.names.len()).filter(|other| !taken[*other]);
            free.find(|other| self.names[*other].eq_ignore_ascii_case(&wanted))
        };
        for triple in
            TRIPLES.iter().filter(|triple| triple.iter().any(|one| one.eq_ignore_ascii_case(component)))
        {
            let found: Option<Vec<usize>> = triple.iter().map(|component| find(component)).collect();
            if let Some(channels) = found {
                let name = if layer.is_empty() { triple.concat() } else { layer.to_owned() };
                return (name, channels);
            }
        }
        (whole.clone(), vec![index])
    }
}
