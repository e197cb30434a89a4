//! What the window shows: a scene with all that an effect needs of it, for the GPU and for rays.

use super::Args;
use crate::learned;
use crate::live::animated_view::{self, ViewRequest};
use crate::live::camera_controller::CameraController;
use crate::location::Location;
use crate::radius::Space;
use crate::views::Viewpoint;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::past;
use deepshade_render::scene::{AnimatedScene, Glow, Light, Scene, SceneSource};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use glam::Vec3;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene with all that an effect needs of it.
pub struct PreparedScene {
    /// Where it is from.
    pub source: SceneSource,
    /// The effect it was completed for.
    pub effect: Effect,
    /// The scene.
    pub animated: AnimatedScene,
    /// From where it is seen first.
    pub controller: CameraController,
    /// What was added to the scene, a sentence each.
    pub added: Vec<String>,
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    /// What a default radius depends on.
    pub space: Space,
    /// Which of its lights animations move.
    rigged: Vec<bool>,
    /// How long the shutter is open, seconds; 0 for effects that do not show it.
    shutter: f32,
    /// What keeps light as the scene has it.
    own_glow: Option<Arc<Glow>>,
    /// And as it was designed instead.
    pub designed: Option<Arc<Glow>>,
    /// The scene for rays, at the moment that was asked for last.
    traced: Mutex<Option<(f32, Arc<TracedScene>)>>,
}

impl PreparedScene {
    /// Reads a scene and completes it.
    ///
    /// # Errors
    /// If it cannot be read, or there is no such camera or view.
    pub fn load(args: &Args, source: &SceneSource, effect: Effect) -> Result<Self> {
        // Another scene than the one of the command line has other cameras.
        let elsewhere = Viewpoint::default();
        let viewpoint = if *source == args.scene { &args.viewpoint } else { &elsewhere };
        let stated = match &args.model {
            Some(Location::Folder(folder)) => learned::environment(folder, effect),
            _ => None,
        };
        let learned = stated.or_else(|| learned::environment(&learned::usual_folder(effect), effect));
        let request = ViewRequest {
            source,
            time: args.time,
            effects: &[effect],
            size: [args.height, args.width],
            props: &args.props,
            viewpoint,
            additions: &args.additions.heard_by(effect),
            seed: args.seed,
            learned: learned.as_ref(),
        };
        let animated_view = animated_view::Args::default().open(&request)?;
        let space = animated_view.space();
        Ok(Self {
            source: source.clone(),
            effect,
            controller: CameraController::new(animated_view.camera, animated_view.distance()),
            added: animated_view.added,
            diagonal: animated_view.diagonal,
            space,
            rigged: rigged(&animated_view.animated),
            own_glow: animated_view.animated.scene.glow.clone(),
            designed: None,
            animated: animated_view.animated,
            shutter: if effect.listens_to(EffectSetting::Shutter) { args.shutter() } else { 0.0 },
            traced: Mutex::new(None),
        })
    }

    /// The same where other paints keep light, if any does: designed ones, or without these the scene's own.
    pub fn with_glow(self: Arc<Self>, designed: Option<&Arc<Glow>>) -> Arc<Self> {
        if self.designed.as_ref() == designed {
            return self;
        }
        let glow = self.own_glow.as_ref().map(|own| Arc::clone(designed.unwrap_or(own)));
        let animated = &self.animated;
        let scene = Scene { glow, ..animated.scene.clone() };
        Arc::new(Self {
            animated: AnimatedScene { scene, rigs: animated.rigs.clone() },
            source: self.source.clone(),
            effect: self.effect,
            controller: self.controller,
            added: self.added.clone(),
            diagonal: self.diagonal,
            space: self.space,
            rigged: self.rigged.clone(),
            shutter: self.shutter,
            own_glow: self.own_glow.clone(),
            designed: designed.cloned(),
            traced: Mutex::default(),
        })
    }

    /// The lights that the user has left, where they are this scene's: as many, and of the same kinds. Else
    /// its own.
    pub fn lights(&self, chosen: Option<&[Light]>) -> Vec<Light> {
        let own = &self.animated.scene.lights;
        chosen.filter(|chosen| fit(chosen, own)).unwrap_or(own).to_vec()
    }

    /// The lights that the user has left, where they have moved some: those that nobody has moved are where a
    /// file has them.
    pub fn moved(&self, chosen: Option<Vec<Light>>) -> Option<Vec<Light>> {
        chosen.filter(|chosen| *chosen != self.animated.scene.lights)
    }

    /// Whether an animation moves one of its lights, so that the user cannot.
    pub fn is_rigged(&self, light: usize) -> bool {
        self.rigged.get(light) == Some(&true)
    }

