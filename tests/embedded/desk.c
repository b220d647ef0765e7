/* The same run on the desk. */
#include <stdio.h>
#include "unit.h"
#include "units.h"

int main(void) {
    for (unsigned i = 0; i < sizeof UNITS / sizeof *UNITS; ++i) {
        const struct unit *unit = UNITS[i];
        const int wrong = unit->self_test();
        unit->start();
        struct sums sums = {FIRST_SUM, FIRST_SUM, 0};
        unit->steps(0, SAMPLES, &sums);
        printf("%s %d %08x %08x\n", unit->name, wrong, (unsigned)sums.rates, (unsigned)sums.flags);
    }
    return 0;
}
