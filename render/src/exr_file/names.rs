//! Which channel of a file is which channel of a g-buffer.

use deepshade_shaders::{Attribute, AttributeKind, Channel};

/// What of a file's channels a name may stand for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// None of them.
    Nothing,
    /// The one of this index.
    One(usize),
    /// Several, such as those of two view layers.
    Several(Vec<usize>),
}

/// The channel that stands for one of a g-buffer: the one of that name without regard to case, or else the
/// one whose name ends in it after a dot. Vectors may be named like colours and the reverse.
pub fn find(names: &[String], channel: Channel) -> Found {
    let found = spellings(channel).into_iter().map(|spelling| find_name(names, &spelling));
    found.into_iter().find(|found| *found != Found::Nothing).unwrap_or(Found::Nothing)
}

/// [`find`] for a name of one's own.
pub fn find_name(names: &[String], wanted: &str) -> Found {
    if let Some(same) = names.iter().position(|name| name.eq_ignore_ascii_case(wanted)) {
        return Found::One(same);
    }
    let longer: Vec<usize> = (0..names.len()).filter(|index| ends_in(&names[*index], wanted)).collect();
    match longer[..] {
        [] => Found::Nothing,
        [index] => Found::One(index),
        _ => Found::Several(longer),
    }
}

/// Whether a name may stand for a channel of one of these attributes.
pub fn may_be_of(name: &str, attributes: &[Attribute]) -> bool {
    let mut spelled = attributes.iter().flat_map(|attribute| attribute.channels()).flat_map(spellings);
    spelled.any(|spelling| name.eq_ignore_ascii_case(&spelling) || ends_in(name, &spelling))
}

/// Whether a name may stand for red, green, blue or grey, or for what is left of a colour beside its grey.
pub fn may_be_colour(name: &str) -> bool {
    let component = name.rsplit('.').next().unwrap_or(name);
    ["R", "G", "B", "Y", "RY", "BY"].iter().any(|known| known.eq_ignore_ascii_case(component))
}

/// A name without one of its parts between dots; none where it has no such part. View layers and the views
/// of stereo images are named by one: `ViewLayer.Normal.X`, `normal.left.X`.
pub fn within_layer(name: &str, layer: &str) -> Option<String> {
    let (dotted, wanted) = (format!(".{name}."), format!(".{layer}."));
    let at = dotted.to_ascii_lowercase().find(&wanted.to_ascii_lowercase())?;
    let rest = format!("{}{}", &dotted[..at], &dotted[at + wanted.len() - 1..]);
    Some(rest.trim_matches('.').to_owned())
}

/// Whether a name is some prefix, a dot, and `wanted`.
fn ends_in(name: &str, wanted: &str) -> bool {
    let (name, wanted) = (name.as_bytes(), wanted.as_bytes());
    name.len() > wanted.len() + 1
        && name[name.len() - wanted.len()..].eq_ignore_ascii_case(wanted)
        && name[name.len() - wanted.len() - 1] == b'.'
}

/// The ways in which renderers write a channel's name, the project's own first.
fn spellings(channel: Channel) -> Vec<String> {
    let layer = channel.attribute.name();
    let others: &[&str] = match channel.attribute.kind() {
        AttributeKind::CameraVector | AttributeKind::WorldVector => &["R", "G", "B"],
        AttributeKind::Colour => &["X", "Y", "Z"],
        AttributeKind::Scalar => return scalar_spellings(layer),
        AttributeKind::Motion | AttributeKind::Scales | AttributeKind::DoubledAngle => {
            return vec![channel.to_string()];
        }
    };
    vec![channel.to_string(), format!("{layer}.{}", others[channel.component])]
}

/// A scalar's channel is the bare name, or has one of the component names that renderers give to lone
/// channels.
fn scalar_spellings(layer: &str) -> Vec<String> {
    let with_component = ["V", "Z", "Y", "R", "X"].map(|component| format!("{layer}.{component}"));
    std::iter::once(layer.to_owned()).chain(with_component).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str], attribute: Attribute) -> Found {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        find(&names, Channel { attribute, component: 0 })
    }

    #[test]
    fn names_of_other_renderers_are_understood() {
        assert_eq!(found(&["depth", "normal.X"], Attribute::Normal), Found::One(1));
        assert_eq!(found(&["ViewLayer.Normal.Y", "ViewLayer.Normal.X"], Attribute::Normal), Found::One(1));
        assert_eq!(found(&["NORMAL.R"], Attribute::Normal), Found::One(0));
        assert_eq!(found(&["ViewLayer.Depth.V"], Attribute::Depth), Found::One(0));
        assert_eq!(found(&["diffuse.R"], Attribute::Diffuse), Found::One(0));
    }

    #[test]
    fn other_layers_are_not_taken_and_doubtful_ones_are_all_named() {
        assert_eq!(found(&["world_normal.X"], Attribute::Normal), Found::Nothing);
        let two = ["left.normal.X", "right.normal.X"];
        assert_eq!(found(&two, Attribute::Normal), Found::Several(vec![0, 1]));
        assert_eq!(found(&["left.normal.X", "normal.x"], Attribute::Normal), Found::One(1));
    }

    #[test]
    fn a_layer_is_a_part_of_the_name_wherever_it_stands() {
        assert_eq!(within_layer("ViewLayer.Normal.X", "viewlayer").as_deref(), Some("Normal.X"));
        assert_eq!(within_layer("normal.left.X", "left").as_deref(), Some("normal.X"));
        assert_eq!(within_layer("a.b.normal.X", "a.b").as_deref(), Some("normal.X"));
        assert_eq!(within_layer("depth.left", "left").as_deref(), Some("depth"));
        for other in ["ViewLayer_001.Normal.X", "leftmost.X", "normal.X"] {
            assert_eq!(within_layer(other, "ViewLayer"), None);
            assert_eq!(within_layer(other, "left"), None);
        }
    }

    #[test]
    fn what_nobody_asks_for_is_not_wanted() {
        let wants = |name| may_be_of(name, &[Attribute::Normal, Attribute::Depth]);
        assert!(wants("ViewLayer.Normal.X") && wants("NORMAL.b") && wants("depth") && wants("a.Depth.Z"));
        assert!(!wants("RY") && !wants("thumb.Y") && !wants("ViewLayer.Denoising Normal.X"));
        assert!(may_be_colour("R") && may_be_colour("Combined.b") && may_be_colour("RY"));
        assert!(!may_be_colour("A") && !may_be_colour("depth"));
    }
}
