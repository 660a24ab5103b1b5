//! Parts of a segment, from 0 at its first end to 1 at its other.

/// Whether parts of a segment cover all of it, but for gaps of less than `slack`.
pub(super) fn cover(parts: &mut [[f64; 2]], slack: f64) -> bool {
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut reached = 0.0;
    for [begin, end] in parts {
        if *begin > reached + slack {
            return false;
        }
        reached = end.max(reached);
    }
    reached >= 1.0 - slack
}
