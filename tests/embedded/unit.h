/* What the main program knows of a configuration under test. */
#ifndef UNIT_H
#define UNIT_H
#include <stdint.h>

#define SAMPLES 10240u
#define FIRST_SUM 2166136261u

struct sums {
    uint32_t rates, flags; /* FNV-1a over the bytes of all rates, and over the flags */
    uint32_t *called_at;   /* the stack where the step is called */
};

struct unit {
    const char *name;
    uint32_t config_bytes, state_bytes;
    int (*self_test)(void);
    void (*start)(void);
    void (*steps)(uint32_t from, uint32_t count, struct sums *sums);
};

#endif
