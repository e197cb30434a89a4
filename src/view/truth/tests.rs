//! Truth that goes on.

use super::*;
use crate::view::tests::args;
use std::sync::Mutex;

const SIZE: [usize; 2] = [12, 16];

fn view_key(subject: &Arc<PreparedScene>) -> ViewKey {
    ViewKey {
        source: subject.source.clone(),
        effect: subject.effect,
        scenes_opened: 0,
        glow: None,
        subject: Arc::downgrade(subject),
        camera: subject.controller.camera,
        time: 0.0,
        lights: subject.lights(None),
        radius: 0.5,
        size: SIZE,
    }
}

#[test]
fn truth_that_comes_back_goes_on_from_its_samples() {
    let args = args("--scene still-life:1 --height 12 --width 16");
    let source = "still-life:1".parse().expect("a scene");
    let subject = Arc::new(PreparedScene::load(&args, &source, Effect::Ao).expect("a scene"));
    let view_key = view_key(&subject);
    let scene = subject.traced(0.0, &view_key.lights).expect("a scene");
    let shot = Shot::new(&scene, &view_key.camera, SIZE, view_key.radius);
    // Samples of another seed are told from those that a fresh start would take.
    let mut of_seed_1 = Refinement::new(Effect::Ao, &shot, SCRAMBLINGS, 1);
    of_seed_1.refine(4, |_, _| true, |_| {});
    let request =
        |samples| Request { view_key: view_key.clone(), exposure: None, stops: 0.0, samples, seed: 2 };
    let image = request(0).shown(of_seed_1.estimate().mean);
    let (samples, ceiling) = (of_seed_1.samples(), Scores::new(&image.values, &image.values));
    let truth = Truth { view_key: view_key.clone(), image, samples, noise: 0.1, ceiling, seconds: 7.0 };
    let kept = Some(Kept { truth, taken: of_seed_1.taken(), seed: 2 });
    let told = Mutex::new(Vec::new());
    let send = |update: Update| {
        if let Update::Truth(truth) = update {
            told.lock().expect("no panic").push(truth);
        }
    };
    let kept = refine(&RequestSlot::default(), request(64), kept, &send).expect("truth");
    of_seed_1.refine(4, |_, _| true, |_| {});
    let told = std::mem::take(&mut *told.lock().expect("no panic"));
    let samples: Vec<u32> = told.iter().map(|truth| truth.samples).collect();
    assert_eq!(samples, [64], "one pass was left to do");
    assert_eq!(*told[0].image.values, of_seed_1.estimate().mean);
    assert!(told[0].seconds > 7.0);
    let [one, other] = of_seed_1.halves();
    assert_eq!(told[0].ceiling, Scores::new(&one, &other));
    let taken = |kept: &Option<Kept>| kept.as_ref().map(|kept| kept.taken.samples());
    assert_eq!(taken(&kept), Some(64));
    // Another request meanwhile takes nothing of it away.
    let requests = RequestSlot::default();
    requests.put(Request { seed: 3, ..request(64) });
    let kept = refine(&requests, request(1024), kept, &send).expect("overtaken");
    assert_eq!(taken(&kept), Some(64));
}

#[test]
fn what_is_kept_fits_into_its_room_and_the_newest_stays() {
    let args = args("--scene still-life:1 --height 12 --width 16");
    let source = "still-life:1".parse().expect("a scene");
    let subject = Arc::new(PreparedScene::load(&args, &source, Effect::Ao).expect("a scene"));
    let view_key = view_key(&subject);
    let scene = subject.traced(0.0, &view_key.lights).expect("a scene");
    let shot = Shot::new(&scene, &view_key.camera, SIZE, view_key.radius);
    let mut refinement = Refinement::new(Effect::Ao, &shot, SCRAMBLINGS, 1);
    refinement.refine(1, |_, _| true, |_| {});
    let request = Request { view_key: view_key.clone(), exposure: None, stops: 0.0, samples: 8, seed: 0 };
    let image = request.shown(refinement.estimate().mean);
    // A value and a colour, four bytes each.
    assert_eq!(image.size(), 12 * 16 * 8);
    let ceiling = Scores::new(&image.values, &image.values);
    let kept = |seed: u32| {
        let truth = Truth {
            view_key: view_key.clone(),
            image: image.clone(),
            samples: 8,
            noise: 0.1,
            ceiling,
            seconds: 1.0,
        };
        Kept { truth, taken: refinement.taken(), seed }
    };
    let size = image.size() + refinement.taken().size();
    for (room, seeds) in
        [(0, &[3][..]), (2 * size, &[2, 3]), (4 * size - 1, &[1, 2, 3]), (4 * size, &[0, 1, 2, 3])]
    {
        let mut known: Vec<Kept> = (0..4).map(kept).collect();
        make_room(&mut known, room);
        assert!(known.iter().map(|kept| kept.seed).eq(seeds.iter().copied()), "{room} bytes");
    }
}
