//! Scenes like those of Baran et al. 2010 (Figure 8): an indoor one with windows, one of trees, a landscape,
//! each in grey fog under a sun that is in the image or beside it.

use super::hall::hall;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::Frame;
use deepshade_render::methods::shafts::{IntegrationInputs, Lamp, ShadowMap, ViewRays};
use deepshade_render::scene::procedural::Family;
use deepshade_render::scene::{
    Bounds, Camera, Density, Encoding, Light, Material, Medium, Scene, Texture, Wrap,
};
use deepshade_shaders::Attribute;
use glam::{Vec2, Vec3};
use rayon::ThreadPool;
use std::sync::Arc;
use std::time::Instant;

/// How fine everything is.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Rows and columns.
    pub size: [usize; 2],
    /// In a slice.
    pub light_rays: usize,
    /// Texels along an edge of the shadow map.
    pub shadow_size: usize,
}

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A hall with windows.
    Indoor,
    /// A grove.
    Trees,
    /// A terrain.
    Landscape,
}

/// Where the sun is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// In the image.
    Sun,
    /// Beside it.
    Side,
}

/// Adds radiance to each view ray's.
pub type Way<'a> = dyn Fn(&IntegrationInputs<'_>, &mut [Vec3]) + Sync + 'a;

/// A scene as a camera sees it.
pub struct FogView {
    /// Scene and view.
    pub name: String,
    /// How fine it is.
    pub setup: Setup,
    scene: TracedScene,
    rays: ViewRays,
    map: ShadowMap,
}

/// How far fog reaches beyond the scene's box, as a share of the diagonal.
const MARGIN: f32 = 0.05;
/// Optical depth of the diagonal.
const DEPTH: f32 = 1.0;
/// Rounds of which the fastest counts.
const ROUNDS: usize = 3;
/// The sun is at least as high: the sine of the angle.
const LOWEST: f32 = 0.2;

impl Setup {
    /// Everything finer or coarser by a factor.
    pub fn scaled(self, factor: f64) -> Self {
        // Shadow maps are of whole tiles.
        let times = |count: usize| ((count as f64 * factor / 4.0).round() as usize).max(1) * 4;
        Self {
            size: self.size.map(times),
            light_rays: times(self.light_rays),
            shadow_size: times(self.shadow_size),
        }
    }
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Indoor, Self::Trees, Self::Landscape];

    const fn name(self) -> &'static str {
        match self {
            Self::Indoor => "indoor",
            Self::Trees => "trees",
            Self::Landscape => "landscape",
        }
    }

    /// The name in figures of its scene from a view.
    pub fn called(self, view: View) -> String {
        format!("{}_{}", self.name(), view.name())
    }

    fn scene(self) -> Scene {
        match self {
            Self::Indoor => hall(),
            Self::Trees => Family::Grove.scene(1),
            Self::Landscape => Family::Terrain.scene(1),
        }
    }

    /// From a side of the scene across it; in the hall along it, or towards the windows where the sun is to
    /// be seen.
    fn camera(self, view: View, Bounds { min, max }: Bounds) -> Camera {
        let at = |share: [f32; 3]| min + (max - min) * Vec3::from(share);
        let [eye, target] = match (self, view) {
            (Self::Indoor, View::Sun) => [[0.2, 0.3, 0.9], [0.5, 0.45, 0.0]],
            (Self::Indoor, View::Side) => [[0.06, 0.35, 0.8], [0.9, 0.4, 0.4]],
            (Self::Trees, _) => [[0.82, 0.35, 0.8], [0.5, 0.4, 0.5]],
            (Self::Landscape, _) => [[0.95, 0.8, 0.95], [0.5, 0.4, 0.5]],
        };
        Camera::look_at(at(eye), at(target))
    }
}

impl View {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Sun, Self::Side];

    const fn name(self) -> &'static str {
        match self {
            Self::Sun => "sun",
            Self::Side => "side",
        }
    }

    /// Unit direction to the sun.
    fn towards_sun(self, camera: &Camera, [height, width]: [usize; 2]) -> Vec3 {
        let [x, y] = match self {
            Self::Sun => [0.3, 0.1],
            Self::Side => [-0.7, -0.4],
        };
        let at = Vec2::new(x * width as f32, y * height as f32);
        let direction = camera.direction(at, height, width);
        Vec3::new(direction.x, direction.y.max(LOWEST), direction.z).normalize()
    }
}

/// A scene in fog under the sun, and where it is seen from.
///
/// # Errors
/// If there is no volume to fill.
pub fn setting(kind: Kind, view: View, size: [usize; 2]) -> Result<(Scene, Camera)> {
    let mut scene = kind.scene();
    let bounds = scene.bounds();
    let camera = kind.camera(view, bounds);
    scene.lights = vec![sun(view.towards_sun(&camera, size))];
    scene.medium = Some(Arc::new(fog(bounds)?));
    Ok((scene, camera))
}

