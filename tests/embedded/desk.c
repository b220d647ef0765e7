/* The same run on the desk. */
#include <stdio.h>
#include "unit.h"
#include "units.h"

int main(void) {
    for (unsigned i = 0; i < sizeof UNITS / sizeof *UNITS; ++i) {
        const struct unit *unit = UNITS[i];
        const int wrong = unit->self_test();
        unit->start();
        printf("%s %d %08x\n", unit->name, wrong, (unsigned)unit->steps(0, 10000, 2166136261u));
    }
    return 0;
}
