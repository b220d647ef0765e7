/* What the main program knows of a configuration under test. */
#ifndef UNIT_H
#define UNIT_H
#include <stdint.h>

struct unit {
    const char *name;
    uint32_t config_bytes, state_bytes;
    int (*self_test)(void);
    void (*start)(void);
    uint32_t (*steps)(uint32_t from, uint32_t count, uint32_t sum);
};

#endif
