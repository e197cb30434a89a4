use super::*;
use deepshade_shaders::Planes;

const SIZE: [usize; 2] = [20, 30];
const ATTRIBUTES: [Attribute; 4] =
    [Attribute::Position, Attribute::Depth, Attribute::Normal, Attribute::Valid];

/// A rough ground below a sky of four rows, which is `sky` of position and depth.
fn gbuffer(sky: impl Fn([f32; 3]) -> [f32; 4]) -> GBuffer {
    let value = |c: usize, y: usize, x: usize| {
        let direction = [(x as f32 - 14.5) / 20.0, (9.5 - y as f32) / 20.0, -1.0];
        let depth = 2.0 + ((7 * x + 3 * y) % 5) as f32;
        let ground = [depth * direction[0], depth * direction[1], -depth, depth];
        match c {
            0..4 => {
                if y < 4 {
                    sky(direction)[c]
                } else {
                    ground[c]
                }
            }
            _ => [0.0, 0.0, 1.0, 1.0][c - 4],
        }
    };
    GBuffer::new(ATTRIBUTES.to_vec(), Planes::from_fn(8, SIZE[0], SIZE[1], value))
}

/// The rows of which something is seen, and what was taken for the sky.
fn left(gbuffer: GBuffer) -> (Vec<bool>, Vec<Sky>) {
    let (gbuffer, skies) = without_sky(gbuffer, Some(-1.0)).expect("validity");
    let seen = gbuffer.seen().expect("validity");
    (seen.chunks(SIZE[1]).map(|row| row.iter().all(|seen| *seen)).collect(), skies)
}

#[test]
fn a_number_far_beyond_all_else_is_the_sky() {
    let ground: Vec<bool> = (0..SIZE[0]).map(|y| y >= 4).collect();
    for far in [1e3, 1e5, 1e6, 1e8] {
        let plane = gbuffer(|[x, y, _]| [far * x, far * y, -far, 3.0]);
        let (rows, skies) = left(plane);
        assert_eq!(rows, ground, "{far}");
        assert_eq!(skies, [Sky { layer: "`position.Z`", value: -far, share: 0.2 }]);
        let (rows, skies) = left(gbuffer(|[x, y, _]| [3.0 * x, 3.0 * y, -3.0, far]));
        assert_eq!(
            (rows, &skies[..]),
            (ground.clone(), &[Sky { layer: "`depth`", value: far, share: 0.2 }][..])
        );
        let sphere = gbuffer(|d| {
            let at = far * Vec3::from_array(d).normalize();
            [at.x, at.y, at.z, 3.0]
        });
        assert_eq!(left(sphere).0, ground, "{far}");
    }
}

#[test]
fn one_number_that_is_not_before_the_camera_is_the_sky() {
    let ground: Vec<bool> = (0..SIZE[0]).map(|y| y >= 4).collect();
    let (rows, skies) = left(gbuffer(|[x, y, _]| [3.0 * x, 3.0 * y, -3.0, -1.0]));
    assert_eq!((rows, skies[0].layer, skies[0].value), (ground.clone(), "`depth`", -1.0));
    assert_eq!(skies[0].to_string(), "no surface is taken to be seen where `depth` is -1, 20 % of the image");
    let (rows, skies) = left(gbuffer(|_| [1.0, 1.0, 1.0, 3.0]));
    assert_eq!((rows, skies[0].layer, skies[0].value), (ground, "`position.Z`", 1.0));
}

#[test]
fn hills_and_what_has_no_one_number_are_surfaces() {
    let all = vec![true; SIZE[0]];
    // Sixty times as far, of one number; a thousand times, of many; behind the camera, of many.
    let near = gbuffer(|[x, y, _]| [360.0 * x, 360.0 * y, -360.0, 360.0]);
    assert_eq!(left(near), (all.clone(), Vec::new()));
    let hills = gbuffer(|[x, y, _]| {
        let depth = 6000.0 + 900.0 * x;
        [depth * x, depth * y, -depth, depth]
    });
    assert_eq!(left(hills), (all.clone(), Vec::new()));
    assert_eq!(left(gbuffer(|[x, y, _]| [x, y, 2.0 + x, 3.0])), (all, Vec::new()));
}

#[test]
fn normals_of_no_length_show_nothing_if_they_are_read() {
    let mut planes = gbuffer(|_| [0.0, 0.0, -3.0, 3.0]).planes().clone();
    (4..7).for_each(|c| planes.plane_mut(c)[..7].fill(0.0));
    let gbuffer = GBuffer::new(ATTRIBUTES.to_vec(), planes);
    let count = |read: &[Attribute]| {
        let left = without_normals_of_no_length(gbuffer.clone(), read).expect("validity");
        left.seen().expect("validity").iter().filter(|seen| !**seen).count()
    };
    assert_eq!(count(&[Attribute::Normal]), 7);
    assert_eq!(count(&[Attribute::Depth]), 0);
}
