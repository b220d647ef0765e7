//! The C functions with any bit pattern as configuration, state and sample: no access outside the structs, no panic.
//! The sources of the library are compiled in, so that the address sanitizer sees them.
#![no_main]

use core::ffi::c_void;
use core::marker::PhantomData;

use libfuzzer_sys::fuzz_target;
use stillrate::{Estimate, Filter, GyroNoise, Sample, Settings};
use stillrate_fuzz::Input;

include!("../../crates/stillrate-c/abi/src/calls.rs");
include!("../../crates/stillrate-c/abi/src/functions.rs");

/// A method in one precision.
struct Case<S, T>(PhantomData<(S, T)>);

/// Drives the four functions of a method as a C program would.
trait Drive {
    fn drive(input: Input<'_>);
}

/// Now the same list gives the callers.
macro_rules! functions {
    ($settings:ident $type:ty; $start:ident $step:ident $estimate:ident $reset:ident) => {
        impl Drive for Case<stillrate::filters::$settings, $type> {
            fn drive(mut input: Input<'_>) {
                unsafe extern "C" {
                    fn $start(config: *const c_void, state: *mut c_void);
                    fn $step(config: *const c_void, state: *mut c_void, value: $type, dt_s: $type) -> $type;
                    fn $estimate(state: *const c_void, out: *mut c_void);
                    fn $reset(config: *const c_void, state: *mut c_void);
                }
                type Config = <stillrate::filters::$settings as Settings>::Filter<$type>;
                type Held = State<<Config as Filter<$type>>::State, $type>;
                let noise = GyroNoise::from_density_two_sided(0.015);
                let built =
                    stillrate::filters::$settings::defaults(50.0, noise).build::<$type>().expect("defaults hold");
                // On the heap, in blocks of exactly their size, with guards around.
                let config = Box::into_raw(Box::new(built));
                let state = Box::into_raw(Box::<Held>::new_zeroed());
                let out = Box::into_raw(Box::<Estimate<$type>>::new_zeroed());
                let wild = input.byte();
                // SAFETY: blocks of the right size; every bit pattern is a valid value of these structs.
                unsafe {
                    if wild & 1 == 1 {
                        scribble(config.cast(), size_of::<Config>(), &mut input);
                    }
                    $start(config.cast(), state.cast());
                    if wild & 2 == 2 {
                        scribble(state.cast(), size_of::<Held>(), &mut input);
                    }
                    while input.any() {
                        match input.byte() {
                            0 => $reset(config.cast(), state.cast()),
                            1 => $estimate(state.cast(), out.cast()),
                            2 => $start(core::ptr::null(), state.cast()),
                            3 => assert_eq!($step(config.cast(), core::ptr::null_mut(), 1.0, 1.0), 0.0),
                            4 => $estimate(core::ptr::null(), out.cast()),
                            _ => {
                                let (value, dt) = (input.number() as $type, input.time_step(0.02) as $type);
                                let rate = $step(config.cast(), state.cast(), value, dt);
                                assert!(rate.is_finite() || wild & 3 != 0);
                            }
                        }
                    }
                    drop(Box::from_raw(config));
                    drop(Box::from_raw(state));
                    drop(Box::from_raw(out));
                }
            }
        }
    };
}

include!("../../crates/stillrate-c/abi/src/functions.rs");

/// Changes some of the bytes.
///
/// # Safety
/// `block` points to `size` bytes whose every value is valid.
unsafe fn scribble(block: *mut u8, size: usize, input: &mut Input<'_>) {
    for _ in 0..input.byte() {
        let at = usize::from(u16::from_le_bytes(input.bytes())) % size;
        // SAFETY: inside the block.
        unsafe { *block.add(at) = input.byte() };
    }
}

macro_rules! one_of {
    ($($name:ident),* $(,)?) => {
        fuzz_target!(|bytes: &[u8]| {
            let mut input = Input(bytes);
            let drives: &[fn(Input<'_>)] = &[$(
                Case::<stillrate::filters::$name, f32>::drive,
                Case::<stillrate::filters::$name, f64>::drive,
            )*];
            let chosen = drives[input.choice(drives.len())];
            chosen(input);
        });
    };
}
stillrate::methods!(one_of);
