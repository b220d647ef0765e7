/* One exported configuration: its self-test, then a log of 10 240 samples of which every output bit enters a sum. The same log
 * goes through Rust (crates/stillrate-c/tests/c_abi.rs) and Python (tests/test_same_bits.py); `bits.txt` holds what all of them
 * must find. FILTER, REAL and the NAME of the configuration come from the command line. */
#include "unit.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)

#ifdef HARNESS
#include "harness.h"
#else
#include "stillrate_selftest.h"
#endif

static JOIN(FILTER, _state) state;

static int self_test(void) { return stillrate_selftest(&state); }

static void start(void) { JOIN(FILTER, _start)(&STILLRATE_CONFIG, &state); }

/* Motion, noise, missing samples, spikes, repeated stamps and gaps from integers alone: the same numbers everywhere. */
static void steps(uint32_t from, uint32_t count, struct sums *sums) {
    const REAL period = STILLRATE_CONFIG.UNIT_PERIOD;
#ifdef __arm__
    __asm__ volatile("mov %0, sp" : "=r"(sums->called_at));
#endif
    for (uint32_t k = from; k < from + count; ++k) {
        uint32_t bits = (k + 1u) * 2654435761u;
        bits ^= bits >> 15;
        REAL value = (REAL)((int32_t)(bits & 1023u) - 512) / (REAL)1024;
        value += (k / 512u) % 2u ? (REAL)(k % 512u) * (REAL)0.125 : (REAL)0;
        if (k % 509u == 300u) value = NAN;
        if (k % 1531u == 1000u) value = (REAL)16384;
        const REAL dt = k % 701u == 400u ? (REAL)0 : k % 811u == 500u ? (REAL)2.5 * period : k == 7000u ? (REAL)11 : period;
        const REAL rate = JOIN(FILTER, _step)(&STILLRATE_CONFIG, &state, value, dt);
        unsigned char bytes[sizeof rate];
        memcpy(bytes, &rate, sizeof rate);
        for (unsigned i = 0; i < sizeof rate; ++i) sums->rates = (sums->rates ^ bytes[i]) * 16777619u;
        sums->flags = (sums->flags ^ state.last.flags) * 16777619u;
    }
}

const struct unit JOIN(NAME, _unit) = {TEXT(NAME), sizeof(JOIN(FILTER, _config)), sizeof(JOIN(FILTER, _state)), self_test, start, steps};
