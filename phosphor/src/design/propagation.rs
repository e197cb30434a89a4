//! From the places that a user edited to all others: places alike get materials alike (after Pellacini and
//! Lawrence 2007, "AppWand"), with affinities in place of their system of equations: a material is the mean
//! of the edited ones, weighted by how near they are in space and in colour.

use deepshade_glow::material::{Material, State};

/// What of a place says how alike it is to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Where it is, in metres.
    pub position: [f64; 3],
    /// Its reflectance, linear RGB.
    pub colour: [f64; 3],
}

/// How far an edit reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// In space: at this distance in metres the affinity is 1/e.
    pub distance: f64,
    /// In colour: at this distance it is 1/e.
    pub colour: f64,
}

/// An edited place.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// What it is like.
    pub feature: Feature,
    /// The material that it was given.
    pub material: Material,
}

/// What a place gets.
#[derive(Clone, Debug, PartialEq)]
pub struct Propagated {
    /// Its material.
    pub material: Material,
    /// How alike it is to the edited place that is most alike: 1 there, towards 0 far away.
    pub affinity: f64,
}

/// Why edits do not spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PropagationError {
    /// None.
    #[error("nothing was edited")]
    NoEdits,
    /// Materials that have no mean.
    #[error("the edited materials differ in bands or in the number of states")]
    Unlike,
}

impl Reach {
    /// The material of a place, from those that were edited. Rates of decay are averaged by their logarithms;
    /// all excitation lists get the length of the longest.
    ///
    /// # Errors
    /// If nothing was edited, or the materials have other bands or numbers of states.
    pub fn propagate(self, edits: &[Edit], at: Feature) -> Result<Propagated, PropagationError> {
        let first = &edits.first().ok_or(PropagationError::NoEdits)?.material;
        let alike = |edit: &Edit| {
            edit.material.bands == first.bands && edit.material.states.len() == first.states.len()
        };
        if !edits.iter().all(alike) {
            return Err(PropagationError::Unlike);
        }
        let far: Vec<f64> = edits.iter().map(|edit| self.squared(edit.feature, at)).collect();
        let nearest = far.iter().copied().fold(f64::INFINITY, f64::min);
        // Relative to the nearest, so that far away from all it is the nearest that counts.
        let weights: Vec<f64> = far.iter().map(|far| (nearest - far).exp()).collect();
        let states = (0..first.states.len()).map(|state| mean(edits, &weights, state)).collect();
        let material = Material { name: first.name.clone(), bands: first.bands, doubt: None, states };
        Ok(Propagated { material, affinity: (-nearest).exp() })
    }

    fn squared(self, a: Feature, b: Feature) -> f64 {
        let off = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        off(a.position, b.position) / self.distance.powi(2) + off(a.colour, b.colour) / self.colour.powi(2)
    }
}

fn mean(edits: &[Edit], weights: &[f64], state: usize) -> State {
    let total: f64 = weights.iter().sum();
    let over = |value: &dyn Fn(&State) -> f64| -> f64 {
        let values = edits.iter().map(|edit| value(&edit.material.states[state]));
        // What does not count may be infinite: the logarithm of 0.
        values.zip(weights).filter(|(_, w)| **w > 0.0).map(|(value, weight)| value * weight).sum::<f64>()
            / total
    };
    let excited = edits.iter().map(|edit| edit.material.states[state].excitation.len()).max().unwrap_or(0);
    let bands = edits[0].material.states[state].emission.len();
    State {
        decay: over(&|state| state.decay.ln()).exp(),
        excitation: (0..excited)
            .map(|b| over(&|state| state.excitation.get(b).copied().unwrap_or(0.0)))
            .collect(),
        emission: (0..bands).map(|band| over(&|state| state.emission[band])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::spectrum::Bands;

    fn edit(x: f64, decay: f64) -> Edit {
        let state = State { decay, excitation: vec![0.1], emission: vec![decay, 2.0, 0.0] };
        let material =
            Material { name: "edited".into(), bands: Bands::Rgb, doubt: None, states: vec![state] };
        Edit { feature: feature(x), material }
    }

    fn feature(x: f64) -> Feature {
        Feature { position: [x, 0.0, 0.0], colour: [0.5; 3] }
    }

    const REACH: Reach = Reach { distance: 0.3, colour: 0.1 };

    #[test]
    fn edited_places_keep_their_material_and_the_middle_has_the_mean() {
        let edits = [edit(0.0, 0.01), edit(2.0, 0.04)];
        let at = |x| REACH.propagate(&edits, feature(x)).expect("a material");
        assert!((at(0.0).material.states[0].decay - 0.01).abs() < 1e-9 && at(0.0).affinity == 1.0);
        let middle = at(1.0).material.states[0].clone();
        assert!(
            (middle.decay - 0.02).abs() < 1e-12 && (middle.emission[0] - 0.025).abs() < 1e-12,
            "{middle:?}"
        );
        let far = at(1e6);
        assert!((far.material.states[0].decay - 0.04).abs() < 1e-9 && far.affinity == 0.0, "{far:?}");
    }

    #[test]
    fn colours_hold_edits_back() {
        let edits = [
            edit(0.0, 0.01),
            Edit { feature: Feature { colour: [0.9; 3], ..feature(0.1) }, ..edit(0.1, 0.04) },
        ];
        let at = REACH.propagate(&edits, feature(0.1)).expect("a material");
        assert!((at.material.states[0].decay - 0.01).abs() < 1e-6, "{at:?}");
    }

    #[test]
    fn what_has_no_mean_is_refused() {
        assert_eq!(REACH.propagate(&[], feature(0.0)), Err(PropagationError::NoEdits));
        let mut two = edit(0.0, 0.1);
        two.material.states.push(two.material.states[0].clone());
        assert_eq!(REACH.propagate(&[edit(0.0, 0.1), two], feature(0.0)), Err(PropagationError::Unlike));
    }
}
