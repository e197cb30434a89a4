//! Singular value decomposition by one-sided Jacobi rotations (Golub and Van Loan 1996, section 8.6.3): pairs
//! of columns are turned until all are perpendicular; their lengths are the singular values.

/// The leading terms of a matrix: `a[row][column] = sum over i of rows[i][row] * columns[i][column]`.
#[derive(Clone, Debug)]
pub struct Svd {
    /// Singular values, the largest first.
    pub values: Vec<f64>,
    /// Left singular vectors, each times its singular value.
    pub rows: Vec<Vec<f64>>,
    /// Right singular vectors, of unit length.
    pub columns: Vec<Vec<f64>>,
}

/// Cosine of the angle between two columns below which they count as perpendicular,
const PERPENDICULAR: f64 = 1e-12;
/// and so do those whose product is this share of the sum of all squares: what rounding has left of them.
const NOTHING: f64 = 1e-20;
/// Sweeps over all pairs; some ten are enough for any matrix of the sizes that are used here.
const MOST_SWEEPS: usize = 40;

impl Svd {
    /// Of a matrix given by its columns, of one length each.
    pub fn of(mut columns: Vec<Vec<f64>>) -> Self {
        let count = columns.len();
        let unit = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect();
        let mut turns: Vec<Vec<f64>> = (0..count).map(unit).collect();
        let nothing = NOTHING * columns.iter().map(|column| dot(column, column)).sum::<f64>();
        for _ in 0..MOST_SWEEPS {
            let mut turned = false;
            for i in 0..count {
                for j in i + 1..count {
                    if let Some(rotation) = rotation(&columns[i], &columns[j], nothing) {
                        rotate(&mut columns, i, j, rotation);
                        rotate(&mut turns, i, j, rotation);
                        turned = true;
                    }
                }
            }
            if !turned {
                break;
            }
        }
        let length = |column: &[f64]| dot(column, column).sqrt();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| length(&columns[*b]).total_cmp(&length(&columns[*a])));
        Self {
            values: order.iter().map(|i| length(&columns[*i])).collect(),
            rows: order.iter().map(|i| columns[*i].clone()).collect(),
            columns: order.iter().map(|i| turns[*i].clone()).collect(),
        }
    }
}

/// Cosine and sine of the turn that makes two columns perpendicular; `None` where they are, or their product
/// is `nothing`.
fn rotation(a: &[f64], b: &[f64], nothing: f64) -> Option<[f64; 2]> {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    if ab.abs() <= nothing.max(PERPENDICULAR * (aa * bb).sqrt()) {
        return None;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    Some([cosine, cosine * tangent])
}

fn rotate(columns: &mut [Vec<f64>], i: usize, j: usize, [cosine, sine]: [f64; 2]) {
    let (left, right) = columns.split_at_mut(j);
    for (a, b) in left[i].iter_mut().zip(&mut right[0]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::split_mix::finalised;

    fn random(columns: usize, rows: usize) -> Vec<Vec<f64>> {
        let value = |i: usize| finalised(i as u64 + 1) as f64 / u64::MAX as f64 - 0.5;
        (0..columns).map(|c| (0..rows).map(|r| value(c * rows + r)).collect()).collect()
    }

    #[test]
    fn all_terms_together_are_the_matrix() {
        let matrix = random(7, 11);
        let svd = Svd::of(matrix.clone());
        for (c, column) in matrix.iter().enumerate() {
            for (r, value) in column.iter().enumerate() {
                let sum: f64 = (0..7).map(|i| svd.rows[i][r] * svd.columns[i][c]).sum();
                assert!((sum - value).abs() < 1e-12, "{sum} is not {value}");
            }
        }
    }

    #[test]
    fn vectors_are_orthonormal_and_values_fall() {
        let svd = Svd::of(random(9, 9));
        for i in 0..9 {
            for j in 0..9 {
                let one = f64::from(u8::from(i == j));
                assert!((dot(&svd.columns[i], &svd.columns[j]) - one).abs() < 1e-12);
                let along = dot(&svd.rows[i], &svd.rows[j]);
                assert!((along - one * svd.values[i].powi(2)).abs() < 1e-12);
            }
        }
        assert!(svd.values.windows(2).all(|pair| pair[0] >= pair[1]));
    }

    #[test]
    fn a_product_of_two_vectors_has_one_term() {
        let outer: Vec<Vec<f64>> =
            (0..5).map(|c| (0..4).map(|r| f64::from((c + 1) * (r - 2))).collect()).collect();
        let svd = Svd::of(outer);
        assert!(svd.values[1] < 1e-12 * svd.values[0], "{:?}", svd.values);
        assert!(Svd::of(vec![vec![0.0; 3]; 3]).values.iter().all(|value| *value == 0.0));
    }
}
