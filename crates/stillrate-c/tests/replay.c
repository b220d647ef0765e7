/* Runs the self-test of an exported configuration, then replays a log: pairs of value and time step from standard input,
 * filtered rate and flags to standard output. FILTER and REAL come from the command line. */
#include <stdio.h>

#include "stillrate_selftest.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

static JOIN(FILTER, _state) state;

int main(void) {
    REAL sample[2];
    const int wrong = stillrate_selftest(&state);
    if (wrong != 0) {
        fprintf(stderr, "self-test: sample %d differs\n", wrong - 1);
        return 1;
    }
    JOIN(FILTER, _start)(&STILLRATE_CONFIG, &state);
    while (fread(sample, sizeof sample, 1, stdin) == 1) {
        const REAL rate = JOIN(FILTER, _step)(&STILLRATE_CONFIG, &state, sample[0], sample[1]);
        if (fwrite(&rate, sizeof rate, 1, stdout) != 1 || fwrite(&state.last.flags, 4, 1, stdout) != 1) {
            return 2;
        }
    }
    return 0;
}
