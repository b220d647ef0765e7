/* The two things of math.h and string.h that a firmware without a C library needs. */
#define NAN __builtin_nanf("")
