/* The paper's continuous closed loop, once, for one run (T = double) or a vector of runs.

   The including file defines T, MASK and the primitives SET, SELECT, AND, SINCOS, EXP, ATAN, LOOKUP,
   FLOOR_INDEX and INDEX, and includes "layout.h", which numbers the parameters P_... as the package
   stores them. The work per step is that of the package's engine: one row of the record, one tally,
   one step of RK4 over plant, disturbance, target and law together. */

#include <math.h>
#include <string.h>

typedef struct { T x, y, heading, speed, yaw_rate, drift, arc, theta, memory; } State;
typedef struct { T samples, foot, cross, angle, steer, cross2, crossmax, angle2, anglemax, steermax,
                 ratemax, leftmax, rightmax, speedmax, steered, rippled, torque, counted, energy; } Tally;
typedef struct { T v, v_drift, v_slave, w, w_drift, w_slave, k; } Reference;
typedef struct { T steer, left, right, e_heading, e_rate, e_speed, seen; Reference ref; State rate; } Response;

#define PAR(name) LOAD_PARAMETER(p, P_##name)
#define ABS(x) SELECT((x) < SET(0.0), -(x), (x))
#define LARGER(a, b) SELECT((a) > (b), (a), (b))

static inline __attribute__((always_inline)) T column(const double *table, INDEX row, T f, T step, T density, int value, int slope, int columns, T *rate)
{
    T y0 = LOOKUP(table, row + value), m0 = LOOKUP(table, row + slope);
    T y1 = LOOKUP(table, row + value + columns), m1 = LOOKUP(table, row + slope + columns);
    T rise = y1 - y0, first = m0 * step, last = m1 * step;
    T b = 3.0 * rise - 2.0 * first - last, c = first + last - 2.0 * rise;
    if (rate) *rate = (first + f * (2.0 * b + f * (3.0 * c))) * density;
    return y0 + f * (first + f * (b + f * c));
}

static inline __attribute__((always_inline)) INDEX locate(T s, PARAMETERS p, T *fraction)
{
    T u = (s - PAR(curve_grid_start)) * PAR(curve_grid_density);
    u = SELECT(u > SET(0.0), u, SET(0.0));
    T inside = SELECT(u < PAR(curve_grid_last), u, PAR(curve_grid_last));
    INDEX cell = FLOOR_INDEX(inside);
    T f = u - FROM_INDEX(cell);
    *fraction = SELECT(f < SET(3.0), f, SET(3.0));
    return FLOOR_INDEX(PAR(curve_grid_offset)) + cell * 7;
}

