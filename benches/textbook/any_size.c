/* The textbook's interacting multiple models for any number of models and states, as a library of matrix routines has it: sizes
 * are arguments, matrices lie row by row in plain arrays, products are literal loops. The measurement is the first state. */
#include <math.h>
#include <string.h>

enum { MOST = 8 };

static void multiply(int n, const double *a, const double *b, double *out) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0;
            for (int k = 0; k < n; k++) sum += a[i * n + k] * b[k * n + j];
            out[i * n + j] = sum;
        }
}

static void multiply_transposed(int n, const double *a, const double *b, double *out) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0;
            for (int k = 0; k < n; k++) sum += a[i * n + k] * b[j * n + k];
            out[i * n + j] = sum;
        }
}

static void predict(int n, double *x, double *P, const double *F, const double *Q) {
    double y[MOST], A[MOST * MOST];
    for (int i = 0; i < n; i++) {
        y[i] = 0;
        for (int k = 0; k < n; k++) y[i] += F[i * n + k] * x[k];
    }
    memcpy(x, y, sizeof(double) * n);
    multiply(n, F, P, A);
    multiply_transposed(n, A, F, P);
    for (int i = 0; i < n * n; i++) P[i] += Q[i];
}

static double update(int n, double *x, double *P, double z, double R) {
    double nu = z - x[0], S = P[0] + R, A[MOST * MOST], B[MOST * MOST];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) A[i * n + j] = (i == j) - P[i * n] / S * (j == 0);
    for (int i = 0; i < n; i++) x[i] += P[i * n] / S * nu;
    multiply(n, A, P, B);
    memcpy(P, B, sizeof(double) * n * n);
    return exp(-0.5 * nu * nu / S) / sqrt(2 * M_PI * S);
}

void imm_of_any_size(int m, int n, long samples, const double *z, double *out, const double *F, const double *Q, const double *R,
                     const double *pi, const double *start_covariance, const double *start_probability) {
    double x[MOST][MOST], P[MOST][MOST * MOST], mu[MOST];
    for (int j = 0; j < m; j++) {
        memset(x[j], 0, sizeof x[j]);
        x[j][0] = z[0];
        memcpy(P[j], start_covariance + j * n * n, sizeof(double) * n * n);
        mu[j] = start_probability[j];
    }
    for (long t = 0; t < samples; t++) {
        double c[MOST], x0[MOST][MOST], P0[MOST][MOST * MOST], likelihood[MOST], sum = 0;
        for (int j = 0; j < m; j++) {
            c[j] = 0;
            for (int i = 0; i < m; i++) c[j] += pi[i * m + j] * mu[i];
        }
        for (int j = 0; j < m; j++) {
            double w[MOST];
            for (int i = 0; i < m; i++) w[i] = pi[i * m + j] * mu[i] / c[j];
            for (int a = 0; a < n; a++) {
                x0[j][a] = 0;
                for (int i = 0; i < m; i++) x0[j][a] += w[i] * x[i][a];
            }
            for (int a = 0; a < n; a++)
                for (int b = 0; b < n; b++) {
                    P0[j][a * n + b] = 0;
                    for (int i = 0; i < m; i++)
                        P0[j][a * n + b] += w[i] * (P[i][a * n + b] + (x[i][a] - x0[j][a]) * (x[i][b] - x0[j][b]));
                }
        }
        for (int j = 0; j < m; j++) {
            predict(n, x0[j], P0[j], F + j * n * n, Q + j * n * n);
            likelihood[j] = update(n, x0[j], P0[j], z[t], R[j]);
            sum += c[j] * likelihood[j];
        }
        out[t] = 0;
        for (int j = 0; j < m; j++) {
            mu[j] = c[j] * likelihood[j] / sum;
            memcpy(x[j], x0[j], sizeof x[j]);
            memcpy(P[j], P0[j], sizeof(double) * n * n);
            out[t] += mu[j] * x[j][0];
        }
    }
}
