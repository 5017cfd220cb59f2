//! What nothing else beats in both time and error.

/// For each point of (cost, error), whether no other is at most as costly and at most as wrong, and less in one of them.
#[must_use]
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && (a[0] < b[0] || a[1] < b[1]);
    points.iter().map(|p| p.iter().all(|x| x.is_finite()) && !points.iter().any(|q| beats(q, p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [[1.0, 5.0], [2.0, 3.0], [2.0, 4.0], [3.0, 3.0], [4.0, 1.0], [0.5, f64::NAN]];
        assert_eq!(front(&points), [true, true, false, false, true, false]);
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]]), [true, true], "equals do not beat each other");
        assert_eq!(front(&[]), [false; 0]);
    }
}
