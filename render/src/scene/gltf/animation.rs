//! Keyframe animation: where the nodes are, and how morph targets weigh, at one moment (glTF 2.0, 3.11 and
//! appendix C).

use super::{super::SceneError, document::File};
use glam::{Mat4, Quat, Vec3};
use gltf::{
    Accessor, Node,
    animation::{Interpolation, Property, Sampler},
    scene::Transform,
};

/// All nodes of a file at one moment.
#[derive(Debug)]
pub(super) struct Pose {
    /// From each node to its parent.
    pub locals: Vec<Mat4>,
    /// Morph weights of each node's mesh.
    pub weights: Vec<Vec<f32>>,
}

impl Pose {
    /// The pose that the first animation has at `time` seconds; the rest pose without an animation.
    pub fn at(file: &File<'_>, time: f32) -> Result<Self, SceneError> {
        Ok(Tracks::read(file)?.at(time))
    }
}

/// The first animation of a file, and how its nodes are at rest.
#[derive(Clone, Debug)]
pub(super) struct Tracks {
    transforms: Vec<Transform>,
    weights: Vec<Vec<f32>>,
    channels: Vec<Channel>,
}

/// What a track animates.
#[derive(Clone, Debug)]
struct Channel {
    node: usize,
    property: Property,
    track: Track,
}

impl Tracks {
    /// Reads all tracks of a file's first animation.
    pub fn read(file: &File<'_>) -> Result<Self, SceneError> {
        let transforms = file.document.nodes().map(|node| node.transform()).collect();
        let weights: Vec<_> = file.document.nodes().map(|node| rest_weights(&node)).collect();
        let channels = file.document.animations().next();
        let channels = channels.iter().flat_map(|animation| animation.channels()).map(|channel| {
            let (node, property) = (channel.target().node().index(), channel.target().property());
            let user = format!("animation 0, channel {}", channel.index());
            let track = Track::read(file, &channel.sampler(), property, weights[node].len(), &user)?;
            Ok(Channel { node, property, track })
        });
        let channels = channels.collect::<Result<_, SceneError>>()?;
        Ok(Self { transforms, weights, channels })
    }

    /// The pose at `time` seconds, that of the first or last key outside of them.
    pub fn at(&self, time: f32) -> Pose {
        let (mut transforms, mut weights) = (self.transforms.clone(), self.weights.clone());
        for Channel { node, property, track } in &self.channels {
            let value = track.at(time);
            match property {
                Property::MorphTargetWeights => weights[*node] = value,
                _ => set(&mut transforms[*node], *property, &value),
            }
        }
        Pose { locals: transforms.into_iter().map(matrix).collect(), weights }
    }

    /// Whether a node itself moves.
    pub fn moves(&self, node: usize) -> bool {
        let moves = |channel: &Channel| channel.property != Property::MorphTargetWeights;
        self.channels.iter().any(|channel| channel.node == node && moves(channel))
    }

    /// Whether the morph weights of a node's mesh change.
    pub fn weighs(&self, node: usize) -> bool {
        let weighs = |channel: &Channel| channel.property == Property::MorphTargetWeights;
        self.channels.iter().any(|channel| channel.node == node && weighs(channel))
    }

    /// When the animation begins and ends, seconds; `None` without one.
    pub fn span(&self) -> Option<[f32; 2]> {
        let times = || self.channels.iter().flat_map(|channel| channel.track.times.iter().copied());
        let (first, last) = (times().reduce(f32::min), times().reduce(f32::max));
        first.zip(last).map(|(first, last)| [first, last])
    }
}

/// When the first animation begins and ends, seconds; `None` where nothing is animated.
pub(super) fn span(file: &File<'_>) -> Result<Option<[f32; 2]>, SceneError> {
    Ok(Tracks::read(file)?.span())
}

/// The weights that a node has without animation: its own, else its mesh's, else zeros.
fn rest_weights(node: &Node<'_>) -> Vec<f32> {
    let Some(mesh) = node.mesh() else { return Vec::new() };
    let targets = mesh.primitives().map(|primitive| primitive.morph_targets().len()).max().unwrap_or(0);
    let mut weights = node.weights().or(mesh.weights()).unwrap_or_default().to_vec();
    weights.resize(targets, 0.0);
    weights
}

/// Replaces one property of a transform.
fn set(transform: &mut Transform, property: Property, value: &[f32]) {
    let (mut translation, mut rotation, mut scale) = transform.clone().decomposed();
    match property {
        Property::Translation => translation.copy_from_slice(value),
        Property::Rotation => rotation.copy_from_slice(value),
        Property::Scale => scale.copy_from_slice(value),
        Property::MorphTargetWeights => {}
    }
    *transform = Transform::Decomposed { translation, rotation, scale };
}

