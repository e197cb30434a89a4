//! What the user has chosen stays chosen.

use super::*;
#[cfg(feature = "train")]
use crate::view::method_worker::Trained;
use crate::view::tests::args;

#[test]
fn a_network_stays_that_of_its_effect() {
    let model = |state: &State| state.show.model.as_deref().map(Path::to_owned);
    // It is not there yet.
    let mut state = State::new(&args("--effect gi --model runs/none")).expect("methods");
    let run = Some(PathBuf::from("runs/none"));
    assert_eq!(model(&state), run);
    state.choose_effect(Effect::Ao);
    assert_eq!(model(&state), None);
    state.choose_effect(Effect::Gi);
    assert_eq!(model(&state), run);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao");
    let opened = state.show.models_opened;
    state.open_model(&shipped).expect("a network");
    assert_eq!((state.show.effect, model(&state)), (Effect::Ao, Some(shipped.clone())));
    assert!(state.show.methods.contains(&LEARNED));
    // As its files are now, which may be other ones.
    let before = state.show.clone();
    state.open_model(&shipped).expect("a network");
    assert!(before != state.show && state.show.models_opened == opened + 2);
    state.choose_effect(Effect::Gi);
    assert_eq!(model(&state), run);
    state.choose_effect(Effect::Ao);
    assert_eq!(model(&state), Some(shipped));
}

#[test]
fn a_stated_radius_and_stated_methods_survive_a_change_of_effect() {
    let seen = |state: &State| (state.show.methods.clone(), state.show.radius);
    let mut state = State::new(&args("--effect ao --methods hbao,surfel --radius 0.5")).expect("methods");
    state.choose_effect(Effect::Gi);
    assert_eq!(seen(&state), (vec!["surfel"], Some(0.5)));
    state.choose_effect(Effect::Aa);
    assert_eq!(state.show.radius, None, "it has none");
    assert!(!state.show.methods.is_empty(), "its first ones");
    state.set_radius(Some(2.0));
    state.choose_effect(Effect::Ao);
    assert_eq!(seen(&state), (vec!["hbao", "surfel"], Some(2.0)));
    state.toggle("hbao");
    state.set_radius(None);
    state.choose_effect(Effect::Gi);
    state.choose_effect(Effect::Ao);
    assert_eq!(seen(&state), (vec!["surfel"], None));
    // A network that the user opens is seen beside them.
    state.open_model(&Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao")).expect("a network");
    assert_eq!(state.show.methods, [LEARNED, "surfel"]);
    // What nobody has stated does not stay.
    let mut free = State::new(&args("--effect ao")).expect("methods");
    free.choose_effect(Effect::Gi);
    assert_ne!(free.show.methods, ["surfel"]);
}

#[test]
fn a_scene_that_is_opened_again_is_read_anew_and_seen_from_the_same_place() {
    let mut state = State::new(&args("--scene room:7")).expect("methods");
    let camera = deepshade_render::scene::Camera::look_at(glam::Vec3::ONE, glam::Vec3::ZERO);
    state.controller = Some(CameraController::new(camera, 1.0));
    state.time = 2.0;
    let (controller, before) = (state.controller, state.show.clone());
    state.open("room:7".parse().expect("a scene"), true);
    assert!(state.show != before && (state.controller, state.time) == (controller, 2.0));
    assert!(!state.go_back(), "there is none before it");
    state.open("room:8".parse().expect("a scene"), true);
    assert_eq!((state.controller, state.time), (None, 0.0));
    assert!(state.go_back() && state.show.source == before.source && state.controller == controller);
    // As its files are then.
    assert!(state.show.scenes_opened > before.scenes_opened);
}

/// Weights for ambient occlusion.
#[cfg(feature = "train")]
fn trained() -> Trained {
    use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};

    let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4));
    Trained(Arc::new(Model { weights: Weights::random(&spec, 1), spec }))
}

#[cfg(feature = "train")]
#[test]
fn a_network_that_was_waited_for_is_shown_once_there_are_weights() {
    let trained = trained();
    let mut state = State::new(&args("--model runs/none")).expect("methods");
    assert!(!state.show.methods.contains(&LEARNED));
    state.take_weights(trained.clone());
    assert!(state.show.methods.contains(&LEARNED) && state.show.trained == Some(trained.clone()));
    state.toggle(LEARNED);
    state.take_weights(trained.clone());
    assert!(!state.show.methods.contains(&LEARNED), "the user has put it away");
    let mut named = State::new(&args("--model runs/none --methods hbao")).expect("methods");
    named.take_weights(trained);
    assert_eq!(named.show.methods, ["hbao"]);
}

#[cfg(feature = "train")]
#[test]
fn weights_for_another_effect_are_not_run_and_their_folder_is_found_by_it() {
    for effect in [Effect::Gi, Effect::FogDirect] {
        let mut state = State::new(&args(&format!("--effect {effect} --model runs/none"))).expect("methods");
        let before = state.show.clone();
        state.take_weights(trained());
        state.take_weights(trained());
        assert!(state.show == before, "{effect}");
        state.choose_effect(Effect::Ao);
        assert_eq!(state.show.model.as_deref(), Some(Path::new("runs/none")));
        state.take_weights(trained());
        assert!(state.show.methods.contains(&LEARNED) && state.show.trained.is_some());
        state.choose_effect(effect);
        assert!(state.show.model.is_none() && state.show.trained.is_none());
    }
}

#[cfg(feature = "train")]
#[test]
fn a_training_that_comes_to_nothing_leaves_an_effect_the_network_that_it_had() {
    let folder = |state: &State| state.show.model.clone();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/ao");
    let new = Path::new("runs/new");
    let mut state = State::new(&args("--effect ao")).expect("methods");
    for before in [None, Some(shipped)] {
        before.iter().for_each(|before| state.open_model(before).expect("a network"));
        state.begin_training(Effect::Ao, new);
        assert_eq!(folder(&state).as_deref(), Some(new));
        assert!(state.end_training());
        assert_eq!(folder(&state), before);
        assert!(!state.end_training(), "it has ended");
    }
    assert!(state.show.methods.contains(&LEARNED));
    // The user looks at something else, or has named the folder themselves.
    state.begin_training(Effect::Ao, new);
    state.choose_effect(Effect::Gi);
    assert!(!state.end_training());
    let mut named = State::new(&args("--effect ao --model runs/new")).expect("methods");
    named.begin_training(Effect::Ao, new);
    assert!(!named.end_training() && folder(&named).as_deref() == Some(new));
}

#[test]
fn truth_is_beside_the_methods_and_none_of_them() {
    let mut state = State::new(&args("--methods truth,hbao")).expect("methods");
    assert_eq!(state.show.methods, ["hbao"]);
    state.toggle("gtao");
    assert!(state.show.methods.len() == 2 && !state.show.methods.contains(&TRUTH));
    assert!(State::new(&args("--methods truth")).expect("methods").show.methods.is_empty());
    assert!(State::new(&args("--methods ssgi")).is_err());
}

#[test]
fn a_network_that_was_fetched_is_known_by_its_address() {
    let mut state = State::new(&args("--effect ao")).expect("methods");
    state.args = Arc::new(args("--effect ao --model s3://models/ao"));
    state.fetched = Some("cache/copy".into());
    let place = |folder: &str| state.location_of_network(Path::new(folder)).to_string();
    assert_eq!(place("cache/copy"), "s3://models/ao");
    assert_eq!(place("models/other"), "models/other");
}
