//! What holds for the stages of every method.

use super::*;
use deepshade_shaders::Effect;

#[test]
fn every_pass_has_a_stage_and_stages_add_up() {
    use clap::Parser as _;
    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }
    let line = Line::try_parse_from(["deepshade", "--scene", "room:1", "--quality", "low"]).expect("a line");
    let gpu = Gpu::new().expect("an adapter");
    let shaded = |effect: &Effect| methods::screen_names(*effect).contains(&METHODS[0]);
    let effects: Vec<Effect> = Effect::ALL.into_iter().filter(shaded).collect();
    let methods = opened(&line.args, &gpu, &effects).expect("methods");
    let attributes: Vec<_> = methods.iter().flat_map(|method| method.attributes()).copied().collect();
    let animated_view = subject::open(&line.args, &effects).expect("a room");
    let size = "64x48".parse().expect("a size");
    let subject = SurfelFrame::new(&gpu, &animated_view, None, size, &attributes).expect("room");
    for method in &methods {
        let name = format!("{} by {}", method.effect(), method.name());
        let passes = MethodPasses::new(method, &subject.inputs(), &subject.view).expect("passes");
        assert!(passes.steps().iter().all(|step| Stage::of(step).is_some()), "{name}");
        let cost = Cost::of(&gpu, &passes, 1).expect("times");
        let has = |stage| cost.stages.iter().any(|(other, _)| *other == stage);
        assert!(has(Stage::Surfels) && has(Stage::Splat), "{name}: {cost:?}");
        assert_eq!(
            has(Stage::Light),
            matches!(method.effect(), Effect::Gi | Effect::Glossy | Effect::Subsurface | Effect::PhosphorGi),
            "{name}"
        );
        assert_eq!(cost.surfels[0] > 100, !method.name().starts_with("aov"), "{name}: {cost:?}");
        assert!(cost.surfels[0] <= cost.surfels[1], "{name}: {cost:?}");
        let sum: f64 = cost.stages.iter().map(|(_, time)| time).sum();
        assert!(sum > 0.0 && cost.total > 0.0 && cost.megabytes > 1.0, "{name}: {cost:?}");
    }
    assert!(subject.area_error(Quality::Low).expect("an area").abs() < 0.01);
}
