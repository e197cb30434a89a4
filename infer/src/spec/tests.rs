//! Networks that can be, and networks that cannot.

use super::*;

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

fn correcting() -> NetSpec {
    let inputs = vec![Attribute::Normal, Attribute::Openness, Attribute::RawOpenness];
    let estimates = vec![AnalyticEstimate::new("gtao", "high")];
    let correction = Correction {
        of: Attribute::Openness,
        over: Attribute::RawOpenness,
        levels: 2,
        kernel: 3,
        gain: false,
        gated: false,
    };
    NetSpec::correcting(Effect::Ao, inputs, estimates, correction, 24, REACH)
}

#[test]
fn a_mono_network_runs_once_a_colour_channel() {
    let spec = |effect| NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("has one");
    let channels = |spec: NetSpec| (spec.input_channels(), spec.output_channels(), spec.runs());
    assert_eq!(channels(spec(Effect::Ao)), (6, 1, 1));
    assert_eq!(channels(spec(Effect::Sss)), (5, 1, 3));
    assert_eq!(channels(spec(Effect::Multi)), (11, 3, 1));
}

#[test]
fn a_network_that_corrects_makes_a_bias_and_its_taps_for_four_pixels() {
    let spec = correcting();
    assert_eq!(spec.validate(), Ok(()));
    assert_eq!((spec.levels(), spec.alignment(), spec.last_level()), (6, 32, 1));
    assert_eq!((spec.head_channels(), spec.last_channels()), (1 + 18, 4 * 19));
    assert_eq!((spec.channels_of(Attribute::Openness), spec.pyramid_channels()), (vec![3], vec![4]));
    assert_eq!(spec.layers()[0].inputs, 4 * 5);
}

#[test]
fn a_spec_survives_the_way_through_its_file() {
    for spec in [correcting(), NetSpec::ao(ChannelOrder::Interleaved, REACH)] {
        let text = serde_json::to_string(&spec).expect("JSON");
        assert_eq!(serde_json::from_str::<NetSpec>(&text).ok(), Some(spec));
    }
}

#[test]
fn the_papers_network_is_valid_and_absurd_ones_are_named() {
    let ao = NetSpec::ao(ChannelOrder::Contiguous, REACH);
    assert_eq!(ao.validate(), Ok(()));
    let block = |index: usize, change: fn(&mut Block)| {
        let mut spec = ao.clone();
        change(&mut spec.blocks[index]);
        spec
    };
    let absurd = [
        (NetSpec { blocks: Vec::new(), ..ao.clone() }, "`blocks` is 0"),
        (block(1, |block| block.outputs = usize::MAX), "`outputs` is"),
        (block(1, |block| block.kernel = 4), "`kernel` is 4"),
        (block(10, |block| block.groups = 0), "`groups` is 0"),
        (block(10, |block| block.groups = 5), "layer `up0` has 5 groups"),
        (block(1, |block| block.outputs = 5), "layer `down1` has 2 groups"),
        (
            block(2, |block| block.reads = BlockSource::Plain(7)),
            "block `down2` reads a block that comes after it",
        ),
        (
            block(0, |block| block.reads = BlockSource::Plain(0)),
            "block `down0` reads a block that comes after it",
        ),
        (block(2, |block| block.name = "down1".to_owned()), "block `down1` has no name of its own"),
        (
            block(6, |block| block.reads = BlockSource::Joined { coarse: 5, skip: 3, groups: 1 }),
            "block `up4` joins blocks that are not one level apart",
        ),
        (
            block(2, |block| block.name = "../down".to_owned()),
            "block `../down` has a name that is not of up to 64 small letters",
        ),
        (block(10, |block| block.reads = BlockSource::Input), "block `up0` is the last and reads the input"),
        (block(8, |block| block.reads = BlockSource::Pooled(6)), "block `up2` pools a block that joins two"),
        (block(10, |block| block.outputs = 2), "the last block makes 2 channels; its head needs 1"),
        (NetSpec { leak: -1.0, ..ao.clone() }, "`leak` is -1"),
        (NetSpec { leak: f32::NAN, ..ao.clone() }, "`leak` is NaN"),
        (NetSpec { inputs: Vec::new(), ..ao.clone() }, "`inputs` is 0"),
        (NetSpec { reach: Reach { radius: 0.0, ..REACH }, ..ao.clone() }, "`reach.radius` is 0"),
        (NetSpec { reach: Reach { height: 0, ..REACH }, ..ao.clone() }, "`reach.height` is 0"),
        (NetSpec { reach: Reach { height: 1 << 40, ..REACH }, ..ao.clone() }, "`reach.height` is 1099"),
        (NetSpec { inputs: vec![Attribute::Normal], ..correcting() }, "the network's head works on 0"),
    ];
    for (spec, message) in absurd {
        let error = spec.validate().expect_err(message).to_string();
        assert!(error.starts_with(message), "{error}");
    }
}
