use super::*;
use crate::recipe::{FamilyShare, FieldOfView, Radius, Resolution, Views};
use crate::stream::scenes::{ReadyScene, Scenes};
use crate::{Dataset, generate};
use std::sync::Weak;
use std::time::Instant;

/// Three views each of scenes of two families, with all that is drawn.
fn recipe() -> Recipe {
    let share = |name: &str| FamilyShare { name: name.to_owned(), scenes: 1 };
    Recipe {
        families: vec![share("tabletop"), share("blobs")],
        views_per_scene: 3,
        scramblings: 2,
        resolution: Resolution { height: 32, width: 32 },
        smallest: Some(Resolution { height: 16, width: 24 }),
        radius: Radius::Pixels([2.0, 8.0]),
        field_of_view: Some(FieldOfView::Drawn([35.0, 90.0])),
        views: Views::NearAndFar,
        ..crate::shipped::shrunk("ao-tiny.toml")
    }
}

#[test]
fn a_pair_depends_neither_on_threads_nor_on_room_nor_on_where_the_stream_began() {
    let recipe = recipe();
    let wanted = |first, room, threads| -> Vec<Arc<Pair>> {
        let stream = Stream::on_threads(&recipe, first, room, threads).expect("a stream");
        (first..14)
            .map(|number| {
                let pair = stream.pair(number).expect("a pair");
                stream.forget_before(number + 1);
                pair
            })
            .collect()
    };
    let all = wanted(0, 3, 1);
    assert!(all == wanted(0, 9, 3));
    assert!(all[7..] == wanted(7, 4, 2));
    assert!(all.windows(2).all(|pairs| pairs[0] != pairs[1]), "one is not the other");
    assert!(all.iter().all(|pair| pair.variance.is_some() && pair.radius > 0.0));
    let sizes: Vec<usize> = all.iter().map(|pair| pair.target.height()).collect();
    assert!(sizes.contains(&16) && sizes.contains(&32), "{sizes:?}");
}

#[test]
fn no_more_pairs_are_rendered_than_there_is_room_until_some_are_forgotten() {
    let stream = Stream::start(&recipe(), 1, 7).expect("a stream");
    // The scenes of numbers below 8, of which 6 and 7 are of one that there is no room for.
    for number in 1..6 {
        stream.pair(number).expect("a pair");
    }
    let refused = |number| stream.pair(number).expect_err("refused").to_string();
    assert_eq!(refused(6), "pair 6 of the stream: there is room for 1 to 5 alone");
    assert_eq!(stream.ring.len(), 5);
    stream.forget_before(4);
    stream.pair(8).expect("room was made");
    assert!(stream.ring.len() <= 7);
    assert_eq!(refused(3), "pair 3 of the stream: all before 4 are forgotten");
    // What nobody waited for is passed over.
    stream.forget_before(100);
    stream.pair(100).expect("a pair");
    assert!(stream.waited() > Duration::ZERO);
}

#[test]
fn a_dropped_stream_ends() {
    let ring: Weak<Ring> = {
        let stream = Stream::start(&recipe(), 0, 3).expect("a stream");
        stream.pair(0).expect("a pair");
        Arc::downgrade(&stream.ring)
    };
    let start = Instant::now();
    while ring.strong_count() > 0 && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(ring.strong_count(), 0, "the thread is still there");
}

#[test]
fn validation_is_of_other_scenes_and_always_the_same() {
    let recipe = recipe();
    let pairs = validation(&recipe, 5).expect("pairs");
    assert_eq!(pairs.len(), 5);
    assert!(pairs == validation(&recipe, 5).expect("pairs"));
    assert!(pairs[..2] == validation(&recipe, 2).expect("pairs")[..]);
    let stream = Stream::start(&recipe, 0, 6).expect("a stream");
    // Tests of the scenes' seeds say the same of all numbers.
    for number in 0..6 {
        let pair = stream.pair(number).expect("a pair");
        assert!(pairs.iter().all(|validation| *validation != *pair));
    }
}

#[test]
fn a_pair_is_what_a_dataset_of_its_scene_holds() {
    let recipe = recipe();
    let scenes = Scenes::of(&recipe).expect("scenes");
    let props = crate::Props::load(&recipe).expect("props");
    let folder = tempfile::tempdir().expect("a folder");
    generate(&recipe, folder.path()).expect("generated");
    let dataset = Dataset::open(folder.path()).expect("a dataset");
    let planned = recipe.plan().expect("a plan").remove(0);
    let staged = crate::StagedScene::load(&planned.scene, &recipe, &props).expect("a scene");
    let drawn = staged.each(&planned.views, |view| staged.drawn(planned.key, view)).expect("views");
    let streamed = scenes.pair(&ReadyScene { planned, staged, drawn }, 1).expect("a pair");
    let stored = dataset.pair(1).expect("a pair");
    assert_eq!((streamed.radius, streamed.target.height()), (stored.radius, stored.target.height()));
    let close = |(a, b): (&f32, &f32)| (a - b).abs() <= b.abs() / 1024.0 + 1e-6;
    assert!(streamed.target.data().iter().zip(stored.target.data()).all(close));
    assert!(streamed.gbuffer.planes().data().iter().zip(stored.gbuffer.planes().data()).all(close));
    let variances = [streamed.variance, stored.variance].map(|variance| variance.expect("known"));
    assert!(variances[0].data().iter().zip(variances[1].data()).all(close));
}
