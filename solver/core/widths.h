/* The header LANES for every width of lanes: one, two, and those that some processors have. FOR_WIDTH is a function of the
   header for one of them. */

#define TARGET
#define W 1
#define SUFFIX _1
#include LANES
#define W 2
#define SUFFIX _2
#include LANES
#undef TARGET
#if defined(__x86_64__)
#define TARGET __attribute__((target("avx2")))
#define W 4
#define SUFFIX _4
#include LANES
#undef TARGET
#define TARGET __attribute__((target("avx512f,avx512dq")))
#define W 8
#define SUFFIX _8
#include LANES
#undef TARGET
#define FOR_WIDTH(w, name) ((w) == 8 ? name##_8 : (w) == 4 ? name##_4 : (w) == 1 ? name##_1 : name##_2)
#else
#define FOR_WIDTH(w, name) ((w) == 1 ? name##_1 : name##_2)
#endif
