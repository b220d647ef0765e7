//! The C functions of stillrate: start, step, estimate and reset of every filter, in f32 and f64.
//!
//! Configuration and state are the core's own `repr(C)` structs; `stillrate.h` declares them for C. A null pointer does
//! nothing and gives 0. No allocation, no global state, no panic: the panic handler below is never linked in, which the
//! tests prove by looking for it.
#![no_std]

use core::panic::PanicInfo;
use stillrate::{Estimate, Filter, Sample, Settings};

/// State of a filter as C holds it: the filter's own, and what the last step found.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct State<S, T> {
    filter: S,
    last: Estimate<T>,
}

#[panic_handler]
fn never(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        /// Defined nowhere: a program in which a panic could be reached does not link.
        fn stillrate_a_step_can_panic() -> !;
    }
    // SAFETY: never linked.
    unsafe { stillrate_a_step_can_panic() }
}

macro_rules! functions {
    ($settings:ident $type:ty; $start:ident $step:ident $estimate:ident $reset:ident) => {
        const _: () = {
            type Config = <stillrate::filters::$settings as Settings>::Filter<$type>;
            type Held = State<<Config as Filter<$type>>::State, $type>;

            fn begin(config: &Config) -> Held {
                let last = Estimate { flags: stillrate::Flags::NO_DATA_YET, ..Estimate::default() };
                State { filter: config.start(), last }
            }

            /// # Safety
            /// Pointers are null or point to properly aligned structs; `config` was initialised.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $start(config: *const Config, state: *mut Held) {
                // SAFETY: the caller's promise.
                if let (Some(config), false) = (unsafe { config.as_ref() }, state.is_null()) {
                    // SAFETY: the caller's promise; what was there before is not read.
                    unsafe { state.write(begin(config)) };
                }
            }

            /// # Safety
            /// Pointers are null or point to properly aligned structs; `config` was initialised.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $reset(config: *const Config, state: *mut Held) {
                // SAFETY: the caller's promise.
                unsafe { $start(config, state) };
            }

            /// # Safety
            /// Pointers are null or point to properly aligned, initialised structs.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $step(config: *const Config, state: *mut Held, value: $type, dt_s: $type) -> $type {
                // SAFETY: the caller's promise.
                let (Some(config), Some(state)) = (unsafe { config.as_ref() }, unsafe { state.as_mut() }) else {
                    return 0.0;
                };
                state.last = config.step(&mut state.filter, Sample { value, dt: dt_s });
                state.last.rate
            }

            /// # Safety
            /// Pointers are null or point to properly aligned structs; `state` was initialised.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $estimate(state: *const Held, out: *mut Estimate<$type>) {
                // SAFETY: the caller's promise.
                if let (Some(state), false) = (unsafe { state.as_ref() }, out.is_null()) {
                    // SAFETY: the caller's promise.
                    unsafe { out.write(state.last) };
                }
            }
        };
    };
}

include!("functions.rs");
