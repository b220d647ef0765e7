/* Checks the exported filter, then cleans rates from standard input, one a line. */
#include <stdio.h>

#include "stillrate_selftest.h"

static STATE state;

int main(void) {
    double value;
    if (stillrate_selftest(&state) != 0) {
        fprintf(stderr, "the filter does not compute what it did on the desk\n");
        return 1;
    }
    while (scanf("%lf", &value) == 1) {
        printf("%.9g\n", (double)STEP(&STILLRATE_CONFIG, &state, (REAL)value, STILLRATE_CONFIG.period_s));
    }
    return 0;
}
