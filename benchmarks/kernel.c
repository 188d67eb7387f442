/* The work of chromanoise's imaging engine, written by hand: the yardstick of its benchmarks.
 *
 * Same sums, same random words (Philox4x32-10), same quantile functions, same table of sRGB; the
 * order of the sums and the use of fused multiply-add are left to the compiler, so bits differ.
 * Rows are taken by threads one batch after the other. Four channels, float32, 16 bands or more.
 */
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <string.h>

enum { P = 4, RUN = 256, LANES = RUN * P, TILE = 2048, BATCH = 8, ENTRIES = 16384 };
/* how far ahead memory is asked for: pixels, numbers into the second cache, and these of a band */
enum { AHEAD = 8, FAR = 8192, FAR_OF_BAND = 768 };
#if defined __AVX512F__
#include <immintrin.h>
enum { W = 16 };
#define lower(a, b) ((wide)_mm512_min_ps((__m512)(a), (__m512)(b)))
#define upper(a, b) ((wide)_mm512_max_ps((__m512)(a), (__m512)(b)))
#elif defined __AVX__
#include <immintrin.h>
enum { W = 8 };
#define lower(a, b) ((wide)_mm256_min_ps((__m256)(a), (__m256)(b)))
#define upper(a, b) ((wide)_mm256_max_ps((__m256)(a), (__m256)(b)))
#else
enum { W = 4 };
typedef int32_t mask __attribute__((vector_size(16)));
#define chosen(m, a, b) ((wide)(((m) & (mask)(a)) | (~(m) & (mask)(b))))
#define lower(a, b) chosen((a) < (b), a, b)
#define upper(a, b) chosen((a) > (b), a, b)
#endif
typedef float wide __attribute__((vector_size(4 * W), aligned(4)));

typedef struct {
    const float *stored; /* the cube */
    int64_t height, width, bands, row_step, pixel_step, band_step;
    const float *weights; /* (P, bands rounded up to 16) */
    const int64_t *tile;  /* of the mosaic */
    int64_t tile_rows, tile_columns;
    float read_noise_e;
    uint64_t key, frame;
    float full_well_e, dn_per_e, black_dn, top_dn;
    const float *matrices; /* (6, P) */
    const uint8_t *table;
    float *electrons;
    uint16_t *codes;
    float *xyz;
    uint8_t *srgb;
    double *counts;  /* (height, 2, P) */
    float *extremes; /* (threads, 2): least and greatest stored number */
    int64_t threads;
    int64_t next; /* row to be taken */
} job;

static inline int64_t padded(int64_t bands) { return (bands + 15) / 16 * 16; }

static inline float folded(wide v) {
    float s = 0;
    for (int j = 0; j < W; j++) s += v[j];
    return s;
}

static inline void ask(const float *x, int64_t bands, int64_t step) {
    for (int64_t b = 0; b < bands; b += 16) {
        __builtin_prefetch(x + AHEAD * step + b);
        __builtin_prefetch(x + FAR + b, 0, 2);
    }
}

/* The last bands are read with some before them, whose weights are 0 the second time. */
static void means_by_pixel(const job *j, const float *x, int64_t n, const float *last,
                           const int64_t *channel, float *mean, wide seen[2]) {
    int64_t bands = j->bands, pitch = padded(bands), whole = bands / W * W;
    wide least = seen[0], most = seen[1];
    for (int64_t i = 0; i < n; i++, x += j->pixel_step) {
        ask(x, bands, j->pixel_step);
        if (channel) {
            const float *w = j->weights + channel[i] * pitch;
            wide sum = {0};
            for (int64_t b = 0; b < whole; b += W) {
                wide v = *(const wide *)(x + b);
                sum += v * *(const wide *)(w + b);
                least = lower(least, v), most = upper(most, v);
            }
            wide v = *(const wide *)(x + bands - W);
            sum += v * *(const wide *)(last + W * channel[i]);
            least = lower(least, v), most = upper(most, v);
            mean[i] = folded(sum);
            continue;
        }
        wide s0 = {0}, s1 = {0}, s2 = {0}, s3 = {0};
        const float *w = j->weights;
        for (int64_t b = 0; b < whole; b += W) {
            wide v = *(const wide *)(x + b);
            s0 += v * *(const wide *)(w + b);
            s1 += v * *(const wide *)(w + pitch + b);
            s2 += v * *(const wide *)(w + 2 * pitch + b);
            s3 += v * *(const wide *)(w + 3 * pitch + b);
            least = lower(least, v), most = upper(most, v);
        }
        wide v = *(const wide *)(x + bands - W);
        s0 += v * *(const wide *)last, s1 += v * *(const wide *)(last + W);
        s2 += v * *(const wide *)(last + 2 * W), s3 += v * *(const wide *)(last + 3 * W);
        least = lower(least, v), most = upper(most, v);
        mean[i] = folded(s0), mean[n + i] = folded(s1);
        mean[2 * n + i] = folded(s2), mean[3 * n + i] = folded(s3);
    }
    seen[0] = least, seen[1] = most;
}

