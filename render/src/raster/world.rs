//! A scene on the GPU, whoever looks at it: vertices as they are posed, materials, lights and their shadow
//! maps.

use super::attributes::Materials;
use super::geometry::Geometry;
use super::glow::GlowOnGpu;
use super::light::Lights;
use super::medium::MediumOnGpu;
use super::patches::{self, Emission, Patch, Reflectance};
use super::pose::Posing;
use super::shadow::{self, CameraView, MapPlan, ShadowPass};
use super::texture::Textures;
use crate::scene::glow::SKY_LAMPS;
use crate::scene::gltf::Rig;
use crate::scene::{AnimatedScene, Bounds, Camera, Glow, Light, Scene};
use deepshade_glow::paint::PaintFactors;
use deepshade_shaders::gpu::{Gpu, GpuError, Stamps};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::FrameView;
use std::sync::{Arc, OnceLock};

/// A scene on the GPU.
#[derive(Debug)]
pub struct World {
    /// The scene at one moment.
    scene: Scene,
    rigs: Vec<Rig>,
    /// All lamps as they are now, and those that stand for the environment.
    lights: Vec<Light>,
    /// The lights as they were given last, before animations move them.
    given: Vec<Light>,
    /// Which of them shine.
    on: Vec<bool>,
    /// The box around all that is seen of it at any moment.
    pub bounds: Bounds,
    /// Vertices as they are posed.
    pub geometry: Geometry,
    posing: Option<Posing>,
    pub(super) textures: Textures,
    /// Which material each mesh has.
    pub materials: Materials,
    /// What the lights send, and from where their maps look.
    pub gpu_lights: Lights,
    /// What fills it.
    pub medium: MediumOnGpu,
    /// What of it keeps light.
    pub glow: GlowOnGpu,
    map_plan: MapPlan,
    /// The lights' maps.
    pub shadows: ShadowPass,
    /// Whether the maps show what they did in the frame before.
    maps_stay: bool,
    map_views: Vec<FrameView>,
    seen: Option<CameraView>,
    /// By the reflectance that they know.
    patches: [OnceLock<Vec<Patch>>; 2],
    /// What the device cannot do as it was asked to, in words.
    pub notes: Vec<String>,
    /// What it was like before.
    past: Vec<([f32; 2], World)>,
}

impl World {
    /// Sends a scene to the GPU, with room for shadow maps of `shadow_size` texels to a side, smaller where
    /// there are many lights; without it there are none.
    ///
    /// # Errors
    /// If the device refuses or has no room; the buffer, texture or pass is named.
    pub fn new(gpu: &Gpu, animated: &AnimatedScene, shadow_size: Option<usize>) -> Result<Self, GpuError> {
        let AnimatedScene { scene, rigs } = animated;
        let device = &gpu.device;
        let textures = Textures::new(gpu, &scene.textures)?;
        let geometry = Geometry::new(device, animated)?;
        let posing = Posing::new(gpu, animated, &geometry)?;
        let of_sky = sky_lamps(scene);
        let lights = [&scene.lights[..], &of_sky].concat();
        let map_plan = match shadow_size {
            Some(size) => MapPlan::new(&lights, scene.lights.len(), size),
            None => MapPlan::without(&lights),
        };
        let gpu_lights = Lights::new(device, scene, &lights, &map_plan)?;
        let shadows = ShadowPass::new(device, &map_plan, &scene.materials, &textures)?;
        Ok(Self {
            scene: scene.clone(),
            rigs: rigs.clone(),
            lights,
            given: scene.lights.clone(),
            on: vec![true; scene.lights.len()],
            bounds: animated.reach(),
            notes: notes(&textures, shadow_size.map(|size| (&map_plan, size))),
            geometry,
            posing,
            textures,
            materials: Materials::new(device, scene)?,
            gpu_lights,
            medium: MediumOnGpu::new(gpu, scene)?,
            glow: GlowOnGpu::new(device, scene, of_sky.len())?,
            map_plan,
            shadows,
            maps_stay: false,
            map_views: Vec::new(),
            seen: None,
            patches: [const { OnceLock::new() }; 2],
            past: Vec::new(),
        })
    }

