// What a panic would run: it calls a function that is defined nowhere, so that a program in which a panic can be reached
// does not link. A file of its own, so that the tests can show that it catches one.

#[panic_handler]
fn never(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        /// Defined nowhere: a program in which a panic could be reached does not link.
        fn stillrate_a_step_can_panic() -> !;
    }
    // SAFETY: never linked.
    unsafe { stillrate_a_step_can_panic() }
}