static void means_by_band(const job *j, const float *x, int64_t n, float *restrict mean,
                          float *restrict least, float *restrict most) {
    int64_t pitch = padded(j->bands), step = j->band_step, b = 0;
    const float *w = j->weights;
    memset(mean, 0, sizeof(float) * P * n);
    for (; b + 4 <= j->bands; b += 4, x += 4 * step)
        for (int64_t first = 0; first < n; first += RUN) {
            int64_t stop = first + RUN < n ? first + RUN : n;
            for (int64_t i = first; i < stop; i += 16)
                for (int k = 0; k < 4; k++)
                    __builtin_prefetch(x + k * step + i + FAR_OF_BAND, 0, 2);
            for (int64_t i = first; i < stop; i++) {
                float v0 = x[i], v1 = x[step + i], v2 = x[2 * step + i], v3 = x[3 * step + i];
                for (int c = 0; c < P; c++) {
                    const float *f = w + c * pitch + b;
                    mean[c * n + i] += v0 * f[0] + v1 * f[1] + v2 * f[2] + v3 * f[3];
                }
                float l01 = v0 < v1 ? v0 : v1, l23 = v2 < v3 ? v2 : v3, l = l01 < l23 ? l01 : l23;
                float m01 = v0 > v1 ? v0 : v1, m23 = v2 > v3 ? v2 : v3, m = m01 > m23 ? m01 : m23;
                least[i] = l < least[i] ? l : least[i], most[i] = m > most[i] ? m : most[i];
            }
        }
    for (; b < j->bands; b++, x += step)
        for (int64_t i = 0; i < n; i++) {
            for (int c = 0; c < P; c++) mean[c * n + i] += x[i] * w[c * pitch + b];
            least[i] = x[i] < least[i] ? x[i] : least[i];
            most[i] = x[i] > most[i] ? x[i] : most[i];
        }
}

static inline void philox(uint64_t pixel, uint32_t purpose, uint64_t frame, uint64_t key,
                          uint32_t *w0, uint32_t *w1, uint32_t *w2, uint32_t *w3) {
    uint32_t c0 = (uint32_t)pixel, c1 = (uint32_t)(pixel >> 32) | purpose << 16;
    uint32_t c2 = (uint32_t)frame, c3 = 0;
    uint32_t k0 = (uint32_t)key, k1 = (uint32_t)(key >> 32);
#pragma GCC unroll 10
    for (int r = 0; r < 10; r++) {
        uint64_t a = (uint64_t)c0 * 0xD2511F53u, b = (uint64_t)c2 * 0xCD9E8D57u;
        c0 = (uint32_t)(b >> 32) ^ c1 ^ k0, c1 = (uint32_t)b;
        c2 = (uint32_t)(a >> 32) ^ c3 ^ k1, c3 = (uint32_t)a;
        k0 += 0x9E3779B9u, k1 += 0xBB67AE85u;
    }
    *w0 = c0, *w1 = c1, *w2 = c2, *w3 = c3;
}

static inline float normal(uint32_t word) {
    int32_t sign = (int32_t)word, bits;
    float tail = ((float)(sign ^ (sign >> 31)) + .5f) * 0x1p-32f, away = 1 - 2 * tail;
    float y = 2 * tail * (1 + away), mantissa;
    memcpy(&bits, &y, 4);
    int32_t exponent = (bits - 0x3F3504F3) >> 23;
    bits -= exponent << 23;
    memcpy(&mantissa, &bits, 4);
    float f = mantissa - 1, f2 = f * f;
    float low = (.9999998139228f - .5000066740315f * f) + (.3333618193219f - .2495934346f * f) * f2;
    float high =
        (.1987304861918f - .1733347148318f * f) + (.1641997547084f - .1010220041f * f) * f2;
    float w = -((float)exponent * .6931471805599453f + (low + high * (f2 * f2)) * f);
    float w2 = w * w, w4 = w2 * w2;
    float above = ((1.2533142805743616f + .4528931760819228f * w) +
                   (.08998653582631565f + .011902043399865366f * w) * w2) +
                  (.0010024744612763129f + 2.921249561208359e-05f * w) * w4;
    float below = ((1 + .09955993205337688f * w) +
                   (.03269102304549773f + .002291294635803468f * w) * w2) +
                  (.00016975149536817527f + 1.0038387061978881e-06f * w) * w4;
    float z = away * above / below;
    return sign < 0 ? z : -z;
}

