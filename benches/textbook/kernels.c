/* Textbook kernels to compare with: literal matrix products, one function call a sequence, double precision.
 * Two interacting Singer models (Blom and Bar-Shalom 1988) and a single Kalman filter, both of state (rate, acceleration). */
#include <math.h>

static void predict(double x[2], double P[2][2], const double F[2][2], const double Q[2][2]) {
    double y[2], A[2][2], B[2][2];
    for (int i = 0; i < 2; i++) {
        y[i] = 0;
        for (int k = 0; k < 2; k++) y[i] += F[i][k] * x[k];
        for (int j = 0; j < 2; j++) {
            A[i][j] = 0;
            for (int k = 0; k < 2; k++) A[i][j] += F[i][k] * P[k][j];
        }
    }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            B[i][j] = Q[i][j];
            for (int k = 0; k < 2; k++) B[i][j] += A[i][k] * F[j][k];
        }
    for (int i = 0; i < 2; i++) {
        x[i] = y[i];
        for (int j = 0; j < 2; j++) P[i][j] = B[i][j];
    }
}

static double update(double x[2], double P[2][2], double z, double R) {
    double nu = z - x[0], S = P[0][0] + R;
    double K[2] = {P[0][0] / S, P[1][0] / S};
    double A[2][2], B[2][2];
    for (int i = 0; i < 2; i++) x[i] += K[i] * nu;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) A[i][j] = (i == j) - K[i] * (j == 0);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            B[i][j] = 0;
            for (int k = 0; k < 2; k++) B[i][j] += A[i][k] * P[k][j];
        }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) P[i][j] = B[i][j];
    return exp(-0.5 * nu * nu / S) / sqrt(2 * M_PI * S);
}

void imm(long n, const double *z, double *out, const double F[2][2][2], const double Q[2][2][2], const double *R,
         const double pi[2][2], const double *start_variance, const double *start_probability) {
    double x[2][2], P[2][2][2], mu[2] = {start_probability[0], start_probability[1]};
    for (int m = 0; m < 2; m++) {
        x[m][0] = z[0], x[m][1] = 0;
        P[m][0][0] = start_variance[2 * m], P[m][1][1] = start_variance[2 * m + 1], P[m][0][1] = P[m][1][0] = 0;
    }
    for (long t = 0; t < n; t++) {
        double c[2], x0[2][2], P0[2][2][2], likelihood[2], sum = 0;
        for (int j = 0; j < 2; j++) {
            c[j] = 0;
            for (int i = 0; i < 2; i++) c[j] += pi[i][j] * mu[i];
        }
        for (int j = 0; j < 2; j++) {
            double w[2];
            for (int i = 0; i < 2; i++) w[i] = pi[i][j] * mu[i] / c[j];
            for (int a = 0; a < 2; a++) {
                x0[j][a] = 0;
                for (int i = 0; i < 2; i++) x0[j][a] += w[i] * x[i][a];
            }
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) {
                    P0[j][a][b] = 0;
                    for (int i = 0; i < 2; i++)
                        P0[j][a][b] += w[i] * (P[i][a][b] + (x[i][a] - x0[j][a]) * (x[i][b] - x0[j][b]));
                }
        }
        for (int j = 0; j < 2; j++) {
            predict(x0[j], P0[j], F[j], Q[j]);
            likelihood[j] = update(x0[j], P0[j], z[t], R[j]);
            sum += c[j] * likelihood[j];
        }
        out[t] = 0;
        for (int j = 0; j < 2; j++) {
            mu[j] = c[j] * likelihood[j] / sum;
            for (int a = 0; a < 2; a++) {
                x[j][a] = x0[j][a];
                for (int b = 0; b < 2; b++) P[j][a][b] = P0[j][a][b];
            }
            out[t] += mu[j] * x[j][0];
        }
    }
}

void kalman(long n, const double *z, double *out, const double F[2][2], const double Q[2][2], double R,
            const double *start_variance) {
    double x[2] = {z[0], 0}, P[2][2] = {{start_variance[0], 0}, {0, start_variance[1]}};
    for (long t = 0; t < n; t++) {
        predict(x, P, F, Q);
        update(x, P, z[t], R);
        out[t] = x[0];
    }
}
