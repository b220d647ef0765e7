//! Any bytes are refused with a sentence, or restore a filter that keeps what every filter promises.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stillrate_lab::runner::restore;
use stillrate_lab::saved::crc32;

fuzz_target!(|bytes: &[u8]| {
    let Some((&mode, body)) = bytes.split_first() else { return };
    let mut saved = body.to_vec();
    if mode % 2 == 1 {
        // With the checksum that its maker would have written: what lies behind the check must hold too.
        let end = saved.len().saturating_sub(4);
        saved.truncate(end);
        let sum = crc32(&saved);
        saved.extend_from_slice(&sum.to_le_bytes());
    }
    let mut filter = match restore(&saved) {
        Ok(filter) => filter,
        Err(refusal) => {
            assert!(!refusal.to_string().is_empty());
            return;
        }
    };
    if filter.channels() > 64 {
        return;
    }
    let mut row = vec![0.0; filter.channels()];
    for k in 0..20 {
        row.fill(if k == 7 { f64::NAN } else { 0.1 * f64::from(k % 3) });
        filter.update(&mut row, None);
        for (channel, rate) in row.iter().enumerate() {
            let last = filter.estimate(channel);
            let sound =
                rate.is_finite() && last.acceleration.is_finite() && last.variance.is_finite() && last.variance >= 0.0;
            assert!(sound, "{} sample {k}: {last:?}", filter.method());
        }
    }
});
