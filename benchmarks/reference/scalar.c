/* One run at a time, as a C programmer would write it: doubles, branches where convenient, libm. */
#define _GNU_SOURCE
#include <math.h>
#include "layout.h"

typedef const double *PARAMETERS;
#define T double
#define MASK int
#define INDEX long
#define SET(x) (x)
#define SELECT(c, a, b) ((c) ? (a) : (b))
#define SINCOS(x, s, c) sincos(x, s, c)
#define EXP exp
#define ATAN atan
#define ROUND rint
#define LOOKUP(table, i) ((table)[i])
#define FLOOR_INDEX(x) ((long)(x))
#define FROM_INDEX(i) ((double)(i))
#define LOAD_PARAMETER(p, i) ((p)[i])
#include "closed_loop.h"

/* state: 9 doubles, tally: 19 doubles, record: 25 doubles a step or null. Returns the steps made. */
int run(double *state, double *tally, const double *parameters, const double *table, int steps, double h, double *record)
{
    State s;
    Tally y;
    memcpy(&s, state, sizeof s);
    memcpy(&y, tally, sizeof y);
    int n = 0;
    for (; n < steps; n++) {
        step_once(n * h, h, n ? h : 0.0, &s, &y, parameters, table, record ? record + 25L * n : 0);
        double size = fabs(s.speed);
        if (!(size <= parameters[P_speed_limit]) || !isfinite(s.x + s.y + s.heading + s.yaw_rate + s.memory)) break;
        if (s.arc >= parameters[P_finish]) break;
    }
    memcpy(state, &s, sizeof s);
    memcpy(tally, &y, sizeof y);
    return n;
}

/* Many runs one after the other: columns of state[9][lanes] and so on, as the vector version has them. */
void run_many(double *state, double *tally, const double *parameters, const double *table, int steps, double h, int lanes)
{
    for (int lane = 0; lane < lanes; lane++) {
        double s[9], y[19], p[PARAMETERS_COUNT];
        for (int i = 0; i < 9; i++) s[i] = state[i * lanes + lane];
        for (int i = 0; i < 19; i++) y[i] = tally[i * lanes + lane];
        for (int i = 0; i < PARAMETERS_COUNT; i++) p[i] = parameters[i * lanes + lane];
        run(s, y, p, table, steps, h, 0);
        for (int i = 0; i < 9; i++) state[i * lanes + lane] = s[i];
        for (int i = 0; i < 19; i++) tally[i * lanes + lane] = y[i];
    }
}
