//! Ambient occlusion by the scene's triangles: ambient occlusion volumes.
//!
//! McGuire, "Ambient Occlusion Volumes", HPG 2010. Around each triangle there is a volume in which it
//! matters: what is in front of it, or on either side where its surface is no closed one, and near enough. A
//! pixel inside is occluded by the triangle's form factor, above the pixel's tangent plane, which has a
//! closed form ([`polygon`]); what all triangles occlude is added up. Triangles count whether they are seen
//! or not, and no sample is drawn, so that there is no noise.
//!
//! The paper draws the volumes; here pixels walk a tree over the triangles ([`facets`]) and so meet those
//! whose volumes they are in.
//!
//! The paper weighs a form factor by a falloff, the product of distances to the volume's planes. The effect
//! here is everything within a radius and nothing beyond, so that the triangle is cut off by the sphere of
//! that radius instead, which has a closed form as well, and into how many triangles a surface is cut changes
//! nothing.
//!
//! What hides behind something counts, too, so that sums are too large. The paper compensates by a map from
//! the sum to what is seen; its own map was not at hand when this was written, and the one here is
//! `1 - m (1 - exp(-sum / m))` ([`MOST_HIDDEN`](reference::MOST_HIDDEN)).
//!
//! - [`volumes`] is the paper's method.
//! - [`bounced`] is that with a bounced z-buffer: Nalbach, Ritschel and Seidel, "The Bounced Z-Buffer for
//!   Indirect Visibility", VMV 2015 (thesis 6.2). Of a few directions of each pixel the nearest triangle
//!   counts, and a filter brings neighbours' directions together, as for [`bounced_z`](super::bounced_z) over
//!   surfels.
//! - [`reference`](mod@reference) is the slow, plain version of both.
//!
//! Limits. The volumes' sum grows darker with every surface behind the first, and what compensates for that
//! makes a lone wall too bright. Closed surfaces occlude only what is in front of them, else their far halves
//! would count: one that is inside out does nothing. The bounced z-buffer has none of these faults, and noise
//! and blur in their place. Time grows with the triangles within reach, of which there is no coarser version.
//!
//! Unlike [`surfel`](super::surfel) they have no surfels that hold less detail than the scene, and unlike
//! [`gtao`](super::gtao) they know what the camera does not see.

pub mod bounced;
pub mod facets;
pub mod polygon;
pub mod reference;
#[cfg(test)]
mod tests;
pub mod volumes;

pub use volumes::Volumes;
