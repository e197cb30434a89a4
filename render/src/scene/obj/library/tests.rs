//! Materials as libraries state them.

use super::*;
use std::path::Path;

fn read(text: &str) -> (Vec<MtlMaterial>, Vec<String>) {
    let mut warnings = Warnings::default();
    let materials = parse(text, &Files::beside(Path::new("no such folder"), Path::new("")), &mut warnings);
    (materials, warnings.about(Path::new("a")))
}

#[test]
fn one_number_is_grey_and_what_is_no_colour_is_said_and_passed_over() {
    let (read_of, warnings) = read("\u{feff}newmtl a\nKd .8\nKe 0\n ks 1 0.5 0 # shine\n");
    assert_eq!(read_of[0].diffuse, Some(Vec3::splat(0.8)));
    assert_eq!(
        (read_of[0].emission, read_of[0].specular),
        (Some(Vec3::ZERO), Some(Vec3::new(1.0, 0.5, 0.0)))
    );
    assert!(warnings.is_empty());
    for odd in ["Kd 1 0", "Kd", "Ks nan 1 1", "Kd spectral a.rfl", "Ke xyz 1 1 1", "d inf", "Pr very"] {
        let (read_of, warnings) = read(&format!("newmtl a\nKa spectral a.rfl\n{odd}\nNs 3\n"));
        assert_eq!(
            read_of[0],
            MtlMaterial { name: "a".into(), exponent: Some(3.0), ..MtlMaterial::default() }
        );
        assert!(warnings.len() == 1 && warnings[0].starts_with("a: line 3: "), "{odd}: {warnings:?}");
    }
}

#[test]
fn opacity_is_stated_in_three_ways() {
    let opacity = |text: &str| read(&format!("newmtl a\n{text}\n")).0[0].dissolve;
    assert_eq!(
        ["d 0.25", "Tr 0.25", "Tr 0.1\nd 0.5", "d -halo 0"].map(opacity),
        [Some(0.25), Some(0.75), Some(0.5), None]
    );
}

#[test]
fn names_have_spaces_and_the_last_of_the_same_name_counts() {
    let (materials, warnings) =
        read("Kd 1 1 1\nnewmtl red paint\nKd 1 0 0\nnewmtl b\nnewmtl red paint\nNs 1\n");
    let names: Vec<&str> = materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((names.as_slice(), materials[0].diffuse), (&["red paint", "b"][..], None));
    assert_eq!(warnings, ["a: line 1: `Kd` before the first `newmtl` is passed over"]);
}

#[test]
fn empty_maps_and_unknown_keywords_are_said() {
    let (materials, warnings) = read("newmtl a\nmap_Kd\nmap_d # none\nmap_bump \nhello 1\n");
    assert!(materials[0].diffuse_map.is_none() && materials[0].dissolve_map.is_none());
    assert_eq!(
        warnings,
        [
            "a: line 2: `map_Kd`: a map without a file is passed over",
            "a: line 3: `map_d`: a map without a file is passed over",
            "a: line 5: `hello` is passed over"
        ]
    );
}

#[test]
fn what_changes_the_picture_is_said_and_what_never_shows_is_not() {
    for keyword in ["bump", "map_Bump", "disp", "decal", "refl", "map_Ks", "map_Ns", "map_Pr", "map_Pm"] {
        let (_, warnings) = read(&format!("newmtl a\n{keyword} -bm 1 x.png\n{keyword} y.png\n"));
        let expected =
            format!("a: line 2 and another: `{keyword}` is left out, though it changes the picture");
        assert_eq!(warnings, [expected]);
    }
    for said in ["Tf 0.5 1 1", "Tf spectral a.rfl", "Pc 1", "aniso 0.5"] {
        assert_eq!(read(&format!("newmtl a\n{said}\n")).1.len(), 1, "{said}");
    }
    let silent = "Ka 1 1 1\nmap_Ka x.png\nNi 1.45\nillum 2\nsharpness 60\nTf 1.0 1 1 # all\nPs 0.0\nPc 0";
    assert_eq!(read(&format!("newmtl a\n{silent}\n")).1, Vec::<String>::new());
}

#[test]
fn values_are_brought_into_their_ranges_and_said() {
    let (materials, warnings) = read("newmtl a\nKd 2 -1 .1# red\nPr 3\nPm -1\nd 1.5\nKe 5 -1 0\nNs -2\n");
    let a = &materials[0];
    assert_eq!(a.diffuse, Some(Vec3::new(1.0, 0.0, 0.1)));
    assert_eq!((a.roughness, a.metallic, a.dissolve), (Some(1.0), Some(0.0), Some(1.0)));
    assert_eq!((a.emission, a.exponent), (Some(Vec3::new(5.0, 0.0, 0.0)), Some(0.0)));
    assert_eq!(warnings.len(), 6, "{warnings:?}");
    assert_eq!(warnings[0], "a: line 2: `Kd` is brought to 0 to 1");
    assert_eq!(warnings[4], "a: line 6: `Ke` is brought to 0 and more");
    let (_, sound) = read("newmtl a\nKd 0 1 .5\nKe 9 0 0\nNs 1000\nTr 1\nPr 0\nPm 1\nKs 2 2 2\n");
    assert_eq!(sound, Vec::<String>::new());
}
