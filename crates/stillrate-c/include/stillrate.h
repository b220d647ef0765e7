/* stillrate: gyro denoising filters, the same bits as on the desk. Generated; do not edit.
 *
 * Everything is a plain struct: configurations are constants from `stillrate export-c`, states are placed by the caller. No
 * function allocates, fails or keeps anything to itself; different states may be used from different threads. A null pointer
 * does nothing and gives 0. MIT OR Apache-2.0. */
#ifndef STILLRATE_H
#define STILLRATE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What happened to a sample: bits of `flags`. */
#define STILLRATE_MISSING 1u /* not a number or infinite: the filter coasted */
#define STILLRATE_NO_DATA_YET 2u /* no usable sample yet: the output is a placeholder */
#define STILLRATE_BAD_TIME 4u /* time step zero, negative or not finite: no time passed */
#define STILLRATE_RESTARTED 8u /* after so long a gap the filter started anew */
#define STILLRATE_SATURATED 16u /* at the sensor's rail */
#define STILLRATE_OUTLIER 32u /* the outlier model took most of it */
#define STILLRATE_DIVERGED 64u /* the filter lost its state and started anew */
#define STILLRATE_OUT_OF_RANGE 128u /* beyond any physical rate: treated as missing */
#define STILLRATE_CHANGE 256u /* a change detector fired */

/* Size and alignment in bytes, checked where this file is compiled. */
#define STILLRATE_LAYOUT(type, size, align)                                                                            \
    typedef char type##_has_its_size[sizeof(type) == (size) ? 1 : -1];                                                 \
    typedef struct { char first; type second; } type##_after_a_byte;                                                   \
    typedef char type##_has_its_alignment[offsetof(type##_after_a_byte, second) == (align) ? 1 : -1]

/* What a step knows afterwards, in the unit of the input. */
typedef struct stillrate_estimate_f32 {
    float rate; /* filtered rate, always finite */
    float acceleration; /* its time derivative, per second; 0 for filters that do not estimate it */
    float variance; /* variance of the rate as the filter believes it; 0 for filters that have no opinion */
    uint32_t flags; /* what happened to the sample */
} stillrate_estimate_f32;

/* What a step knows afterwards, in the unit of the input. */
typedef struct stillrate_estimate_f64 {
    double rate; /* filtered rate, always finite */
    double acceleration; /* its time derivative, per second; 0 for filters that do not estimate it */
    double variance; /* variance of the rate as the filter believes it; 0 for filters that have no opinion */
    uint32_t flags; /* what happened to the sample */
} stillrate_estimate_f64;

/* ---- ar-kf in f32 ---- */

