//! Claims of Baran et al. 2010 that need no march at equal error: what colour costs, the decay of singular
//! values, slices that are saved, the narrow beam.

use super::subject::{FogView, Kind, Setup, View, Way, fog, sun};
use super::table_number;
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::methods::epipolar::{self, Rectified, Slices};
use deepshade_render::methods::shafts::Integration;
use deepshade_render::methods::{Quality, epipolar_sampling, ray_march};
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_render::scene::{Bounds, Camera, Light, Material, Mesh, Scene, TextureId};
use deepshade_shaders::{Effect, Planes};
use glam::{DVec2, Vec3};
use rayon::ThreadPool;
use std::sync::Arc;

/// What was found, what the paper says, and the figure's name.
type Claim = (&'static str, f64, &'static str);

/// All of them.
pub struct Claims(Vec<Claim>);

impl Claims {
    /// Measures in a pool of one thread.
    ///
    /// # Errors
    /// If a scene cannot be traced.
    pub fn of(setup: Setup, pool: &ThreadPool) -> Result<Self> {
        let trees = epipolar::EpipolarParameters {
            light_rays: setup.light_rays,
            ..epipolar::EpipolarParameters::of(Quality::High)
        };
        let plain = FogView::new(Kind::Indoor, View::Side, setup)?;
        let coloured = plain.with_light(|light| {
            let Light::Directional { pattern, .. } = light else { return };
            *pattern = Some((TextureId(0), 1.0));
        })?;
        let seconds = |subject: &FogView| {
            let [(_, seconds)] = subject.timed([&|lit, radiance| trees.add(lit, radiance)], pool);
            seconds
        };
        let textured = seconds(&coloured) / seconds(&plain);
        let mut largest: f64 = 0.0;
        for kind in Kind::ALL {
            for view in View::ALL {
                largest = largest
                    .max(sigma_ratio(&FogView::new(kind, view, setup.scaled(0.25))?, trees.light_rays));
            }
        }
        let [tree, every, sampling] = beam(setup, pool)?;
        let [height, width] = setup.size;
        Ok(Self(vec![
            ("ratio_textured", textured, "1.5"),
            ("sigma_ratio", largest, "at most 0.025"),
            ("slices_saved_centre", saved(setup, [0.5 * width as f64, 0.5 * height as f64]), "0.15"),
            ("slices_saved_corner", saved(setup, [0.03 * width as f64, 0.03 * height as f64]), "0.5"),
            ("relmse_beam_tree", tree, "the beam is seen"),
            ("relmse_beam_every_pixel", every, ""),
            ("relmse_beam_sampling", sampling, "the beam is blurred"),
        ]))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        self.0.iter().for_each(|(name, value, _)| figures.set(name, *value));
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["claim", "found", "paper"].map(str::to_owned).to_vec()];
        let row = |(name, value, paper): &Claim| {
            vec![(*name).to_owned(), table_number(*value), (*paper).to_owned()]
        };
        rows.extend(self.0.iter().map(row));
        rows
    }
}

/// The fourth singular value over the first.
fn sigma_ratio(subject: &FogView, light_rays: usize) -> f64 {
    subject.lit(|lit| {
        let rectified = Rectified::new(lit, light_rays, 16.0, epipolar::Terms::Four.most_magnified());
        rectified.map_or(0.0, |rectified| rectified.factors::<4, 1>().values[3])
    })
}

/// Share of the slices with one pixel between them along the edges that is saved, for an epipole in pixels.
fn saved(setup: Setup, [x, y]: [f64; 2]) -> f64 {
    let slices = Slices::new(DVec2::new(x, y), setup.size[0], setup.size[1]);
    1.0 - slices.count() as f64 / slices.count_by_perimeter() as f64
}

/// A narrow beam of sunlight before a wall without a jump of depth (Figure 13): errors of trees, of marching
/// every pixel, and of epipolar sampling with the same steps, under one exposure.
fn beam(setup: Setup, pool: &ThreadPool) -> Result<[f64; 3]> {
    let quad = |corners: [[f32; 3]; 4]| Mesh {
        positions: corners.map(Vec3::from).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let roof = |x: [f32; 2]| quad([[x[0], 4., -5.], [x[0], 4., 5.], [x[1], 4., 5.], [x[1], 4., -5.]]);
    let wall = quad([[-5., -5., -2.], [5., -5., -2.], [5., 5., -2.], [-5., 5., -2.]]);
    let bounds = Bounds { min: Vec3::splat(-5.0), max: Vec3::splat(5.0) };
    let scene = Scene {
        meshes: vec![wall, roof([-5.0, 0.0]), roof([0.08, 5.0])].into(),
        materials: vec![Material::default()],
        lights: vec![sun(Vec3::new(-0.9, 1.0, 0.1).normalize())],
        medium: Some(Arc::new(fog(bounds)?)),
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::new(2.0, 1.0, 4.0), Vec3::new(2.0, 1.0, 0.0));
    let subject = FogView::of("beam".to_owned(), scene, &camera, setup.scaled(0.5))?;
    let [height, width] = subject.setup.size;
    let steps = 4096;
    let image = |way: &Way<'_>| {
        let (radiance, _) = subject.once(way, pool);
        Planes::from_fn(1, height, width, |_, y, x| radiance[y * width + x].x)
    };
    let usual = ray_march::RayMarchParameters::of(Quality::High);
    let long = ray_march::RayMarchParameters { steps, jitter: false, ..usual };
    let truth = image(&|lit, radiance| long.add(lit, radiance));
    let exposure = exposure(Effect::FogDirect, &truth);
    let error = |way: &Way<'_>| relative_mse(&exposed(&image(way), exposure), &exposed(&truth, exposure));
    let trees = epipolar::EpipolarParameters {
        light_rays: setup.light_rays,
        ..epipolar::EpipolarParameters::of(Quality::High)
    };
    let [every, few] = [1, 16].map(|spacing| {
        let usual = epipolar_sampling::EpipolarSamplingParameters::of(Quality::High);
        epipolar_sampling::EpipolarSamplingParameters { spacing, steps, ..usual }
    });
    Ok([
        error(&|lit, radiance| trees.add(lit, radiance)),
        error(&|lit, radiance| every.add(lit, radiance)),
        error(&|lit, radiance| few.add(lit, radiance)),
    ])
}
