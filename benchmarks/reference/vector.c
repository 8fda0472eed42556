/* Hand-vectorised: WIDTH runs in one register, polynomial sine, exponential and arc tangent, gathers.

   Each group of runs goes from start to end with its state in registers, the way one would write it. */
#include <immintrin.h>
#include <math.h>
#include <string.h>
#include "layout.h"

#ifdef __AVX512F__
#define WIDTH 8
#define GATHER(table, i) ((T)_mm512_i64gather_pd((__m512i)(i), (table), 8))
#else
#define WIDTH 4
#define GATHER(table, i) ((T){(table)[(i)[0]], (table)[(i)[1]], (table)[(i)[2]], (table)[(i)[3]]})
#endif
typedef double T __attribute__((vector_size(8 * WIDTH)));
typedef long INDEX __attribute__((vector_size(8 * WIDTH)));
typedef INDEX MASK;
typedef struct { const double *first; int lanes; } PARAMETERS;

#define SET(x) ((x) - (T){0})
#define SELECT(c, a, b) blend((MASK)(c), (a), (b))
#define LOOKUP(table, i) GATHER(table, i)
#define FLOOR_INDEX(x) __builtin_convertvector((x), INDEX)
#define FROM_INDEX(i) __builtin_convertvector((i), T)
#define LOAD_PARAMETER(p, i) load((p).first + (long)(i) * (p).lanes)
#define ROUND(x) (((x) + 6755399441055744.0) - 6755399441055744.0)
#define SINCOS sine_cosine
#define EXP exponential
#define ATAN arc_tangent

static inline __attribute__((always_inline)) T load(const double *from) { T x; memcpy(&x, from, sizeof x); return x; }

static inline __attribute__((always_inline)) T blend(MASK c, T a, T b)
{
#ifdef __AVX512F__
    return (T)_mm512_mask_blend_pd(_mm512_movepi64_mask((__m512i)c), (__m512d)b, (__m512d)a);
#else
    return (T)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)c);
#endif
}

static inline __attribute__((always_inline)) void sine_cosine(T x, T *sine, T *cosine)
{
    T shifted = x * 0.6366197723675814 + 6755399441055744.0, q = shifted - 6755399441055744.0;
    INDEX quadrant = (INDEX)shifted;
    T r = ((x - q * 1.57079632673412561417) - q * 6.07710050630396597660e-11) - q * 2.02226624879595063154e-21;
    T z = r * r;
    T s = r + r * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    T c = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03
        + z * (2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09
        + z * -1.13596475577881948265e-11)))));
    MASK odd = (quadrant & 1) != 0;
    T a = blend(odd, c, s), b = blend(odd, s, c);
    *sine = blend((quadrant & 2) != 0, -a, a);
    *cosine = blend(((quadrant + 1) & 2) != 0, -b, b);
}

static inline __attribute__((always_inline)) T exponential(T x)
{
    T shifted = x * 1.4426950408889634 + 6755399441055744.0, q = shifted - 6755399441055744.0;
    T r = (x - q * 6.93147180369123816490e-01) - q * 1.90821492927058770002e-10, sum = SET(1.6059043836821613e-10);
    const double c[] = {2.08767569878681e-09, 2.505210838544172e-08, 2.755731922398589e-07, 2.7557319223985893e-06,
                        2.48015873015873e-05, 1.984126984126984e-04, 1.3888888888888889e-03, 8.333333333333333e-03,
                        4.1666666666666664e-02, 1.6666666666666666e-01, 0.5, 1.0, 1.0};
    for (int i = 0; i < 13; i++) sum = c[i] + r * sum;
    return (T)((INDEX)sum + ((INDEX)shifted << 52));
}

static inline __attribute__((always_inline)) T arc_tangent(T x)
{
    T a = blend(x < SET(0.0), -x, x);
    MASK steep = a > SET(2.414213562373095), middle = a > SET(0.41421356237309503);
    T t = blend(steep, SET(-1.0), blend(middle, a - 1.0, a)) / blend(steep, a, blend(middle, a + 1.0, SET(1.0)));
    T base = blend(steep, SET(1.5707963267948966), blend(middle, SET(0.7853981633974483), SET(0.0)));
    T z = t * t, sum = SET(1.62858201153657823623e-02);
    const double c[] = {-3.65315727442169155270e-02, 4.97687799461593236017e-02, -5.83357013379057348645e-02,
                        6.66107313738753120669e-02, -7.69187620504482999495e-02, 9.09088713343650656196e-02,
                        -1.11111104054623557880e-01, 1.42857142725034663711e-01, -1.99999999998764832476e-01,
                        3.33333333333329318027e-01};
    for (int i = 0; i < 10; i++) sum = c[i] + z * sum;
    T angle = base + (t - t * z * sum);
    return blend(x < SET(0.0), -angle, angle);
}

#include "closed_loop.h"

void run_many(double *state, double *tally, const double *parameters, const double *table, int steps, double h, int lanes)
{
    for (int lane = 0; lane < lanes; lane += WIDTH) {
        T columns[28];
        for (int i = 0; i < 9; i++) columns[i] = load(state + (long)i * lanes + lane);
        for (int i = 0; i < 19; i++) columns[9 + i] = load(tally + (long)i * lanes + lane);
        State s;
        Tally y;
        memcpy(&s, columns, sizeof s);
        memcpy(&y, columns + 9, sizeof y);
        PARAMETERS p = {parameters + lane, lanes};
        MASK ended = {0};
        for (int n = 0; n < steps; n++) {
            State before = s;
            Tally counted = y;
            step_once(n * h, h, n ? h : 0.0, &s, &y, p, table, 0);
            T size = SELECT(s.speed < SET(0.0), -s.speed, s.speed);
            T whole = (s.x + s.y + s.heading + s.yaw_rate + s.memory) * 0.0;
            MASK stop = ended | ~(size <= PAR(speed_limit)) | (whole != SET(0.0)) | (s.arc >= PAR(finish));
            T *now = (T *)&s, *old = (T *)&before;
            for (int i = 0; i < 9; i++) now[i] = blend(ended, old[i], now[i]);
            now = (T *)&y, old = (T *)&counted;
            for (int i = 0; i < 19; i++) now[i] = blend(ended, old[i], now[i]);
            ended = stop;
        }
        memcpy(columns, &s, sizeof s);
        memcpy(columns + 9, &y, sizeof y);
        for (int i = 0; i < 9; i++) memcpy(state + (long)i * lanes + lane, &columns[i], sizeof(T));
        for (int i = 0; i < 19; i++) memcpy(tally + (long)i * lanes + lane, &columns[9 + i], sizeof(T));
    }
}