/* Shot and read noise together: read noise must be .75 e- or more. */
static inline float many(float mean, float variance, float z) {
    float inverse = 1 / (mean + variance), i = sqrtf(inverse), q = mean * inverse, s = z * z;
    float order_1 = z * ((s - 3) * (1 / 24.f) - q * (2 * s - 5) * (1 / 36.f));
    float of_q2 = 17 / 324.f + s * (-53 / 324.f + s * (12 / 324.f));
    float of_q = 2 / 24.f + s * (-5 / 24.f + s * (1 / 24.f));
    float order_2 = 3 / 120.f + s * (-6 / 120.f + s * (1 / 120.f)) - q * (of_q - q * of_q2);
    float away = (s - 1) * (1 / 6.f) + i * (order_1 + i * order_2);
    return mean + (mean + variance) * i * z + q * away;
}

static float few(float mean, uint32_t word) {
    double chance = exp(-(double)mean), left = (word + .5) * 0x1p-32 - chance;
    int k = 0;
    while (left >= 0 && k < 80) k++, chance *= mean / k, left -= chance;
    return (float)k;
}

/* How many means are low: their read noise is still to be added. */
static int noise(const float *restrict mean, const uint32_t *restrict words, int n,
                 float read_noise_e, float *restrict electrons) {
    int low = 0;
    for (int k = 0; k < n; k++) {
        electrons[k] = many(mean[k], read_noise_e * read_noise_e, normal(words[k]));
        low += mean[k] < 20;
    }
    if (low)
        for (int k = 0; k < n; k++)
            if (mean[k] < 20) electrons[k] = few(mean[k], words[k]);
    return low;
}

static void read_out(const float *restrict mean, const uint32_t *restrict words, int n,
                     float read_noise_e, float *restrict electrons) {
    for (int k = 0; k < n; k++)
        if (mean[k] < 20) electrons[k] += read_noise_e * normal(words[k]);
}

static void words_of_all(const job *j, int64_t pixel, int n, uint32_t purpose,
                         uint32_t *restrict words) {
#pragma GCC ivdep
    for (int i = 0; i < n; i++)
        philox(pixel + i, purpose, j->frame, j->key, words + i, words + n + i, words + 2 * n + i,
               words + 3 * n + i);
}

static void words_of_one(const job *j, int64_t pixel, int n, uint32_t purpose,
                         const int32_t *restrict lane, uint32_t *restrict words) {
    uint32_t w[LANES];
    words_of_all(j, pixel, n, purpose, w);
    for (int i = 0; i < n; i++) {
        uint32_t even = lane[i] & 2 ? w[2 * n + i] : w[i];
        uint32_t odd = lane[i] & 2 ? w[3 * n + i] : w[n + i];
        words[i] = lane[i] & 1 ? odd : even;
    }
}

static void run_to_color(const job *j, int64_t row, int64_t first, int n, const float *mean) {
    float electrons[LANES], colors[RUN];
    uint32_t words[LANES];
    int64_t pixel = row * j->width + first;
    words_of_all(j, pixel, n, 0, words);
    if (noise(mean, words, n * P, j->read_noise_e, electrons)) {
        words_of_all(j, pixel, n, 1, words);
        read_out(mean, words, n * P, j->read_noise_e, electrons);
    }
    for (int c = 0; c < P; c++) {
        float sum = 0;
        int beyond = 0;
        for (int i = 0; i < n; i++) beyond += electrons[c * n + i] > j->full_well_e;
        for (int i = 0; i < n; i++) sum += mean[c * n + i];
        j->counts[row * 2 * P + c] += sum, j->counts[row * 2 * P + P + c] += beyond;
    }
    float *xyz = j->xyz + 3 * (row * j->width + first);
    uint8_t *srgb = j->srgb + 3 * (row * j->width + first);
    for (int k = 0; k < 6; k++) {
        const float *m = j->matrices + k * P;
        for (int i = 0; i < n; i++)
            colors[i] = electrons[i] * m[0] + electrons[n + i] * m[1] +
                        electrons[2 * n + i] * m[2] + electrons[3 * n + i] * m[3];
        if (k < 3)
            for (int i = 0; i < n; i++) xyz[3 * i + k] = colors[i];
        else {
            int32_t entry[RUN];
            for (int i = 0; i < n; i++) {
                float v = colors[i] > 0 ? colors[i] : 0;
                v = v < 1 ? v : 1;
                entry[i] = (int32_t)(v * (ENTRIES - 1) + .5f);
            }
            for (int i = 0; i < n; i++) srgb[3 * i + k - 3] = j->table[entry[i]];
        }
    }
}

