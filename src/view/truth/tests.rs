//! Truth that goes on.

use super::*;
use crate::view::tests::args;
use std::sync::{Arc, Mutex};

const SIZE: [usize; 2] = [12, 16];

fn sight(subject: &Arc<Subject>) -> Sight {
    Sight {
        source: subject.source.clone(),
        effect: subject.effect,
        contents: subject.contents.clone(),
        subject: Arc::downgrade(subject),
        camera: subject.pilot.camera,
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
    let subject = Arc::new(Subject::load(&args, &source, Effect::Ao).expect("a scene"));
    let sight = sight(&subject);
    let scene = subject.traced(0.0, &sight.lights).expect("a scene");
    let shot = Shot::new(&scene, &sight.camera, SIZE, sight.radius);
    // Samples of another seed are told from those that a fresh start would take.
    let mut of_seed_1 = Refinement::new(Effect::Ao, &shot, SCRAMBLINGS, 1);
    of_seed_1.refine(4, |_, _| true, |_| {});
    let order = |samples| Order { sight: sight.clone(), exposure: None, stops: 0.0, samples, seed: 2 };
    let image = order(0).developed(of_seed_1.estimate().mean);
    let (samples, ceiling) = (of_seed_1.samples(), Scores::new(&image.values, &image.values));
    let truth = Truth { sight: sight.clone(), image, samples, noise: 0.1, ceiling, seconds: 7.0 };
    let mut kept = Some(Kept { truth, taken: Some(of_seed_1.taken()), seed: 2 });
    let told = Arc::new(Mutex::new(Vec::new()));
    let tell = {
        let told = Arc::clone(&told);
        move |news: News| {
            if let News::Truth(truth) = news {
                told.lock().expect("no panic").push(truth);
            }
        }
    };
    refine(&Mailbox::default(), order(64), &mut kept, &tell).expect("truth");
    of_seed_1.refine(4, |_, _| true, |_| {});
    let told = std::mem::take(&mut *told.lock().expect("no panic"));
    let samples: Vec<u32> = told.iter().map(|truth| truth.samples).collect();
    assert_eq!(samples, [64], "one pass was left to do");
    assert_eq!(*told[0].image.values, of_seed_1.estimate().mean);
    assert!(told[0].seconds > 7.0);
    let [one, other] = of_seed_1.halves();
    assert_eq!(told[0].ceiling, Scores::new(&one, &other));
    let taken = |kept: &Option<Kept>| kept.as_ref().and_then(|kept| kept.taken.as_ref().map(Taken::samples));
    assert_eq!(taken(&kept), Some(64));
    // Who wants other truth meanwhile takes nothing of it away.
    let orders = Mailbox::default();
    orders.put(Order { seed: 3, ..order(64) });
    refine(&orders, order(1024), &mut kept, &tell).expect("overtaken");
    assert_eq!(taken(&kept), Some(64));
    // And without samples it begins anew, behind what is known.
    kept.as_mut().expect("kept").taken = None;
    refine(&Mailbox::default(), order(128), &mut kept, &tell).expect("truth");
    assert_eq!(taken(&kept), Some(128));
}

#[test]
fn what_is_kept_fits_into_its_room_and_the_newest_stays() {
    let args = args("--scene still-life:1 --height 12 --width 16");
    let source = "still-life:1".parse().expect("a scene");
    let subject = Arc::new(Subject::load(&args, &source, Effect::Ao).expect("a scene"));
    let sight = sight(&subject);
    let scene = subject.traced(0.0, &sight.lights).expect("a scene");
    let shot = Shot::new(&scene, &sight.camera, SIZE, sight.radius);
    let mut refinement = Refinement::new(Effect::Ao, &shot, SCRAMBLINGS, 1);
    refinement.refine(1, |_, _| true, |_| {});
    let order = Order { sight: sight.clone(), exposure: None, stops: 0.0, samples: 8, seed: 0 };
    let image = order.developed(refinement.estimate().mean);
    // A value and a colour, four bytes each.
    assert_eq!(image.size(), 12 * 16 * 8);
    let ceiling = Scores::new(&image.values, &image.values);
    let kept = |seed: u32| {
        let truth = Truth {
            sight: sight.clone(),
            image: image.clone(),
            samples: 8,
            noise: 0.1,
            ceiling,
            seconds: 1.0,
        };
        Kept { truth, taken: Some(refinement.taken()), seed }
    };
    let (own, taken) = (image.size(), refinement.taken().size());
    for (room, seeds, going_on) in [
        (0, &[3][..], 0),
        (2 * own, &[2, 3], 0),
        (4 * own + taken - 1, &[0, 1, 2, 3], 0),
        (4 * own + taken, &[0, 1, 2, 3], 1),
        (4 * own + 2 * taken, &[0, 1, 2, 3], 2),
    ] {
        let mut known: Vec<Kept> = (0..4).map(kept).collect();
        make_room(&mut known, room);
        assert!(known.iter().map(|kept| kept.seed).eq(seeds.iter().copied()), "{room} bytes");
        let found: Vec<bool> = known.iter().map(|kept| kept.taken.is_some()).collect();
        assert_eq!(found.iter().filter(|kept| **kept).count(), going_on, "{room} bytes");
        assert!(found.is_sorted(), "the newest go on");
    }
    let mut known: Vec<Kept> = (0..40).map(kept).collect();
    make_room(&mut known, ROOM);
    assert_eq!((known.len(), known[0].seed), (KEPT, 8));
}