    /// From when to when time goes on by itself, seconds: as long as something moves, without an end where
    /// surfaces keep light.
    pub fn timeline(&self) -> Option<[f32; 2]> {
        let moves = self.animated.span().filter(|[begin, end]| end > begin);
        let Some(glow) = &self.animated.scene.glow else { return moves };
        let begin = moves.map_or(f32::INFINITY, |[begin, _]| begin).min(glow.begin());
        Some([begin, f32::INFINITY])
    }

    /// The scene at a moment, seconds, under these lights, but for those that animations move, ready for
    /// rays; with what it was like before where surfaces keep light and something moves.
    ///
    /// # Errors
    /// If there is no such moment.
    pub fn traced(&self, time: f32, lights: &[Light]) -> Result<Arc<TracedScene>> {
        let traced = self.at(time)?;
        let mut now = lights.to_vec();
        self.animated.light(&mut now, time);
        if traced.scene().lights == now {
            return Ok(traced);
        }
        Ok(Arc::new(past::lit(&self.animated, &traced, lights, time)?))
    }

    fn at(&self, time: f32) -> Result<Arc<TracedScene>> {
        let mut kept = self.traced.lock().unwrap_or_else(PoisonError::into_inner);
        let glow = self.animated.scene.glow.as_deref();
        let stays = self.animated.span().is_none() && glow.is_none();
        if let Some((moment, traced)) = kept.as_ref()
            && (*moment == time || stays)
        {
            return Ok(Arc::clone(traced));
        }
        let traced = Arc::new(match glow {
            Some(glow) => {
                let glow = Glow { moment: time, ..glow.clone() };
                let now = Scene { glow: Some(Arc::new(glow)), ..self.animated.scene.clone() };
                past::of_animation(&self.animated, &now)?
            }
            None => TracedScene::new(self.animated.at(time, self.shutter)?)?,
        });
        *kept = Some((time, Arc::clone(&traced)));
        Ok(traced)
    }
}

/// Whether lights are as many, and of the same kinds.
fn fit(some: &[Light], others: &[Light]) -> bool {
    let kinds = |lights: &[Light]| lights.iter().map(std::mem::discriminant).collect::<Vec<_>>();
    kinds(some) == kinds(others)
}

