//! A step asks the allocator for nothing, whatever the filter and the sample.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use stillrate::{Filter, GyroNoise, Real, Sample, Settings};

thread_local! {
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: hands everything on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        REQUESTS.set(REQUESTS.get() + 1);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn requests_while_stepping<S: Settings, T: Real>() -> u64 {
    let filter = S::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<T>().unwrap();
    let before = REQUESTS.get();
    let mut state = filter.start();
    for k in 0..20_000 {
        let value = if k % 97 == 0 { f64::NAN } else { f64::from(k % 31) * 0.1 };
        let dt = if k % 101 == 0 { 0.3 } else { 0.02 };
        std::hint::black_box(filter.step(&mut state, Sample { value: T::of(value), dt: T::of(dt) }));
    }
    REQUESTS.get() - before
}

#[test]
fn no_step_of_any_filter_allocates() {
    macro_rules! every {
        ($($name:ident),* $(,)?) => { $(
            assert_eq!(requests_while_stepping::<stillrate::filters::$name, f32>(), 0, stringify!($name));
            assert_eq!(requests_while_stepping::<stillrate::filters::$name, f64>(), 0, stringify!($name));
        )* };
    }
    stillrate::methods!(every);
}

fn requests_while_calibrating_a_gimbal<T: Real>() -> u64 {
    use stillrate::gimbal::{
        DEFAULT_SCALE, Estimator, FirstOrder, Gauge, JointFilter, Model, Options, Record, Reference, Relinearised,
        Selection, TwoLoop,
    };
    let model = Model::new(9.8, 0.7).unwrap();
    let selection = Selection::<32>::new(Gauge::Accelerometer, Options::default()).unwrap();
    let estimator = Estimator::<T, 32>::new(model, selection, &DEFAULT_SCALE, 0.0).unwrap();
    let mut command = vec![[0.01, -0.005, 0.0]; 200];
    command[60] = [f64::NAN, 0.0, 0.0];
    let sample = |k: usize| {
        [0.1 * (k % 7) as f64, if k.is_multiple_of(53) { f64::NAN } else { 9.8 }, 1e3 * (k % 41 / 40) as f64]
    };
    let samples: Vec<[f64; 3]> = (0..1001).map(sample).collect();
    let record = Record::new(&command, &samples, 0.25, 1e-3).unwrap();
    let (joint, first) = (JointFilter::new(estimator, 5.0).unwrap(), FirstOrder { estimator });
    let two = TwoLoop::<T>::new(model, &DEFAULT_SCALE).unwrap();
    let before = REQUESTS.get();
    let mut on_line = joint.start(&[0.0; 41]);
    let mut single = first.start(&[0.0; 41]);
    for k in 0..record.epochs() {
        std::hint::black_box(joint.epoch(&mut on_line, &record, k, Reference::Model));
        std::hint::black_box(first.epoch(&mut single, &record, k));
    }
    std::hint::black_box(Relinearised::new(estimator).run(&record, &[0.0; 41], |_, _, _| {}));
    std::hint::black_box(two.cascade(&record, &[0.0; 41], |_, _| {}));
    std::hint::black_box(two.two_stage(&record, &[0.0; 41], |_, _| {}));
    REQUESTS.get() - before
}

#[test]
fn no_epoch_of_a_gimbal_calibration_allocates() {
    assert_eq!(requests_while_calibrating_a_gimbal::<f64>(), 0);
    assert_eq!(requests_while_calibrating_a_gimbal::<f32>(), 0);
}

#[test]
fn the_counter_sees_an_allocation() {
    let before = REQUESTS.get();
    std::hint::black_box(Box::new(7_u64));
    assert!(REQUESTS.get() > before);
}
