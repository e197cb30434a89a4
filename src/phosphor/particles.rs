//! `deepshade phosphor particles`: a scene file of particles whose paths are known.

use crate::figures::write_atomically;
use anyhow::{Result, ensure};
use deepshade_phosphor::particles::Tracks;
use std::path::PathBuf;

/// Makes a glTF file of particles that move, small octahedra that any scene can take in (`--put`).
///
/// Their paths are those of a table (CSV) with the columns `particle`, `time`, `x`, `y` and `z`, in seconds
/// and metres, as simulations write them; or of a fountain.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade phosphor particles simulated.csv --out spray.glb\n  \
    deepshade phosphor particles --fountain 400 --out fountain.glb\n  \
    deepshade render --animate --scene room:7 --put fountain.glb@0,0,0 --effect phosphor --white 0.05 --out frames")]
pub struct Args {
    /// The table of paths.
    #[arg(required_unless_present = "fountain", conflicts_with = "fountain")]
    tracks: Option<PathBuf>,
    /// A fountain of so many drops in its place.
    #[arg(long, value_name = "DROPS", value_parser = clap::value_parser!(u32).range(1..=MOST as i64))]
    fountain: Option<u32>,
    /// Chooses the fountain's drops.
    #[arg(long, default_value_t = 1, requires = "fountain")]
    seed: u32,
    /// How long the fountain lasts, seconds.
    #[arg(long, default_value_t = 4.0, requires = "fountain")]
    seconds: f32,
    /// Radius of a particle, metres.
    #[arg(long, default_value_t = 0.02)]
    radius: f32,
    /// Name of their material, for files that say what keeps light (`--phosphor`).
    #[arg(long, default_value = "particles", value_parser = crate::arguments::name)]
    material: String,
    /// The glTF file, binary (.glb).
    #[arg(long)]
    out: PathBuf,
}

/// Most particles of a file: joints have 16 bits.
const MOST: u32 = 65_535;
/// Most moments of all particles: 16 bytes each, of which 4 GB can be told.
const MOST_MOMENTS: usize = 50_000_000;

