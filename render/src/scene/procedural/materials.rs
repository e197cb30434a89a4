//! Plausible materials with random colours and procedural textures.

use super::noise;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use crate::scene::{AlphaMode, Encoding, Material, MaterialId, Texture, Wrap};
use deepshade_shaders::colour::srgb_byte;
use glam::{IVec3, Vec2, Vec3};

/// Texels along the edge of a texture.
const SIZE: usize = 128;

/// A colour from hue, saturation and value, each in [0, 1], taken as linear.
pub fn colour(hue: f32, saturation: f32, value: f32) -> Vec3 {
    let channel = |offset: f32| {
        let distance = ((hue + offset).rem_euclid(1.0) * 6.0 - 3.0).abs() - 1.0;
        value * (1.0 - saturation * (1.0 - distance.clamp(0.0, 1.0)))
    };
    Vec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

/// Paint, plastic or cloth of any colour.
pub fn paint(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.unit(), random.within(0.1, 0.8), random.within(0.25, 0.85));
    let roughness = random.within(0.25, 0.9);
    builder.material(solid("paint", base, roughness))
}

/// Wall plaster: pale, with soft stains.
pub fn plaster(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.05, 0.2), random.within(0.02, 0.25), random.within(0.6, 0.9));
    let seed = random.bits();
    let shade = move |uv: Vec2| 1.0 + 0.12 * noise::fbm(seed, (uv * 6.0).extend(0.5), 4);
    textured(builder, "plaster", base, 0.9, 1.5, Wrap::Mirror, shade)
}

/// Sawn wood with its grain along u.
pub fn wood(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.05, 0.11), random.within(0.45, 0.75), random.within(0.2, 0.6));
    let (seed, rings) = (random.bits(), random.within(8.0, 20.0));
    let shade = move |uv: Vec2| {
        let bend = noise::fbm(seed, Vec3::new(uv.x * 2.0, uv.y * 5.0, 0.5), 3);
        let ring = (uv.y * rings + bend * 3.0).rem_euclid(1.0);
        let fibre = noise::gradient(seed ^ 1, Vec3::new(uv.x * 8.0, uv.y * 60.0, 0.5));
        0.72 + 0.33 * ring + 0.12 * fibre
    };
    textured(builder, "wood", base, random.within(0.4, 0.8), 0.8, Wrap::Mirror, shade)
}

/// Natural stone: grey to brown, mottled.
pub fn stone(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.04, 0.16), random.within(0.02, 0.3), random.within(0.3, 0.7));
    let seed = random.bits();
    let shade = move |uv: Vec2| {
        let grain = noise::gradient(seed ^ 1, (uv * 40.0).extend(0.5));
        0.95 + 0.4 * noise::fbm(seed, (uv * 5.0).extend(0.5), 5) + 0.1 * grain
    };
    textured(builder, "stone", base, random.within(0.7, 1.0), 1.2, Wrap::Mirror, shade)
}

/// Polished stone with veins.
pub fn marble(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.0, 0.6), random.within(0.02, 0.2), random.within(0.5, 0.85));
    let seed = random.bits();
    let shade = move |uv: Vec2| {
        let vein = noise::fbm(seed, (uv * 4.0).extend(0.5), 5).abs();
        0.55 + 0.5 * (vein * 6.0).min(1.0)
    };
    textured(builder, "marble", base, random.within(0.1, 0.4), 1.0, Wrap::Mirror, shade)
}

/// Bare or painted metal.
pub fn metal(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.05, 0.15), random.within(0.0, 0.5), random.within(0.5, 0.9));
    let roughness = random.within(0.15, 0.6);
    builder.material(Material { metallic: 1.0, ..solid("metal", base, roughness) })
}

/// Earth, sand or grass seen from above.
pub fn earth(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.07, 0.3), random.within(0.25, 0.6), random.within(0.2, 0.5));
    let seed = random.bits();
    let shade = move |uv: Vec2| 0.9 + 0.6 * noise::fbm(seed, (uv * 10.0).extend(0.5), 5);
    textured(builder, "earth", base, 1.0, 2.0, Wrap::Mirror, shade)
}

/// Fine woven cloth.
pub fn cloth(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.unit(), random.within(0.1, 0.7), random.within(0.3, 0.85));
    let stripes = random.count(1, 6) as f32;
    let contrast = random.within(0.0, 0.5);
    let shade = move |uv: Vec2| if (uv.x * stripes).rem_euclid(1.0) < 0.5 { 1.0 } else { 1.0 - contrast };
    textured(builder, "cloth", base, 1.0, random.within(0.2, 0.6), Wrap::Repeat, shade)
}

/// A checker of two shades.
pub fn checker(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.unit(), random.within(0.0, 0.4), random.within(0.6, 0.85));
    let dark = random.within(0.15, 0.6);
    let shade = move |uv: Vec2| if (uv.x < 0.5) == (uv.y < 0.5) { 1.0 } else { dark };
    textured(builder, "checker", base, random.within(0.2, 0.7), random.within(0.5, 1.0), Wrap::Repeat, shade)
}

