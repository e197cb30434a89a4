//! A look at the lines of OBJ and MTL files before they are parsed; errors say which line is wrong.

/// Checks that the indices of all faces are in range and that these are no more than `most` triangles. Negative indices
/// count back from the last element above the line.
pub(super) fn check_faces(text: &str, most: usize) -> Result<(), String> {
    let keywords = || text.lines().filter_map(|line| line.split_whitespace().next());
    let total = ["v", "vt", "vn"].map(|kind| keywords().filter(|keyword| *keyword == kind).count() as i64);
    let (mut above, mut triangles) = ([0i64; 3], 0);
    for (line, content) in text.lines().enumerate() {
        let mut words = content.split_whitespace();
        match words.next() {
            Some("v") => above[0] += 1,
            Some("vt") => above[1] += 1,
            Some("vn") => above[2] += 1,
            Some(kind @ ("f" | "l")) => {
                if kind == "f" {
                    triangles += words.clone().count().saturating_sub(2);
                }
                if triangles > most {
                    let what = format!("there are more triangles than the {most} that memory holds");
                    return Err(format!("line {}: {what}", line + 1));
                }
                for word in words {
                    let known = word.split('/').count() <= 3
                        && word.split('/').zip(total.iter().zip(above)).all(|(index, (total, above))| {
                            index.is_empty() || in_range(index, *total, above)
                        });
                    if !known || word.starts_with('/') {
                        return Err(format!("line {}: there is no vertex `{word}`", line + 1));
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn in_range(index: &str, total: i64, above: i64) -> bool {
    index.parse().is_ok_and(|index: i64| (1..=total).contains(&index) || (-above..=-1).contains(&index))
}

/// Checks that all colours of a material library have three finite components.
pub(super) fn check_colours(text: &str) -> Result<(), String> {
    for (line, content) in text.lines().enumerate() {
        let mut words = content.split_whitespace();
        if let Some(keyword @ ("Ka" | "Kd" | "Ks" | "Ke")) = words.next() {
            let finite = |word: &str| word.parse().is_ok_and(f32::is_finite);
            if words.take(3).filter(|word| finite(word)).count() != 3 {
                return Err(format!("line {}: {keyword} is not three numbers", line + 1));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";

    #[test]
    fn faces_in_range_pass() {
        for face in ["f 1 2 3", "f -3 -2 -1", "f 1//1 2//1 3//-1", "# f 9 9 9"] {
            assert_eq!(check_faces(&format!("{CORNERS}{face}"), 9), Ok(()), "{face}");
        }
    }

    #[test]
    fn faces_out_of_range_are_named_with_their_line() {
        for word in [
            "0",
            "4",
            "-4",
            "1/1",
            "1//2",
            "1//1/1",
            "/1",
            "x",
            "6148914691236517206",
            "1//6148914691236517206",
        ] {
            let error = check_faces(&format!("{CORNERS}f 1 2 {word}"), 9).expect_err(word);
            assert_eq!(error, format!("line 5: there is no vertex `{word}`"));
        }
    }

    #[test]
    fn reading_stops_where_memory_holds_no_more_triangles() {
        let text = format!("{CORNERS}f 1 2 3\nl 1 2 3 1\nf 1 2 3 1 2\n");
        assert_eq!(check_faces(&text, 4), Ok(()));
        let error = check_faces(&text, 3).expect_err("one and three");
        assert_eq!(error, "line 7: there are more triangles than the 3 that memory holds");
    }

    #[test]
    fn colours_are_three_finite_numbers() {
        assert_eq!(check_colours("newmtl a\n Kd 1 0.5 0\nNs 3"), Ok(()));
        for bad in ["Kd 1 0", "Ke 0", "Ks nan 1 1", "Kd spectral a.rfl"] {
            assert!(
                check_colours(&format!("newmtl a\n{bad}")).is_err_and(|error| error.starts_with("line 2")),
                "{bad}"
            );
        }
    }
}
