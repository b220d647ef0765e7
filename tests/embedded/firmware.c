/* The run on a Cortex-M under the emulator: bits, instructions a step (SysTick, 40 instructions a tick at -icount shift=0), stack. */
#include <stddef.h>
#include "unit.h"
#include "units.h"

extern uint32_t stack_top, stack_bottom, bss_start, bss_end;
#define REG(address) (*(volatile uint32_t *)(address))

void *memcpy(void *to, const void *from, size_t n) { char *t = to; const char *f = from; while (n--) *t++ = *f++; return to; }
void *memmove(void *to, const void *from, size_t n) {
    char *t = to; const char *f = from;
    if (t < f) while (n--) *t++ = *f++; else while (n--) t[n] = f[n];
    return to;
}
void *memset(void *to, int value, size_t n) { char *t = to; while (n--) *t++ = (char)value; return to; }
int memcmp(const void *a, const void *b, size_t n) {
    const unsigned char *x = a, *y = b;
    for (; n--; ++x, ++y) if (*x != *y) return *x - *y;
    return 0;
}

static void host(uint32_t call, const void *argument) {
    register uint32_t r0 __asm__("r0") = call;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}
static void text(const char *line) { host(4, line); }
static void number(uint32_t value, uint32_t base, int digits) {
    char buffer[12]; int at = 11; buffer[at] = 0;
    do { buffer[--at] = "0123456789abcdef"[value % base]; value /= base; } while (value || 11 - at < digits);
    text(" "); text(buffer + at);
}

void main_loop(void) {
    REG(0xE000ED88) |= 0xF00000; /* floating-point unit on */
    __asm__ volatile("dsb; isb");
    for (uint32_t *p = &bss_start; p < &bss_end; ++p) *p = 0;
    for (unsigned i = 0; i < sizeof UNITS / sizeof *UNITS; ++i) {
        const struct unit *unit = UNITS[i];
        const int wrong = unit->self_test();
        unit->start();
        uint32_t *low = &stack_bottom, *here;
        __asm__ volatile("mov %0, sp" : "=r"(here));
        for (uint32_t *p = low; p < here - 16; ++p) *p = 0xa5a5a5a5;
        REG(0xE000E014) = 0xffffff; REG(0xE000E018) = 0; REG(0xE000E010) = 5;
        struct sums sums = {FIRST_SUM, FIRST_SUM, 0};
        uint32_t ticks = 0;
        for (uint32_t k = 0; k < SAMPLES; k += 64) {
            const uint32_t before = REG(0xE000E018);
            unit->steps(k, 64, &sums);
            ticks += (before - REG(0xE000E018)) & 0xffffff;
        }
        while (*low == 0xa5a5a5a5) ++low;
        text(unit->name); number((uint32_t)wrong, 10, 1); number(sums.rates, 16, 8); number(sums.flags, 16, 8); text(" |");
        number(ticks * 40u / SAMPLES, 10, 1); number((uint32_t)((char *)sums.called_at - (char *)low), 10, 1);
        number(unit->config_bytes, 10, 1); number(unit->state_bytes, 10, 1); text("\n");
    }
    host(0x18, (void *)0x20026);
    for (;;) {}
}

__attribute__((noreturn)) static void fault(void) { text("fault\n"); host(0x18, (void *)0x20023); for (;;) {} }
__attribute__((section(".vectors"), used)) static const void *const VECTORS[16] = {
    &stack_top, (void *)main_loop, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault};