/// Bricks in stretcher bond, with a normal map for the joints.
pub fn bricks(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.0, 0.08), random.within(0.3, 0.7), random.within(0.35, 0.7));
    courses(builder, random, "bricks", base, 0.9, Courses { columns: 4, rows: 12, shift: 0.5, width: 1.0 })
}

/// Glazed or stone tiles, with a normal map for the joints.
pub fn tiles(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.unit(), random.within(0.0, 0.5), random.within(0.4, 0.85));
    let count = random.count(2, 6);
    let width = random.within(0.6, 1.6);
    courses(builder, random, "tiles", base, 0.3, Courses { columns: count, rows: count, shift: 0.0, width })
}

/// Green of any plant.
pub fn foliage(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.15, 0.36), random.within(0.4, 0.8), random.within(0.2, 0.6));
    builder.material(solid("foliage", base, random.within(0.5, 0.9)))
}

/// Leaves, with the leaf cut out of its square by alpha.
pub fn leaves(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let base = colour(random.within(0.15, 0.36), random.within(0.4, 0.8), random.within(0.2, 0.6));
    let (lobes, depth) = (random.count(1, 7) as f32, random.within(0.0, 0.4));
    let texels = filled(SIZE, |uv| {
        let centred = uv * 2.0 - Vec2::ONE;
        let jagged = depth * (centred.y * lobes * 3.0).sin().abs();
        let half_width =
            (1.0 - centred.y * centred.y).max(0.0) * (0.55 - 0.2 * centred.y) * (1.0 - jagged) * 1.4;
        let vein = 0.75 + 0.25 * (centred.x.abs() * 12.0).min(1.0);
        let inside = centred.x.abs() < half_width;
        (base * vein).extend(f32::from(inside))
    });
    let slot = builder.texture(Texture::new(SIZE, SIZE, texels, Encoding::Srgb, [Wrap::Clamp; 2]), 1.0);
    let leaf = solid("leaves", Vec3::ONE, random.within(0.5, 0.9));
    builder.material(Material { base_colour_texture: Some(slot), alpha: AlphaMode::Mask(0.5), ..leaf })
}

/// One of the materials of buildings' walls.
pub fn masonry(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let make = random.pick::<Maker>(&[plaster, stone, bricks, stone]);
    make(builder, random)
}

/// One of the materials of floors.
pub fn flooring(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let make = random.pick::<Maker>(&[wood, tiles, checker, stone, marble]);
    make(builder, random)
}

/// One of the materials of small things.
pub fn any(builder: &mut SceneBuilder, random: &mut Random) -> MaterialId {
    let make = random.pick::<Maker>(&[paint, paint, wood, stone, marble, metal]);
    make(builder, random)
}

/// `count` of the materials that a maker makes.
pub fn several(
    count: usize,
    make: Maker,
    builder: &mut SceneBuilder,
    random: &mut Random,
) -> Vec<MaterialId> {
    (0..count).map(|_| make(builder, random)).collect()
}

/// Makes a material.
pub type Maker = fn(&mut SceneBuilder, &mut Random) -> MaterialId;

/// How bricks or tiles are laid in a square of `width` metres.
#[derive(Clone, Copy)]
struct Courses {
    columns: usize,
    rows: usize,
    /// By how much of a brick every other row is shifted.
    shift: f32,
    width: f32,
}

impl Courses {
    /// The brick at a point and the distance to its border, in shares of the texture's width.
    fn at(self, uv: Vec2) -> (IVec3, f32) {
        let (columns, rows) = (self.columns as f32, self.rows as f32);
        let row = (uv.y * rows).floor();
        let along = (uv.x * columns + self.shift * (row % 2.0)).rem_euclid(columns);
        let inside = Vec2::new(along.fract(), (uv.y * rows).fract());
        let border = inside.min(Vec2::ONE - inside) / Vec2::new(columns, rows);
        (IVec3::new(along as i32, row as i32, 0), border.min_element())
    }
}

/// A material of bricks or tiles with a colour of its own for each and a normal map.
fn courses(
    builder: &mut SceneBuilder,
    random: &mut Random,
    name: &str,
    base: Vec3,
    rough: f32,
    laid: Courses,
) -> MaterialId {
    let (seed, contrast) = (random.bits(), random.within(0.1, 0.5));
    let joint = 0.008 / laid.width;
    let shade = move |uv: Vec2| {
        let (brick, border) = laid.at(uv);
        let own = 1.0 - contrast * noise::of_cell(seed, brick);
        if border < joint { 0.6 } else { own }
    };
    let id = textured(builder, name, base, rough, laid.width, Wrap::Repeat, shade);
    let height = move |uv: Vec2| (laid.at(uv).1 / joint).min(2.0) * joint;
    let slot = builder.texture(normal_map(height), laid.width);
    let material = builder.get(id).clone();
    builder.material(Material { normal_texture: Some((slot, 1.0)), ..material })
}