/// Which lights animations move: those that they bring back from elsewhere.
fn rigged(animated: &AnimatedScene) -> Vec<bool> {
    let away = |light: &Light| light.moved(|place| place + Vec3::ONE, |direction| -direction);
    let elsewhere: Vec<Light> = animated.scene.lights.iter().map(away).collect();
    let mut back = elsewhere.clone();
    let begin = animated.span().map_or(0.0, |[begin, _]| begin);
    animated.light(&mut back, begin);
    back.iter().zip(&elsewhere).map(|(back, elsewhere)| back != elsewhere).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::tests::args;

    #[test]
    fn lights_fit_where_they_are_as_many_and_of_the_same_kinds() {
        let point = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        let dim = point.brighter(0.5);
        assert!(fit(&[point, sun], &[dim, sun]));
        assert!(!fit(&[point], &[point, sun]) && !fit(&[sun], &[point]));
    }

    #[test]
    fn what_one_effect_listens_to_does_not_keep_others_from_being_shown() {
        let options = "--effect fog-direct --extinction 0.2 --aperture 0.01 --mean-free-path 0.01";
        let args = args(&format!("--scene still-life:1 --height 16 --width 16 {options}"));
        let source = "still-life:1".parse().expect("a scene");
        for effect in [Effect::FogDirect, Effect::Ao, Effect::Sss, Effect::Dof] {
            let subject = PreparedScene::load(&args, &source, effect).expect("a scene");
            let scene = &subject.animated.scene;
            assert_eq!(scene.medium.is_some(), effect == Effect::FogDirect, "{effect}");
            let looks_through = matches!(effect, Effect::FogDirect | Effect::Dof);
            let lens = subject.controller.camera.lens.map(|lens| lens.radius);
            assert_eq!(lens, looks_through.then_some(0.01), "{effect}");
        }
    }

    #[test]
    fn lights_that_nobody_has_moved_are_the_files() {
        let args = args("--scene still-life:1 --height 16 --width 16 --effect gi");
        let subject = PreparedScene::load(&args, &args.scene, Effect::Gi).expect("a scene");
        let own = subject.lights(None);
        let bright: Vec<Light> = own.iter().map(|light| light.brighter(2.0)).collect();
        assert_eq!((subject.moved(None), subject.moved(Some(own))), (None, None));
        assert_eq!(subject.moved(Some(bright.clone())), Some(bright));
    }

    /// A lamp that goes from (0, 2, 0) to (3, 2, 0) within a second, above a triangle that stays.
    const LAMP: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
            "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}},
            "scenes":[{"nodes":[0,1]}],
            "nodes":[{"mesh":0},{"translation":[0,2,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":1,"output":2}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]},
                {"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
                {"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}],
            "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},
                {"buffer":0,"byteOffset":44,"byteLength":24}],
            "buffers":[{"byteLength":68,"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAIC/AACAPwAAAAAAAIC/AAAAAAAAAAAAAIA/AAAAAAAAgD8AAAAAAAAAQAAAAAAAAEBAAAAAQAAAAAA="}]}"#;

    #[test]
    fn rays_see_animated_lights_at_every_moment_without_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("lamp.gltf");
        std::fs::write(&file, LAMP).expect("written");
        let source = SceneSource::File(file.clone());
        let args = args(&format!("--scene {} --effect gi --eye 0,4,3 --look-at 0,0,0", file.display()));
        let subject = PreparedScene::load(&args, &source, Effect::Gi).expect("a scene");
        std::fs::remove_file(&file).expect("deleted");
        assert!(subject.is_rigged(0) && subject.timeline() == Some([0.0, 1.0]));
        let bright: Vec<Light> = subject.lights(None).iter().map(|light| light.brighter(2.0)).collect();
        for (time, x) in [(0.0, 0.0), (0.5, 1.5), (1.0, 3.0)] {
            let traced = subject.traced(time, &bright).expect("a moment");
            let light = traced.scene().lights[0];
            let place = light.position().expect("a point");
            assert!(place.distance(Vec3::new(x, 2.0, 0.0)) < 1e-5, "{time}: {place}");
            assert_eq!(
                light,
                bright[0].moved(|_| place, |direction| direction),
                "as bright as the user has it"
            );
        }
    }

    #[test]
    fn designed_paints_replace_the_scene_s_own_and_give_way_to_them() {
        let args = args("--scene still-life:1 --effect phosphor --height 16 --width 16");
        let load = |effect| Arc::new(PreparedScene::load(&args, &args.scene, effect).expect("a scene"));
        let subject = load(Effect::Phosphor);
        let own = subject.animated.scene.glow.clone().expect("all glows");
        let designed = Arc::new(Glow { surfaces: Vec::new(), ..Glow::clone(&own) });
        let glow = |subject: &PreparedScene| subject.animated.scene.glow.clone();
        let other = Arc::clone(&subject).with_glow(Some(&designed));
        assert!([glow(&other), other.designed.clone()].iter().all(|glow| glow.as_ref() == Some(&designed)));
        let seen = other.traced(1.0, &other.lights(None)).expect("a moment");
        assert!(Glow::of(seen.scene()).surfaces.is_empty(), "rays see it, too");
        assert_eq!(glow(&other.with_glow(None)), Some(own));
        assert!(Arc::ptr_eq(&Arc::clone(&subject).with_glow(None), &subject));
        assert_eq!(glow(&load(Effect::Ao).with_glow(Some(&designed))), None, "nothing glows there");
    }

    /// The lamp goes on for a second and shines from second 0 on: poses of the past have it, as bright as the
    /// user has it, where it was.
    #[test]
    fn rays_see_what_was_before_where_surfaces_keep_light() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, glow) = (folder.path().join("lamp.gltf"), folder.path().join("glow.toml"));
        std::fs::write(&file, LAMP).expect("written");
        std::fs::write(&glow, "[[surface]]\npaint = 'orange'\n").expect("written");
        let source = SceneSource::File(file.clone());
        let arguments = "--effect phosphor --eye 0,4,3 --look-at 0,0,0 --phosphor";
        let args = args(&format!("--scene {} {arguments} {}", file.display(), glow.display()));
        let subject = PreparedScene::load(&args, &source, Effect::Phosphor).expect("a scene");
        assert!(subject.timeline().is_some_and(|[begin, end]| begin.is_finite() && end.is_infinite()));
        let bright: Vec<Light> = subject.lights(None).iter().map(|light| light.brighter(2.0)).collect();
        let traced = subject.traced(2.0, &bright).expect("a moment");
        let places = traced.past().iter().map(|(from, pose)| {
            let light = pose.scene().lights[0];
            let place = light.position().expect("a point");
            assert_eq!(light, bright[0].moved(|_| place, |direction| direction));
            (*from, place.x)
        });
        let places: Vec<(f32, f32)> = places.collect();
        assert!(places.len() > 8 && places[0].1 < 0.3, "{places:?}");
        for (index, (from, x)) in places.iter().enumerate() {
            let until = places.get(index + 1).map_or(2.0, |(next, _)| *next);
            let within = (3.0 * from.min(1.0), 3.0 * until.min(1.0));
            assert!(within.0 <= x + 1e-4 && x - 1e-4 <= within.1, "{x} m from second {from} to {until}");
        }
        let still = PreparedScene::load(&args, &"still-life:1".parse().expect("a scene"), Effect::Phosphor);
        let traced = still.expect("a scene").traced(2.0, &bright[..0]);
        assert!(traced.expect("a moment").past().is_empty(), "nothing moves");
    }
}
