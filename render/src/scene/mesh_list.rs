//! The meshes of a scene, shared by its copies.

use super::Mesh;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// A list of meshes that copies share until one of them changes something.
#[derive(Clone, Debug, Default)]
pub struct Meshes(Arc<Vec<Mesh>>);

impl Deref for Meshes {
    type Target = Vec<Mesh>;

    fn deref(&self) -> &Vec<Mesh> {
        &self.0
    }
}

impl DerefMut for Meshes {
    /// Copies the meshes where another list shares them.
    fn deref_mut(&mut self) -> &mut Vec<Mesh> {
        Arc::make_mut(&mut self.0)
    }
}

impl From<Vec<Mesh>> for Meshes {
    fn from(meshes: Vec<Mesh>) -> Self {
        Self(Arc::new(meshes))
    }
}

impl FromIterator<Mesh> for Meshes {
    fn from_iter<I: IntoIterator<Item = Mesh>>(meshes: I) -> Self {
        Vec::from_iter(meshes).into()
    }
}

impl<'a> IntoIterator for &'a Meshes {
    type Item = &'a Mesh;
    type IntoIter = std::slice::Iter<'a, Mesh>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Meshes {
    type Item = &'a mut Mesh;
    type IntoIter = std::slice::IterMut<'a, Mesh>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_share_their_meshes_until_one_changes() {
        let meshes = Meshes::from(vec![Mesh::default()]);
        let mut copy = meshes.clone();
        assert_eq!(meshes.as_ptr(), copy.as_ptr());
        copy[0].name = "other".to_owned();
        assert_eq!((meshes[0].name.as_str(), copy[0].name.as_str()), ("", "other"));
    }
}
