//! Pareto front of time and error.

/// Returns for each point of (cost, error) true if no other point is at most as large in both and smaller in one.
#[must_use]
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| finite(&points[i])).collect();
    order.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]).then(points[a][1].total_cmp(&points[b][1])));
    let mut on = vec![false; points.len()];
    // Smallest error of all points cheaper than the current group of equal cost.
    let mut cheaper = f64::INFINITY;
    for group in order.chunk_by(|&a, &b| points[a][0] == points[b][0]) {
        let least = points[group[0]][1];
        if least < cheaper {
            group.iter().filter(|&&i| points[i][1] == least).for_each(|&i| on[i] = true);
            cheaper = least;
        }
    }
    on
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
