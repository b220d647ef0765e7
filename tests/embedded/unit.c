/* One exported configuration: its self-test, then a log of 10 000 samples of which every output bit enters a sum.
 * FILTER and REAL come from the command line. */
#include "stillrate_selftest.h"
#include "unit.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)

static JOIN(FILTER, _state) state;

static int self_test(void) { return stillrate_selftest(&state); }

static void start(void) { JOIN(FILTER, _start)(&STILLRATE_CONFIG, &state); }

/* Motion, noise, missing and repeated samples from integers alone: the same numbers everywhere. */
static uint32_t steps(uint32_t from, uint32_t count, uint32_t sum) {
    const REAL period = STILLRATE_CONFIG.UNIT_PERIOD;
    for (uint32_t k = from; k < from + count; ++k) {
        uint32_t bits = (k + 1u) * 2654435761u;
        bits ^= bits >> 15;
        REAL value = (REAL)((int32_t)(bits & 1023u) - 512) / (REAL)1024;
        value += (k / 512u) % 2u ? (REAL)(k % 512u) * (REAL)0.125 : (REAL)0;
        if (k % 509u == 300u) value = NAN;
        const REAL dt = k % 701u == 400u ? (REAL)0 : k % 811u == 500u ? (REAL)2.5 * period : period;
        const REAL rate = JOIN(FILTER, _step)(&STILLRATE_CONFIG, &state, value, dt);
        unsigned char bytes[sizeof rate];
        memcpy(bytes, &rate, sizeof rate);
        for (unsigned i = 0; i < sizeof rate; ++i) sum = (sum ^ bytes[i]) * 16777619u;
        sum = (sum ^ state.last.flags) * 16777619u;
    }
    return sum;
}

const struct unit JOIN(FILTER, _unit) = {TEXT(FILTER), sizeof(JOIN(FILTER, _config)), sizeof(JOIN(FILTER, _state)), self_test, start, steps};