    /// The same, with what it was like before: worlds of the same triangles, each with the stretch of time
    /// for which it stands, from and up to how many seconds ago, the oldest first.
    #[must_use]
    pub fn with_past(self, past: Vec<([f32; 2], Self)>) -> Self {
        Self { past, ..self }
    }

    /// What it was like before, as [`Self::with_past`] says; nothing where it stays, and in a sequence, whose
    /// frames are the past.
    pub fn past(&self) -> &[([f32; 2], Self)] {
        &self.past
    }

    /// The worlds that a frame goes through: that of each stretch of the past, or this one alone.
    pub fn poses(&self) -> impl Iterator<Item = &Self> {
        let still = self.past().is_empty().then_some(self);
        self.past().iter().map(|(_, pose)| pose).chain(still)
    }

    /// Says what the next frame shows: the scene at `time` seconds, with the shutter open for `shutter`
    /// seconds around it, by a camera whose images are `aspect` times as wide as high.
    pub fn set(&mut self, queue: &wgpu::Queue, time: f32, shutter: f32, camera: &Camera, aspect: f32) {
        if let Some(posing) = &mut self.posing {
            posing.set(queue, &self.rigs, time, shutter);
        }
        self.glow.set(queue, time);
        let (lights, on) = (self.lights.clone(), self.scene.shining(time));
        self.rigs.iter().for_each(|rig| rig.light(&mut self.lights, time));
        if self.lights != lights || self.on != on {
            self.on = on;
            self.gpu_lights.set(queue, &self.lights, &self.on);
        }
        let seen = CameraView { camera: *camera, aspect, bounds: self.bounds };
        let views = self.map_plan.views(&self.lights, seen);
        let same = bytemuck::cast_slice::<_, u8>(&views) == bytemuck::cast_slice::<_, u8>(&self.map_views);
        self.maps_stay = same && self.posing.is_none();
        if !same {
            self.shadows.set(queue, &views);
            queue.write_buffer(&self.gpu_lights.map_views, 0, bytemuck::cast_slice(&views));
            self.map_views = views;
        }
        self.seen = Some(seen);
    }

    /// Moves, turns, dims or brightens the lights; those that an animation moves go on as it says. Light that
    /// surfaces keep is then as if they had always been so.
    ///
    /// # Panics
    /// If they are not as many, and of the same kinds: their maps are laid out.
    pub fn set_lights(&mut self, queue: &wgpu::Queue, lights: &[Light]) {
        let kinds = |lights: &[Light]| lights.iter().map(std::mem::discriminant).collect::<Vec<_>>();
        assert_eq!(kinds(lights), kinds(&self.given), "lights keep their kinds");
        if lights != self.given {
            self.given = lights.to_vec();
            self.lights[..lights.len()].copy_from_slice(lights);
            self.gpu_lights.set(queue, &self.lights, &self.on);
            self.glow.forget();
        }
    }

    /// Gives what keeps light other paints, as if it had always had these. Whether that can be without going
    /// to the GPU anew: as [`GlowOnGpu::repaint`], and in a sequence only.
    pub fn set_glow(&mut self, queue: &wgpu::Queue, glow: &Arc<Glow>) -> bool {
        let can = self.past.is_empty() && self.glow.repaint(queue, glow);
        if can {
            self.scene.glow = Some(Arc::clone(glow));
        }
        can
    }

