//! Adaptive forgetting against a rival that was tuned by search, judged on seeds that nobody was tuned on.

use stillrate::Settings;
use stillrate::filters::VariableForgettingSettings;
use stillrate_lab::recursive::bench::{Played, noise, tune_one_euro};
use stillrate_lab::recursive::scenarios::{SAMPLE_RATE_HZ, Scenario};

#[test]
fn variable_forgetting_is_quiet_at_rest_and_true_in_motion_where_one_euro_is_not() {
    let judged = [20_261, 20_262, 20_263];
    let (quiet, mixed) = (Played::of(Scenario::Quiet, &judged), Played::of(Scenario::Mixed, &judged));
    let vff = VariableForgettingSettings::defaults(SAMPLE_RATE_HZ, noise()).build::<f64>().unwrap();
    let (vff_quiet, vff_mixed) = (quiet.relative_error(vff), mixed.relative_error(vff));
    let tuned = tune_one_euro(60, 1, &[911, 912, 913]);
    let one_euro = tuned.build::<f64>().unwrap();
    let (rival_quiet, rival_mixed) = (quiet.relative_error(one_euro), mixed.relative_error(one_euro));
    println!("VFF quiet {vff_quiet:.4} mixed {vff_mixed:.4}; one-euro quiet {rival_quiet:.4} mixed {rival_mixed:.4}");
    println!("{tuned:?}");
    assert!(vff_quiet <= 0.165 && vff_mixed <= 1.05);
    assert!(rival_mixed >= 4.0 * vff_mixed);
}
