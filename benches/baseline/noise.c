/* Phase noise as a plain program would have it: one hold interval after the other, ziggurat samples, the mathematical
   library's cosine, Eq. (11) at the end of each interval that ends beyond a membrane. What is constant stands outside
   of the loop. One version takes Runge-Kutta steps with three cosines each, as the paper's program would; the other,
   which is leaner, the closed form of each interval, with one sine and cosine. */

#include <math.h>
#include <stdint.h>

struct parameters {
    double cylinder_mass, amplitude, omega, phase, phase_noise, hold, restitution, half_travel;
    double cylinder_position, cylinder_velocity, ball_position, ball_velocity;
    /* U_DE4 - U_in, V, of an impact with this speed, m/s. */
    double (*gain)(const void *membrane, double speed);
    const void *membrane;
    uint64_t seed, steps;
};

/* Generator xoshiro256+ of Blackman and Vigna, seeded by splitmix64. */
static uint64_t state[4];

static inline uint64_t rotate(uint64_t x, int k) { return x << k | x >> (64 - k); }

static inline uint64_t next(void) {
    uint64_t result = state[0] + state[3], t = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= t;
    state[3] = rotate(state[3], 45);
    return result;
}

static void seed(uint64_t x) {
    for (int i = 0; i < 4; i++) {
        uint64_t z = x += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        state[i] = z ^ z >> 31;
    }
}

static inline double uniform(void) { return ((double)(next() >> 11) + 0.5) * 0x1p-53; }

/* Ziggurat of Marsaglia and Tsang with 256 layers of equal area under exp(-x^2 / 2); x[i] and y[i] are the corners of
   the layers, from the tail inwards. */
enum { LAYERS = 256 };
static const double TAIL = 3.6541528853610088, AREA = 0.00492867323399;
static double x[LAYERS + 1], y[LAYERS + 1];

static void build_layers(void) {
    x[0] = AREA / exp(-0.5 * TAIL * TAIL);
    x[1] = TAIL;
    for (int i = 2; i < LAYERS; i++)
        x[i] = sqrt(-2.0 * log(AREA / x[i - 1] + exp(-0.5 * x[i - 1] * x[i - 1])));
    x[LAYERS] = 0.0;
    for (int i = 0; i <= LAYERS; i++)
        y[i] = exp(-0.5 * x[i] * x[i]);
}

static double tail(int negative) {
    double far, exponential;
    do {
        far = -log(uniform()) / TAIL;
        exponential = -log(uniform());
    } while (2.0 * exponential < far * far);
    return negative ? -TAIL - far : TAIL + far;
}

static inline double normal(void) {
    for (;;) {
        uint64_t bits = next();
        int i = bits >> 3 & (LAYERS - 1);
        double u = (double)((int64_t)bits >> 11) * 0x1p-52, sample = u * x[i];
        if (fabs(sample) < x[i + 1])
            return sample;
        if (i == 0)
            return tail(u < 0.0);
        if (y[i] + uniform() * (y[i + 1] - y[i]) < exp(-0.5 * sample * sample))
            return sample;
    }
}

void noise_samples(uint64_t from, uint64_t count, double *samples) {
    build_layers();
    seed(from);
    for (uint64_t n = 0; n < count; n++)
        samples[n] = normal();
}

enum method { RUNGE_KUTTA, CLOSED_FORM };

/* Sum of U_DE4 - U_in, V, over the run. `method` is known where this is called: no step asks for it. */
static inline double run(const struct parameters *p, enum method method) {
    build_layers();
    seed(p->seed);
    /* Copies, since the compiler must take it that p->gain may change what p points to. */
    const uint64_t steps = p->steps;
    const double h = p->hold, omega = p->omega, phase = p->phase, noise = p->phase_noise, half = p->half_travel;
    const double x = 0.5 * omega * h, restitution = p->restitution;
    const double acceleration = p->amplitude / p->cylinder_mass, swing = acceleration / (omega * omega);
    const double push = 2.0 * swing * omega * sin(x);
    const double shift = swing * omega * h * sin(x), lag = 2.0 * swing * (sin(x) - x * cos(x));
    double position = p->cylinder_position, velocity = p->cylinder_velocity;
    double ball = p->ball_position, ball_velocity = p->ball_velocity, gain = 0.0;
    for (uint64_t n = 0; n < steps; n++) {
        double angle = omega * ((double)n * h) + phase + noise * normal();
        if (method == RUNGE_KUTTA) {
            /* A new phase in each step leaves no value of the force to share with the next one. */
            double a = cos(angle), b = cos(angle + x), c = cos(angle + 2.0 * x);
            position += h * velocity + acceleration * h * h / 6.0 * (a + 2.0 * b);
            velocity += acceleration * h / 6.0 * (a + 4.0 * b + c);
        } else {
            double a = cos(angle + x), b = sin(angle + x);
            position += h * velocity + shift * a + lag * b;
            velocity += push * a;
        }
        ball += h * ball_velocity;
        double dz = position - ball, approach = velocity - ball_velocity;
        if (fabs(dz) >= half && dz * approach > 0.0) {
            gain += p->gain(p->membrane, fabs(approach));
            ball_velocity = (1.0 + restitution) * velocity - restitution * ball_velocity;
        }
    }
    return gain;
}

/* The paper's Runge-Kutta method with the hold time as step. */
double noise_runge_kutta(const struct parameters *p) { return run(p, RUNGE_KUTTA); }

/* The closed form of a hold interval, the angle taken in its middle: one sine and cosine each. */
double noise_closed_form(const struct parameters *p) { return run(p, CLOSED_FORM); }