    /// Its lamps with their maps, and those that stand for the environment, as passes bind them one after the
    /// other.
    pub fn lamps<'a>(&'a self, sampler: &'a wgpu::Sampler) -> [wgpu::BindingResource<'a>; 5] {
        let Lights { records, map_views, pictures, .. } = &self.gpu_lights;
        [
            records.as_entire_binding(),
            map_views.as_entire_binding(),
            pictures.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.shadows.maps),
            wgpu::BindingResource::Sampler(sampler),
        ]
    }

    /// Of a pass that reads light that surfaces keep, in a clear scene and in one whose medium dims the
    /// lamps', the one that this scene wants, with its constants.
    pub fn dimmed(&self, [clear, dimmed]: [Shader; 2]) -> (Shader, Vec<(&'static str, u32)>) {
        let mut constants =
            [&self.glow.constants()[..], &[("LIGHTS", self.gpu_lights.charging as u32)]].concat();
        if self.scene.medium.is_none() {
            return (clear, constants);
        }
        constants.push(("MEDIUM", self.medium.kind));
        (dimmed, constants)
    }

    /// The medium as such passes bind it, where there is one.
    pub fn dimming(&self) -> Vec<wgpu::BindingResource<'_>> {
        if self.scene.medium.is_none() {
            return Vec::new();
        }
        let MediumOnGpu { record, densities, .. } = &self.medium;
        vec![record.as_entire_binding(), wgpu::BindingResource::TextureView(densities)]
    }

    /// The scene at one moment; what moves lies elsewhere at others.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The same with what moves.
    pub fn animated(&self) -> AnimatedScene {
        AnimatedScene { scene: self.scene.clone(), rigs: self.rigs.clone() }
    }

    /// The parts of its surface that surfels are laid out on; made when they are asked for first.
    pub fn patches(&self, reflectance: Reflectance) -> &[Patch] {
        let made = &self.patches[reflectance as usize];
        made.get_or_init(|| patches::patches(&self.scene, &self.geometry.draws, reflectance))
    }

    /// Radiance that each of them emits; none where nothing emits.
    pub fn emissions(&self) -> Vec<Emission> {
        patches::emissions(&self.scene, &self.geometry.draws)
    }

    /// The paint of each of them, as its glow counts them, and what its middle has of it.
    pub fn patch_paints(&self) -> Vec<(Option<usize>, Option<PaintFactors>)> {
        patches::paints(&self.scene, &self.geometry.draws)
    }

    /// Its surface in about so many parts, beside triangles that are smaller than one.
    pub fn cut(&self, parts: f32) -> Vec<Patch> {
        patches::cut(&self.scene, &self.geometry.draws, parts)
    }

    /// Records the pass that moves vertices, where any move.
    pub fn encode_pose(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.posing.iter().for_each(|posing| posing.encode(pass));
    }

    /// How many shadow maps there are to draw: those that show what they already do are kept.
    pub fn maps_to_draw(&self) -> usize {
        if self.maps_stay { 0 } else { self.map_plan.maps }
    }

    /// Records the passes that draw them.
    pub fn encode_shadows(&self, encoder: &mut wgpu::CommandEncoder, stamps: Option<&Stamps<'_>>) {
        let maps = self.maps_to_draw();
        for map in 0..maps {
            let stamps = stamps.and_then(|stamps| stamps.of_one_raster(map == 0, map + 1 == maps));
            self.shadows.encode(encoder, &self.geometry, map, stamps);
        }
    }

    /// From where the maps of one of the scene's lights look in this frame, `size` texels wide each; none
    /// before a frame is set.
    pub fn light_views(&self, light: usize, size: usize) -> Vec<FrameView> {
        self.seen.iter().flat_map(|seen| shadow::views(&self.lights[light], size, *seen)).collect()
    }
}

/// The lamps that stand for the environment of a scene that keeps its light.
fn sky_lamps(scene: &Scene) -> Vec<Light> {
    let environment = scene.environment.as_deref().filter(|_| Glow::of(scene).schedule_of_sky().is_some());
    environment.map_or_else(Vec::new, |environment| environment.lamps(SKY_LAMPS))
}

/// What the device does in another way than asked; of shadows where any are asked for, with maps of which
/// size.
fn notes(textures: &Textures, shadows: Option<(&MapPlan, usize)>) -> Vec<String> {
    let mut notes = Vec::new();
    if !textures.reduced.is_empty() {
        notes.push(format!(
            "{} textures are larger than the device allows and were halved",
            textures.reduced.len()
        ));
    }
    let Some((plan, shadow_size)) = shadows else { return notes };
    if plan.maps > 0 && plan.size < shadow_size {
        notes.push(format!(
            "shadow maps have {} texels to a side, since there are {} of them",
            plan.size, plan.maps
        ));
    }
    match plan.without_shadow() {
        0 => {}
        faint => notes
            .push(format!("{faint} of the fainter lights cast no shadow: there is no room for their maps")),
    }
    notes
}
