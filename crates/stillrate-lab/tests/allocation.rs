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

#[test]
fn the_counter_sees_an_allocation() {
    let before = REQUESTS.get();
    std::hint::black_box(Box::new(7_u64));
    assert!(REQUESTS.get() > before);
}
