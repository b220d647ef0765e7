// The C functions of one method. A file of its own, so that they can also be compiled where there is a standard library.

/// State of a filter as C holds it: the filter's own, and what the last step found.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct State<S, T> {
    filter: S,
    last: Estimate<T>,
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
