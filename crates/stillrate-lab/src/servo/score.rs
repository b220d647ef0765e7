//! How points of a search compare: constraints first (K. Deb's rules, 2000).

use core::cmp::Ordering;

/// How good a point is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// Sum of constraint violations, 0 for a feasible point.
    pub(crate) violation: f64,
    /// Value to minimise.
    pub(crate) value: f64,
}

impl Score {
    /// Worse than anything.
    pub(crate) const WORST: Self = Self { violation: f64::INFINITY, value: f64::INFINITY };

    /// Deb's comparison; NaN never wins.
    pub(crate) fn beats(self, other: Self) -> bool {
        if self.violation != other.violation {
            return self.violation < other.violation;
        }
        self.value < other.value
    }
}

/// A point and its score.
pub(crate) type Scored = (Vec<f64>, Score);

/// Best first.
pub(super) fn order(a: &Scored, b: &Scored) -> Ordering {
    if a.1.beats(b.1) {
        Ordering::Less
    } else if b.1.beats(a.1) {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}
