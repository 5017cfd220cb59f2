//! Structural similarity (Wang, Bovik, Sheikh & Simoncelli 2004), with that paper's constants.
//!
//! Implemented here because the published crates compare 8-bit pictures, whose rounding hides small differences.

/// Half the width of the window: 11 by 11.
const RADIUS: usize = 5;
/// Standard deviation of the window's Gaussian weights, in pixels.
const SIGMA: f64 = 1.5;
/// `(0.01 L)^2` and `(0.03 L)^2` for values of range `L = 1`.
const C1: f64 = 1e-4;
const C2: f64 = 9e-4;

/// Returns the mean over channels and over all windows that lie fully inside. The window shrinks if the picture is
/// smaller.
pub(super) fn ssim(a: &[[f64; 3]], b: &[[f64; 3]], width: usize, height: usize) -> f64 {
    let radius = RADIUS.min((width.min(height) - 1) / 2);
    let weights = gaussian(radius);
    let (columns, rows) = (width - 2 * radius, height - 2 * radius);
    let mut total = 0.0;
    // For each column, the horizontal sums of one row: weighted a, b, a^2, b^2 and a b.
    let mut sums = vec![[0.0; 5]; columns * height];
    for channel in 0..3 {
        for (i, sum) in sums.iter_mut().enumerate() {
            let start = i / columns * width + i % columns;
            *sum = [0.0; 5];
            for (k, w) in weights.iter().enumerate() {
                let (x, y) = (a[start + k][channel], b[start + k][channel]);
                for (s, v) in sum.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                    *s += w * v;
                }
            }
        }
        for i in 0..columns * rows {
            let mut m = [0.0; 5];
            for (k, w) in weights.iter().enumerate() {
                for (m, s) in m.iter_mut().zip(sums[i + k * columns]) {
                    *m += w * s;
                }
            }
            let [x, y, xx, yy, xy] = m;
            let luminance = (2.0 * x * y + C1) / (x * x + y * y + C1);
            let structure = (2.0 * (xy - x * y) + C2) / ((xx - x * x) + (yy - y * y) + C2);
            total += luminance * structure;
        }
    }
    total / (3 * columns * rows) as f64
}

/// Returns Gaussian weights at `-radius..=radius` that sum to 1.
fn gaussian(radius: usize) -> Vec<f64> {
    let weights: Vec<f64> =
        (0..=2 * radius).map(|i| i as f64 - radius as f64).map(|x| (-x * x / (2.0 * SIGMA * SIGMA)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_flat_pictures_differ_in_luminance_alone() {
        for (width, height) in [(16, 12), (4, 9), (1, 1)] {
            let n = width * height;
            let s = ssim(&vec![[0.5; 3]; n], &vec![[0.6; 3]; n], width, height);
            assert!((s - (2.0 * 0.5 * 0.6 + C1) / (0.25 + 0.36 + C1)).abs() < 1e-10);
        }
    }

    #[test]
    fn a_single_window_is_the_formula_written_out() {
        // Stripes against their negative in one 11 by 11 window: the same spread, opposite signs. With weights p on
        // odd columns, mean = p, variance = p - p^2 for one, mean = 1 - p for the other, covariance = -variance.
        let a: Vec<_> = (0..121).map(|i| [(i % 11 % 2) as f64; 3]).collect();
        let b: Vec<_> = a.iter().map(|p| p.map(|x| 1.0 - x)).collect();
        let p: f64 = gaussian(5).iter().skip(1).step_by(2).sum();
        let v = p - p * p;
        let luminance = (2.0 * p * (1.0 - p) + C1) / (p * p + (1.0 - p) * (1.0 - p) + C1);
        let expected = luminance * (C2 - 2.0 * v) / (C2 + 2.0 * v);
        assert!((ssim(&a, &b, 11, 11) - expected).abs() < 1e-12);
        assert!(expected < -0.9);
    }
}