static inline __attribute__((always_inline)) Response respond(double t, const State *s, PARAMETERS p, const double *table)
{
    Response out;
    /* profile, eq. (23) */
    T x = PAR(pace_decay) * t, fading = EXP(-x);
    T pace = PAR(pace_amplitude) * PAR(pace_decay) * x * fading;
    T pace_rate = PAR(pace_amplitude) * PAR(pace_decay) * PAR(pace_decay) * (1.0 - x) * fading;
    /* modified target, eq. (25) */
    T f, dk;
    INDEX row = locate(s->arc, p, &f);
    T k = column(table, row, f, PAR(curve_grid_step), PAR(curve_grid_density), 5, 6, 7, &dk);
    T radius = 1.0 / SELECT(k != SET(0.0), k, SET(1.0));
    out.ref = (Reference){s->yaw_rate * radius, -dk * s->speed * s->yaw_rate * (radius * radius), radius,
                          pace, pace_rate, SET(0.0), k};
    /* law, eqs (34)-(42) */
    out.seen = s->heading + s->drift;
    out.e_heading = out.seen - s->theta;
    out.e_rate = s->yaw_rate - pace;
    out.e_speed = s->speed - out.ref.v;
    T feedback = -(PAR(control_heading_gain) * out.e_heading + PAR(control_rate_gain) * out.e_rate);
    T ahead = PAR(control_preview_rate) * pace + PAR(control_preview_acceleration) * pace_rate;
    T yaw_acceleration = PAR(control_model_yaw_gain) * (feedback + ahead);
    T difference = yaw_acceleration * PAR(control_model_differential);
    MASK moving = s->speed != SET(0.0);
    T curvature = SELECT(moving, s->yaw_rate / SELECT(moving, s->speed, SET(1.0)), PAR(control_at_rest));
    T target_rate = out.ref.v_drift + out.ref.v_slave * yaw_acceleration;
    T wanted = target_rate - PAR(control_speed_gain) * out.e_speed;
    T inertia = PAR(control_model_drive_inertia)
              + (PAR(control_model_turn_inertia) - PAR(control_model_coupling)) * curvature * curvature;
    T torque = (wanted * inertia + PAR(control_model_coupling) * curvature * yaw_acceleration)
             * PAR(control_model_traction);
    T sliding = s->speed - PAR(control_initial_speed) - s->memory;
    T sign = SELECT(sliding > SET(0.0), SET(1.0), SET(0.0)) - SELECT(sliding < SET(0.0), SET(1.0), SET(0.0));
    torque = torque - (PAR(control_switching) + PAR(control_uncertainty) * ABS(out.e_speed)) * sign;
    out.steer = ATAN(PAR(control_model_wheelbase) * curvature);
    out.left = 0.5 * (torque - difference);
    out.right = 0.5 * (torque + difference);
    /* disturbance */
    T wave, quarter;
    SINCOS(PAR(disturbance_frequency) * t, &wave, &quarter);
    double slow = sin(t);
    T heading = PAR(disturbance_heading_feedback) * out.e_heading + PAR(disturbance_heading_amplitude) * wave;
    T push = PAR(disturbance_speed_amplitude) * slow + PAR(disturbance_speed_feedback) * out.e_speed;
    T turn = PAR(disturbance_yaw_rate_feedback) * out.e_rate + PAR(disturbance_yaw_rate_amplitude) * quarter;
    /* plant, eq. (16) */
    T sine, cosine;
    SINCOS(s->heading, &sine, &cosine);
    T actual = PAR(plant_model_yaw_gain) * (out.right - out.left) + turn;
    T bend = SELECT(moving, s->yaw_rate / SELECT(moving, s->speed, SET(1.0)), PAR(plant_at_rest));
    T weight = PAR(plant_model_drive_inertia)
             + (PAR(plant_model_turn_inertia) - PAR(plant_model_coupling)) * bend * bend;
    T drive = PAR(plant_model_wheel_radius) * (out.left + out.right) - PAR(plant_model_coupling) * bend * actual;
    out.rate = (State){s->speed * cosine, s->speed * sine, s->yaw_rate + PAR(disturbance_turns_robot) * heading,
                       drive / weight + push, actual, (1.0 - PAR(disturbance_turns_robot)) * heading,
                       s->speed, pace, target_rate};
    return out;
}

static inline __attribute__((always_inline)) State moved(double h, const State *rate, const State *s)
{
    return (State){s->x + h * rate->x, s->y + h * rate->y, s->heading + h * rate->heading,
                   s->speed + h * rate->speed, s->yaw_rate + h * rate->yaw_rate, s->drift + h * rate->drift,
                   s->arc + h * rate->arc, s->theta + h * rate->theta, s->memory + h * rate->memory};
}

