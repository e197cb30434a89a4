//! ADADELTA (Zeiler 2012, algorithm 1): steps in the units of the weights, from running means of squares.

use burn::optim::{LearningRate, Optimizer, RecordState, StateSink, StateSource};
use burn::tensor::{Device, Tensor};

/// The optimiser's numbers.
#[derive(Clone, Debug)]
pub struct Adadelta {
    /// Decay of both running means.
    pub decay: f64,
    /// Added to both means before their roots are taken.
    pub epsilon: f64,
}

/// The running means of a parameter.
#[derive(Clone)]
pub struct AdadeltaState<const D: usize> {
    gradients: Tensor<D>,
    steps: Tensor<D>,
}

const GRADIENTS: &str = "gradients";
const STEPS: &str = "steps";

impl<const D: usize> RecordState for AdadeltaState<D> {
    fn state_flatten(&self, prefix: &str, out: &mut StateSink) {
        out.push_tensor(prefix, GRADIENTS, self.gradients.to_data());
        out.push_tensor(prefix, STEPS, self.steps.to_data());
    }

    fn state_unflatten(prefix: &str, source: &mut StateSource, device: &Device) -> Option<Self> {
        let gradients = source.take_tensor(prefix, GRADIENTS)?;
        let steps = source.take_tensor(prefix, STEPS)?;
        Some(Self {
            gradients: Tensor::from_data(gradients, device),
            steps: Tensor::from_data(steps, device),
        })
    }
}

impl Optimizer for Adadelta {
    type State<const D: usize> = AdadeltaState<D>;

    fn step<const D: usize>(
        &self,
        rate: LearningRate,
        weights: Tensor<D>,
        gradient: Tensor<D>,
        state: Option<Self::State<D>>,
    ) -> (Tensor<D>, Option<Self::State<D>>) {
        let state = state.unwrap_or_else(|| AdadeltaState {
            gradients: gradient.zeros_like(),
            steps: gradient.zeros_like(),
        });
        let gradients = self.follow(state.gradients, gradient.clone());
        let step = (state.steps.clone() + self.epsilon).sqrt() / (gradients.clone() + self.epsilon).sqrt()
            * gradient;
        let steps = self.follow(state.steps, step.clone());
        (weights - step * rate, Some(AdadeltaState { gradients, steps }))
    }

    fn to_device<const D: usize>(state: Self::State<D>, device: &Device) -> Self::State<D> {
        AdadeltaState { gradients: state.gradients.to_device(device), steps: state.steps.to_device(device) }
    }
}

impl Adadelta {
    /// A running mean after one more value's square.
    fn follow<const D: usize>(&self, mean: Tensor<D>, value: Tensor<D>) -> Tensor<D> {
        mean * self.decay + value.square() * (1.0 - self.decay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_steps_are_those_of_the_algorithm_done_by_hand() {
        let device = crate::device();
        let adadelta = Adadelta { decay: 0.9, epsilon: 1e-6 };
        let mut weights = Tensor::<1>::from_floats([1.0, -2.0], &device);
        let mut state = None;
        let (mut expected, mut means) = ([1.0, -2.0], [[0.0f64; 2]; 2]);
        for gradient in [[0.5, -3.0], [-0.25, 1.0], [2.0, 0.0]] {
            let tensor = Tensor::from_floats(gradient.map(|g| g as f32), &device);
            (weights, state) = adadelta.step(0.5, weights, tensor, state);
            for at in 0..2 {
                let [square, step] = &mut means[at];
                *square = 0.9 * *square + 0.1 * gradient[at] * gradient[at];
                let by = (*step + 1e-6).sqrt() / (*square + 1e-6).sqrt() * gradient[at];
                *step = 0.9 * *step + 0.1 * by * by;
                expected[at] -= 0.5 * by;
            }
        }
        let weights = weights.into_data().try_into_vec::<f32>().expect("f32");
        for (weight, expected) in weights.iter().zip(expected) {
            assert!((f64::from(*weight) - expected).abs() < 1e-6, "{weight} is not {expected}");
        }
        // The first step alone, in closed form: sqrt(epsilon) / sqrt(0.1 g^2 + epsilon) * g.
        let (first, _) =
            adadelta.step::<1>(1.0, Tensor::zeros([1], &device), Tensor::from_floats([0.5], &device), None);
        let first: f32 = first.into_scalar();
        assert!((f64::from(first) + 1e-3 / (0.025f64 + 1e-6).sqrt() * 0.5).abs() < 1e-8, "{first}");
    }
}