static void run_to_codes(const job *j, int64_t row, int64_t first, int n, const int64_t *channel,
                         const float *mean) {
    float electrons[RUN];
    uint32_t words[RUN];
    int64_t pixel = row * j->width + first;
    int32_t lane[RUN];
    for (int i = 0; i < n; i++) lane[i] = (int32_t)channel[i];
    words_of_one(j, pixel, n, 0, lane, words);
    if (noise(mean, words, n, j->read_noise_e, electrons)) {
        words_of_one(j, pixel, n, 1, lane, words);
        read_out(mean, words, n, j->read_noise_e, electrons);
    }
    uint16_t *codes = j->codes + row * j->width + first;
    for (int i = 0; i < n; i++) {
        float held = electrons[i] < j->full_well_e ? electrons[i] : j->full_well_e;
        float code = floorf(held * j->dn_per_e + j->black_dn + .5f);
        code = code > 0 ? code : 0;
        codes[i] = (uint16_t)(int32_t)(code < j->top_dn ? code : j->top_dn);
    }
    for (int i = 0; i < n; i++) {
        double *own = j->counts + row * 2 * P + lane[i];
        own[0] += mean[i];
        if (electrons[i] > j->full_well_e) own[P] += 1;
    }
}

static void row_of(const job *j, int64_t row, const float *last, wide seen[2], float *least,
                   float *most) {
    static __thread float mean[P * TILE];
    int64_t channel[RUN];
    for (int64_t first = 0; first < j->width; first += TILE) {
        int64_t m = j->width - first < TILE ? j->width - first : TILE;
        const float *x = j->stored + row * j->row_step + first * j->pixel_step;
        int by_band = j->pixel_step == 1;
        if (by_band) means_by_band(j, x, m, mean, least, most);
        for (int64_t run = 0; run < m; run += RUN) {
            int n = m - run < RUN ? m - run : RUN;
            float here[LANES];
            if (j->codes)
                for (int i = 0; i < n; i++)
                    channel[i] = j->tile[row % j->tile_rows * j->tile_columns +
                                         (first + run + i) % j->tile_columns];
            if (!by_band)
                means_by_pixel(j, x + run * j->pixel_step, n, last, j->codes ? channel : 0, here,
                               seen);
            else if (j->codes)
                for (int i = 0; i < n; i++) here[i] = mean[channel[i] * m + run + i];
            else
                for (int c = 0; c < P; c++)
                    memcpy(here + c * n, mean + c * m + run, sizeof(float) * n);
            if (j->codes)
                run_to_codes(j, row, first + run, n, channel, here);
            else if (j->xyz)
                run_to_color(j, row, first + run, n, here);
            else
                for (int i = 0; i < n; i++)
                    for (int c = 0; c < P; c++)
                        j->electrons[P * (row * j->width + first + run + i) + c] = here[c * n + i];
        }
    }
}

typedef struct {
    job *j;
    int64_t number;
} share;

static void *worker(void *given) {
    share *own = given;
    job *j = own->j;
    float last[W * P] = {0}, least[TILE], most[TILE];
    int64_t whole = j->bands / W * W;
    wide seen[2];
    for (int64_t b = whole; b < j->bands; b++)
        for (int c = 0; c < P; c++)
            last[W * c + b - (j->bands - W)] = j->weights[c * padded(j->bands) + b];
    for (int k = 0; k < W; k++) seen[0][k] = 3e38f, seen[1][k] = -3e38f;
    for (int k = 0; k < TILE; k++) least[k] = 3e38f, most[k] = -3e38f;
    for (;;) {
        int64_t row = __atomic_fetch_add(&j->next, BATCH, __ATOMIC_RELAXED);
        if (row >= j->height) break;
        int64_t stop = row + BATCH < j->height ? row + BATCH : j->height;
        for (; row < stop; row++) row_of(j, row, last, seen, least, most);
    }
    float *ends = j->extremes + 2 * own->number;
    ends[0] = 3e38f, ends[1] = -3e38f;
    for (int k = 0; k < W; k++) {
        if (seen[0][k] < ends[0]) ends[0] = seen[0][k];
        if (seen[1][k] > ends[1]) ends[1] = seen[1][k];
    }
    for (int k = 0; k < TILE; k++) {
        if (least[k] < ends[0]) ends[0] = least[k];
        if (most[k] > ends[1]) ends[1] = most[k];
    }
    return 0;
}

void photograph(job *j) {
    pthread_t threads[64];
    share shares[64];
    j->next = 0;
    for (int64_t t = 0; t < j->threads; t++) {
        shares[t] = (share){j, t};
        pthread_create(threads + t, 0, worker, shares + t);
    }
    for (int64_t t = 0; t < j->threads; t++) pthread_join(threads[t], 0);
}