static inline __attribute__((always_inline)) Tally count(double elapsed, const State *s, const Response *r, T steer, Tally y, PARAMETERS p, const double *table)
{
    T guess = y.foot + elapsed * s->speed, f, dk, ignored, length = PAR(curve_length);
    guess = SELECT(guess > SET(0.0), guess, SET(0.0));
    guess = SELECT(guess < length, guess, length);
    INDEX row = locate(guess, p, &f);
    T step = PAR(curve_grid_step), density = PAR(curve_grid_density);
    T px = column(table, row, f, step, density, 0, 2, 7, 0), py = column(table, row, f, step, density, 1, 3, 7, 0);
    T ph = column(table, row, f, step, density, 4, 5, 7, 0);
    T pk = column(table, row, f, step, density, 5, 6, 7, &dk);
    T sine, cosine;
    SINCOS(ph, &sine, &cosine);
    T dx = s->x - px, dy = s->y - py, along = dx * cosine + dy * sine, aside = dy * cosine - dx * sine;
    T slack = 1.0 - pk * aside, shift = along / SELECT(slack > SET(0.1), slack, SET(0.1));
    T cross = aside - 0.5 * pk * shift * along;
    T raw = s->heading - ph - pk * shift;
    T angle = raw - ROUND(raw * 0.15915494309189535) * 6.283185307179586;
    T change = ABS(steer - y.steer) * (elapsed > 0.0 ? 1.0 / elapsed : 0.0);
    (void)ignored; (void)dk;
    T moved_by = ABS(steer - y.steer), total = r->left + r->right;
    MASK counts = guess >= PAR(settled);
    T off = SELECT(counts, cross, SET(0.0)), turned = SELECT(counts, angle, SET(0.0));
    return (Tally){y.samples + 1.0, guess + shift, cross, angle, steer, y.cross2 + off * off,
                   LARGER(ABS(off), y.crossmax), y.angle2 + turned * turned, LARGER(ABS(turned), y.anglemax),
                   LARGER(ABS(steer), y.steermax), LARGER(change, y.ratemax), LARGER(ABS(r->left), y.leftmax),
                   LARGER(ABS(r->right), y.rightmax), LARGER(ABS(s->speed), y.speedmax),
                   y.steered + (elapsed > 0.0 ? moved_by : SET(0.0)), y.rippled + ABS(total - y.torque), total,
                   y.counted + SELECT(counts, SET(1.0), SET(0.0)),
                   y.energy + elapsed * ABS(total * s->speed) * PAR(plant_model_traction)};
}

static inline __attribute__((always_inline)) T steering(const State *s, PARAMETERS p)
{
    MASK moving = s->speed != SET(0.0);
    T curvature = SELECT(moving, s->yaw_rate / SELECT(moving, s->speed, SET(1.0)), PAR(plant_at_rest));
    return ATAN(PAR(plant_model_wheelbase) * curvature);
}

/* One step: fills a row of the record if there is one, counts, and moves on. */
static inline __attribute__((always_inline)) void step_once(double t, double h, double elapsed, State *s, Tally *y, PARAMETERS p, const double *table, T *row)
{
    Response r = respond(t, s, p, table);
    T steer = steering(s, p);
    *y = count(elapsed, s, &r, steer, *y, p, table);
    if (row) {
        T values[25] = {SET(t), s->x, s->y, s->heading, s->speed, s->yaw_rate, steer, r.ref.v, r.ref.v_drift, r.ref.v_slave,
                        r.ref.w, r.ref.w_drift, r.ref.w_slave, r.ref.k, s->theta, r.steer, r.left, r.right, r.e_heading,
                        r.e_rate, r.e_speed, s->arc, y->foot, y->cross, y->angle};
        memcpy(row, values, sizeof values);
    }
    State s2 = moved(0.5 * h, &r.rate, s);
    Response r2 = respond(t + 0.5 * h, &s2, p, table);
    State s3 = moved(0.5 * h, &r2.rate, s);
    Response r3 = respond(t + 0.5 * h, &s3, p, table);
    State s4 = moved(h, &r3.rate, s);
    Response r4 = respond(t + h, &s4, p, table);
    State total = moved(1.0, &r4.rate, &r.rate);
    total = moved(2.0, &r2.rate, &total);
    total = moved(2.0, &r3.rate, &total);
    *s = moved(h / 6.0, &total, s);
}
