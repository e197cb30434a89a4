//! Names that people mistype: which of those that are known was meant.

/// How alike two names must be, from 0 to 1, for one to be taken for the other mistyped.
const ALIKE: f64 = 0.75;

/// The known name that is most like one that is not known, by Jaro's similarity (JASA 84(406), 1989); none
/// where nothing is like it. Capitals and the kind of dash mean nothing.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |name: &str| name.to_lowercase().replace('_', "-");
    let wanted = plain(name);
    let alike = known.into_iter().map(|known| (strsim::jaro(&wanted, &plain(known)), known));
    let best = alike.filter(|(likeness, _)| *likeness > ALIKE);
    best.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, known)| known)
}

/// What is said behind a name that is not known: ` (did you mean ...?)`, or nothing where nothing is like it.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, known).map_or_else(String::new, |known| format!(" (did you mean `{known}`?)"))
}

/// What serde says of a key or a name that it does not know, with the one that was meant behind it.
pub fn with_meant(message: &str) -> String {
    let unknown = ["unknown field `", "unknown variant `"].into_iter().find_map(|lead| {
        let (_, rest) = message.split_once(lead)?;
        rest.split_once('`')
    });
    let Some((name, rest)) = unknown else { return message.to_owned() };
    let known = rest.split('`').skip(1).step_by(2);
    let head = message.len() - rest.len();
    format!("{}{}{rest}", &message[..head], did_you_mean(name, known))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_hand_is_known_for_what_was_meant() {
        let known = ["learned", "gtao", "hbao", "fog-march", "screen-truth"];
        for (wrong, meant) in [
            ("gtoa", "gtao"),
            ("HBAO", "hbao"),
            ("hbao+", "hbao"),
            ("learnt", "learned"),
            ("fog_march", "fog-march"),
        ] {
            assert_eq!(nearest(wrong, known), Some(meant), "{wrong}");
        }
        for other in ["", "x", "voxels", "42"] {
            assert_eq!(nearest(other, known), None, "{other}");
        }
        assert_eq!(did_you_mean("gtoa", known), " (did you mean `gtao`?)");
        assert_eq!((did_you_mean("voxels", known), did_you_mean("gtoa", [])), (String::new(), String::new()));
    }

    #[test]
    fn keys_that_serde_does_not_know_are_followed_by_what_was_meant() {
        let of = |name: &str| format!("at line 3\nunknown field `{name}`, expected one of `seed`, `samples`");
        let meant =
            "at line 3\nunknown field `sampels` (did you mean `samples`?), expected one of `seed`, `samples`";
        assert_eq!(with_meant(&of("sampels")), meant);
        let two = with_meant("unknown variant `tran`, expected `train` or `test`");
        assert_eq!(two, "unknown variant `tran` (did you mean `train`?), expected `train` or `test`");
        for other in [of("colour"), "missing field `seed`".to_owned(), "unknown field `".to_owned()] {
            assert_eq!(with_meant(&other), other);
        }
    }
}
