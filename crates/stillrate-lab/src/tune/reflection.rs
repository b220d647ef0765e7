//! The recursions of Levinson and Durbin and of Burg: from order to order by one reflection coefficient.

/// Coefficients and driving variance of one order.
pub(super) type Model = (Vec<f64>, f64);

/// One step of Levinson's recursion: the coefficients of the next order from a reflection coefficient.
fn extended(coefficients: &[f64], reflection: f64) -> Vec<f64> {
    let backwards = coefficients.iter().rev();
    let mut next: Vec<f64> = coefficients.iter().zip(backwards).map(|(a, b)| a - reflection * b).collect();
    next.push(reflection);
    next
}

/// Biased autocovariance at lags 0 to `order`.
pub(super) fn autocovariance(deviations: &[f64], order: usize) -> Vec<f64> {
    let count = deviations.len() as f64;
    let at = |lag: usize| deviations.iter().zip(&deviations[lag..]).map(|(a, b)| a * b).sum::<f64>() / count;
    (0..=order).map(at).collect()
}

/// Levinson-Durbin on an autocovariance; none without variation.
pub(super) fn levinson(covariance: &[f64]) -> Option<Vec<Model>> {
    let mut variance = covariance[0];
    let mut coefficients = Vec::new();
    let mut models = Vec::new();
    for order in 1..covariance.len() {
        if !is_positive(variance) {
            return None;
        }
        let predicted: f64 = coefficients.iter().zip(covariance[1..order].iter().rev()).map(|(a, c)| a * c).sum();
        let reflection = (covariance[order] - predicted) / variance;
        coefficients = extended(&coefficients, reflection);
        variance *= 1.0 - reflection * reflection;
        models.push((coefficients.clone(), variance));
    }
    is_positive(variance).then_some(models)
}

/// Burg's recursion on the forward and backward prediction errors; none without variation.
pub(super) fn burg(deviations: &[f64], order: usize) -> Option<Vec<Model>> {
    let (mut forward, mut backward) = (deviations.to_vec(), deviations.to_vec());
    let mut variance = deviations.iter().map(|x| x * x).sum::<f64>() / deviations.len() as f64;
    let mut coefficients = Vec::new();
    let mut models = Vec::new();
    for _ in 0..order {
        // Errors that belong together: forward at k, backward at k - 1.
        forward.remove(0);
        backward.pop();
        let product: f64 = forward.iter().zip(&backward).map(|(f, b)| f * b).sum();
        let power: f64 = forward.iter().zip(&backward).map(|(f, b)| f * f + b * b).sum();
        if !(is_positive(power) && is_positive(variance)) {
            return None;
        }
        let reflection = 2.0 * product / power;
        for (f, b) in forward.iter_mut().zip(&mut backward) {
            (*f, *b) = (*f - reflection * *b, *b - reflection * *f);
        }
        coefficients = extended(&coefficients, reflection);
        variance *= 1.0 - reflection * reflection;
        models.push((coefficients.clone(), variance));
    }
    is_positive(variance).then_some(models)
}

/// Above zero and neither NaN nor infinite.
fn is_positive(number: f64) -> bool {
    number > 0.0 && number.is_finite()
}