/// An opaque dielectric.
fn solid(name: &str, base: Vec3, roughness: f32) -> Material {
    Material { roughness, ..Material::matte(name, base) }
}

/// A material whose colour is multiplied by a shade that depends on the place in a square of `width` metres.
fn textured(
    builder: &mut SceneBuilder,
    name: &str,
    base: Vec3,
    roughness: f32,
    width: f32,
    wrap: Wrap,
    shade: impl Fn(Vec2) -> f32,
) -> MaterialId {
    let texels = filled(SIZE, |uv| (base * shade(uv)).extend(1.0));
    let slot = builder.texture(Texture::new(SIZE, SIZE, texels, Encoding::Srgb, [wrap; 2]), width);
    builder.material(Material { base_colour_texture: Some(slot), ..solid(name, Vec3::ONE, roughness) })
}

/// Texels of a square of `size` x `size` from linear values at their middles.
pub fn filled(size: usize, value: impl Fn(Vec2) -> glam::Vec4) -> Vec<[u8; 4]> {
    let texel = |index: usize| {
        let value = value(middle(index, size));
        let [r, g, b] = value.truncate().to_array().map(srgb_byte);
        [r, g, b, (value.w * 255.0) as u8]
    };
    (0..size * size).map(texel).collect()
}

/// Tangent-space normals of a height, both in shares of the texture's width.
fn normal_map(height: impl Fn(Vec2) -> f32) -> Texture {
    let step = 1.0 / SIZE as f32;
    let texel = |index: usize| {
        let uv = middle(index, SIZE);
        let slope = |along: Vec2| {
            let (before, after) = ((uv - along).rem_euclid(Vec2::ONE), (uv + along).rem_euclid(Vec2::ONE));
            (height(after) - height(before)) / (2.0 * step)
        };
        // Green points against v (glTF 2.0, 3.9.3), so a height that grows with v leans towards +green.
        let normal = Vec3::new(-slope(Vec2::X * step), slope(Vec2::Y * step), 1.0).normalize();
        let [r, g, b] = (normal * 0.5 + 0.5).to_array().map(|value| (value * 255.0).round() as u8);
        [r, g, b, 255]
    };
    let texels = (0..SIZE * SIZE).map(texel).collect();
    Texture::new(SIZE, SIZE, texels, Encoding::Linear, [Wrap::Repeat; 2])
}

/// The middle of a texel, in [0, 1]^2 from the top left.
fn middle(index: usize, size: usize) -> Vec2 {
    (Vec2::new((index % size) as f32, (index / size) as f32) + Vec2::splat(0.5)) / size as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_known_hues() {
        assert!((colour(0.0, 1.0, 1.0) - Vec3::X).length() < 1e-6);
        assert!((colour(1.0 / 3.0, 1.0, 0.5) - Vec3::Y * 0.5).length() < 1e-6);
        assert!((colour(0.7, 0.0, 0.3) - Vec3::splat(0.3)).length() < 1e-6);
    }

    #[test]
    fn normal_map_leans_away_from_the_rise() {
        // Rises along u, and with v: so the normal leans to -u and, green being against v, to +green.
        let texture = normal_map(|uv| 0.5 * uv.x + 0.25 * uv.y);
        let value = texture.sample(Vec2::splat(0.5)).truncate() * 2.0 - Vec3::ONE;
        assert!((value - Vec3::new(-0.5, 0.25, 1.0).normalize()).length() < 0.01, "{value}");
    }

    #[test]
    fn bricks_are_shifted_in_every_other_row() {
        let laid = Courses { columns: 4, rows: 2, shift: 0.5, width: 1.0 };
        assert!(laid.at(Vec2::new(0.25, 0.2)).1 < 1e-6);
        assert!(laid.at(Vec2::new(0.25, 0.7)).1 > 0.1);
    }

    #[test]
    fn diffuse_colours_are_those_of_real_things() {
        let mut builder = SceneBuilder::new(String::new());
        let mut random = Random::new(0, 1);
        let makers: [Maker; 6] = [paint, plaster, wood, stone, marble, earth];
        let ids: Vec<MaterialId> = makers.iter().map(|make| make(&mut builder, &mut random)).collect();
        let scene = builder.finish();
        for id in ids {
            let at = |i: u8| [Vec2::new(f32::from(i) * 0.137, f32::from(i) * 0.311), Vec2::ZERO];
            let surface = |i| scene.material(id).surface(&scene.textures, at(i), glam::Vec4::ONE).diffuse;
            let mean = (0..64).map(surface).sum::<Vec3>() / 64.0;
            assert!(mean.min_element() > 0.01 && mean.max_element() < 0.95, "{mean}");
        }
    }
}