/// Writes the file.
///
/// # Errors
/// If the table cannot be read or says what makes no sense, or the file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    ensure!(args.radius.is_finite() && args.radius > 0.0, "--radius {} is not above 0", args.radius);
    let seconds = args.seconds;
    ensure!((0.1..=600.0).contains(&seconds), "--seconds {seconds} is not from 0.1 to 600");
    let ending = args.out.extension().is_some_and(|ending| ending == "glb");
    ensure!(ending, "--out {}: binary glTF files end in .glb", args.out.display());
    let moments = f64::from(args.fountain.unwrap_or(0)) * f64::from(seconds) * 60.0;
    ensure!(
        moments <= MOST_MOMENTS as f64,
        "a fountain of so many drops for so long is more than a file can have"
    );
    let tracks = match (&args.tracks, args.fountain) {
        (Some(path), _) => Tracks::read(path)?,
        (None, drops) => Tracks::fountain(drops.unwrap_or(1) as usize, seconds, args.seed),
    };
    let count = tracks.count();
    let moments = tracks.moments();
    ensure!(moments <= MOST_MOMENTS, "{moments} rows are more than the {MOST_MOMENTS} that a file can have");
    ensure!(count <= MOST as usize, "{count} particles are more than the {MOST} that a file can have");
    write_atomically(&args.out, &tracks.glb(args.radius, &args.material))?;
    say!("{}: {count} particles", args.out.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::paint::{Paint, PaintState};
    use deepshade_render::bvh::TracedScene;
    use deepshade_render::path::phosphor::Afterglow;
    use deepshade_render::scene::glow::{GlowSurface, Schedule, Start};
    use deepshade_render::scene::{AnimatedScene, Glow, Light, SceneSource};
    use glam::Vec3;

    const RADIUS: f32 = 0.05;

    /// The scene that `particles` makes of a table.
    fn animated(table: &str) -> AnimatedScene {
        let folder = tempfile::tempdir().expect("a folder");
        let [tracks, out] = ["tracks.csv", "spray.glb"].map(|name| folder.path().join(name));
        std::fs::write(&tracks, table).expect("written");
        let (radius, material) = (RADIUS, "dust".to_owned());
        let tracks = Some(tracks);
        run(&Args { tracks, fountain: None, seed: 1, seconds: 4.0, radius, material, out: out.clone() })
            .expect("a file");
        AnimatedScene::load(&SceneSource::File(out), 0.0).expect("a glTF file")
    }

    #[test]
    fn particles_are_where_the_table_has_them() {
        let animated = animated("particle,time,x,y,z\n7,1,2,0,0\n3,0,0,1,0\n7,0,0,0,0\n3,2,0,1,4\n");
        assert_eq!(animated.span(), Some([0.0, 2.0]));
        for (time, wanted) in [
            (0.0, [Vec3::Y, Vec3::ZERO]),
            (0.5, [Vec3::new(0.0, 1.0, 1.0), Vec3::X]),
            (9.0, [Vec3::new(0.0, 1.0, 4.0), 2.0 * Vec3::X]),
        ] {
            let scene = animated.at(time, 0.0).expect("a pose");
            let corners = &scene.meshes[0].positions;
            for (corners, wanted) in corners.chunks(corners.len() / 2).zip(wanted) {
                let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
                assert!(middle.distance(wanted) < 1e-5, "{middle} at {time}");
                assert!(corners.iter().all(|at| (at.distance(wanted) - RADIUS).abs() < 1e-5));
            }
            // Outside is outside: the volume of both octahedra is positive.
            let volume: f32 = (0..scene.meshes[0].triangles.len())
                .map(|triangle| scene.meshes[0].corners(triangle))
                .map(|[a, b, c]| a.cross(b).dot(c) / 6.0)
                .sum();
            assert!((volume / (2.0 * 4.0 / 3.0 * RADIUS.powi(3)) - 1.0).abs() < 0.02, "{volume}");
        }
    }

    /// Two particles, one of which goes through the light of a spot lamp and out of it again.
    #[test]
    fn a_particle_takes_along_the_light_that_it_met() {
        let mut animated = animated("particle,time,x,y,z\n1,0,-2,0,0\n1,4,2,0,0\n2,0,-2,0,1\n2,4,2,0,1\n");
        animated.scene.lights = vec![Light::Spot {
            position: Vec3::new(0.0, 2.0, 0.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::splat(20.0),
            range: f32::INFINITY,
            cos_inner: 0.995,
            cos_outer: 0.99,
            slide: None,
        }];
        let decay = 0.1;
        let state = PaintState { decay, excitation: 0.4 * Vec3::X, emission: Vec3::splat(decay) };
        let paint = Paint { name: "test".to_owned(), states: vec![state] };
        let schedule = Schedule { on: vec![[0.0, 9.0]], ..Schedule::default() };
        let (surfaces, schedules, start) =
            (vec![GlowSurface::new(None, paint)], vec![schedule], Start::Share(0.0));
        animated.scene.glow = Some(Glow { surfaces, medium: None, schedules, start, moment: 4.0 }.into());
        let pose = |time: f32| TracedScene::new(animated.at(time, 0.0).expect("a pose")).expect("particles");
        let times: Vec<f32> = (0..80).map(|step| 0.05 * step as f32).collect();
        let past = times.iter().map(|time| (*time, pose(time + 0.025))).collect();
        let now = pose(4.0).with_past(past).expect("the same triangles");
        let afterglow = Afterglow::new(&now);
        let faces = now.scene().meshes[0].triangles.len() / 2;
        let sent = |particle: usize| -> f32 {
            (0..faces).map(|face| afterglow.emission_at(0, particle * faces + face, [1.0 / 3.0; 3]).x).sum()
        };
        assert!(sent(0) > 0.01 && sent(1) == 0.0, "{} {}", sent(0), sent(1));
    }
}
