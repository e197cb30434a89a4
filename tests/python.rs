//! The Python package's table of effects is the program's.

use deepshade_infer::{AnalyticEstimate, NetSpec, Reach};
use deepshade_shaders::Effect;

/// An effect as the package writes it, what is usual left out.
fn as_in_python(effect: Effect) -> String {
    let [_, most] = effect.range();
    let number = |value: f32| format!("{value:?}");
    let background = match effect.background() {
        None => Some("background=None".to_owned()),
        Some(0.0) => None,
        Some(value) => Some(format!("background={}", number(value))),
    };
    let fields = [
        background,
        (effect.channels() != 3).then(|| format!("channels={}", effect.channels())),
        (most == 1.0).then(|| "most=1.0".to_owned()),
        effect.definition().filters_light.then(|| "filters_light=True".to_owned()),
        (brightness(effect) != 1.0).then(|| format!("brightness={}", number(brightness(effect)))),
    ];
    let fields: String = fields.into_iter().flatten().map(|field| format!(", {field}")).collect();
    format!("Effect(\"{}\"{fields}),", effect.name())
}

/// How bright light is to an effect's networks.
fn brightness(effect: Effect) -> f32 {
    let reach = Reach { radius: 1.0, diagonal_share: 0.03, height: 256 };
    let estimate = AnalyticEstimate::new("any", "low");
    let any = NetSpec::corrected(Effect::Ao, 8, vec![estimate], reach).expect("ao has one");
    NetSpec { effect, ..any }.brightness()
}

#[test]
fn the_package_knows_every_effect_as_the_program_does() {
    let table = include_str!("../python/src/deepshade/effects.py");
    let rows = table.lines().map(str::trim).filter(|line| line.starts_with("Effect(\""));
    let ours: Vec<String> = Effect::ALL.into_iter().map(as_in_python).collect();
    assert_eq!(rows.map(str::to_owned).collect::<Vec<_>>(), ours);
}