/* Kalman filter on a stationary autoregressive model of order 1 to 8; the first sample starts it. */
typedef struct stillrate_ar_kf_f32 {
    float period_s; /* Nominal sample period, s. */
    float coefficients[8]; /* phi_1, phi_2, ...; zero beyond the order. */
    float drive; /* Q / R. */
    float unit; /* Square root of R, deg/s: the unit that the state is kept in. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_ar_kf_f32;

/* State of ArKf, in units of the measurement standard deviation. */
typedef struct stillrate_ar_kf_state_f32 {
    float lags[8]; /* x_k, x_(k-1), ... */
    float covariance[8][8]; /* Covariance, symmetric. */
    float started; /* 1 once a sample has been seen. */
} stillrate_ar_kf_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ar_kf_f32 stillrate_ar_kf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ar_kf_f32_state {
    stillrate_ar_kf_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_ar_kf_f32_state;

/* The state before the first sample. */
void stillrate_ar_kf_f32_start(const stillrate_ar_kf_f32_config *config, stillrate_ar_kf_f32_state *state);
/* Back to it. */
void stillrate_ar_kf_f32_reset(const stillrate_ar_kf_f32_config *config, stillrate_ar_kf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_ar_kf_f32_step(const stillrate_ar_kf_f32_config *config, stillrate_ar_kf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_ar_kf_f32_estimate(const stillrate_ar_kf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_ar_kf_f32_config, 48, 4);
STILLRATE_LAYOUT(stillrate_ar_kf_f32_state, 308, 4);

/* ---- ar-kf in f64 ---- */

/* Kalman filter on a stationary autoregressive model of order 1 to 8; the first sample starts it. */
typedef struct stillrate_ar_kf_f64 {
    double period_s; /* Nominal sample period, s. */
    double coefficients[8]; /* phi_1, phi_2, ...; zero beyond the order. */
    double drive; /* Q / R. */
    double unit; /* Square root of R, deg/s: the unit that the state is kept in. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_ar_kf_f64;

/* State of ArKf, in units of the measurement standard deviation. */
typedef struct stillrate_ar_kf_state_f64 {
    double lags[8]; /* x_k, x_(k-1), ... */
    double covariance[8][8]; /* Covariance, symmetric. */
    double started; /* 1 once a sample has been seen. */
} stillrate_ar_kf_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ar_kf_f64 stillrate_ar_kf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ar_kf_f64_state {
    stillrate_ar_kf_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_ar_kf_f64_state;

/* The state before the first sample. */
void stillrate_ar_kf_f64_start(const stillrate_ar_kf_f64_config *config, stillrate_ar_kf_f64_state *state);
/* Back to it. */
void stillrate_ar_kf_f64_reset(const stillrate_ar_kf_f64_config *config, stillrate_ar_kf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_ar_kf_f64_step(const stillrate_ar_kf_f64_config *config, stillrate_ar_kf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_ar_kf_f64_estimate(const stillrate_ar_kf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_ar_kf_f64_config, 96, 8);
STILLRATE_LAYOUT(stillrate_ar_kf_f64_state, 616, 8);

/* ---- biquad in f32 ---- */

/* Second-order low-pass; starts in the steady state of its first sample and holds its output over missing ones. */
typedef struct stillrate_biquad_f32 {
    float period_s; /* Nominal sample period, s. */
    float half_corner_rad_s; /* pi times the cut-off, rad/s. */
    float damping; /* 1 / quality. */
    float gains[3]; /* Gains of the loop at the nominal period. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_biquad_f32;

/* State of Biquad. */
typedef struct stillrate_biquad_state_f32 {
    float slope; /* First integrator (band-pass). */
    float level; /* Second integrator (low-pass). */
    float output; /* Last output. */
    float started; /* 1 once a sample has been seen. */
} stillrate_biquad_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_biquad_f32 stillrate_biquad_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_biquad_f32_state {
    stillrate_biquad_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_biquad_f32_state;

/* The state before the first sample. */
void stillrate_biquad_f32_start(const stillrate_biquad_f32_config *config, stillrate_biquad_f32_state *state);
/* Back to it. */
void stillrate_biquad_f32_reset(const stillrate_biquad_f32_config *config, stillrate_biquad_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_biquad_f32_step(const stillrate_biquad_f32_config *config, stillrate_biquad_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_biquad_f32_estimate(const stillrate_biquad_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_biquad_f32_config, 28, 4);
STILLRATE_LAYOUT(stillrate_biquad_f32_state, 32, 4);

/* ---- biquad in f64 ---- */

/* Second-order low-pass; starts in the steady state of its first sample and holds its output over missing ones. */
typedef struct stillrate_biquad_f64 {
    double period_s; /* Nominal sample period, s. */
    double half_corner_rad_s; /* pi times the cut-off, rad/s. */
    double damping; /* 1 / quality. */
    double gains[3]; /* Gains of the loop at the nominal period. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_biquad_f64;

/* State of Biquad. */
typedef struct stillrate_biquad_state_f64 {
    double slope; /* First integrator (band-pass). */
    double level; /* Second integrator (low-pass). */
    double output; /* Last output. */
    double started; /* 1 once a sample has been seen. */
} stillrate_biquad_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_biquad_f64 stillrate_biquad_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_biquad_f64_state {
    stillrate_biquad_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_biquad_f64_state;

/* The state before the first sample. */
void stillrate_biquad_f64_start(const stillrate_biquad_f64_config *config, stillrate_biquad_f64_state *state);
/* Back to it. */
void stillrate_biquad_f64_reset(const stillrate_biquad_f64_config *config, stillrate_biquad_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_biquad_f64_step(const stillrate_biquad_f64_config *config, stillrate_biquad_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_biquad_f64_estimate(const stillrate_biquad_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_biquad_f64_config, 56, 8);
STILLRATE_LAYOUT(stillrate_biquad_f64_state, 64, 8);

/* ---- cusum-forgetting in f32 ---- */

/* Recursive least squares, opened again where the innovations show a change. */
typedef struct stillrate_cusum_forgetting_f32 {
    float period_s; /* Nominal sample period, s. */
    float loss; /* 1 - lambda: what one nominal period takes off the weight of the past. */
    float tau_s; /* Memory, s. */
    float drift; /* Standard deviations that count as no change. */
    float threshold; /* Sum at which a change is declared. */
    float samples_kept; /* Samples' worth of the past that survive a change. */
    float sigma; /* Standard deviation of one sample, deg/s. */
    float sample_variance; /* Its square. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_cusum_forgetting_f32;

/* State of a weighted mean. */
typedef struct stillrate_level_state_f32 {
    float level; /* The mean. */
    float weight; /* Weight S of all samples so far, in samples; its reciprocal is the gain. 0 before the first. */
    float weight_low; /* What rounding took from the weight. */
    float noise_gain; /* Variance of the mean over that of one sample, for a constant rate in white noise. */
} stillrate_level_state_f32;

/* State of CusumForgetting. */
typedef struct stillrate_cusum_forgetting_state_f32 {
    stillrate_level_state_f32 mean; /* The weighted mean. */
    float gain; /* Gain of the sample before. */
    float upward; /* g+, the sum against changes upwards. */
    float downward; /* g-, the sum against changes downwards. */
} stillrate_cusum_forgetting_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_cusum_forgetting_f32 stillrate_cusum_forgetting_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_cusum_forgetting_f32_state {
    stillrate_cusum_forgetting_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_cusum_forgetting_f32_state;

/* The state before the first sample. */
void stillrate_cusum_forgetting_f32_start(const stillrate_cusum_forgetting_f32_config *config, stillrate_cusum_forgetting_f32_state *state);
/* Back to it. */
void stillrate_cusum_forgetting_f32_reset(const stillrate_cusum_forgetting_f32_config *config, stillrate_cusum_forgetting_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_cusum_forgetting_f32_step(const stillrate_cusum_forgetting_f32_config *config, stillrate_cusum_forgetting_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_cusum_forgetting_f32_estimate(const stillrate_cusum_forgetting_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_cusum_forgetting_f32_config, 36, 4);
STILLRATE_LAYOUT(stillrate_cusum_forgetting_f32_state, 44, 4);

/* ---- cusum-forgetting in f64 ---- */

/* Recursive least squares, opened again where the innovations show a change. */
typedef struct stillrate_cusum_forgetting_f64 {
    double period_s; /* Nominal sample period, s. */
    double loss; /* 1 - lambda: what one nominal period takes off the weight of the past. */
    double tau_s; /* Memory, s. */
    double drift; /* Standard deviations that count as no change. */
    double threshold; /* Sum at which a change is declared. */
    double samples_kept; /* Samples' worth of the past that survive a change. */
    double sigma; /* Standard deviation of one sample, deg/s. */
    double sample_variance; /* Its square. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_cusum_forgetting_f64;

/* State of a weighted mean. */
typedef struct stillrate_level_state_f64 {
    double level; /* The mean. */
    double weight; /* Weight S of all samples so far, in samples; its reciprocal is the gain. 0 before the first. */
    double weight_low; /* What rounding took from the weight. */
    double noise_gain; /* Variance of the mean over that of one sample, for a constant rate in white noise. */
} stillrate_level_state_f64;

/* State of CusumForgetting. */
typedef struct stillrate_cusum_forgetting_state_f64 {
    stillrate_level_state_f64 mean; /* The weighted mean. */
    double gain; /* Gain of the sample before. */
    double upward; /* g+, the sum against changes upwards. */
    double downward; /* g-, the sum against changes downwards. */
} stillrate_cusum_forgetting_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_cusum_forgetting_f64 stillrate_cusum_forgetting_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_cusum_forgetting_f64_state {
    stillrate_cusum_forgetting_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_cusum_forgetting_f64_state;

/* The state before the first sample. */
void stillrate_cusum_forgetting_f64_start(const stillrate_cusum_forgetting_f64_config *config, stillrate_cusum_forgetting_f64_state *state);
/* Back to it. */
void stillrate_cusum_forgetting_f64_reset(const stillrate_cusum_forgetting_f64_config *config, stillrate_cusum_forgetting_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_cusum_forgetting_f64_step(const stillrate_cusum_forgetting_f64_config *config, stillrate_cusum_forgetting_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_cusum_forgetting_f64_estimate(const stillrate_cusum_forgetting_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_cusum_forgetting_f64_config, 72, 8);
STILLRATE_LAYOUT(stillrate_cusum_forgetting_f64_state, 88, 8);

/* ---- fir in f32 ---- */

/* Weighted mean of the last samples. */
typedef struct stillrate_fir_low_pass_f32 {
    float period_s; /* Nominal sample period, s. */
    float taps[128]; /* Taps, newest sample first, zeros after the last. */
    float rows; /* Rows of eight taps in use. */
    float from_zero; /* 1 where the register starts at zero instead of at the first sample. */
    float variance; /* Variance of the output, (deg/s)^2. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_fir_low_pass_f32;

/* State of FirLowPass. */
typedef struct stillrate_fir_low_pass_state_f32 {
    float samples[128]; /* Samples, newest first. */
    float output; /* The last output. */
    float started; /* 1 once a sample has been seen. */
} stillrate_fir_low_pass_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_fir_low_pass_f32 stillrate_fir_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_fir_f32_state {
    stillrate_fir_low_pass_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_fir_f32_state;

/* The state before the first sample. */
void stillrate_fir_f32_start(const stillrate_fir_f32_config *config, stillrate_fir_f32_state *state);
/* Back to it. */
void stillrate_fir_f32_reset(const stillrate_fir_f32_config *config, stillrate_fir_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_fir_f32_step(const stillrate_fir_f32_config *config, stillrate_fir_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_fir_f32_estimate(const stillrate_fir_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_fir_f32_config, 532, 4);
STILLRATE_LAYOUT(stillrate_fir_f32_state, 536, 4);

/* ---- fir in f64 ---- */

/* Weighted mean of the last samples. */
typedef struct stillrate_fir_low_pass_f64 {
    double period_s; /* Nominal sample period, s. */
    double taps[128]; /* Taps, newest sample first, zeros after the last. */
    double rows; /* Rows of eight taps in use. */
    double from_zero; /* 1 where the register starts at zero instead of at the first sample. */
    double variance; /* Variance of the output, (deg/s)^2. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_fir_low_pass_f64;

/* State of FirLowPass. */
typedef struct stillrate_fir_low_pass_state_f64 {
    double samples[128]; /* Samples, newest first. */
    double output; /* The last output. */
    double started; /* 1 once a sample has been seen. */
} stillrate_fir_low_pass_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_fir_low_pass_f64 stillrate_fir_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_fir_f64_state {
    stillrate_fir_low_pass_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_fir_f64_state;

/* The state before the first sample. */
void stillrate_fir_f64_start(const stillrate_fir_f64_config *config, stillrate_fir_f64_state *state);
/* Back to it. */
void stillrate_fir_f64_reset(const stillrate_fir_f64_config *config, stillrate_fir_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_fir_f64_step(const stillrate_fir_f64_config *config, stillrate_fir_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_fir_f64_estimate(const stillrate_fir_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_fir_f64_config, 1064, 8);
STILLRATE_LAYOUT(stillrate_fir_f64_state, 1072, 8);

/* ---- linear-prediction in f32 ---- */

/* Forward linear prediction of order 16; the first sample starts it. */
typedef struct stillrate_linear_prediction_f32 {
    float period_s; /* Nominal sample period, s. */
    float step_size; /* Step size mu. */
    float unit; /* Standard deviation of the raw noise, deg/s: the unit that the state is kept in. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_linear_prediction_f32;

/* State of LinearPrediction, in units of the noise's standard deviation. */
typedef struct stillrate_linear_prediction_state_f32 {
    float history[16]; /* The last samples, the newest first. */
    float weights[16]; /* Weight of each. */
    float output; /* Last output. */
    float started; /* 1 once a sample has been seen. */
} stillrate_linear_prediction_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_linear_prediction_f32 stillrate_linear_prediction_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_linear_prediction_f32_state {
    stillrate_linear_prediction_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_linear_prediction_f32_state;

/* The state before the first sample. */
void stillrate_linear_prediction_f32_start(const stillrate_linear_prediction_f32_config *config, stillrate_linear_prediction_f32_state *state);
/* Back to it. */
void stillrate_linear_prediction_f32_reset(const stillrate_linear_prediction_f32_config *config, stillrate_linear_prediction_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_linear_prediction_f32_step(const stillrate_linear_prediction_f32_config *config, stillrate_linear_prediction_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_linear_prediction_f32_estimate(const stillrate_linear_prediction_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_linear_prediction_f32_config, 16, 4);
STILLRATE_LAYOUT(stillrate_linear_prediction_f32_state, 152, 4);

/* ---- linear-prediction in f64 ---- */

/* Forward linear prediction of order 16; the first sample starts it. */
typedef struct stillrate_linear_prediction_f64 {
    double period_s; /* Nominal sample period, s. */
    double step_size; /* Step size mu. */
    double unit; /* Standard deviation of the raw noise, deg/s: the unit that the state is kept in. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_linear_prediction_f64;

/* State of LinearPrediction, in units of the noise's standard deviation. */
typedef struct stillrate_linear_prediction_state_f64 {
    double history[16]; /* The last samples, the newest first. */
    double weights[16]; /* Weight of each. */
    double output; /* Last output. */
    double started; /* 1 once a sample has been seen. */
} stillrate_linear_prediction_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_linear_prediction_f64 stillrate_linear_prediction_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_linear_prediction_f64_state {
    stillrate_linear_prediction_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_linear_prediction_f64_state;

/* The state before the first sample. */
void stillrate_linear_prediction_f64_start(const stillrate_linear_prediction_f64_config *config, stillrate_linear_prediction_f64_state *state);
/* Back to it. */
void stillrate_linear_prediction_f64_reset(const stillrate_linear_prediction_f64_config *config, stillrate_linear_prediction_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_linear_prediction_f64_step(const stillrate_linear_prediction_f64_config *config, stillrate_linear_prediction_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_linear_prediction_f64_estimate(const stillrate_linear_prediction_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_linear_prediction_f64_config, 32, 8);
STILLRATE_LAYOUT(stillrate_linear_prediction_f64_state, 304, 8);

/* ---- ms-imm-ikf-paper in f32 ---- */

/* One model of the pair. */
typedef struct stillrate_paper_model_f32 {
    float parameter; /* alpha (or its logarithm) at the start. */
    float acceleration_variance; /* sigma_m^2. */
    float measurement_variance; /* R. */
    float alpha_noise; /* Density of the third state's random walk. */
    float start_variance[3]; /* Variances of the three states at the first sample. */
} stillrate_paper_model_f32;

/* The published filter; build it from MsImmIkfPaperSettings(MsImmIkfPaperSettings). */
typedef struct stillrate_ms_imm_ikf_paper_f32 {
    float period_s; /* Nominal sample period, s. */
    stillrate_paper_model_f32 model[2]; /* The two models. */
    float transition[2][2]; /* Transition probabilities fromto a sample. */
    float static_transition[2][2]; /* The same while rest is declared. */
    float start_probability[2]; /* Probabilities before the first sample. */
    float static_alpha; /* alpha3. */
    float fading_scale; /* Factor of the square in Delta. */
    float fading_memory; /* Forgetting factor of the windowed form. */
    float fading_softening; /* Softening of R in the windowed form. */
    float limit; /* Values beyond this magnitude count as missing. */
    uint32_t shares_alpha; /* 1 where alpha is mixed. */
    uint32_t fades_alpha; /* 1 where lambda multiplies the third row and column. */
    uint32_t exact_jacobian; /* 1 where the Jacobian knows how the prediction depends on alpha. */
    uint32_t logarithmic; /* 1 where the third state is the logarithm of alpha. */
    uint32_t form; /* How lambda is computed: 0 not at all, 1 with |C|, else with C. */
    uint32_t source; /* What Delta is made of: 0 the measurement, 1 the innovation, else its windowed mean square. */
    uint32_t gate; /* When lambda acts: 0 always, 1 while moving, else in the second model while moving. */
} stillrate_ms_imm_ikf_paper_f32;

/* Rate, acceleration and the model's own parameter. */
typedef struct stillrate_gaussian3_f32 {
    float mean[3]; /* Mean. */
    float covariance[6]; /* Covariance 00, 01, 02, 11, 12, 22. */
} stillrate_gaussian3_f32;

/* State of MsImmIkfPaper. */
typedef struct stillrate_ms_imm_ikf_paper_state_f32 {
    stillrate_gaussian3_f32 model[2]; /* Both models. */
    float probability[2]; /* Their probabilities. */
    float window[2]; /* Windowed innovation squares; below 0 before the first. */
    float started; /* 1 once a sample has been seen. */
} stillrate_ms_imm_ikf_paper_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ms_imm_ikf_paper_f32 stillrate_ms_imm_ikf_paper_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ms_imm_ikf_paper_f32_state {
    stillrate_ms_imm_ikf_paper_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_ms_imm_ikf_paper_f32_state;

/* The state before the first sample. */
void stillrate_ms_imm_ikf_paper_f32_start(const stillrate_ms_imm_ikf_paper_f32_config *config, stillrate_ms_imm_ikf_paper_f32_state *state);
/* Back to it. */
void stillrate_ms_imm_ikf_paper_f32_reset(const stillrate_ms_imm_ikf_paper_f32_config *config, stillrate_ms_imm_ikf_paper_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_ms_imm_ikf_paper_f32_step(const stillrate_ms_imm_ikf_paper_f32_config *config, stillrate_ms_imm_ikf_paper_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_ms_imm_ikf_paper_f32_estimate(const stillrate_ms_imm_ikf_paper_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_ms_imm_ikf_paper_f32_config, 148, 4);
STILLRATE_LAYOUT(stillrate_ms_imm_ikf_paper_f32_state, 108, 4);

/* ---- ms-imm-ikf-paper in f64 ---- */

/* One model of the pair. */
typedef struct stillrate_paper_model_f64 {
    double parameter; /* alpha (or its logarithm) at the start. */
    double acceleration_variance; /* sigma_m^2. */
    double measurement_variance; /* R. */
    double alpha_noise; /* Density of the third state's random walk. */
    double start_variance[3]; /* Variances of the three states at the first sample. */
} stillrate_paper_model_f64;

/* The published filter; build it from MsImmIkfPaperSettings(MsImmIkfPaperSettings). */
typedef struct stillrate_ms_imm_ikf_paper_f64 {
    double period_s; /* Nominal sample period, s. */
    stillrate_paper_model_f64 model[2]; /* The two models. */
    double transition[2][2]; /* Transition probabilities fromto a sample. */
    double static_transition[2][2]; /* The same while rest is declared. */
    double start_probability[2]; /* Probabilities before the first sample. */
    double static_alpha; /* alpha3. */
    double fading_scale; /* Factor of the square in Delta. */
    double fading_memory; /* Forgetting factor of the windowed form. */
    double fading_softening; /* Softening of R in the windowed form. */
    double limit; /* Values beyond this magnitude count as missing. */
    uint32_t shares_alpha; /* 1 where alpha is mixed. */
    uint32_t fades_alpha; /* 1 where lambda multiplies the third row and column. */
    uint32_t exact_jacobian; /* 1 where the Jacobian knows how the prediction depends on alpha. */
    uint32_t logarithmic; /* 1 where the third state is the logarithm of alpha. */
    uint32_t form; /* How lambda is computed: 0 not at all, 1 with |C|, else with C. */
    uint32_t source; /* What Delta is made of: 0 the measurement, 1 the innovation, else its windowed mean square. */
    uint32_t gate; /* When lambda acts: 0 always, 1 while moving, else in the second model while moving. */
} stillrate_ms_imm_ikf_paper_f64;

/* Rate, acceleration and the model's own parameter. */
typedef struct stillrate_gaussian3_f64 {
    double mean[3]; /* Mean. */
    double covariance[6]; /* Covariance 00, 01, 02, 11, 12, 22. */
} stillrate_gaussian3_f64;

/* State of MsImmIkfPaper. */
typedef struct stillrate_ms_imm_ikf_paper_state_f64 {
    stillrate_gaussian3_f64 model[2]; /* Both models. */
    double probability[2]; /* Their probabilities. */
    double window[2]; /* Windowed innovation squares; below 0 before the first. */
    double started; /* 1 once a sample has been seen. */
} stillrate_ms_imm_ikf_paper_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ms_imm_ikf_paper_f64 stillrate_ms_imm_ikf_paper_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ms_imm_ikf_paper_f64_state {
    stillrate_ms_imm_ikf_paper_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_ms_imm_ikf_paper_f64_state;

/* The state before the first sample. */
void stillrate_ms_imm_ikf_paper_f64_start(const stillrate_ms_imm_ikf_paper_f64_config *config, stillrate_ms_imm_ikf_paper_f64_state *state);
/* Back to it. */
void stillrate_ms_imm_ikf_paper_f64_reset(const stillrate_ms_imm_ikf_paper_f64_config *config, stillrate_ms_imm_ikf_paper_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_ms_imm_ikf_paper_f64_step(const stillrate_ms_imm_ikf_paper_f64_config *config, stillrate_ms_imm_ikf_paper_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_ms_imm_ikf_paper_f64_estimate(const stillrate_ms_imm_ikf_paper_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_ms_imm_ikf_paper_f64_config, 272, 8);
STILLRATE_LAYOUT(stillrate_ms_imm_ikf_paper_f64_state, 216, 8);

/* ---- ms-imm-ikf in f32 ---- */

/* How the moments follow, in periods. */
typedef struct stillrate_frequency_memory_f32 {
    float frequency_periods; /* Memory of the frequency. */
    float variance_periods; /* Memory of the prior variances. */
    float angle_min; /* Smallest angular frequency, radians a period. */
    float angle_max; /* Largest angular frequency, radians a period. */
    float rate_square_min; /* Below this mean square rate the frequency is held. */
} stillrate_frequency_memory_f32;

/* Transition and unit process noise of a Singer model over one step. */
typedef struct stillrate_singer_coefficients_f32 {
    float r; /* Rate gained per unit of acceleration, s. */
    float s; /* Share of the acceleration that remains. */
    float q11; /* Variance of the rate, s^3. */
    float q12; /* Covariance of rate and acceleration, s^2. */
    float q22; /* Variance of the acceleration, s. */
} stillrate_singer_coefficients_f32;

/* What follows from the length of a step alone; a filter holds that of its nominal period. */
typedef struct stillrate_pace_f32 {
    float elapsed; /* Length in periods. */
    stillrate_singer_coefficients_f32 singer; /* Coefficients shared by all rungs. */
    float leave; /* Probability of leaving a moving model. */
    float leave_rest; /* Probability of leaving the random walk. */
    float walk; /* Variance of the random walk over the step. */
} stillrate_pace_f32;

/* The recommended filter; build it from MsImmIkfSettings(MsImmIkfSettings). */
typedef struct stillrate_ms_imm_ikf_f32 {
    float period_s; /* Nominal sample period, s. */
    float measurement_variance; /* Variance R of a sample. */
    float noise_share; /* Share of the noise that keeps prior variances above zero, per unit angle. */
    float limit; /* Values beyond this magnitude count as missing. */
    float walk_variance; /* Variance of the random walk over a period. */
    float missing_acceleration; /* Variance of the acceleration that the random walk lacks. */
    float start_variance[2]; /* Variances of second and third derivative before the first sample. */
    uint32_t rung_count; /* Rungs in use. */
    uint32_t oscillator_count; /* Oscillators in use. */
    float rung_intensity[8]; /* Process noise of each rung. */
    float rung_counts_in[8]; /* 1 where a rung counts in the moments of the motion. */
    float oscillator_intensity[6]; /* Process noise of each oscillator at unit angle. */
    float derivative_cap; /* Cap of 4.3a in units of the mean square acceleration. */
    stillrate_frequency_memory_f32 memory; /* How the moments of the motion are followed. */
    float start_angle; /* Manoeuvre frequency before anything is known, radians a period. */
    float refresh_samples; /* Samples between refreshes of the oscillators. */
    float outlier_probability; /* Prior probability of an outlier; 0 is off. */
    float saturation; /* Full scale of the sensor. */
    float dwell_periods; /* Dwell time of moving models in periods. */
    float rest_dwell_periods; /* Dwell time of the random walk in periods. */
    float share; /* 1 / (number of models - 1). */
    stillrate_pace_f32 nominal; /* What follows from a step of one period. */
} stillrate_ms_imm_ikf_f32;

/* Rate and acceleration. */
typedef struct stillrate_gaussian2_f32 {
    float mean[2]; /* Mean. */
    float covariance[3]; /* Covariance 00, 01, 11. */
} stillrate_gaussian2_f32;

/* Rate and its first three derivatives. */
typedef struct stillrate_gaussian4_f32 {
    float mean[4]; /* Mean. */
    float covariance[10]; /* Covariance 00, 01, 02, 03, 11, 12, 13, 22, 23, 33. */
} stillrate_gaussian4_f32;

/* Moments of the fused motion, in periods. */
typedef struct stillrate_motion_moments_f32 {
    float mean_rate; /* Slow mean of the rate. */
    float rate_square; /* Mean square of the rate about it. */
    float acceleration_square; /* Mean square acceleration, memory of the prior variances. */
    float acceleration_square_slow; /* Mean square acceleration, memory of the frequency. */
    float angle; /* Angular frequency, radians a period. */
} stillrate_motion_moments_f32;

/* Transition and unit process noise of a double oscillator for one step. */
typedef struct stillrate_oscillator_step_f32 {
    float from_rate[4]; /* First column of F: what the rate does to each derivative. */
    float from_acceleration[4]; /* Second column of F: what the acceleration does. */
    float response[5]; /* h0 ... h4; the third column of F is h1 ... h4, the fourth h0 ... h3. */
    float noise[10]; /* Integral of h h' over the step, packed (00 01 02 03 11 12 13 22 23 33). */
} stillrate_oscillator_step_f32;

/* State of MsImmIkf: moments of every model, probabilities, followed motion, oscillator coefficients. */
typedef struct stillrate_ms_imm_ikf_state_f32 {
    float started; /* 1 once a sample has been seen. */
    float walk[2]; /* Random walk: rate and its variance. */
    stillrate_gaussian2_f32 rung[8]; /* Rungs: rate and acceleration. */
    stillrate_gaussian4_f32 oscillator[6]; /* Oscillators: rate and three derivatives. */
    float walk_probability; /* Probability of the random walk. */
    float rung_probability[8]; /* Probabilities of the rungs. */
    float oscillator_probability[6]; /* Probabilities of the oscillators. */
    float lacking[2]; /* Variances of second and third derivative in the models that lack them, last step. */
    float lacking_next[2]; /* The same for the coming steps. */
    float fused[3]; /* Fused rate, acceleration and variance of the rate. */
    stillrate_motion_moments_f32 motion; /* Followed motion. */
    stillrate_oscillator_step_f32 step; /* Coefficients of the oscillators. */
    float renew_in; /* Samples until they are renewed. */
    float made_for; /* Step length they were made for, in periods. */
    float silent; /* Periods since the last sample that was used. */
} stillrate_ms_imm_ikf_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ms_imm_ikf_f32 stillrate_ms_imm_ikf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ms_imm_ikf_f32_state {
    stillrate_ms_imm_ikf_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_ms_imm_ikf_f32_state;

/* The state before the first sample. */
void stillrate_ms_imm_ikf_f32_start(const stillrate_ms_imm_ikf_f32_config *config, stillrate_ms_imm_ikf_f32_state *state);
/* Back to it. */
void stillrate_ms_imm_ikf_f32_reset(const stillrate_ms_imm_ikf_f32_config *config, stillrate_ms_imm_ikf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_ms_imm_ikf_f32_step(const stillrate_ms_imm_ikf_f32_config *config, stillrate_ms_imm_ikf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_ms_imm_ikf_f32_estimate(const stillrate_ms_imm_ikf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_ms_imm_ikf_f32_config, 216, 4);
STILLRATE_LAYOUT(stillrate_ms_imm_ikf_f32_state, 736, 4);

/* ---- ms-imm-ikf in f64 ---- */

/* How the moments follow, in periods. */
typedef struct stillrate_frequency_memory_f64 {
    double frequency_periods; /* Memory of the frequency. */
    double variance_periods; /* Memory of the prior variances. */
    double angle_min; /* Smallest angular frequency, radians a period. */
    double angle_max; /* Largest angular frequency, radians a period. */
    double rate_square_min; /* Below this mean square rate the frequency is held. */
} stillrate_frequency_memory_f64;

/* Transition and unit process noise of a Singer model over one step. */
typedef struct stillrate_singer_coefficients_f64 {
    double r; /* Rate gained per unit of acceleration, s. */
    double s; /* Share of the acceleration that remains. */
    double q11; /* Variance of the rate, s^3. */
    double q12; /* Covariance of rate and acceleration, s^2. */
    double q22; /* Variance of the acceleration, s. */
} stillrate_singer_coefficients_f64;

/* What follows from the length of a step alone; a filter holds that of its nominal period. */
typedef struct stillrate_pace_f64 {
    double elapsed; /* Length in periods. */
    stillrate_singer_coefficients_f64 singer; /* Coefficients shared by all rungs. */
    double leave; /* Probability of leaving a moving model. */
    double leave_rest; /* Probability of leaving the random walk. */
    double walk; /* Variance of the random walk over the step. */
} stillrate_pace_f64;

/* The recommended filter; build it from MsImmIkfSettings(MsImmIkfSettings). */
typedef struct stillrate_ms_imm_ikf_f64 {
    double period_s; /* Nominal sample period, s. */
    double measurement_variance; /* Variance R of a sample. */
    double noise_share; /* Share of the noise that keeps prior variances above zero, per unit angle. */
    double limit; /* Values beyond this magnitude count as missing. */
    double walk_variance; /* Variance of the random walk over a period. */
    double missing_acceleration; /* Variance of the acceleration that the random walk lacks. */
    double start_variance[2]; /* Variances of second and third derivative before the first sample. */
    uint32_t rung_count; /* Rungs in use. */
    uint32_t oscillator_count; /* Oscillators in use. */
    double rung_intensity[8]; /* Process noise of each rung. */
    double rung_counts_in[8]; /* 1 where a rung counts in the moments of the motion. */
    double oscillator_intensity[6]; /* Process noise of each oscillator at unit angle. */
    double derivative_cap; /* Cap of 4.3a in units of the mean square acceleration. */
    stillrate_frequency_memory_f64 memory; /* How the moments of the motion are followed. */
    double start_angle; /* Manoeuvre frequency before anything is known, radians a period. */
    double refresh_samples; /* Samples between refreshes of the oscillators. */
    double outlier_probability; /* Prior probability of an outlier; 0 is off. */
    double saturation; /* Full scale of the sensor. */
    double dwell_periods; /* Dwell time of moving models in periods. */
    double rest_dwell_periods; /* Dwell time of the random walk in periods. */
    double share; /* 1 / (number of models - 1). */
    stillrate_pace_f64 nominal; /* What follows from a step of one period. */
} stillrate_ms_imm_ikf_f64;

/* Rate and acceleration. */
typedef struct stillrate_gaussian2_f64 {
    double mean[2]; /* Mean. */
    double covariance[3]; /* Covariance 00, 01, 11. */
} stillrate_gaussian2_f64;

/* Rate and its first three derivatives. */
typedef struct stillrate_gaussian4_f64 {
    double mean[4]; /* Mean. */
    double covariance[10]; /* Covariance 00, 01, 02, 03, 11, 12, 13, 22, 23, 33. */
} stillrate_gaussian4_f64;

/* Moments of the fused motion, in periods. */
typedef struct stillrate_motion_moments_f64 {
    double mean_rate; /* Slow mean of the rate. */
    double rate_square; /* Mean square of the rate about it. */
    double acceleration_square; /* Mean square acceleration, memory of the prior variances. */
    double acceleration_square_slow; /* Mean square acceleration, memory of the frequency. */
    double angle; /* Angular frequency, radians a period. */
} stillrate_motion_moments_f64;

/* Transition and unit process noise of a double oscillator for one step. */
typedef struct stillrate_oscillator_step_f64 {
    double from_rate[4]; /* First column of F: what the rate does to each derivative. */
    double from_acceleration[4]; /* Second column of F: what the acceleration does. */
    double response[5]; /* h0 ... h4; the third column of F is h1 ... h4, the fourth h0 ... h3. */
    double noise[10]; /* Integral of h h' over the step, packed (00 01 02 03 11 12 13 22 23 33). */
} stillrate_oscillator_step_f64;

/* State of MsImmIkf: moments of every model, probabilities, followed motion, oscillator coefficients. */
typedef struct stillrate_ms_imm_ikf_state_f64 {
    double started; /* 1 once a sample has been seen. */
    double walk[2]; /* Random walk: rate and its variance. */
    stillrate_gaussian2_f64 rung[8]; /* Rungs: rate and acceleration. */
    stillrate_gaussian4_f64 oscillator[6]; /* Oscillators: rate and three derivatives. */
    double walk_probability; /* Probability of the random walk. */
    double rung_probability[8]; /* Probabilities of the rungs. */
    double oscillator_probability[6]; /* Probabilities of the oscillators. */
    double lacking[2]; /* Variances of second and third derivative in the models that lack them, last step. */
    double lacking_next[2]; /* The same for the coming steps. */
    double fused[3]; /* Fused rate, acceleration and variance of the rate. */
    stillrate_motion_moments_f64 motion; /* Followed motion. */
    stillrate_oscillator_step_f64 step; /* Coefficients of the oscillators. */
    double renew_in; /* Samples until they are renewed. */
    double made_for; /* Step length they were made for, in periods. */
    double silent; /* Periods since the last sample that was used. */
} stillrate_ms_imm_ikf_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_ms_imm_ikf_f64 stillrate_ms_imm_ikf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_ms_imm_ikf_f64_state {
    stillrate_ms_imm_ikf_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_ms_imm_ikf_f64_state;

/* The state before the first sample. */
void stillrate_ms_imm_ikf_f64_start(const stillrate_ms_imm_ikf_f64_config *config, stillrate_ms_imm_ikf_f64_state *state);
/* Back to it. */
void stillrate_ms_imm_ikf_f64_reset(const stillrate_ms_imm_ikf_f64_config *config, stillrate_ms_imm_ikf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_ms_imm_ikf_f64_step(const stillrate_ms_imm_ikf_f64_config *config, stillrate_ms_imm_ikf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_ms_imm_ikf_f64_estimate(const stillrate_ms_imm_ikf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_ms_imm_ikf_f64_config, 424, 8);
STILLRATE_LAYOUT(stillrate_ms_imm_ikf_f64_state, 1472, 8);

/* ---- one-euro in f32 ---- */

/* One-euro filter; the first sample starts it, missing samples hold it. */
typedef struct stillrate_one_euro_f32 {
    float period_s; /* Nominal sample period, s. */
    float minimum_corner_rad_s; /* 2 pi times the cut-off at rest, rad/s. */
    float corner_per_speed; /* 2 pi times beta, rad/s per deg/s^2. */
    float derivative_corner_rad_s; /* 2 pi times the cut-off for the derivative, rad/s. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_one_euro_f32;

/* State of OneEuro. */
typedef struct stillrate_one_euro_state_f32 {
    float level; /* The filtered value. */
    float slope; /* The filtered derivative, per second. */
    float raw; /* The last raw sample. */
    float since; /* Time since then, s. */
    float started; /* 1 once a sample has been seen. */
} stillrate_one_euro_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_one_euro_f32 stillrate_one_euro_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_one_euro_f32_state {
    stillrate_one_euro_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_one_euro_f32_state;

/* The state before the first sample. */
void stillrate_one_euro_f32_start(const stillrate_one_euro_f32_config *config, stillrate_one_euro_f32_state *state);
/* Back to it. */
void stillrate_one_euro_f32_reset(const stillrate_one_euro_f32_config *config, stillrate_one_euro_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_one_euro_f32_step(const stillrate_one_euro_f32_config *config, stillrate_one_euro_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_one_euro_f32_estimate(const stillrate_one_euro_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_one_euro_f32_config, 20, 4);
STILLRATE_LAYOUT(stillrate_one_euro_f32_state, 36, 4);

/* ---- one-euro in f64 ---- */

/* One-euro filter; the first sample starts it, missing samples hold it. */
typedef struct stillrate_one_euro_f64 {
    double period_s; /* Nominal sample period, s. */
    double minimum_corner_rad_s; /* 2 pi times the cut-off at rest, rad/s. */
    double corner_per_speed; /* 2 pi times beta, rad/s per deg/s^2. */
    double derivative_corner_rad_s; /* 2 pi times the cut-off for the derivative, rad/s. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_one_euro_f64;

/* State of OneEuro. */
typedef struct stillrate_one_euro_state_f64 {
    double level; /* The filtered value. */
    double slope; /* The filtered derivative, per second. */
    double raw; /* The last raw sample. */
    double since; /* Time since then, s. */
    double started; /* 1 once a sample has been seen. */
} stillrate_one_euro_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_one_euro_f64 stillrate_one_euro_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_one_euro_f64_state {
    stillrate_one_euro_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_one_euro_f64_state;

/* The state before the first sample. */
void stillrate_one_euro_f64_start(const stillrate_one_euro_f64_config *config, stillrate_one_euro_f64_state *state);
/* Back to it. */
void stillrate_one_euro_f64_reset(const stillrate_one_euro_f64_config *config, stillrate_one_euro_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_one_euro_f64_step(const stillrate_one_euro_f64_config *config, stillrate_one_euro_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_one_euro_f64_estimate(const stillrate_one_euro_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_one_euro_f64_config, 40, 8);
STILLRATE_LAYOUT(stillrate_one_euro_f64_state, 72, 8);

/* ---- pt1 in f32 ---- */

/* First-order low-pass with cut-off cutoff_hz; the first sample starts it. */
typedef struct stillrate_pt1_f32 {
    float period_s; /* Nominal sample period, s. */
    float gain; /* Gain at the nominal period. */
    float corner_rad_s; /* 2 pi times the cut-off, rad/s. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_pt1_f32;

/* State of Pt1. */
typedef struct stillrate_pt1_state_f32 {
    float level; /* The filtered value. */
    float started; /* 1 once a sample has been seen. */
} stillrate_pt1_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_pt1_f32 stillrate_pt1_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_pt1_f32_state {
    stillrate_pt1_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_pt1_f32_state;

/* The state before the first sample. */
void stillrate_pt1_f32_start(const stillrate_pt1_f32_config *config, stillrate_pt1_f32_state *state);
/* Back to it. */
void stillrate_pt1_f32_reset(const stillrate_pt1_f32_config *config, stillrate_pt1_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_pt1_f32_step(const stillrate_pt1_f32_config *config, stillrate_pt1_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_pt1_f32_estimate(const stillrate_pt1_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_pt1_f32_config, 16, 4);
STILLRATE_LAYOUT(stillrate_pt1_f32_state, 24, 4);

/* ---- pt1 in f64 ---- */

/* First-order low-pass with cut-off cutoff_hz; the first sample starts it. */
typedef struct stillrate_pt1_f64 {
    double period_s; /* Nominal sample period, s. */
    double gain; /* Gain at the nominal period. */
    double corner_rad_s; /* 2 pi times the cut-off, rad/s. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_pt1_f64;

/* State of Pt1. */
typedef struct stillrate_pt1_state_f64 {
    double level; /* The filtered value. */
    double started; /* 1 once a sample has been seen. */
} stillrate_pt1_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_pt1_f64 stillrate_pt1_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_pt1_f64_state {
    stillrate_pt1_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_pt1_f64_state;

/* The state before the first sample. */
void stillrate_pt1_f64_start(const stillrate_pt1_f64_config *config, stillrate_pt1_f64_state *state);
/* Back to it. */
void stillrate_pt1_f64_reset(const stillrate_pt1_f64_config *config, stillrate_pt1_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_pt1_f64_step(const stillrate_pt1_f64_config *config, stillrate_pt1_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_pt1_f64_estimate(const stillrate_pt1_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_pt1_f64_config, 32, 8);
STILLRATE_LAYOUT(stillrate_pt1_f64_state, 48, 8);

/* ---- hmm-kf in f32 ---- */

/* Kalman filter for a random walk in white noise; the first sample starts it. */
typedef struct stillrate_random_walk_kf_f32 {
    float period_s; /* Nominal sample period, s. */
    float variance_ratio; /* q = Q/R over one nominal period. */
    float sample_variance; /* Variance R of one sample, (deg/s)^2. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_random_walk_kf_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_random_walk_kf_f32 stillrate_hmm_kf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_hmm_kf_f32_state {
    stillrate_level_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_hmm_kf_f32_state;

/* The state before the first sample. */
void stillrate_hmm_kf_f32_start(const stillrate_hmm_kf_f32_config *config, stillrate_hmm_kf_f32_state *state);
/* Back to it. */
void stillrate_hmm_kf_f32_reset(const stillrate_hmm_kf_f32_config *config, stillrate_hmm_kf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_hmm_kf_f32_step(const stillrate_hmm_kf_f32_config *config, stillrate_hmm_kf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_hmm_kf_f32_estimate(const stillrate_hmm_kf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_hmm_kf_f32_config, 16, 4);
STILLRATE_LAYOUT(stillrate_hmm_kf_f32_state, 32, 4);

/* ---- hmm-kf in f64 ---- */

/* Kalman filter for a random walk in white noise; the first sample starts it. */
typedef struct stillrate_random_walk_kf_f64 {
    double period_s; /* Nominal sample period, s. */
    double variance_ratio; /* q = Q/R over one nominal period. */
    double sample_variance; /* Variance R of one sample, (deg/s)^2. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_random_walk_kf_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_random_walk_kf_f64 stillrate_hmm_kf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_hmm_kf_f64_state {
    stillrate_level_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_hmm_kf_f64_state;

/* The state before the first sample. */
void stillrate_hmm_kf_f64_start(const stillrate_hmm_kf_f64_config *config, stillrate_hmm_kf_f64_state *state);
/* Back to it. */
void stillrate_hmm_kf_f64_reset(const stillrate_hmm_kf_f64_config *config, stillrate_hmm_kf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_hmm_kf_f64_step(const stillrate_hmm_kf_f64_config *config, stillrate_hmm_kf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_hmm_kf_f64_estimate(const stillrate_hmm_kf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_hmm_kf_f64_config, 32, 8);
STILLRATE_LAYOUT(stillrate_hmm_kf_f64_state, 64, 8);

/* ---- hmm-rls in f32 ---- */

/* Order 1 on its own: the exponentially weighted mean. */
typedef struct stillrate_weighted_mean_f32 {
    float period_s; /* Nominal sample period, s. */
    float loss; /* 1 - lambda: what one nominal period takes off the weight of the past. */
    float tau_s; /* Memory, s. */
    float sample_variance; /* Variance of one sample, (deg/s)^2. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_weighted_mean_f32;

/* Exponentially weighted mean or line of all samples so far. */
typedef struct stillrate_recursive_least_squares_f32 {
    stillrate_weighted_mean_f32 mean; /* Order 1, and what order 2 has in common with it. */
    float order; /* 1 or 2. */
} stillrate_recursive_least_squares_f32;

/* State of a weighted line. */
typedef struct stillrate_line_state_f32 {
    float level; /* Level now (of the fitted line, gaps included). */
    float slope; /* Slope per nominal period. */
    float moments[3]; /* S0, S1, S2. */
    float squared[3]; /* The same with squared weights. */
    float silent_s; /* Seconds since the last usable sample. */
} stillrate_line_state_f32;

/* State of RecursiveLeastSquares: of the two orders only the configured one is in use. */
typedef struct stillrate_recursive_least_squares_state_f32 {
    stillrate_level_state_f32 mean; /* Order 1. */
    stillrate_line_state_f32 line; /* Order 2. */
} stillrate_recursive_least_squares_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_recursive_least_squares_f32 stillrate_hmm_rls_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_hmm_rls_f32_state {
    stillrate_recursive_least_squares_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_hmm_rls_f32_state;

/* The state before the first sample. */
void stillrate_hmm_rls_f32_start(const stillrate_hmm_rls_f32_config *config, stillrate_hmm_rls_f32_state *state);
/* Back to it. */
void stillrate_hmm_rls_f32_reset(const stillrate_hmm_rls_f32_config *config, stillrate_hmm_rls_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_hmm_rls_f32_step(const stillrate_hmm_rls_f32_config *config, stillrate_hmm_rls_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_hmm_rls_f32_estimate(const stillrate_hmm_rls_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_hmm_rls_f32_config, 24, 4);
STILLRATE_LAYOUT(stillrate_hmm_rls_f32_state, 68, 4);

/* ---- hmm-rls in f64 ---- */

/* Order 1 on its own: the exponentially weighted mean. */
typedef struct stillrate_weighted_mean_f64 {
    double period_s; /* Nominal sample period, s. */
    double loss; /* 1 - lambda: what one nominal period takes off the weight of the past. */
    double tau_s; /* Memory, s. */
    double sample_variance; /* Variance of one sample, (deg/s)^2. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_weighted_mean_f64;

/* Exponentially weighted mean or line of all samples so far. */
typedef struct stillrate_recursive_least_squares_f64 {
    stillrate_weighted_mean_f64 mean; /* Order 1, and what order 2 has in common with it. */
    double order; /* 1 or 2. */
} stillrate_recursive_least_squares_f64;

/* State of a weighted line. */
typedef struct stillrate_line_state_f64 {
    double level; /* Level now (of the fitted line, gaps included). */
    double slope; /* Slope per nominal period. */
    double moments[3]; /* S0, S1, S2. */
    double squared[3]; /* The same with squared weights. */
    double silent_s; /* Seconds since the last usable sample. */
} stillrate_line_state_f64;

/* State of RecursiveLeastSquares: of the two orders only the configured one is in use. */
typedef struct stillrate_recursive_least_squares_state_f64 {
    stillrate_level_state_f64 mean; /* Order 1. */
    stillrate_line_state_f64 line; /* Order 2. */
} stillrate_recursive_least_squares_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_recursive_least_squares_f64 stillrate_hmm_rls_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_hmm_rls_f64_state {
    stillrate_recursive_least_squares_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_hmm_rls_f64_state;

/* The state before the first sample. */
void stillrate_hmm_rls_f64_start(const stillrate_hmm_rls_f64_config *config, stillrate_hmm_rls_f64_state *state);
/* Back to it. */
void stillrate_hmm_rls_f64_reset(const stillrate_hmm_rls_f64_config *config, stillrate_hmm_rls_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_hmm_rls_f64_step(const stillrate_hmm_rls_f64_config *config, stillrate_hmm_rls_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_hmm_rls_f64_estimate(const stillrate_hmm_rls_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_hmm_rls_f64_config, 48, 8);
STILLRATE_LAYOUT(stillrate_hmm_rls_f64_state, 136, 8);

/* ---- sage-husa-kf in f32 ---- */

/* Kalman filter with a Singer model and an adaptive measurement variance; the first sample starts it. */
typedef struct stillrate_sage_husa_kf_f32 {
    float period_s; /* Nominal sample period, s. */
    float alpha_per_s; /* Reciprocal of the manoeuvre time constant, 1/s. */
    stillrate_singer_coefficients_f32 model; /* Singer's model at the nominal period. */
    float drive; /* Spectral density of the driving noise over the noise variance R of the start, 1/s^5. */
    float forgotten; /* Share of the measurement variance that is forgotten in a nominal step. */
    float memory_s; /* Memory of the measurement variance, s. */
    float unit; /* Measurement standard deviation at the start, deg/s: the unit that the state is kept in. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_sage_husa_kf_f32;

/* State of SageHusaKf, in units of the measurement standard deviation it started with. */
typedef struct stillrate_sage_husa_kf_state_f32 {
    float rate; /* Rate. */
    float acceleration; /* Its derivative, per second. */
    float p11; /* Variance of the rate. */
    float p12; /* Covariance of rate and acceleration. */
    float p22; /* Variance of the acceleration. */
    float measurement_variance; /* Measurement variance R. */
    float started; /* 1 once a sample has been seen. */
} stillrate_sage_husa_kf_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_sage_husa_kf_f32 stillrate_sage_husa_kf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_sage_husa_kf_f32_state {
    stillrate_sage_husa_kf_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_sage_husa_kf_f32_state;

/* The state before the first sample. */
void stillrate_sage_husa_kf_f32_start(const stillrate_sage_husa_kf_f32_config *config, stillrate_sage_husa_kf_f32_state *state);
/* Back to it. */
void stillrate_sage_husa_kf_f32_reset(const stillrate_sage_husa_kf_f32_config *config, stillrate_sage_husa_kf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_sage_husa_kf_f32_step(const stillrate_sage_husa_kf_f32_config *config, stillrate_sage_husa_kf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_sage_husa_kf_f32_estimate(const stillrate_sage_husa_kf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_sage_husa_kf_f32_config, 48, 4);
STILLRATE_LAYOUT(stillrate_sage_husa_kf_f32_state, 44, 4);

/* ---- sage-husa-kf in f64 ---- */

/* Kalman filter with a Singer model and an adaptive measurement variance; the first sample starts it. */
typedef struct stillrate_sage_husa_kf_f64 {
    double period_s; /* Nominal sample period, s. */
    double alpha_per_s; /* Reciprocal of the manoeuvre time constant, 1/s. */
    stillrate_singer_coefficients_f64 model; /* Singer's model at the nominal period. */
    double drive; /* Spectral density of the driving noise over the noise variance R of the start, 1/s^5. */
    double forgotten; /* Share of the measurement variance that is forgotten in a nominal step. */
    double memory_s; /* Memory of the measurement variance, s. */
    double unit; /* Measurement standard deviation at the start, deg/s: the unit that the state is kept in. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_sage_husa_kf_f64;

/* State of SageHusaKf, in units of the measurement standard deviation it started with. */
typedef struct stillrate_sage_husa_kf_state_f64 {
    double rate; /* Rate. */
    double acceleration; /* Its derivative, per second. */
    double p11; /* Variance of the rate. */
    double p12; /* Covariance of rate and acceleration. */
    double p22; /* Variance of the acceleration. */
    double measurement_variance; /* Measurement variance R. */
    double started; /* 1 once a sample has been seen. */
} stillrate_sage_husa_kf_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_sage_husa_kf_f64 stillrate_sage_husa_kf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_sage_husa_kf_f64_state {
    stillrate_sage_husa_kf_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_sage_husa_kf_f64_state;

/* The state before the first sample. */
void stillrate_sage_husa_kf_f64_start(const stillrate_sage_husa_kf_f64_config *config, stillrate_sage_husa_kf_f64_state *state);
/* Back to it. */
void stillrate_sage_husa_kf_f64_reset(const stillrate_sage_husa_kf_f64_config *config, stillrate_sage_husa_kf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_sage_husa_kf_f64_step(const stillrate_sage_husa_kf_f64_config *config, stillrate_sage_husa_kf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_sage_husa_kf_f64_estimate(const stillrate_sage_husa_kf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_sage_husa_kf_f64_config, 96, 8);
STILLRATE_LAYOUT(stillrate_sage_husa_kf_f64_state, 88, 8);

/* ---- singer-imm-kf in f32 ---- */

/* One Singer model of the pair. */
typedef struct stillrate_singer_imm_model_f32 {
    float alpha; /* Reciprocal time constant, 1/s. */
    stillrate_singer_coefficients_f32 step; /* Coefficients at the nominal period, driving noise included. */
    float measurement_variance; /* Variance of a sample. */
    float start_variance[2]; /* Variances of rate and acceleration at the first sample. */
} stillrate_singer_imm_model_f32;

/* Two interacting Singer models. */
typedef struct stillrate_singer_imm_kf_f32 {
    float period_s; /* Nominal sample period, s. */
    stillrate_singer_imm_model_f32 model[2]; /* The two models. */
    float leave[2]; /* Probabilities of leaving each model for the other, a sample. */
    float start_probability; /* Probability of the first model before the first sample. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_singer_imm_kf_f32;

/* State of SingerImmKf. */
typedef struct stillrate_singer_imm_kf_state_f32 {
    stillrate_gaussian2_f32 model[2]; /* Rate and acceleration of both models. */
    float weight[2]; /* Their weights: probabilities once divided by their sum. */
    float started; /* 1 once a sample has been seen. */
} stillrate_singer_imm_kf_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_singer_imm_kf_f32 stillrate_singer_imm_kf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_singer_imm_kf_f32_state {
    stillrate_singer_imm_kf_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_singer_imm_kf_f32_state;

/* The state before the first sample. */
void stillrate_singer_imm_kf_f32_start(const stillrate_singer_imm_kf_f32_config *config, stillrate_singer_imm_kf_f32_state *state);
/* Back to it. */
void stillrate_singer_imm_kf_f32_reset(const stillrate_singer_imm_kf_f32_config *config, stillrate_singer_imm_kf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_singer_imm_kf_f32_step(const stillrate_singer_imm_kf_f32_config *config, stillrate_singer_imm_kf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_singer_imm_kf_f32_estimate(const stillrate_singer_imm_kf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_singer_imm_kf_f32_config, 92, 4);
STILLRATE_LAYOUT(stillrate_singer_imm_kf_f32_state, 68, 4);

/* ---- singer-imm-kf in f64 ---- */

/* One Singer model of the pair. */
typedef struct stillrate_singer_imm_model_f64 {
    double alpha; /* Reciprocal time constant, 1/s. */
    stillrate_singer_coefficients_f64 step; /* Coefficients at the nominal period, driving noise included. */
    double measurement_variance; /* Variance of a sample. */
    double start_variance[2]; /* Variances of rate and acceleration at the first sample. */
} stillrate_singer_imm_model_f64;

/* Two interacting Singer models. */
typedef struct stillrate_singer_imm_kf_f64 {
    double period_s; /* Nominal sample period, s. */
    stillrate_singer_imm_model_f64 model[2]; /* The two models. */
    double leave[2]; /* Probabilities of leaving each model for the other, a sample. */
    double start_probability; /* Probability of the first model before the first sample. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_singer_imm_kf_f64;

/* State of SingerImmKf. */
typedef struct stillrate_singer_imm_kf_state_f64 {
    stillrate_gaussian2_f64 model[2]; /* Rate and acceleration of both models. */
    double weight[2]; /* Their weights: probabilities once divided by their sum. */
    double started; /* 1 once a sample has been seen. */
} stillrate_singer_imm_kf_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_singer_imm_kf_f64 stillrate_singer_imm_kf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_singer_imm_kf_f64_state {
    stillrate_singer_imm_kf_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_singer_imm_kf_f64_state;

/* The state before the first sample. */
void stillrate_singer_imm_kf_f64_start(const stillrate_singer_imm_kf_f64_config *config, stillrate_singer_imm_kf_f64_state *state);
/* Back to it. */
void stillrate_singer_imm_kf_f64_reset(const stillrate_singer_imm_kf_f64_config *config, stillrate_singer_imm_kf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_singer_imm_kf_f64_step(const stillrate_singer_imm_kf_f64_config *config, stillrate_singer_imm_kf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_singer_imm_kf_f64_estimate(const stillrate_singer_imm_kf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_singer_imm_kf_f64_config, 184, 8);
STILLRATE_LAYOUT(stillrate_singer_imm_kf_f64_state, 136, 8);

/* ---- singer-kf in f32 ---- */

/* Singer Kalman filter. */
typedef struct stillrate_singer_kf_f32 {
    float period_s; /* Nominal sample period, s. */
    float alpha; /* Reciprocal time constant, 1/s. */
    float intensity; /* Density of the driving noise, 2 alpha sigma_m^2. */
    stillrate_singer_coefficients_f32 step; /* Coefficients at the nominal period. */
    float measurement_variance; /* Variance of a sample. */
    float start_variance[2]; /* Variances of rate and acceleration at the first sample. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_singer_kf_f32;

/* State of SingerKf. */
typedef struct stillrate_singer_kf_state_f32 {
    stillrate_gaussian2_f32 model; /* Rate and acceleration. */
    float started; /* 1 once a sample has been seen. */
} stillrate_singer_kf_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_singer_kf_f32 stillrate_singer_kf_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_singer_kf_f32_state {
    stillrate_singer_kf_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_singer_kf_f32_state;

/* The state before the first sample. */
void stillrate_singer_kf_f32_start(const stillrate_singer_kf_f32_config *config, stillrate_singer_kf_f32_state *state);
/* Back to it. */
void stillrate_singer_kf_f32_reset(const stillrate_singer_kf_f32_config *config, stillrate_singer_kf_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_singer_kf_f32_step(const stillrate_singer_kf_f32_config *config, stillrate_singer_kf_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_singer_kf_f32_estimate(const stillrate_singer_kf_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_singer_kf_f32_config, 48, 4);
STILLRATE_LAYOUT(stillrate_singer_kf_f32_state, 40, 4);

/* ---- singer-kf in f64 ---- */

/* Singer Kalman filter. */
typedef struct stillrate_singer_kf_f64 {
    double period_s; /* Nominal sample period, s. */
    double alpha; /* Reciprocal time constant, 1/s. */
    double intensity; /* Density of the driving noise, 2 alpha sigma_m^2. */
    stillrate_singer_coefficients_f64 step; /* Coefficients at the nominal period. */
    double measurement_variance; /* Variance of a sample. */
    double start_variance[2]; /* Variances of rate and acceleration at the first sample. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_singer_kf_f64;

/* State of SingerKf. */
typedef struct stillrate_singer_kf_state_f64 {
    stillrate_gaussian2_f64 model; /* Rate and acceleration. */
    double started; /* 1 once a sample has been seen. */
} stillrate_singer_kf_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_singer_kf_f64 stillrate_singer_kf_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_singer_kf_f64_state {
    stillrate_singer_kf_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_singer_kf_f64_state;

/* The state before the first sample. */
void stillrate_singer_kf_f64_start(const stillrate_singer_kf_f64_config *config, stillrate_singer_kf_f64_state *state);
/* Back to it. */
void stillrate_singer_kf_f64_reset(const stillrate_singer_kf_f64_config *config, stillrate_singer_kf_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_singer_kf_f64_step(const stillrate_singer_kf_f64_config *config, stillrate_singer_kf_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_singer_kf_f64_estimate(const stillrate_singer_kf_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_singer_kf_f64_config, 96, 8);
STILLRATE_LAYOUT(stillrate_singer_kf_f64_state, 80, 8);

/* ---- variable-forgetting in f32 ---- */

/* Recursive least squares whose forgetting factor follows the innovation. */
typedef struct stillrate_variable_forgetting_f32 {
    float period_s; /* Nominal sample period, s. */
    float order; /* 1 or 2. */
    float forgetting_factor_max; /* Forgetting factor at rest, a nominal period. */
    float range; /* What full motion adds to it (negative). */
    float smoothing; /* beta. */
    float spread; /* sqrt((2 - beta)/beta). */
    float threshold; /* Where forgetting begins, standard deviations. */
    float width; /* From there to full motion, standard deviations. */
    float sigma; /* Standard deviation of one sample, deg/s. */
    float sample_variance; /* Its square. */
    float quiet_tau_s; /* Memory at rest, s: an order-2 line is followed through a gap for so long. */
    float limit; /* Values beyond this magnitude count as missing. */
} stillrate_variable_forgetting_f32;

/* State of VariableForgetting. */
typedef struct stillrate_variable_forgetting_state_f32 {
    stillrate_recursive_least_squares_state_f32 sums; /* The weighted mean or line. */
    float gain; /* Gain of the sample before (order 2: its g1). */
    float smoothed; /* Smoothed innovation in standard deviations. */
} stillrate_variable_forgetting_state_f32;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_variable_forgetting_f32 stillrate_variable_forgetting_f32_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_variable_forgetting_f32_state {
    stillrate_variable_forgetting_state_f32 filter; /* what the filter remembers */
    stillrate_estimate_f32 last; /* what the last step found */
} stillrate_variable_forgetting_f32_state;

/* The state before the first sample. */
void stillrate_variable_forgetting_f32_start(const stillrate_variable_forgetting_f32_config *config, stillrate_variable_forgetting_f32_state *state);
/* Back to it. */
void stillrate_variable_forgetting_f32_reset(const stillrate_variable_forgetting_f32_config *config, stillrate_variable_forgetting_f32_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
float stillrate_variable_forgetting_f32_step(const stillrate_variable_forgetting_f32_config *config, stillrate_variable_forgetting_f32_state *state, float value, float dt_s);
/* What the last step found. */
void stillrate_variable_forgetting_f32_estimate(const stillrate_variable_forgetting_f32_state *state, stillrate_estimate_f32 *out);

STILLRATE_LAYOUT(stillrate_variable_forgetting_f32_config, 48, 4);
STILLRATE_LAYOUT(stillrate_variable_forgetting_f32_state, 76, 4);

/* ---- variable-forgetting in f64 ---- */

/* Recursive least squares whose forgetting factor follows the innovation. */
typedef struct stillrate_variable_forgetting_f64 {
    double period_s; /* Nominal sample period, s. */
    double order; /* 1 or 2. */
    double forgetting_factor_max; /* Forgetting factor at rest, a nominal period. */
    double range; /* What full motion adds to it (negative). */
    double smoothing; /* beta. */
    double spread; /* sqrt((2 - beta)/beta). */
    double threshold; /* Where forgetting begins, standard deviations. */
    double width; /* From there to full motion, standard deviations. */
    double sigma; /* Standard deviation of one sample, deg/s. */
    double sample_variance; /* Its square. */
    double quiet_tau_s; /* Memory at rest, s: an order-2 line is followed through a gap for so long. */
    double limit; /* Values beyond this magnitude count as missing. */
} stillrate_variable_forgetting_f64;

/* State of VariableForgetting. */
typedef struct stillrate_variable_forgetting_state_f64 {
    stillrate_recursive_least_squares_state_f64 sums; /* The weighted mean or line. */
    double gain; /* Gain of the sample before (order 2: its g1). */
    double smoothed; /* Smoothed innovation in standard deviations. */
} stillrate_variable_forgetting_state_f64;

/* Checked configuration; made by `stillrate export-c`. */
typedef stillrate_variable_forgetting_f64 stillrate_variable_forgetting_f64_config;
/* State: place it anywhere, start it before the first step. */
typedef struct stillrate_variable_forgetting_f64_state {
    stillrate_variable_forgetting_state_f64 filter; /* what the filter remembers */
    stillrate_estimate_f64 last; /* what the last step found */
} stillrate_variable_forgetting_f64_state;

/* The state before the first sample. */
void stillrate_variable_forgetting_f64_start(const stillrate_variable_forgetting_f64_config *config, stillrate_variable_forgetting_f64_state *state);
/* Back to it. */
void stillrate_variable_forgetting_f64_reset(const stillrate_variable_forgetting_f64_config *config, stillrate_variable_forgetting_f64_state *state);
/* One sample: the measured rate (NAN where missing) and the time in seconds since the one before; gives the filtered rate. */
double stillrate_variable_forgetting_f64_step(const stillrate_variable_forgetting_f64_config *config, stillrate_variable_forgetting_f64_state *state, double value, double dt_s);
/* What the last step found. */
void stillrate_variable_forgetting_f64_estimate(const stillrate_variable_forgetting_f64_state *state, stillrate_estimate_f64 *out);

STILLRATE_LAYOUT(stillrate_variable_forgetting_f64_config, 96, 8);
STILLRATE_LAYOUT(stillrate_variable_forgetting_f64_state, 152, 8);

#ifdef __cplusplus
}
#endif
#endif
