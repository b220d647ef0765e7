/* See math.h. */
#include <stddef.h>
void *memcpy(void *to, const void *from, size_t count);
int memcmp(const void *first, const void *second, size_t count);