/// A node's transform as a matrix.
fn matrix(transform: Transform) -> Mat4 {
    match transform {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix),
        Transform::Decomposed { translation, rotation, scale } => {
            Mat4::from_scale_rotation_translation(scale.into(), unit(&rotation), Vec3::from(translation))
        }
    }
}

/// A rotation from its four components; none where they have no length.
fn unit(components: &[f32]) -> Quat {
    let rotation = Quat::from_slice(components);
    if rotation.length_squared().is_normal() { rotation.normalize() } else { Quat::IDENTITY }
}

/// The values of one animated property over time.
#[derive(Clone, Debug)]
struct Track {
    /// Increasing, seconds; never empty.
    times: Vec<f32>,
    /// For each time `width` values; for cubic splines three times as many: tangent in, value, tangent out.
    values: Vec<f32>,
    width: usize,
    interpolation: Interpolation,
    is_rotation: bool,
}

impl Track {
    /// Reads a track. `targets` is the number of morph targets of the animated node.
    fn read(
        file: &File<'_>,
        sampler: &Sampler<'_>,
        property: Property,
        targets: usize,
        user: &str,
    ) -> Result<Self, SceneError> {
        let times: Vec<f32> = file.floats::<1>(&sampler.input(), user)?.into_flattened();
        let output = sampler.output();
        let (values, width) = match property {
            Property::Rotation => (flat::<4>(file, &output, user)?, 4),
            Property::MorphTargetWeights => (flat::<1>(file, &output, user)?, targets),
            _ => (flat::<3>(file, &output, user)?, 3),
        };
        if times.is_empty() || !times.is_sorted_by(|a, b| a < b) {
            return Err(file.invalid(format!("{user}: its times do not increase")));
        }
        let interpolation = sampler.interpolation();
        let values_per_time = if interpolation == Interpolation::CubicSpline { 3 * width } else { width };
        if times.len().checked_mul(values_per_time) != Some(values.len()) {
            let (found, times) = (values.len(), times.len());
            return Err(
                file.invalid(format!("{user}: {found} values for {times} times of {values_per_time}"))
            );
        }
        Ok(Self { times, values, width, interpolation, is_rotation: property == Property::Rotation })
    }

    /// The value at a time, that of the first or last key outside of them.
    fn at(&self, time: f32) -> Vec<f32> {
        let next = self.times.partition_point(|key| *key <= time);
        if next == 0 || next == self.times.len() {
            return self.value(next.saturating_sub(1)).to_vec();
        }
        let key = next - 1;
        let span = self.times[next] - self.times[key];
        let t = (time - self.times[key]) / span;
        match self.interpolation {
            Interpolation::Step => self.value(key).to_vec(),
            Interpolation::CubicSpline => self.spline(key, span, t),
            Interpolation::Linear if self.is_rotation => {
                unit(self.value(key)).slerp(unit(self.value(next)), t).to_array().to_vec()
            }
            Interpolation::Linear => {
                self.value(key).iter().zip(self.value(next)).map(|(a, b)| a + (b - a) * t).collect()
            }
        }
    }

    /// The value at a key.
    fn value(&self, key: usize) -> &[f32] {
        self.part(key, usize::from(self.interpolation == Interpolation::CubicSpline))
    }

    /// One of the three parts of a key of a spline: tangent in, value, tangent out. Other keys have one part.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        &self.values[(key * parts + part) * self.width..][..self.width]
    }

    /// Cubic Hermite spline (glTF 2.0, appendix C.5).
    fn spline(&self, key: usize, span: f32, t: f32) -> Vec<f32> {
        let (t2, t3) = (t * t, t * t * t);
        let [value, leaving] = [self.part(key, 1), self.part(key, 2)];
        let [arriving, next] = [self.part(key + 1, 0), self.part(key + 1, 1)];
        let component = |i: usize| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * value[i]
                + span * (t3 - 2.0 * t2 + t) * leaving[i]
                + (3.0 * t2 - 2.0 * t3) * next[i]
                + span * (t3 - t2) * arriving[i]
        };
        (0..self.width).map(component).collect()
    }
}

/// The elements of an accessor in one row.
fn flat<const N: usize>(
    file: &File<'_>,
    accessor: &Accessor<'_>,
    user: &str,
) -> Result<Vec<f32>, SceneError> {
    Ok(file.floats::<N>(accessor, user)?.into_flattened())
}
