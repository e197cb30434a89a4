//! Which channel of a file is which channel of a g-buffer.

use deepshade_shaders::{AttributeKind, Channel};

/// The index of the one name that stands for a channel: the name itself without regard to case, or else the only
/// one that ends in it after a dot. Vectors may be named like colours and the reverse.
pub fn find(names: &[String], channel: Channel) -> Option<usize> {
    spellings(channel).iter().find_map(|spelling| find_name(names, spelling))
}

/// [`find`] for a name of one's own.
pub fn find_name(names: &[String], wanted: &str) -> Option<usize> {
    let same = |name: &String| name.eq_ignore_ascii_case(wanted);
    names.iter().position(same).or_else(|| {
        let mut longer = (0..names.len()).filter(|index| ends_in(&names[*index], wanted));
        longer.next().filter(|_| longer.next().is_none())
    })
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
        AttributeKind::Motion | AttributeKind::Scales => return vec![channel.to_string()],
    };
    vec![channel.to_string(), format!("{layer}.{}", others[channel.component])]
}

/// A scalar's channel is the bare name, or has one of the component names that renderers give to lone channels.
fn scalar_spellings(layer: &str) -> Vec<String> {
    let with_component = ["V", "Z", "Y", "R", "X"].map(|component| format!("{layer}.{component}"));
    std::iter::once(layer.to_owned()).chain(with_component).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Attribute;

    fn found(names: &[&str], attribute: Attribute) -> Option<usize> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        find(&names, Channel { attribute, component: 0 })
    }

    #[test]
    fn names_of_other_renderers_are_understood() {
        assert_eq!(found(&["depth", "normal.X"], Attribute::Normal), Some(1));
        assert_eq!(found(&["ViewLayer.Normal.Y", "ViewLayer.Normal.X"], Attribute::Normal), Some(1));
        assert_eq!(found(&["NORMAL.R"], Attribute::Normal), Some(0));
        assert_eq!(found(&["ViewLayer.Depth.V"], Attribute::Depth), Some(0));
        assert_eq!(found(&["diffuse.R"], Attribute::Diffuse), Some(0));
    }

    #[test]
    fn other_layers_and_doubtful_ones_are_not_taken() {
        assert_eq!(found(&["world_normal.X"], Attribute::Normal), None);
        assert_eq!(found(&["left.normal.X", "right.normal.X"], Attribute::Normal), None);
        assert_eq!(found(&["left.normal.X", "normal.x"], Attribute::Normal), Some(1));
    }
}
