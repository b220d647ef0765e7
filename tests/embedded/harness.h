/* A filter that does nothing, in REAL: what making the log and summing the output take by themselves. */
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct { REAL period_s; } JOIN(FILTER, _config);
typedef struct { struct { uint32_t flags; } last; } JOIN(FILTER, _state);

static const JOIN(FILTER, _config) STILLRATE_CONFIG = {(REAL)0.02};

__attribute__((noinline)) static void JOIN(FILTER, _start)(const JOIN(FILTER, _config) * config, JOIN(FILTER, _state) * state) {
    (void)config;
    state->last.flags = 0;
}

__attribute__((noinline)) static REAL JOIN(FILTER, _step)(const JOIN(FILTER, _config) * config, JOIN(FILTER, _state) * state, REAL value, REAL dt) {
    __asm__ volatile("" : : "r"(config), "r"(state) : "memory");
    (void)dt;
    return value;
}

static int stillrate_selftest(JOIN(FILTER, _state) * state) { (void)state; return 0; }