impl FogView {
    /// One of the scenes.
    ///
    /// # Errors
    /// If it cannot be traced.
    pub fn new(kind: Kind, view: View, setup: Setup) -> Result<Self> {
        let (scene, camera) = setting(kind, view, setup.size)?;
        Self::of(kind.called(view), scene, &camera, setup)
    }

    /// A scene with a light and a medium.
    ///
    /// # Errors
    /// If it cannot be traced.
    pub fn of(name: String, scene: Scene, camera: &Camera, setup: Setup) -> Result<Self> {
        let scene = TracedScene::new(scene)?;
        let [height, width] = setup.size;
        let gbuffer = gbuffer::render(&scene, camera, height, width, &[Attribute::Depth, Attribute::Valid]);
        let rays = ViewRays::of(&Frame { scene: &scene, camera, gbuffer: &gbuffer, radius: 1.0, seed: 0 });
        let lamp = Lamp::new(scene.scene(), &scene.scene().lights[0]);
        // One, as in the paper.
        let map = ShadowMap::new(&scene, &lamp, &rays, [1, setup.shadow_size]);
        Ok(Self { name, setup, scene, rays, map })
    }

    /// The same with a change to its light, which may project a picture of many colours, texture 0.
    ///
    /// # Errors
    /// If it cannot be traced.
    pub fn with_light(&self, change: impl FnOnce(&mut Light)) -> Result<Self> {
        let mut look = self.scene.scene().look();
        look.textures.insert(0, Arc::new(stained_glass()));
        change(&mut look.lights[0]);
        // Materials' textures are not read here.
        look.materials.iter_mut().for_each(|material| *material = Material::default());
        let scene = self.scene.with_look(look)?;
        Ok(Self {
            name: self.name.clone(),
            setup: self.setup,
            scene,
            rays: self.rays.clone(),
            map: self.map.clone(),
        })
    }

    /// Calls a function with the scene's light.
    pub fn lit<T>(&self, function: impl FnOnce(&IntegrationInputs<'_>) -> T) -> T {
        let scene = self.scene.scene();
        let medium = scene.medium.as_deref().expect("the scene has fog");
        let lamp = Lamp::new(scene, &scene.lights[0]);
        function(&IntegrationInputs { rays: &self.rays, medium, lamp: &lamp, map: &self.map, seed: 1 })
    }

    /// Radiance by each of some methods, and the least of the seconds that its runs took in a pool of
    /// threads. They take turns, so that what else the machine does meets all of them; the first round does
    /// not count.
    pub fn timed<const N: usize>(&self, ways: [&Way<'_>; N], pool: &ThreadPool) -> [(Vec<Vec3>, f64); N] {
        let mut found = ways.map(|_| (vec![Vec3::ZERO; self.rays.count()], f64::INFINITY));
        self.lit(|lit| {
            for round in 0..=ROUNDS {
                for (way, (radiance, seconds)) in ways.iter().zip(&mut found) {
                    radiance.fill(Vec3::ZERO);
                    let start = Instant::now();
                    pool.install(|| way(lit, radiance));
                    let taken = start.elapsed().as_secs_f64();
                    *seconds = if round == 0 { f64::INFINITY } else { seconds.min(taken) };
                }
            }
        });
        found
    }

    /// Radiance by a method, and the seconds that its only run took in a pool of threads.
    pub fn once(&self, way: &Way<'_>, pool: &ThreadPool) -> (Vec<Vec3>, f64) {
        let mut radiance = vec![Vec3::ZERO; self.rays.count()];
        let start = Instant::now();
        self.lit(|lit| pool.install(|| way(lit, &mut radiance)));
        (radiance, start.elapsed().as_secs_f64())
    }
}

/// Squares of eight colours.
fn stained_glass() -> Texture {
    let colour = |i: usize| {
        let [x, y] = [i % 8, i / 8];
        let bit = |which: usize| if (x * 3 + y * 5) >> which & 1 == 1 { 255 } else { 40 };
        [bit(0), bit(1), bit(2), 255]
    };
    Texture::new(8, 8, (0..64).map(colour).collect(), Encoding::Linear, [Wrap::Repeat; 2])
}

/// White sunlight from a direction.
pub fn sun(towards: Vec3) -> Light {
    Light::Directional { direction: -towards, irradiance: Vec3::splat(10.0), pattern: None }
}

/// Grey fog around a box that scatters alike in all directions.
///
/// # Errors
/// If the box has no volume.
pub fn fog(Bounds { min, max }: Bounds) -> Result<Medium> {
    let diagonal = (max - min).length();
    let margin = Vec3::splat(MARGIN * diagonal);
    let around = Density::Within(Bounds { min: min - margin, max: max + margin });
    Ok(Medium::new(Vec3::ZERO, Vec3::splat(DEPTH / diagonal), 0.0, around)?)
}
